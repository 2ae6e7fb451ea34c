"""Best route by enumeration of all routes, for the checks of what solvers claim.

Partial routes are pruned only if they cannot lead to a best route: if they are too late, or cannot
become the best even if their rest takes the least possible time. With dominance, a partial route is
also pruned if another one with the same blocks and locations is not later and has neither more
travel nor more energy used. Any continuation takes both equally long except for waiting, and
waiting ends at the same time for both.
"""

from collections.abc import Callable, Iterator
from fractions import Fraction
from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csr_array

from argo_compiler.route.blocks import Arrival, Blocks, Locations
from argo_compiler.route.problem import NEVER, Objective, Tour

_MOST_ARCS = 5_000
"""highest number of arcs between blocks for which dual prices are computed"""


class PartialRoute(NamedTuple):
    """Route up to the end of some block, or up to a charger."""

    time: int
    travel: int
    """time without waiting"""
    used: int
    """energy used since the last charge"""
    tour: Tour = Tour(())


Layer = dict[tuple[int, Locations], dict[tuple[int, int, int], PartialRoute]]
"""partial routes by their set of blocks and the robot's possible locations, and then by time,
travel and used energy"""


class Enumeration:
    """Enumeration of all routes that are better than a given prize and cost.

    A route is better if it wins more than the first of `better_than`, or as much and costs less
    than the second; if that is None, all routes are enumerated. Holds the best route so far. Needs
    exact blocks. `spend` is called before each step of work, and may raise an exception to end it.
    """

    def __init__(
        self, blocks: Blocks, better_than: tuple[int, int] | None, spend: Callable[[], None]
    ) -> None:
        self._blocks, self._problem, self._spend = blocks, blocks.problem, spend
        self._incumbent = better_than
        limit = blocks.problem.max_duration
        self._limit: float = inf if limit is None else limit
        self._leave, self._enter = _dual_prices(
            blocks.least_end_to_end_times, blocks.problem.selective
        )
        self._completions: dict[int, tuple[int, int, list[tuple[int, int]]]] = {}
        self.best: Tour | None = None
        """best route; None: none is better than `better_than`"""
        self.count = 0
        """number of partial routes"""

    def run(self, *, use_dominance: bool) -> None:
        """Enumerate the routes; store the best one, if better than `better_than`, in `best`.

        `use_dominance`: prune partial routes that another one with the same blocks and locations
        dominates; otherwise only equal ones are merged.
        """
        battery = self._problem.battery
        first = PartialRoute(0, 0, 0 if battery is None else battery.used)
        layer: Layer = {(0, frozenset([self._problem.size])): {first[:3]: first}}
        while layer:
            following: Layer = {}
            for (made, locations), partial_routes in layer.items():
                for partial in partial_routes.values():
                    self.count += 1
                    for origins, departing in self._departures(locations, partial):
                        self._finish(made, origins, departing)
                        for key, extended in self._extensions(made, origins, departing):
                            _add(following.setdefault(key, {}), extended, use_dominance)
            layer = following

    def _departures(
        self, locations: Locations, partial: PartialRoute
    ) -> Iterator[tuple[Locations, PartialRoute]]:
        """Yield a partial route as it is, and after a charge at each charger within reach.

        With each comes the set of locations from which the next drive may start.
        """
        yield locations, partial
        battery, tour = self._problem.battery, partial.tour
        for charger in range(len(self._problem.chargers)):
            arrived = self._after_drive(
                partial, self._blocks.worst_arrival(locations, self._problem.charger(charger))
            )
            if arrived is not None and battery is not None:
                charge = battery.overhead + arrived.used
                charged = Tour(tour.order, {**tour.charges, len(tour.order): charger})
                origins = frozenset([self._problem.charger(charger)])
                yield (
                    origins,
                    PartialRoute(arrived.time + charge, arrived.travel + charge, 0, charged),
                )

    def _after_drive(self, partial: PartialRoute, arrival: Arrival | None) -> PartialRoute | None:
        """Return the partial route after a drive or block, or None if the battery does not last."""
        battery = self._problem.battery
        if arrival is None or (
            battery is not None and partial.used + arrival[1] > battery.capacity
        ):
            return None
        return PartialRoute(
            partial.time + arrival[0],
            partial.travel + arrival[0],
            partial.used + arrival[1],
            partial.tour,
        )

    def _extensions(
        self, made: int, origins: Locations, partial: PartialRoute
    ) -> Iterator[tuple[tuple[int, Locations], PartialRoute]]:
        """Yield the partial route extended by each block that may come next.

        With each comes its key: the set of its blocks, and the robot's possible locations.
        """
        for block, visit in enumerate(self._blocks.visit):
            if not self._blocks.can_come_next(made, block):
                continue
            for arrival, order in self._blocks.distinct_executions(block, origins):
                self._spend()
                arrived = self._after_drive(partial, arrival)
                if arrived is None:
                    continue
                begin = max(arrived.time, visit.earliest)
                if visit.latest is not None and begin > visit.latest:
                    continue
                end, travel = begin + visit.service, arrived.travel + visit.service
                if not self._is_hopeless(made | 1 << block, block, end, travel):
                    tour = Tour(partial.tour.order + order, partial.tour.charges)
                    key = made | 1 << block, arrival[2]
                    yield key, PartialRoute(end, travel, arrived.used, tour)

    def _finish(self, made: int, origins: Locations, partial: PartialRoute) -> None:
        """Complete a partial route by the drive to the end; store it if it is feasible and best."""
        end = self._after_drive(partial, self._blocks.worst_arrival(origins, self._problem.end))
        if end is None or self._blocks.mandatory & ~made or end.time > self._limit:
            return
        prize, cost = self._prize(made), self._cost(end.time, end.travel)
        if self._incumbent is None or (-prize, cost) < (-self._incumbent[0], self._incumbent[1]):
            self._incumbent, self.best = (prize, cost), end.tour

    def _is_hopeless(self, made: int, last: int, time: int, travel: int) -> bool:
        """Return True if no completion of a partial route is in time and better than the best."""
        remaining_time, prize, optional = self._completion(made)
        least = max(0, remaining_time + self._leave[last])
        spare = self._limit - time - least
        if spare < 0 or self._incumbent is None:
            return spare < 0
        for block_time, gain in optional:
            # The last block counts in part, so that no selection of complete blocks wins more.
            prize += gain if block_time <= spare else int(gain * max(spare, 0)) // block_time
            spare -= block_time
        cost = self._cost(time + least, travel + least)
        return (-prize, cost) >= (-self._incumbent[0], self._incumbent[1])

    def _completion(self, made: int) -> tuple[int, int, list[tuple[int, int]]]:
        """Return bounds on the completions of partial routes that have made a set of blocks.

        The first is the least remaining time with all mandatory blocks, without the price of
        leaving the last block made. The second is the prize of the blocks made and of the mandatory
        ones. The list has the least time and the prize of each optional block that may still come,
        sorted by prize per time, highest first.
        """
        if made not in self._completions:
            blocks = self._blocks
            times = [e + o for e, o in zip(self._enter, self._leave, strict=True)]
            remaining = [b for b in range(blocks.count) if not made >> b & 1]
            mandatory = [b for b in remaining if blocks.mandatory >> b & 1]
            more = [b for b in remaining if b not in mandatory and not blocks.followers[b] & made]
            optional = [(times[b], blocks.prize[b]) for b in more]
            optional.sort(key=lambda block: Fraction(-block[1], block[0]) if block[0] else -inf)
            prize = self._prize(made) + sum(blocks.prize[b] for b in mandatory)
            self._completions[made] = (
                sum(times[b] for b in mandatory) + self._enter[-1],
                prize,
                optional,
            )
        return self._completions[made]

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


def _dual_prices(least_times: NDArray[np.int64], selective: bool) -> tuple[list[int], list[int]]:
    """Compute integer prices of leaving and of entering each block: an assignment problem's dual.

    The price of leaving one block and that of entering another are together at most the least time
    between them. If blocks are optional, leaving has no price; otherwise the sum of all prices is
    the highest possible one, except for rounding.
    """
    count = len(least_times)
    rows, columns = np.nonzero(least_times < NEVER)
    leave = np.zeros(count, np.int64)
    if not selective and 0 < len(rows) <= _MOST_ARCS:
        arcs = np.arange(len(rows))
        matrix = csr_array(
            (np.ones(2 * len(rows)), (np.tile(arcs, 2), np.append(rows, count + columns))),
            shape=(len(rows), 2 * count),
        )
        solution = milp(
            -np.ones(2 * count),
            bounds=Bounds(-inf, inf),
            constraints=LinearConstraint(matrix, ub=least_times[rows, columns]),
        )
        if solution.status == 0:
            leave = np.floor(solution.x[:count]).astype(np.int64)
    return leave.tolist(), (least_times - leave[:, None]).min(axis=0).tolist()


def _add(
    others: dict[tuple[int, int, int], PartialRoute], partial: PartialRoute, use_dominance: bool
) -> None:
    measures = partial[:3]
    if use_dominance:
        if any(all(a <= b for a, b in zip(o, measures, strict=True)) for o in others):
            return
        for other in [o for o in others if all(a <= b for a, b in zip(measures, o, strict=True))]:
            del others[other]
    others[measures] = partial
