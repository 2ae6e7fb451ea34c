"""Portfolio of solvers: quick ones first, then improving and proving ones in turn or parallel."""

import threading
from collections.abc import Callable, Sequence

from argo_compiler.route.ruin_recreate import RuinRecreate
from argo_compiler.route.search import Search
from argo_compiler.route.solvers import (
    FIRST,
    IMPROVING,
    PROVING,
    SMALL,
    SOLVERS,
    RouteSolver,
    find_solver,
)

_FIRST_IMPROVING_SHARE = 0.35
"""share of the time for better routes before the proofs start, with one worker"""
_FIRST_TIME_PER_STEP, _FIRST_TIME_PER_EASY_STEP = 0.05, 0.003
"""upper limits of that time, in s per step: in general, and where a proof needs no good route"""
_PROVING_SHARE = 0.7
"""share of the remaining time for proofs; the rest is again for better routes"""


def solve(search: Search, workers: int, chosen: Sequence[str | RouteSolver] | None = None) -> None:
    """Search until the best route is proven or the time has passed.

    `chosen`: the only solvers that take part, as names or objects; None: all of Argo and all that
    are registered. Raises NotFound or Unavailable if there is no usable solver of a name.
    """
    own: list[RouteSolver] = [*FIRST, *SMALL, *IMPROVING, *PROVING]
    wanted = [
        find_solver(solver) if isinstance(solver, str) else solver
        for solver in ([*own, *SOLVERS.registered()] if chosen is None else chosen)
    ]

    def usable(group: Sequence[RouteSolver]) -> list[RouteSolver]:
        return [s for s in group if s in wanted and s.supports(search.problem)]

    for solver in [*usable(FIRST), *usable(SMALL)]:
        _run(solver, search)
    custom = usable([solver for solver in wanted if solver not in own])
    improving = [*custom, *_ranked(search, usable(IMPROVING))]
    proving = usable(PROVING)
    if workers > 1 and search.timed and improving and proving:
        _run_in_parallel(
            search,
            lambda: _run_in_turn(search, improving),
            lambda: _run_in_turn(search, proving),
        )
        return
    network = search.network
    is_easy = network.has_additive_times and not (network.selective or search.pruned.before.any())
    most = (_FIRST_TIME_PER_EASY_STEP if is_easy else _FIRST_TIME_PER_STEP) * len(network.prize)
    _run_in_turn(
        search.with_time_share(_FIRST_IMPROVING_SHARE, most) if proving else search, improving
    )
    _run_in_turn(search.with_time_share(_PROVING_SHARE if improving else 1.0), proving)
    _run_in_turn(search, improving)


def _ranked(search: Search, solvers: list[RouteSolver]) -> list[RouteSolver]:
    """Return the local searches that suit the problem, in the order in which they run.

    Ruin and recreate is used only if no other local search supports the problem.
    """
    suited = [solver for solver in solvers if not isinstance(solver, RuinRecreate)] or solvers
    prefers_pyvrp = search.network.selective or search.network.has_windows
    # Without prizes and windows, PyVRP does not find all that the exchange search finds.
    return suited if prefers_pyvrp else suited[::-1]


def _run_in_turn(search: Search, solvers: Sequence[RouteSolver]) -> None:
    """Run the solvers one after the other, each with an equal share of the remaining time."""
    for number, solver in enumerate(solvers):
        _run(solver, search.with_time_share(1.0 / (len(solvers) - number)))


def _run(solver: RouteSolver, search: Search) -> None:
    if search.remaining_time() > 0.0:
        with search.turn_of(solver.name) as turn:
            solver.solve(turn)


def _run_in_parallel(
    search: Search, foreground: Callable[[], object], background: Callable[[], object]
) -> None:
    """Run two functions at the same time, the second one in a thread.

    An exception of either stops the search for both, and is raised.
    """
    failure: list[BaseException] = []

    def run() -> None:
        try:
            background()
        except BaseException as error:
            failure.append(error)
            search.stop()

    thread = threading.Thread(target=run)
    thread.start()
    try:
        foreground()
        thread.join()
    except BaseException:
        search.stop()
        thread.join()
        raise
    if failure:
        raise failure[0]
