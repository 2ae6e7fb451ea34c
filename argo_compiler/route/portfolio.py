"""Which solver takes part when: quick ones first, then those that improve and those that prove."""

import threading
from collections.abc import Callable, Sequence

from argo_compiler.base.errors import NotFound
from argo_compiler.base.nearest_name import nearest_name
from argo_compiler.route.ruin_recreate import RuinRecreate
from argo_compiler.route.search import Search
from argo_compiler.route.solvers import (
    FIRST,
    IMPROVING,
    PROVING,
    SMALL,
    RouteSolver,
    registered_solvers,
    solver_names,
)

_IMPROVED_FIRST = 0.35
"""share of the time for better routes before proofs are tried, where there is one worker"""
_FIRST_MOST, _FIRST_BRIEF = 0.05, 0.003
"""s for each step that this is at most; and where a proof needs no good route"""
_PROVED = 0.7
"""share of the rest for proofs; what is left is for better routes again"""


def solve(search: Search, workers: int, chosen: Sequence[str | RouteSolver] | None = None) -> None:
    """Searches until the best route is proven or the time is over. `chosen`: the only solvers that
    take part, by name or one's own; None: all.

    Raises NotFound for a name that no solver has.
    """
    own = [solver for solver in chosen or () if not isinstance(solver, str)]
    names = [solver for solver in chosen or () if isinstance(solver, str)]
    for name in names:
        if name not in solver_names():
            near = nearest_name(name, solver_names())
            instead = (
                f"did you mean {near!r}?" if near else f"there are {', '.join(solver_names())}"
            )
            raise NotFound(f"no route solver is named {name!r}; {instead}")

    def those(group: Sequence[RouteSolver]) -> list[RouteSolver]:
        wanted = [one for one in group if chosen is None or one.name in names]
        return [one for one in wanted if one.supports(search.problem)]

    for solver in [*those(FIRST), *those(SMALL)]:
        _run(solver, search)
    mine = [one for one in own if one.supports(search.problem)]
    improving = [*mine, *those(registered_solvers()), *_best_of(search, those(IMPROVING))]
    proving = those(PROVING)
    if workers > 1 and search.timed and improving and proving:
        _beside(
            search,
            lambda: _in_turn(search, improving),
            lambda: _in_turn(search, proving),
        )
        return
    network = search.network
    brief = network.plain and not (network.selective or search.pruned.before.any())
    most = (_FIRST_BRIEF if brief else _FIRST_MOST) * len(network.prize)
    _in_turn(search.part(_IMPROVED_FIRST, most) if proving else search, improving)
    _in_turn(search.part(_PROVED if improving else 1.0), proving)
    _in_turn(search, improving)


def _best_of(search: Search, solvers: list[RouteSolver]) -> list[RouteSolver]:
    """Those of the local searches that find the best routes of such a problem, in their order."""
    kept = [one for one in solvers if not isinstance(one, RuinRecreate)] or solvers
    waits = search.network.selective or search.network.windowed
    # Without prizes and windows, PyVRP does not find what exchanges find.
    return kept if waits else kept[::-1]


def _in_turn(search: Search, solvers: Sequence[RouteSolver]) -> None:
    """Each solver has an equal part of the time that is left."""
    for number, solver in enumerate(solvers):
        _run(solver, search.part(1.0 / (len(solvers) - number)))


def _run(solver: RouteSolver, search: Search) -> None:
    if search.left() > 0.0:
        with search.by(solver.name) as turn:
            solver.solve(turn)


def _beside(search: Search, here: Callable[[], object], there: Callable[[], object]) -> None:
    """Both at the same time. What goes wrong in either ends both, and is raised."""
    failure: list[BaseException] = []

    def run() -> None:
        try:
            there()
        except BaseException as error:
            failure.append(error)
            search.stop()

    thread = threading.Thread(target=run)
    thread.start()
    try:
        here()
        thread.join()
    except BaseException:
        search.stop()
        thread.join()
        raise
    if failure:
        raise failure[0]
