"""Whether two conditions can't hold at the same time."""

from math import inf

from argo_compiler.il import Condition, ConditionType
from argo_compiler.script.resolve.program import Alternatives


def exclude(one: Alternatives, other: Alternatives) -> bool:
    """Whether no values satisfy an alternative of the one and an alternative of the other."""
    return all(any(_apart(a, b) for a in each for b in also) for each in one for also in other)


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
