"""Search for the cheapest paths through a lattice, region by region.

Paths change from region to region at portals. Within a region A* finds them.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.memoization import thread_safe_cached_property
from argo_compiler.base.stages import stage, stage_items
from argo_env.files.parts import NO_CACHE, Arrays, Parts
from argo_env.navigation.graphs import (
    Graph,
    Trees,
    make_graph,
    make_graph_of_moves,
    shortest_path_trees,
)
from argo_env.navigation.lattice import Lattice
from argo_env.navigation.regions import Partition, Region, walk_tree

_STEP = 4.0  # s by which each attempt raises the limit above the lower bound
_ATTEMPTS = 7  # with a limit, before the whole region is searched


def find_path_within(
    area: Region,
    source: int,
    ends: NDArray[np.int64],
    extra: NDArray[np.float64],
    max_cost: float = np.inf,
) -> tuple[float, list[int]] | None:
    """Return the cost (s) and the states of the cheapest path that stays in a region.

    This is A*: a search with move costs that are reduced by what the landmarks' bounds fall along
    the move. As scipy's searches end at a limit and not at a goal, the limit is raised until it is
    above the cost of a path.

    Args:
        area: Region to search in.
        source: State from which the path starts, in the region's own numbers.
        ends: States, one of which the path reaches, in the same numbers.
        extra: Additional cost (s) of each of `ends`.
        max_cost: Cost (s), `extra` included, up to which a path is of interest.

    Returns:
        The cost, `extra` included, and the states in the lattice's numbers; None if there is no
        path or it costs more than `max_cost`.
    """
    bounds = area.landmarks.lower_bounds_from_all_states(source, ends, extra)
    if bounds is None:
        bounds = np.zeros(len(area.members))
        limits, towards = [np.inf], area.forward
    else:
        limits = [*(_STEP * (1 + k) for k in range(_ATTEMPTS)), np.inf]
        towards = _reduced_costs(area, bounds)
    room = max_cost + 1e-6 - bounds[source]
    for limit in limits:
        costs, before = shortest_path_trees(towards, np.array([source]), max(0.0, min(limit, room)))
        total = costs[0, ends] - bounds[ends] + extra
        best = int(np.argmin(total))
        if np.isfinite(total[best]) and total[best] <= limit:
            cost = float(total[best] + bounds[source])
            if cost > max_cost:
                return None
            steps = [*walk_tree(before[0], int(ends[best]))][::-1]
            return cost, area.members[steps].tolist()
        if limit >= room:
            return None
    return None


def _reduced_costs(area: Region, bounds: NDArray[np.float64]) -> Graph:
    """Return the region's forward moves, each cheaper by what the bounds fall along it."""
    graph = area.forward
    costs = bounds.take(area.move_targets, mode="clip")  # twice as fast; all are in range
    costs -= np.repeat(bounds, np.diff(graph.indptr))
    costs += graph.data
    return make_graph(costs, graph.indices, graph.indptr)


@dataclass(frozen=True)
class Portals:
    """States where paths change from region to region, ascending, and the paths between them.

    For each two of them there are the cost and the time (s) of the cheapest path, and the last
    portal before its end, all of shape (n, n).
    """

    states: NDArray[np.int64]
    costs: NDArray[np.float64]
    times: NDArray[np.float64]
    before: NDArray[np.int32]

    def indices_of_entries(self, area: Region) -> NDArray[np.int64]:
        """Return the indices in `states` of the region's entries."""
        return np.searchsorted(self.states, area.members[area.entries])

    def indices_of_exits(self, area: Region) -> NDArray[np.int64]:
        """Return the indices in `states` of the region's exits."""
        return np.searchsorted(self.states, area.members[area.exits])


def portals_arrays(portals: Portals) -> Arrays:
    """Return portals as named arrays, for the disk cache."""
    return {
        "states": portals.states,
        "costs": portals.costs,
        "times": portals.times,
        "before": portals.before,
    }


def make_portals_with_paths(lattice: Lattice, part: Partition) -> Portals:
    """Return the portals of a partitioned lattice, and all paths between them."""
    sources, targets, costs = part.crossings
    states = np.unique(np.concatenate([sources, targets]))
    moves = [(sources, targets, costs, lattice.move_times(costs, sources, targets))]
    for area in part.regions:
        between, times = costs_and_times_from_entries(lattice, area, area.exits)
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
    move_times = np.zeros(shape)
    move_times[a, b] = seconds
    total, before = shortest_path_trees(
        make_graph_of_moves(costs, a, b, len(states)), np.arange(len(states))
    )
    times = np.zeros(shape)
    row, end = np.nonzero(before >= 0)
    here = end.copy()
    while len(row):
        last = before[row, here]
        times[row, end] += move_times[last, here]
        going = last != row
        row, end, here = row[going], end[going], last[going]
    return Portals(states, total, times, before)


def costs_and_times_from_entries(
    lattice: Lattice, area: Region, ends: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the costs and times (s) from each entry of a region to each of its states `ends`.

    The states are in the region's own numbers. Both arrays have the shape (entries, ends). Without
    a path, the cost is inf and the time 0.
    """
    return area.trees_from_entries[0][:, ends], times_from_tree_roots(
        lattice, area, area.trees_from_entries, ends
    )


def times_from_tree_roots(
    lattice: Lattice, area: Region, trees: Trees, ends: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return the time (s) of the path from the root of each tree to each of `ends`.

    The shape is (trees, ends). The time is 0 where there is no path, and at the root itself.

    Args:
        lattice: Lattice that the region is part of.
        area: Region whose states the trees connect.
        trees: Cheapest paths from some roots to all states of the region.
        ends: States of the region, in the region's own numbers.
    """
    costs, before = trees
    times = np.zeros((len(costs), len(ends)))
    tree, end = np.nonzero(before[:, ends] >= 0)
    here = ends[end]
    while len(here):
        last = before[tree, here]
        spent = costs[tree, here] - costs[tree, last]
        times[tree, end] += lattice.move_times(spent, area.members[last], area.members[here])
        going = before[tree, last] >= 0
        tree, end, here = tree[going], end[going], last[going].astype(np.int64)
    return times


Goals = tuple[NDArray[np.int64], NDArray[np.float64]]
"""states, one of which a path reaches, and the additional cost of each in s"""


@dataclass(frozen=True)
class _PortalPath:
    """Cheapest path that leaves the region in which it begins."""

    cost: float
    """cost in s"""
    leaving: int
    """number of the exit in the first region"""
    last: int
    """row of the last portal"""
    area: Region
    """region in which it ends"""
    arriving: int
    """number of the entry in that region"""
    end: int
    """state of that region in which it ends"""


class PathSearch:
    """Search for the cheapest paths from state to state of a lattice.

    It holds the paths between portals.
    """

    def __init__(self, lattice: Lattice, partition: Partition, parts: Parts = NO_CACHE) -> None:
        self.partition = partition
        self._parts = parts
        self._lattice = lattice

    def prepare(self) -> None:
        """Compute now what all later searches share: paths between portals, and landmarks."""
        with stage("finding the paths between floors"):
            portals = len(self._portals.states) > 0
        for area in stage_items("searching the paths of each part", self.partition.regions):
            area.landmarks.prepare()
            if portals:
                _ = area.trees_to_exits

    def find_path(self, source: int, goals: Goals) -> list[int] | None:
        """Return the states on the cheapest path from `source` to any one of the goals.

        Both ends are included, and the additional cost of the goal counts. None means that there is
        no path. Of paths of equal cost, equal arguments always give the same one.
        """
        part = self.partition
        portal_path = self._portal_path(source, goals)
        near = part.region[goals[0]] == part.region[source]
        if near.any():
            inside = find_path_within(
                part.regions[part.region[source]],
                int(part.local[source]),
                part.local[goals[0][near]],
                goals[1][near],
                portal_path.cost if portal_path else np.inf,
            )
            if inside:
                return inside[1]
        return self._path_over(source, portal_path) if portal_path else None

    def costs_from(self, source: int) -> NDArray[np.float64]:
        """Return the cost (s) of the cheapest path from `source` to each state; inf without one."""
        part, portals = self.partition, self._portals
        here = int(part.region[source])
        area = part.regions[here]
        costs = np.full(len(part.region), np.inf)
        inside = shortest_path_trees(area.forward, part.local[[source]])[0][0]
        exits = portals.indices_of_exits(area)
        to_portals = (inside[area.exits][:, None] + portals.costs[exits]).min(
            axis=0, initial=np.inf
        )
        for number, there in enumerate(part.regions):
            entries = portals.indices_of_entries(there)
            over = to_portals[entries][:, None] + there.trees_from_entries[0]
            costs[there.members] = over.min(axis=0, initial=np.inf)
            if number == here:
                costs[there.members] = np.minimum(costs[there.members], inside)
        return costs

    def travel_times(
        self, states: NDArray[np.int64], source_count: int | None = None
    ) -> NDArray[np.float64]:
        """Return the time (s) of the cheapest path between `states`, shape (source_count, n).

        If `source_count` is given, paths start from the first `source_count` states only. The time
        is inf where there is no path.
        """
        part, portals = self.partition, self._portals
        source_count = len(states) if source_count is None else source_count
        result = np.full((source_count, len(states)), np.inf)
        region, local = part.region[states], part.local[states]
        present = np.unique(region).tolist()
        columns = {r: np.flatnonzero(region == r) for r in present}
        onwards = {
            r: costs_and_times_from_entries(self._lattice, part.regions[r], local[columns[r]])
            for r in present
        }
        sources = zip(region[:source_count].tolist(), local[:source_count].tolist(), strict=True)
        for row, (here, source) in enumerate(sources):
            area = part.regions[here]
            tree = shortest_path_trees(area.forward, np.array([source]))
            ends = np.concatenate([local[columns[here]], area.exits])
            costs, times = (
                tree[0][0, ends],
                times_from_tree_roots(self._lattice, area, tree, ends)[0],
            )
            inside = len(columns[here])
            # To each portal of the site, by the best of the region's exits.
            exits = portals.indices_of_exits(area)
            over = costs[inside:, None] + portals.costs[exits]
            best = over.argmin(axis=0) if len(exits) else np.empty(0, dtype=np.int64)
            every = np.arange(len(portals.states))
            for there in present:
                entries = portals.indices_of_entries(part.regions[there])
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

    def _portal_path(self, source: int, goals: Goals) -> _PortalPath | None:
        """Return the cheapest path from `source` over portals to a goal, in any region.

        Returns None if there is none.
        """
        part, portals = self.partition, self._portals
        area, start = part.regions[part.region[source]], int(part.local[source])
        exits = portals.indices_of_exits(area)
        if not len(exits):
            return None
        over = area.trees_to_exits[0][:, start, None] + portals.costs[exits]
        to_portals = over.min(axis=0)
        best: _PortalPath | None = None
        region = part.region[goals[0]]
        for there in np.unique(region).tolist():
            goal_area, chosen = part.regions[there], region == there
            entries = portals.indices_of_entries(goal_area)
            if not len(entries):
                continue
            ends = part.local[goals[0][chosen]]
            total = to_portals[entries, None] + goal_area.trees_from_entries[0][:, ends]
            total += goals[1][chosen]
            arriving, end = divmod(int(total.argmin()), total.shape[1])
            cost = float(total[arriving, end])
            if cost < (best.cost if best else np.inf):
                last = int(entries[arriving])
                leaving = int(over[:, last].argmin())
                best = _PortalPath(cost, leaving, last, goal_area, arriving, int(ends[end]))
        return best

    def _path_over(self, source: int, portal_path: _PortalPath) -> list[int]:
        """Return the states of a path over portals, from `source` to its goal, both included."""
        part, portals = self.partition, self._portals
        area = part.regions[part.region[source]]
        first = int(portals.indices_of_exits(area)[portal_path.leaving])
        after = area.trees_to_exits[1][portal_path.leaving]
        states = area.members[[*walk_tree(after, int(part.local[source]))]].tolist()
        visited = [*walk_tree(portals.before[first], portal_path.last)][::-1]
        for a, b in pairwise(visited):
            states += self._states_between(int(portals.states[a]), int(portals.states[b]))
        before = portal_path.area.trees_from_entries[1][portal_path.arriving]
        steps = [*walk_tree(before, portal_path.end)][::-1]
        return [*states, *portal_path.area.members[steps[1:]].tolist()]

    def _states_between(self, a: int, b: int) -> list[int]:
        """Return the states after portal `a` up to and including `b`, the next portal on a path."""
        part = self.partition
        area = part.regions[part.region[a]]
        if part.region[b] != part.region[a]:
            return [b]
        tree = int(np.searchsorted(area.entries, part.local[a]))
        steps = [*walk_tree(area.trees_from_entries[1][tree], int(part.local[b]))][::-1]
        return [int(s) for s in area.members[steps[1:]]]

    @thread_safe_cached_property
    def _portals(self) -> Portals:
        return Portals(
            **self._parts.load_or_make(
                "portals",
                lambda: portals_arrays(make_portals_with_paths(self._lattice, self.partition)),
            )
        )
