"""Cheap runs that help to estimate what expensive ones bring: control variates.

The same worlds are run with a cheap drive and an expensive one. Where the two go up and down
together, many more runs of the cheap one alone tell in which way the few expensive ones were lucky
(regression estimates with double sampling: W. G. Cochran, Sampling techniques, 3rd edition, 1977,
chapter 12). Whether that pays depends on their correlation and on what a run costs, so both are
measured first.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Invalid
from argo_env.evaluation.estimates.rates import LEVEL, Estimate

FEWEST_PAIRS = 10
"""from which on a correlation says anything"""


@dataclass(frozen=True)
class ControlVariate:
    """How much a cheap run tells of an expensive one."""

    correlation: float
    cost: float
    """of a cheap run, as a share of that of an expensive one"""

    @classmethod
    def measured(
        cls, expensive: NDArray[np.float64], cheap: NDArray[np.float64], cost: float
    ) -> "ControlVariate":
        """From pairs, one of each a world, shape (n,) each."""
        if len(expensive) != len(cheap) or len(expensive) < FEWEST_PAIRS:
            raise Invalid(f"a correlation takes at least {FEWEST_PAIRS} pairs of runs")
        if not cost > 0:
            raise Invalid(f"a cheap run that costs {cost:g} of an expensive one: give more than 0")
        if np.ptp(expensive) == 0 or np.ptp(cheap) == 0:
            return cls(0.0, cost)
        return cls(float(np.corrcoef(expensive, cheap)[0, 1]), cost)

    @property
    def cheap_runs(self) -> float:
        """How many cheap runs there should be for each expensive one."""
        unexplained = 1.0 - self.correlation**2
        if unexplained <= 0:
            return math.inf
        return max(1.0, math.sqrt(self.correlation**2 / (unexplained * self.cost)))

    @property
    def gain(self) -> float:
        """How many times as much expensive runs alone would cost for the same accuracy; below 1 it
        does not pay."""
        r2, k = self.correlation**2, self.cheap_runs
        if math.isinf(k):
            k = 1e6
        return 1.0 / ((1.0 + self.cost * k) * (1.0 - r2 * (1.0 - 1.0 / k)))

    @property
    def pays(self) -> bool:
        """Whether it is worth it: a tenth less at least."""
        return self.gain > 1.1


def controlled_mean(
    expensive: NDArray[np.float64],
    cheap: NDArray[np.float64],
    more_cheap: NDArray[np.float64],
    level: float = LEVEL,
) -> Estimate:
    """The mean of the expensive runs, from pairs, shape (n,) each, and the cheap runs of further
    worlds, shape (m,). The interval is that of the normal distribution with n - 2 degrees."""
    n, m = len(expensive), len(more_cheap)
    if n != len(cheap) or n < FEWEST_PAIRS:
        raise Invalid(f"it takes at least {FEWEST_PAIRS} pairs of runs")
    from scipy.stats import t

    spread = float(np.var(cheap, ddof=1))
    slope = float(np.cov(expensive, cheap, ddof=1)[0, 1]) / spread if spread else 0.0
    all_cheap = np.concatenate([cheap, more_cheap])
    value = float(np.mean(expensive)) + slope * float(np.mean(all_cheap) - np.mean(cheap))
    rest = expensive - np.mean(expensive) - slope * (cheap - np.mean(cheap))
    unexplained = float(rest @ rest) / (n - 2)
    shift = float(np.mean(cheap) - np.mean(all_cheap)) ** 2
    variance = unexplained / n
    if spread:
        variance += unexplained * shift / (spread * (n - 1))
    variance += slope**2 * float(np.var(all_cheap, ddof=1)) / (n + m)
    half = float(t.ppf((1 + level) / 2, n - 2)) * math.sqrt(variance)
    return Estimate(value, value - half, value + half)
