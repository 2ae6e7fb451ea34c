"""The best route by going through all of them, for the checks of what solvers claim.

Left out is only what can't matter: what is too late already, or can't be the best any more, even if
all that is to come takes as little as it ever does; and, if asked for, a beginning of a route that
is later, has been on the way for longer and has used more energy than another one that has made the
same and stands at the same place. Whatever follows takes both equally long but for waiting, and
that ends at the same time for both.
"""

from collections.abc import Callable, Iterator
from fractions import Fraction
from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csr_array

from argo_compiler.route.blocks import Blocks, Places
from argo_compiler.route.problem import NEVER, Objective, Tour

_MOST_ARCS = 5_000
"""between blocks, for which prices are looked for"""


class Beginning(NamedTuple):
    """A route up to the end of some block, or up to a charger."""

    time: int
    travel: int
    """the same less waiting"""
    used: int
    """of the battery"""
    tour: Tour = Tour(())


Beginnings = dict[tuple[int, Places], dict[tuple[int, int, int], Beginning]]
"""by the blocks that are made and where the robot may be, and by time, travel and use"""


class Exhaustion:
    """Goes through all routes that win more than the first of `better_than`, or as much at less
    than the second; through all, if it is None. Needs exact blocks. `spend` may raise what ends
    it. Has state."""

    def __init__(
        self, blocks: Blocks, better_than: tuple[int, int] | None, spend: Callable[[], None]
    ) -> None:
        self._blocks, self._problem, self._spend = blocks, blocks.problem, spend
        self._worth = better_than
        limit = blocks.problem.max_duration
        self._limit: float = inf if limit is None else limit
        self._leave, self._enter = _prices(blocks.between, blocks.problem.selective)
        self._to_come: dict[int, tuple[int, int, list[tuple[int, int]]]] = {}
        self.best: Tour | None = None
        """None: none is better"""
        self.count = 0
        """of beginnings of routes that were gone through"""

    def run(self, *, same_place: bool) -> None:
        """`same_place`: whether beginnings that have made the same and stand at the same place are
        compared; else all are gone through that are not equal."""
        battery = self._problem.battery
        first = Beginning(0, 0, 0 if battery is None else battery.used)
        layer: Beginnings = {(0, frozenset([self._problem.size])): {first[:3]: first}}
        while layer:
            following: Beginnings = {}
            for (made, places), beginnings in layer.items():
                for one in beginnings.values():
                    self.count += 1
                    for there, now in self._departures(places, one):
                        self._finish(made, there, now)
                        for key, then in self._next(made, there, now):
                            _keep(following.setdefault(key, {}), then, same_place)
            layer = following

    def _departures(self, places: Places, one: Beginning) -> Iterator[tuple[Places, Beginning]]:
        """From here, or charged at each charger."""
        yield places, one
        battery, tour = self._problem.battery, one.tour
        for charger in range(len(self._problem.chargers)):
            way = self._moved(one, self._blocks.way(places, self._problem.charger(charger)))
            if way is not None and battery is not None:
                charge = battery.overhead + way.used
                charged = Tour(tour.order, {**tour.charges, len(tour.order): charger})
                there = frozenset([self._problem.charger(charger)])
                yield there, Beginning(way.time + charge, way.travel + charge, 0, charged)

    def _moved(self, one: Beginning, way: tuple[int, int, Places] | None) -> Beginning | None:
        """After a way, if the battery lasts."""
        battery = self._problem.battery
        if way is None or (battery is not None and one.used + way[1] > battery.capacity):
            return None
        return Beginning(one.time + way[0], one.travel + way[0], one.used + way[1], one.tour)

    def _next(
        self, made: int, places: Places, now: Beginning
    ) -> Iterator[tuple[tuple[int, Places], Beginning]]:
        """After each block that may come next."""
        for block, visit in enumerate(self._blocks.visit):
            if not self._blocks.may_follow(made, block):
                continue
            for reached, order in self._blocks.made(block, places):
                self._spend()
                there = self._moved(now, reached)
                if there is None:
                    continue
                begin = max(there.time, visit.earliest)
                if visit.latest is not None and begin > visit.latest:
                    continue
                end, travel = begin + visit.service, there.travel + visit.service
                if not self._hopeless(made | 1 << block, block, end, travel):
                    tour = Tour(now.tour.order + order, now.tour.charges)
                    key = made | 1 << block, reached[2]
                    yield key, Beginning(end, travel, there.used, tour)

    def _finish(self, made: int, places: Places, now: Beginning) -> None:
        """Keeps the route that ends here, if there is one and it is better."""
        end = self._moved(now, self._blocks.way(places, self._problem.end))
        if end is None or self._blocks.mandatory & ~made or end.time > self._limit:
            return
        prize, cost = self._prize(made), self._cost(end.time, end.travel)
        if self._worth is None or (-prize, cost) < (-self._worth[0], self._worth[1]):
            self._worth, self.best = (prize, cost), end.tour

    def _hopeless(self, made: int, last: int, time: int, travel: int) -> bool:
        """Whether no route that begins so is in time and better than the best."""
        to_come, prize, optional = self._left(made)
        least = max(0, to_come + self._leave[last])
        room = self._limit - time - least
        if room < 0 or self._worth is None:
            return room < 0
        for takes, gain in optional:
            # Of the last one a part: no choice of whole ones wins more.
            prize += gain if takes <= room else int(gain * max(room, 0)) // takes
            room -= takes
        cost = self._cost(time + least, travel + least)
        return (-prize, cost) >= (-self._worth[0], self._worth[1])

    def _left(self, made: int) -> tuple[int, int, list[tuple[int, int]]]:
        """The least time still to come, and the prize with that; the least time and the prize of
        each block that may come beside, first of what wins most for its time."""
        if made not in self._to_come:
            blocks = self._blocks
            takes = [e + o for e, o in zip(self._enter, self._leave, strict=True)]
            left = [b for b in range(blocks.count) if not made >> b & 1]
            sure = [b for b in left if blocks.mandatory >> b & 1]
            more = [b for b in left if b not in sure and not blocks.followers[b] & made]
            optional = [(takes[b], blocks.prize[b]) for b in more]
            optional.sort(key=lambda one: Fraction(-one[1], one[0]) if one[0] else -inf)
            prize = self._prize(made) + sum(blocks.prize[b] for b in sure)
            self._to_come[made] = sum(takes[b] for b in sure) + self._enter[-1], prize, optional
        return self._to_come[made]

    def _prize(self, made: int) -> int:
        return sum(prize for b, prize in enumerate(self._blocks.prize) if made >> b & 1)

    def _cost(self, time: int, travel: int) -> int:
        match self._problem.objective:
            case Objective.DURATION:
                return time
            case Objective.TRAVEL:
                return travel
            case Objective.PRIZE:
                return 0


def _prices(between: NDArray[np.int64], selective: bool) -> tuple[list[int], list[int]]:
    """Whole prices of leaving and of entering each block that together are nowhere more than what
    lies between: of entering alone where something may be left out, else those that come to most,
    but for rounding."""
    count = len(between)
    rows, columns = np.nonzero(between < NEVER)
    leave = np.zeros(count, np.int64)
    if not selective and 0 < len(rows) <= _MOST_ARCS:
        arcs = np.arange(len(rows))
        matrix = csr_array(
            (np.ones(2 * len(rows)), (np.tile(arcs, 2), np.append(rows, count + columns))),
            shape=(len(rows), 2 * count),
        )
        found = milp(
            -np.ones(2 * count),
            bounds=Bounds(-inf, inf),
            constraints=LinearConstraint(matrix, ub=between[rows, columns]),
        )
        if found.status == 0:
            leave = np.floor(found.x[:count]).astype(np.int64)
    return leave.tolist(), (between - leave[:, None]).min(axis=0).tolist()


def _keep(others: dict[tuple[int, int, int], Beginning], one: Beginning, same_place: bool) -> None:
    worth = one[:3]
    if same_place:
        if any(all(a <= b for a, b in zip(o, worth, strict=True)) for o in others):
            return
        for other in [o for o in others if all(a <= b for a, b in zip(worth, o, strict=True))]:
            del others[other]
    others[worth] = one
