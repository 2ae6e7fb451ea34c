"""Paired comparisons of two plans in the same worlds.

Functions import scipy.stats, as an evaluation that compares nothing begins sooner without it.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Invalid
from argo_env.evaluation.estimates.rates import LEVEL, clopper_pearson
from argo_env.seeding import generator

RESAMPLES = 10_000
_AT_ONCE = 2_000_000  # numbers in memory


@dataclass(frozen=True)
class SuccessPairs:
    """How often which of two plans succeeded in one world."""

    both: int
    first_only: int
    second_only: int
    neither: int

    @classmethod
    def of(cls, first: NDArray[np.bool_], second: NDArray[np.bool_]) -> "SuccessPairs":
        """Two plans' successes, shape (n,) each, world by world."""
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
    def difference(self) -> float:
        """By how much the first one's rate is higher."""
        return (self.first_only - self.second_only) / self.pairs if self.pairs else math.nan

    def interval(self, level: float = LEVEL) -> tuple[float, float]:
        """Between what the difference of the rates lies, with at least the probability `level`,
        whatever they are: the exact intervals of both kinds of pairs that differ, each of which
        may err half as often, put together."""
        each = (1.0 + level) / 2.0
        up = clopper_pearson(self.first_only, self.pairs, each)
        down = clopper_pearson(self.second_only, self.pairs, each)
        return up.low - down.high, up.high - down.low

    @property
    def p_value(self) -> float:
        """Of McNemar's exact test: how likely a difference at least as great is if there is none.

        Q. McNemar, Psychometrika 12 (1947), 153-157; exact by the binomial distribution of the
        pairs that differ.
        """
        from scipy.stats import binomtest

        differ = self.first_only + self.second_only
        return float(binomtest(self.first_only, differ).pvalue) if differ else 1.0


def power(pairs: int, first_only: float, second_only: float, alpha: float = 1.0 - LEVEL) -> float:
    """How likely McNemar's exact test finds a difference with so many pairs, if these shares of
    them differ in truth."""
    from scipy.stats import binom

    if min(first_only, second_only) < 0 or first_only + second_only > 1:
        raise Invalid("the shares of pairs that differ lie between 0 and 1, and together below 1")
    differ = first_only + second_only
    if differ == 0:
        return 0.0
    share = first_only / differ
    found = 0.0
    for n in range(pairs + 1):
        chance = float(binom.pmf(n, pairs, differ))
        if chance < 1e-12 or n == 0:
            continue
        # The test is symmetric: up to that many of one kind it is significant.
        least = binom.ppf(alpha / 2.0, n, 0.5) - 1
        while least >= 0 and 2.0 * binom.cdf(least, n, 0.5) > alpha:
            least -= 1
        while 2.0 * binom.cdf(least + 1, n, 0.5) <= alpha and 2 * (least + 1) < n:
            least += 1
        if least >= 0:
            tails = binom.cdf(least, n, share) + binom.sf(n - least - 1, n, share)
            found += chance * float(tails)
    return found


@dataclass(frozen=True)
class Difference:
    """By how much a mean is higher, with its interval, and how likely that is by chance."""

    pairs: int
    value: float
    low: float
    high: float
    p_value: float

    @property
    def found(self) -> bool:
        """Whether there is one, at the level of 95 %."""
        return self.p_value <= 1.0 - LEVEL


def difference(
    first: NDArray[np.float64], second: NDArray[np.float64], seed: int = 0, level: float = LEVEL
) -> Difference:
    """Of the means of two plans, from one value a world, shape (n,) each.

    The interval is that of the paired bootstrap (percentiles over worlds drawn again); how likely
    the difference is by chance says a test that swaps the plans in each world by the toss of a
    coin, which is exact but for the number of tosses, and says 1 where no pair differs.
    """
    _require_pairs(first, second)
    if not len(first):
        return Difference(0, math.nan, math.nan, math.nan, 1.0)
    gaps = np.asarray(first, dtype=float) - np.asarray(second, dtype=float)
    mean = float(np.mean(gaps))
    rng = generator(seed, "difference")
    worlds = _blocks(len(gaps))
    drawn = np.concatenate(
        [gaps[rng.integers(len(gaps), size=(n, len(gaps)))].mean(axis=1) for n in worlds]
    )
    low, high = np.quantile(drawn, [(1 - level) / 2, (1 + level) / 2])
    return Difference(len(gaps), mean, float(low), float(high), _swapped(gaps, rng))


def _swapped(gaps: NDArray[np.float64], rng: np.random.Generator) -> float:
    differing = gaps[gaps != 0.0]
    if not len(differing):
        return 1.0
    seen = abs(float(np.sum(differing))) * (1 - 1e-12)
    extreme = 0
    for n in _blocks(len(differing)):
        signs = rng.integers(2, size=(n, len(differing)), dtype=np.int8) * 2.0 - 1.0
        extreme += int(np.sum(np.abs(signs @ differing) >= seen))
    return (extreme + 1) / (RESAMPLES + 1)  # what was seen is one of the ways to toss


def _blocks(pairs: int) -> list[int]:
    """RESAMPLES in parts that fit into memory."""
    most = max(1, _AT_ONCE // pairs)
    return [min(most, RESAMPLES - first) for first in range(0, RESAMPLES, most)]


def _require_pairs(first: NDArray[np.generic], second: NDArray[np.generic]) -> None:
    if len(first) != len(second):
        raise Invalid(f"{len(first)} and {len(second)} runs make no pairs: one of each a world")
