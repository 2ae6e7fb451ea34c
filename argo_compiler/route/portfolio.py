"""Which solver for which network: picked by structure, and said why."""

import threading

from argo_compiler.route import labels, routing, subsets
from argo_compiler.route.circuit import solve_circuit
from argo_compiler.route.found import Found, found, none_found
from argo_compiler.route.local import LocalSearch
from argo_compiler.route.masks import Bits
from argo_compiler.route.network import Network
from argo_compiler.route.problem import Objective
from argo_compiler.route.progress import Search
from argo_compiler.route.pruning import Pruned

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
    plain = not (network.windowed or pruned.before.any() or network.problem.battery is not None)
    if plain and sets > _FEW_SETS:
        search.say(f"{steps} steps in any order: CP-SAT proves those fastest")
        return _searched(network, pruned, search)
    # Windows may leave much fewer sets than the order does.
    if (sets <= most or network.windowed) and Bits(network, pruned).fits:
        layers = subsets.soonest_layers(network, pruned, most)
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
    """Local search for a start, then CP-SAT, with more local search beside it if there is a second
    worker; for what is too large for CP-SAT, local search alone."""
    best, method = _first(network, pruned, search)
    large = int(pruned.arcs.sum()) > _MOST_ARCS
    many = len(network.prize) >= _MANY_STEPS and routing.applies(network)
    if many:
        share = 1.0 if large else 0.06
        search.say("routing's guided local search improves the first route")
        better = routing.solve_routing(
            network, pruned, search, search.clock() + share * search.left(), best
        )
        if better is not None and better.better_than(best):
            best, method = better, "guided local search"
    if large:
        search.say(f"{len(network.prize)} steps are too many for CP-SAT")
        if best is None:
            return none_found(network, proven=False, bound=search.bound), method
        return _closed(network, search, best), method
    ordered = network.windowed or pruned.before.any() or network.problem.battery is not None
    if ordered and not network.selective and Bits(network, pruned).fits:
        search.say("beams of labels with prices for what is still to come")
        with search.part(0.5):
            some = labels.search_labels(network, pruned, search, best)
        if some.proven:
            return some, "dynamic programming with prices"
        if some.better_than(best):
            best, method = some, "beams of labels"
        search.known(bound=some.bound)
    if search.workers > 1 and many:
        exact, beside = _side_by_side(network, pruned, search, best)
    else:
        exact, beside = solve_circuit(network, pruned, search, best), None
    if beside is not None and beside.better_than(exact):
        prize_bound, bound = exact.prize_bound, exact.bound
        better = found(network, beside.path or (), beside.charges, prize_bound, bound)
        return _closed(network, search, better), "guided local search"
    if exact.better_than(best) or exact.proven or exact.path is None:
        method = "CP-SAT" if exact.better_than(best) or best is None else method
    if exact.path is not None and not exact.proven and search.left() > 0.05:
        more = LocalSearch(network, pruned, search.seed).improve(
            exact.path, search, search.deadline
        )
        if more.better_than(exact):
            exact = found(network, more.path or (), more.charges, exact.prize_bound, exact.bound)
            method = "local search"
    return _closed(network, search, exact), method


def _first(network: Network, pruned: Pruned, search: Search) -> tuple[Found | None, str]:
    """A first route by simple rules, and a little better."""
    local = LocalSearch(network, pruned, search.seed)
    path = local.first(lambda: search.left() <= 0.0)
    if path is None:
        search.say("no simple rule leads to a first route")
        return None, "CP-SAT"
    until = search.clock() + min(0.1 * search.left(), 0.02 * len(network.prize))
    return local.improve(path, search, until), "local search"


def _closed(network: Network, search: Search, best: Found) -> Found:
    """With the bounds that the search knows from elsewhere."""
    if best.path is None or network.selective or network.objective is Objective.PRIZE:
        return best
    bound = max(best.bound, min(search.bound, best.cost))
    return found(network, best.path, best.charges, best.prize_bound, bound)


def _side_by_side(
    network: Network, pruned: Pruned, search: Search, best: Found | None
) -> tuple[Found, Found | None]:
    """CP-SAT with one worker less, and guided local search at the same time."""
    results: list[Found] = []
    failures: list[BaseException] = []

    def prove() -> None:
        try:
            results.append(solve_circuit(network, pruned, search.alone(), best))
        except BaseException as error:
            failures.append(error)

    thread = threading.Thread(target=prove)
    thread.start()
    beside, span = best, 0.5
    # The library can't be stopped from outside: it is run for longer and longer spans.
    while thread.is_alive() and search.left() > 0.0:
        until = min(search.deadline, search.clock() + span)
        beside = routing.solve_routing(network, pruned, search, until, beside)
        span = min(2 * span, 4.0)
        thread.join(0.01)
    thread.join()
    if failures:
        raise failures[0]
    (exact,) = results
    if exact.path is not None:
        search.route(exact.prize, exact.cost)
    search.known(exact.prize_bound, exact.bound)
    return exact, beside
