"""Tests for conditions that exclude each other, or that cover all values together."""

from collections.abc import Iterable, Sequence
from itertools import combinations
from math import inf

from argo_compiler.il.mission import Condition, ConditionType

Alternatives = Sequence[Sequence[Condition]]
"""alternatives; each one is satisfied if all its conditions are"""


def are_surely_exclusive(first: Alternatives, second: Alternatives) -> bool:
    """Return True if no values satisfy an alternative of `first` and one of `second` together.

    False may also mean that this could not be shown.
    """
    return all(
        any(_are_disjoint(a, b) for a in one for b in other) for one in first for other in second
    )


def are_contradictory(conditions: Iterable[Condition]) -> bool:
    """Return True if two conditions on the same checkpoint can't be satisfied together."""
    return any(_are_disjoint(a, b) for a, b in combinations(conditions, 2))


def are_surely_exhaustive(alternatives: Alternatives) -> bool:
    """Return True if each value of a checkpoint satisfies one of the alternatives.

    It detects only a pair of alternatives that cover all values together, GREATER and LESS, with
    one condition each and no `max_age`.
    """
    single = [held[0] for held in alternatives if len(held) == 1 and held[0].max_age is None]
    return any(
        _cover_all_values(a, b) or _cover_all_values(b, a) for a, b in combinations(single, 2)
    )


def _cover_all_values(low: Condition, high: Condition) -> bool:
    """Return True if each value satisfies GREATER condition `low` or LESS condition `high`."""
    if low.object_id != high.object_id or low.param1 is None or high.param1 is None:
        return False
    if (low.type, high.type) != (ConditionType.GREATER, ConditionType.LESS):
        return False
    touching = low.inclusive or high.inclusive
    return low.param1 < high.param1 or (low.param1 == high.param1 and touching)


def _are_disjoint(a: Condition, b: Condition) -> bool:
    """Return True if both conditions are on one checkpoint and no value satisfies both."""
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
