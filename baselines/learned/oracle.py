"""The best that is left of a route, exactly: dynamic programming over subsets of few checkpoints.

After M. Held and R. Karp, "A dynamic programming approach to sequencing problems" (1962). The
table has, for each set of checkpoints and each place, the least time to visit all of the set, in an
order that precedence allows, and be docked. From it follows what each action is worth in any state
of the same instance, which is what the network is taught before it learns by itself.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]
Ints = NDArray[np.int32]
_CHUNK = 128  # sets that are looked at first
_EQUAL = 1e-5


@dataclass(frozen=True)
class Remainder:
    """What is left of a batch of routes: m checkpoints each, in the numbers 0 to m - 1."""

    start: Floats
    """s from here to the end of a visit, shape (batch, m)"""
    back: Floats
    """s from here to the dock, shape (batch,)"""
    between: Floats
    """s from the end of one visit (row) to the end of the next, shape (batch, m, m)"""
    home: Floats
    """s from each to the dock, shape (batch, m)"""
    prizes: Floats
    """shape (batch, m)"""
    before: NDArray[np.bool_]
    """whether row must be visited before column, shape (batch, m, m)"""
    left: Floats
    """s, shape (batch,)"""


class Oracle:
    """Knows what every action in every state of these routes is worth."""

    def __init__(self, routes: Remainder) -> None:
        self.routes = routes
        batch, m = routes.prizes.shape
        self._bits = np.int32(1) << np.arange(m, dtype=np.int32)
        self._first = (routes.before * self._bits[:, None]).sum(axis=1, dtype=np.int32)
        self._times = _times(routes, self._first)
        sets = np.arange(1 << m, dtype=np.int32)
        self._prize = np.zeros((batch, 1 << m), np.float32)
        self._needs = np.zeros((batch, 1 << m), np.int32)
        for k in range(m):
            with_k = slice(1 << k, 2 << k)
            self._prize[:, with_k] = self._prize[:, : 1 << k] + routes.prizes[:, k : k + 1]
            self._needs[:, with_k] = self._needs[:, : 1 << k] | self._first[:, k : k + 1]
        self._needs &= ~sets
        self._sets = np.argsort(-self._prize, axis=1, kind="stable").astype(np.int32)

    def legal(self, k: int, visited: int, travel: Floats, left: float) -> Ints:
        """The checkpoints that may come next on route k, `travel` (s) away."""
        free = (self._bits & visited) == 0
        free &= (self._first[k] & ~np.int32(visited)) == 0
        return np.flatnonzero(free & (travel + self.routes.home[k] <= left)).astype(np.int32)

    def values(
        self, k: int, visited: int, travel: Floats, left: float, actions: Ints
    ) -> tuple[Floats, Floats]:
        """The best prize that is still to be had on route k after each of the actions, theirs
        included, and the least time (s) in which it can be had and the robot be docked."""
        sets = self._sets[k]
        sets = sets[(sets & visited) == 0]
        best = np.full(len(actions), -1.0, np.float32)
        time = np.full(len(actions), np.inf, np.float32)
        bits, steps = self._bits[actions], travel[actions]
        done, size = 0, _CHUNK
        # The sets with the highest prizes come first, so most actions are soon settled.
        while done < len(sets):
            rest = sets[done : done + size]
            prize = self._prize[k][rest][:, None]
            times = self._times[k][rest][:, actions] + steps
            fits = times <= left
            fits &= (rest[:, None] & bits) == 0
            fits &= (self._needs[k][rest][:, None] & ~(bits | np.int32(visited))) == 0
            best = np.maximum(best, np.where(fits, prize, -1.0).max(axis=0))
            # Prizes are sums in single precision: equal ones may differ in their last bits.
            fits &= prize >= best - _EQUAL
            time = np.minimum(time, np.where(fits, times, np.inf).min(axis=0))
            if prize[-1, 0] < best.min() - _EQUAL:
                break
            done, size = done + size, size * 4
        return best + self.routes.prizes[k, actions], time


def _times(routes: Remainder, first: Ints) -> Floats:
    """The table, shape (batch, 2^m, m): set and place."""
    batch, m = routes.prizes.shape
    table = np.full((1 << m, batch, m), np.inf, np.float32)
    table[0] = routes.home
    for layer in _layers(m):
        for k, sets in enumerate(layer):
            if not len(sets):
                continue
            rest = sets ^ np.int32(1 << k)
            after = table[rest, :, k]
            after[(first[:, k] & rest[:, None]) != 0] = np.inf
            best = after[:, :, None] + routes.between[None, :, :, k]
            table[sets] = np.minimum(table[sets], best, out=best)
    return np.ascontiguousarray(table.transpose(1, 0, 2))


@lru_cache(maxsize=4)
def _layers(m: int) -> list[list[Ints]]:
    """The sets with 1, 2 and so on of m members, each list by the member that it has."""
    sets = np.arange(1 << m, dtype=np.int32)
    counts = np.bitwise_count(sets)
    return [
        [sets[(counts == size) & (sets >> k & 1 == 1)] for k in range(m)]
        for size in range(1, m + 1)
    ]
