"""Versions of a mission: kept, listed, made the mission again, dropped."""

from typing import Annotated

from fastapi import Path, Response

from argo_compiler.base.model import Model
from argo_planner.service.core.commands import CommandId, ReplaceFrom, ReplacePlan
from argo_planner.service.core.document import PlanVersion
from argo_planner.service.rooms.messages import VersionSummary
from argo_planner.service.web.bodies import Sent
from argo_planner.service.web.commands import COMMAND, carried_out
from argo_planner.service.web.problems import documented
from argo_planner.service.web.requests import (
    MadeOn,
    NameGiven,
    PlanId,
    Planner,
    Service,
    Viewer,
    created,
    links,
    routes,
    said,
)

router = routes("versions")

_VERSION = links(
    "read_version",
    "restore_version",
    "drop_version",
    id="$request.path.id",
    number="$response.body#/number",
)


class RestoredVersion(Model):
    """A command that makes a version the mission again."""

    id: CommandId


class VersionList(Model):
    """Versions in the order in which they were kept."""

    versions: tuple[VersionSummary, ...]


@router.get("/missions/{id}/versions", operation_id="list_versions", response_model=VersionList)
async def list_versions(service: Service, _: Viewer, id: PlanId) -> Response:
    """The versions that were kept of a mission."""
    document = (await service.rooms.open(id)).document
    return said(VersionList(versions=tuple(map(VersionSummary.from_version, document.versions))))


@router.post(
    "/missions/{id}/versions",
    operation_id="keep_version",
    status_code=201,
    response_model=VersionSummary,
    responses=documented(412, 428) | {201: created(VersionSummary, _VERSION)},
)
async def keep_version(
    service: Service,
    visitor: Planner,
    id: PlanId,
    given: Sent[NameGiven],
    made_on: MadeOn,
) -> Response:
    """Keeps the mission as it stands under a name."""
    room = await service.rooms.open(id)
    version = await room.store_version(given.name, visitor.author, made_on)
    return said(version, 201, location=f"/api/missions/{id}/versions/{version.number}")


VersionNumber = Annotated[int, Path(ge=1, le=10**9, description="of the version")]


@router.get(
    "/missions/{id}/versions/{number}", operation_id="read_version", response_model=PlanVersion
)
async def read_version(service: Service, _: Viewer, id: PlanId, number: VersionNumber) -> Response:
    """A version with its mission."""
    return said((await service.rooms.open(id)).document.version(number))


@router.delete("/missions/{id}/versions/{number}", operation_id="drop_version", status_code=204)
async def drop_version(service: Service, _: Planner, id: PlanId, number: VersionNumber) -> Response:
    """Keeps a version no longer."""
    await (await service.rooms.open(id)).delete_version(number)
    return Response(status_code=204)


@router.post("/missions/{id}/versions/{number}/restore", operation_id="restore_version", **COMMAND)
async def restore_version(
    service: Service,
    visitor: Planner,
    id: PlanId,
    number: VersionNumber,
    command: Sent[RestoredVersion],
    made_on: MadeOn,
) -> Response:
    """Makes a version the mission again, as a command that can be undone."""
    room = await service.rooms.open(id)
    asked = ReplaceFrom(id=command.id, kept_as=f"version {number}")
    # Before the version is looked for, which may have been dropped since.
    if (again := room.earlier_answer(asked, visitor.author)) is not None:
        return said(again, revision=again.newest)
    version = room.document.version(number)
    replaced = ReplacePlan.model_construct(
        id=command.id, mission=version.mission, about=f"version {version.name}"
    )
    return await carried_out(room, replaced, visitor.author, made_on, asked)
