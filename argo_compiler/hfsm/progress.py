"""How far a mission has come, as data that can be written to a file and gone on from."""

from enum import StrEnum

from pydantic import Field

from argo_compiler.base.model import Model
from argo_compiler.hfsm.kinds import Outcome, ReadingKind
from argo_compiler.il import EventKind


class GroupProgress(Model):
    """An active group: the round it is in, from 1, and the time on its clock (s)."""

    group: str
    round: int = Field(ge=1)
    elapsed: float = Field(ge=0)
    counts_interruptions: bool = False
    """whether time away is added to its clock"""


class ReadingProgress(Model):
    """The reading of a checkpoint and its age (s)."""

    object_id: str
    kind: ReadingKind = ReadingKind.VALUE
    value: float | None = None
    """of the kind VALUE"""
    abnormal: bool = False
    age: float = Field(ge=0)


class TaskTally(Model):
    """How often visits of a task have ended."""

    task: str
    done: int = Field(default=0, ge=0)
    """by the robot"""
    failed: int = Field(default=0, ge=0)
    """for good"""
    by_hand: int = Field(default=0, ge=0)
    """done or skipped by a person"""


class ByHand(Model):
    """What a person did in place of the machine's next visit of a task."""

    task: str
    value: float | None = None
    """what was read, for MEASURE"""
    abnormal: bool = False
    """whether the value lies outside the checkpoint's nominal range"""
    duration: float = Field(default=0.0, ge=0)
    """s that it took, for the clocks of groups"""
    skipped: bool = False
    """left out, rather than done"""
    age: float | None = Field(default=None, ge=0)
    """s ago that it was done; None: when the robot is given back"""


class Phase(StrEnum):
    """How far a reaction has come."""

    DRIVING = "driving"
    HOLDING = "holding"


class Waiting(Model):
    """A reaction whose turn has not come yet, or which was interrupted and begins anew."""

    event: EventKind
    over: bool = False
    """whether the event that it would hold for has occurred already"""


class Reacting(Waiting):
    """The reaction under way."""

    phase: Phase
    held: float = Field(default=0.0, ge=0)
    """HOLDING: s that it has held"""


class Progress(Model):
    """Where a mission stands. All times are relative, so that it can go on at any later time."""

    active: str | None
    """the task it stands at; None: nothing is left to do"""
    attempt: int = Field(default=0, ge=0)
    """how often the action has failed in this visit of the task"""
    since: float = Field(default=0.0, ge=0)
    """s since this visit began"""
    occurred: bool = False
    """whether the event that this visit waits for has occurred"""
    round_of: str | None = None
    """the group whose round begins with this visit and is not due yet, or was not when the mission
    was interrupted; None: no round has to be waited for"""
    groups: tuple[GroupProgress, ...] = ()
    """those that the active task lies in, outermost first"""
    readings: tuple[ReadingProgress, ...] = ()
    tallies: tuple[TaskTally, ...] = ()
    """of all tasks of which a visit has ended; a cancelled action has not ended one"""
    failed: bool = False
    """whether a failure counts as one of the mission (M3)"""
    actions: int = Field(default=0, ge=0)
    """how many have been started, so that none of those that follow has the id of one of them"""
    elapsed: float = Field(default=0.0, ge=0)
    """s since the mission's start, interruptions included"""
    time_up: bool = False
    """whether TIME_UP has occurred"""
    paused: bool = False
    """whether a person has to let it go on"""
    reaction: Reacting | None = None
    waiting: tuple[Waiting, ...] = ()
    """in the order in which the events occurred"""
    outcome: Outcome | None = None
    """None: it has not ended"""
    by_hand: tuple[ByHand, ...] = ()
    """what a person did and the machine has not come to yet; of one task in order"""
