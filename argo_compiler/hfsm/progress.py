"""How far a mission has come, as data that can be written to a file and gone on from."""

from enum import StrEnum

from pydantic import Field

from argo_compiler.hfsm.events import Outcome
from argo_compiler.il import EventKind
from argo_compiler.model import Model


class GroupProgress(Model):
    """An active group: the round it is in, from 1, and the time on its clock (s)."""

    group: str
    round: int = Field(ge=1)
    elapsed: float = Field(ge=0)


class ValueProgress(Model):
    """The last value measured at a checkpoint and its age (s)."""

    object_id: str
    value: float
    age: float = Field(ge=0)


class EndedTask(Model):
    """A visit of a task that has ended, and why it failed for good if it did."""

    task: str
    failure: str | None = None
    by_hand: bool = False


class ByHand(Model):
    """What a person did in place of the machine's next visit of a task."""

    task: str
    value: float | None = None
    """what was read, for MEASURE"""
    duration: float = Field(default=0.0, ge=0)
    """s that it took, for the clocks of groups"""
    skipped: bool = False
    """left out, rather than done"""


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


class Progress(Model):
    """Where a mission stands. All times are relative, so that it can go on at any later time."""

    active: str | None
    """the task it stands at; None: nothing is left to do"""
    attempt: int = Field(default=0, ge=0)
    """how often the action has failed in this visit of the task"""
    groups: tuple[GroupProgress, ...] = ()
    """those that the active task lies in, outermost first"""
    values: tuple[ValueProgress, ...] = ()
    ended: tuple[EndedTask, ...] = ()
    """in order, once for each visit that has ended; a cancelled action has not"""
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
