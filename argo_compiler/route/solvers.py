"""The solvers of route problems: their protocol, Argo's own, and those that are registered.

A new one of Argo's is listed here; when it takes part, `portfolio.py` says.
"""

from typing import Protocol

from argo_compiler.base.errors import Conflict
from argo_compiler.route.cp_sat import CpSat
from argo_compiler.route.exchange_search import ExchangeSearch
from argo_compiler.route.first_rules import FirstRules
from argo_compiler.route.held_karp import HeldKarp
from argo_compiler.route.labels import LabelBeams, Labels
from argo_compiler.route.linear_proof import LinearProof
from argo_compiler.route.problem import RouteProblem
from argo_compiler.route.pyvrp_search import PyvrpSearch
from argo_compiler.route.ruin_recreate import RuinRecreate
from argo_compiler.route.search import Search


class RouteSolver(Protocol):
    """Looks for routes, or proves things of them."""

    @property
    def name(self) -> str:
        """What users are told that a route comes from."""
        ...

    def supports(self, problem: RouteProblem, /) -> bool:
        """Whether it can take part in the search for this problem."""
        ...

    def solve(self, search: Search, /) -> None:
        """Offers routes and what it proves to the search, until `search.left()` is 0 or there is
        nothing more that it can do. Under a limit of work (`not search.timed`) it must report that
        by `search.spend`, and do the same each time."""
        ...


FIRST: tuple[RouteSolver, ...] = (FirstRules(),)
SMALL: tuple[RouteSolver, ...] = (HeldKarp(), Labels())
"""prove what is small enough, and give up on all else at once"""
IMPROVING: tuple[RouteSolver, ...] = (PyvrpSearch(), ExchangeSearch(), RuinRecreate())
PROVING: tuple[RouteSolver, ...] = (LinearProof(), LabelBeams(), CpSat())

_registered: dict[str, RouteSolver] = {}


def register_solver(solver: RouteSolver) -> None:
    """From now on, it takes part in the search for each problem that it supports, in this process.

    Raises Conflict if there is one of that name already.
    """
    if solver.name in _registered:
        raise Conflict(f"there is a route solver {solver.name!r} already; name yours otherwise")
    _registered[solver.name] = solver


def unregister_solver(name: str) -> None:
    """It takes part no more."""
    _registered.pop(name, None)


def registered_solvers() -> tuple[RouteSolver, ...]:
    """One's own, in the order of their registration."""
    return tuple(_registered.values())


def solver_names() -> tuple[str, ...]:
    """Return the names of all solvers: Argo's own, then those that are registered."""
    groups = FIRST, SMALL, IMPROVING, PROVING, registered_solvers()
    return tuple(solver.name for group in groups for solver in group)
