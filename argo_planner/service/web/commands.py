"""Commands to a mission, its script, its reading and its analysis."""

import asyncio
from typing import Annotated, Any

from fastapi import Response
from pydantic import Discriminator, Field

from argo_compiler.base.errors import NotFound
from argo_compiler.base.model import Model
from argo_compiler.script.write.reading import MissionReading
from argo_planner.service.core.commands import (
    CommandId,
    EditPlan,
    PlanCommand,
    RedoEdit,
    ReplaceFrom,
    ReplacePlan,
    UndoEdit,
)
from argo_planner.service.jobs.analysis import AnalysisFound
from argo_planner.service.rooms.messages import CommandDone
from argo_planner.service.rooms.room import PlanRoom
from argo_planner.service.storage.import_notes import store_import_notes
from argo_planner.service.web.bodies import Sent
from argo_planner.service.web.missions import sound
from argo_planner.service.web.problems import documented
from argo_planner.service.web.requests import (
    MadeOn,
    PlanId,
    Planner,
    Service,
    Viewer,
    routes,
    said,
)
from argo_planner.use_cases.explaining import explain_mission
from argo_planner.use_cases.importing import Upload, import_mission

MOST_SCRIPT = 1_000_000
"""characters"""

router = routes("commands", prefix="/api/missions/{id}")
COMMAND: dict[str, Any] = {"response_model": CommandDone, "responses": documented(412, 428)}
"""how routes answer that carry out a command"""

AnyCommand = Annotated[EditPlan | UndoEdit | RedoEdit | ReplacePlan, Discriminator("kind")]


class ScriptGiven(Model):
    """A script in place of the mission."""

    id: CommandId
    script: str = Field(max_length=MOST_SCRIPT)


@router.post("/commands", operation_id="carry_out_command", **COMMAND)
async def carry_out_command(
    service: Service,
    visitor: Planner,
    id: PlanId,
    command: Sent[AnyCommand],
    made_on: MadeOn,
) -> Response:
    """Carries out a command. Sent again with the same id it does nothing twice."""
    room = await service.rooms.open(id)
    return await carried_out(room, command, visitor.author, made_on)


@router.put("/script", operation_id="write_script", **COMMAND)
async def write_script(
    service: Service,
    visitor: Planner,
    id: PlanId,
    given: Sent[ScriptGiven],
    made_on: MadeOn,
) -> Response:
    """Puts what a script says in place of the mission, as a command that can be undone."""
    room = await service.rooms.open(id)
    upload = Upload("script", given.script.encode(errors="replace"))
    imported = await asyncio.to_thread(import_mission, upload, service.site)
    command = ReplacePlan.model_construct(id=given.id, mission=imported.mission, about="a script")
    answer = await carried_out(room, command, visitor.author, made_on)
    revision = room.document.plan.revision
    await asyncio.to_thread(store_import_notes, service.folder, id, revision, imported.diagnostics)
    return answer


@router.get("/reading", operation_id="read_back", response_model=MissionReading)
async def read_back(service: Service, _: Viewer, id: PlanId) -> Response:
    """The mission in plain sentences, task by task; `text` is a script that gives the same."""
    document = (await service.rooms.open(id)).document
    reading = await asyncio.to_thread(explain_mission, sound(document, service.site), service.site)
    return said(reading, revision=document.plan.revision)


@router.get("/analysis", operation_id="read_analysis", response_model=AnalysisFound)
async def read_analysis(service: Service, _: Viewer, id: PlanId) -> Response:
    """What the analysis has found last, and of which revision; 404 until there is one."""
    room = await service.rooms.open(id)
    if room.analysis is None:
        raise NotFound("the mission has not been analysed yet: ask again in a moment")
    return said(room.analysis)


async def carried_out(
    room: PlanRoom,
    command: PlanCommand,
    author: str,
    made_on: int | None,
    asked: ReplaceFrom | None = None,
) -> Response:
    """The answer to a command. Raises what `PlanRoom.execute` raises."""
    done = await room.execute(command, author, made_on, asked)
    return said(done, revision=done.newest)
