"""How probable it is that a route is completed: many runs of it at once.

What a route means is `argo_compiler.route.evaluation`; here the same is done with arrays, whose
items are the samples, and with times that are drawn. Without any spread both agree.
"""

from collections import Counter
from dataclasses import dataclass, field, replace
from functools import lru_cache
from math import log1p, sqrt

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Invalid
from argo_compiler.route.evaluation import evaluate
from argo_compiler.route.problem import NEVER, EnergyBudget, RouteProblem, Tour
from argo_compiler.route.robust_spread import TravelSpread

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

_Z = 1.959964
"""95 % of a normal distribution lie within so many standard deviations"""
_KEPT = 4_000_000
"""samples of ways that are kept, all ways together"""


@dataclass(frozen=True)
class Completion:
    """How probable it is that a route keeps to everything: the maximum duration, time windows and
    the battery."""

    probability: float
    low: float
    high: float
    """the interval that holds the true probability in 95 of 100 cases (E. B. Wilson, 1927)"""
    samples: int
    duration: float
    """mean over the samples, in units; infinite if the order itself is not allowed"""
    duration_95: float
    """within which 95 % of the samples are at the end, in units"""


class Draws:
    """The random parts of many runs, the same for all routes that they are drawn for: so that
    routes differ by what they are and not by luck. Keeps what it has drawn."""

    def __init__(self, spread: TravelSpread, samples: int, rng: np.random.Generator) -> None:
        """Raises ArgoError if there are no samples."""
        if samples < 1:
            raise Invalid(f"{samples} samples tell nothing; ask for 1 or more")
        self.spread, self.samples = spread, samples
        self._root = int(rng.integers(2**63))
        self.common = _factors(spread.common, samples, self._generator(0))
        self.way = lru_cache(_KEPT // samples)(self._way)

    def _way(self, place: int, time: int) -> tuple[Floats, Floats, Floats]:
        """Of the way that leads to a place for the `time`-th time: factors, delays (s), and how
        often the service there is done."""
        spread, rng = self.spread, self._generator(1, place, time)
        factors = self.common * _factors(spread.way, self.samples, rng)
        held_up = rng.random(self.samples) < spread.delay_chance
        delays = np.where(held_up, rng.exponential(spread.delay, self.samples), 0.0)
        services = np.where(rng.random(self.samples) < spread.repeat_chance, 2.0, 1.0)
        return factors, delays, services

    def _generator(self, *purpose: int) -> np.random.Generator:
        return np.random.default_rng((self._root, *purpose))


def _factors(deviation: float, samples: int, rng: np.random.Generator) -> Floats:
    """Log-normal with mean 1 and that standard deviation."""
    variance = log1p(deviation**2)
    return np.exp(rng.normal(-variance / 2.0, sqrt(variance), samples))


def completion_probability(
    problem: RouteProblem,
    route: Tour,
    spread: TravelSpread,
    samples: int,
    rng: np.random.Generator,
) -> Completion:
    """How probable it is that the robot completes the route.

    Raises ArgoError if there are no samples.
    """
    return completion(problem, route, Draws(spread, samples, rng))


def completion(problem: RouteProblem, route: Tour, draws: Draws) -> Completion:
    """The same, over runs that have been drawn."""
    walk = _Walk(problem, draws)
    if _is_none(problem, route):
        walk.done[:] = False
        walk.time[:] = np.inf
    else:
        walk.follow(route)
    n, share = draws.samples, float(walk.done.mean())
    middle = (share + _Z**2 / (2 * n)) / (1 + _Z**2 / n)
    half = _Z / (1 + _Z**2 / n) * sqrt(share * (1 - share) / n + _Z**2 / (4 * n**2))
    return Completion(
        share,
        max(0.0, min(share, middle - half)),
        min(1.0, max(share, middle + half)),
        n,
        float(walk.time.mean()),
        float(np.quantile(walk.time, 0.95, method="inverted_cdf")),
    )


def _is_none(problem: RouteProblem, route: Tour) -> bool:
    """Whether the route breaks what has nothing to do with times: as if all ways took none."""
    visits = tuple(replace(visit, earliest=0, latest=None) for visit in problem.visits)
    travel = np.zeros_like(problem.travel)
    battery = None if problem.battery is None else EnergyBudget(travel, capacity=0)
    timeless = replace(problem, visits=visits, travel=travel, max_duration=None, battery=battery)
    return not evaluate(timeless, route).feasible


@dataclass
class _Walk:
    """Follows a route in all samples. Holds where and when the robot is in each."""

    problem: RouteProblem
    draws: Draws
    time: Floats = field(init=False)
    used: Floats = field(init=False)
    done: Bools = field(init=False)
    """whether all has been kept to so far"""
    _where: NDArray[np.int64] = field(init=False)
    """number of the set of places at which the robot may be: it is reckoned with the worst"""
    _sets: list[tuple[int, ...]] = field(init=False)
    _times: Counter[int] = field(default_factory=Counter)
    """how often ways to each place have been driven"""

    def __post_init__(self) -> None:
        samples, battery = self.draws.samples, self.problem.battery
        self.time = np.zeros(samples)
        self.used = np.full(samples, 0.0 if battery is None else float(battery.used))
        self.done = np.ones(samples, dtype=np.bool_)
        self._where = np.zeros(samples, dtype=np.int64)
        self._sets = [(self.problem.size,)]

    def follow(self, route: Tour) -> None:
        everyone = np.ones(self.draws.samples, dtype=np.bool_)
        position = 0
        while position < len(route.order):
            self._charge(everyone, route, position)
            around = self._around(route.order[position])
            size = len(self.problem.rounds[around[0]].members) if around else 1
            part = route.order[position : position + size]
            if around:
                self._rounds(everyone, around[0], part)
            else:
                self._visit(everyone, part[0])
            position += size
        self._charge(everyone, route, len(route.order))
        self._drive(everyone, self.problem.end)
        if self.problem.max_duration is not None:
            self.done &= self.time <= self.problem.max_duration

    def _around(self, visit: int) -> list[int]:
        """The rounds around a visit, from the outermost."""
        rounds = self.problem.rounds
        numbers = [k for k, one in enumerate(rounds) if visit in one.members]
        return sorted(numbers, key=lambda k: (-len(rounds[k].members), k))

    def _put(self, who: Bools, places: tuple[int, ...]) -> None:
        if who.all():
            self._sets = []
        if places not in self._sets:
            self._sets.append(places)
        self._where[who] = self._sets.index(places)

    def _drive(self, who: Bools, place: int) -> Floats:
        """To the place; how often the service there is done."""
        factors, delays, services = self.draws.way(place, self._times[place])
        self._times[place] += 1
        nominal = self._worst(self.problem.travel, place)
        self.done &= ~(who & (nominal >= NEVER))
        self.time += np.where(who, nominal * factors + delays / self.problem.unit, 0.0)
        if self.problem.battery is not None:
            energy = self._worst(self.problem.battery.energy, place) * factors
            self.used += np.where(who, energy, 0.0)
            self.done &= ~(who & (self.used > self.problem.battery.capacity))
        self._put(who, (place,))
        return services

    def _worst(self, matrix: NDArray[np.int64], place: int) -> NDArray[np.int64]:
        worst = np.array([max(matrix[origin, place] for origin in one) for one in self._sets])
        found: NDArray[np.int64] = worst[self._where]
        return found

    def _charge(self, who: Bools, route: Tour, position: int) -> None:
        battery, number = self.problem.battery, route.charges.get(position)
        if battery is not None and number is not None:
            self._drive(who, self.problem.charger(number))
            self.time[who] += battery.overhead + self.used[who]
            self.used[who] = 0.0

    def _visit(self, who: Bools, number: int) -> None:
        visit = self.problem.visits[number]
        services = self._drive(who, number)
        if visit.earliest:
            self.time[who] = np.maximum(self.time[who], visit.earliest)
        if visit.latest is not None:
            self.done &= ~(who & (self.time > visit.latest))
        if visit.service:
            self.time += np.where(who, visit.service * services, 0.0)

    def _rounds(self, who: Bools, number: int, order: tuple[int, ...]) -> None:
        """All rounds of one Round in those samples."""
        one = self.problem.rounds[number]
        entered, who, rounds = self.time.copy(), who.copy(), 0
        while who.any() and (rounds == 0 or not one.repeat or rounds < one.repeat):
            begun = self.time.copy()
            self._one_round(who, number, order)
            rounds += 1
            if rounds > 1:
                who &= self.time > begun  # rounds without any time would never fill a duration
            if one.duration:
                elapsed = self.time - entered
                if not one.soft:
                    cut = who & (elapsed > one.duration)
                    self.time[cut] = entered[cut] + one.duration
                    self._put(cut, tuple(sorted(one.members)))
                who &= elapsed < one.duration

    def _one_round(self, who: Bools, number: int, order: tuple[int, ...]) -> None:
        position = 0
        while position < len(order):
            around = self._around(order[position])
            inside = around[around.index(number) + 1 :]
            size = len(self.problem.rounds[inside[0]].members) if inside else 1
            part = order[position : position + size]
            if inside:
                self._rounds(who, inside[0], part)
            else:
                self._visit(who, part[0])
            position += size
