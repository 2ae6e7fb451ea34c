"""Solver that builds a first route greedily: a simple rule chooses each next step."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.path_timing import PathTiming
from argo_compiler.route.problem import RouteProblem
from argo_compiler.route.pruning import horizon, least_arc_times_without_service
from argo_compiler.route.search import Search

Vector = NDArray[np.int64]
Rule = Callable[[int, int], Vector]
"""function of the robot's node and time: a cost for each node, of which the lowest comes next"""

_OVERTIME = 0.1
"""s beyond the limit, so that there is a first route"""
_MOST_LABELS = 8
"""highest number of labels, with different charges, at a node"""


class FirstRules:
    """Solver that makes the mandatory steps, and those they need, by the first rule that succeeds.

    Optional steps are left to the solvers that improve the route.
    """

    name = "first rules"

    def supports(self, _problem: RouteProblem, /) -> bool:
        return True

    def solve(self, search: Search, /) -> None:
        network, m = search.network, search.network.node_count
        onward = least_arc_times_without_service(network)[:, :m] + network.service
        latest = np.minimum(search.pruned.latest, horizon(network))
        earliest = network.earliest[network.step]
        rules: list[Rule] = [
            lambda at, _: onward[at],
            lambda at, now: np.maximum(now + onward[at], earliest),
            lambda at, now: np.maximum(now + onward[at], earliest) + latest // 4,
            lambda _at, _now: latest,
        ]
        timing = PathTiming(network)
        until = search.elapsed_time() + search.remaining_time() + _OVERTIME
        if not any(_build(search, timing, rule, until) for rule in rules):
            search.add_reason("no simple rule leads to a first route")


def _build(search: Search, timing: PathTiming, rule: Rule, until: float) -> bool:
    """Build a route by a rule, offer it, and return whether there is one.

    The next node is always the one that the rule prefers among those from which the end can be
    reached. The route is given up if there is no such node, or when
    `search.elapsed_time()` is `until`.
    """
    network, pruned, m = search.network, search.pruned, search.network.node_count
    path: list[int] = []
    remaining = network.mandatory.copy()
    missing = pruned.needs.sum(axis=0)
    closed = np.zeros(len(remaining), np.int64)
    labels, at = timing.start_labels(), m
    end_labels = timing.extend(labels, m, m, 0)
    while remaining.any():
        ready = (remaining & (missing == 0) & (closed == 0))[network.step] & pruned.arcs[at, :m]
        nodes = np.flatnonzero(ready)
        cost = rule(at, labels[0].time)[nodes]
        for node in nodes[np.argsort(cost, kind="stable")].tolist():
            if search.elapsed_time() >= until:
                return False
            following = timing.extend(labels, at, node, len(path))
            end_labels = timing.extend(following, node, m, len(path) + 1)
            if end_labels:
                break
        else:
            return False
        if len(following) > _MOST_LABELS:  # the earliest ones, and the one with the most energy
            following = [*following[: _MOST_LABELS - 1], following[-1]]
        labels, at, s = following, node, network.step[node]
        path.append(node)
        remaining[s] = False
        missing -= pruned.needs[s]
        closed += pruned.before[:, s]
    if end_labels:
        search.offer(path, dict(min(end_labels, key=timing.cost).charges))
    return bool(end_labels)
