"""Rates of what is put together from strata: of faults that come with known probabilities.

Where failures are rare and most of them come with a few faults, it tells more to run each fault
often enough than to wait until chance brings it (stratified sampling: W. G. Cochran, Sampling
techniques, 3rd edition, 1977, chapter 5).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from argo_compiler.base.errors import Invalid
from argo_env.evaluation.statistics.rates import LEVEL, clopper_pearson


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
