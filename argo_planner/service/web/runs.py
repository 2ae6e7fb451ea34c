"""Routes for runs: start, control and follow them, read their reports, and connect a robot."""

from collections.abc import Iterable, Sequence
from typing import Annotated

from fastapi import APIRouter, Path, Query, Response, WebSocket
from pydantic import Field

from argo_compiler.base.errors import Invalid, NotFound
from argo_compiler.base.message import Listing, Message
from argo_compiler.base.model import Model
from argo_compiler.il import Mission
from argo_env.faults.kinds import AnyFault
from argo_env.planning.opening import OpenedSite
from argo_env.report.files import PAGE, RECORD
from argo_env.run.drives_and_sensors import REMOTE, ROUTE, SENSORS, drive_names
from argo_env.run.run_setup import check_spec
from argo_env.run.spec import RunSpec
from argo_env.site import Site
from argo_planner.service.core.commands import CommandId
from argo_planner.service.runs.pictures import picture_path
from argo_planner.service.runs.requests import (
    ClientRequest,
    GoOnEdited,
    RequestState,
    RunOrder,
    Speed,
)
from argo_planner.service.runs.state import EntryList, LatestRuns, RunState
from argo_planner.service.storage.stored_files import read_stored_bytes
from argo_planner.service.web.access import AccessRole
from argo_planner.service.web.bodies import JsonBody
from argo_planner.service.web.faults import require_faults_on_site
from argo_planner.service.web.live import accept_socket, exchange_messages, next_client_id
from argo_planner.service.web.missions import open_valid_plan
from argo_planner.service.web.problems import problem_responses
from argo_planner.service.web.requests import (
    REPORT_POLICY,
    MadeOn,
    Operator,
    PlanId,
    PlanningService,
    Service,
    Viewer,
    created_response,
    file_route_arguments,
    json_response,
    make_router,
    openapi_links,
)

router = make_router("runs")

RunId = Annotated[
    str, Path(pattern=r"^[0-9]{8}-[0-9]{6}-[0-9a-f]{4}$", description="id of the run")
]
_RUN = openapi_links("read_run", "ask_run", "list_entries", "read_report", run="$response.body#/id")
_REQUEST = openapi_links("read_request", run="$request.path.run", request="$response.body#/id")
MAX_ENTRIES = 1_000
"""maximum number of entries in one response"""


class RunAsked(Model):
    """Request for a run: its setup, the simulated world, and the speed."""

    drive: str = Field(default="kinematic", max_length=40)
    sensor: str = Field(default="ideal", max_length=40)
    seed: int = Field(default=0, ge=0, le=2**31)
    values: dict[int, float] = Field(default_factory=dict, max_length=1_000)
    """values of checkpoints, by number; the others are drawn at random"""
    faults: tuple[AnyFault, ...] = Field(default=(), max_length=100)
    speed: Speed = 1.0


class PlanGiven(Model):
    """Request that the run continues with the present revision of its mission."""

    id: CommandId


class RunList(Model):
    """Runs, the newest ones first."""

    runs: tuple[RunState, ...]


@router.post(
    "/missions/{id}/runs",
    operation_id="start_run",
    status_code=201,
    response_model=RunState,
    responses=problem_responses(412, 428) | {201: created_response(RunState, _RUN)},
)
async def start_run(
    service: Service, visitor: Operator, id: PlanId, run: JsonBody[RunAsked], made_on: MadeOn
) -> Response:
    """Start a run of the mission; 409 until the current run has ended, with who started it."""
    document = await open_valid_plan(service, id, made_on)
    plan = document.plan
    _require_known(run, service.site.site)
    await service.run_on_site(_require_possible, run, plan.mission, service.site)
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
    return json_response(state, 201, location=f"/api/runs/{state.id}")


@router.get("/runs", operation_id="list_runs", response_model=RunList)
async def list_runs(service: Service, _: Viewer) -> Response:
    """Return the states of all runs: the current run first, then the others, the newest first."""
    return json_response(RunList(runs=tuple(await service.runs.list_runs())))


@router.get("/runs/latest", operation_id="list_latest_runs", response_model=LatestRuns)
async def list_latest_runs(
    service: Service, _: Viewer, most: Annotated[int, Query(ge=1, le=100)] = 10
) -> Response:
    """Return summaries: of the latest runs of all missions, and of the last run of each."""
    return json_response(await service.runs.list_latest(most))


@router.get("/runs/{run}", operation_id="read_run", response_model=RunState)
async def read_run(service: Service, _: Viewer, run: RunId) -> Response:
    """Return the state of a run."""
    return json_response(await service.runs.read_state(run))


@router.post(
    "/runs/{run}/requests",
    operation_id="ask_run",
    status_code=202,
    response_model=RequestState,
    responses={202: created_response(RequestState, _REQUEST)},
)
async def send_request(
    service: Service, visitor: Operator, run: RunId, request: JsonBody[ClientRequest]
) -> Response:
    """Send a request to the current run.

    A request that was accepted is not done yet: read its progress.
    """
    state = await service.runs.send_request(run, request, visitor.author)
    return json_response(state, 202, location=f"/api/runs/{run}/requests/{state.id}")


@router.post(
    "/runs/{run}/plan",
    operation_id="go_on_edited",
    status_code=202,
    response_model=RequestState,
    responses=problem_responses(412, 428),
)
async def continue_with_edits(
    service: Service,
    visitor: Operator,
    run: RunId,
    given: JsonBody[PlanGiven],
    made_on: MadeOn,
) -> Response:
    """Request that the robot is given back and the run continues with the run's edited mission.

    A request that was accepted is not done yet: read its progress.
    """
    plan = (await open_valid_plan(service, service.runs.require_current(run).plan, made_on)).plan
    request = GoOnEdited(id=given.id, mission=plan.mission, revision=plan.revision)
    state = await service.runs.send_request(run, request, visitor.author)
    return json_response(state, 202, location=f"/api/runs/{run}/requests/{state.id}")


@router.get(
    "/runs/{run}/requests/{request}", operation_id="read_request", response_model=RequestState
)
async def read_request(
    service: Service,
    _: Viewer,
    run: RunId,
    request: Annotated[str, Path(pattern=r"^[A-Za-z0-9._:-]{1,64}$")],
) -> Response:
    """Return the progress of a request to the current run; 404 if `run` is another run."""
    return json_response(service.runs.find_request(run, request))


@router.get("/runs/{run}/entries", operation_id="list_entries", response_model=EntryList)
async def list_entries(
    service: Service,
    _: Viewer,
    run: RunId,
    since: Annotated[
        int, Query(ge=0, le=10**9, description="number of entries that the client has")
    ] = 0,
    most: Annotated[int, Query(ge=1, le=MAX_ENTRIES)] = MAX_ENTRIES,
) -> Response:
    """Return the entries of a run after the first `since`."""
    return json_response(await service.runs.list_entries(run, since, most))


@router.get(
    "/runs/{run}/report/{file}",
    operation_id="read_report",
    **file_route_arguments("the file", "text/html", "application/json", "image/png"),
)
async def read_run_report(
    service: Service, _: Viewer, run: RunId, file: Annotated[str, Path(max_length=40)]
) -> Response:
    """Return report.html, report.json or site.png of a run that has ended."""
    media = {PAGE: "text/html", RECORD: "application/json", "site.png": "image/png"}
    if file not in media:
        raise NotFound(
            Message(
                "the report has no file {file}; it has: {media}",
                file=repr(file),
                media=Listing(media),
            )
        )
    content = await service.runs.read_report_file(run, file)
    headers = REPORT_POLICY if file == PAGE else None
    return Response(content, media_type=media[file], headers=headers)


@router.get(
    "/runs/{run}/pictures/{checkpoint}/{milliseconds}",
    operation_id="read_picture",
    **file_route_arguments("the picture", "image/png"),
)
async def read_picture(
    service: Service,
    _: Viewer,
    run: RunId,
    checkpoint: Annotated[int, Path(ge=0, le=10**6, description="number of the checkpoint")],
    milliseconds: Annotated[int, Path(ge=0, le=10**12, description="`t` of the reading, in ms")],
) -> Response:
    """Return the picture of a reading; only the sensor `camera` takes pictures."""
    path = picture_path(service.runs.folder.run_path(run), checkpoint, milliseconds / 1000)
    try:
        content = read_stored_bytes(path)
    except OSError:
        raise NotFound(
            Message(
                "run {run} has no picture of checkpoint {checkpoint} at this time",
                run=run,
                checkpoint=checkpoint,
            )
        ) from None
    headers = {"cache-control": "private, max-age=31536000, immutable"}
    return Response(content, 200, headers, "image/png")


socket_router = APIRouter()


@socket_router.websocket("/api/robot/live")
async def follow_robot(socket: WebSocket, since: Annotated[int | None, Query(ge=0)] = None) -> None:
    """Send the state of the current run, its entries after the first `since`, then each event.

    Without `since`, all entries are sent.
    """
    service: PlanningService = socket.app.state.service
    if not await accept_socket(socket):
        return
    client = next_client_id()
    mailbox = service.runs.subscribe(client, since)
    try:
        await exchange_messages(socket, mailbox, lambda _: None)
    finally:
        service.runs.unsubscribe(client)


@socket_router.websocket("/api/robot/link")
async def connect_robot(socket: WebSocket) -> None:
    """Connect a remote robot: exchange the messages of `argo_env.remote`."""
    service: PlanningService = socket.app.state.service
    if not await accept_socket(socket, AccessRole.OPERATE):
        return
    mailbox = service.runs.robot.replace_connection()
    try:
        await exchange_messages(
            socket, mailbox, lambda text: service.runs.receive_from_robot(mailbox, text)
        )
    finally:
        service.runs.robot.disconnect(mailbox)


def _require_known(run: RunAsked, site: Site) -> None:
    """Raise Invalid for an unknown drive, sensor or checkpoint, before anything starts."""
    checkpoints = [checkpoint.id for checkpoint in site.checkpoints]
    _require_in("drive", [run.drive], [*drive_names(), REMOTE])
    _require_in("sensor", [run.sensor], [*SENSORS])
    _require_in("checkpoint", run.values, checkpoints)


def _require_possible(run: RunAsked, mission: Mission, site: OpenedSite) -> None:
    """Raise ArgoError, before anything starts, for a run that can't be made on the site."""
    spec = RunSpec(
        mission=mission,
        site=site.reference,
        drive=ROUTE if run.drive == REMOTE else run.drive,
        sensor=run.sensor,
        seed=run.seed,
        values=run.values,
        faults=run.faults,
    )
    require_faults_on_site(run.faults, site.site, run.seed)
    check_spec(spec, site.site)


def _require_in(what: str, given: Iterable[object], known: Sequence[object]) -> None:
    if unknown := [f"`{one}`" for one in given if one not in known]:
        raise Invalid(
            Message(
                "unknown {what} {unknown}: choose from {names}",
                what=what,
                unknown=Listing(unknown),
                names=Listing(map(str, known)),
            )
        )
