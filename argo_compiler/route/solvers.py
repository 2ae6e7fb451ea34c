"""Solvers of route problems: their protocol, Argo's own solvers, and those of others.

A new solver of Argo is listed here; `portfolio.py` decides when it takes part.
"""

import logging
from dataclasses import dataclass
from itertools import chain
from typing import Protocol

from argo_compiler.base.extensions import ExtensionPoint
from argo_compiler.base.message import Message
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


def _find_problem(name: str, item: object) -> str | None:
    if isinstance(item, type):
        return Message("is a class: offer an object of it")
    if getattr(item, "name", None) != name:
        return Message("has another `name` than `{name}`", name=name)
    lacking = [method for method in ("supports", "solve") if not hasattr(item, method)]
    return Message("has no `{lacking}`", lacking=lacking[0]) if lacking else None


SOLVERS: ExtensionPoint[RouteSolver] = ExtensionPoint(
    "argo.solvers",
    Message("route solver"),
    {solver.name: solver for solver in chain(FIRST, SMALL, IMPROVING, PROVING)},
    _find_problem,
)
"""All solvers by name. Those of installed packages take part only in searches that name them."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class InstalledSolver:
    """Solver of an installed package, of which only the routes count.

    What it reports as proven is ignored, as nothing could check that. If it fails, the search goes
    on without it.
    """

    inner: RouteSolver
    package: str

    @property
    def name(self) -> str:
        return self.inner.name

    def supports(self, problem: RouteProblem, /) -> bool:
        try:
            return self.inner.supports(problem)
        except Exception as error:  # another package may raise anything
            self._log_failure(error)
            return False

    def solve(self, search: Search, /) -> None:
        try:
            self.inner.solve(search.without_proofs())
        except Exception as error:  # another package may raise anything
            search.add_reason(self._log_failure(error))

    def _log_failure(self, error: Exception) -> str:
        message = Message(
            "the solver `{solver}` of {package} has failed ({name}: {error}); the search "
            "went on without it",
            solver=self.name,
            package=self.package,
            name=type(error).__name__,
            error=error,
        )
        _log.warning("%s", message)
        return message


def register_solver(solver: RouteSolver) -> None:
    """Register a solver: in this process it takes part in each search that it supports.

    Raises Conflict if there is a solver of that name already.
    """
    SOLVERS.register(solver.name, solver)


def discard_solver(name: str) -> None:
    """Remove a registered solver; no-op if there is none of that name."""
    SOLVERS.discard(name)


def all_solver_names() -> tuple[str, ...]:
    """Return the names of the solvers that take part by default: Argo's, then the registered."""
    groups = FIRST, SMALL, IMPROVING, PROVING, SOLVERS.registered()
    return tuple(solver.name for group in groups for solver in group)


def find_solver(name: str) -> RouteSolver:
    """Return a solver by its name.

    Raises NotFound if there is none, Unavailable if an installed package's can't be used.
    """
    package = SOLVERS.package_of(name)
    return SOLVERS[name] if package is None else InstalledSolver(SOLVERS[name], package)
