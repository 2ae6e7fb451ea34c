"""Requests that people make to a run, and the states of these requests."""

from collections.abc import Iterable
from enum import StrEnum
from typing import Annotated, Literal

from pydantic import Discriminator, Field

from argo_compiler.base.errors import Conflict, NotFound
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model, Pose
from argo_compiler.base.wording import Text, Worded, Wording, wording_field
from argo_compiler.il import EventKind, Mission
from argo_env.faults.kinds import AnyFault
from argo_planner.service.core.commands import CommandId
from argo_planner.service.world.obstacles import Obstacle

MOST_SETTLED = 50
"""settled requests that the state of a run lists, the latest ones"""
MIN_SPEED, MAX_SPEED = 0.1, 1_000.0
"""limits of the speed, in simulated seconds per second"""

Speed = Annotated[float, Field(ge=MIN_SPEED, le=MAX_SPEED)] | None
"""simulated seconds per second; None: as fast as possible"""


class RunOrder(Model):
    """Order to start a run, with all that the run depends on."""

    plan: str
    """id of the mission plan"""
    revision: int
    """revision of the mission plan"""
    name: str
    """name of the mission plan, for people"""
    mission: Mission
    site: str
    """reference that `open_site` takes"""
    drive: str = "kinematic"
    sensor: str = "ideal"
    seed: int = Field(default=0, ge=0, le=2**31)
    values: dict[int, float] = Field(default_factory=dict)
    """displayed values, by the numbers of the checkpoints; those of other checkpoints are drawn"""
    faults: tuple[AnyFault, ...] = ()
    obstacles: tuple[Obstacle, ...] = ()
    """obstacles on the site"""
    speed: Speed = 1.0


class RequestProgress(StrEnum):
    """Progress of a request."""

    ACCEPTED = "accepted"
    """the request is stored and is being sent to the run"""
    UNDER_WAY = "under way"
    """the run carries the request out, and it has not taken effect yet"""
    CONFIRMED = "confirmed"
    """the request has taken effect"""
    REFUSED = "refused"
    """the request was refused and has changed nothing"""
    FAILED = "failed"
    """the request was begun, but not completed"""


class RequestState(Worded):
    """State of a request."""

    id: CommandId
    kind: str
    by: str
    """author of the request"""
    subject: str = ""
    """task, checkpoint, event or kind of fault that the request names; empty: none"""
    progress: RequestProgress
    reason: Text | None = None
    """why the request was refused or has failed, or why a run that was to stop ended otherwise"""
    reason_wording: Wording | None = wording_field("reason")

    @property
    def over(self) -> bool:
        """True if the request is settled: confirmed, refused or failed."""
        return self.progress not in (RequestProgress.ACCEPTED, RequestProgress.UNDER_WAY)


class _Request(Model):
    id: CommandId
    """id that the client gives the request; a request that is sent again has the same id"""


class PauseRun(_Request):
    """Request to pause the mission, confirmed when the robot stands still.

    It has no effect during a pause, and is refused while a person has the robot.
    """

    kind: Literal["pause"] = "pause"


class GoOnWithRun(_Request):
    """Request to resume the mission after a pause, or the run after its process has died."""

    kind: Literal["go_on"] = "go_on"


class EndRun(_Request):
    """Request to end the run at once, whatever it is doing; an interrupted run ends as well."""

    kind: Literal["stop"] = "stop"


class CancelMission(_Request):
    """Request to cancel the mission; the action under way cleans up first."""

    kind: Literal["cancel"] = "cancel"


class TakeRobot(_Request):
    """Request to give the robot to a person, confirmed when the robot stands still."""

    kind: Literal["take_over"] = "take_over"


class GiveRobotBack(_Request):
    """Request to give the robot back to the mission.

    Visits that were done by hand or skipped are left out. The mission continues, even if it was
    paused before the person took over.
    """

    kind: Literal["give_back"] = "give_back"


class DoTask(_Request):
    """Request to carry out a task of the mission by hand."""

    kind: Literal["do_task"] = "do_task"
    task: str


class DriveTo(_Request):
    """Request to drive to a pose by hand."""

    kind: Literal["drive_to"] = "drive_to"
    pose: Pose


class MeasureAt(_Request):
    """Request to measure at a checkpoint by hand."""

    kind: Literal["measure"] = "measure"
    checkpoint: str


class StopByHandNow(_Request):
    """Request to stop the action by hand, confirmed when the robot stands still."""

    kind: Literal["stop_by_hand"] = "stop_by_hand"


class SkipTask(_Request):
    """Request to skip the next visit of a task, which takes effect when the robot is given back.

    Until then, a task can be skipped only once.
    """

    kind: Literal["skip"] = "skip"
    task: str


class ChangeSpeed(_Request):
    """Request to change the speed of the simulation."""

    kind: Literal["speed"] = "speed"
    speed: Speed


class TellEvent(_Request):
    """Request to report an event that the mission may react to."""

    kind: Literal["event"] = "event"
    event: EventKind
    detail: str = Field(default="", max_length=1_000)


class TellReading(_Request):
    """Request to enter the reading of a checkpoint."""

    kind: Literal["reading"] = "reading"
    checkpoint: str
    value: float


class BeginFault(_Request):
    """Request to begin a fault in the simulation."""

    kind: Literal["fault"] = "fault"
    fault: AnyFault


class GoOnEdited(_Request):
    """Request to give the robot back and to continue the run with the edited mission."""

    kind: Literal["go_on_edited"] = "go_on_edited"
    mission: Mission
    revision: int
    """revision of the mission plan"""


ClientRequest = Annotated[
    PauseRun
    | GoOnWithRun
    | EndRun
    | CancelMission
    | TakeRobot
    | GiveRobotBack
    | DoTask
    | DriveTo
    | MeasureAt
    | StopByHandNow
    | SkipTask
    | ChangeSpeed
    | TellEvent
    | TellReading
    | BeginFault,
    Discriminator("kind"),
]
"""request that clients can send to a run; `kind` distinguishes them"""

RunRequest = ClientRequest | GoOnEdited
"""any request to a run"""


def request_subject(request: RunRequest) -> str:
    """Return the task, checkpoint, event or kind of fault that a request names; empty: none."""
    match request:
        case DoTask() | SkipTask():
            return request.task
        case MeasureAt() | TellReading():
            return request.checkpoint
        case TellEvent():
            return request.event
        case BeginFault():
            return str(request.fault.kind)
    return ""


class RequestBook:
    """The latest states of the requests to one run, by their ids."""

    def __init__(self, run: str, requests: Iterable[RequestState] = ()) -> None:
        self._run = run
        self._requests = {request.id: request for request in requests}

    def find(self, id: str) -> RequestState:
        """Return the state of a request; raises NotFound if there is no such request."""
        if id not in self._requests:
            raise NotFound(
                Message("run {run} has no request {id}", run=self._run, id=repr(id[:64]))
            )
        return self._requests[id]

    def find_repeated(self, request: RunRequest, by: str) -> RequestState | None:
        """Return the state of a request that is sent again; None if the request is new.

        Raises Conflict if the id belongs to a request of another kind or author.
        """
        known = self._requests.get(request.id)
        if known is not None and (known.kind, known.by) != (request.kind, by):
            raise Conflict(
                Message(
                    "another request has used the id {id}: give each request an id of its own",
                    id=request.id,
                )
            )
        return known

    def update(self, request: RequestState) -> None:
        """Add a request, or replace its state."""
        self._requests[request.id] = request

    def remove(self, id: str) -> None:
        """Remove a request that could not be accepted."""
        del self._requests[id]

    @property
    def pending(self) -> tuple[RequestState, ...]:
        """Requests that are not over, in the order in which they came."""
        return tuple(request for request in self._requests.values() if not request.over)

    def pending_and_latest(self, updates: Iterable[RequestState] = ()) -> tuple[RequestState, ...]:
        """Return all pending requests and at most MOST_SETTLED settled ones, the latest of these.

        All are in the order in which the requests came, which also decides which ones are the
        latest. In the result, `updates` replace the states in the book or are added to them; the
        book itself is not changed.
        """
        requests = (self._requests | {request.id: request for request in updates}).values()
        over = [request.id for request in requests if request.over]
        old = set(over[: max(0, len(over) - MOST_SETTLED)])
        return tuple(request for request in requests if request.id not in old)
