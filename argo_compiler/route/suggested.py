"""Result of a search for a route: an order of visits, its cost and the proven bounds."""

from collections.abc import Mapping
from dataclasses import dataclass

from argo_compiler.route.problem import Tour
from argo_compiler.route.stop import SearchProgress, SolverTurn, gap


@dataclass(frozen=True)
class RouteSuggestion:
    """Route with its proven bounds, or requirements that cannot all be met.

    If visits are optional, the prize is maximised first, and then the cost is minimised. Without a
    route, all that describes one is None, and `proven` is false.
    """

    route: Tour | None
    """best route that was found; None: none was found, see `infeasible`"""
    prize: int | None
    """prize of the route; None without a route"""
    prize_bound: int
    """upper bound on the prize of any route"""
    cost: int | None
    """value that the problem's objective minimises, in units; None without a route"""
    bound: int
    """lower bound on the cost of the routes that win `prize_bound`, in units"""
    proven: bool
    """true if the route is proven to be the best one"""
    infeasible: bool = False
    """true if it is proven that there is no route"""
    dropped: tuple[int, ...] | None = None
    """visits that the route leaves out; None without a route"""
    infeasible_subset: tuple[str, ...] = ()
    """without a route: requirements, in the mission's words, that cannot all be met although each
    smaller set of them can. If there was no time to check the smaller sets, `reasons` says so.
    Empty: none are known"""
    method: str = ""
    """name of the solver that completed the proof, or, without one, found the route"""
    reasons: tuple[str, ...] = ()
    """messages about how the route was found: the methods tried and their results"""
    history: tuple[SearchProgress, ...] = ()
    """progress at each new route or bound: the curve of an anytime search"""
    turns: tuple[SolverTurn, ...] = ()
    """turns of the solvers, by their begin"""

    @property
    def order(self) -> tuple[int, ...] | None:
        """Visits in the route's order; None without a route."""
        return None if self.route is None else self.route.order

    @property
    def charges(self) -> Mapping[int, int] | None:
        """Charges of the route, as in `Tour`; None without a route."""
        return None if self.route is None else self.route.charges

    @property
    def gap(self) -> float | None:
        """Optimality gap, as a share; None without a route.

        It is the gap of the prize, until that is proven, and then the gap of the cost, as
        `argo_compiler.route.stop.gap` computes them.
        """
        if self.prize is None or self.cost is None:
            return None
        return gap(self.prize, self.cost, self.prize_bound, self.bound)
