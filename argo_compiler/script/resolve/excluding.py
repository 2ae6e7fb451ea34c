"""Puts conditions of which no two can hold at the same time into one choice."""

from itertools import combinations, pairwise

from argo_compiler.il.bounds import exclude
from argo_compiler.script.resolve.program import Choice, Leave


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
