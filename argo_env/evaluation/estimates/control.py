"""Control variates: cheap runs that narrow the interval of a mean over expensive runs.

The same worlds are run with a cheap drive and an expensive one. If their results are correlated,
many more runs of the cheap drive alone show by how much the few expensive runs deviate by chance
(regression estimates with double sampling: W. G. Cochran, Sampling techniques, 3rd edition, 1977,
chapter 12). Whether that pays depends on the correlation and on the cost of a run, so both are
measured first.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Invalid
from argo_env.evaluation.estimates.rates import LEVEL, Estimate

FEWEST_PAIRS = 10
"""smallest number of pairs for a meaningful correlation"""


@dataclass(frozen=True)
class ControlVariate:
    """Correlation of cheap runs with expensive ones, and the relative cost of a cheap run."""

    correlation: float
    cost: float
    """cost of a cheap run, as a share of the cost of an expensive run"""

    @classmethod
    def from_pairs(
        cls, expensive: NDArray[np.float64], cheap: NDArray[np.float64], cost: float
    ) -> "ControlVariate":
        """Measure the correlation from pairs of runs, one pair in each world.

        `expensive` and `cheap` are the results of the runs, of shape (n,) each; `cost` is that of a
        cheap run, as a share of the cost of an expensive run.

        Raises Invalid for too few pairs, unequal numbers of runs, or a cost that is not positive.
        """
        if len(expensive) != len(cheap) or len(expensive) < FEWEST_PAIRS:
            raise Invalid(f"a correlation needs at least {FEWEST_PAIRS} pairs of runs")
        if not cost > 0:
            raise Invalid(f"a cheap run costs {cost:g} of an expensive one: give more than 0")
        if np.ptp(expensive) == 0 or np.ptp(cheap) == 0:
            return cls(0.0, cost)
        return cls(float(np.corrcoef(expensive, cheap)[0, 1]), cost)

    @property
    def cheap_runs_per_expensive_run(self) -> float:
        """Number of cheap runs, 1 or more, for each expensive run that reduces the cost most.

        That is the maximum of `cost_reduction_factor`. It is infinite for a perfect correlation.
        """
        unexplained = 1.0 - self.correlation**2
        if unexplained <= 0:
            return math.inf
        return max(1.0, math.sqrt(self.correlation**2 / (unexplained * self.cost)))

    @property
    def cost_reduction_factor(self) -> float:
        """Factor by which cheap runs reduce the cost of an estimate of the same accuracy.

        That is the cost of expensive runs alone over the cost with cheap runs. Below 1, cheap runs
        do not pay.
        """
        r2, k = self.correlation**2, self.cheap_runs_per_expensive_run
        if math.isinf(k):
            k = 1e6
        return 1.0 / ((1.0 + self.cost * k) * (1.0 - r2 * (1.0 - 1.0 / k)))

    @property
    def pays(self) -> bool:
        """True if `cost_reduction_factor` is above 1.1: cheap runs are worth their trouble."""
        return self.cost_reduction_factor > 1.1


def controlled_mean(
    expensive: NDArray[np.float64],
    cheap: NDArray[np.float64],
    more_cheap: NDArray[np.float64],
    level: float = LEVEL,
) -> Estimate:
    """Estimate the mean of expensive runs from pairs of runs and further cheap runs.

    Args:
        expensive: Results of the pairs' expensive runs, shape (n,).
        cheap: Results of the pairs' cheap runs in the same worlds, shape (n,).
        more_cheap: Results of cheap runs in further worlds, shape (m,).
        level: Level of the interval, which uses Student's t distribution with n - 2 degrees of
            freedom.

    Raises:
        Invalid: For too few pairs, or unequal numbers of runs.
    """
    n, m = len(expensive), len(more_cheap)
    if n != len(cheap) or n < FEWEST_PAIRS:
        raise Invalid(f"a control variate needs at least {FEWEST_PAIRS} pairs of runs")
    from scipy.stats import t

    spread = float(np.var(cheap, ddof=1))
    slope = float(np.cov(expensive, cheap, ddof=1)[0, 1]) / spread if spread else 0.0
    all_cheap = np.concatenate([cheap, more_cheap])
    value = float(np.mean(expensive)) + slope * float(np.mean(all_cheap) - np.mean(cheap))
    residuals = expensive - np.mean(expensive) - slope * (cheap - np.mean(cheap))
    unexplained = float(residuals @ residuals) / (n - 2)
    shift = float(np.mean(cheap) - np.mean(all_cheap)) ** 2
    variance = unexplained / n
    if spread:
        variance += unexplained * shift / (spread * (n - 1))
    variance += slope**2 * float(np.var(all_cheap, ddof=1)) / (n + m)
    half = float(t.ppf((1 + level) / 2, n - 2)) * math.sqrt(variance)
    return Estimate(value, value - half, value + half)
