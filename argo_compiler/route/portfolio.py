"""Which solver for which network: picked by structure, and said why."""

import threading
from typing import Any

from argo_compiler.route import labels, routing, subsets
from argo_compiler.route.circuit import solve_circuit
from argo_compiler.route.found import Found, found, none_found
from argo_compiler.route.local import LocalSearch
from argo_compiler.route.masks import Bits
from argo_compiler.route.network import Network
from argo_compiler.route.problem import Objective
from argo_compiler.route.progress import Search
from argo_compiler.route.pruning import Pruned, longest

_MOST_SETS = 1_500_000
_MOST_WORK = 24_000_000
"""sets times nodes that dynamic programming may go through"""
_FEW_SETS = 30_000
"""with which dynamic programming takes no time worth speaking of"""
_MOST_ARCS = 80_000
"""of a model for CP-SAT"""
_MANY_STEPS = 24
"""from which on routing's local search is worth its start-up"""


def solve(network: Network, pruned: Pruned, search: Search) -> tuple[Found, str]:
    """The best path found until the deadline, and the solver that it comes from."""
    steps = int(pruned.steps.sum())
    most = min(_MOST_SETS, _MOST_WORK // max(1, network.size))
    sets = subsets.count_sets(network, pruned, most)
    if not _ordered(network, pruned) and sets > _FEW_SETS:
        search.say(f"{steps} steps in any order: CP-SAT proves those fastest")
        return _searched(network, pruned, search)
    # Windows may leave much fewer sets than the order does.
    small = longest(network) < subsets.INF
    if small and (sets <= most or network.windowed) and Bits(network, pruned).fits:
        with search.part(0.7):
            layers = subsets.soonest_layers(network, pruned, most, lambda: search.left() <= 0.0)
        if layers is not None:
            return _all_sets(network, pruned, search, layers)
    search.say(f"{steps} steps allow more than {most} sets, or have too much to reckon with")
    return _searched(network, pruned, search)


def _all_sets(
    network: Network, pruned: Pruned, search: Search, layers: list[subsets.Layer]
) -> tuple[Found, str]:
    """Dynamic programming over the sets of the layers."""
    count = 1 + sum(len(layer.masks) for layer in layers)
    reason = f"order and time allow {count} sets of {int(pruned.steps.sum())} steps"
    if subsets.applies(network):
        search.say(f"{reason}: all are gone through")
        best = subsets.solve_subsets(network, pruned, layers)
        if best.path is not None:
            search.route(best.prize, best.cost)
        return best, "dynamic programming over sets"
    if labels.applies(network):
        search.say(f"{reason}: gone through with time and {_second(network)}")
        best = labels.solve_labels(network, pruned, search, layers)
        return best, "dynamic programming with labels"
    return _searched(network, pruned, search)


def _second(network: Network) -> str:
    return "travel" if network.problem.battery is None else "energy"


def _searched(network: Network, pruned: Pruned, search: Search) -> tuple[Found, str]:
    """A first route, better ones by what fits the network, and CP-SAT; local search for the rest of
    the time."""
    best, method = _first(network, pruned, search)
    if int(pruned.arcs.sum()) > _MOST_ARCS:
        search.say(f"{len(network.prize)} steps are too many for CP-SAT: guided local search")
        return _improved(network, pruned, search, best, method)
    if search.workers > 1:
        search.say("CP-SAT from nothing, and beside it from the best route of other searches")
        best, method, exact = _raced(network, pruned, search, best, method)
    elif not _ordered(network, pruned):
        exact = solve_circuit(network, pruned, search, best, hinted=False)
    else:
        with search.part(0.4):
            best, method = _prepared(network, pruned, search, best, method)
        if best is not None and best.proven:
            return best, method
        exact = solve_circuit(network, pruned, search, best)
    if exact.better_than(best) or best is None:
        best, method = exact, "CP-SAT"
    if best.path is None or exact.proven:
        return exact, "CP-SAT"
    best = _bounded(network, search, best, exact)
    if not best.proven and search.left() > 0.05:
        local = LocalSearch(network, pruned, search.seed)
        more = local.improve(best.path or (), search, search.deadline)
        if more.better_than(best):
            best, method = _bounded(network, search, more, exact), "local search"
    return best, method


def _ordered(network: Network, pruned: Pruned) -> bool:
    """Whether the steps can't come in any order."""
    return bool(network.windowed or pruned.before.any() or network.problem.battery is not None)


def _routed(network: Network) -> bool:
    """Whether routing's local search is of use, and worth its start-up."""
    return len(network.prize) >= _MANY_STEPS and routing.applies(network)


def _prepared(
    network: Network, pruned: Pruned, search: Search, best: Found | None, method: str
) -> tuple[Found | None, str]:
    """A good route for CP-SAT to begin with, where order and windows make that hard for it."""
    if _routed(network):
        search.say("guided local search improves the first route")
        until = search.clock() + 0.15 * search.left()
        better = routing.solve_routing(network, pruned, search, until, best)
        if better is not None and better.better_than(best):
            best, method = better, "guided local search"
    small = longest(network) < subsets.INF and Bits(network, pruned).fits
    if small and not network.selective and labels.applies(network):
        search.say("beams of labels, with prices for what is still to come")
        some = labels.search_labels(network, pruned, search, best)
        search.known(bound=some.bound)
        if some.proven or some.better_than(best):
            best, method = some, "beams of labels"
    return best, method


def _improved(
    network: Network, pruned: Pruned, search: Search, best: Found | None, method: str
) -> tuple[Found, str]:
    """Local search until the deadline."""
    if routing.applies(network):
        # From nothing, the library finds a better first route than by the nearest.
        start = best if _ordered(network, pruned) or network.selective else None
        better = routing.solve_routing(network, pruned, search, search.deadline, start)
        if better is not None and better.better_than(best):
            best, method = better, "guided local search"
    if best is None:
        return none_found(network, proven=False, bound=search.bound), method
    left = LocalSearch(network, pruned, search.seed)
    more = left.improve(best.path or (), search, search.deadline)
    if more.better_than(best):
        best, method = more, "local search"
    return _bounded(network, search, best, none_found(network, proven=False)), method


def _first(network: Network, pruned: Pruned, search: Search) -> tuple[Found | None, str]:
    """A first route by simple rules, and a little better."""
    local = LocalSearch(network, pruned, search.seed)
    path = local.first(lambda: search.left() <= 0.0)
    if path is None:
        search.say("no simple rule leads to a first route")
        return None, "CP-SAT"
    until = search.clock() + min(0.1 * search.left(), 0.02 * len(network.prize))
    return local.improve(path, search, until), "local search"


def _bounded(network: Network, search: Search, best: Found, exact: Found) -> Found:
    """A path with all bounds that are known."""
    bound = exact.bound
    if not network.selective and network.objective is not Objective.PRIZE:
        bound = max(bound, min(search.bound, best.cost))
    return found(network, best.path or (), best.charges, exact.prize_bound, bound)


def _raced(
    network: Network, pruned: Pruned, search: Search, best: Found | None, method: str
) -> tuple[Found | None, str, Found]:
    """CP-SAT from nothing on one core; on another CP-SAT with what is known, and before that, where
    the order is tight, local search and beams. The first that proves something ends the other."""
    running: list[Any] = []
    results: list[Found] = []
    failures: list[BaseException] = []
    whole, alone = search.deadline, search.alone()

    def prove() -> None:
        try:
            results.append(solve_circuit(network, pruned, alone, running=running))
        except BaseException as error:
            failures.append(error)
        else:
            if results[0].proven:
                search.deadline = search.clock()
                for solver in running:
                    solver.stop_search()

    thread = threading.Thread(target=prove)
    thread.start()
    ordered = _ordered(network, pruned)
    if ordered:
        search.deadline = min(search.deadline, search.clock() + 0.5 * search.left())
        best, method = _prepared(network, pruned, search, best, method)
    exact = best if best is not None and best.proven else None
    if exact is None and not (results and results[0].proven):
        search.deadline = whole
        exact = solve_circuit(network, pruned, search, best, hinted=ordered, running=running)
    if exact is not None and exact.proven:
        for solver in running:
            solver.stop_search()
    thread.join()
    search.deadline = whole
    if failures:
        raise failures[0]
    (other,) = results
    return best, method, _both(network, search, exact, other)


def _both(network: Network, search: Search, one: Found | None, other: Found) -> Found:
    """The better path of two searches, with the better bounds of both."""
    if one is None or other.proven:
        return other
    if one.proven:
        return one
    best = other if other.better_than(one) else one
    if best.path is None:
        return none_found(network, proven=False, bound=max(one.bound, other.bound))
    search.route(best.prize, best.cost)
    prize_bound = min(one.prize_bound, other.prize_bound)
    search.known(prize_bound, max(one.bound, other.bound))
    return found(network, best.path, best.charges, prize_bound, max(one.bound, other.bound))
