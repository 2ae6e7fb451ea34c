"""The course of a search: what was known when."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from argo_compiler.route.suggestion import Point


@dataclass
class Search:
    """The time that a search has, and what it has found. Has state."""

    clock: Callable[[], float]
    """s, of whatever begin"""
    deadline: float
    """on that clock"""
    seed: int
    workers: int
    prize_bound: int
    bound: int = 0
    begun: float = 0.0
    certain: bool = True
    """whether what is proven of the network is so of the problem"""
    stopped: bool = False
    history: list[Point] = field(default_factory=list)
    reasons: list[str] = field(default_factory=list)
    _prize: int | None = None
    _cost: int | None = None

    def alone(self) -> "Search":
        """A search with the same time, for another thread."""
        return Search(
            self.clock,
            self.deadline,
            self.seed,
            1,
            self.prize_bound,
            self.bound,
            self.begun,
            self.certain,
        )

    @contextmanager
    def part(self, share: float) -> Iterator[None]:
        """Within it, there is only a share of the time that is left."""
        deadline = self.deadline
        self.deadline = self.clock() + share * self.left()
        try:
            yield
        finally:
            self.deadline = deadline

    def left(self) -> float:
        """s until the deadline, at least 0."""
        return 0.0 if self.stopped else max(0.0, self.deadline - self.clock())

    def stop(self) -> None:
        """From now on, there is no time left."""
        self.stopped = True

    def route(self, prize: int, cost: int) -> None:
        """A route was found. Those that are no better than the best so far are not noted."""
        best = None if self._prize is None else (-self._prize, self._cost or 0)
        if best is None or (-prize, cost) < best:
            self._prize, self._cost = prize, cost
            self._note()

    def known(self, prize_bound: int | None = None, bound: int | None = None) -> None:
        """Something is proven of all routes."""
        if not self.certain:
            return
        tighter = prize_bound is not None and prize_bound < self.prize_bound
        higher = bound is not None and bound > self.bound
        if tighter and prize_bound is not None:
            self.prize_bound = prize_bound
        if higher and bound is not None:
            self.bound = bound
        if tighter or higher:
            self._note()

    def say(self, reason: str) -> None:
        """Notes why the route is as it is."""
        self.reasons.append(reason)

    def _note(self) -> None:
        now = self.clock() - self.begun
        self.history.append(Point(now, self._prize, self._cost, self.prize_bound, self.bound))
