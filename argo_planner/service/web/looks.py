"""What is looked at before something is decided: the picture of a reading, a suggested order as it
would be driven, what an import had to say."""

from typing import Annotated

from fastapi import Path, Response

from argo_compiler.base.errors import NotFound
from argo_compiler.base.model import Model
from argo_compiler.diagnostics import Diagnostic
from argo_planner.service.runs.pictures import picture_of
from argo_planner.service.storage.notes import read_notes
from argo_planner.service.web.jobs import JobId
from argo_planner.service.web.requests import (
    PlanId,
    Service,
    Viewer,
    answers_file,
    routes,
    said,
)
from argo_planner.service.web.runs import RunId
from argo_planner.service.world.previews import PreviewedMission, preview_mission

router = routes()


class ImportNotes(Model):
    """What the last import of a mission had to say."""

    revision: int
    """of the mission that it made"""
    notes: tuple[Diagnostic, ...]


@router.get(
    "/runs/{run}/pictures/{checkpoint}/{milliseconds}",
    operation_id="read_picture",
    tags=["runs"],
    **answers_file("the picture", "image/png"),
)
async def read_picture(
    service: Service,
    _: Viewer,
    run: RunId,
    checkpoint: Annotated[int, Path(ge=0, le=10**6, description="that was read")],
    milliseconds: Annotated[int, Path(ge=0, le=10**12, description="`t` of the reading, in ms")],
) -> Response:
    """The picture from which a checkpoint was read. Only the sensor `camera` takes pictures."""
    path = picture_of(service.runs.folder.path(run), checkpoint, milliseconds / 1000)
    try:
        content = path.read_bytes()
    except OSError:
        raise NotFound(f"run {run} has no picture of checkpoint {checkpoint} then") from None
    headers = {"cache-control": "private, max-age=31536000, immutable"}
    return Response(content, 200, headers, "image/png")


@router.get(
    "/jobs/{id}/preview",
    operation_id="preview_job",
    tags=["jobs"],
    response_model=PreviewedMission,
)
async def preview_job(service: Service, _: Viewer, id: JobId) -> Response:
    """The ways of the mission in the order that a search has found; 409 until there is one."""
    mission = service.orders.ordered(id)[1]
    obstacles = service.obstacles.present.obstacles
    return said(await service.on_site(preview_mission, service.site, mission, obstacles))


@router.get(
    "/missions/{id}/notes",
    operation_id="read_notes",
    tags=["missions"],
    response_model=ImportNotes,
)
async def read_import_notes(service: Service, _: Viewer, id: PlanId) -> Response:
    """What the import of the mission, or of the last script put in its place, had to say: what was
    healed, taken for something, or has no effect."""
    await service.rooms.open(id)
    revision, notes = read_notes(service.folder, id)
    return said(ImportNotes(revision=revision, notes=notes))
