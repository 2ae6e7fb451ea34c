"""The result of a search for a route: an order, and how good it is known to be."""

from collections.abc import Mapping
from dataclasses import dataclass

from argo_compiler.route.problem import Tour
from argo_compiler.route.stop import SearchProgress, SolverTurn, gap


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
    smaller set of them can, unless there was no time to find that out, as `reasons` then says;
    empty: none are known"""
    method: str = ""
    """which solver it comes from"""
    reasons: tuple[str, ...] = ()
    """why the route was made so: what was tried, and what was picked why"""
    history: tuple[SearchProgress, ...] = ()
    """what was known when: the curve of an anytime search"""
    turns: tuple[SolverTurn, ...] = ()
    """which solver took part when, by their begin"""

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
        return gap(self.prize, self.cost, self.prize_bound, self.bound)
