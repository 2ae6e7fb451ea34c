"""The lattice cut into regions, a storey each, that only a few states on the stairs connect.

A fastest way through several storeys goes from portal to portal, and what lies between the portals
of a region never changes. So a query searches near its two ends only. Nothing is lost by this: the
ways found are as cheap as those of one search over the whole lattice.

Landmarks are states whose ways to and from all others are known, and bound all other ways from
below by the triangle inequality (Goldberg and Harrelson, "Computing the shortest path: A* search
meets graph theory", 2005).
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from argo_env.files.parts import NO_CACHE, Arrays, Parts
from argo_env.navigation.graphs import Graph, Trees, against, costs_of, part_of, search
from argo_env.navigation.lattice import Lattice

_SIDES, _AWAY = 8, 8  # landmarks at the outermost places, and far away from all others
_ACTIVE = 6  # bounds that one search uses
_WORTH_IT = 100_000  # states; a search through fewer is short, and landmarks take memory
_SHARE = 0.998  # of a bound is used: what single precision rounds must not exceed a move's cost
_NEVER = 1e6  # s that a way counts that there is not


@dataclass(frozen=True)
class Landmarks:
    """Landmarks of a graph with the moves `ahead` in time and `back` against it; `places` are the
    x and y (m) of its states, shape (n, 2).

    The bounds hold as well for a graph that has lost some of the moves.
    """

    ahead: Graph
    back: Graph
    places: NDArray[np.float64]
    parts: Parts = NO_CACHE
    name: str = ""
    """of the part with their ways"""

    def bounds(
        self, source: int, ends: NDArray[np.int64], extra: NDArray[np.float64]
    ) -> NDArray[np.float64] | None:
        """Of each state a cost (s) that no way from it to one of `ends` is below, where arriving at
        each costs `extra` (s) besides; the best ones near the ways from `source`.

        Along a move, bounds fall by less than its cost. None for a small graph.
        """
        if len(self.places) < _WORTH_IT:
            return None
        onto, away = self._distances
        # A way from the goals on to the landmark, or from the landmark to the goals.
        behind = (onto[:, ends] - extra).max(axis=1).astype(np.float32)
        before = (away[:, ends] + extra).min(axis=1).astype(np.float32)
        with np.errstate(invalid="ignore"):
            worth = np.concatenate([onto[:, source] - behind, before - away[:, source]])
        usable = np.isfinite(np.concatenate([behind, before]))
        worth[~usable] = -np.inf
        best = np.zeros(len(self.places), dtype=np.float32)
        bound = np.empty_like(best)
        for number in np.argsort(-worth, kind="stable")[: min(_ACTIVE, int(usable.sum()))].tolist():
            k = number % len(onto)
            if number == k:
                np.subtract(onto[k], behind[k], out=bound)
            else:
                np.subtract(before[k], away[k], out=bound)
            np.maximum(best, bound, out=best)
        return np.minimum(best, np.float32(_NEVER), out=best).astype(np.float64) * _SHARE

    def prepare(self) -> None:
        """Finds the ways now."""
        if len(self.places) >= _WORTH_IT:
            _ = self._distances

    @cached_property
    def _distances(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """The costs (s) from all states to each landmark, and from each landmark to all states,
        shape (landmarks, n)."""
        ways = self.parts.load_or_make(self.name, self._find_distances)
        return ways["onto"], ways["away"]

    def _find_distances(self) -> dict[str, NDArray[np.float32]]:
        chosen = _outermost(self.places)
        onto, away = self._to_and_from(chosen)
        nearest = (onto + away).min(axis=0)
        for _ in range(_AWAY):
            nearest[~np.isfinite(nearest)] = -1.0
            more = self._to_and_from([int(np.argmax(nearest))])
            onto, away = np.vstack([onto, more[0]]), np.vstack([away, more[1]])
            nearest = np.minimum(nearest, (more[0] + more[1])[0])
        return {"onto": onto, "away": away}

    def _to_and_from(self, states: list[int]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        onto, away = (costs_of(graph, states) for graph in (self.back, self.ahead))
        return onto.astype(np.float32), away.astype(np.float32)


def _outermost(places: NDArray[np.float64]) -> list[int]:
    """The state that lies farthest in each of some directions, in the middle of those that do."""
    states = []
    for k in range(_SIDES):
        angle = 2 * math.pi * k / _SIDES
        along = places @ np.array([math.cos(angle), math.sin(angle)])
        aside = places @ np.array([-math.sin(angle), math.cos(angle)])
        edge = np.flatnonzero(along > along.max() - 0.15)
        middle = np.abs(aside[edge] - np.median(aside[edge])).round(6)
        states.append(int(edge[np.argmin(middle)]))
    return states


@dataclass(frozen=True)
class Region:
    """The states `members` of a lattice, ascending, with the moves between them forwards in time
    (`ahead`) and against it (`back`), in the region's own numbers.

    Ways come in at the states `entries` and leave at the states `exits`.
    """

    members: NDArray[np.int64]
    ahead: Graph
    back: Graph
    entries: NDArray[np.int64]
    exits: NDArray[np.int64]
    landmarks: Landmarks
    parts: Parts = NO_CACHE
    name: str = ""
    """of what is kept of it in `parts`"""

    @cached_property
    def heads(self) -> NDArray[np.intp]:
        """Where each move ahead leads, in the numbers that numpy takes fastest."""
        return self.ahead.indices.astype(np.intp)

    @cached_property
    def from_entries(self) -> Trees:
        """The cheapest ways from each entry; what is next to a state is the state before it."""
        return self._trees("entries", self.ahead, self.entries)

    @cached_property
    def to_exits(self) -> Trees:
        """The cheapest ways to each exit; what is next to a state is the state after it."""
        return self._trees("exits", self.back, self.exits)

    def _trees(self, kind: str, graph: Graph, sources: NDArray[np.int64]) -> Trees:
        def find() -> Arrays:
            costs, following = search(graph, sources)
            return {"costs": costs, "following": following}

        trees = self.parts.load_or_make(f"{self.name}-{kind}", find)
        return trees["costs"], trees["following"]


def walk(following: NDArray[np.int32], start: int) -> Iterator[int]:
    """`start` and what follows it, up to the end."""
    while start >= 0:
        yield start
        start = int(following[start])


def find_cuts(lattice: Lattice, floors: Sequence[float]) -> list[float]:
    """A height between each floor and the next, in m, that the fewest moves cross."""
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
    """A lattice in regions. State s is number `local[s]` of region `region[s]`; `crossings` are the
    moves from region to region: sources, targets and costs (s)."""

    region: NDArray[np.int64]
    local: NDArray[np.int64]
    regions: tuple[Region, ...]
    crossings: tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]


def make_partition(lattice: Lattice, cuts: Sequence[float], parts: Parts = NO_CACHE) -> Partition:
    """The partition of the lattice at the heights `cuts` (m). What takes long to find of its
    regions is kept in `parts`."""
    region = np.searchsorted(np.array(cuts), lattice.surface.z[lattice.cell])
    members = [np.flatnonzero(region == r) for r in range(len(cuts) + 1)]
    local = np.empty(lattice.size, dtype=np.int64)
    for states in members:
        local[states] = np.arange(len(states))
    crossings = _crossings(lattice, region)
    regions = []
    for number, states in enumerate(members):
        found = _region(lattice, states, local, crossings)
        name = f"region-{number}"
        landmarks = replace(found.landmarks, parts=parts, name=f"{name}-landmarks")
        regions.append(replace(found, landmarks=landmarks, parts=parts, name=name))
    return Partition(region, local, tuple(regions), crossings)


def repartition(partition: Partition, lattice: Lattice, changed: NDArray[np.bool_]) -> Partition:
    """The partition of a `lattice` with the same states that has lost moves at the states
    `changed`; regions without them are shared, with all that is known of them."""
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
    ahead = part_of(lattice.costs, members)
    # scipy searches with 32-bit numbers and would convert them for every search.
    ahead.indices, ahead.indptr = ahead.indices.astype(np.int32), ahead.indptr.astype(np.int32)
    inside = np.zeros(lattice.size, dtype=bool)
    inside[members] = True
    sources, targets, _ = crossings
    back = against(ahead)
    return Region(
        members,
        ahead,
        back,
        local[np.unique(targets[inside[targets]])],
        local[np.unique(sources[inside[sources]])],
        landmarks or Landmarks(ahead, back, lattice.poses(members)[:, :2]),
    )
