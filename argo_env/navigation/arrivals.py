"""How long the ways to some states take, from wherever they begin."""

import numpy as np
from numpy.typing import NDArray

from argo_env.navigation.graphs import against, search
from argo_env.navigation.lattice import Lattice


def times_to(lattice: Lattice, goals: NDArray[np.int64]) -> NDArray[np.float32]:
    """The time (s) of the cheapest way from every state to each of `goals`, shape (goals, states);
    inf where there is none."""
    back = against(lattice.costs)
    back.indices, back.indptr = back.indices.astype(np.int32), back.indptr.astype(np.int32)
    times = np.empty((len(goals), lattice.size), dtype=np.float32)
    for row, goal in enumerate(goals.tolist()):
        (costs,), (following,) = search(back, np.array([goal]))
        times[row] = _along(lattice, costs, following.astype(np.int64))
    return times


def _along(
    lattice: Lattice, costs: NDArray[np.float64], following: NDArray[np.int64]
) -> NDArray[np.float64]:
    """The time (s) from each state along the states that follow, given what the ways cost."""
    states = np.arange(lattice.size)
    there = np.isfinite(costs)
    on = there & (following >= 0)
    after = np.where(on, following, states)
    times = np.zeros(lattice.size)
    times[on] = lattice.seconds(costs[on] - costs[after[on]], states[on], after[on])
    # Each round doubles how many moves are added up, until all lead to the goal.
    while (after != after[after]).any():
        times += times[after]
        after = after[after]
    return np.where(there, times, np.inf)
