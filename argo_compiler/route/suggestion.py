"""One call for all route problems."""

import logging
import time
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from argo_compiler.base.errors import Invalid
from argo_compiler.route.problem import RouteProblem, Tour
from argo_compiler.route.stop import SearchProgress, StopCriterion
from argo_compiler.route.suggested import RouteSuggestion

if TYPE_CHECKING:
    from argo_compiler.route.solvers import RouteSolver

_log = logging.getLogger(__name__)


def suggest_route(
    problem: RouteProblem,
    time_limit: float | None = 5.0,
    seed: int = 0,
    workers: int = 1,
    explain: bool = True,
    *,
    work_limit: float | None = None,
    stop: StopCriterion | None = None,
    on_best: Callable[[SearchProgress, Tour], None] | None = None,
    on_bound: Callable[[SearchProgress], None] | None = None,
    solvers: "Sequence[str | RouteSolver] | None" = None,
    clock: Callable[[], float] = time.perf_counter,
) -> RouteSuggestion:
    """The best route that is found within the limits, and what is known of it. Where there is none,
    and there is time left, what can't all be met is looked for, unless nothing is to be explained.

    `time_limit`: s. `work_limit`: s that the solvers may work by their own count, on one core
    however many workers there are; with it, and without a time limit, the result is the same each
    time, also on a busy machine. `stop`: see `argo_compiler.route.stop`. `on_best` and `on_bound`
    are called when a better route, or a better bound, is known; from any thread, so quickly.
    `solvers`: the only ones that take part, by their names or as objects.

    What is proven does not depend on the seed; the route may, where others are as good or the time
    is over. Raises Invalid if a limit or the number of workers is not positive, or there is no
    limit, NotFound for an unknown solver, and whatever the criterion and the observers raise.
    """
    given = [limit for limit in (time_limit, work_limit) if limit is not None]
    if not given or not all(limit > 0.0 for limit in given) or workers < 1:
        raise Invalid(
            "a route needs time (or work) and a worker to be looked for, not "
            f"{time_limit} s ({work_limit}) and {workers}"
        )
    # OR-Tools takes a second to be imported, and most who import this package don't search.
    from argo_compiler.route.find_route import find_route
    from argo_compiler.route.search import Observers, SearchLimits

    found = find_route(
        problem,
        SearchLimits(time_limit, work_limit, stop),
        seed,
        workers,
        clock,
        explain=explain,
        observers=Observers(on_best, on_bound),
        solvers=solvers,
    )
    for reason in found.reasons:
        _log.debug("%s", reason)
    _log.info(
        "%d visits: %s by %s",
        problem.size,
        "no route" if found.route is None else "proven" if found.proven else "not proven",
        found.method or "no search",
    )
    return found
