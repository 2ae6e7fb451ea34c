"""One call for all route problems."""

from argo_compiler.errors import ArgoError
from argo_compiler.route.problem import RouteProblem
from argo_compiler.route.suggestion import RouteSuggestion


def suggest_route(
    problem: RouteProblem,
    time_limit: float = 5.0,
    seed: int = 0,
    workers: int = 1,
    explain: bool = True,
) -> RouteSuggestion:
    """The best route that is found within the time limit (s), and what is known of it. Where there
    is none, what can't all be met is looked for after that time as well, unless nothing is to be
    explained.

    What is proven does not depend on the seed; the route may, where others are as good or the time
    is over. Raises ArgoError if the time limit or the number of workers is not positive.
    """
    if not time_limit > 0.0 or workers < 1:
        raise ArgoError(
            f"a route needs time and a worker to be looked for, not {time_limit:g} s and {workers}"
        )
    # OR-Tools takes a second to be imported, and most who import this package don't search.
    from argo_compiler.route.solving import find_route

    return find_route(problem, time_limit, seed, workers, explain=explain)
