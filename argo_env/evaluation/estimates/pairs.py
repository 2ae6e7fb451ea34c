"""Statistics of paired comparisons: two plans in the same worlds.

Functions import scipy.stats themselves, so that an evaluation without comparisons starts faster.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Invalid
from argo_env.evaluation.estimates.rates import LEVEL, clopper_pearson
from argo_env.seeding import generator

RESAMPLES = 10_000
MIN_PAIRS = 6
"""number of pairs from which on a test can show a difference: 2 of 2**6 swaps are below 5 %"""
_BATCH_SIZE = 2_000_000  # numbers in memory at once


@dataclass(frozen=True)
class SuccessPairs:
    """Numbers of pairs of runs by which of the two plans succeeded."""

    both: int
    first_only: int
    second_only: int
    neither: int

    @classmethod
    def from_successes(cls, first: NDArray[np.bool_], second: NDArray[np.bool_]) -> "SuccessPairs":
        """Count the pairs from the successes of two plans, world by world; shape (n,) each."""
        _require_pairs(first, second)
        return cls(
            int(np.sum(first & second)),
            int(np.sum(first & ~second)),
            int(np.sum(~first & second)),
            int(np.sum(~first & ~second)),
        )

    @property
    def pairs(self) -> int:
        return self.both + self.first_only + self.second_only + self.neither

    @property
    def first_minus_second(self) -> float:
        """Difference of the success rates, first plan minus second plan; NaN without pairs."""
        return (self.first_only - self.second_only) / self.pairs if self.pairs else math.nan

    def interval(self, level: float = LEVEL) -> tuple[float, float]:
        """Return an interval of the difference of the rates with coverage of at least `level`.

        The coverage is guaranteed for all true rates. The exact intervals of the two kinds of
        discordant pairs are combined; each of them may err half as often (Bonferroni).
        """
        each_level = (1.0 + level) / 2.0
        first = clopper_pearson(self.first_only, self.pairs, each_level)
        second = clopper_pearson(self.second_only, self.pairs, each_level)
        return first.low - second.high, first.high - second.low

    @property
    def p_value(self) -> float:
        """P-value of McNemar's exact test for a difference of the success rates.

        That is the probability of a difference at least as large if there is truly none
        (Q. McNemar, Psychometrika 12 (1947), 153-157), exact by the binomial distribution of the
        discordant pairs.
        """
        from scipy.stats import binomtest

        discordant = self.first_only + self.second_only
        return float(binomtest(self.first_only, discordant).pvalue) if discordant else 1.0


def power(pairs: int, first_only: float, second_only: float, alpha: float = 1.0 - LEVEL) -> float:
    """Compute the power of McNemar's exact test.

    Args:
        pairs: Number of pairs.
        first_only: True share of pairs in which only the first plan succeeds.
        second_only: True share of pairs in which only the second plan succeeds.
        alpha: Significance level of the test.

    Returns:
        Probability that the test finds a difference.

    Raises:
        Invalid: For shares that are negative, or above 1 together.
    """
    from scipy.stats import binom

    if min(first_only, second_only) < 0 or first_only + second_only > 1:
        raise Invalid("give shares of differing pairs of at least 0, and together at most 1")
    discordant = first_only + second_only
    if discordant == 0:
        return 0.0
    share = first_only / discordant
    found = 0.0
    for n in range(pairs + 1):
        probability = float(binom.pmf(n, pairs, discordant))
        if probability < 1e-12 or n == 0:
            continue
        # The test is symmetric: it is significant if at most `critical` pairs are of one kind.
        critical = binom.ppf(alpha / 2.0, n, 0.5) - 1
        while critical >= 0 and 2.0 * binom.cdf(critical, n, 0.5) > alpha:
            critical -= 1
        while 2.0 * binom.cdf(critical + 1, n, 0.5) <= alpha and 2 * (critical + 1) < n:
            critical += 1
        if critical >= 0:
            tails = binom.cdf(critical, n, share) + binom.sf(n - critical - 1, n, share)
            found += probability * float(tails)
    return found


@dataclass(frozen=True)
class FirstMinusSecond:
    """Difference of two means, the first minus the second, with its interval and its p-value."""

    pairs: int
    value: float
    low: float
    high: float
    p_value: float

    @property
    def is_significant_by_p_value(self) -> bool:
        """True if the difference is significant: its p-value is at most 5 %."""
        return self.p_value <= 1.0 - LEVEL


def mean_first_minus_second(
    first: NDArray[np.float64], second: NDArray[np.float64], seed: int = 0, level: float = LEVEL
) -> FirstMinusSecond:
    """Compute the mean of the first plan's values minus the second plan's, one value in each world.

    `first` and `second` have the shape (n,), world by world. The interval is that of the paired
    bootstrap (percentiles over resampled worlds). The p-value is that of a permutation test that
    randomly swaps the plans in each world. The test is exact except for the limited number of
    random swaps; its p-value is 1 if no pair differs.
    """
    _require_pairs(first, second)
    if not len(first):
        return FirstMinusSecond(0, math.nan, math.nan, math.nan, 1.0)
    differences = np.asarray(first, dtype=float) - np.asarray(second, dtype=float)
    mean = float(np.mean(differences))
    rng = generator(seed, "difference")
    batches = _resample_batches(len(differences))
    means = np.concatenate(
        [
            differences[rng.integers(len(differences), size=(n, len(differences)))].mean(axis=1)
            for n in batches
        ]
    )
    low, high = np.quantile(means, [(1 - level) / 2, (1 + level) / 2])
    return FirstMinusSecond(
        len(differences), mean, float(low), float(high), _permutation_p_value(differences, rng)
    )


def _permutation_p_value(differences: NDArray[np.float64], rng: np.random.Generator) -> float:
    nonzero = differences[differences != 0.0]
    if not len(nonzero):
        return 1.0
    observed = abs(float(np.sum(nonzero))) * (1 - 1e-12)
    extreme = 0
    for n in _resample_batches(len(nonzero)):
        signs = rng.integers(2, size=(n, len(nonzero)), dtype=np.int8) * 2.0 - 1.0
        extreme += int(np.sum(np.abs(signs @ nonzero) >= observed))
    return (extreme + 1) / (RESAMPLES + 1)  # the observed order counts as one permutation


def _resample_batches(pairs: int) -> list[int]:
    """Return the sizes of batches of resamples that fit into memory; RESAMPLES in all.

    A resample has `pairs` values.
    """
    most = max(1, _BATCH_SIZE // pairs)
    return [min(most, RESAMPLES - first) for first in range(0, RESAMPLES, most)]


def _require_pairs(first: NDArray[np.generic], second: NDArray[np.generic]) -> None:
    if len(first) != len(second):
        raise Invalid(f"{len(first)} and {len(second)} runs make no pairs: give equal numbers")
