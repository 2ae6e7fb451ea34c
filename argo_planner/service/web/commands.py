"""Routes for the commands to a mission, its script, its plain sentences and its analysis."""

import asyncio
from collections.abc import AsyncIterator
from typing import Annotated, Any

from fastapi import Response
from pydantic import Discriminator, Field

from argo_compiler.base.errors import NotFound
from argo_compiler.base.message import Message
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
from argo_planner.service.web.bodies import JsonBody
from argo_planner.service.web.missions import require_valid_mission
from argo_planner.service.web.problems import problem_responses
from argo_planner.service.web.requests import (
    MadeOn,
    PlanId,
    Planner,
    Service,
    Viewer,
    json_response,
    make_router,
)
from argo_planner.use_cases.explaining import explain_mission

MAX_SCRIPT_LENGTH = 1_000_000
"""in characters"""

router = make_router("commands", prefix="/api/missions/{id}")
COMMAND_RESPONSE: dict[str, Any] = {
    "response_model": CommandDone,
    "responses": problem_responses(412, 428),
}
"""arguments of a route that executes a command: its response, and its problems"""

AnyCommand = Annotated[EditPlan | UndoEdit | RedoEdit | ReplacePlan, Discriminator("kind")]


class ScriptGiven(Model):
    """A script whose mission replaces the present one."""

    id: CommandId
    script: str = Field(max_length=MAX_SCRIPT_LENGTH)


@router.post("/commands", operation_id="carry_out_command", **COMMAND_RESPONSE)
async def carry_out_command(
    service: Service,
    visitor: Planner,
    id: PlanId,
    command: JsonBody[AnyCommand],
    made_on: MadeOn,
) -> Response:
    """Execute a command. A command that is sent again with the same id is not executed again."""
    room = await service.rooms.open(id)
    return await execute_command(room, command, visitor.author, made_on)


@router.put("/script", operation_id="write_script", **COMMAND_RESPONSE)
async def write_script(
    service: Service,
    visitor: Planner,
    id: PlanId,
    given: JsonBody[ScriptGiven],
    made_on: MadeOn,
) -> Response:
    """Replace the mission by that of a script, as a command that can be undone."""
    room = await service.rooms.open(id)
    read = await service.scripts.import_upload("script", _parts(given.script), visitor.key)
    imported = read.require_mission()
    command = ReplacePlan.model_construct(
        id=given.id, mission=imported.mission, about=Message("a script")
    )
    answer = await execute_command(room, command, visitor.author, made_on)
    revision = room.document.plan.revision
    notes = (imported.diagnostics, given.script)
    await asyncio.to_thread(store_import_notes, service.folder, id, revision, *notes)
    return answer


@router.get("/reading", operation_id="read_back", response_model=MissionReading)
async def read_plain_sentences(service: Service, _: Viewer, id: PlanId) -> Response:
    """Return the mission in plain sentences, by task; the field `text` is a script made from it."""
    document = (await service.rooms.open(id)).document
    reading = await asyncio.to_thread(
        explain_mission, require_valid_mission(document, service.site), service.site
    )
    return json_response(reading, revision=document.plan.revision)


@router.get("/analysis", operation_id="read_analysis", response_model=AnalysisFound)
async def read_last_analysis(service: Service, _: Viewer, id: PlanId) -> Response:
    """Return the last analysis and its revision; 404 until the mission has been analysed."""
    room = await service.rooms.open(id)
    if room.last_analysis is None:
        raise NotFound("the mission has not been analysed yet: ask again in a moment")
    return json_response(room.last_analysis)


async def _parts(script: str) -> AsyncIterator[bytes]:
    yield script.encode(errors="replace")


async def execute_command(
    room: PlanRoom,
    command: PlanCommand,
    author: str,
    made_on: int | None,
    asked: ReplaceFrom | None = None,
) -> Response:
    """Execute a command in a room, and return the HTTP response with its result.

    The arguments and the errors are those of `PlanRoom.execute`.
    """
    done = await room.execute(command, author, made_on, asked)
    return json_response(done, revision=done.newest)
