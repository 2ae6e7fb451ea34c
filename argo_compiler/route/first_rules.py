"""A first route, built step by step, always on to the best step by a simple rule."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.path_timing import PathTiming
from argo_compiler.route.problem import RouteProblem
from argo_compiler.route.pruning import horizon, shortest
from argo_compiler.route.search import Search

Vector = NDArray[np.int64]
Rule = Callable[[int, int], Vector]
"""from the node and the time that the robot is at, numbers of all nodes: the smaller, the better"""

_BEYOND = 0.1
"""s beyond the limit for a first route, so that there is one"""
_MOST_STANDS = 8
"""ways to have charged that are kept"""


class FirstRules:
    """Makes what must be made, and what that needs, by the first of some rules that gets through.
    What may be left out is left to those who improve the route."""

    name = "first rules"

    def supports(self, _problem: RouteProblem, /) -> bool:
        return True

    def solve(self, search: Search, /) -> None:
        network, m = search.network, search.network.size
        onward = shortest(network)[:, :m] + network.service
        latest = np.minimum(search.pruned.latest, horizon(network))
        earliest = network.earliest[network.step]
        rules: list[Rule] = [
            lambda at, _: onward[at],
            lambda at, now: np.maximum(now + onward[at], earliest),
            lambda at, now: np.maximum(now + onward[at], earliest) + latest // 4,
            lambda _at, _now: latest,
        ]
        follower = PathTiming(network)
        until = search.now() + search.left() + _BEYOND
        if not any(_built(search, follower, rule, until) for rule in rules):
            search.say("no simple rule leads to a first route")


def _built(search: Search, follower: PathTiming, rule: Rule, until: float) -> bool:
    """Offers the route that goes always on to the best node by the rule from which the end can be
    reached, and says whether there is one, and time for it."""
    network, pruned, m = search.network, search.pruned, search.network.size
    path: list[int] = []
    left = network.mandatory.copy()
    missing = pruned.needs.sum(axis=0)
    closed = np.zeros(len(left), np.int64)
    stands, at = follower.start(), m
    home = follower.go(stands, m, m, 0)
    while left.any():
        ready = (left & (missing == 0) & (closed == 0))[network.step] & pruned.arcs[at, :m]
        nodes = np.flatnonzero(ready)
        cost = rule(at, stands[0].time)[nodes]
        for node in nodes[np.argsort(cost, kind="stable")].tolist():
            if search.now() >= until:
                return False
            following = follower.go(stands, at, node, len(path))
            home = follower.go(following, node, m, len(path) + 1)
            if home:
                break
        else:
            return False
        if len(following) > _MOST_STANDS:  # the soonest, and that with the most left
            following = [*following[: _MOST_STANDS - 1], following[-1]]
        stands, at, s = following, node, network.step[node]
        path.append(node)
        left[s] = False
        missing -= pruned.needs[s]
        closed += pruned.before[:, s]
    if home:
        search.offer(path, dict(min(home, key=follower.cost).charges))
    return bool(home)
