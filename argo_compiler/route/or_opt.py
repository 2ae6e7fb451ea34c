"""Two neighbouring stretches of a route change places, where that keeps the order and is shorter.

No stretch is turned round, so that neither one-way times nor precedence stand in the way: the
SOP-3-exchange of L. M. Gambardella and M. Dorigo (INFORMS Journal on Computing 12, 2000), but with
all exchanges that have one cut in common looked at together, as matrices. Cut k is between the
positions k and k + 1 of the route, where position 0 is the start and the last one the end.
"""

from collections import deque
from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.network import StepNetwork
from argo_compiler.route.problem import NEVER
from argo_compiler.route.pruning import Pruned

Cuts = tuple[int, int, int]
"""before the first stretch, between the two, and after the second"""
Exchanges = tuple[NDArray[np.int64], NDArray[np.bool_], Callable[[int, int], Cuts]]
"""what each makes longer, whether it keeps the order, and its cuts by row and column"""
_MOST_STEPS = 300
"""a matrix of steps by steps is made for each exchange"""
_TRIES = 50


def applies(network: StepNetwork) -> bool:
    """Whether less travel is less time, and the matrices are not too large."""
    return network.plain and len(network.prize) <= _MOST_STEPS


class Exchange:
    """Exchanges in the routes of one network."""

    def __init__(self, network: StepNetwork, pruned: Pruned) -> None:
        m = network.size
        allowed = pruned.arcs & (network.time < NEVER)
        none = int(network.time[allowed].max(initial=0)) * (m + 2) + 1
        self.times: NDArray[np.int64] = np.where(allowed, network.time, none)
        """shape (m + 1, m + 1); an arc that there is not takes longer than any route"""
        self.before = np.zeros((m + 1, m + 1), np.bool_)
        """shape (m + 1, m + 1): row can't be made any more after column"""
        self.before[:m, :m] = pruned.before[np.ix_(network.step, network.step)]

    def improved(self, path: tuple[int, ...], near: Iterable[int]) -> tuple[int, ...]:
        """The path after exchanges that make it shorter, until there is none with a cut right after
        one of the nodes `near` or of those where it was cut."""
        line = _Line(self, path)
        waiting = deque(near)
        queued = set(waiting)
        while waiting:
            node = waiting.popleft()
            queued.discard(node)
            cuts = line.shortest_after(node)
            if cuts is not None:
                cut = line.exchange(cuts) - queued
                waiting += cut
                queued |= cut
        return line.path()

    def shuffled(
        self, path: tuple[int, ...], rng: np.random.Generator, times: int, length: int
    ) -> tuple[tuple[int, ...], set[int]]:
        """The path after some random exchanges of stretches of `length` nodes at most, and the
        nodes after which it was cut."""
        line, near = _Line(self, path), set[int]()
        for _ in range(times):
            for _ in range(_TRIES):
                first, second = (int(k) for k in rng.integers(1, length + 1, 2))
                if first + second > len(path):
                    continue
                begin = int(rng.integers(0, len(path) - first - second + 1))
                cuts = begin, begin + first, begin + first + second
                if line.keeps_order(cuts):
                    near |= line.exchange(cuts)
                    break
        return line.path(), near


class _Line:
    """A route with its start and end, as it is being changed. Has state."""

    def __init__(self, exchange: Exchange, path: tuple[int, ...]) -> None:
        self._exchange = exchange
        depot = len(exchange.times) - 1
        count = len(path) + 2
        self._positions = np.arange(count)
        self._later = self._positions[:, None] < self._positions
        """whether column is after row"""
        self._put(np.array([depot, *path, depot]))

    def path(self) -> tuple[int, ...]:
        return tuple(self.nodes[1:-1])

    def _put(self, order: NDArray[np.int64]) -> None:
        self._order = order
        self.nodes: list[int] = order.tolist()
        self._at = {node: k for k, node in enumerate(self.nodes[:-1])}
        self._time = self._exchange.times[order[:, None], order]
        """by position, as all that follows"""
        self._arc = self._time.diagonal(1).copy()
        """from each position to the next"""
        end = len(order) - 1
        before = self._exchange.before[order[:, None], order]
        follower = np.where(before & self._later, self._positions, end)
        soonest = np.minimum.accumulate(follower[:, ::-1], axis=1)[:, ::-1]
        """[i, j]: the first from j on that can't be made before i"""
        beyond = np.full_like(soonest, end)
        beyond[:, :-1] = np.where(self._later.T[:, :-1], end, soonest[:, 1:])
        self._reach = np.minimum.accumulate(beyond[::-1], axis=0)[::-1] - 1
        """[i, j]: how far the stretch after that from i to j may go to be exchanged with it"""

    def keeps_order(self, cuts: Cuts) -> bool:
        first, second, third = cuts
        return bool(third <= self._reach[first + 1, second])

    def exchange(self, cuts: Cuts) -> set[int]:
        """Makes an exchange; the nodes after which it cut."""
        first, second, third = (k + 1 for k in cuts)
        order = self._order
        after = {self.nodes[k] for k in cuts}
        parts = order[:first], order[second:third], order[first:second], order[third:]
        self._put(np.concatenate(parts))
        return after

    def shortest_after(self, node: int) -> Cuts | None:
        """The exchange with a cut after a node that saves most; None: none saves anything."""
        least, best, cut = 0, None, self._at[node]
        for longer, allowed, cuts in (self._first(cut), self._second(cut), self._third(cut)):
            if longer.size:
                longer[~allowed] = 0
                row, column = divmod(int(longer.argmin()), longer.shape[1])
                if longer[row, column] < least:
                    least, best = int(longer[row, column]), cuts(row, column)
        return best

    # Of an exchange, the new arcs are those from the first cut to behind the second, from the third
    # to behind the first, and from the second to behind the third.

    def _first(self, first: int) -> Exchanges:
        """Exchanges with this as their first cut: rows are second, columns third cuts."""
        time, arc, low = self._time, self._arc, first + 1
        second = time[first, low + 1 : -1] - arc[low:-1] - arc[first]
        third = time[low + 1 : -1, low] - arc[low + 1 :]
        longer = second[:, None] + third + time[low:-2, low + 2 :]
        allowed = self._later[low:-2, low + 1 : -1]
        allowed = allowed & (self._positions[low + 1 : -1] <= self._reach[low, low:-2, None])
        return longer, allowed, lambda row, column: (first, low + row, low + 1 + column)

    def _second(self, second: int) -> Exchanges:
        """Exchanges with this as their second cut: rows are first, columns third cuts."""
        time, arc, high = self._time, self._arc, second + 1
        first = time[:second, high] - arc[:second] - arc[second]
        third = time[second, high + 1 :] - arc[high:]
        longer = first[:, None] + third + time[high:-1, 1:high].T
        allowed = self._positions[high:-1] <= self._reach[1:high, second, None]
        return longer, allowed, lambda row, column: (row, second, high + column)

    def _third(self, third: int) -> Exchanges:
        """Exchanges with this as their third cut: rows are first, columns second cuts."""
        time, arc, last = self._time, self._arc, max(0, third - 1)
        first = time[third, 1:third] - arc[:last] - arc[third]
        second = time[1:third, third + 1] - arc[1:third]
        longer = first[:, None] + second + time[:last, 2 : third + 1]
        allowed = self._later[:last, 1:third] & (self._reach[1:third, 1:third] >= third)
        return longer, allowed, lambda row, column: (row, column + 1, third)
