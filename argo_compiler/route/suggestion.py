"""One call for all route problems, and what it says: an order, and how good it is known to be."""

import logging
from collections.abc import Mapping
from dataclasses import dataclass

from argo_compiler.errors import Invalid
from argo_compiler.route.problem import RouteProblem, Tour

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Point:
    """What was known at one moment of the search."""

    time: float
    """s since the search began"""
    prize: int | None
    """of the best route so far; None: there was none"""
    cost: int | None
    """of the best route so far, in units"""
    prize_bound: int
    """no route wins more"""
    bound: int
    """no route that wins as much as the best can win costs less, in units"""


@dataclass(frozen=True)
class RouteSuggestion:
    """A route and its proof, or the requirements that can't all be met.

    With something optional, first as much prize as possible is won, and then the cost made small.
    """

    route: Tour | None
    """None: none was found"""
    prize: int
    prize_bound: int
    """no route wins more"""
    cost: int
    """what the problem's objective makes small, in units"""
    bound: int
    """no route that wins `prize_bound` costs less, in units"""
    proven: bool
    """whether the route is known to be the best, or, without one, that there is none"""
    dropped: tuple[int, ...] = ()
    """the visits that are left out"""
    infeasible_subset: tuple[str, ...] = ()
    """without a route: requirements, in the mission's words, that can't all be met, though each
    smaller set of them can; empty: none are known"""
    method: str = ""
    """which solver it comes from"""
    reasons: tuple[str, ...] = ()
    """why the route was made so: what was tried, and what was picked why"""
    history: tuple[Point, ...] = ()

    @property
    def order(self) -> tuple[int, ...]:
        """The visits in their order; empty where there is no route."""
        return () if self.route is None else self.route.order

    @property
    def charges(self) -> Mapping[int, int]:
        """See Route."""
        return {} if self.route is None else self.route.charges

    @property
    def gap(self) -> float | None:
        """By what share the best order could be better at most: of the prize, where that is not
        proven, else of the cost. None without a route."""
        if self.route is None:
            return None
        if self.prize < self.prize_bound:
            return (self.prize_bound - self.prize) / self.prize_bound
        return (self.cost - self.bound) / self.cost if self.cost > self.bound else 0.0


def suggest_route(
    problem: RouteProblem,
    time_limit: float = 5.0,
    seed: int = 0,
    workers: int = 1,
    explain: bool = True,
) -> RouteSuggestion:
    """The best route that is found within the time limit (s), and what is known of it. Where there
    is none, what can't all be met is looked for after that time as well, unless nothing is to be
    explained.

    What is proven does not depend on the seed; the route may, where others are as good or the time
    is over. Raises ArgoError if the time limit or the number of workers is not positive.
    """
    if not time_limit > 0.0 or workers < 1:
        raise Invalid(
            f"a route needs time and a worker to be looked for, not {time_limit:g} s and {workers}"
        )
    # OR-Tools takes a second to be imported, and most who import this package don't search.
    from argo_compiler.route.find_route import find_route

    found = find_route(problem, time_limit, seed, workers, explain=explain)
    for reason in found.reasons:
        _log.debug("%s", reason)
    _log.info(
        "%d visits: %s by %s",
        problem.size,
        "no route" if found.route is None else "proven" if found.proven else "not proven",
        found.method or "no search",
    )
    return found
