"""Rates with confidence intervals, of runs, of worlds and of strata.

The runs of one world depend on each other and count as one. Strata are faults with known
probabilities. If failures are rare and most of them come with a few faults, running each fault
often enough gives more information than drawing faults by their probabilities (stratified sampling:
W. G. Cochran, Sampling techniques, 3rd edition, 1977, chapter 5).
"""

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray
from scipy.special import betaincinv

from argo_compiler.base.errors import Invalid

LEVEL = 0.95
"""default level of all intervals"""


@dataclass(frozen=True)
class Rate:
    """Share of runs that have some property, with an interval of the true share; 0 to 1."""

    count: int
    """number of runs with the property"""
    runs: int
    low: float
    high: float

    @property
    def value(self) -> float:
        """Share of the runs with the property; NaN without runs."""
        return self.count / self.runs if self.runs else math.nan

    @property
    def width(self) -> float:
        """Width of the interval."""
        return self.high - self.low


def clopper_pearson(count: int, runs: int, level: float = LEVEL) -> Rate:
    """Compute a rate, `count` of `runs`, with its exact interval (Clopper-Pearson).

    The interval contains the true share with a probability of at least `level`, whatever that share
    is, if the number of runs does not depend on their outcomes (C. J. Clopper and E. S. Pearson,
    Biometrika 26 (1934), 404-413).
    """
    _check(count, runs, level)
    half = (1.0 - level) / 2.0
    low = float(betaincinv(count, runs - count + 1, half)) if count else 0.0
    high = float(betaincinv(count + 1, runs - count, 1.0 - half)) if count < runs else 1.0
    return Rate(count, runs, low, high)


def wilson(count: int, runs: int, level: float = LEVEL) -> Rate:
    """Compute a rate, `count` of `runs`, with an approximate interval, for display during runs.

    The coverage of the interval is `level` on average only, so that nothing is claimed by it (E. B.
    Wilson, Journal of the American Statistical Association 22 (1927), 209-212).
    """
    _check(count, runs, level)
    if not runs:
        return Rate(0, 0, 0.0, 1.0)
    z = NormalDist().inv_cdf((1.0 + level) / 2.0)
    share = count / runs
    middle = (share + z * z / (2 * runs)) / (1 + z * z / runs)
    half = z * math.sqrt(share * (1 - share) / runs + (z / (2 * runs)) ** 2) / (1 + z * z / runs)
    low = 0.0 if count == 0 else max(0.0, middle - half)
    high = 1.0 if count == runs else min(1.0, middle + half)
    return Rate(count, runs, low, high)


def _check(count: int, runs: int, level: float) -> None:
    if not 0 <= count <= runs:
        raise Invalid(f"{count} of {runs} runs: give a count from 0 to {runs}")
    if not 0 < level < 1:
        raise Invalid(f"a level of {level:g}: give a level between 0 and 1")


@dataclass(frozen=True)
class Stratum:
    """Stratum with its weight and its runs so far."""

    weight: float
    """share of this stratum among all missions; the weights of all strata add up to 1"""
    count: int
    """number of runs with the property"""
    runs: int


@dataclass(frozen=True)
class Estimate:
    """Estimated number with its confidence interval."""

    value: float
    low: float
    high: float


def stratified_rate(strata: Sequence[Stratum], level: float = LEVEL) -> Estimate:
    """Estimate the rate over all strata by weight, from independent runs of each stratum.

    The interval combines the exact intervals of the strata: the weighted distances of their ends
    from the rates add up in squares (G. Y. Zou, W. Huang and X. Zhang, Computational Statistics and
    Data Analysis 53 (2009), 1080-1085). It is approximate; the tests measure its coverage. A
    stratum without runs counts with a rate of 0.5. Raises Invalid if the weights don't add up to 1.
    """
    if not strata or abs(math.fsum(s.weight for s in strata) - 1.0) > 1e-6:
        raise Invalid("the weights of the strata must add up to 1")
    rates = [clopper_pearson(s.count, s.runs, level) for s in strata]
    shares = [0.5 if math.isnan(rate.value) else rate.value for rate in rates]
    value = math.fsum(s.weight * share for s, share in zip(strata, shares, strict=True))
    below = above = 0.0
    for stratum, share, rate in zip(strata, shares, rates, strict=True):
        below += (stratum.weight * (share - rate.low)) ** 2
        above += (stratum.weight * (rate.high - share)) ** 2
    return Estimate(value, max(0.0, value - math.sqrt(below)), min(1.0, value + math.sqrt(above)))


def allocate_runs(strata: Sequence[Stratum], runs: int) -> tuple[int, ...]:
    """Return how many of the further `runs` each stratum gets for the narrowest overall interval.

    Each stratum gets one of them, if there are enough. The rest of them is divided in proportion to
    the weight and to the standard deviation of the outcome (Neyman allocation: J. Neyman, Journal
    of the Royal Statistical Society 97 (1934), 558-625). Earlier runs only serve to estimate the
    standard deviation.
    """
    # One success and one failure are added, so that a stratum with few runs does not seem certain.
    shares = [(s.count + 1) / (s.runs + 2) for s in strata]
    needs = [s.weight * math.sqrt(p * (1 - p)) for s, p in zip(strata, shares, strict=True)]
    total_need = math.fsum(needs)
    minimum = 1 if runs >= len(strata) else 0
    free = runs - minimum * len(strata)
    exact = [free * need / total_need if total_need else free / len(strata) for need in needs]
    counts = [math.floor(share) for share in exact]
    by_remainder = sorted(range(len(strata)), key=lambda k: counts[k] - exact[k])
    for k in by_remainder[: free - sum(counts)]:
        counts[k] += 1
    return tuple(minimum + count for count in counts)


def world_means_in_order_seen(
    values: Iterable[tuple[int, float | tuple[float, ...]]],
) -> NDArray[np.float64]:
    """Return the mean of the values in each world, shape (worlds,), or (worlds, k) for tuples.

    `values` are pairs: the seed of a world, and a value of a run there or a tuple of values of a
    pair of runs. The worlds are in the order in which they first appear in `values`.
    """
    worlds: dict[int, list[float | tuple[float, ...]]] = defaultdict(list)
    for seed, value in values:
        worlds[seed].append(value)
    return np.array([np.mean(results, axis=0) for results in worlds.values()])


def weighted_means_of_complete_worlds(
    values: Iterable[tuple[int, str, float | None]], weights: Mapping[str, float]
) -> dict[int, float]:
    """Return, by seed, the weighted mean over the cases that count in a world.

    Each item has a world's seed, a case's name and the case's value in that world; a case whose
    value is None does not count. `weights` are those of the cases by name. Worlds in which a case
    is missing, or no case counts, are left out.
    """
    worlds: dict[int, dict[str, float | None]] = defaultdict(dict)
    for seed, case, value in values:
        worlds[seed][case] = value
    means = {}
    for seed, by_case in worlds.items():
        counting = {case: value for case, value in by_case.items() if value is not None}
        total_weight = math.fsum(weights[case] for case in counting)
        if len(by_case) == len(weights) and total_weight:
            weighted = math.fsum(weights[case] * v for case, v in counting.items())
            means[seed] = weighted / total_weight
    return means
