"""Pool that distributes calls to workers and survives calls that kill their worker.

Several calls are sent together in a chunk, since sending takes as long as a short call itself.
"""

import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from argo_env.closing import Closing
from argo_env.evaluation.pool.backend import WorkerBackend, WorkerDiedError

_CHUNK_TIME = 0.25  # s that a chunk should take, a short time to wait for its results
_MAX_CHUNK = 32


@dataclass(frozen=True)
class CallOutcome:
    """Result of one call in a chunk."""

    value: Any = None
    error: Exception | None = None
    """exception that the call raised; None if it returned"""


@dataclass(frozen=True)
class Chunk:
    """Function with the arguments of several calls, which are executed one after the other."""

    function: Callable[[Any], Any]
    arguments: tuple[Any, ...]


def execute_chunk(chunk: Chunk) -> tuple[tuple[CallOutcome, ...], float]:
    """Execute the calls of a chunk; return their outcomes and the time of all of them in s.

    Workers call this function.
    """
    start = time.perf_counter()
    outcomes = []
    for argument in chunk.arguments:
        try:
            outcomes.append(CallOutcome(chunk.function(argument)))
        except Exception as error:  # any exception of the function is the outcome of the call
            outcomes.append(CallOutcome(error=error))
    return tuple(outcomes), time.perf_counter() - start


class ChunkSize:
    """Number of calls in a chunk; it adapts to the measured time of the calls."""

    def __init__(self) -> None:
        self._mean: float | None = None
        """moving average of the time of a call in s; None before the first measurement"""

    def update(self, count: int, seconds: float) -> None:
        """Update the moving average of a call's time: `count` calls took `seconds` together."""
        mean = seconds / count
        self._mean = mean if self._mean is None else 0.8 * self._mean + 0.2 * mean

    @property
    def limit(self) -> int:
        """Number of calls, 1 to 32, that take about 0.25 s; 1 before the first measurement."""
        if self._mean is None:
            return 1
        return max(1, min(_MAX_CHUNK, int(_CHUNK_TIME / max(self._mean, 1e-6))))

    def next_size(self, waiting: Sequence[Any], workers: int) -> int:
        """Return the number of calls in the next chunk: `limit`, or fewer to supply all workers."""
        return min(self.limit, max(1, len(waiting) // workers))


CRASHES, KILLS = 3, 10
"""number of deaths of workers, by a crash or by a kill, after which the pool gives up their call.
Deaths that another call may have caused don't count. A worker may be killed by chance, and more
than once, so that more kills are allowed."""
_CHUNKS_AHEAD = 3  # chunks for each worker that are sent at once, so that no worker has to wait


@dataclass(frozen=True)
class CompletedCall:
    """Result of a call, as the pool returns it."""

    ticket: Any
    """identifier that the caller gave to `submit`"""
    value: Any = None
    """value that the call returned"""
    error: Exception | None = None
    """exception that the call raised; None if it returned"""
    died: str | None = None
    """reason why its workers died at each attempt; None if they did not"""


@dataclass
class _Call:
    ticket: Any
    argument: Any
    deaths: float = 0.0
    """deaths of workers that this call caused, as a share of those at which it is given up"""
    alone: bool = False
    """whether this call must be the cause if its worker dies now"""
    single: bool = False
    """whether the call must be in a chunk of its own"""


class Pool(Closing):
    """Pool that executes calls of one function in workers and yields the results as they complete.

    It holds the calls that have not completed. Short calls are sent in chunks. If a worker dies,
    its calls are repeated by new workers, each while no other call runs that could be the cause. A
    call whose workers die at each attempt completes with `died`. All other calls are executed, and
    executed again if they were lost with a worker.
    """

    def __init__(self, backend: WorkerBackend, function: Callable[[Any], Any]) -> None:
        self._backend = backend
        self._function = function
        self._waiting: deque[_Call] = deque()
        self._suspects: deque[_Call] = deque()
        self._running: dict[Any, list[_Call]] = {}
        self._chunk_size = ChunkSize()

    @property
    def pending(self) -> int:
        """Number of submitted calls that `as_completed` has not collected yet."""
        running = sum(map(len, self._running.values()))
        return len(self._waiting) + len(self._suspects) + running

    @property
    def needs_calls(self) -> bool:
        """True if a worker may soon be idle unless more calls are submitted."""
        return self.pending < 2 * _CHUNKS_AHEAD * self._backend.workers * self._chunk_size.limit

    def submit(self, ticket: Any, argument: Any) -> None:
        """Add a call of the function with this argument, for the next free worker.

        `ticket` is any object by which the caller recognises the call when it has completed.
        """
        self._waiting.append(_Call(ticket, argument))

    def as_completed(self) -> Iterator[CompletedCall]:
        """Yield the calls with their results as they complete, until none is pending.

        More calls may be submitted meanwhile.
        """
        while self.pending:
            self._dispatch()
            for handle in self._backend.wait(list(self._running)):
                yield from self._collect(handle)

    def close(self) -> None:
        """End the workers; calls that they execute are lost."""
        self._backend.close()

    def _dispatch(self) -> None:
        if self._suspects and not self._backend.isolates_deaths:
            # Suspects run one after the other and alone, so that a death identifies its call.
            if not self._running:
                self._backend.replace_dead_workers()
                self._start([self._suspects.popleft()], alone=True)
            return
        while self._suspects:
            self._start([self._suspects.popleft()], alone=True)
        while self._waiting and len(self._running) < _CHUNKS_AHEAD * self._backend.workers:
            calls = self._next_chunk()
            self._start(calls, alone=self._backend.isolates_deaths and len(calls) == 1)

    def _next_chunk(self) -> list[_Call]:
        """Remove the calls of the next chunk from the waiting ones, and return them."""
        calls = [self._waiting.popleft()]
        for _ in range(self._chunk_size.next_size(self._waiting, self._backend.workers) - 1):
            if calls[0].single or not self._waiting or self._waiting[0].single:
                break
            calls.append(self._waiting.popleft())
        return calls

    def _start(self, calls: list[_Call], alone: bool) -> None:
        for call in calls:
            call.alone = alone
        chunk = Chunk(self._function, tuple(call.argument for call in calls))
        try:
            handle = self._backend.submit(execute_chunk, chunk)
        except WorkerDiedError:
            # The workers died before they received these calls.
            self._suspects.extend(calls)
            return
        self._running[handle] = calls

    def _collect(self, handle: Any) -> Iterator[CompletedCall]:
        calls = self._running.pop(handle)
        try:
            outcomes, seconds = self._backend.result(handle)
        except WorkerDiedError as death:
            for call in calls:
                if call.alone:
                    call.deaths += 1 / (KILLS if death.killed else CRASHES)
                if call.deaths > 1 - 1e-9:
                    yield CompletedCall(call.ticket, died=str(death))
                else:
                    self._suspects.append(call)
        except Exception as error:  # the chunk or its result can't be pickled
            if len(calls) == 1:
                yield CompletedCall(calls[0].ticket, error=error)
            for call in calls if len(calls) > 1 else ():
                call.single = True
                self._waiting.append(call)
        else:
            self._chunk_size.update(len(calls), seconds)
            for call, outcome in zip(calls, outcomes, strict=True):
                yield CompletedCall(call.ticket, outcome.value, outcome.error)
