"""Graphs of numbered nodes: strongly connected parts and shortest ways."""

from collections import deque
from collections.abc import Callable, Iterable, Sequence

Successors = Sequence[Sequence[int]]
"""for each node, the nodes that may come next"""


def components(successors: Successors) -> list[list[int]]:
    """The strongly connected parts, each one after those that it leads to. Linear time.

    Tarjan, Depth-first search and linear graph algorithms, 1972, with a stack of its own.
    """
    index = [-1] * len(successors)
    low = [0] * len(successors)
    on_stack = [False] * len(successors)
    stack: list[int] = []
    found: list[list[int]] = []
    counter = 0
    for root in range(len(successors)):
        if index[root] >= 0:
            continue
        calls = [(root, 0)]
        while calls:
            node, at = calls.pop()
            if at == 0:
                index[node] = low[node] = counter
                counter += 1
                stack.append(node)
                on_stack[node] = True
            else:
                low[node] = min(low[node], low[successors[node][at - 1]])
            for k in range(at, len(successors[node])):
                following = successors[node][k]
                if index[following] < 0:
                    calls += [(node, k + 1), (following, 0)]
                    break
                if on_stack[following]:
                    low[node] = min(low[node], index[following])
            else:
                if low[node] == index[node]:
                    part: list[int] = []
                    while not part or part[-1] != node:
                        part.append(stack.pop())
                        on_stack[part[-1]] = False
                    found.append(part)
    return found


def is_loop(part: Sequence[int], successors: Successors) -> bool:
    """Whether a strongly connected part is more than a node that is passed once."""
    return len(part) > 1 or part[0] in successors[part[0]]


def leading_to(successors: Successors, goals: Iterable[int]) -> list[bool]:
    """For each node, whether a goal can be reached from it."""
    before: list[list[int]] = [[] for _ in successors]
    for node, following in enumerate(successors):
        for other in following:
            before[other].append(node)
    return reached_from(before, goals)


def reached_from(successors: Successors, sources: Iterable[int]) -> list[bool]:
    """For each node, whether it can be reached from a source."""
    reached = [False] * len(successors)
    pending = list(sources)
    for node in pending:
        reached[node] = True
    while pending:
        for other in successors[pending.pop()]:
            if not reached[other]:
                reached[other] = True
                pending.append(other)
    return reached


def first_ways(
    successors: Successors, source: int, passable: Callable[[int, int], bool]
) -> list[int | None]:
    """For each node, the one before it on a way of fewest steps from `source`, over passable
    steps only; None where there is none, and for the source itself."""
    before: list[int | None] = [None] * len(successors)
    seen = [False] * len(successors)
    seen[source] = True
    pending = deque([source])
    while pending:
        node = pending.popleft()
        for other in successors[node]:
            if not seen[other] and passable(node, other):
                seen[other] = True
                before[other] = node
                pending.append(other)
    return before


def way_to(before: Sequence[int | None], source: int, target: int) -> tuple[int, ...] | None:
    """The nodes from `source` to `target`, both included, or None if there is no way."""
    way = [target]
    while way[-1] != source:
        previous = before[way[-1]]
        if previous is None:
            return None
        way.append(previous)
    return tuple(reversed(way))
