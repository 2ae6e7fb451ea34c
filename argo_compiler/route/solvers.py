"""Solvers of route problems: their protocol, Argo's own solvers, and a register for others.

A new solver of Argo is listed here; `portfolio.py` decides when it takes part.
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
    """Method that offers routes or proves bounds on them."""

    @property
    def name(self) -> str:
        """Name that users see as the method of a route."""
        ...

    def supports(self, problem: RouteProblem, /) -> bool:
        """Return True if the solver can take part in the search for this problem."""
        ...

    def solve(self, search: Search, /) -> None:
        """Offer routes and report bounds to the search.

        Ends when `search.remaining_time()` is 0, or when the solver has nothing more to try. Under
        a limit of work (`not search.timed`) it must report its work by `search.spend`, and must be
        deterministic.
        """
        ...


FIRST: tuple[RouteSolver, ...] = (FirstRules(),)
SMALL: tuple[RouteSolver, ...] = (HeldKarp(), Labels())
"""solvers that prove small problems to optimality, and give up on all others at once"""
IMPROVING: tuple[RouteSolver, ...] = (PyvrpSearch(), ExchangeSearch(), RuinRecreate())
PROVING: tuple[RouteSolver, ...] = (LinearProof(), LabelBeams(), CpSat())

_registered: dict[str, RouteSolver] = {}


def register_solver(solver: RouteSolver) -> None:
    """Register a solver: in this process it takes part in each search that it supports.

    Raises Conflict if a solver of that name is registered already.
    """
    if solver.name in _registered:
        raise Conflict(f"a route solver {solver.name!r} is registered already; choose another name")
    _registered[solver.name] = solver


def discard_solver(name: str) -> None:
    """Remove a registered solver; no-op if there is none of that name."""
    _registered.pop(name, None)


def registered_solvers() -> tuple[RouteSolver, ...]:
    """Return the registered solvers, in the order of their registration."""
    return tuple(_registered.values())


def all_solver_names() -> tuple[str, ...]:
    """Return the names of all solvers: Argo's own, then the registered ones."""
    groups = FIRST, SMALL, IMPROVING, PROVING, registered_solvers()
    return tuple(solver.name for group in groups for solver in group)
