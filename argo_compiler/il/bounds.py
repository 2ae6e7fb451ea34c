"""Conditions of which no two can hold at the same time, or of which one always does."""

from collections.abc import Iterable, Sequence
from itertools import combinations
from math import inf

from argo_compiler.il.mission import Condition, ConditionType

Alternatives = Sequence[Sequence[Condition]]
"""alternatives, of each of which all conditions hold"""


def exclude(one: Alternatives, other: Alternatives) -> bool:
    """Whether no values satisfy an alternative of the one and an alternative of the other."""
    return all(any(_apart(a, b) for a in each for b in also) for each in one for also in other)


def contradict(conditions: Iterable[Condition]) -> bool:
    """Whether no value satisfies all the bounds for one of the checkpoints."""
    return any(_apart(a, b) for a, b in combinations(conditions, 2))


def cover_all(alternatives: Alternatives) -> bool:
    """Whether each value of a checkpoint satisfies one of the alternatives."""
    single = [held[0] for held in alternatives if len(held) == 1 and held[0].max_age is None]
    return any(_meet(a, b) or _meet(b, a) for a, b in combinations(single, 2))


def _meet(low: Condition, high: Condition) -> bool:
    """Whether the values above the one bound and below the other are all there are."""
    if low.object_id != high.object_id or low.param1 is None or high.param1 is None:
        return False
    if (low.type, high.type) != (ConditionType.GREATER, ConditionType.LESS):
        return False
    both = low.inclusive or high.inclusive
    return low.param1 < high.param1 or (low.param1 == high.param1 and both)


def _apart(a: Condition, b: Condition) -> bool:
    """Whether no value of a checkpoint satisfies both bounds."""
    if a.object_id != b.object_id:
        return False
    first, second = _interval(a), _interval(b)
    if first is None or second is None:
        return False
    both = a.inclusive and b.inclusive
    low, high = max(first[0], second[0]), min(first[1], second[1])
    return low > high or (low == high and not both)


def _interval(condition: Condition) -> tuple[float, float] | None:
    low, high = condition.param1, condition.param2
    match condition.type:
        case ConditionType.GREATER if low is not None:
            return low, inf
        case ConditionType.LESS if low is not None:
            return -inf, low
        case ConditionType.WITHIN if low is not None and high is not None:
            return low, high
    return None
