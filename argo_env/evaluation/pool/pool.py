"""Calls handed to workers, and what came of each: also of those that kill their worker.

Several calls are handed over together, since that takes as long for a short one as the call itself.
"""

import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from argo_env.closing import Closing
from argo_env.evaluation.pool.backend import WorkerBackend, WorkerDiedError

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


CRASHES, KILLS = 3, 10
"""deaths of a worker from which on its call is given up: those of which no other call can be the
reason. A process that was killed may have been so by chance, and more than once."""
_AHEAD = 3  # bundles a worker that are handed over at once, so that none waits for the next


@dataclass(frozen=True)
class Finished:
    """What came of a call."""

    ticket: Any
    """what `submit` was given"""
    value: Any = None
    """what it returned"""
    error: Exception | None = None
    """what it raised, if it did"""
    died: str | None = None
    """why its workers died, if they did, each time that it was tried"""


@dataclass
class _Call:
    ticket: Any
    argument: Any
    deaths: float = 0.0
    """of its workers that are its own, as a share of those with which it is given up"""
    alone: bool = False
    """whether no other call can be the reason if its worker dies now"""
    single: bool = False
    """whether it is to be handed over by itself"""


class Pool(Closing):
    """Hands calls of one function to workers and gives back what came of them, as it comes.

    Short calls are handed over several together. Where a worker dies, its calls are tried again in
    fresh ones, each while no other is under way that could be the reason; a call whose workers die
    each time is given back as `died`. All others are carried out, each once more if it was lost
    with a worker.
    """

    def __init__(self, backend: WorkerBackend, call: Callable[[Any], Any]) -> None:
        self._backend = backend
        self._call = call
        self._waiting: deque[_Call] = deque()
        self._suspects: deque[_Call] = deque()
        self._under_way: dict[Any, list[_Call]] = {}
        self._size = BundleSize()

    @property
    def open(self) -> int:
        """How many calls have not ended."""
        under_way = sum(map(len, self._under_way.values()))
        return len(self._waiting) + len(self._suspects) + under_way

    @property
    def wants_more(self) -> bool:
        """Whether a worker may soon have nothing to do."""
        return self.open < 2 * _AHEAD * self._backend.workers * self._size.most

    def submit(self, ticket: Any, argument: Any) -> None:
        """Calls the function with the argument, when a worker is free for it."""
        self._waiting.append(_Call(ticket, argument))

    def as_completed(self) -> Iterator[Finished]:
        """What came of the calls, in the order in which they end; more may be submitted
        meanwhile. Ends when none is open."""
        while self.open:
            self._hand_over()
            for handle in self._backend.wait(list(self._under_way)):
                yield from self._taken(handle)

    def close(self) -> None:
        """Ends the workers. What they were at is lost."""
        self._backend.close()

    def _hand_over(self) -> None:
        if self._suspects and not self._backend.names_the_dead:
            # One after the other, and alone: who dies then is to blame.
            if not self._under_way:
                self._backend.mend()
                self._begin([self._suspects.popleft()], alone=True)
            return
        while self._suspects:
            self._begin([self._suspects.popleft()], alone=True)
        while self._waiting and len(self._under_way) < _AHEAD * self._backend.workers:
            calls = self._bundled()
            self._begin(calls, alone=self._backend.names_the_dead and len(calls) == 1)

    def _bundled(self) -> list[_Call]:
        """The next ones of those that wait."""
        calls = [self._waiting.popleft()]
        for _ in range(self._size.of(self._waiting, self._backend.workers) - 1):
            if calls[0].single or not self._waiting or self._waiting[0].single:
                break
            calls.append(self._waiting.popleft())
        return calls

    def _begin(self, calls: list[_Call], alone: bool) -> None:
        for call in calls:
            call.alone = alone
        bundle = Bundle(self._call, tuple(call.argument for call in calls))
        try:
            handle = self._backend.submit(carry_out_bundle, bundle)
        except WorkerDiedError:
            # The workers died of something before these calls came to them.
            self._suspects.extend(calls)
            return
        self._under_way[handle] = calls

    def _taken(self, handle: Any) -> Iterator[Finished]:
        calls = self._under_way.pop(handle)
        try:
            outcomes, seconds = self._backend.result(handle)
        except WorkerDiedError as death:
            for call in calls:
                if call.alone:
                    call.deaths += 1 / (KILLS if death.killed else CRASHES)
                if call.deaths > 1 - 1e-9:
                    yield Finished(call.ticket, died=str(death))
                else:
                    self._suspects.append(call)
        except Exception as error:  # what can't be sent to a worker, or back
            if len(calls) == 1:
                yield Finished(calls[0].ticket, error=error)
            for call in calls if len(calls) > 1 else ():
                call.single = True
                self._waiting.append(call)
        else:
            self._size.learn(len(calls), seconds)
            for call, outcome in zip(calls, outcomes, strict=True):
                yield Finished(call.ticket, outcome.value, outcome.error)
