"""Robust routes: those with a high probability of completion, instead of the shortest ones.

If the times of all legs were independent and normal, without windows, rounds and battery, the most
probable route would minimise mean + weight x variance for some weight (E. Nikolova, J. Kelner,
M. Brand, M. Mitzenmacher, "Stochastic shortest paths via quasi-convex maximization", ESA 2006). So
problems with such times are solved for some weights around the one that would be right, and
problems with tightened limits as well. Local search improves the routes on samples that all of them
share. None of this is a proof: the result is the best of the routes that were tried.
"""

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Conflict, Invalid
from argo_compiler.base.message import Message
from argo_compiler.route.problem import NEVER, RouteProblem, Tour
from argo_compiler.route.robust_sampling import Completion, Draws, estimate_completion
from argo_compiler.route.robust_spread import TravelSpread
from argo_compiler.route.suggested import RouteSuggestion
from argo_compiler.route.suggestion import suggest_route

SEARCH_SAMPLES = 2000
"""number of samples on which the search compares routes"""
FINAL_SAMPLES = 10_000
"""number of other samples, on which the result is estimated"""
_WEIGHTS = (0.5, 1.0, 2.0)
"""weights of the variance, as multiples of the right one for the nominal route"""
_MARGINS = (0.5, 1.0, 1.6, 2.3, 3.0)
"""margins by which limits are tightened, in standard deviations of the duration"""
_LONGEST_MOVED = 3
"""highest number of visits that local search moves at once"""


@dataclass(frozen=True)
class RobustSuggestion:
    """Robust route and the best route without any spread, estimated on the same samples."""

    route: Tour
    completion: Completion
    prize: int
    nominal: RouteSuggestion
    nominal_completion: Completion
    tried: int
    """number of different routes compared"""

    @property
    def dropped_for_robustness(self) -> tuple[int, ...]:
        """Visits that this route leaves out, but the best route without any spread makes."""
        return tuple(sorted(set(self.nominal.order or ()) - set(self.route.order)))


def suggest_robust_route(
    problem: RouteProblem,
    spread: TravelSpread,
    time_limit: float = 10.0,
    seed: int = 0,
    confidence: float = 0.95,
) -> RobustSuggestion:
    """Search for the route with the highest probability of completion, within `time_limit` s.

    If visits are optional, the result is the route with the highest prize among those with a
    probability of at least `confidence`; if there is none, the most probable one.

    Raises Invalid if `confidence` is not above 0 and at most 1, and Conflict if there is no route
    even without any spread, or none is found.
    """
    if not 0.0 < confidence <= 1.0:
        raise Invalid(
            Message(
                "a confidence of {confidence} is not possible; give one above 0 and up to 1",
                confidence=confidence,
            )
        )
    nominal = suggest_route(problem, time_limit / 4.0, seed)
    # The time counts from here: the first search imports OR-Tools, which may take longer than that.
    end = time.monotonic() + time_limit * 0.75
    if nominal.route is None:
        if not nominal.infeasible:
            raise Conflict("no route was found within the time limit: give more time")
        why = "; ".join(nominal.infeasible_subset) or "the constraints contradict each other"
        raise Conflict(Message("there is no route: {why}; relax its constraints", why=why))
    search = _Search(problem, Draws(spread, SEARCH_SAMPLES, _rng(seed, 0)), confidence)
    search.consider(nominal.route)
    if search.is_perfect:
        end = -math.inf
    varied = [*_variations(problem, spread, search.deviation(nominal.route))]
    for k, variation in enumerate(varied):
        # Half of the remaining time is for the local search.
        share = (end - time.monotonic()) / 2.0 / (len(varied) - k)
        if share <= 0.0:
            break
        suggestion = suggest_route(variation, share, seed, explain=False)
        if suggestion.route is not None:
            search.consider(suggestion.route)
    search.improve(lambda: time.monotonic() < end)
    final_draws = Draws(spread, FINAL_SAMPLES, _rng(seed, 1))
    routes = [search.best, nominal.route]
    completions = [estimate_completion(problem, route, final_draws) for route in routes]
    keys = [_key(problem, *pair, confidence) for pair in zip(routes, completions, strict=True)]
    # A route that was only lucky on the few samples of the search must not replace the nominal one.
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


def _key(problem: RouteProblem, route: Tour, estimate: Completion, confidence: float) -> _Key:
    """Return the sort key of a route: of two routes, the one with the greater key is better.

    It compares the probability of completion up to `confidence`, then the prize, the probability
    itself, and the shorter mean duration.
    """
    sufficient = min(estimate.probability, confidence)
    prize = _prize(problem, route) if estimate.probability > 0.0 else 0
    return (sufficient, prize, estimate.probability, -estimate.duration)


class _Search:
    """Comparison of routes on the same samples, which holds the best one so far."""

    def __init__(self, problem: RouteProblem, draws: Draws, confidence: float) -> None:
        self._problem, self._draws, self._confidence = problem, draws, confidence
        self._best: tuple[_Key, Tour] | None = None
        self._seen: set[tuple[tuple[int, ...], tuple[tuple[int, int], ...]]] = set()

    @property
    def tried(self) -> int:
        """Number of different routes compared."""
        return len(self._seen)

    @property
    def best(self) -> Tour:
        assert self._best is not None
        return self._best[1]

    @property
    def is_perfect(self) -> bool:
        """True if the best route wins all prizes in all samples, so that no route is better."""
        assert self._best is not None
        (_, prize, probability, _), _ = self._best
        return probability == 1.0 and prize == sum(visit.prize for visit in self._problem.visits)

    def consider(self, route: Tour) -> bool:
        """Store a route if it is better than the best one so far; return True if it was stored."""
        identity = (route.order, tuple(sorted(route.charges.items())))
        if identity in self._seen:
            return False
        self._seen.add(identity)
        estimate = estimate_completion(self._problem, route, self._draws)
        key = _key(self._problem, route, estimate, self._confidence)
        if self._best is not None and key <= self._best[0]:
            return False
        self._best = (key, route)
        return True

    def deviation(self, route: Tour) -> float:
        """Return an estimate of the standard deviation of a route's duration.

        Its unit is that of the problem.
        """
        estimate = estimate_completion(self._problem, route, self._draws)
        return max(0.0, (estimate.duration_95 - estimate.duration) / 1.645)

    def improve(self, has_time: Callable[[], bool]) -> None:
        """Replace the best route by a better neighbour until there is none, or the time is up."""
        improved = True
        while improved:
            improved = False
            for neighbour in _neighbours(self._problem, self.best):
                if not has_time():
                    return
                if self.consider(neighbour):
                    improved = True
                    break


def _neighbours(problem: RouteProblem, route: Tour) -> Iterator[Tour]:
    """Yield routes with some visits moved, a part reversed, a visit left out or one added.

    Charges stay at their positions as far as these exist.
    """
    order = route.order
    n = len(order)

    def changed(*parts: tuple[int, ...]) -> Tour:
        joined = sum(parts, ())
        return Tour(joined, {k: c for k, c in route.charges.items() if k <= len(joined)})

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
    """Yield problems without any spread whose best routes may be robust in this problem."""
    mean = _with_mean_times(problem, spread)
    yield mean
    if problem.max_duration is not None and deviation > 0.0:
        # With a normal distribution, a unit of variance costs as much as margin / (2 x deviation)
        # units of the mean, with a margin of one to two deviations.
        variance = _variances(problem, spread)
        for weight in _WEIGHTS:
            yield _with_longer_legs(mean, variance * weight / deviation)
    for margin in _MARGINS:
        yield _with_tighter_limits(mean, margin * deviation, spread, margin)


def _with_mean_times(problem: RouteProblem, spread: TravelSpread) -> RouteProblem:
    delay = spread.delay_chance * spread.delay / problem.unit
    visits = tuple(
        replace(visit, service=round(visit.service * (1.0 + spread.repeat_chance)))
        for visit in problem.visits
    )
    return _with_longer_legs(replace(problem, visits=visits), np.full(problem.travel.shape, delay))


def _variances(problem: RouteProblem, spread: TravelSpread) -> NDArray[np.float64]:
    """Return the variance of the time of each leg, in units squared."""
    delay = spread.delay / problem.unit
    of_delay = spread.delay_chance * (2.0 - spread.delay_chance) * delay**2
    variances: NDArray[np.float64] = (
        spread.way * problem.travel.astype(np.float64)
    ) ** 2 + of_delay
    return variances


def _with_longer_legs(problem: RouteProblem, extra: NDArray[np.float64]) -> RouteProblem:
    longest = NEVER >> 4  # far below NEVER, which means that there is no path
    longer = np.rint(np.minimum(problem.travel + extra, longest)).astype(np.int64)
    return replace(problem, travel=np.where(problem.travel >= NEVER, NEVER, longer))


def _with_tighter_limits(
    problem: RouteProblem, margin: float, spread: TravelSpread, deviations: float
) -> RouteProblem:
    """Return the problem with earlier limits and a smaller battery.

    `margin`: units by which the limits are earlier; `deviations`: standard deviations of the energy
    by which the battery is smaller.
    """
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
