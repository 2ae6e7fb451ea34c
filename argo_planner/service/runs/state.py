"""How a run stands, and what those who follow it are told."""

from datetime import datetime
from enum import StrEnum
from typing import Annotated, Literal

from pydantic import Field

from argo_compiler.base.model import Model
from argo_compiler.il import EventKind
from argo_env.run.log import Entry
from argo_env.run.record import Reading
from argo_env.run.verdict_line import Headline
from argo_planner.service.runs.requests import RequestState


class RunStatus(StrEnum):
    """How far a run is."""

    PREPARING = "preparing"
    """its process begins, and opens the site"""
    RUNNING = "running"
    INTERRUPTED = "interrupted"
    """its process has died, or that of the service: it goes on from its journal, or stops, when it
    is asked to"""
    ENDED = "ended"


class RunMode(StrEnum):
    """Who has the robot."""

    AUTONOMOUS = "autonomous"
    """the mission"""
    PAUSED = "paused"
    """the mission, which stands still or is coming to a stop"""
    SUPERVISED = "supervised"
    """a person"""
    REACTING = "reacting"
    """the mission, which reacts to an event"""


class TaskCount(Model):
    """How often visits of a task have ended, and whether the next one is skipped."""

    task: str
    done: int = 0
    failed: int = 0
    by_hand: int = 0
    """done or skipped by a person"""


class RunState(Model):
    """A run as it stands."""

    id: str
    plan: str
    revision: int
    name: str
    by: str
    """who began it"""
    begun: datetime
    status: RunStatus
    drive: str
    sensor: str = "ideal"
    seed: int
    speed: float | None
    """simulated seconds a second; None: as fast as possible"""
    t: float = 0.0
    """s of simulated time"""
    max_duration: float | None = None
    """s"""
    mode: RunMode = RunMode.AUTONOMOUS
    moving: bool = False
    """whether an action is under way; a robot that is told to pause moves until it has stopped"""
    task: str | None = None
    """whose action is under way"""
    by_hand: bool = False
    """whether a person lets the robot do that"""
    reaction: EventKind | None = None
    rounds: dict[str, int] = Field(default_factory=dict)
    """of the groups that the mission is in"""
    tasks: tuple[TaskCount, ...] = ()
    """those of which a visit has ended"""
    skipped: tuple[str, ...] = ()
    """tasks whose next visit a person has skipped, until the robot is given back"""
    readings: tuple[Reading, ...] = ()
    """the last one of each checkpoint"""
    charge: float | None = None
    """of the battery, 0 to 1"""
    entries: int = 0
    """how many there are"""
    requests: tuple[RequestState, ...] = ()
    """that are not over, and the last ones that are"""
    headline: Headline | None = None
    """how it went, once it has ended"""
    silent_since: float | None = None
    """s of the run, since when nothing was heard of a robot that is somewhere else; None: it is
    heard"""
    problem: str | None = None
    """why it was interrupted, or has ended without having been carried out or stopped properly"""


class EntryList(Model):
    """What has happened in a run, in order."""

    count: int
    """of all there are by now"""
    entries: tuple[Entry, ...]


class EntryTold(Model):
    """Something has happened; none of these is ever left out."""

    kind: Literal["entry"] = "entry"
    run: str
    number: int = Field(ge=1)
    """from 1 on, the same in each telling"""
    entry: Entry


class PoseTold(Model):
    """Where the robot is; only the newest one counts."""

    kind: Literal["pose"] = "pose"
    run: str
    t: float
    """s"""
    pose: tuple[float, float, float, float, float]
    """x, y, z (m), yaw, pitch (rad)"""
    charge: float | None
    """of the battery, 0 to 1"""


class StateTold(Model):
    """How the run stands; only the newest one counts."""

    kind: Literal["state"] = "state"
    state: RunState | None
    """None: there is no run, and there was none"""


class RequestTold(Model):
    """A request has come further."""

    kind: Literal["request"] = "request"
    run: str
    request: RequestState


RunMessage = Annotated[EntryTold | PoseTold | StateTold | RequestTold, Field(discriminator="kind")]
"""all that those who follow runs are told"""
