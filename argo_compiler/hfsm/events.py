"""What goes into an executor and what comes out: events, commands and the trace."""

from dataclasses import dataclass
from enum import StrEnum

from argo_compiler.il import Task


@dataclass(frozen=True, slots=True)
class ActionSucceeded:
    """The active task's action has ended well. `value`: what a MEASURE read, if it is a number."""

    task: str
    value: float | None = None


@dataclass(frozen=True, slots=True)
class ActionFailed:
    """The active task's action has ended without its result: not reached, not measured."""

    task: str
    reason: str


@dataclass(frozen=True, slots=True)
class Tick:
    """Nothing but the passing of time."""


Event = ActionSucceeded | ActionFailed | Tick


@dataclass(frozen=True, slots=True)
class StartAction:
    """Carry out the task's action and report its end by an event."""

    task: Task


@dataclass(frozen=True, slots=True)
class CancelAction:
    """Stop the action of the task; no event of it is to follow."""

    task_name: str


Command = StartAction | CancelAction


class Cause(StrEnum):
    """Why the machine went from one task to the next."""

    START = "start"
    RESUME = "resume"
    CONDITION = "condition"
    REPEAT = "repeat"
    DEFAULT = "default"
    TIMEOUT = "time out"


@dataclass(frozen=True, slots=True)
class TraceEntry:
    """One step of the machine at a time (s): from the task `source` to the task `target`.

    `source` is None at the start, `target` when the mission ends.
    """

    time: float
    source: str | None
    target: str | None
    cause: Cause
    conditions: tuple[str, ...] = ()
    """those that held, for CONDITION"""
    timed_out: str | None = None
    """the group whose time was up, for TIMEOUT"""
    repeated: str | None = None
    """the group that began another round, for REPEAT and perhaps TIMEOUT"""
    failure: str | None = None
    """why the action of `source` failed, if it did"""

    @property
    def why(self) -> str:
        """The cause in words, with the conditions, the group or the failure that it was."""
        why = str(self.cause)
        if self.conditions:
            why = " and ".join(self.conditions)
        if self.timed_out is not None:
            why = f"time of '{self.timed_out}' is up"
        if self.repeated is not None:
            again = f"another round of '{self.repeated}'"
            why = f"{why}, {again}" if self.timed_out is not None else again
        if self.failure is not None:
            why += f"; failed: {self.failure}"
        return why

    def __str__(self) -> str:
        return f"{self.time:g} s: {self.source or 'start'} -> {self.target or 'end'} ({self.why})"
