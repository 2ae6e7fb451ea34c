"""Confidence sequences: intervals that stay valid when they are checked and acted upon at any time.

An interval for a fixed number of runs errs the more often the more often it is checked while runs
are added. A confidence sequence contains the true mean at all times at once, with the probability
`level`. An evaluation may therefore stop because of the present interval, which stays valid.

The method is testing by betting. Whoever claims that the mean is m sells bets on each outcome at
that price. A buyer whose wealth has grown twentyfold has refuted the claim at the level 95 %, since
wealth in a fair game grows by 20 or more with a probability of at most 1/20 (Ville's inequality).
The buyer spreads the wealth over the alternative means once, at the start. For outcomes of 0 or 1
this is the mixture of binomial likelihoods of H. Robbins (Annals of Mathematical Statistics 41
(1970), 1397-1409); for any outcomes from 0 to 1 see I. Waudby-Smith and A. Ramdas, Journal of the
Royal Statistical Society B 86 (2024), 1-27.
"""

import math
from collections import Counter
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Invalid
from argo_env.evaluation.estimates.rates import LEVEL

_BETS = 200
"""number of alternative means that the wealth is spread over, between m and the end of the scale"""
_STEPS = 40  # of a bisection


class ConfidenceSequence:
    """Confidence sequence for the mean of independent outcomes from 0 to 1.

    It holds the number of outcomes by value; `add` adds outcomes, one after the other.
    """

    def __init__(self, level: float = LEVEL) -> None:
        if not 0 < level < 1:
            raise Invalid(f"a level of {level:g}: give a level between 0 and 1")
        self._threshold = math.log(2.0 / (1.0 - level))
        self._counts: Counter[float] = Counter()

    @property
    def runs(self) -> int:
        return self._counts.total()

    def add(self, outcomes: Iterable[float]) -> None:
        """Add outcomes, 0 to 1 each. Raises Invalid for any other outcome."""
        for outcome in outcomes:
            if not 0.0 <= outcome <= 1.0:
                raise Invalid(f"an outcome of {outcome!r}: it must lie between 0 and 1")
            self._counts[float(outcome)] += 1

    def is_above(self, mean: float) -> bool:
        """Return True if the outcomes show that the true mean is at least `mean`."""
        return self._log_wealth(mean, up=True) >= self._threshold

    def is_below(self, mean: float) -> bool:
        """Return True if the outcomes show that the true mean is at most `mean`."""
        return self._log_wealth(mean, up=False) >= self._threshold

    @property
    def interval(self) -> tuple[float, float]:
        """Interval of all means that the outcomes so far do not refute; 0 to 1 without outcomes."""
        if not self._counts:
            return 0.0, 1.0
        mean = math.fsum(value * n for value, n in self._counts.items()) / self.runs
        return self._bound(0.0, mean, up=True), self._bound(1.0, mean, up=False)

    def _bound(self, refuted: float, possible: float, up: bool) -> float:
        """Return the last mean from `possible` towards `refuted` that the outcomes don't refute.

        The mean is found by bisection and rounded towards `refuted`. With `up`, means are refuted
        as too low, otherwise as too high.
        """
        if refuted == possible:
            return possible
        for _ in range(_STEPS):
            middle = (refuted + possible) / 2.0
            if self._log_wealth(middle, up) >= self._threshold:
                refuted = middle
            else:
                possible = middle
        return refuted

    def _log_wealth(self, mean: float, up: bool) -> float:
        """Return the log wealth of a buyer who bet 1 against a true mean of at most `mean`.

        With `up` False, the bets are against a true mean of at least `mean`.
        """
        price = mean if up else 1.0 - mean
        if price >= 1.0:
            return -math.inf  # such bets can't win
        if price <= 0.0:
            raise Invalid(f"a mean of {mean:g} can't be tested: every mean is between 0 and 1")
        alternatives = price + (1.0 - price) * _ALTERNATIVES
        odds = (alternatives - price) / (price * (1.0 - price))
        log_wealth = np.zeros(len(alternatives))
        for value, times in self._payoffs(up).items():
            log_wealth += times * np.log1p(odds * (value - price))
        largest = float(np.max(log_wealth))
        return largest + math.log(float(_WEIGHTS @ np.exp(log_wealth - largest)))

    def _payoffs(self, up: bool) -> dict[float, int]:
        return {(value if up else 1.0 - value): times for value, times in self._counts.items()}


def _alternatives() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the alternative means, as shares of the way from m to 1, and their weights.

    They are denser at both ends, where a small difference matters (arcsine distribution). The
    weights add up to 1; no alternative lies on an end.
    """
    angles = (np.arange(_BETS) + 0.5) / _BETS * (math.pi / 2.0)
    return np.sin(angles) ** 2, np.full(_BETS, 1.0 / _BETS)


_ALTERNATIVES, _WEIGHTS = _alternatives()
