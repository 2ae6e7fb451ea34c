"""Conditions: what is asked of values, states and events, joined by and, or and not."""

from enum import StrEnum

from argo_compiler.il import EventKind
from argo_compiler.script.sentences.tree.node import Node, node
from argo_compiler.script.sentences.tree.nouns import Nouns


class Relation(StrEnum):
    """How a value compares with a bound."""

    GREATER = "greater"
    LESS = "less"
    AT_LEAST = "at least"
    AT_MOST = "at most"


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
class Compared(Node):
    """`above 5 bar`."""

    relation: Relation
    bound: Amount


@node
class Between(Node):
    """`between 2 and 3`, the bounds excluded; `from 2 to 3`, included."""

    low: Amount
    high: Amount
    inclusive: bool


@node
class InState(Node):
    """`abnormal`, `unreadable`, `older than 60 s`."""

    state: TaskState
    age: float | None = None
    """s, of STALE"""


class ValvePosition(StrEnum):
    """ValvePosition of a valve."""

    OPEN = "open"
    HALF_OPEN = "half_open"
    CLOSED = "closed"


@node
class InValvePosition(Node):
    """`open`, `half open`, `closed`."""

    position: ValvePosition


Predicate = Compared | Between | InState | InValvePosition


@node
class Test(Node):
    """What is asked of the checkpoints; of several joined by `or`, one has to be so."""

    subject: Nouns | None
    """None: what was measured last"""
    predicate: Predicate
    negated: bool = False
    max_age: float | None = None
    """s"""
    id: str = ""
    second_bound: float | None = None
    """an upper bound that the comparison does not need, kept for the plan's sake"""

    @property
    def is_of_failure(self) -> bool:
        """Whether it asks if a task has failed, which is known as soon as it has ended."""
        return isinstance(self.predicate, InState) and self.predicate.state in _FAILURES


@node
class Occurs(Node):
    """`a gas leak is detected`. None: which of two kinds of obstacle is open."""

    event: EventKind | None


@node
class BatteryLevel(Node):
    """`the battery drops below 30 %`, `the battery is above 60 %`."""

    relation: Relation
    level: Amount


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
