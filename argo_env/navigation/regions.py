"""The lattice cut into regions, a storey each, that only a few states on the stairs connect.

A fastest way through several storeys goes from portal to portal, and what lies between the portals
of a region never changes. So a query searches near its two ends only. Nothing is lost by this: the
ways found are as cheap as those of one search over the whole lattice.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from argo_env.files.parts import NOWHERE, Arrays, Parts
from argo_env.navigation.graphs import Graph, Trees, against, part_of, search
from argo_env.navigation.landmarks import Landmarks
from argo_env.navigation.lattice import Lattice


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
    parts: Parts = NOWHERE
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

        trees = self.parts.made(f"{self.name}-{kind}", find)
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


def make_partition(lattice: Lattice, cuts: Sequence[float], parts: Parts = NOWHERE) -> Partition:
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
