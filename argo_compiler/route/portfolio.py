"""Portfolio of solvers: quick ones first, then improving and proving ones in turn or parallel."""

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
    all_solver_names,
    registered_solvers,
)

_FIRST_IMPROVING_SHARE = 0.35
"""share of the time for better routes before the proofs start, with one worker"""
_FIRST_TIME_PER_STEP, _FIRST_TIME_PER_EASY_STEP = 0.05, 0.003
"""upper limits of that time, in s per step: in general, and where a proof needs no good route"""
_PROVING_SHARE = 0.7
"""share of the remaining time for proofs; the rest is again for better routes"""


def solve(search: Search, workers: int, chosen: Sequence[str | RouteSolver] | None = None) -> None:
    """Search until the best route is proven or the time has passed.

    `chosen`: the only solvers that take part, as names or objects; None: all. Raises NotFound if no
    solver has a name.
    """
    objects = [solver for solver in chosen or () if not isinstance(solver, str)]
    names = [solver for solver in chosen or () if isinstance(solver, str)]
    for name in names:
        if name not in all_solver_names():
            near = nearest_name(name, all_solver_names())
            remedy = (
                f"did you mean {near!r}?" if near else f"there are {', '.join(all_solver_names())}"
            )
            raise NotFound(f"no route solver is named {name!r}; {remedy}")

    def usable(group: Sequence[RouteSolver]) -> list[RouteSolver]:
        wanted = [solver for solver in group if chosen is None or solver.name in names]
        return [solver for solver in wanted if solver.supports(search.problem)]

    for solver in [*usable(FIRST), *usable(SMALL)]:
        _run(solver, search)
    custom = [solver for solver in objects if solver.supports(search.problem)]
    improving = [*custom, *usable(registered_solvers()), *_ranked(search, usable(IMPROVING))]
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
