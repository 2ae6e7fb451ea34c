"""Conditions: what is asked of values, states and events, joined by and, or and not."""

from enum import StrEnum

from argo_compiler.il import EventKind
from argo_compiler.script.sentences.tree.node import Node, node
from argo_compiler.script.sentences.tree.nouns import Nouns


class TaskState(StrEnum):
    """What a reading may be."""

    NORMAL = "normal"
    ABNORMAL = "abnormal"
    UNREADABLE = "unreadable"
    UNREACHABLE = "unreachable"
    FAILED = "failed"
    STALE = "stale"


_FAILURES = (TaskState.FAILED, TaskState.UNREADABLE, TaskState.UNREACHABLE)


@node
class Amount(Node):
    """A value with the unit that is said with it, if one is."""

    value: float
    unit: str = ""


@node
class Bounded(Node):
    """`above 5 bar`, `between 2 and 3`; with one bound or two."""

    low: Amount | None = None
    high: Amount | None = None
    inclusive: bool
    """whether a value may be at a bound: `at least 5`, `from 2 to 3`"""

    @property
    def bounds(self) -> tuple[Amount, ...]:
        return tuple(bound for bound in (self.low, self.high) if bound is not None)


class ValvePosition(StrEnum):
    """Position of a valve."""

    OPEN = "open"
    HALF_OPEN = "half_open"
    CLOSED = "closed"


@node
class InState(Node):
    """`abnormal`, `unreadable`, `older than 60 s`, `open`."""

    state: TaskState | ValvePosition
    age: float | None = None
    """s, of STALE"""


Predicate = Bounded | InState


@node
class Test(Node):
    """What is asked of the checkpoints; of several joined by `or`, one has to be so."""

    subject: Nouns | None
    """None: what was measured last"""
    predicate: Predicate
    negated: bool = False
    general: bool = False
    """whether any of several may be meant: `if a reading fails`"""
    max_age: float | None = None
    """s"""
    id: str = ""
    second_bound: float | None = None
    """an upper bound that the comparison does not need, kept for the plan's sake"""

    @property
    def is_of_failure(self) -> bool:
        """Return True for a test of a failed task, whose result is known when the task ends."""
        return isinstance(self.predicate, InState) and self.predicate.state in _FAILURES


@node
class Occurs(Node):
    """`a gas leak is detected`. None: which of two kinds of obstacle is open."""

    event: EventKind | None


@node
class BatteryLevel(Node):
    """`the battery drops below 30 %`, `the battery is above 60 %`."""

    level: Bounded


@node
class TooLate(Node):
    """`it is too late`: the window of the task before is over."""


Asked = Test | Occurs | BatteryLevel | TooLate


@node
class SaidCondition(Node):
    """Alternatives, of each of which all must hold: `and` binds more tightly than `or`."""

    alternatives: tuple[tuple[Asked, ...], ...]
    negated: bool = False
    """`unless`"""

    @property
    def tests(self) -> list[Asked]:
        """All that is asked, of whichever alternative."""
        return [test for tests in self.alternatives for test in tests]
