"""Function that searches for the best route of any problem."""

import logging
import time
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from argo_compiler.base.errors import Invalid
from argo_compiler.base.message import Message
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
    """Search for the best route within the limits.

    The result of a proof does not depend on the seed; the route may, if others are as good or the
    time ends first. Exceptions of the criterion and of the callbacks are passed on.

    Args:
        problem: The visits, travel times and constraints.
        time_limit: Limit of time in s, or None.
        seed: Seed of all random choices.
        workers: If above 1, solvers that improve routes and solvers that prove run in parallel;
            with a limit of work they run one after the other in any case.
        explain: If there is no route, and time remains, search for requirements that cannot all be
            met.
        work_limit: Limit of work in nominal s, by the solvers' own count, on one core for any
            number of workers; or None. With it, and without a time limit, the result is the same
            each time, also on a busy machine.
        stop: Criterion that ends the search early, see `argo_compiler.route.stop`.
        on_best: Callback for each better route. It is called from any thread and must be quick.
        on_bound: Callback for each better bound. It is called from any thread and must be quick.
        solvers: The only solvers that take part, as names or objects; None: all.
        clock: Clock in s, from any start.

    Raises:
        Invalid: if a limit or the number of workers is not positive, or there is no limit.
        NotFound: if there is no solver of a name.
    """
    limits = [limit for limit in (time_limit, work_limit) if limit is not None]
    if not limits or not all(limit > 0.0 for limit in limits) or workers < 1:
        raise Invalid(
            Message(
                "the search for a route needs a limit of time or work above 0, and a "
                "worker, not {time_limit} s, work {work_limit} and {workers} workers",
                time_limit=time_limit,
                work_limit=work_limit,
                workers=workers,
            )
        )
    # OR-Tools takes a second to import, and most users of this package do not search.
    from argo_compiler.route.find_route import find_route
    from argo_compiler.route.search import Observers, SearchLimits

    suggestion = find_route(
        problem,
        SearchLimits(time_limit, work_limit, stop),
        seed,
        workers,
        clock,
        explain=explain,
        observers=Observers(on_best, on_bound),
        solvers=solvers,
    )
    for reason in suggestion.reasons:
        _log.debug("%s", reason)
    _log.info(
        "%d visits: %s by %s",
        problem.size,
        Message("proven that there is no route")
        if suggestion.infeasible
        else Message("no route found")
        if suggestion.route is None
        else Message("proven")
        if suggestion.proven
        else Message("not proven"),
        suggestion.method or Message("no search"),
    )
    return suggestion
