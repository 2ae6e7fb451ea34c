"""Means with confidence intervals, by the bootstrap."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_env.seeding import generator

RESAMPLES = 10_000
_LEVEL = 0.95


@dataclass(frozen=True)
class ConfidenceInterval:
    """An estimate with its 95 % confidence interval."""

    value: float
    low: float
    high: float


class Bootstrap:
    """Percentile intervals over instances that are drawn again with replacement (Efron and
    Tibshirani, "An introduction to the bootstrap", 1993, chapter 13).

    All estimates draw the same instances: those of differences and ratios are paired.
    """

    def __init__(self, instances: int, seed: int = 0) -> None:
        rng = generator(seed, "bootstrap")
        draws = rng.integers(instances, size=(RESAMPLES, instances))
        # How often each instance is drawn, shape (resamples, instances).
        self._weights = np.apply_along_axis(np.bincount, 1, draws, minlength=instances)

    def mean(self, values: NDArray[np.float64]) -> ConfidenceInterval:
        """Of one value an instance."""
        return self.ratio(values, np.ones(len(values)))

    def ratio(self, values: NDArray[np.float64], to: NDArray[np.float64]) -> ConfidenceInterval:
        """Of the sum of one to the sum of the other; 0 where that is 0."""
        whole = self._share(values.sum(keepdims=True), to.sum(keepdims=True))
        drawn = self._share(self._weights @ values, self._weights @ to)
        low, high = np.quantile(drawn, [(1 - _LEVEL) / 2, (1 + _LEVEL) / 2])
        return ConfidenceInterval(float(whole[0]), float(low), float(high))

    @staticmethod
    def _share(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.divide(a, b, out=np.zeros(len(a)), where=b != 0.0)
