"""Progress of a search, and the criteria that end it before its limit.

A criterion is any callable that takes a `SearchProgress` and returns True to stop the search. It is
called often, from several threads.
"""

from collections.abc import Callable
from dataclasses import dataclass

from argo_compiler.base.errors import Invalid


@dataclass(frozen=True)
class SearchProgress:
    """Best route and bounds known at one moment of a search."""

    time: float
    """s since the search began"""
    work: float
    """nominal s of the solvers' work, by their own count, which does not depend on the machine's
    load"""
    iterations: int
    """number of routes that local searches have tried"""
    prize: int | None
    """prize of the best route so far; None: there is none"""
    cost: int | None
    """cost of the best route so far, in units; None: there is none"""
    prize_bound: int
    """upper bound on the prize of any route"""
    bound: int
    """lower bound on the cost of the routes with the highest possible prize, in units"""
    better: tuple[float, int] = (0.0, 0)
    """time and iterations when the best route was found; zeros without a route"""
    solver: str = ""
    """in the history of a search: the solver that found the route or the bound"""

    @property
    def gap(self) -> float | None:
        """Optimality gap, as the function `gap` computes it; None without a route."""
        if self.prize is None or self.cost is None:
            return None
        return gap(self.prize, self.cost, self.prize_bound, self.bound)


def gap(prize: int, cost: int, prize_bound: int, bound: int) -> float:
    """Return the optimality gap of a route, relative to a bound.

    It is the gap of the prize, as a share of `prize_bound`, while the prize is below that bound;
    else the gap of the cost, as a share of the cost; 0 if the cost is not above `bound`.
    """
    if prize < prize_bound:
        return (prize_bound - prize) / prize_bound
    return (cost - bound) / cost if cost > bound else 0.0


@dataclass(frozen=True)
class SolverTurn:
    """Time in which a solver took part; begin and end in s since the search began."""

    solver: str
    begin: float
    end: float


StopCriterion = Callable[[SearchProgress], bool]


@dataclass(frozen=True)
class MaxRuntime:
    """Criterion that stops the search after `seconds`."""

    seconds: float

    def __call__(self, progress: SearchProgress) -> bool:
        return progress.time >= self.seconds


@dataclass(frozen=True)
class MaxIterations:
    """Criterion that stops the search when local searches have tried `iterations` routes."""

    iterations: int

    def __call__(self, progress: SearchProgress) -> bool:
        return progress.iterations >= self.iterations


@dataclass(frozen=True)
class NoImprovement:
    """Criterion that stops the search when the best route has not improved for some time.

    That time is a number of iterations, of seconds, or whichever passes first. The search does not
    stop before it has a route.
    """

    iterations: int | None = None
    seconds: float | None = None

    def __post_init__(self) -> None:
        if self.iterations is None and self.seconds is None:
            raise Invalid("NoImprovement needs a limit: give iterations or seconds")

    def __call__(self, progress: SearchProgress) -> bool:
        if progress.prize is None:
            return False
        since, last = progress.better
        many = self.iterations is not None and progress.iterations - last >= self.iterations
        return many or (self.seconds is not None and progress.time - since >= self.seconds)


@dataclass(frozen=True)
class MaxGap:
    """Criterion that stops the search when the best route's optimality gap is at most `gap`."""

    gap: float

    def __call__(self, progress: SearchProgress) -> bool:
        return progress.gap is not None and progress.gap <= self.gap


@dataclass(frozen=True)
class FirstFeasible:
    """Criterion that stops the search when it has a route."""

    def __call__(self, progress: SearchProgress) -> bool:
        return progress.prize is not None


@dataclass(frozen=True)
class MultipleCriteria:
    """Criterion that stops the search when any of several criteria is met."""

    criteria: tuple[StopCriterion, ...]

    def __call__(self, progress: SearchProgress) -> bool:
        return any(criterion(progress) for criterion in self.criteria)
