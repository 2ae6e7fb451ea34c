"""Routes for versions of a mission: store, list, read, restore and delete them."""

from typing import Annotated

from fastapi import Path, Response

from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_planner.service.core.commands import CommandId, ReplaceFrom, ReplacePlan
from argo_planner.service.core.document import PlanVersion
from argo_planner.service.rooms.messages import VersionSummary
from argo_planner.service.web.bodies import JsonBody
from argo_planner.service.web.commands import COMMAND_RESPONSE, execute_command
from argo_planner.service.web.problems import problem_responses
from argo_planner.service.web.requests import (
    MadeOn,
    NameGiven,
    PlanId,
    Planner,
    Service,
    Viewer,
    created_response,
    json_response,
    make_router,
    openapi_links,
)

router = make_router("versions")

_VERSION = openapi_links(
    "read_version",
    "restore_version",
    "drop_version",
    id="$request.path.id",
    number="$response.body#/number",
)


class RestoredVersion(Model):
    """Command that restores a version."""

    id: CommandId


class VersionList(Model):
    """Versions in the order in which they were stored."""

    versions: tuple[VersionSummary, ...]


@router.get("/missions/{id}/versions", operation_id="list_versions", response_model=VersionList)
async def list_versions(service: Service, _: Viewer, id: PlanId) -> Response:
    """Return the stored versions of a mission, without their content."""
    document = (await service.rooms.open(id)).document
    return json_response(
        VersionList(versions=tuple(map(VersionSummary.from_version, document.versions)))
    )


@router.post(
    "/missions/{id}/versions",
    operation_id="keep_version",
    status_code=201,
    response_model=VersionSummary,
    responses=problem_responses(412, 428) | {201: created_response(VersionSummary, _VERSION)},
)
async def store_mission_version(
    service: Service,
    visitor: Planner,
    id: PlanId,
    given: JsonBody[NameGiven],
    made_on: MadeOn,
) -> Response:
    """Store the present mission as a version with a name.

    409 if another version has the name, or there are too many versions.
    """
    room = await service.rooms.open(id)
    version = await room.store_version(given.name, visitor.author, made_on)
    return json_response(version, 201, location=f"/api/missions/{id}/versions/{version.number}")


VersionNumber = Annotated[int, Path(ge=1, le=10**9, description="number of the version")]


@router.get(
    "/missions/{id}/versions/{number}", operation_id="read_version", response_model=PlanVersion
)
async def read_version(service: Service, _: Viewer, id: PlanId, number: VersionNumber) -> Response:
    """Return a version with its mission."""
    return json_response((await service.rooms.open(id)).document.version(number))


@router.delete("/missions/{id}/versions/{number}", operation_id="drop_version", status_code=204)
async def delete_mission_version(
    service: Service, _: Planner, id: PlanId, number: VersionNumber
) -> Response:
    """Delete a version."""
    await (await service.rooms.open(id)).delete_version(number)
    return Response(status_code=204)


@router.post(
    "/missions/{id}/versions/{number}/restore", operation_id="restore_version", **COMMAND_RESPONSE
)
async def restore_version(
    service: Service,
    visitor: Planner,
    id: PlanId,
    number: VersionNumber,
    command: JsonBody[RestoredVersion],
    made_on: MadeOn,
) -> Response:
    """Replace the present mission by a version, as a command that can be undone."""
    room = await service.rooms.open(id)
    request = ReplaceFrom(id=command.id, kept_as=Message("version {number}", number=number))
    # This precedes the search for the version, which may have been deleted since.
    if (again := room.earlier_answer(request, visitor.author)) is not None:
        return json_response(again, revision=again.newest)
    version = room.document.version(number)
    replaced = ReplacePlan.model_construct(
        id=command.id,
        mission=version.mission,
        about=Message("version {version}", version=version.name),
    )
    return await execute_command(room, replaced, visitor.author, made_on, request)
