"""Blocks of a problem and the times between them, for checks that use none of the solvers' code.

A round (`Round`) is here a group of visits, its members, with all its repetitions. A block is a
visit outside of rounds, or an outermost round with all its members: a route does not interrupt it.
The time of a round depends on where the robot comes from and on the order of its members, but not
on when the round begins, as its members have no time windows.
"""

from collections.abc import Callable
from functools import cached_property
from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.evaluation import state_after_all_repetitions
from argo_compiler.route.problem import NEVER, RouteProblem, Visit

Locations = frozenset[int]
"""possible locations of the robot; the worst one counts for the next drive"""

Arrival = tuple[int, int, Locations]
"""time and energy of a drive or a block, and the robot's possible locations at its end"""

_MOST_MEMBERS = 7
"""highest number of members of a round whose orders are all enumerated"""


class Blocks:
    """Blocks of a problem, by their numbers; sets of blocks are the bits of an integer.

    Caches the executions of its blocks. `spend` is called before each step of work, and may raise
    an exception to end it.
    """

    def __init__(self, problem: RouteProblem, spend: Callable[[], None]) -> None:
        self.problem, self._spend = problem, spend
        rounds = problem.rounds
        widest = sorted(range(len(rounds)), key=lambda k: (-len(rounds[k].members), k))
        around = {v: k for k in reversed(widest) for v in rounds[k].members}
        self._round: list[int | None] = list(dict.fromkeys(around.values()))
        self.members = [rounds[k].members for k in self._round if k is not None]
        loose = [(v,) for v in range(problem.size) if v not in around]
        self.members += loose
        self._round += [None] * len(loose)
        self.count = len(self.members)
        self._before = {
            (first, second)
            for precedence in problem.precedences
            for k, second in enumerate(precedence.sequence)
            for first in precedence.sequence[:k]
        }
        self.exact = all(len(members) <= _MOST_MEMBERS for members in self.members)
        """true if `distinct_executions` returns all executions of each block; if false, it returns
        lower bounds for large rounds"""
        self._orders = [self._feasible_orders(members) for members in self.members]
        visits_by_block = [[problem.visits[v] for v in members] for members in self.members]
        self.prize = [sum(visit.prize for visit in visits) for visits in visits_by_block]
        self.mandatory = sum(
            1 << b
            for b, visits in enumerate(visits_by_block)
            if any(visit.mandatory for visit in visits)
        )
        with_round = zip(visits_by_block, self._round, strict=True)
        self.visit = [visits[0] if k is None else Visit("") for visits, k in with_round]
        """visit, with service and time window, of each block; an empty one for rounds"""
        self.followers, self.needs = [0] * self.count, [0] * self.count
        """for each block, the set of those that can't come before it, and of those that must"""
        self._add_precedences()
        self._executions: dict[tuple[int, Locations], list[tuple[Arrival, tuple[int, ...]]]] = {}

    def _add_precedences(self) -> None:
        block = {v: b for b, members in enumerate(self.members) for v in members}
        for precedence in self.problem.precedences:
            numbers = [block[v] for v in precedence.sequence]
            for k, second in enumerate(numbers):
                for first in numbers[:k]:
                    if first != second:
                        self.followers[first] |= 1 << second
                        self.needs[second] |= 1 << first if precedence.needed else 0

    def can_come_next(self, made_mask: int, block: int) -> bool:
        """Return True if the precedences allow a block next when those of `made_mask` are made.

        `made_mask` has a bit for each block.
        """
        return (
            not made_mask & (self.followers[block] | 1 << block)
            and not self.needs[block] & ~made_mask
        )

    def worst_arrival(self, origins: Locations, goal: int) -> Arrival | None:
        """Return the worst arrival after a drive to a location, or None if it may be impossible.

        The robot may be at any of `origins`, its possible locations. So the longest time and the
        highest energy of the drives from them count. A drive is impossible without a path, and if
        it needs more energy than a full battery has.
        """
        self._spend()
        battery = self.problem.battery
        time = max(int(self.problem.travel[origin, goal]) for origin in origins)
        energy = 0
        if battery is not None:
            energy = max(int(battery.energy[origin, goal]) for origin in origins)
        if time >= NEVER or (battery is not None and energy > battery.capacity):
            return None
        return time, energy, frozenset([goal])

    def distinct_executions(
        self, block: int, origins: Locations
    ) -> list[tuple[Arrival, tuple[int, ...]]]:
        """Return the possible executions of a block: of each, the arrival and the order of members.

        `origins` are the robot's possible locations before the block. The arrival at a single visit
        is before its service; that of a round is after all its repetitions, services included. Of
        orders with the same arrival only one is returned. If `exact` is false, large rounds have
        lower bounds as arrivals, and arbitrary orders.
        """
        if (block, origins) not in self._executions:
            self._executions[block, origins] = self._compute_executions(block, origins)
        return self._executions[block, origins]

    def _compute_executions(
        self, block: int, origins: Locations
    ) -> list[tuple[Arrival, tuple[int, ...]]]:
        number, members = self._round[block], self.members[block]
        if number is None:
            arrival = self.worst_arrival(origins, members[0])
            return [] if arrival is None or not self._orders[block] else [(arrival, members)]
        if len(members) > _MOST_MEMBERS:
            least = self._least_time(members)
            return [((least, 0, frozenset([v])), members) for v in members]
        order_by_arrival: dict[Arrival, tuple[int, ...]] = {}
        for order in self._orders[block]:
            self._spend()
            arrival = state_after_all_repetitions(self.problem, number, order, origins)
            if arrival is not None:
                order_by_arrival.setdefault(arrival, order)
        return list(order_by_arrival.items())

    def _feasible_orders(self, members: tuple[int, ...]) -> list[tuple[int, ...]]:
        """Return the orders of a block's members that the precedences and inner rounds allow.

        An order must not interrupt an inner round. Returns an empty list for large rounds.
        """
        if len(members) > _MOST_MEMBERS:
            return []
        inner = [set(r.members) for r in self.problem.rounds if set(r.members) <= set(members)]
        return [order for order in permutations(members) if self._is_feasible(order, inner)]

    def _is_feasible(self, order: tuple[int, ...], inner: list[set[int]]) -> bool:
        self._spend()
        for k, second in enumerate(order):
            if any((second, first) in self._before for first in order[: k + 1]):
                return False
        positions = [[k for k, v in enumerate(order) if v in group] for group in inner]
        return all(group[-1] - group[0] + 1 == len(group) for group in positions)

    def _least_time(self, members: tuple[int, ...]) -> int:
        """Return a lower bound on the time of a large round.

        It is the least time of one repetition or, if less, the shortest duration that may
        interrupt it.
        """
        inner = [r for r in self.problem.rounds if set(r.members) <= set(members)]
        once = sum(
            int(np.delete(self.problem.travel[:, v], v).min()) + self.problem.visits[v].service
            for v in members
        )
        return min([once, *(r.duration for r in inner if r.duration and not r.soft)])

    @cached_property
    def least_end_to_end_times(self) -> NDArray[np.int64]:
        """Least time from the end of each block to the end of each other.

        It includes the drive, straight or by a charger, and the execution of the latter block.

        Shape (n + 1, n + 1) with n blocks: the last row is the start, the last column the end.
        NEVER: the block can't follow.
        """
        n, first = self.count, (self.count, frozenset([self.problem.size]))
        times = np.full((n + 1, n + 1), NEVER, np.int64)
        waiting, seen = [first], {first}
        while waiting:
            last, locations = waiting.pop()
            for added, origins in self._departures(locations):
                arrival = self.worst_arrival(origins, self.problem.end)
                if arrival and (last == n or not self.followers[last] & self.mandatory):
                    times[last, n] = min(times[last, n], added + arrival[0])
                for b in range(n):
                    if b == last or (last < n and self.followers[b] >> last & 1):
                        continue
                    for (time, _, end), _ in self.distinct_executions(b, origins):
                        block_time = added + time + self.visit[b].service
                        times[last, b] = min(times[last, b], block_time)
                        if (b, end) not in seen:
                            seen.add((b, end))
                            waiting.append((b, end))
        return times

    def _departures(self, locations: Locations) -> list[tuple[int, Locations]]:
        """Return pairs of the least time until the next drive starts, and its possible origins.

        In the first pair the drive starts at once, from one of the robot's possible `locations`. In
        each other one it starts at a charger within reach, after the drive there and a charge. The
        times are in the unit of the problem.
        """
        departures = [(0, locations)]
        for charger in range(len(self.problem.chargers)):
            arrival = self.worst_arrival(locations, self.problem.charger(charger))
            if arrival is not None and self.problem.battery is not None:
                departures.append(
                    (arrival[0] + self.problem.battery.overhead + arrival[1], arrival[2])
                )
        return departures
