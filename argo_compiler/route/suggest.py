"""One call for all route problems."""

from argo_compiler.route.problem import RouteProblem
from argo_compiler.route.suggestion import RouteSuggestion


def suggest_route(
    problem: RouteProblem, time_limit: float = 5.0, seed: int = 0, workers: int = 1
) -> RouteSuggestion:
    """The best route that is found within the time limit (s), and what is known of it.

    Raises ArgoError if the time limit is not positive.
    """
    raise NotImplementedError
