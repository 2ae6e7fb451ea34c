"""Which solver for which network: picked by structure, and said why."""

from argo_compiler.route import guided_local_search, held_karp, labels
from argo_compiler.route.cp_sat import solve_cp_sat
from argo_compiler.route.first_routes import first_route, improve, is_ordered, prepare
from argo_compiler.route.network import StepNetwork
from argo_compiler.route.order_ideals import Bits
from argo_compiler.route.parallel_search import raced
from argo_compiler.route.problem import Objective
from argo_compiler.route.pruning import Pruned, longest
from argo_compiler.route.search import Search
from argo_compiler.route.solution import Solution, make_solution, no_solution

_MOST_SETS = 1_500_000
_MOST_WORK = 24_000_000
"""sets times nodes that dynamic programming may go through"""
_FEW_SETS = 30_000
"""with which dynamic programming takes no time worth speaking of"""
_MOST_ARCS = 80_000
"""of a model for CP-SAT"""


def solve(network: StepNetwork, pruned: Pruned, search: Search) -> tuple[Solution, str]:
    """The best path found until the deadline, and the solver that it comes from."""
    steps = int(pruned.steps.sum())
    most = min(_MOST_SETS, _MOST_WORK // max(1, network.size))
    sets = held_karp.count_sets(network, pruned, most)
    if not is_ordered(network, pruned) and sets > _FEW_SETS:
        search.say(f"{steps} steps in any order: CP-SAT proves those fastest")
        return _searched(network, pruned, search)
    # Windows may leave much fewer sets than the order does.
    small = longest(network) < held_karp.INF
    if small and (sets <= most or network.windowed) and Bits(network, pruned).fits:
        with search.part(0.7):
            layers = held_karp.soonest_layers(network, pruned, most, lambda: search.left() <= 0.0)
            in_time = search.left() > 0.0
        if layers is not None:
            return _all_sets(network, pruned, search, layers)
        if not in_time:
            search.say(f"there was no time to go through all sets of {steps} steps")
            return _searched(network, pruned, search)
    search.say(f"{steps} steps allow more than {most} sets, or have too much to reckon with")
    return _searched(network, pruned, search)


def _all_sets(
    network: StepNetwork, pruned: Pruned, search: Search, layers: list[held_karp.Layer]
) -> tuple[Solution, str]:
    """Dynamic programming over the sets of the layers."""
    count = 1 + sum(len(layer.masks) for layer in layers)
    reason = f"order and time allow {count} sets of {int(pruned.steps.sum())} steps"
    if held_karp.applies(network):
        search.say(f"{reason}: all are gone through")
        best = held_karp.solve_held_karp(network, pruned, layers)
        if best.path is not None:
            search.route(best.prize, best.cost)
        return best, "dynamic programming over sets"
    if labels.applies(network):
        search.say(f"{reason}: gone through with time and {_second(network)}")
        best = labels.solve_labels(network, pruned, search, layers)
        return best, "dynamic programming with labels"
    return _searched(network, pruned, search)


def _second(network: StepNetwork) -> str:
    return "travel" if network.problem.battery is None else "energy"


def _searched(network: StepNetwork, pruned: Pruned, search: Search) -> tuple[Solution, str]:
    """A first route, better ones by what fits the network, and CP-SAT; local search for the rest of
    the time."""
    best, method = first_route(network, pruned, search)
    if int(pruned.arcs.sum()) > _MOST_ARCS:
        search.say(f"{len(network.prize)} steps are too many for CP-SAT: guided local search")
        return _improved(network, pruned, search, best, method)
    if search.workers > 1:
        search.say("CP-SAT from nothing, and beside it from the best route of other searches")
        best, method, exact = raced(network, pruned, search, best, method)
    elif not is_ordered(network, pruned):
        exact = solve_cp_sat(network, pruned, search, best, hinted=False)
    else:
        best, method = prepare(network, pruned, search, best, method)
        if best is not None and best.proven:
            return best, method
        exact = solve_cp_sat(network, pruned, search, best, timed=True)
    if exact is not best and (best is None or exact.proven or exact.better_than(best)):
        best, method = exact, "CP-SAT"
    if best.path is None or best.proven:
        return best, method
    best = _bounded(network, search, best, exact)
    if not best.proven and search.left() > 0.05:
        more, method = improve(network, pruned, search, search.deadline, best, method)
        best = _bounded(network, search, more, exact)
    return best, method


def _improved(
    network: StepNetwork, pruned: Pruned, search: Search, best: Solution | None, method: str
) -> tuple[Solution, str]:
    """Local search until the deadline."""
    if guided_local_search.applies(network):
        # From nothing, the library finds a better first route than by the nearest.
        start = best if is_ordered(network, pruned) or network.selective else None
        better = guided_local_search.solve_guided_local_search(
            network, pruned, search, search.deadline, start
        )
        if better is not None and better.better_than(best):
            best, method = better, "guided local search"
    if best is None:
        return no_solution(network, proven=False, bound=search.bound), method
    best, method = improve(network, pruned, search, search.deadline, best, method)
    return _bounded(network, search, best, no_solution(network, proven=False)), method


def _bounded(network: StepNetwork, search: Search, best: Solution, exact: Solution) -> Solution:
    """A path with all bounds that are known."""
    bound = exact.bound
    if not network.selective and network.objective is not Objective.PRIZE:
        bound = max(bound, min(search.bound, best.cost))
    return make_solution(network, best.path or (), best.charges, exact.prize_bound, bound)
