"""Progress of a mission, as data that can be written to a file and restored."""

from enum import StrEnum

from pydantic import Field

from argo_compiler.base.model import Model
from argo_compiler.hfsm.kinds import Outcome, ReadingKind
from argo_compiler.il import EventKind


class GroupProgress(Model):
    """Active group: its current round, from 1, and the time on its clock (s)."""

    group: str
    round: int = Field(ge=1)
    elapsed: float = Field(ge=0)
    counts_interruptions: bool = False
    """whether its clock runs during interruptions and time away"""


class ReadingProgress(Model):
    """Reading of a checkpoint, with its age (s)."""

    object_id: str
    kind: ReadingKind = ReadingKind.VALUE
    value: float | None = None
    """only for the kind VALUE"""
    abnormal: bool = False
    age: float = Field(ge=0)


class TaskTally(Model):
    """Numbers of ended visits of a task."""

    task: str
    done: int = Field(default=0, ge=0)
    """visits that the robot completed"""
    failed: int = Field(default=0, ge=0)
    """visits that failed for good"""
    by_hand: int = Field(default=0, ge=0)
    """visits that a person did or skipped"""


class ByHand(Model):
    """Task that a person did or skipped, in place of the machine's next visit of it."""

    task: str
    value: float | None = None
    """the value that was read, for MEASURE"""
    abnormal: bool = False
    """whether the value lies outside the checkpoint's nominal range"""
    duration: float = Field(default=0.0, ge=0)
    """s that it took, for the clocks of groups"""
    skipped: bool = False
    """whether it was skipped, rather than done"""
    age: float | None = Field(default=None, ge=0)
    """s since it was done; None: it is done when the robot is given back"""


class Phase(StrEnum):
    """Phase of a reaction: its drive or its hold."""

    DRIVING = "driving"
    HOLDING = "holding"


class Waiting(Model):
    """Reaction that waits: it has not started, or was interrupted and starts again."""

    event: EventKind
    over: bool = False
    """whether the event `until`, for which it would hold, has already occurred"""


class Reacting(Waiting):
    """The active reaction."""

    phase: Phase
    held: float = Field(default=0.0, ge=0)
    """HOLDING: s since the hold began"""


class Progress(Model):
    """Progress of a mission. All times are relative, so that it can continue at any later time."""

    active: str | None
    """the active task; None if nothing remains to be done"""
    attempt: int = Field(default=0, ge=0)
    """how often the action has failed in this visit of the task"""
    since: float = Field(default=0.0, ge=0)
    """s since this visit began"""
    occurred: bool = False
    """whether the event that this visit waits for has occurred"""
    round_of: str | None = None
    """the group whose next round starts with this visit and is not due yet, or was not due when the
    mission was interrupted; None if no round is awaited"""
    groups: tuple[GroupProgress, ...] = ()
    """the groups around the active task, outermost first"""
    readings: tuple[ReadingProgress, ...] = ()
    tallies: tuple[TaskTally, ...] = ()
    """of all tasks of which a visit has ended; a cancelled action ends no visit"""
    failed: bool = False
    """whether the mission can only end *completed with failures* (M3): a task that is not optional
    failed"""
    actions: int = Field(default=0, ge=0)
    """number of actions started so far, so that the ids of later ones differ"""
    elapsed: float = Field(default=0.0, ge=0)
    """s since the mission's start, interruptions included"""
    time_up: bool = False
    """whether TIME_UP has occurred"""
    paused: bool = False
    """whether the mission waits for a person to resume it"""
    reaction: Reacting | None = None
    waiting: tuple[Waiting, ...] = ()
    """in the order in which the events occurred"""
    outcome: Outcome | None = None
    """outcome of the mission; None if it has not ended"""
    by_hand: tuple[ByHand, ...] = ()
    """tasks done by hand whose visit the machine has not reached yet; those of the same task in
    order"""
