"""The cheapest ways through a lattice, found region by region."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import dijkstra

from argo_env.navigation.lattice import Lattice
from argo_env.navigation.raster import CELL
from argo_env.navigation.regions import Partition, Region, Trees, search
from argo_env.navigation.stencil import HEADINGS, heading_angle

_SHARE = 0.6  # of the time in the open: the first radius of two searches that should meet
_GROWTH = 1.3  # of the radius where they did not meet
_ROUNDS = 3  # before the whole region is searched

Goals = tuple[NDArray[np.int64], NDArray[np.float64]]
"""States to go to, and what arriving at each costs besides, in s."""


@dataclass(frozen=True)
class Portals:
    """All states where ways change from region to region, ascending, and between each two of them
    the cost and the time (s) of the cheapest way, shape (n, n), and the portal before the last."""

    states: NDArray[np.int64]
    costs: NDArray[np.float64]
    times: NDArray[np.float64]
    before: NDArray[np.int32]

    def numbers(self, states: NDArray[np.int64]) -> NDArray[np.int64]:
        """The rows of portals that are given as states."""
        return np.searchsorted(self.states, states)


class Routes:
    """Finds the cheapest ways from state to state of a lattice. Keeps the ways between portals."""

    def __init__(self, lattice: Lattice, partition: Partition) -> None:
        self.partition = partition
        self._lattice = lattice
        self._longest_move = float(lattice.costs.data.max(initial=0.0))

    def prepare(self) -> None:
        """Searches the ways between the portals now."""
        if len(self._portals.states):
            for area in self.partition.regions:
                _ = area.to_exits

    def find(self, source: int, goals: Goals) -> list[int] | None:
        """The states on the cheapest way from `source` to one of the goals; None if there is none.

        Of ways that cost the same, equal arguments always give the same one.
        """
        part = self.partition
        here = part.region[source]
        near = part.region[goals[0]] == here
        cost, way = np.inf, None
        if near.any():
            inside = (goals[0][near], goals[1][near])
            cost, way, elsewhere = self._inside(part.regions[here], source, inside)
            if near.all() and cost <= elsewhere:
                return way
        return self._over_portals(source, goals, cost) or way

    def costs_from(self, source: int) -> NDArray[np.float64]:
        """The cost (s) of the cheapest way from `source` to every state; inf without one."""
        part, portals = self.partition, self._portals
        here = int(part.region[source])
        area = part.regions[here]
        costs = np.full(len(part.region), np.inf)
        inside = search(area.ahead, part.local[[source]])[0][0]
        exits = portals.numbers(area.members[area.exits])
        to_portals = (inside[area.exits][:, None] + portals.costs[exits]).min(
            axis=0, initial=np.inf
        )
        for number, there in enumerate(part.regions):
            entries = portals.numbers(there.members[there.entries])
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
        onwards = {r: self._costs_and_times(r, local[columns[r]]) for r in present}
        sources = zip(region[:rows].tolist(), local[:rows].tolist(), strict=True)
        for row, (here, source) in enumerate(sources):
            area = part.regions[here]
            tree = search(area.ahead, np.array([source]))
            ends = np.concatenate([local[columns[here]], area.exits])
            costs, times = tree[0][0, ends], self._seconds(area, tree, ends)[0]
            inside = len(columns[here])
            # To every portal of the site, by the best of the region's exits.
            exits = portals.numbers(area.members[area.exits])
            over = costs[inside:, None] + portals.costs[exits]
            best = over.argmin(axis=0) if len(exits) else np.empty(0, dtype=np.int64)
            every = np.arange(len(portals.states))
            for there in present:
                entries = portals.numbers(part.regions[there].members[part.regions[there].entries])
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

    def _inside(
        self, area: Region, source: int, goals: Goals
    ) -> tuple[float, list[int] | None, float]:
        """The cheapest way that stays in the region: its cost and its states, and a cost that no
        way that leaves the region can be below.

        Two searches, from the source and from the goals, grow until they surely have met on the
        cheapest way: when no way that costs less than twice their radius is left out.
        """
        start = int(self.partition.local[source])
        ends = self.partition.local[goals[0]]
        back = _with_root(area.back, ends, goals[1])
        root = back.shape[0] - 1
        radius = _SHARE * self._in_the_open(source, goals)
        for attempt in range(_ROUNDS + 2):
            if attempt > _ROUNDS:
                radius = np.inf
            # A move further, so that the last state within the radius has met the next one.
            from_start = search(area.ahead, np.array([start]), radius + self._longest_move)
            to_root = search(back, np.array([root]), radius + 1.0)
            behind, before = from_start[0][0], from_start[1][0]
            left, after = to_root[0][0, :root] - 1.0, to_root[1][0]
            total = behind + left
            middle = int(np.argmin(total))
            cost = float(total[middle])
            if cost <= 2 * radius or radius == np.inf:
                break
            radius = cost / 2 + 1e-9 if np.isfinite(cost) else radius * _GROWTH
        out = min(radius, behind[area.exits].min(initial=np.inf))
        elsewhere = out + min(radius, left[area.entries].min(initial=np.inf))
        if not len(area.exits) or not len(area.entries):
            elsewhere = np.inf
        if not np.isfinite(cost):
            return np.inf, None, elsewhere
        steps = [*_walk(before, middle)][::-1] + [*_walk(after, middle)][1:-1]
        return cost, area.members[steps].tolist(), elsewhere

    def _in_the_open(self, source: int, goals: Goals) -> float:
        """What the way to the nearest of the goals would cost without any obstacle, in s: turn,
        drive along one heading, turn, drive along the next heading, turn, and arrive."""
        lattice = self._lattice
        surface, robot = lattice.surface, lattice.robot
        cell, start = lattice.cell[goals[0]], lattice.cell[source]
        across, up = surface.i[cell] - surface.i[start], surface.j[cell] - surface.j[start]
        diagonal = np.minimum(np.abs(across), np.abs(up))
        straight = np.maximum(np.abs(across), np.abs(up)) - diagonal
        octant = np.round(np.arctan2(np.sign(up), np.sign(across)) / heading_angle(1))
        along_x = np.abs(across) > np.abs(up)
        main = np.where(along_x, np.where(across > 0, 0, 4), np.where(up > 0, 2, 6))
        legs = [
            (np.where(diagonal > 0, octant.astype(np.int64), main), diagonal * np.sqrt(2.0)),
            (np.where(straight > 0, main, octant.astype(np.int64)), straight),
        ]
        second = heading_angle(1) / robot.turn_rate_radians
        best = np.full(len(cell), np.inf)
        for first, then in (legs, legs[::-1]):
            for gear in (0, HEADINGS // 2):
                for other in (0, HEADINGS // 2):
                    a, b = first[0] + gear, then[0] + other
                    turns = _turned(lattice.heading[source], a) + _turned(a, b)
                    turns += _turned(b, lattice.heading[goals[0]])
                    speeds = [robot.reverse_speed if g else robot.speed for g in (gear, other)]
                    drive = first[1] * CELL / speeds[0] + then[1] * CELL / speeds[1]
                    best = np.minimum(best, turns * second + drive)
        return float((best + goals[1]).min())

    def _over_portals(self, source: int, goals: Goals, below: float) -> list[int] | None:
        """The cheapest way that leaves its region, if it costs less than `below` (s)."""
        part, portals = self.partition, self._portals
        area, start = part.regions[part.region[source]], int(part.local[source])
        exits = portals.numbers(area.members[area.exits])
        if not len(exits):
            return None
        to_exits, after = area.to_exits
        over = to_exits[:, start, None] + portals.costs[exits]
        found: tuple[Region, int, int] | None = None
        region = part.region[goals[0]]
        for there in np.unique(region).tolist():
            goal_area, chosen = part.regions[there], region == there
            entries = portals.numbers(goal_area.members[goal_area.entries])
            if not len(entries):
                continue
            ends = part.local[goals[0][chosen]]
            costs = over.min(axis=0)[entries, None] + goal_area.from_entries[0][:, ends]
            total = costs + goals[1][chosen]
            best = divmod(int(total.argmin()), total.shape[1])
            if total[best] < below:
                below = float(total[best])
                found = goal_area, best[0], int(ends[best[1]])
        if found is None:
            return None
        goal_area, arriving, end = found
        last = int(portals.numbers(goal_area.members[goal_area.entries[[arriving]]])[0])
        leaving = int(over[:, last].argmin())
        way = area.members[[*_walk(after[leaving], start)]].tolist()
        hops = [*_walk(portals.before[exits[leaving]], last)][::-1]
        for a, b in pairwise(hops):
            way += self._hop(int(portals.states[a]), int(portals.states[b]))
        steps = [*_walk(goal_area.from_entries[1][arriving], end)][::-1]
        return [*way, *goal_area.members[steps[1:]].tolist()]

    def _hop(self, a: int, b: int) -> list[int]:
        """The states after portal `a` up to portal `b`, the next one on a cheapest way."""
        part = self.partition
        area = part.regions[part.region[a]]
        if part.region[b] != part.region[a]:
            return [b]
        tree = int(np.searchsorted(area.entries, part.local[a]))
        steps = [*_walk(area.from_entries[1][tree], int(part.local[b]))][::-1]
        return [int(s) for s in area.members[steps[1:]]]

    @cached_property
    def _portals(self) -> Portals:
        part = self.partition
        sources, targets, costs = part.crossings
        states = np.unique(np.concatenate([sources, targets]))
        seconds = self._lattice.seconds(costs, sources, targets)
        moves = [(sources, targets, costs, seconds)]
        for number, area in enumerate(part.regions):
            between, times = self._costs_and_times(number, area.exits)
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
        total, before = dijkstra(
            csr_array(coo_array((costs, (a, b)), shape=shape)), return_predecessors=True
        )
        times = np.zeros(shape)
        row, end = np.nonzero(before >= 0)
        here = end.copy()
        while len(row):
            last = before[row, here]
            times[row, end] += hop[last, here]
            going = last != row
            row, end, here = row[going], end[going], last[going]
        return Portals(states, total, times, before)

    def _costs_and_times(
        self, region: int, ends: NDArray[np.int64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """From each entry of a region to each of its states `ends`, shape (entries, ends)."""
        area = self.partition.regions[region]
        return area.from_entries[0][:, ends], self._seconds(area, area.from_entries, ends)

    def _seconds(self, area: Region, trees: Trees, ends: NDArray[np.int64]) -> NDArray[np.float64]:
        """The time (s) of the way to each of `ends` in each tree, shape (trees, ends); 0 where
        there is none."""
        costs, before = trees
        times = np.zeros((len(costs), len(ends)))
        tree, end = np.nonzero(before[:, ends] >= 0)
        here = ends[end]
        while len(here):
            last = before[tree, here]
            spent = costs[tree, here] - costs[tree, last]
            times[tree, end] += self._lattice.seconds(spent, area.members[last], area.members[here])
            going = before[tree, last] >= 0
            tree, end, here = tree[going], end[going], last[going].astype(np.int64)
        return times


def _turned(a: NDArray[np.int64], b: NDArray[np.int64]) -> NDArray[np.int64]:
    """Headings of the lattice from one to the other, the short way round."""
    aside: NDArray[np.int64] = (a - b) % HEADINGS
    return np.minimum(aside, HEADINGS - aside)


def _walk(following: NDArray[np.int32], start: int) -> Iterator[int]:
    """`start` and what follows it, up to the end."""
    while start >= 0:
        yield start
        start = int(following[start])


def _with_root(back: csr_array, ends: NDArray[np.int64], extra: NDArray[np.float64]) -> csr_array:
    """The graph with one state more, from which moves of cost 1 + `extra` (s) lead to the `ends`.

    The 1 is there because no move may cost nothing.
    """
    size = back.shape[0] + 1
    return csr_array(
        (
            np.concatenate([back.data, extra + 1.0]),
            np.concatenate([back.indices, ends.astype(np.int32)]),
            np.concatenate([back.indptr, [back.nnz + len(ends)]]).astype(np.int32),
        ),
        shape=(size, size),
    )
