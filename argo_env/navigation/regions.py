"""The lattice cut into regions, one per storey, which only a few states on the stairs connect.

A fastest path through several storeys goes from portal to portal, and the paths between the portals
of a region never change. So a query searches near its two ends only. The paths are as cheap as
those of one search over the whole lattice.

Landmarks are states whose path costs to and from all others are known. By the triangle inequality
they give lower bounds on all other costs (Goldberg and Harrelson, "Computing the shortest path: A*
search meets graph theory", 2005).
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.memoization import thread_safe_cached_property
from argo_env.files.parts import NO_CACHE, Arrays, Parts
from argo_env.navigation.graphs import (
    Graph,
    Trees,
    reverse_graph,
    shortest_path_costs,
    shortest_path_trees,
    subgraph,
)
from argo_env.navigation.lattice import Lattice

_OUTER_LANDMARKS, _DISTANT_LANDMARKS = 8, 8  # at the border, and far away from all others
_BOUNDS_USED = 6  # at most, in one search
_MIN_STATES = 100_000  # fewer are searched fast without landmarks, which take memory
_BOUND_SHARE = 0.998  # lowers bounds, so that rounded ones fall by less than a move's cost
_UNREACHABLE_COST = 1e6  # s, limit of the bounds, also where there is no path


@dataclass(frozen=True)
class Landmarks:
    """Landmarks of a graph.

    `forward` has the moves in the direction of travel, `backward` the reversed ones. `positions`
    are the x and y (m) of its states, shape (n, 2). The bounds also hold for a graph that has lost
    some of the moves.
    """

    forward: Graph
    backward: Graph
    positions: NDArray[np.float64]
    parts: Parts = NO_CACHE
    name: str = ""
    """name of the part of the disk cache that has the costs from and to the landmarks"""

    def lower_bounds_from_all_states(
        self, search_start: int, ends: NDArray[np.int64], end_costs: NDArray[np.float64]
    ) -> NDArray[np.float64] | None:
        """Return for each state a lower bound (s) on the cost to reach one of `ends`.

        Along a move, bounds fall by less than the cost of the move. They are closest to the true
        costs near the paths from `search_start`.

        Args:
            search_start: State from which the search starts.
            ends: States to reach.
            end_costs: Additional cost (s) of each of `ends`.

        Returns:
            Bounds of shape (n,), or None for a small graph.
        """
        if len(self.positions) < _MIN_STATES:
            return None
        onto, away = self._distances
        # Costs from the goals on to each landmark, and from each landmark to the goals.
        behind = (onto[:, ends] - end_costs).max(axis=1).astype(np.float32)
        before = (away[:, ends] + end_costs).min(axis=1).astype(np.float32)
        with np.errstate(invalid="ignore"):
            worth = np.concatenate([onto[:, search_start] - behind, before - away[:, search_start]])
        usable = np.isfinite(np.concatenate([behind, before]))
        worth[~usable] = -np.inf
        best = np.zeros(len(self.positions), dtype=np.float32)
        bound = np.empty_like(best)
        for number in np.argsort(-worth, kind="stable")[
            : min(_BOUNDS_USED, int(usable.sum()))
        ].tolist():
            k = number % len(onto)
            if number == k:
                np.subtract(onto[k], behind[k], out=bound)
            else:
                np.subtract(before[k], away[k], out=bound)
            np.maximum(best, bound, out=best)
        return (
            np.minimum(best, np.float32(_UNREACHABLE_COST), out=best).astype(np.float64)
            * _BOUND_SHARE
        )

    def prepare(self) -> None:
        """Compute the costs from and to the landmarks now."""
        if len(self.positions) >= _MIN_STATES:
            _ = self._distances

    @thread_safe_cached_property
    def _distances(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Costs (s) from all states to each landmark, and from each landmark to all states.

        Both have the shape (landmarks, n).
        """
        costs = self.parts.load_or_make(self.name, self._find_distances)
        return costs["onto"], costs["away"]

    def _find_distances(self) -> dict[str, NDArray[np.float32]]:
        chosen = _outermost(self.positions)
        onto, away = self._to_and_from(chosen)
        nearest = (onto + away).min(axis=0)
        for _ in range(_DISTANT_LANDMARKS):
            nearest[~np.isfinite(nearest)] = -1.0
            more = self._to_and_from([int(np.argmax(nearest))])
            onto, away = np.vstack([onto, more[0]]), np.vstack([away, more[1]])
            nearest = np.minimum(nearest, (more[0] + more[1])[0])
        return {"onto": onto, "away": away}

    def _to_and_from(self, states: list[int]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        onto, away = (shortest_path_costs(graph, states) for graph in (self.backward, self.forward))
        return onto.astype(np.float32), away.astype(np.float32)


def _outermost(positions: NDArray[np.float64]) -> list[int]:
    """Return the outermost state in each of _OUTER_LANDMARKS directions.

    Of the states within 0.15 m of the outermost one, it is the one nearest to their middle.
    """
    states = []
    for k in range(_OUTER_LANDMARKS):
        angle = 2 * math.pi * k / _OUTER_LANDMARKS
        along = positions @ np.array([math.cos(angle), math.sin(angle)])
        aside = positions @ np.array([-math.sin(angle), math.cos(angle)])
        edge = np.flatnonzero(along > along.max() - 0.15)
        middle = np.abs(aside[edge] - np.median(aside[edge])).round(6)
        states.append(int(edge[np.argmin(middle)]))
    return states


@dataclass(frozen=True)
class Region:
    """Part of a lattice: the states `members`, ascending, and the moves between them.

    `forward` has the moves in the direction of travel, `backward` the reversed ones, both in the
    region's own numbers. Paths come in at the states `entries` and leave at the states `exits`, in
    the same numbers.
    """

    members: NDArray[np.int64]
    forward: Graph
    backward: Graph
    entries: NDArray[np.int64]
    exits: NDArray[np.int64]
    landmarks: Landmarks
    parts: Parts = NO_CACHE
    name: str = ""
    """beginning of the names of the region's parts in the disk cache"""

    @thread_safe_cached_property
    def move_targets(self) -> NDArray[np.intp]:
        """State that each forward move leads to, in the type that NumPy indexes fastest with."""
        return self.forward.indices.astype(np.intp)

    @thread_safe_cached_property
    def trees_from_entries(self) -> Trees:
        """Cheapest paths from each entry, the root: the next state is the one before on a path."""
        return self._trees("entries", self.forward, self.entries)

    @thread_safe_cached_property
    def trees_to_exits(self) -> Trees:
        """Cheapest paths to each exit: their costs, and each state's next one towards the exit."""
        return self._trees("exits", self.backward, self.exits)

    def _trees(self, kind: str, graph: Graph, sources: NDArray[np.int64]) -> Trees:
        def compute_trees() -> Arrays:
            costs, following = shortest_path_trees(graph, sources)
            return {"costs": costs, "following": following}

        trees = self.parts.load_or_make(f"{self.name}-{kind}", compute_trees)
        return trees["costs"], trees["following"]


def walk_tree(following: NDArray[np.int32], start: int) -> Iterator[int]:
    """Yield `start` and the states that follow it, up to the root of the tree.

    `following` has the next state of each, negative at the root.
    """
    while start >= 0:
        yield start
        start = int(following[start])


def find_cut_heights(lattice: Lattice, floors: Sequence[float]) -> list[float]:
    """Return one height (m) between each two consecutive floors: the one that fewest moves cross.

    `floors` are the heights (m) of the floors, ascending.
    """
    z = lattice.surface.z[lattice.cell]
    moves = lattice.costs.tocoo()
    a, b = z[moves.coords[0]], z[moves.coords[1]]
    climbs = np.abs(a - b) > 1e-6
    low, high = np.minimum(a, b)[climbs], np.maximum(a, b)[climbs]
    levels = np.unique(np.round(z, 4))
    between = (levels[:-1] + levels[1:]) / 2
    low, high = np.sort(low), np.sort(high)
    crossing = np.searchsorted(low, between) - np.searchsorted(high, between)
    cuts = []
    for below, above in pairwise(floors):
        inside = np.flatnonzero((between > below) & (between < above))
        if len(inside):
            aside = np.abs(between[inside] - (below + above) / 2)
            best = np.lexsort((aside.round(6), crossing[inside]))[0]
            cuts.append(float(between[inside[best]]))
    return cuts


@dataclass(frozen=True)
class Partition:
    """A lattice cut into regions.

    State s is number `local[s]` of region `region[s]`; `crossings` are the moves from region to
    region: sources, targets and costs (s).
    """

    region: NDArray[np.int64]
    local: NDArray[np.int64]
    regions: tuple[Region, ...]
    crossings: tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]


def make_partition(lattice: Lattice, cuts: Sequence[float], parts: Parts = NO_CACHE) -> Partition:
    """Return the lattice cut at the heights `cuts` (m), which are ascending, into regions.

    `parts` is where the regions store what takes long to compute.
    """
    region = np.searchsorted(np.array(cuts), lattice.surface.z[lattice.cell])
    members = [np.flatnonzero(region == r) for r in range(len(cuts) + 1)]
    local = np.empty(lattice.size, dtype=np.int64)
    for states in members:
        local[states] = np.arange(len(states))
    crossings = _crossings(lattice, region)
    regions = []
    for number, states in enumerate(members):
        plain = _region(lattice, states, local, crossings)
        name = f"region-{number}"
        landmarks = replace(plain.landmarks, parts=parts, name=f"{name}-landmarks")
        regions.append(replace(plain, landmarks=landmarks, parts=parts, name=name))
    return Partition(region, local, tuple(regions), crossings)


def repartition(partition: Partition, lattice: Lattice, changed: NDArray[np.bool_]) -> Partition:
    """Return the same partition for another lattice, with the same states but fewer moves.

    `changed` is a mask of the states at which a missing move starts. Regions without such states
    are shared with `partition`, with all that has been computed of them.
    """
    crossings = _crossings(lattice, partition.region)
    regions = [
        _region(lattice, old.members, partition.local, crossings, old.landmarks)
        if changed[old.members].any()
        else old
        for old in partition.regions
    ]
    return Partition(partition.region, partition.local, tuple(regions), crossings)


def _crossings(
    lattice: Lattice, region: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
    source, target = lattice.costs.tocoo().coords
    out = np.flatnonzero(region[source] != region[target])
    return source[out].astype(np.int64), target[out].astype(np.int64), lattice.costs.data[out]


def _region(
    lattice: Lattice,
    members: NDArray[np.int64],
    local: NDArray[np.int64],
    crossings: tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]],
    landmarks: Landmarks | None = None,
) -> Region:
    forward = subgraph(lattice.costs, members)
    # scipy searches with 32-bit numbers and would convert them for every search.
    forward.indices, forward.indptr = (
        forward.indices.astype(np.int32),
        forward.indptr.astype(np.int32),
    )
    inside = np.zeros(lattice.size, dtype=bool)
    inside[members] = True
    sources, targets, _ = crossings
    backward = reverse_graph(forward)
    return Region(
        members,
        forward,
        backward,
        local[np.unique(targets[inside[targets]])],
        local[np.unique(sources[inside[sources]])],
        landmarks or Landmarks(forward, backward, lattice.state_poses(members)[:, :2]),
    )
