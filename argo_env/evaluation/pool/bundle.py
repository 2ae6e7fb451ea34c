"""Several calls handed to a worker together: to hand over a short one takes as long as itself."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

_WORTH = 0.25  # s that a bundle should take: as long as nobody minds waiting for what came of it
_MOST = 32


@dataclass(frozen=True)
class CallOutcome:
    """What came of one of the calls."""

    value: Any = None
    error: Exception | None = None
    """what it raised, if it did"""


@dataclass(frozen=True)
class Bundle:
    """A function, and what it is called with, one after the other."""

    call: Callable[[Any], Any]
    arguments: tuple[Any, ...]


def carry_out_bundle(bundle: Bundle) -> tuple[tuple[CallOutcome, ...], float]:
    """In a worker: what came of each call, and how long all took (s)."""
    begun = time.perf_counter()
    outcomes = []
    for argument in bundle.arguments:
        try:
            outcomes.append(CallOutcome(bundle.call(argument)))
        except Exception as error:  # whatever the function raises is what came of the call
            outcomes.append(CallOutcome(error=error))
    return tuple(outcomes), time.perf_counter() - begun


class BundleSize:
    """How many calls are handed over together. Learns how long they take."""

    def __init__(self) -> None:
        self._mean: float | None = None
        """s a call"""

    def learn(self, count: int, seconds: float) -> None:
        """So many calls took that long."""
        mean = seconds / count
        self._mean = mean if self._mean is None else 0.8 * self._mean + 0.2 * mean

    @property
    def most(self) -> int:
        """As many as together take about a quarter of a second; one as long as nothing is known."""
        if self._mean is None:
            return 1
        return max(1, min(_MOST, int(_WORTH / max(self._mean, 1e-6))))

    def of(self, waiting: Sequence[Any], workers: int) -> int:
        """How many of those that wait: no more than leaves some for each worker."""
        return min(self.most, max(1, len(waiting) // workers))
