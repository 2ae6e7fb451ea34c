"""What goes into an executor and what comes out: events and commands."""

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

from argo_compiler.il import EventKind, Task

if TYPE_CHECKING:  # progress tells an outcome, which is defined here
    from argo_compiler.hfsm.progress import ByHand


@dataclass(frozen=True, slots=True)
class ActionSucceeded:
    """The running action has ended well. `value`: what a MEASURE read, if it is a number."""

    task: str
    value: float | None = None


@dataclass(frozen=True, slots=True)
class ActionFailed:
    """The running action has ended without its result: not reached, not measured."""

    task: str
    reason: str


@dataclass(frozen=True, slots=True)
class ActionStopped:
    """An action that was to be cancelled has ended, its clean-up done."""

    task: str


@dataclass(frozen=True, slots=True)
class Tick:
    """Nothing but the passing of time."""


@dataclass(frozen=True, slots=True)
class Occurred:
    """Something has happened that the mission may react to."""

    event: EventKind
    detail: str = ""
    """for people: where, how much"""


@dataclass(frozen=True, slots=True)
class Pause:
    """A person pauses the mission."""


@dataclass(frozen=True, slots=True)
class Resume:
    """A person lets the mission go on, or ends a hold."""


@dataclass(frozen=True, slots=True)
class TakeOver:
    """A person takes the robot over: the mission pauses under supervision."""


@dataclass(frozen=True, slots=True)
class GiveBack:
    """A person gives the robot back, and the mission goes on as it would from a progress that was
    handed over with this."""

    by_hand: "tuple[ByHand, ...]" = ()
    """what they did or skipped, in this order"""


@dataclass(frozen=True, slots=True)
class Cancel:
    """A person ends the mission."""


ActionEnded = ActionSucceeded | ActionFailed | ActionStopped
Event = ActionEnded | Tick | Occurred | Pause | Resume | TakeOver | GiveBack | Cancel


@dataclass(frozen=True, slots=True)
class StartAction:
    """Carry out the task's action and report its end by an event."""

    task: Task


@dataclass(frozen=True, slots=True)
class CancelAction:
    """Stop the action of the task, clean up, and report its end: it is awaited."""

    task: str
    reason: str


Command = StartAction | CancelAction


class Outcome(StrEnum):
    """How a mission has ended."""

    COMPLETED = "completed"
    """all was done that the plan asked for"""
    RETURNED = "returned"
    """at the dock, after a failure or an event"""
    SHELTERED = "sheltered"
    """in a safe area, after an event"""
    FAILED = "failed"
    """the way to the dock or to a safe area failed as well"""
    ABORTED = "aborted"
    """where the robot stood, after a failure or an event"""
    CANCELLED = "cancelled"
    """by a person"""
