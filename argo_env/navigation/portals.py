"""Portals: where ways change from region to region, and the cheapest ways between them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_env.files.parts import Arrays
from argo_env.navigation.graphs import Trees, graph_of_moves, search
from argo_env.navigation.lattice import Lattice
from argo_env.navigation.regions import Partition, Region


@dataclass(frozen=True)
class Portals:
    """All states where ways change from region to region, ascending, and between each two of them
    the cost and the time (s) of the cheapest way, shape (n, n), and the portal before the last."""

    states: NDArray[np.int64]
    costs: NDArray[np.float64]
    times: NDArray[np.float64]
    before: NDArray[np.int32]

    def entries(self, area: Region) -> NDArray[np.int64]:
        """The rows of the region's entries."""
        return np.searchsorted(self.states, area.members[area.entries])

    def exits(self, area: Region) -> NDArray[np.int64]:
        """The rows of the region's exits."""
        return np.searchsorted(self.states, area.members[area.exits])


def portals_arrays(portals: Portals) -> Arrays:
    """Portals as arrays."""
    return {
        "states": portals.states,
        "costs": portals.costs,
        "times": portals.times,
        "before": portals.before,
    }


def find_portals(lattice: Lattice, part: Partition) -> Portals:
    """The portals of a lattice in regions, and all ways between them."""
    sources, targets, costs = part.crossings
    states = np.unique(np.concatenate([sources, targets]))
    moves = [(sources, targets, costs, lattice.seconds(costs, sources, targets))]
    for area in part.regions:
        between, times = costs_and_times(lattice, area, area.exits)
        entry, leave = np.nonzero(
            np.isfinite(between) & (area.entries[:, None] != area.exits[None, :])
        )
        a, b = area.members[area.entries[entry]], area.members[area.exits[leave]]
        moves.append((a, b, between[entry, leave], times[entry, leave]))
    a, b, costs, seconds = (np.concatenate(parts) for parts in zip(*moves, strict=True))
    a, b = np.searchsorted(states, a), np.searchsorted(states, b)
    shape = (len(states), len(states))
    if not len(states):
        return Portals(states, np.empty(shape), np.empty(shape), np.empty(shape, np.int32))
    hop = np.zeros(shape)
    hop[a, b] = seconds
    total, before = search(graph_of_moves(costs, a, b, len(states)), np.arange(len(states)))
    times = np.zeros(shape)
    row, end = np.nonzero(before >= 0)
    here = end.copy()
    while len(row):
        last = before[row, here]
        times[row, end] += hop[last, here]
        going = last != row
        row, end, here = row[going], end[going], last[going]
    return Portals(states, total, times, before)


def costs_and_times(
    lattice: Lattice, area: Region, ends: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """From each entry of a region to each of its states `ends`, shape (entries, ends)."""
    return area.from_entries[0][:, ends], tree_times(lattice, area, area.from_entries, ends)


def tree_times(
    lattice: Lattice, area: Region, trees: Trees, ends: NDArray[np.int64]
) -> NDArray[np.float64]:
    """The time (s) of the way to each of `ends` in each tree of a region, shape (trees, ends); 0
    where there is none."""
    costs, before = trees
    times = np.zeros((len(costs), len(ends)))
    tree, end = np.nonzero(before[:, ends] >= 0)
    here = ends[end]
    while len(here):
        last = before[tree, here]
        spent = costs[tree, here] - costs[tree, last]
        times[tree, end] += lattice.seconds(spent, area.members[last], area.members[here])
        going = before[tree, last] >= 0
        tree, end, here = tree[going], end[going], last[going].astype(np.int64)
    return times
