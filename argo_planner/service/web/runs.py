"""Runs: begun, asked, followed; and those that were."""

from collections.abc import Iterable, Sequence
from typing import Annotated

from fastapi import APIRouter, Path, Query, Response, WebSocket
from pydantic import Field

from argo_compiler.base.errors import Invalid, NotFound
from argo_compiler.base.model import Model
from argo_env.faults.kinds import AnyFault
from argo_env.report.files import PAGE, RECORD
from argo_env.run.drives_and_sensors import DRIVES, SENSORS
from argo_env.site import Site
from argo_planner.service.core.commands import CommandId
from argo_planner.service.runs.pictures import picture_of
from argo_planner.service.runs.requests import AskedOfRun, GoOnEdited, RequestState, RunOrder, Speed
from argo_planner.service.runs.state import EntryList, RunState
from argo_planner.service.runs.worker import REMOTE
from argo_planner.service.web.access import AccessRole
from argo_planner.service.web.bodies import Sent
from argo_planner.service.web.live import admitted, carry, socket_client
from argo_planner.service.web.missions import sound_plan
from argo_planner.service.web.problems import documented
from argo_planner.service.web.requests import (
    REPORT_POLICY,
    MadeOn,
    Operator,
    PlanId,
    PlanningService,
    Service,
    Viewer,
    answers_file,
    created,
    links,
    routes,
    said,
)

router = routes("runs")

RunId = Annotated[str, Path(pattern=r"^[0-9]{8}-[0-9]{6}-[0-9a-f]{4}$", description="of the run")]
_RUN = links("read_run", "ask_run", "list_entries", "read_report", run="$response.body#/id")
_REQUEST = links("read_request", run="$request.path.run", request="$response.body#/id")
MOST_ENTRIES = 1_000
"""in one answer"""


class RunAsked(Model):
    """How a mission is to be driven."""

    drive: str = Field(default="kinematic", max_length=40)
    sensor: str = Field(default="ideal", max_length=40)
    seed: int = Field(default=0, ge=0, le=2**31)
    values: dict[int, float] = Field(default_factory=dict, max_length=1_000)
    """what checkpoints show, by number, where it is not drawn"""
    faults: tuple[AnyFault, ...] = Field(default=(), max_length=100)
    speed: Speed = 1.0


class PlanGiven(Model):
    """A request that the run goes on with its mission as it is now."""

    id: CommandId


class RunList(Model):
    """Runs, the newest ones first."""

    runs: tuple[RunState, ...]


@router.post(
    "/missions/{id}/runs",
    operation_id="start_run",
    status_code=201,
    response_model=RunState,
    responses=documented(412, 428) | {201: created(RunState, _RUN)},
)
async def start_run(
    service: Service, visitor: Operator, id: PlanId, run: Sent[RunAsked], made_on: MadeOn
) -> Response:
    """Begins a run of the mission as it stands; 409 with who has the robot if there is one."""
    document = await sound_plan(service, id, made_on)
    plan = document.plan
    _require_known(run, service.site.site)
    order = RunOrder(
        plan=id,
        revision=plan.revision,
        name=document.name,
        mission=plan.mission,
        site=service.site.reference,
        obstacles=service.obstacles.present.obstacles,
        **dict(run),
    )
    state = await service.runs.start(order, visitor.author)
    return said(state, 201, location=f"/api/runs/{state.id}")


@router.get("/runs", operation_id="list_runs", response_model=RunList)
async def list_runs(service: Service, _: Viewer) -> Response:
    """The present run and those before it."""
    return said(RunList(runs=tuple(await service.runs.all())))


@router.get("/runs/{run}", operation_id="read_run", response_model=RunState)
async def read_run(service: Service, _: Viewer, run: RunId) -> Response:
    """How a run stands, or how it ended."""
    return said(await service.runs.read(run))


@router.post(
    "/runs/{run}/requests",
    operation_id="ask_run",
    status_code=202,
    response_model=RequestState,
    responses={202: created(RequestState, _REQUEST)},
)
async def ask_run(
    service: Service, visitor: Operator, run: RunId, request: Sent[AskedOfRun]
) -> Response:
    """Asks something of the present run. That it was accepted does not say that it is so: follow
    how far it is."""
    state = await service.runs.ask(run, request, visitor.author)
    return said(state, 202, location=f"/api/runs/{run}/requests/{state.id}")


@router.post(
    "/runs/{run}/plan",
    operation_id="go_on_edited",
    status_code=202,
    response_model=RequestState,
    responses=documented(412, 428),
)
async def go_on_edited(
    service: Service,
    visitor: Operator,
    run: RunId,
    given: Sent[PlanGiven],
    made_on: MadeOn,
) -> Response:
    """Gives the robot back, and lets the run go on with its mission as it was edited since."""
    plan = (await sound_plan(service, service.runs.of(run).plan, made_on)).plan
    request = GoOnEdited(id=given.id, mission=plan.mission, revision=plan.revision)
    asked = await service.runs.ask(run, request, visitor.author)
    return said(asked, 202, location=f"/api/runs/{run}/requests/{asked.id}")


@router.get(
    "/runs/{run}/requests/{request}", operation_id="read_request", response_model=RequestState
)
async def read_request(
    service: Service,
    _: Viewer,
    run: RunId,
    request: Annotated[str, Path(pattern=r"^[A-Za-z0-9._:-]{1,64}$")],
) -> Response:
    """How far a request to the present run is."""
    return said(service.runs.request(run, request))


@router.get("/runs/{run}/entries", operation_id="list_entries", response_model=EntryList)
async def list_entries(
    service: Service,
    _: Viewer,
    run: RunId,
    since: Annotated[int, Query(ge=0, le=10**9, description="so many are known")] = 0,
    most: Annotated[int, Query(ge=1, le=MOST_ENTRIES)] = MOST_ENTRIES,
) -> Response:
    """What has happened in a run."""
    return said(await service.runs.history(run, since, most))


@router.get(
    "/runs/{run}/report/{file}",
    operation_id="read_report",
    **answers_file("the file", "text/html", "application/json", "image/png"),
)
async def read_report(
    service: Service, _: Viewer, run: RunId, file: Annotated[str, Path(max_length=40)]
) -> Response:
    """A file of the report of a run that has ended: report.html, report.json or site.png."""
    media = {PAGE: "text/html", RECORD: "application/json", "site.png": "image/png"}
    if file not in media:
        raise NotFound(f"the report has no file {file!r}; it has: {', '.join(media)}")
    content = await service.runs.report(run, file)
    headers = REPORT_POLICY if file == PAGE else None
    return Response(content, media_type=media[file], headers=headers)


@router.get(
    "/runs/{run}/pictures/{checkpoint}/{milliseconds}",
    operation_id="read_picture",
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


socket_router = APIRouter()


@socket_router.websocket("/api/robot/live")
async def follow_robot(socket: WebSocket, since: Annotated[int | None, Query(ge=0)] = None) -> None:
    """How the present run stands, its entries after that number, then all that happens."""
    service: PlanningService = socket.app.state.service
    if not await admitted(socket):
        return
    client = socket_client()
    mailbox = service.runs.follow(client, since)
    try:
        await carry(socket, mailbox, lambda _: None)
    finally:
        service.runs.leave(client)


@socket_router.websocket("/api/robot/link")
async def connect_robot(socket: WebSocket) -> None:
    """The line of a robot that is somewhere else: it carries the messages of `argo_env.remote`."""
    service: PlanningService = socket.app.state.service
    if not await admitted(socket, AccessRole.OPERATE):
        return
    line = service.runs.robot.connect()
    try:
        await carry(socket, line, lambda text: service.runs.hear_robot(line, text))
    finally:
        service.runs.robot.disconnect(line)


def _require_known(run: RunAsked, site: Site) -> None:
    """Raises Invalid for drives, sensors and checkpoints that there are not, before anything
    begins."""
    checkpoints = [checkpoint.id for checkpoint in site.checkpoints]
    _require("drive", [run.drive], [*DRIVES, REMOTE])
    _require("sensor", [run.sensor], [*SENSORS])
    _require("values: checkpoint", run.values, checkpoints)


def _require(what: str, given: Iterable[object], known: Sequence[object]) -> None:
    if unknown := [f"`{one}`" for one in given if one not in known]:
        raise Invalid(
            f"{what} {', '.join(unknown)}: there is none; known: {', '.join(map(str, known))}"
        )
