"""What can come next on a route, and how long it takes: for the checks of what solvers claim, which
use none of the solvers' code.

A block is what is made as one: a visit outside of rounds, or an outermost round with all that lies
in it. How long a round takes depends on where the robot comes from and on the order of its members,
but not on when, for its members have no time windows.
"""

from collections.abc import Callable
from functools import cached_property
from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.evaluation import after_rounds
from argo_compiler.route.problem import NEVER, RouteProblem, Visit

Places = frozenset[int]
"""where the robot may be: it is reckoned with the worst"""

Reached = tuple[int, int, Places]
"""the time and energy that it takes to where the robot is then"""

_MOST_MEMBERS = 7
"""of a round whose orders are all gone through"""


class Blocks:
    """A problem's blocks, by their numbers; sets of blocks are the bits of a whole number.

    `spend` is called before each step of work, and may raise what ends it.
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
        """whether `made` tells all there is; else, of larger rounds, what takes less than any"""
        self._orders = [self._legal_orders(members) for members in self.members]
        made = [[problem.visits[v] for v in members] for members in self.members]
        self.prize = [sum(visit.prize for visit in visits) for visits in made]
        self.mandatory = sum(
            1 << b for b, visits in enumerate(made) if any(visit.mandatory for visit in visits)
        )
        alone = zip(made, self._round, strict=True)
        self.visit = [visits[0] if k is None else Visit("") for visits, k in alone]
        """service and time window of a block that is no round"""
        self.followers, self.needs = [0] * self.count, [0] * self.count
        """for each block, those that can't be made before it, and those that have to be"""
        self._find_order()
        self._made: dict[tuple[int, Places], list[tuple[Reached, tuple[int, ...]]]] = {}

    def _find_order(self) -> None:
        block = {v: b for b, members in enumerate(self.members) for v in members}
        for precedence in self.problem.precedences:
            numbers = [block[v] for v in precedence.sequence]
            for k, second in enumerate(numbers):
                for first in numbers[:k]:
                    if first != second:
                        self.followers[first] |= 1 << second
                        self.needs[second] |= 1 << first if precedence.needed else 0

    def may_follow(self, made: int, block: int) -> bool:
        """Whether a block may be made after a set of others."""
        return not made & (self.followers[block] | 1 << block) and not self.needs[block] & ~made

    def way(self, places: Places, place: int) -> Reached | None:
        """At a place, with the time and energy from where the robot is; None: there is no way."""
        self._spend()
        battery = self.problem.battery
        time = max(int(self.problem.travel[origin, place]) for origin in places)
        energy = 0
        if battery is not None:
            energy = max(int(battery.energy[origin, place]) for origin in places)
        if time >= NEVER or (battery is not None and energy > battery.capacity):
            return None
        return time, energy, frozenset([place])

    def made(self, block: int, places: Places) -> list[tuple[Reached, tuple[int, ...]]]:
        """The ways to make a block from there: when it is over (when a visit is reached), the
        energy used till then and where the robot is, with the order of the members."""
        if (block, places) not in self._made:
            self._made[block, places] = self._find_made(block, places)
        return self._made[block, places]

    def _find_made(self, block: int, places: Places) -> list[tuple[Reached, tuple[int, ...]]]:
        number, members = self._round[block], self.members[block]
        if number is None:
            there = self.way(places, members[0])
            return [] if there is None or not self._orders[block] else [(there, members)]
        if len(members) > _MOST_MEMBERS:
            least = self._least(members)
            return [((least, 0, frozenset([v])), members) for v in members]
        found: dict[Reached, tuple[int, ...]] = {}
        for order in self._orders[block]:
            self._spend()
            there = after_rounds(self.problem, number, order, places)
            if there is not None:
                found.setdefault(there, order)
        return list(found.items())

    def _legal_orders(self, members: tuple[int, ...]) -> list[tuple[int, ...]]:
        """The orders that keep to what comes before what, and the rounds inside together."""
        if len(members) > _MOST_MEMBERS:
            return []
        inside = [set(r.members) for r in self.problem.rounds if set(r.members) <= set(members)]
        return [order for order in permutations(members) if self._legal(order, inside)]

    def _legal(self, order: tuple[int, ...], inside: list[set[int]]) -> bool:
        self._spend()
        for k, second in enumerate(order):
            if any((second, first) in self._before for first in order[: k + 1]):
                return False
        places = [[k for k, v in enumerate(order) if v in group] for group in inside]
        return all(there[-1] - there[0] + 1 == len(there) for there in places)

    def _least(self, members: tuple[int, ...]) -> int:
        """One pass of all members, or the duration after which some round is left at the least."""
        inside = [r for r in self.problem.rounds if set(r.members) <= set(members)]
        once = sum(
            int(np.delete(self.problem.travel[:, v], v).min()) + self.problem.visits[v].service
            for v in members
        )
        return min([once, *(r.duration for r in inside if r.duration and not r.soft)])

    @cached_property
    def between(self) -> NDArray[np.int64]:
        """The least time from the end of each block to the end of each other, by way of a charger
        or not, shape (n + 1, n + 1) with n blocks: the last row is the start, the last column the
        end. NEVER: it can't follow."""
        n, first = self.count, (self.count, frozenset([self.problem.size]))
        times = np.full((n + 1, n + 1), NEVER, np.int64)
        waiting, seen = [first], {first}
        while waiting:
            last, places = waiting.pop()
            for added, there in self._departures(places):
                home = self.way(there, self.problem.end)
                if home and (last == n or not self.followers[last] & self.mandatory):
                    times[last, n] = min(times[last, n], added + home[0])
                for b in range(n):
                    if b == last or (last < n and self.followers[b] >> last & 1):
                        continue
                    for (time, _, then), _ in self.made(b, there):
                        takes = added + time + self.visit[b].service
                        times[last, b] = min(times[last, b], takes)
                        if (b, then) not in seen:
                            seen.add((b, then))
                            waiting.append((b, then))
        return times

    def _departures(self, places: Places) -> list[tuple[int, Places]]:
        """Where the robot may set off from, and after what time at least: from here, or charged."""
        found = [(0, places)]
        for charger in range(len(self.problem.chargers)):
            way = self.way(places, self.problem.charger(charger))
            if way is not None and self.problem.battery is not None:
                found.append((way[0] + self.problem.battery.overhead + way[1], way[2]))
        return found
