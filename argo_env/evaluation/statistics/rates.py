"""How often something happens: rates with confidence intervals."""

import math
from dataclasses import dataclass
from statistics import NormalDist

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
