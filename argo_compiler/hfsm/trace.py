"""The trace: what a machine did, when and why."""

from dataclasses import dataclass
from typing import NamedTuple

from argo_compiler.hfsm.conditions import words
from argo_compiler.hfsm.kinds import Cause
from argo_compiler.hfsm.tables import CompiledTransition, LeafNode
from argo_compiler.il import Condition, EventKind

new_tuple = tuple.__new__
"""makes a NamedTuple in half the time of its own"""


@dataclass(frozen=True, slots=True)
class TraceEntry:
    """What happened at a time (s): the mission went from the task `source` to the task `target`.

    `source` is None at the start, `target` when the mission ends. What does not move the mission
    has the task at which it stands as both.
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
    """why the action of `source`, or of the reaction, failed, if it did"""
    event: EventKind | None = None
    """what occurred, for REPORT, REACTION, HOLD and what ends them"""
    by_hand: bool = False
    """whether `source` was done or skipped by a person"""
    skipped: bool = False
    """with `by_hand`: whether it was skipped"""
    detail: str = ""
    """more in words"""

    @property
    def why(self) -> str:
        """The cause in words, with the conditions, the group, the event or the failure."""
        why = str(self.cause)
        if self.conditions:
            why = " and ".join(self.conditions)
        if self.timed_out is not None:
            why = f"time of '{self.timed_out}' is up"
        if self.repeated is not None:
            again = f"another round of '{self.repeated}'"
            why = f"{why}, {again}" if self.timed_out is not None else again
        if self.event is not None:
            why += f": {self.event.replace('_', ' ')}"
        if self.detail:
            why += f" ({self.detail})"
        if self.by_hand:
            why += "; counts as done by hand: skipped" if self.skipped else "; done by hand"
        if self.failure is not None:
            why += f"; failed: {self.failure}"
        return why

    def __str__(self) -> str:
        return f"{self.time:g} s: {self.source or 'start'} -> {self.target or 'end'} ({self.why})"


class RawEntry(NamedTuple):
    """The fields of a `TraceEntry`, but that conditions are put in words later."""

    time: float
    source: str | None
    target: str | None
    cause: Cause
    conditions: tuple[Condition, ...] = ()
    timed_out: str | None = None
    repeated: str | None = None
    failure: str | None = None
    event: EventKind | None = None
    by_hand: bool = False
    skipped: bool = False
    detail: str = ""


KeptStep = tuple[float, LeafNode, LeafNode | None, CompiledTransition, str]
"""An entry as the executor stores it for most events: when a task ended well, the task, the next
one, the transition between them, and the detail."""


def raw_entry(kept: RawEntry | KeptStep) -> RawEntry:
    """Return the entry that was kept."""
    if isinstance(kept, RawEntry):
        return kept
    time, source, target, way, detail = kept
    return RawEntry(
        time,
        source.name,
        None if target is None else target.name,
        way.cause,
        way.conditions,
        repeated=None if way.repeats is None else way.repeats.name,
        detail=detail,
    )


def entry(kept: RawEntry | KeptStep) -> TraceEntry:
    """The entry that a person reads."""
    raw = raw_entry(kept)
    fields = raw._asdict() | {"conditions": tuple(map(words, raw.conditions))}
    return TraceEntry(**fields)
