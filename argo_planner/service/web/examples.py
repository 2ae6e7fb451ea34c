"""Routes for the shipped examples of missions: list them, and create a mission from one."""

from collections.abc import AsyncIterator
from typing import Annotated

from fastapi import Path, Response
from pydantic import Field

from argo_compiler.base.errors import NotFound
from argo_compiler.base.message import Listing, Message
from argo_compiler.base.model import Model
from argo_planner.service.storage.outline import PlanSummary
from argo_planner.service.web.bodies import JsonBody
from argo_planner.service.web.missions import MISSION_LINKS, create_plan
from argo_planner.service.web.requests import (
    Planner,
    Service,
    Viewer,
    created_response,
    json_response,
    make_router,
)
from argo_planner.use_cases.examples import example_files, list_missions_on_site

router = make_router("examples")


class ExampleSummary(Model):
    """Example of a mission."""

    name: str
    about: str
    """line about the example"""


class ExampleList(Model):
    """Examples of missions on the site of the service."""

    examples: tuple[ExampleSummary, ...]


class ExampleNamed(Model):
    """Name of the mission that is created from an example."""

    name: str | None = Field(default=None, max_length=1_000)
    """null: the name of the example"""


@router.get("/examples", operation_id="list_mission_examples", response_model=ExampleList)
async def list_mission_examples(service: Service, _: Viewer) -> Response:
    """Return the shipped examples of missions on the service's site; there may be none."""
    found = list_missions_on_site(service.site.name)
    examples = (ExampleSummary(name=name, about=one.about) for name, one in found.items())
    return json_response(ExampleList(examples=tuple(examples)))


@router.post(
    "/examples/{example}/mission",
    operation_id="create_mission_from_example",
    status_code=201,
    response_model=PlanSummary,
    responses={201: created_response(PlanSummary, MISSION_LINKS)},
)
async def create_mission_from_example(
    service: Service,
    visitor: Planner,
    example: Annotated[str, Path(max_length=40, description="name of the example")],
    given: JsonBody[ExampleNamed],
) -> Response:
    """Create a mission from an example, as an import of its file does."""
    found = list_missions_on_site(service.site.name)
    if example not in found:
        raise NotFound(
            Message(
                "there is no example `{example}` on this site; there are: {known}",
                example=example,
                known=Listing(found) or Message("none"),
            )
        )
    file, content = next(iter(example_files(example).items()))

    async def parts() -> AsyncIterator[bytes]:
        yield content

    areas = found[example].start_area, found[example].end_area
    read = await service.imports.import_upload(file, parts(), visitor.key, *areas)
    imported = read.require_mission()
    notes = imported.diagnostics
    return await create_plan(
        service, given.name or example, imported.mission, notes, read.script_text
    )
