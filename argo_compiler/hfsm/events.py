"""What goes into an executor and what comes out: events and commands."""

from dataclasses import dataclass
from typing import NamedTuple

from argo_compiler.hfsm.progress import ByHand
from argo_compiler.il import EventKind, Task


@dataclass(frozen=True, slots=True, init=False)
class ActionSucceeded:
    """The running action has ended well. `value`: what a MEASURE read, if it is a number.

    The `id` is that of the command which started the action. An end without one is taken for that
    of the action that runs, so a driver that may deliver an end twice gives it.
    """

    task: str
    value: float | None
    abnormal: bool
    """whether the value lies outside the checkpoint's nominal range"""
    id: int | None

    def __init__(
        self, task: str, value: float | None = None, abnormal: bool = False, id: int | None = None
    ) -> None:
        # Most events are of this kind; a frozen dataclass' own takes twice as long.
        _set_task(self, task)
        _set_value(self, value)
        _set_abnormal(self, abnormal)
        _set_id(self, id)


_set_task, _set_value, _set_abnormal, _set_id = (
    vars(ActionSucceeded)[name].__set__ for name in ("task", "value", "abnormal", "id")
)


@dataclass(frozen=True, slots=True)
class ActionFailed:
    """The running action has ended without its result: not reached, not measured."""

    task: str
    reason: str
    unreadable: bool = False
    """MEASURE: whether the robot looked at the checkpoint, and could not read a value"""
    id: int | None = None


@dataclass(frozen=True, slots=True)
class ActionStopped:
    """An action that was to be cancelled has ended, its clean-up done."""

    task: str
    id: int | None = None


@dataclass(frozen=True, slots=True)
class ReadingGiven:
    """Somebody else tells the value of a checkpoint, read now: an instrument, or a person."""

    object_id: str
    value: float
    abnormal: bool = False


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

    by_hand: tuple[ByHand, ...] = ()
    """what they did or skipped, in this order"""


@dataclass(frozen=True, slots=True)
class Cancel:
    """A person ends the mission."""


ActionEnded = ActionSucceeded | ActionFailed | ActionStopped
Event = ActionEnded | Tick | Occurred | ReadingGiven | Pause | Resume | TakeOver | GiveBack | Cancel


class StartAction(NamedTuple):
    """Carry out the task's action and report its end by an event."""

    task: Task
    id: int = 0
    """of this action, from 1; none is given twice in a run. The end of the action has it as well"""
    not_before: float | None = None
    """s on the executor's clock before which the robot does not begin at the place (W4)"""


@dataclass(frozen=True, slots=True)
class CancelAction:
    """Stop the action of the task, clean up, and report its end: it is awaited."""

    task: str
    reason: str
    id: int = 0
    """of the action"""


Command = StartAction | CancelAction
