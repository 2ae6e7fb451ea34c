"""What people ask of a run, as data, and how far each request is."""

from collections.abc import Iterable
from enum import StrEnum
from typing import Annotated, Literal

from pydantic import Discriminator, Field

from argo_compiler.base.errors import Conflict, NotFound
from argo_compiler.base.model import Model, Pose
from argo_compiler.il import EventKind, Mission
from argo_env.faults.kinds import AnyFault
from argo_planner.service.core.commands import CommandId
from argo_planner.service.world.obstacles import Obstacle

MOST_TOLD = 50
"""of the requests that are over, in the state of a run"""
SLOWEST, FASTEST = 0.1, 1_000.0
"""simulated seconds a second"""

Speed = Annotated[float, Field(ge=SLOWEST, le=FASTEST)] | None
"""simulated seconds a second; None: as fast as possible"""


class RunOrder(Model):
    """A run that is to be begun."""

    plan: str
    """id of the mission"""
    revision: int
    name: str
    """of the mission, for people"""
    mission: Mission
    site: str
    """what opens it"""
    drive: str = "kinematic"
    sensor: str = "ideal"
    seed: int = Field(default=0, ge=0, le=2**31)
    values: dict[int, float] = Field(default_factory=dict)
    """what checkpoints show, where it is not drawn"""
    faults: tuple[AnyFault, ...] = ()
    obstacles: tuple[Obstacle, ...] = ()
    """that stand on the site"""
    speed: Speed = 1.0


class RequestProgress(StrEnum):
    """How far a request is."""

    ACCEPTED = "accepted"
    """it is on its way to the robot"""
    UNDER_WAY = "under way"
    """the robot has it, and is not yet where it asks for"""
    CONFIRMED = "confirmed"
    """it is so"""
    REFUSED = "refused"
    """nothing was changed"""
    FAILED = "failed"
    """it was begun, and did not come to its end"""


class RequestState(Model):
    """A request, and how far it is."""

    id: CommandId
    kind: str
    by: str
    progress: RequestProgress
    reason: str | None = None
    """of a refusal or a failure, or why a run that was to stop ended otherwise"""

    @property
    def over(self) -> bool:
        return self.progress not in (RequestProgress.ACCEPTED, RequestProgress.UNDER_WAY)


class _Request(Model):
    id: CommandId


class PauseRun(_Request):
    """The mission stands still; confirmed when nothing moves any more. During a pause it changes
    nothing; while a person has the robot it is refused."""

    kind: Literal["pause"] = "pause"


class GoOnWithRun(_Request):
    """The mission goes on after a pause; or the run, as it stood, after its process has died."""

    kind: Literal["go_on"] = "go_on"


class EndRun(_Request):
    """The run ends here, whatever it is doing, also where it is interrupted."""

    kind: Literal["stop"] = "stop"


class CancelMission(_Request):
    """The mission ends; the action under way cleans up first."""

    kind: Literal["cancel"] = "cancel"


class TakeRobot(_Request):
    """A person takes the robot over; confirmed when it stands still."""

    kind: Literal["take_over"] = "take_over"


class GiveRobotBack(_Request):
    """The person gives the robot back: what was done by hand or skipped is passed over. The mission
    goes on, also where it was paused before they took over."""

    kind: Literal["give_back"] = "give_back"


class DoTask(_Request):
    """By hand: a task of the mission."""

    kind: Literal["do_task"] = "do_task"
    task: str


class DriveTo(_Request):
    """By hand: to a place."""

    kind: Literal["drive_to"] = "drive_to"
    pose: Pose


class MeasureAt(_Request):
    """By hand: a checkpoint."""

    kind: Literal["measure"] = "measure"
    checkpoint: str


class StopByHandNow(_Request):
    """What the robot does by hand is stopped; confirmed when it stands still."""

    kind: Literal["stop_by_hand"] = "stop_by_hand"


class SkipTask(_Request):
    """The next visit of a task is left out; it counts when the robot is given back. A task is
    skipped once until then."""

    kind: Literal["skip"] = "skip"
    task: str


class ChangeSpeed(_Request):
    """How fast the simulation goes."""

    kind: Literal["speed"] = "speed"
    speed: Speed


class TellEvent(_Request):
    """Something has happened that the mission may react to."""

    kind: Literal["event"] = "event"
    event: EventKind
    detail: str = Field(default="", max_length=1_000)


class TellReading(_Request):
    """Somebody tells what a checkpoint shows."""

    kind: Literal["reading"] = "reading"
    checkpoint: str
    value: float


class BeginFault(_Request):
    """Something goes wrong from now on, in the simulation."""

    kind: Literal["fault"] = "fault"
    fault: AnyFault


class GoOnEdited(_Request):
    """The person gives the robot back, and the run goes on with the mission as edited."""

    kind: Literal["go_on_edited"] = "go_on_edited"
    mission: Mission
    revision: int
    """of the plan"""


AskedOfRun = Annotated[
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
"""what clients can ask of a run, told apart by `kind`"""

RunRequest = AskedOfRun | GoOnEdited


class RequestBook:
    """The requests to one run, by their ids. Holds how far each is."""

    def __init__(self, run: str, requests: Iterable[RequestState] = ()) -> None:
        self._run = run
        self._requests = {request.id: request for request in requests}

    def of(self, id: str) -> RequestState:
        """Raises NotFound."""
        if id not in self._requests:
            raise NotFound(f"run {self._run} has had no request {id[:64]!r}")
        return self._requests[id]

    def known(self, request: RunRequest, by: str) -> RequestState | None:
        """How far a request is that is sent again. Raises Conflict if another one has its id."""
        known = self._requests.get(request.id)
        if known is not None and (known.kind, known.by) != (request.kind, by):
            raise Conflict(f"another request has had the id {request.id}: give each its own")
        return known

    def note(self, request: RequestState) -> None:
        """A request has come, or come further."""
        self._requests[request.id] = request

    def forget(self, id: str) -> None:
        """A request was not taken after all."""
        del self._requests[id]

    @property
    def pending(self) -> tuple[RequestState, ...]:
        """Those that are not over, in the order in which they came."""
        return tuple(one for one in self._requests.values() if not one.over)

    def told(self, news: Iterable[RequestState] = ()) -> tuple[RequestState, ...]:
        """Those that are not over, and the last ones that are, with the news of some of them."""
        requests = (self._requests | {one.id: one for one in news}).values()
        over = [one.id for one in requests if one.over]
        old = set(over[: max(0, len(over) - MOST_TOLD)])
        return tuple(one for one in requests if one.id not in old)
