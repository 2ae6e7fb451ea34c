"""Routes that are likely to be completed, instead of short ones.

If all ways were independent and normal, with no windows, rounds and battery, the most probable
route would be one that minimises mean + weight x variance for some weight (E. Nikolova, J. Kelner,
M. Brand, M. Mitzenmacher, "Stochastic shortest paths via quasi-convex maximization", ESA 2006). So
problems with such times are solved for some weights around the one that would be right, together
with ones whose limits are drawn in, and the routes are improved by local search on samples that all
of them share. None of this is a proof: the result is the best of the routes that were tried.
"""

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Conflict, Invalid
from argo_compiler.route.problem import NEVER, RouteProblem, Tour
from argo_compiler.route.robust_sampling import Completion, Draws, completion
from argo_compiler.route.robust_spread import TravelSpread
from argo_compiler.route.suggested import RouteSuggestion
from argo_compiler.route.suggestion import suggest_route

SEARCHED = 2000
"""samples on which routes are compared in the search"""
JUDGED = 10_000
"""samples, others than those, on which the result is judged"""
_WEIGHTS = (0.5, 1.0, 2.0)
"""of the variance, times the one that would be right if the route stayed the same"""
_MARGINS = (0.5, 1.0, 1.6, 2.3, 3.0)
"""standard deviations of the duration by which limits are drawn in"""
_LONGEST_MOVED = 3
"""visits that local search moves at once"""


@dataclass(frozen=True)
class RobustSuggestion:
    """The route, and the one that is best without any spread, judged on the same samples."""

    route: Tour
    completion: Completion
    prize: int
    nominal: RouteSuggestion
    nominal_completion: Completion
    tried: int
    """how many different routes were compared"""

    @property
    def dropped(self) -> tuple[int, ...]:
        """The visits that the route without any spread makes, and this one does not."""
        return tuple(sorted(set(self.nominal.order) - set(self.route.order)))


def suggest_robust_route(
    problem: RouteProblem,
    spread: TravelSpread,
    time_limit: float = 10.0,
    seed: int = 0,
    confidence: float = 0.95,
) -> RobustSuggestion:
    """The route that is most probably completed, of those that are found within the limit (s).

    Where visits may be left out, the one with the most prize of those that are completed with a
    probability of at least `confidence`; if there is none, the most probable one.

    Raises ArgoError if there is no route even without any spread, or none is found.
    """
    if not 0.0 < confidence <= 1.0:
        raise Invalid(f"a confidence of {confidence} is none; give one above 0 and up to 1")
    nominal = suggest_route(problem, time_limit / 4.0, seed)
    # From here: the first search imports OR-Tools, which may take longer than the time limit.
    end = time.monotonic() + time_limit * 0.75
    if nominal.route is None:
        why = "; ".join(nominal.infeasible_subset) or "none was found within the time limit"
        raise Conflict(f"there is no route: {why}; relax what it must keep to, or give more time")
    search = _Search(problem, Draws(spread, SEARCHED, _rng(seed, 0)), confidence)
    search.consider(nominal.route)
    if search.all_done:
        end = -math.inf
    varied = [*_variations(problem, spread, search.deviation(nominal.route))]
    for k, variation in enumerate(varied):
        # Half of the time that is left is for the local search.
        share = (end - time.monotonic()) / 2.0 / (len(varied) - k)
        if share <= 0.0:
            break
        found = suggest_route(variation, share, seed, explain=False)
        if found.route is not None:
            search.consider(found.route)
    search.improve(lambda: time.monotonic() < end)
    judged = Draws(spread, JUDGED, _rng(seed, 1))
    routes = [search.best, nominal.route]
    completions = [completion(problem, route, judged) for route in routes]
    keys = [_key(problem, *one, confidence) for one in zip(routes, completions, strict=True)]
    # Luck on the few samples of the search must not make a route worse than the usual one.
    pick = 0 if keys[0] >= keys[1] else 1
    return RobustSuggestion(
        routes[pick],
        completions[pick],
        _prize(problem, routes[pick]),
        nominal,
        completions[1],
        search.tried,
    )


def _rng(seed: int, purpose: int) -> np.random.Generator:
    return np.random.default_rng((seed, purpose))


def _prize(problem: RouteProblem, route: Tour) -> int:
    return sum(problem.visits[visit].prize for visit in route.order)


_Key = tuple[float, int, float, float]


def _key(problem: RouteProblem, route: Tour, found: Completion, confidence: float) -> _Key:
    """What makes a route better than another, the greater first."""
    sure = min(found.probability, confidence)
    prize = _prize(problem, route) if found.probability > 0.0 else 0
    return (sure, prize, found.probability, -found.duration)


class _Search:
    """Compares routes on the same samples. Holds the best one so far."""

    def __init__(self, problem: RouteProblem, draws: Draws, confidence: float) -> None:
        self._problem, self._draws, self._confidence = problem, draws, confidence
        self._best: tuple[_Key, Tour] | None = None
        self._seen: set[tuple[tuple[int, ...], tuple[tuple[int, int], ...]]] = set()

    @property
    def tried(self) -> int:
        """How many different routes were compared."""
        return len(self._seen)

    @property
    def best(self) -> Tour:
        assert self._best is not None
        return self._best[1]

    @property
    def all_done(self) -> bool:
        """Whether all prize is won in all samples, so that there is nothing to gain."""
        assert self._best is not None
        (_, prize, probability, _), _ = self._best
        return probability == 1.0 and prize == sum(visit.prize for visit in self._problem.visits)

    def consider(self, route: Tour) -> bool:
        """Takes the route if it is the best one so far, and tells whether it is."""
        same = (route.order, tuple(sorted(route.charges.items())))
        if same in self._seen:
            return False
        self._seen.add(same)
        found = completion(self._problem, route, self._draws)
        key = _key(self._problem, route, found, self._confidence)
        if self._best is not None and key <= self._best[0]:
            return False
        self._best = (key, route)
        return True

    def deviation(self, route: Tour) -> float:
        """About the standard deviation of a route's duration, in units."""
        found = completion(self._problem, route, self._draws)
        return max(0.0, (found.duration_95 - found.duration) / 1.645)

    def improve(self, go_on: Callable[[], bool]) -> None:
        """Changes the best route in small ways until none of them makes it better."""
        better = True
        while better:
            better = False
            for changed in _neighbours(self._problem, self.best):
                if not go_on():
                    return
                if self.consider(changed):
                    better = True
                    break


def _neighbours(problem: RouteProblem, route: Tour) -> Iterator[Tour]:
    """Routes with some visits moved, a part reversed, one left out or one more made.

    Charges stay at their positions as far as these exist.
    """
    order = route.order
    n = len(order)

    def changed(*parts: tuple[int, ...]) -> Tour:
        made = sum(parts, ())
        return Tour(made, {k: c for k, c in route.charges.items() if k <= len(made)})

    for size in range(1, _LONGEST_MOVED + 1):
        for k in range(n - size + 1):
            rest, moved = order[:k] + order[k + size :], order[k : k + size]
            for to in range(len(rest) + 1):
                if to != k:
                    yield changed(rest[:to], moved, rest[to:])
    for k in range(n):
        for end in range(k + 3, n + 1):  # shorter ones are moves
            yield changed(order[:k], order[k:end][::-1], order[end:])
    for k, visit in enumerate(order):
        if not problem.visits[visit].mandatory:
            yield changed(order[:k], order[k + 1 :])
    for visit in sorted(set(range(problem.size)) - set(order)):
        for k in range(n + 1):
            yield changed(order[:k], (visit,), order[k:])


def _variations(
    problem: RouteProblem, spread: TravelSpread, deviation: float
) -> Iterator[RouteProblem]:
    """Problems without any spread whose best routes may be likely to be completed in this one."""
    mean = _with_means(problem, spread)
    yield mean
    if problem.max_duration is not None and deviation > 0.0:
        # Where the probability is that of a normal distribution, a unit of variance costs as much
        # as margin / (2 x deviation) units of the mean, with a margin of one to two deviations.
        variance = _variances(problem, spread)
        for weight in _WEIGHTS:
            yield _slower(mean, variance * weight / deviation)
    for margin in _MARGINS:
        yield _drawn_in(mean, margin * deviation, spread, margin)


def _with_means(problem: RouteProblem, spread: TravelSpread) -> RouteProblem:
    delay = spread.delay_chance * spread.delay / problem.unit
    visits = tuple(
        replace(visit, service=round(visit.service * (1.0 + spread.repeat_chance)))
        for visit in problem.visits
    )
    return _slower(replace(problem, visits=visits), np.full(problem.travel.shape, delay))


def _variances(problem: RouteProblem, spread: TravelSpread) -> NDArray[np.float64]:
    """Of the time of each way, in units squared."""
    delay = spread.delay / problem.unit
    held_up = spread.delay_chance * (2.0 - spread.delay_chance) * delay**2
    variances: NDArray[np.float64] = (spread.way * problem.travel.astype(np.float64)) ** 2 + held_up
    return variances


def _slower(problem: RouteProblem, more: NDArray[np.float64]) -> RouteProblem:
    longest = NEVER >> 4  # the longest time that a route problem takes
    with_more = np.rint(np.minimum(problem.travel + more, longest)).astype(np.int64)
    return replace(problem, travel=np.where(problem.travel >= NEVER, NEVER, with_more))


def _drawn_in(
    problem: RouteProblem, margin: float, spread: TravelSpread, deviations: float
) -> RouteProblem:
    """With less time until all limits, and less in the battery."""
    less = round(margin)
    visits = tuple(
        visit
        if visit.latest is None
        else replace(visit, latest=max(visit.earliest, visit.latest - less))
        for visit in problem.visits
    )
    limit, battery = problem.max_duration, problem.battery
    if limit is not None:
        limit = max(0, limit - less)
    if battery is not None:
        share = 1.0 - deviations * float(np.hypot(spread.common, spread.way))
        battery = replace(battery, capacity=round(battery.capacity * max(0.0, share)))
    return replace(problem, visits=visits, max_duration=limit, battery=battery)
