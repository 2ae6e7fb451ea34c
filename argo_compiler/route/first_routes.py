"""Routes to begin with, before CP-SAT: by simple rules, local search and beams."""

from argo_compiler.route import guided_local_search, held_karp, labels, or_opt
from argo_compiler.route.network import StepNetwork
from argo_compiler.route.order_ideals import Bits
from argo_compiler.route.pruning import Pruned, longest
from argo_compiler.route.ruin_recreate import LocalSearch
from argo_compiler.route.search import Search
from argo_compiler.route.solution import Solution

_FIRST = 0.002
"""s for each step to improve the first route: what more would find, CP-SAT finds sooner"""
_EXCHANGING = 0.2
"""share of the time in which stretches are exchanged"""
_PREPARING = 0.45
"""share of the time for the others together"""
_ROUTING = 0.15
"""share of that for guided local search"""
_RUINING = 0.3
"""share of the rest for ruin and recreate"""
_MANY_STEPS = 24
"""from which on routing's local search is worth its start-up"""


def first_route(
    network: StepNetwork, pruned: Pruned, search: Search
) -> tuple[Solution | None, str]:
    """A first route by simple rules, and a little better."""
    local = LocalSearch(network, pruned, search.seed)
    path = local.first(lambda: search.left() <= 0.0)
    if path is None:
        search.say("no simple rule leads to a first route")
        return None, "CP-SAT"
    until = search.clock() + min(0.1 * search.left(), _FIRST * len(network.prize))
    return local.improve(path, search, until), "local search"


def is_ordered(network: StepNetwork, pruned: Pruned) -> bool:
    """Whether the steps can't come in any order."""
    return bool(network.windowed or pruned.before.any() or network.problem.battery is not None)


def prepare(
    network: StepNetwork, pruned: Pruned, search: Search, best: Solution | None, method: str
) -> tuple[Solution | None, str]:
    """A good route for CP-SAT to begin with, where order and windows make that hard for it."""
    if best is not None and or_opt.applies(network):
        search.say("stretches of the first route are exchanged")
        until = search.clock() + _EXCHANGING * search.left()
        return improve(network, pruned, search, until, best, method)
    with search.part(_PREPARING):
        if len(network.prize) >= _MANY_STEPS and guided_local_search.applies(network):
            search.say("guided local search improves the first route")
            until = search.clock() + _ROUTING * search.left()
            better = guided_local_search.solve_guided_local_search(
                network, pruned, search, until, best
            )
            if better is not None and better.better_than(best):
                best, method = better, "guided local search"
        if best is not None:
            until = search.clock() + _RUINING * search.left()
            best, method = improve(network, pruned, search, until, best, method)
        small = longest(network) < held_karp.INF and Bits(network, pruned).fits
        if small and not network.selective and labels.applies(network):
            search.say("beams of labels, with prices for what is still to come")
            some = labels.search_labels(network, pruned, search, best)
            search.known(bound=some.bound)
            if some.proven or some.better_than(best):
                best, method = some, "beams of labels"
    return best, method


def improve(
    network: StepNetwork, pruned: Pruned, search: Search, until: float, best: Solution, method: str
) -> tuple[Solution, str]:
    """The better of a route and what local search makes of it, until then on the search's clock."""
    more = LocalSearch(network, pruned, search.seed).improve(best.path or (), search, until)
    return (more, "local search") if more.better_than(best) else (best, method)
