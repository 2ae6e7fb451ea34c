"""Routes for any problem, changed again and again.

By ruin and recreate: some steps near each other are taken out of the route and put back where they
cost least (P. Shaw, CP 1998; G. Schrimpf et al., Journal of Computational Physics 159, 2000). Steps
that were left out are tried as well. A route that is a little worse is taken now and then, less and
less often. `argo_compiler.route.exchange_search` does more of it in the same time, but knows no
battery.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.network import StepNetwork
from argo_compiler.route.path_timing import PathTiming
from argo_compiler.route.problem import NEVER, RouteProblem
from argo_compiler.route.pruning import Pruned, least_arc_times
from argo_compiler.route.search import Search

Path = tuple[int, ...]
Vector = NDArray[np.int64]
Worth = tuple[int, int]
"""prize and cost (negative): the greater, the better"""
_CHANGE, _LEG = 1e-4, 3e-6
"""s for one change, and for each leg that it looks at"""
_RUINED = 8
"""steps that are taken out at most"""
_TRIED = 40
"""steps that were left out and are tried, at most"""
_WORSE = 0.05
"""by how much a route that is taken may be worse, in the beginning"""


class RuinRecreate:
    """Improves the best route that is known, until the time is over."""

    name = "ruin and recreate"

    def supports(self, _problem: RouteProblem, /) -> bool:
        return True

    def solve(self, search: Search, /) -> None:
        best = search.best
        if best is not None and best.path is not None:
            LocalSearch(search.network, search.pruned, search.seed).improve(best.path, search)


def _charges(network: StepNetwork, path: Path) -> dict[int, int]:
    label = PathTiming(network).follow(path)
    assert label is not None
    return dict(label.charges)


class LocalSearch:
    """Improves routes of one network. Has state: its generator."""

    def __init__(self, network: StepNetwork, pruned: Pruned, seed: int) -> None:
        self._network, self._pruned = network, pruned
        self._timing = PathTiming(network)
        self._rng = np.random.default_rng(seed)
        self._near = least_arc_times(network)
        self._step = network.step.tolist()
        self._needs = [set(np.flatnonzero(column).tolist()) for column in pruned.needs.T]
        self._after = [set(np.flatnonzero(row).tolist()) for row in pruned.before]
        self._before = [set(np.flatnonzero(column).tolist()) for column in pruned.before.T]
        self._over: Callable[[], bool] = lambda: False
        self._must = np.flatnonzero(network.mandatory).tolist()

    def improve(self, path: Path, search: Search) -> None:
        """Offers the better routes that are found until the time is over, from the one given."""
        best = at = path
        best_worth = at_worth = self._worth(path) or (0, -NEVER)
        whole = search.remaining()
        self._over = lambda: search.remaining() <= 0.0
        if not path and not self._network.selective:
            return
        k, legs = 0, self._timing.legs
        while (left := search.remaining()) > 0.0:
            k += 1
            search.spend(_CHANGE + _LEG * (self._timing.legs - legs), 1)
            legs = self._timing.legs
            there = self._recreated(self._ruined(at))
            worth = None if there is None else self._worth(there)
            if there is None or worth is None:
                continue
            if worth > best_worth:
                best, best_worth = there, worth
                search.offer(best, _charges(self._network, best))
            worse = (at_worth[1] - worth[1]) / max(1, -best_worth[1])
            if worth > at_worth or (
                worth[0] >= at_worth[0] and worse < _WORSE * left / whole * self._rng.random()
            ):
                at, at_worth = there, worth
            elif k % 200 == 199:
                at, at_worth = best, best_worth

    def _worth(self, path: Path) -> Worth | None:
        label = self._timing.follow(path)
        if label is None:
            return None
        prize = sum(int(self._network.prize[self._step[node]]) for node in path)
        return prize, -self._timing.cost(label)

    def _ruined(self, path: Path) -> tuple[list[int], list[int]]:
        """A path without some nodes near each other, and the steps that may be put back."""
        m, rng = self._network.size, self._rng
        made = {self._step[node] for node in path}
        left_out = [s for s in np.flatnonzero(self._pruned.steps).tolist() if s not in made]
        left_out = rng.permutation(left_out)[:_TRIED].tolist()
        if not path:
            return [], [int(s) for s in left_out]
        count = int(rng.integers(1, min(_RUINED, len(path)) + 1))
        centre = path[int(rng.integers(len(path)))]
        near = np.minimum(self._near[centre, :m], self._near[:m, centre])
        order = sorted(path, key=lambda node: (node != centre, near[node] * rng.random()))
        out = set(order[:count])
        # What needs a step that is taken out is taken out as well.
        steps = {self._step[node] for node in out}
        out |= {node for node in path if self._needs[self._step[node]] & steps}
        rest = [node for node in path if node not in out]
        back = [self._step[node] for node in out] + left_out
        return rest, [int(s) for s in rng.permutation(back)]

    def _recreated(self, ruin: tuple[list[int], list[int]]) -> Path | None:
        """The steps put back, one after the other, where each costs least."""
        path, back = ruin
        must = set(self._must)
        for s in sorted(back, key=lambda s: (len(self._needs[s]), s not in must)):
            if self._over():
                return None
            made = {self._step[node] for node in path}
            placed = None
            if self._needs[s] <= made:
                placed = self._placed(path, s)
            if placed is not None:
                path = placed
            elif s in must:
                return None
        return tuple(path)

    def _placed(self, path: list[int], s: int) -> list[int] | None:
        """The path with a step at one of the cheapest places that can be followed."""
        steps = [self._step[node] for node in path]
        low = max((k + 1 for k, t in enumerate(steps) if t in self._before[s]), default=0)
        high = min((k for k, t in enumerate(steps) if t in self._after[s]), default=len(path))
        if low > high:
            return None
        m, near = self._network.size, self._near
        around = np.array([m, *path, m])
        before, after = around[low : high + 1], around[low + 1 : high + 2]
        places: list[tuple[float, int, int]] = []
        for node in self._network.nodes_of(s):
            more = near[before, node] + near[node, after] - near[before, after]
            blink = more * self._rng.uniform(1.0, 1.05, len(more))
            places += [(float(cost), low + k, node) for k, cost in enumerate(blink)]
        tries = 1 if self._network.plain and self._network.limit >= NEVER else 6
        for _, position, node in sorted(places)[:tries]:
            longer = [*path[:position], node, *path[position:]]
            if self._timing.follow(tuple(longer)) is not None:
                return longer
        return None
