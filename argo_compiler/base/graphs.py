"""Graphs of numbered nodes: strongly connected components and shortest paths."""

from collections import deque
from collections.abc import Callable, Iterable, Sequence

Successors = Sequence[Sequence[int]]
"""for each node, the nodes that may come next"""


def components(successors: Successors) -> list[list[int]]:
    """Return the strongly connected components, each one after all that can be reached from it.

    Linear time. Tarjan, Depth-first search and linear graph algorithms, 1972, with an explicit
    stack.
    """
    index = [-1] * len(successors)
    low = [0] * len(successors)
    on_stack = [False] * len(successors)
    stack: list[int] = []
    result: list[list[int]] = []
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
                    component: list[int] = []
                    while not component or component[-1] != node:
                        component.append(stack.pop())
                        on_stack[component[-1]] = False
                    result.append(component)
    return result


def is_loop(component: Sequence[int], successors: Successors) -> bool:
    """Return True if a strongly connected component has a cycle.

    It has one if it has several nodes, or an edge from its only node to itself.
    """
    return len(component) > 1 or component[0] in successors[component[0]]


def can_reach(successors: Successors, goals: Iterable[int]) -> list[bool]:
    """Return, for each node, whether a goal can be reached from it; True for the goals."""
    before: list[list[int]] = [[] for _ in successors]
    for node, following in enumerate(successors):
        for other in following:
            before[other].append(node)
    return reachable_from(before, goals)


def reachable_from(successors: Successors, sources: Iterable[int]) -> list[bool]:
    """Return, for each node, whether it can be reached from a source; True for the sources."""
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


def shortest_path_predecessors(
    successors: Successors, source: int, passable: Callable[[int, int], bool]
) -> list[int | None]:
    """Return, for each node, its predecessor on a path of fewest edges from `source`.

    Only edges are used for which `passable(node, next node)` is True. The predecessor is None for
    nodes without such a path, and for the source itself.
    """
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


def path_to(before: Sequence[int | None], source: int, target: int) -> tuple[int, ...] | None:
    """Return the nodes from `source` to `target`, both included, or None if there is no path.

    `before` has the predecessor of each node on a shortest path from `source`, as
    `shortest_path_predecessors` returns it.
    """
    path = [target]
    while path[-1] != source:
        previous = before[path[-1]]
        if previous is None:
            return None
        path.append(previous)
    return tuple(reversed(path))
