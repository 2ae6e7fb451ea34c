"""Routes for missions: create, import, list, rename, copy, delete, restore and export them."""

import asyncio
import io
import os
import re
import zipfile
from collections.abc import Mapping
from typing import Annotated
from urllib.parse import quote

from fastapi import Path, Query, Request, Response
from pydantic import Field

from argo_compiler.base.errors import NotFound
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_compiler.checks import check
from argo_compiler.diagnostics import Diagnostic, DiagnosticError, has_errors
from argo_compiler.il import Mission
from argo_env.planning.opening import OpenedSite
from argo_planner.service.core.change import mission_change
from argo_planner.service.core.commands import Revision
from argo_planner.service.core.document import PlanDocument
from argo_planner.service.core.plan_limits import require_within_limits
from argo_planner.service.drafts.messages import DraftState
from argo_planner.service.rooms.messages import PlanState
from argo_planner.service.storage.import_notes import (
    delete_import_notes,
    load_import_notes,
    load_imported_script,
    store_import_notes,
)
from argo_planner.service.storage.outline import PlanSummary
from argo_planner.service.web.bodies import JsonBody
from argo_planner.service.web.requests import (
    NameGiven,
    PlanId,
    Planner,
    Service,
    Viewer,
    created_response,
    file_route_arguments,
    json_response,
    make_router,
    openapi_link,
    openapi_links,
)
from argo_planner.use_cases.exporting import export_mission, to_script
from argo_planner.use_cases.importing import ImportedMission

MISSION_LINKS = openapi_links(
    "read_mission",
    "rename_mission",
    "file_mission",
    "duplicate_mission",
    "delete_mission",
    "export_mission",
    "carry_out_command",
    "list_revisions",
    "keep_version",
    "list_versions",
    "read_back",
    "read_analysis",
    "read_imported_script",
    "write_script",
    "suggest_order",
    "start_run",
    id="$response.body#/id",
)
DRAFT_LINKS = openapi_links(
    "read_draft", "decide_draft", "complete_draft", "delete_draft", id="$response.body#/id"
)
ETAG = "$response.header.ETag"
for _name in ("carry_out_command", "keep_version", "write_script", "start_run"):
    MISSION_LINKS[_name]["parameters"]["If-Match"] = ETAG
for _name in ("decide_draft", "complete_draft"):
    DRAFT_LINKS[_name]["parameters"]["If-Match"] = ETAG

router = make_router("missions")


class PlanList(Model):
    """Missions, the last changed ones first."""

    missions: tuple[PlanSummary, ...]


class NewMission(Model):
    """New mission plan: its name, and its mission, which is empty if none is given."""

    name: str = Field(max_length=1_000)
    mission: Mission | None = None


class FolderGiven(Model):
    """Folder of the list of missions that a mission is moved to."""

    folder: str = Field(max_length=1_000)
    """name of the folder; empty: no folder"""
    seen: str | None = Field(default=None, max_length=1_000)
    """folder in which the client has seen the mission; if it is in another one by now, the answer
    is 409; null: move it from wherever it is"""


class RevisionList(Model):
    """Revisions, the oldest ones first."""

    revisions: tuple[Revision, ...]


class ImportNotes(Model):
    """Notes of the last import of a mission."""

    revision: int
    """revision of the mission that the import made; 0 if there was none"""
    notes: tuple[Diagnostic, ...]


class ImportedScript(Model):
    """Script that a mission was imported from."""

    revision: int
    """revision of the mission that the import made; 0 if there is no script"""
    text: str


@router.get("/missions", operation_id="list_missions", response_model=PlanList)
async def list_missions(service: Service, _: Viewer) -> Response:
    """Return a summary of each mission, except for those in the bin."""
    return json_response(PlanList(missions=tuple(await service.rooms.list_plans())))


@router.post(
    "/missions",
    operation_id="create_mission",
    status_code=201,
    response_model=PlanSummary,
    responses={201: created_response(PlanSummary, MISSION_LINKS)},
)
async def create_mission(service: Service, _: Planner, new: JsonBody[NewMission]) -> Response:
    """Create a mission."""
    if new.mission is not None:
        # In a thread: a large mission takes a second, in which others go on.
        diagnostics = await asyncio.to_thread(check, new.mission, service.site.catalog)
        if has_errors(diagnostics):
            raise DiagnosticError(new.name, diagnostics)
    mission = new.mission or Mission(tasks=(), site=service.site.name)
    return await create_plan(service, new.name, mission)


@router.post(
    "/imports",
    operation_id="import_mission",
    status_code=201,
    response_model=PlanSummary,
    responses={
        201: created_response(PlanSummary, MISSION_LINKS),
        202: created_response(DraftState, DRAFT_LINKS) | {"description": "A draft was created"},
    },
    openapi_extra={
        "requestBody": {
            "required": True,
            "content": {
                "application/octet-stream": {"schema": {"type": "string", "format": "binary"}}
            },
        }
    },
)
async def import_a_mission(
    request: Request,
    service: Service,
    visitor: Planner,
    filename: Annotated[
        str,
        Query(max_length=200, description="name of the file; its ending shows the format"),
    ],
    name: Annotated[str | None, Query(max_length=1_000)] = None,
    start_area: Annotated[int | None, Query(ge=-1000, le=1000)] = None,
    end_area: Annotated[int | None, Query(ge=-1000, le=1000)] = None,
) -> Response:
    """Create a mission from the body: a script, a document, JSON, a ROS bag or an isar mission.

    202 if lines of a script are left to decide on: then a draft is created instead.
    """
    file = os.path.basename(filename) or "mission"
    read = await service.imports.import_upload(
        file, request.stream(), visitor.key, start_area, end_area
    )
    name = name or os.path.splitext(file)[0]
    if read.imported is None and read.reading is not None and read.script is not None:
        areas = (start_area, end_area)
        state = await service.drafts.create(name, file, read.script, read.reading, areas)
        location = f"/api/drafts/{state.id}"
        return json_response(state, 202, revision=state.revision, location=location)
    imported = read.require_mission()
    notes = imported.diagnostics
    return await create_plan(service, name, imported.mission, notes, read.script_text)


@router.get("/missions/{id}", operation_id="read_mission", response_model=PlanState)
async def read_current_mission(service: Service, visitor: Viewer, id: PlanId) -> Response:
    """Return the present state of a mission; its ETag is the revision."""
    state = (await service.rooms.open(id)).plan_state(visitor.author)
    return json_response(state, revision=state.revision)


@router.put("/missions/{id}/name", operation_id="rename_mission", response_model=PlanSummary)
async def rename_mission(
    service: Service, visitor: Planner, id: PlanId, given: JsonBody[NameGiven]
) -> Response:
    """Rename a mission."""
    room = await service.rooms.open(id)
    await room.rename(given.name, visitor.author)
    return json_response(room.summary())


@router.put("/missions/{id}/folder", operation_id="file_mission", response_model=PlanSummary)
async def file_mission(
    service: Service, visitor: Planner, id: PlanId, given: JsonBody[FolderGiven]
) -> Response:
    """Move a mission to a folder of the list; a folder exists while a mission is in it."""
    room = await service.rooms.open(id)
    await room.move_to_folder(given.folder, given.seen, visitor.author)
    return json_response(room.summary())


@router.post(
    "/missions/{id}/duplicate",
    operation_id="duplicate_mission",
    status_code=201,
    response_model=PlanSummary,
    responses={201: created_response(PlanSummary, MISSION_LINKS)},
)
async def duplicate_mission(
    service: Service, _: Planner, id: PlanId, given: JsonBody[NameGiven]
) -> Response:
    """Create a copy of a mission in its folder, without its revisions and versions."""
    document = (await service.rooms.open(id)).document
    mission = document.plan.mission
    return await create_plan(service, given.name, mission, folder=document.folder)


@router.delete(
    "/missions/{id}",
    operation_id="delete_mission",
    status_code=204,
    responses={
        204: {
            "description": "No Content",
            "links": {"restore": openapi_link("restore_mission", id="$request.path.id")},
        }
    },
)
async def delete_mission(service: Service, _: Planner, id: PlanId) -> Response:
    """Move a mission to the bin, and cancel a running evaluation of it."""
    await service.rooms.delete(id)
    await service.evaluations.cancel_for_mission(id)
    return Response(status_code=204)


@router.get("/bin", operation_id="list_bin", response_model=PlanList)
async def list_bin(service: Service, _: Viewer) -> Response:
    """Return a summary of each mission in the bin."""
    return json_response(PlanList(missions=tuple(await service.rooms.list_deleted())))


@router.post("/bin/{id}/restore", operation_id="restore_mission", response_model=PlanSummary)
async def restore_mission(service: Service, _: Planner, id: PlanId) -> Response:
    """Move a mission out of the bin."""
    room = await service.rooms.restore(id)
    return json_response(room.summary(), location=f"/api/missions/{id}")


@router.delete("/bin/{id}", operation_id="destroy_mission", status_code=204)
async def destroy_mission(service: Service, _: Planner, id: PlanId) -> Response:
    """Delete a mission in the bin for ever, with its evaluations."""
    await service.rooms.delete_from_bin(id)
    await service.evaluations.delete_for_mission(id)
    await service.orders.delete_for_mission(id)
    delete_import_notes(service.folder, id)
    return Response(status_code=204)


@router.get(
    "/missions/{id}/export/{format}",
    operation_id="export_mission",
    **file_route_arguments(
        "the file, or a zip archive if the format has several files",
        "application/octet-stream",
        "application/zip",
    ),
)
async def export_a_mission(
    service: Service,
    _: Viewer,
    id: PlanId,
    format: Annotated[
        str,
        Path(max_length=40, description="`script`, `json`, or a format of `argo export`"),
    ],
) -> Response:
    """Return the mission as `format` states: a script, JSON, or the format of another tool."""
    room = await service.rooms.open(id)
    document = room.document
    imported = (
        require_valid_mission(document, service.site)
        if format != "json"
        else unchecked_mission(document)
    )
    content, ending = await service.run_on_site(_export_file, imported, service.site, format)
    media = "application/zip" if ending == ".zip" else "application/octet-stream"
    file = re.sub(r"[^\w.-]+", "_", document.name).strip("._") or "mission"
    disposition = f"attachment; filename*=UTF-8''{quote(file + ending)}"
    return Response(content, 200, {"content-disposition": disposition}, media)


@router.get("/missions/{id}/revisions", operation_id="list_revisions", response_model=RevisionList)
async def list_revisions(
    service: Service, _: Viewer, id: PlanId, since: Annotated[int, Query(ge=1, le=10**12)]
) -> Response:
    """Return the revisions after the number `since`, none if it is the present one.

    404 if not all of them are known, or there is no revision `since` yet.
    """
    plan = (await service.rooms.open(id)).document.plan
    revisions = plan.revisions_after(since)
    if revisions is None:
        raise NotFound(
            Message(
                "the changes since revision {since} are not known: read the mission, which "
                "is at revision {revision}",
                since=since,
                revision=plan.revision,
            )
        )
    return json_response(RevisionList.model_construct(revisions=revisions), revision=plan.revision)


@router.get("/missions/{id}/notes", operation_id="read_notes", response_model=ImportNotes)
async def read_import_notes(service: Service, _: Viewer, id: PlanId) -> Response:
    """Return the notes of the mission's import, or of the last script that has replaced it.

    They are about words that were corrected, understood as something else, or have no effect.
    """
    await service.rooms.open(id)
    revision, notes = load_import_notes(service.folder, id)
    return json_response(ImportNotes(revision=revision, notes=notes))


@router.get(
    "/missions/{id}/imported-script",
    operation_id="read_imported_script",
    response_model=ImportedScript,
)
async def read_imported_script(service: Service, _: Viewer, id: PlanId) -> Response:
    """Return the script that the mission was imported from, or that has replaced it last.

    The places of tasks (`source`) are in this text. It is empty if there is none, or if the
    mission was replaced by another one since.
    """
    plan = (await service.rooms.open(id)).document.plan
    revision, text = load_imported_script(service.folder, id)
    since = plan.revisions_after(revision)
    if since is None or any(_replaces(one, revision) for one in since):
        return json_response(ImportedScript(revision=0, text=""))
    return json_response(ImportedScript(revision=revision, text=text))


def _replaces(later: Revision, imported: int) -> bool:
    """Return True if a later revision replaces the imported mission, or undoes its import."""
    return later.kind == "replace" or (later.reverts is not None and later.reverts <= imported)


def unchecked_mission(document: PlanDocument) -> ImportedMission:
    """Return the mission of a plan, with no diagnostics: it is not checked and may have errors."""
    return ImportedMission(document.plan.mission, document.name, (), ())


async def open_valid_plan(service: Service, id: str, made_on: int | None = None) -> PlanDocument:
    """Return a plan whose mission has no errors.

    Raises StaleRevision if the plan is no longer at the revision `made_on` (None: any revision),
    DiagnosticError if the mission has errors.
    """
    document = (await service.rooms.open(id)).document
    document.plan.require_newest(made_on)
    require_valid_mission(document, service.site)
    return document


def require_valid_mission(document: PlanDocument, site: OpenedSite) -> ImportedMission:
    """Return the mission of a plan, with no diagnostics: its warnings are left out.

    Raises DiagnosticError if the mission has errors.
    """
    if has_errors(diagnostics := check(document.plan.mission, site.catalog)):
        raise DiagnosticError(document.name, diagnostics)
    return unchecked_mission(document)


async def create_plan(
    service: Service,
    name: str,
    mission: Mission,
    notes: tuple[Diagnostic, ...] = (),
    script: str | None = None,
    folder: str = "",
) -> Response:
    """Create a mission, and return the response that has its summary.

    `notes` are those of its import, `script` the text that it was imported from, if any; `folder`
    is that of the list of missions.
    """
    require_within_limits(mission, mission_change(Mission(tasks=()), mission))
    room = await service.rooms.create(name, mission, folder)
    document = room.document
    if notes or script is not None:
        imported = (document.id, document.plan.revision, notes, script)
        await asyncio.to_thread(store_import_notes, service.folder, *imported)
    return json_response(
        room.summary(),
        201,
        revision=document.plan.revision,
        location=f"/api/missions/{document.id}",
    )


def _export_file(imported: ImportedMission, site: OpenedSite, format: str) -> tuple[bytes, str]:
    """Return the content of the exported file, and the ending of its name."""
    if format == "json":
        return imported.mission.model_dump_json(indent=2).encode(), ".json"
    if format == "script":
        return to_script(imported, site).encode(), ".txt"
    exported = export_mission(imported, site, format)
    content = exported.content
    if isinstance(content, Mapping):
        buffer = io.BytesIO()
        with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
            for path, part in sorted(content.items()):
                archive.writestr(zipfile.ZipInfo(path), part)
        return buffer.getvalue(), ".zip"
    return content.encode() if isinstance(content, str) else content, exported.suffix
