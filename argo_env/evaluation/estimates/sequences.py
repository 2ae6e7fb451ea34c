"""Confidence sequences: what may be looked at after each run, and acted upon.

An interval that is made for a fixed number of runs errs more and more often the more often one
looks at it. A confidence sequence has the true mean at all times at once, with the probability
`level`: whoever stops because of what it says keeps what it says.

It is made by betting. Somebody who says that the mean is m sells bets on each outcome at that
price; a buyer whose money has grown twentyfold has shown at the level 95 % that it is another one,
since money grows in a fair game by 20 or more with a probability of at most 1/20 (Ville's
inequality). The buyer spreads the money over the means that may be true instead, and leaves it
there. Where outcomes are 0 or 1, that is the mixture of binomial likelihoods of H. Robbins (Annals
of Mathematical Statistics 41 (1970), 1397-1409); for any outcomes from 0 to 1 see
I. Waudby-Smith and A. Ramdas, Journal of the Royal Statistical Society B 86 (2024), 1-27.
"""

import math
from collections import Counter
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Invalid
from argo_env.evaluation.estimates.rates import LEVEL

_BETS = 200
"""means that the money is spread over, between m and the end of the scale"""
_STEPS = 40  # of a bisection


class ConfidenceSequence:
    """Between what the mean of outcomes from 0 to 1 lies that come one after the other, independent
    of each other. Holds how often each came."""

    def __init__(self, level: float = LEVEL) -> None:
        if not 0 < level < 1:
            raise Invalid(f"a level of {level:g}: give one between 0 and 1")
        self._needed = math.log(2.0 / (1.0 - level))
        self._seen: Counter[float] = Counter()

    @property
    def runs(self) -> int:
        return self._seen.total()

    def add(self, outcomes: Iterable[float]) -> None:
        """More outcomes, 0 to 1."""
        for outcome in outcomes:
            if not 0.0 <= outcome <= 1.0:
                raise Invalid(f"an outcome of {outcome!r}: it must lie between 0 and 1")
            self._seen[float(outcome)] += 1

    def is_above(self, mean: float) -> bool:
        """Whether it is shown that the mean is at least this."""
        return self._money(mean, up=True) >= self._needed

    def is_below(self, mean: float) -> bool:
        """Whether it is shown that the mean is at most this."""
        return self._money(mean, up=False) >= self._needed

    @property
    def interval(self) -> tuple[float, float]:
        """All means that are not shown to be wrong."""
        if not self._seen:
            return 0.0, 1.0
        middle = sum(value * n for value, n in self._seen.items()) / self.runs
        return self._end(0.0, middle, up=True), self._end(1.0, middle, up=False)

    def _end(self, wrong: float, possible: float, up: bool) -> float:
        """The farthest mean from what was seen that is still possible, rounded away from it."""
        if wrong == possible:
            return possible
        for _ in range(_STEPS):
            middle = (wrong + possible) / 2.0
            if self._money(middle, up) >= self._needed:
                wrong = middle
            else:
                possible = middle
        return wrong

    def _money(self, mean: float, up: bool) -> float:
        """Logarithm of what has become of a bet of 1 against a mean of at most this, or with `up`
        False at least this."""
        price = mean if up else 1.0 - mean
        if price >= 1.0:
            return -math.inf  # nothing is left to be won
        if price <= 0.0:
            raise Invalid(f"a mean of {mean:g} is no question: every mean is between 0 and 1")
        hoped = price + (1.0 - price) * _SHARES
        odds = (hoped - price) / (price * (1.0 - price))
        total = np.zeros(len(hoped))
        for value, times in self._won(up).items():
            total += times * np.log1p(odds * (value - price))
        most = float(np.max(total))
        return most + math.log(float(_WEIGHTS @ np.exp(total - most)))

    def _won(self, up: bool) -> dict[float, int]:
        return {(value if up else 1.0 - value): times for value, times in self._seen.items()}


def _shares() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Where between m and 1 the money lies, and how much of it: denser at both ends, where a
    small difference matters (an arcsine distribution). Shares add up to 1; none lies on an end."""
    angles = (np.arange(_BETS) + 0.5) / _BETS * (math.pi / 2.0)
    return np.sin(angles) ** 2, np.full(_BETS, 1.0 / _BETS)


_SHARES, _WEIGHTS = _shares()
