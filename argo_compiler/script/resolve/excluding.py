"""Conditions of which no two can hold at the same time, or of which one always does."""

from collections.abc import Iterable
from itertools import combinations, pairwise
from math import inf

from argo_compiler.il import Condition, ConditionType
from argo_compiler.script.resolve.program import Alternatives, Choice, Leave


def put_together(last: Choice) -> bool:
    """Puts the conditions that belong together so that the other case of the last one is what is
    done if none of them holds; False if it may be meant for the last of them only."""
    chain = [last]
    while isinstance(before := chain[-1].before, Choice) and chain[-1].bound:
        chain.append(before)
    chain.reverse()
    if isinstance(last.then.last, Choice):
        return False  # `if ..., check #2 unless ...; otherwise ...`
    several = [c for c in chain if c is last or not isinstance(c.then.last, Leave)]
    if len(several) == 1:
        return True
    clear = all(exclude(a.alternatives, b.alternatives) for a, b in combinations(several, 2))
    if not clear or any(c.negated or c.otherwise.first is not None for c in chain):
        return False
    for outer, inner in pairwise(chain):
        assert inner.block is not None
        inner.block.remove(inner)
        outer.otherwise.append(inner)
    return True


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
