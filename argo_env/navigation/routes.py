"""The cheapest ways through a lattice, found region by region: portals are where ways change from
one to the next, and within a region a search leads towards its goals."""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.stages import stage, stage_items
from argo_env.files.parts import NO_CACHE, Arrays, Parts
from argo_env.navigation.graphs import Graph, Trees, graph_of, graph_of_moves, search
from argo_env.navigation.lattice import Lattice
from argo_env.navigation.regions import Partition, Region, walk

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


Goals = tuple[NDArray[np.int64], NDArray[np.float64]]
"""States to go to, and what arriving at each costs besides, in s."""


@dataclass(frozen=True)
class _Crossing:
    """The cheapest way over portals: its cost (s), the exit (number of the region's) and the portal
    by which it leaves the region it begins in, and the region, entry and state where it ends."""

    cost: float
    leaving: int
    last: int
    area: Region
    arriving: int
    end: int


class Routes:
    """Finds the cheapest ways from state to state of a lattice. Keeps the ways between portals."""

    def __init__(self, lattice: Lattice, partition: Partition, parts: Parts = NO_CACHE) -> None:
        self.partition = partition
        self._parts = parts
        self._lattice = lattice

    def prepare(self) -> None:
        """Searches now what all later searches use."""
        with stage("finding the ways between floors"):
            portals = len(self._portals.states) > 0
        for area in stage_items("searching the ways of each part", self.partition.regions):
            area.landmarks.prepare()
            if portals:
                _ = area.to_exits

    def find(self, source: int, goals: Goals) -> list[int] | None:
        """The states on the cheapest way from `source` to one of the goals; None if there is none.

        Of ways that cost the same, equal arguments always give the same one.
        """
        part = self.partition
        crossing = self._crossing(source, goals)
        near = part.region[goals[0]] == part.region[source]
        if near.any():
            found = find_inside(
                part.regions[part.region[source]],
                int(part.local[source]),
                part.local[goals[0][near]],
                goals[1][near],
                crossing.cost if crossing else np.inf,
            )
            if found:
                return found[1]
        return self._way_over(source, crossing) if crossing else None

    def costs_from(self, source: int) -> NDArray[np.float64]:
        """The cost (s) of the cheapest way from `source` to every state; inf without one."""
        part, portals = self.partition, self._portals
        here = int(part.region[source])
        area = part.regions[here]
        costs = np.full(len(part.region), np.inf)
        inside = search(area.ahead, part.local[[source]])[0][0]
        exits = portals.exits(area)
        to_portals = (inside[area.exits][:, None] + portals.costs[exits]).min(
            axis=0, initial=np.inf
        )
        for number, there in enumerate(part.regions):
            entries = portals.entries(there)
            over = to_portals[entries][:, None] + there.from_entries[0]
            costs[there.members] = over.min(axis=0, initial=np.inf)
            if number == here:
                costs[there.members] = np.minimum(costs[there.members], inside)
        return costs

    def times(self, states: NDArray[np.int64], rows: int | None = None) -> NDArray[np.float64]:
        """The time (s) of the cheapest way from each of `states`, or from the first `rows` of them,
        to each other, shape (rows, n); inf where there is none."""
        part, portals = self.partition, self._portals
        rows = len(states) if rows is None else rows
        result = np.full((rows, len(states)), np.inf)
        region, local = part.region[states], part.local[states]
        present = np.unique(region).tolist()
        columns = {r: np.flatnonzero(region == r) for r in present}
        onwards = {
            r: costs_and_times(self._lattice, part.regions[r], local[columns[r]]) for r in present
        }
        sources = zip(region[:rows].tolist(), local[:rows].tolist(), strict=True)
        for row, (here, source) in enumerate(sources):
            area = part.regions[here]
            tree = search(area.ahead, np.array([source]))
            ends = np.concatenate([local[columns[here]], area.exits])
            costs, times = tree[0][0, ends], tree_times(self._lattice, area, tree, ends)[0]
            inside = len(columns[here])
            # To every portal of the site, by the best of the region's exits.
            exits = portals.exits(area)
            over = costs[inside:, None] + portals.costs[exits]
            best = over.argmin(axis=0) if len(exits) else np.empty(0, dtype=np.int64)
            every = np.arange(len(portals.states))
            for there in present:
                entries = portals.entries(part.regions[there])
                cost = np.full(len(columns[there]), np.inf)
                time = cost.copy()
                if len(exits) and len(entries):
                    to_entry = over[best, every][entries]
                    after = times[inside:][best] + portals.times[exits[best], every]
                    total = to_entry[:, None] + onwards[there][0]
                    entry = total.argmin(axis=0)
                    at = np.arange(len(entry))
                    cost = total[entry, at]
                    time = after[entries][entry] + onwards[there][1][entry, at]
                if there == here:
                    time = np.where(costs[:inside] <= cost, times[:inside], time)
                    cost = np.minimum(cost, costs[:inside])
                result[row, columns[there]] = np.where(np.isfinite(cost), time, np.inf)
        return result

    def _crossing(self, source: int, goals: Goals) -> _Crossing | None:
        """The cheapest way from `source` to one of the goals that leaves its region."""
        part, portals = self.partition, self._portals
        area, start = part.regions[part.region[source]], int(part.local[source])
        exits = portals.exits(area)
        if not len(exits):
            return None
        over = area.to_exits[0][:, start, None] + portals.costs[exits]
        to_portals = over.min(axis=0)
        best: _Crossing | None = None
        region = part.region[goals[0]]
        for there in np.unique(region).tolist():
            goal_area, chosen = part.regions[there], region == there
            entries = portals.entries(goal_area)
            if not len(entries):
                continue
            ends = part.local[goals[0][chosen]]
            total = to_portals[entries, None] + goal_area.from_entries[0][:, ends]
            total += goals[1][chosen]
            arriving, end = divmod(int(total.argmin()), total.shape[1])
            cost = float(total[arriving, end])
            if cost < (best.cost if best else np.inf):
                last = int(entries[arriving])
                leaving = int(over[:, last].argmin())
                best = _Crossing(cost, leaving, last, goal_area, arriving, int(ends[end]))
        return best

    def _way_over(self, source: int, crossing: _Crossing) -> list[int]:
        """The states of the way over portals."""
        part, portals = self.partition, self._portals
        area = part.regions[part.region[source]]
        first = int(portals.exits(area)[crossing.leaving])
        after = area.to_exits[1][crossing.leaving]
        way = area.members[[*walk(after, int(part.local[source]))]].tolist()
        hops = [*walk(portals.before[first], crossing.last)][::-1]
        for a, b in pairwise(hops):
            way += self._hop(int(portals.states[a]), int(portals.states[b]))
        before = crossing.area.from_entries[1][crossing.arriving]
        steps = [*walk(before, crossing.end)][::-1]
        return [*way, *crossing.area.members[steps[1:]].tolist()]

    def _hop(self, a: int, b: int) -> list[int]:
        """The states after portal `a` up to portal `b`, the next one on a cheapest way."""
        part = self.partition
        area = part.regions[part.region[a]]
        if part.region[b] != part.region[a]:
            return [b]
        tree = int(np.searchsorted(area.entries, part.local[a]))
        steps = [*walk(area.from_entries[1][tree], int(part.local[b]))][::-1]
        return [int(s) for s in area.members[steps[1:]]]

    @cached_property
    def _portals(self) -> Portals:
        return Portals(
            **self._parts.load_or_make(
                "portals", lambda: portals_arrays(find_portals(self._lattice, self.partition))
            )
        )
