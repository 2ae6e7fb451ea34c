"""One call for all route problems."""

import time

from argo_compiler.route import labels
from argo_compiler.route.circuit import solve_circuit
from argo_compiler.route.modes import Step
from argo_compiler.route.network import network
from argo_compiler.route.problem import RouteProblem
from argo_compiler.route.progress import Search
from argo_compiler.route.pruning import prune
from argo_compiler.route.subsets import applies, count_sets, solve_subsets
from argo_compiler.route.suggestion import RouteSuggestion


def suggest_route(
    problem: RouteProblem, time_limit: float = 5.0, seed: int = 0, workers: int = 1
) -> RouteSuggestion:
    """The best route that is found within the time limit (s), and what is known of it.

    Raises ArgoError if the time limit is not positive.
    """
    begun = time.perf_counter()

    def order_of(step: Step) -> tuple[Step, ...]:
        return tuple(step.parts)

    net = network(problem, order_of)
    search = Search(
        time.perf_counter, begun + time_limit, seed, workers, int(net.prize.sum()), begun=begun
    )
    pruned = prune(net)
    few = count_sets(net, pruned, 1_500_000) <= 1_500_000
    if few and applies(net):
        best = solve_subsets(net, pruned)
    elif few and labels.applies(net):
        best = labels.solve_labels(net, pruned, search)
    else:
        best = solve_circuit(net, pruned, search)
    route = None if best.path is None else net.route(best.path, dict(best.charges))
    made = set(() if route is None else route.order)
    dropped = tuple(v for v in range(problem.size) if v not in made)
    return RouteSuggestion(
        route,
        best.prize,
        best.prize_bound,
        best.cost,
        best.bound,
        best.proven,
        dropped if route else (),
        (),
        "CP-SAT",
        tuple(search.reasons),
        tuple(search.history),
    )
