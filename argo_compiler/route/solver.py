"""The protocol of solvers, and the registry of one's own. Argo's are listed in `portfolio.py`."""

from typing import Protocol

from argo_compiler.base.errors import Conflict
from argo_compiler.route.problem import RouteProblem
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
