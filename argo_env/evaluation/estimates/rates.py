"""Rates with confidence intervals, of runs, of worlds and of strata.

The runs of one world depend on each other and count as one. Strata are faults that come with known
probabilities: where failures are rare and most of them come with a few faults, it tells more to run
each fault often enough than to wait until chance brings it (stratified sampling: W. G. Cochran,
Sampling techniques, 3rd edition, 1977, chapter 5).
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
"""of all intervals, unless another is asked for"""


@dataclass(frozen=True)
class Rate:
    """How many of some runs, and between what the true share lies. Shares are 0 to 1."""

    count: int
    runs: int
    low: float
    high: float

    @property
    def value(self) -> float:
        """The share of the runs; NaN of none."""
        return self.count / self.runs if self.runs else math.nan

    @property
    def width(self) -> float:
        """Of the interval."""
        return self.high - self.low


def clopper_pearson(count: int, runs: int, level: float = LEVEL) -> Rate:
    """The exact interval: it has the true share with at least the probability `level`, whatever
    that share is, if the number of runs does not depend on their outcomes.

    C. J. Clopper and E. S. Pearson, Biometrika 26 (1934), 404-413.
    """
    _check(count, runs, level)
    half = (1.0 - level) / 2.0
    low = float(betaincinv(count, runs - count + 1, half)) if count else 0.0
    high = float(betaincinv(count + 1, runs - count, 1.0 - half)) if count < runs else 1.0
    return Rate(count, runs, low, high)


def wilson(count: int, runs: int, level: float = LEVEL) -> Rate:
    """A quick interval to look at while runs still come. Its coverage is `level` on average only,
    so nothing is claimed by it.

    E. B. Wilson, Journal of the American Statistical Association 22 (1927), 209-212.
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
        raise Invalid(f"{count} of {runs} runs: give a number of them, 0 to {runs}")
    if not 0 < level < 1:
        raise Invalid(f"an interval that holds with {level:g}: give a level between 0 and 1")


@dataclass(frozen=True)
class Stratum:
    """What was seen of one of the strata."""

    weight: float
    """the share of all missions that are like this; those of all strata add up to 1"""
    count: int
    runs: int


@dataclass(frozen=True)
class Estimate:
    """A number with its confidence interval."""

    value: float
    low: float
    high: float


def stratified_rate(strata: Sequence[Stratum], level: float = LEVEL) -> Estimate:
    """The rate of the whole, from independent runs of each stratum.

    The interval is put together from the exact ones of the strata: the squares of their halves
    add up, each weighted (G. Y. Zou, W. Huang and X. Zhang, Computational Statistics and Data
    Analysis 53 (2009), 1080-1085). It is no exact one; its coverage is measured in the suite.
    """
    if not strata or abs(math.fsum(s.weight for s in strata) - 1.0) > 1e-6:
        raise Invalid("the weights of all strata add up to 1")
    rates = [clopper_pearson(s.count, s.runs, level) for s in strata]
    shares = [0.5 if math.isnan(rate.value) else rate.value for rate in rates]
    value = math.fsum(s.weight * share for s, share in zip(strata, shares, strict=True))
    below = above = 0.0
    for stratum, share, rate in zip(strata, shares, rates, strict=True):
        below += (stratum.weight * (share - rate.low)) ** 2
        above += (stratum.weight * (rate.high - share)) ** 2
    return Estimate(value, max(0.0, value - math.sqrt(below)), min(1.0, value + math.sqrt(above)))


def allocation(strata: Sequence[Stratum], runs: int) -> tuple[int, ...]:
    """How many of so many further runs each stratum gets, so that the whole rate becomes as sure as
    can be: by weight, and by how uncertain the outcome is (J. Neyman, Journal of the Royal
    Statistical Society 97 (1934), 558-625). Each gets at least one, if there are enough."""
    # As if one more had succeeded and one more failed: a stratum of which few runs are known is
    # not taken for sure.
    shares = [(s.count + 1) / (s.runs + 2) for s in strata]
    needs = [s.weight * math.sqrt(p * (1 - p)) for s, p in zip(strata, shares, strict=True)]
    whole = math.fsum(needs)
    least = 1 if runs >= len(strata) else 0
    free = runs - least * len(strata)
    exact = [free * need / whole if whole else free / len(strata) for need in needs]
    given = [math.floor(one) for one in exact]
    by_rest = sorted(range(len(strata)), key=lambda k: given[k] - exact[k])
    for k in by_rest[: free - sum(given)]:
        given[k] += 1
    return tuple(least + one for one in given)


def world_means(values: Iterable[tuple[int, float | tuple[float, ...]]]) -> NDArray[np.float64]:
    """Return the mean in each world of what runs, or pairs of them, have come to.

    Each value, or tuple of values, comes with its world's seed; the worlds are in the order in
    which they first come.
    """
    worlds: dict[int, list[float | tuple[float, ...]]] = defaultdict(list)
    for seed, value in values:
        worlds[seed].append(value)
    return np.array([np.mean(found, axis=0) for found in worlds.values()])


def weighted_world_means(
    values: Iterable[tuple[int, str, float | None]], weights: Mapping[str, float]
) -> dict[int, float]:
    """Return by seed the weighted mean over the cases that count in a world.

    Each value comes with the seed and the case; None counts for nothing. Worlds in which a case is
    missing, or none counts, are left out.
    """
    worlds: dict[int, dict[str, float | None]] = defaultdict(dict)
    for seed, case, value in values:
        worlds[seed][case] = value
    means = {}
    for seed, found in worlds.items():
        counting = {case: value for case, value in found.items() if value is not None}
        whole = sum(weights[case] for case in counting)
        if len(found) == len(weights) and whole:
            means[seed] = sum(weights[case] * v for case, v in counting.items()) / whole
    return means
