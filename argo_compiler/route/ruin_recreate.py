"""Local search by ruin and recreate, for any problem.

Some steps near each other are removed from the route and inserted again where they cost least
(P. Shaw, CP 1998; G. Schrimpf et al., Journal of Computational Physics 159, 2000). Steps that the
route leaves out are tried as well. Slightly worse routes are accepted now and then, ever more
rarely. `argo_compiler.route.exchange_search` tries more routes in the same time, but does not
support a battery.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.network import StepNetwork
from argo_compiler.route.path_timing import PathTiming
from argo_compiler.route.problem import NEVER, RouteProblem
from argo_compiler.route.pruning import Pruned, least_arc_times_without_service
from argo_compiler.route.search import Search

Path = tuple[int, ...]
Vector = NDArray[np.int64]
Worth = tuple[int, int]
"""prize and negative cost: the greater, the better"""
_TIME_PER_CHANGE, _TIME_PER_LEG = 1e-4, 3e-6
"""nominal s for one change, and for each leg tried in it"""
_MOST_REMOVED = 8
"""highest number of steps that are removed at a time"""
_MOST_ADDED = 40
"""highest number of left out steps that are tried at a time"""
_TOLERANCE = 0.05
"""relative increase in cost up to which a worse route may be accepted, at the start"""


class RuinRecreate:
    """Solver that improves the best known route until the time is up."""

    name = "ruin and recreate"

    def supports(self, _problem: RouteProblem, /) -> bool:
        return True

    def solve(self, search: Search, /) -> None:
        best = search.best
        if best is not None and best.path is not None:
            LocalSearch(search.network, search.pruned, search.seed).offer_improvements(
                best.path, search
            )


def _charges(network: StepNetwork, path: Path) -> dict[int, int]:
    label = PathTiming(network).evaluate_path(path)
    assert label is not None
    return dict(label.charges)


class LocalSearch:
    """Local search for routes of one network; holds the state of its random generator."""

    def __init__(self, network: StepNetwork, pruned: Pruned, seed: int) -> None:
        self._network, self._pruned = network, pruned
        self._timing = PathTiming(network)
        self._rng = np.random.default_rng(seed)
        self._near = least_arc_times_without_service(network)
        self._step = network.step.tolist()
        self._needs = [set(np.flatnonzero(column).tolist()) for column in pruned.needs.T]
        self._after = [set(np.flatnonzero(row).tolist()) for row in pruned.before]
        self._before = [set(np.flatnonzero(column).tolist()) for column in pruned.before.T]
        self._is_time_up: Callable[[], bool] = lambda: False
        self._mandatory = np.flatnonzero(network.mandatory).tolist()

    def offer_improvements(self, path: Path, search: Search) -> None:
        """Search for better routes from a path until the time is up, and offer them."""
        best = current = path
        best_worth = current_worth = self._worth(path) or (0, -NEVER)
        total = search.remaining_time()
        self._is_time_up = lambda: search.remaining_time() <= 0.0
        if not path and not self._network.selective:
            return
        k, legs = 0, self._timing.legs
        while (remaining := search.remaining_time()) > 0.0:
            k += 1
            search.spend(_TIME_PER_CHANGE + _TIME_PER_LEG * (self._timing.legs - legs), 1)
            legs = self._timing.legs
            changed = self._recreate(self._ruin(current))
            worth = None if changed is None else self._worth(changed)
            if changed is None or worth is None:
                continue
            if worth > best_worth:
                best, best_worth = changed, worth
                search.offer(best, _charges(self._network, best))
            increase = (current_worth[1] - worth[1]) / max(1, -best_worth[1])
            if worth > current_worth or (
                worth[0] >= current_worth[0]
                and increase < _TOLERANCE * remaining / total * self._rng.random()
            ):
                current, current_worth = changed, worth
            elif k % 200 == 199:
                current, current_worth = best, best_worth

    def _worth(self, path: Path) -> Worth | None:
        label = self._timing.evaluate_path(path)
        if label is None:
            return None
        prize = sum(int(self._network.prize[self._step[node]]) for node in path)
        return prize, -self._timing.cost(label)

    def _ruin(self, path: Path) -> tuple[list[int], list[int]]:
        """Return a path without some nodes near each other, and the steps that may be inserted.

        These are the removed steps, and some of those that the path has left out.
        """
        m, rng = self._network.node_count, self._rng
        made = {self._step[node] for node in path}
        left_out = [s for s in np.flatnonzero(self._pruned.steps).tolist() if s not in made]
        left_out = rng.permutation(left_out)[:_MOST_ADDED].tolist()
        if not path:
            return [], [int(s) for s in left_out]
        count = int(rng.integers(1, min(_MOST_REMOVED, len(path)) + 1))
        centre = path[int(rng.integers(len(path)))]
        near = np.minimum(self._near[centre, :m], self._near[:m, centre])
        order = sorted(path, key=lambda node: (node != centre, near[node] * rng.random()))
        removed = set(order[:count])
        # The nodes that need a removed step are removed as well.
        steps = {self._step[node] for node in removed}
        removed |= {node for node in path if self._needs[self._step[node]] & steps}
        rest = [node for node in path if node not in removed]
        missing = [self._step[node] for node in removed] + left_out
        return rest, [int(s) for s in rng.permutation(missing)]

    def _recreate(self, ruin: tuple[list[int], list[int]]) -> Path | None:
        """Insert the steps one after the other where each costs least.

        Returns None if a mandatory step fits nowhere, or the time is up.
        """
        path, missing = ruin
        mandatory = set(self._mandatory)
        for s in sorted(missing, key=lambda s: (len(self._needs[s]), s not in mandatory)):
            if self._is_time_up():
                return None
            made = {self._step[node] for node in path}
            longer = None
            if self._needs[s] <= made:
                longer = self._insert(path, s)
            if longer is not None:
                path = longer
            elif s in mandatory:
                return None
        return tuple(path)

    def _insert(self, path: list[int], s: int) -> list[int] | None:
        """Return the path with a step inserted where it costs least, or None if it fits nowhere.

        Only a few of the cheapest positions are tried.
        """
        steps = [self._step[node] for node in path]
        low = max((k + 1 for k, t in enumerate(steps) if t in self._before[s]), default=0)
        high = min((k for k, t in enumerate(steps) if t in self._after[s]), default=len(path))
        if low > high:
            return None
        m, near = self._network.node_count, self._near
        closed_path = np.array([m, *path, m])
        before, after = closed_path[low : high + 1], closed_path[low + 1 : high + 2]
        insertions: list[tuple[float, int, int]] = []
        for node in self._network.nodes_of(s):
            extra = near[before, node] + near[node, after] - near[before, after]
            noisy = extra * self._rng.uniform(1.0, 1.05, len(extra))
            insertions += [(float(cost), low + k, node) for k, cost in enumerate(noisy)]
        tries = 1 if self._network.has_additive_times and self._network.limit >= NEVER else 6
        for _, position, node in sorted(insertions)[:tries]:
            longer = [*path[:position], node, *path[position:]]
            if self._timing.evaluate_path(tuple(longer)) is not None:
                return longer
        return None
