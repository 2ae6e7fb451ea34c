"""Probability that a route is completed, by simulation of many samples at once.

The simulation does the same as `argo_compiler.route.evaluation`, which defines the meaning of a
route, but with random times, and with arrays whose items are the samples. Without any spread both
agree.
"""

from collections import Counter
from dataclasses import dataclass, field, replace
from functools import lru_cache
from math import log1p, sqrt

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Invalid
from argo_compiler.base.message import Message
from argo_compiler.route.evaluation import evaluate
from argo_compiler.route.problem import NEVER, EnergyBudget, RouteProblem, Tour
from argo_compiler.route.robust_spread import TravelSpread

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

_Z = 1.959964
"""number of standard deviations around the mean that hold 95 % of a normal distribution"""
_CACHED = 4_000_000
"""highest number of cached samples, all legs together"""


@dataclass(frozen=True)
class Completion:
    """Probability that a route meets all constraints: maximum duration, time windows, battery."""

    probability: float
    low: float
    high: float
    """limits of the 95 % confidence interval of the probability (E. B. Wilson, 1927)"""
    samples: int
    duration: float
    """mean duration of the samples, in units; infinite if the order itself is infeasible"""
    duration_95: float
    """duration that 95 % of the samples do not exceed, in units"""


class Draws:
    """Random numbers of many samples, common to all routes that they are used for.

    So routes differ by their order and not by chance. Caches the numbers of each leg.
    """

    def __init__(self, spread: TravelSpread, samples: int, rng: np.random.Generator) -> None:
        """Draw the common factors; raise Invalid if `samples` is below 1."""
        if samples < 1:
            raise Invalid(
                Message("{samples} samples give no probability; ask for 1 or more", samples=samples)
            )
        self.spread, self.samples = spread, samples
        self._root = int(rng.integers(2**63))
        self.common = _factors(spread.common, samples, self._generator(0))
        self.leg = lru_cache(_CACHED // samples)(self._draw_leg)

    def _draw_leg(self, location: int, time: int) -> tuple[Floats, Floats, Floats]:
        """Draw the numbers of the `time`-th leg, from 0, to the same location.

        Returns, for each sample, the factor of its time, the delay in s, and how often the service
        there is done, 1 or 2.
        """
        spread, rng = self.spread, self._generator(1, location, time)
        factors = self.common * _factors(spread.way, self.samples, rng)
        is_delayed = rng.random(self.samples) < spread.delay_chance
        delays = np.where(is_delayed, rng.exponential(spread.delay, self.samples), 0.0)
        services = np.where(rng.random(self.samples) < spread.repeat_chance, 2.0, 1.0)
        return factors, delays, services

    def _generator(self, *purpose: int) -> np.random.Generator:
        return np.random.default_rng((self._root, *purpose))


def _factors(deviation: float, samples: int, rng: np.random.Generator) -> Floats:
    """Draw log-normal factors whose mean is 1, and whose standard deviation is `deviation`."""
    variance = log1p(deviation**2)
    return np.exp(rng.normal(-variance / 2.0, sqrt(variance), samples))


def completion_probability(
    problem: RouteProblem,
    route: Tour,
    spread: TravelSpread,
    samples: int,
    rng: np.random.Generator,
) -> Completion:
    """Estimate the probability that the robot makes all visits of a route within the constraints.

    Raises Invalid if `samples` is below 1.
    """
    return estimate_completion(problem, route, Draws(spread, samples, rng))


def estimate_completion(problem: RouteProblem, route: Tour, draws: Draws) -> Completion:
    """Estimate the probability that the robot completes a route, with given random numbers."""
    simulation = _SampledSimulation(problem, draws)
    if _is_infeasible_order(problem, route):
        simulation.feasible[:] = False
        simulation.time[:] = np.inf
    else:
        simulation.follow(route)
    n, share = draws.samples, float(simulation.feasible.mean())
    middle = (share + _Z**2 / (2 * n)) / (1 + _Z**2 / n)
    half = _Z / (1 + _Z**2 / n) * sqrt(share * (1 - share) / n + _Z**2 / (4 * n**2))
    return Completion(
        share,
        max(0.0, min(share, middle - half)),
        min(1.0, max(share, middle + half)),
        n,
        float(simulation.time.mean()),
        float(np.quantile(simulation.time, 0.95, method="inverted_cdf")),
    )


def _is_infeasible_order(problem: RouteProblem, route: Tour) -> bool:
    """Return True if the route violates a constraint even if all legs take no time."""
    visits = tuple(replace(visit, earliest=0, latest=None) for visit in problem.visits)
    travel = np.zeros_like(problem.travel)
    battery = None if problem.battery is None else EnergyBudget(travel, capacity=0)
    timeless = replace(problem, visits=visits, travel=travel, max_duration=None, battery=battery)
    return not evaluate(timeless, route).feasible


@dataclass
class _SampledSimulation:
    """Simulation of a route in all samples, which holds the robot's state in each.

    The methods change only the samples that a mask selects.
    """

    problem: RouteProblem
    draws: Draws
    time: Floats = field(init=False)
    used: Floats = field(init=False)
    feasible: Bools = field(init=False)
    """false in samples that have violated a constraint"""
    _location_set: NDArray[np.int64] = field(init=False)
    """index in `_sets` of the robot's possible locations; the worst one counts for the next leg"""
    _sets: list[tuple[int, ...]] = field(init=False)
    _leg_counts: Counter[int] = field(default_factory=Counter)
    """number of legs to each location so far"""

    def __post_init__(self) -> None:
        samples, battery = self.draws.samples, self.problem.battery
        self.time = np.zeros(samples)
        self.used = np.full(samples, 0.0 if battery is None else float(battery.used))
        self.feasible = np.ones(samples, dtype=np.bool_)
        self._location_set = np.zeros(samples, dtype=np.int64)
        self._sets = [(self.problem.size,)]

    def follow(self, route: Tour) -> None:
        all_samples = np.ones(self.draws.samples, dtype=np.bool_)
        position = 0
        while position < len(route.order):
            self._charge(all_samples, route, position)
            enclosing = self._rounds_around(route.order[position])
            size = len(self.problem.rounds[enclosing[0]].members) if enclosing else 1
            part = route.order[position : position + size]
            if enclosing:
                self._rounds(all_samples, enclosing[0], part)
            else:
                self._visit(all_samples, part[0])
            position += size
        self._charge(all_samples, route, len(route.order))
        self._drive(all_samples, self.problem.end)
        if self.problem.max_duration is not None:
            self.feasible &= self.time <= self.problem.max_duration

    def _rounds_around(self, visit: int) -> list[int]:
        """Return the rounds around a visit, from the outermost."""
        rounds = self.problem.rounds
        numbers = [k for k, round_ in enumerate(rounds) if visit in round_.members]
        return sorted(numbers, key=lambda k: (-len(rounds[k].members), k))

    def _set_locations(self, selected: Bools, locations: tuple[int, ...]) -> None:
        if selected.all():
            self._sets = []
        if locations not in self._sets:
            self._sets.append(locations)
        self._location_set[selected] = self._sets.index(locations)

    def _drive(self, selected: Bools, location: int) -> Floats:
        """Drive to a location in the `selected` samples.

        Returns how often the service there is done, for all samples.
        """
        factors, delays, services = self.draws.leg(location, self._leg_counts[location])
        self._leg_counts[location] += 1
        nominal = self._worst(self.problem.travel, location)
        self.feasible &= ~(selected & (nominal >= NEVER))
        self.time += np.where(selected, nominal * factors + delays / self.problem.unit, 0.0)
        if self.problem.battery is not None:
            energy = self._worst(self.problem.battery.energy, location) * factors
            self.used += np.where(selected, energy, 0.0)
            self.feasible &= ~(selected & (self.used > self.problem.battery.capacity))
        self._set_locations(selected, (location,))
        return services

    def _worst(self, matrix: NDArray[np.int64], location: int) -> NDArray[np.int64]:
        worst_by_set = np.array(
            [max(matrix[origin, location] for origin in origins) for origins in self._sets]
        )
        worst: NDArray[np.int64] = worst_by_set[self._location_set]
        return worst

    def _charge(self, selected: Bools, route: Tour, position: int) -> None:
        battery, number = self.problem.battery, route.charges.get(position)
        if battery is not None and number is not None:
            self._drive(selected, self.problem.charger(number))
            self.time[selected] += battery.overhead + self.used[selected]
            self.used[selected] = 0.0

    def _visit(self, selected: Bools, number: int) -> None:
        visit = self.problem.visits[number]
        services = self._drive(selected, number)
        if visit.earliest:
            self.time[selected] = np.maximum(self.time[selected], visit.earliest)
        if visit.latest is not None:
            self.feasible &= ~(selected & (self.time > visit.latest))
        if visit.service:
            self.time += np.where(selected, visit.service * services, 0.0)

    def _rounds(self, selected: Bools, number: int, order: tuple[int, ...]) -> None:
        """Simulate all repetitions of a round."""
        round_ = self.problem.rounds[number]
        entered, selected, repetitions = self.time.copy(), selected.copy(), 0
        while selected.any() and (
            repetitions == 0 or not round_.repeat or repetitions < round_.repeat
        ):
            begun = self.time.copy()
            self._one_repetition(selected, number, order)
            repetitions += 1
            if repetitions > 1:
                # Repetitions that take no time would never fill a duration.
                selected &= self.time > begun
            if round_.duration:
                elapsed = self.time - entered
                if not round_.soft:
                    interrupted = selected & (elapsed > round_.duration)
                    self.time[interrupted] = entered[interrupted] + round_.duration
                    self._set_locations(interrupted, tuple(sorted(round_.members)))
                selected &= elapsed < round_.duration

    def _one_repetition(self, selected: Bools, number: int, order: tuple[int, ...]) -> None:
        position = 0
        while position < len(order):
            enclosing = self._rounds_around(order[position])
            inside = enclosing[enclosing.index(number) + 1 :]
            size = len(self.problem.rounds[inside[0]].members) if inside else 1
            part = order[position : position + size]
            if inside:
                self._rounds(selected, inside[0], part)
            else:
                self._visit(selected, part[0])
            position += size
