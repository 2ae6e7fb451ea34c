"""The cheapest way within a region, found by a search towards its goals."""

import numpy as np
from numpy.typing import NDArray

from argo_env.navigation.graphs import Graph, graph_of, search
from argo_env.navigation.regions import Region, walk

_STEP = 4.0  # s more than the least that the way may cost, in each attempt
_ATTEMPTS = 7  # before the whole region is searched


def find_inside(
    area: Region,
    source: int,
    ends: NDArray[np.int64],
    extra: NDArray[np.float64],
    most: float = np.inf,
) -> tuple[float, list[int]] | None:
    """The cheapest way that stays in the region from its state `source` to one of the states
    `ends`, where arriving at each costs `extra` (s) besides: its cost and its states. None if it
    costs more than `most`.

    This is A*: a search through moves that count less the nearer they lead to the goals, by the
    bounds that landmarks give. Since scipy's searches end at a limit and not at a goal, the limit
    is raised until it is above the cost found.
    """
    bounds = area.landmarks.bounds(source, ends, extra)
    if bounds is None:
        bounds = np.zeros(len(area.members))
        limits, towards = [np.inf], area.ahead
    else:
        limits = [*(_STEP * (1 + k) for k in range(_ATTEMPTS)), np.inf]
        towards = _towards(area, bounds)
    room = most + 1e-6 - bounds[source]
    for limit in limits:
        costs, before = search(towards, np.array([source]), max(0.0, min(limit, room)))
        total = costs[0, ends] - bounds[ends] + extra
        best = int(np.argmin(total))
        if np.isfinite(total[best]) and total[best] <= limit:
            cost = float(total[best] + bounds[source])
            if cost > most:
                return None
            steps = [*walk(before[0], int(ends[best]))][::-1]
            return cost, area.members[steps].tolist()
        if limit >= room:
            return None
    return None


def _towards(area: Region, bounds: NDArray[np.float64]) -> Graph:
    """The moves ahead, each cheaper by what the bounds fall along it."""
    graph = area.ahead
    costs = bounds.take(area.heads, mode="clip")  # in range, and so twice as fast
    costs -= np.repeat(bounds, np.diff(graph.indptr))
    costs += graph.data
    return graph_of(costs, graph.indices, graph.indptr)
