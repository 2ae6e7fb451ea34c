"""Trace of a machine: its changes, with their times and causes."""

from dataclasses import dataclass
from typing import NamedTuple

from argo_compiler.hfsm.conditions import condition_text
from argo_compiler.hfsm.kinds import Cause
from argo_compiler.hfsm.tables import CompiledTransition, LeafNode
from argo_compiler.il import Condition, EventKind

new_tuple = tuple.__new__
"""creates a NamedTuple in half the time that its class needs"""


class TracedRound(NamedTuple):
    """Round of a group that begins, or that is awaited because it is not due yet."""

    group: str
    number: int
    """from 1"""
    due: float | None
    """time (s) at which it is due, or was; None for a group without `every`"""
    awaited: bool
    """whether it is awaited: an entry with the cause ROUND follows when it begins"""


@dataclass(frozen=True, slots=True)
class TraceEntry:
    """Entry of the trace: at a time (s), the mission went from task `source` to task `target`.

    `source` is None at the start, `target` at the end of the mission. If the mission stays at its
    task, both are that task.
    """

    time: float
    source: str | None
    target: str | None
    cause: Cause
    conditions: tuple[str, ...] = ()
    """the conditions that were satisfied, for CONDITION"""
    timed_out: str | None = None
    """the group whose time was up, for TIMEOUT"""
    repeated: str | None = None
    """the group that started another round, for REPEAT and perhaps TIMEOUT"""
    left: tuple[str, ...] = ()
    """the groups that were left, innermost first; some may have been entered again at once"""
    rounds: tuple[TracedRound, ...] = ()
    """the rounds of groups that begin or are awaited, outermost first; for RESTORE, those that
    continue. The groups inside an awaited round begin theirs together with it"""
    failure: str | None = None
    """why the action of `source` or of the reaction failed; None if it did not"""
    event: EventKind | None = None
    """the event of REPORT, REACTION, HOLD and the causes that end them"""
    by_hand: bool = False
    """whether a person did or skipped `source`"""
    skipped: bool = False
    """with `by_hand`: whether it was skipped"""
    detail: str = ""
    """further details, as text"""

    @property
    def why(self) -> str:
        """Cause of the entry as text, with the conditions, the group, the event or the failure."""
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
    """Fields of a `TraceEntry`, with conditions that are not yet converted to text."""

    time: float
    source: str | None
    target: str | None
    cause: Cause
    conditions: tuple[Condition, ...] = ()
    timed_out: str | None = None
    repeated: str | None = None
    left: tuple[str, ...] = ()
    rounds: tuple[TracedRound, ...] = ()
    failure: str | None = None
    event: EventKind | None = None
    by_hand: bool = False
    skipped: bool = False
    detail: str = ""


StoredStep = tuple[
    float, LeafNode, LeafNode | None, CompiledTransition, str, tuple[TracedRound, ...]
]
"""compact form in which the executor stores most entries: the time at which a task ended well, the
task, the next one, the transition between them, the detail, and the rounds that begin"""


def raw_entry(stored: RawEntry | StoredStep) -> RawEntry:
    """Return an entry of the trace with all its fields; its conditions are no text yet."""
    if isinstance(stored, RawEntry):
        return stored
    time, source, target, transition, detail, rounds = stored
    return RawEntry(
        time,
        source.name,
        None if target is None else target.name,
        transition.cause,
        transition.conditions,
        repeated=None if transition.repeats is None else transition.repeats.name,
        left=groups_left(source, transition),
        rounds=rounds,
        detail=detail,
    )


def groups_left(source: LeafNode, transition: CompiledTransition) -> tuple[str, ...]:
    """Return the names of the groups that a transition from a task leaves, innermost first."""
    kept = transition.kept_groups
    return tuple(group.name for group in source.groups_outward if group.depth >= kept)


def trace_entry(stored: RawEntry | StoredStep) -> TraceEntry:
    """Return an entry of the trace in the form for people, with its conditions as text."""
    raw = raw_entry(stored)
    fields = raw._asdict() | {"conditions": tuple(map(condition_text, raw.conditions))}
    return TraceEntry(**fields)
