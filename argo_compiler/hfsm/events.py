"""Inputs and outputs of an executor: events and commands."""

from dataclasses import dataclass
from typing import NamedTuple

from argo_compiler.hfsm.kinds import ReadingKind
from argo_compiler.hfsm.progress import ByHand
from argo_compiler.il import EventKind, Task


@dataclass(frozen=True, slots=True, init=False)
class ActionSucceeded:
    """Success of the running action. `value`: the value that a MEASURE read, None if it read none.

    `id` is that of the command which started the action. Without an id the event counts for the
    action that runs, so a driver that may deliver an event twice must give the id.
    """

    task: str
    value: float | None
    abnormal: bool
    """whether the value lies outside the checkpoint's nominal range"""
    id: int | None

    def __init__(
        self, task: str, value: float | None = None, abnormal: bool = False, id: int | None = None
    ) -> None:
        # Most events are of this class; the __init__ of a frozen dataclass takes twice as long.
        _set_task(self, task)
        _set_value(self, value)
        _set_abnormal(self, abnormal)
        _set_id(self, id)


_set_task, _set_value, _set_abnormal, _set_id = (
    vars(ActionSucceeded)[name].__set__ for name in ("task", "value", "abnormal", "id")
)


@dataclass(frozen=True, slots=True)
class ActionFailed:
    """Failure of the running action: it has ended without its result.

    The robot did not reach the target, or did not get a measurement.
    """

    task: str
    reason: str
    unreadable: bool = False
    """MEASURE only: whether the robot looked at the checkpoint, but could not read a value"""
    id: int | None = None
    unreachable: bool = False
    """MEASURE only: whether the robot could not get to a pose from which it measures; not together
    with `unreadable`"""

    @property
    def reading_kind(self) -> ReadingKind:
        """Kind of the reading that a MEASURE has if it has failed for good in this way."""
        if self.unreadable:
            return ReadingKind.UNREADABLE
        return ReadingKind.UNREACHABLE if self.unreachable else ReadingKind.FAILED


@dataclass(frozen=True, slots=True)
class ActionStopped:
    """End of an action after its cancellation, with its clean-up done."""

    task: str
    id: int | None = None


@dataclass(frozen=True, slots=True)
class ReadingGiven:
    """Value of a checkpoint from another source, an instrument or a person, read now."""

    object_id: str
    value: float
    abnormal: bool = False


@dataclass(frozen=True, slots=True)
class Tick:
    """Passing of time, without any other event."""


@dataclass(frozen=True, slots=True)
class Occurred:
    """Event that the mission may react to."""

    event: EventKind
    detail: str = ""
    """details for people: where, how much"""


@dataclass(frozen=True, slots=True)
class Pause:
    """Command of a person: pause the mission."""


@dataclass(frozen=True, slots=True)
class Resume:
    """Command of a person: resume the mission, or end a hold."""


@dataclass(frozen=True, slots=True)
class TakeOver:
    """Command of a person: take over the robot. The mission pauses under supervision."""


@dataclass(frozen=True, slots=True)
class GiveBack:
    """Command of a person: give the robot back. The mission resumes.

    It continues as if it were restored from a progress to which `hand_over` added `by_hand`.
    """

    by_hand: tuple[ByHand, ...] = ()
    """tasks that the person did or skipped, in this order"""


@dataclass(frozen=True, slots=True)
class Cancel:
    """Command of a person: end the mission."""


ActionEnded = ActionSucceeded | ActionFailed | ActionStopped
Event = ActionEnded | Tick | Occurred | ReadingGiven | Pause | Resume | TakeOver | GiveBack | Cancel


class StartAction(NamedTuple):
    """Command to execute the task's action and to report its end by an event."""

    task: Task
    id: int = 0
    """id of this action, from 1, unique within a run; the event of the action's end has the same
    id"""
    not_before: float | None = None
    """time (s, executor's clock) before which the robot must not begin the work at the target
    (W4)"""


@dataclass(frozen=True, slots=True)
class CancelAction:
    """Command to stop the task's action, clean up and report its end.

    The executor waits for that end.
    """

    task: str
    reason: str
    id: int = 0
    """id of the action to cancel"""


Command = StartAction | CancelAction
