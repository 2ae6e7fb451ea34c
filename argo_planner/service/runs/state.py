"""State of a run, and the messages that the service sends to its followers."""

from datetime import datetime
from enum import StrEnum
from typing import Annotated, Literal

from pydantic import Field

from argo_compiler.base.model import Model
from argo_compiler.base.wording import Text, Worded, Wording, wording_field
from argo_compiler.il import EventKind
from argo_env.run.log import Entry
from argo_env.run.record import Reading
from argo_env.run.verdict_line import Ending, Headline, Tone
from argo_planner.service.runs.requests import RequestState


class RunStatus(StrEnum):
    """Status of a run."""

    PREPARING = "preparing"
    """its process is starting and opens the site"""
    RUNNING = "running"
    INTERRUPTED = "interrupted"
    """its process or the service has died; on request it resumes from its journal, or stops"""
    ENDED = "ended"


class RunMode(StrEnum):
    """Control mode of a run: the mission or a person has the robot."""

    AUTONOMOUS = "autonomous"
    """the mission has the robot"""
    PAUSED = "paused"
    """the mission is paused; the robot stands still or is coming to a stop"""
    SUPERVISED = "supervised"
    """a person has the robot"""
    REACTING = "reacting"
    """the mission has the robot and reacts to an event"""


class TaskCount(Model):
    """Numbers of ended visits of a task, by their outcome."""

    task: str
    """name of the task"""
    done: int = 0
    failed: int = 0
    by_hand: int = 0
    """visits that a person has done or skipped"""


class RunState(Worded):
    """State of a run, as the service sends it to clients."""

    id: str
    plan: str
    """id of the mission plan"""
    revision: int
    """revision of the plan that is being run"""
    name: str
    """name of the mission"""
    by: str
    """author who started the run"""
    begun: datetime
    status: RunStatus
    drive: str
    sensor: str = "ideal"
    seed: int
    speed: float | None
    """simulated seconds per second; None: as fast as possible"""
    t: float = 0.0
    """simulated time, in s"""
    max_duration: float | None = None
    """time limit of the mission, in s; None: it has no limit"""
    mode: RunMode = RunMode.AUTONOMOUS
    moving: bool = False
    """whether an action is under way; after a request to pause, True until the robot has stopped"""
    task: str | None = None
    """name of the task whose action is under way; None: no action is"""
    by_hand: bool = False
    """whether a person has ordered that action"""
    reaction: EventKind | None = None
    """event that the mission is reacting to; None: it is not reacting"""
    rounds: dict[str, int] = Field(default_factory=dict)
    """current round of each group that the mission is in"""
    tasks: tuple[TaskCount, ...] = ()
    """counts for the tasks of which a visit has ended"""
    skipped: tuple[str, ...] = ()
    """tasks whose next visit a person has skipped; empty again after the robot is given back"""
    readings: tuple[Reading, ...] = ()
    """last reading of each checkpoint"""
    charge: float | None = None
    """charge of the battery, 0 to 1; None: no battery is simulated"""
    entries: int = 0
    """number of entries in the log"""
    requests: tuple[RequestState, ...] = ()
    """all pending requests and the latest settled ones"""
    headline: Headline | None = None
    """result of the run in a few words; None: it has not ended"""
    silent_since: float | None = None
    """simulated time in s since when a remote robot sends nothing; None: the robot is connected"""
    problem: Text | None = None
    """why the run was interrupted, or ended without being carried out or stopped properly"""
    problem_wording: Wording | None = wording_field("problem")


class RunSummary(Model):
    """Summary of a run, for lists."""

    id: str
    plan: str
    """id of the mission plan"""
    name: str
    """name of the mission when the run began"""
    by: str
    """author who started the run"""
    begun: datetime
    status: RunStatus
    drive: str
    t: float
    """simulated time, in s"""
    ending: Ending | None = None
    """how it ended; None: it has not ended, or without a result"""
    tone: Tone | None = None
    """how good that is; None like `ending`"""

    @staticmethod
    def from_state(state: RunState) -> "RunSummary":
        """Return the summary of a run in this state."""
        headline = state.headline
        return RunSummary(
            id=state.id,
            plan=state.plan,
            name=state.name,
            by=state.by,
            begun=state.begun,
            status=state.status,
            drive=state.drive,
            t=state.t,
            ending=headline and headline.ending,
            tone=headline and headline.tone,
        )


class LatestRuns(Model):
    """The latest runs of all missions, and the last run of each mission."""

    latest: tuple[RunSummary, ...]
    """the newest first"""
    by_mission: tuple[RunSummary, ...]
    """one run for each mission that was ever run"""


class EntryList(Model):
    """Entries of a run's log, in order."""

    count: int
    """number of entries in the whole log"""
    entries: tuple[Entry, ...]
    """requested part of the log"""


class EntryTold(Model):
    """Message with a new entry; followers get all of them."""

    kind: Literal["entry"] = "entry"
    run: str
    number: int = Field(ge=1)
    """number of the entry in the log, from 1"""
    entry: Entry


class PoseTold(Model):
    """Message with the robot's pose; followers may get only the newest one."""

    kind: Literal["pose"] = "pose"
    run: str
    t: float
    """simulated time, in s"""
    pose: tuple[float, float, float, float, float]
    """x, y, z (m), yaw, pitch (rad)"""
    charge: float | None
    """charge of the battery, 0 to 1; None: no battery is simulated"""


class StateTold(Model):
    """Message with the state of the run; followers may get only the newest one."""

    kind: Literal["state"] = "state"
    state: RunState | None
    """state of the current run; None: no run was ever started"""


class RequestTold(Model):
    """Message with the new state of a request."""

    kind: Literal["request"] = "request"
    run: str
    request: RequestState


RunMessage = Annotated[EntryTold | PoseTold | StateTold | RequestTold, Field(discriminator="kind")]
"""message to the followers of runs"""
