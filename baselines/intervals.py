"""Confidence intervals of means and ratios, by the bootstrap."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_env.seeding import generator

RESAMPLES = 10_000
"""number of bootstrap samples"""
_LEVEL = 0.95


@dataclass(frozen=True)
class ConfidenceInterval:
    """An estimate with its 95 % confidence interval."""

    value: float
    low: float
    high: float


class Bootstrap:
    """Percentile intervals over instances that are drawn with replacement.

    All estimates use the same draws of instances, so differences and ratios are paired. See Efron
    and Tibshirani, "An introduction to the bootstrap", 1993, chapter 13.
    """

    def __init__(self, instances: int, seed: int = 0) -> None:
        rng = generator(seed, "bootstrap")
        draws = rng.integers(instances, size=(RESAMPLES, instances))
        # Number of times that each instance is drawn, shape (resamples, instances).
        self._weights = np.apply_along_axis(np.bincount, 1, draws, minlength=instances)

    def mean(self, values: NDArray[np.float64]) -> ConfidenceInterval:
        """Return the mean of `values`, one for each instance, with its confidence interval."""
        return self.ratio_of_sums(values, np.ones(len(values)))

    def ratio_of_sums(
        self, values: NDArray[np.float64], to: NDArray[np.float64]
    ) -> ConfidenceInterval:
        """Return the ratio of the sum of `values` to the sum of `to`; 0 where the latter is 0."""
        estimate = self._divide(values.sum(keepdims=True), to.sum(keepdims=True))
        drawn = self._divide(self._weights @ values, self._weights @ to)
        low, high = np.quantile(drawn, [(1 - _LEVEL) / 2, (1 + _LEVEL) / 2])
        return ConfidenceInterval(float(estimate[0]), float(low), float(high))

    @staticmethod
    def _divide(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.divide(a, b, out=np.zeros(len(a)), where=b != 0.0)
