"""How far a search is, and the criteria by which it ends before its limit.

A criterion is any callable that is given a `SearchProgress` and says whether to stop. It is called
often, from several threads.
"""

from collections.abc import Callable
from dataclasses import dataclass

from argo_compiler.base.errors import Invalid


@dataclass(frozen=True)
class SearchProgress:
    """What was known at one moment of a search."""

    time: float
    """s since the search began"""
    work: float
    """s that solvers have worked by their own count, which a busy machine does not change"""
    iterations: int
    """routes that local searches have tried"""
    prize: int | None
    """of the best route so far; None: there was none"""
    cost: int | None
    """of the best route so far, in units"""
    prize_bound: int
    """no route wins more"""
    bound: int
    """no route that wins as much as the best can win costs less, in units"""
    better: tuple[float, int] = (0.0, 0)
    """time and iterations when the best route was found; those of the beginning before"""
    solver: str = ""
    """in the curve of a search: who found this"""

    @property
    def gap(self) -> float | None:
        """See `gap`; None without a route."""
        if self.prize is None or self.cost is None:
            return None
        return gap(self.prize, self.cost, self.prize_bound, self.bound)


def gap(prize: int, cost: int, prize_bound: int, bound: int) -> float:
    """By what share a route could be better at most: in the prize, where that is not proven, else
    in the cost."""
    if prize < prize_bound:
        return (prize_bound - prize) / prize_bound
    return (cost - bound) / cost if cost > bound else 0.0


@dataclass(frozen=True)
class SolverTurn:
    """When a solver took part; s since the search began."""

    solver: str
    begin: float
    end: float


StopCriterion = Callable[[SearchProgress], bool]


@dataclass(frozen=True)
class MaxRuntime:
    """When so many seconds are over."""

    seconds: float

    def __call__(self, progress: SearchProgress) -> bool:
        return progress.time >= self.seconds


@dataclass(frozen=True)
class MaxIterations:
    """When local searches have tried so many routes."""

    iterations: int

    def __call__(self, progress: SearchProgress) -> bool:
        return progress.iterations >= self.iterations


@dataclass(frozen=True)
class NoImprovement:
    """When no better route was found for so many iterations, or seconds; there must be a route."""

    iterations: int | None = None
    seconds: float | None = None

    def __post_init__(self) -> None:
        if self.iterations is None and self.seconds is None:
            raise Invalid("without improvement for how long? give iterations or seconds")

    def __call__(self, progress: SearchProgress) -> bool:
        if progress.prize is None:
            return False
        since, last = progress.better
        many = self.iterations is not None and progress.iterations - last >= self.iterations
        return many or (self.seconds is not None and progress.time - since >= self.seconds)


@dataclass(frozen=True)
class MaxGap:
    """When the best route is within this share of the best that there can be."""

    gap: float

    def __call__(self, progress: SearchProgress) -> bool:
        return progress.gap is not None and progress.gap <= self.gap


@dataclass(frozen=True)
class FirstFeasible:
    """When there is a route."""

    def __call__(self, progress: SearchProgress) -> bool:
        return progress.prize is not None


@dataclass(frozen=True)
class MultipleCriteria:
    """When any of some criteria is met."""

    criteria: tuple[StopCriterion, ...]

    def __call__(self, progress: SearchProgress) -> bool:
        return any(criterion(progress) for criterion in self.criteria)
