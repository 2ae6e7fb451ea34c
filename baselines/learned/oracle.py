"""Exact values of actions in small route problems, by dynamic programming over subsets.

The method is that of M. Held and R. Karp, "A dynamic programming approach to sequencing problems"
(1962). The table has, for each set of checkpoints and each checkpoint from which the robot departs,
the least time to visit the whole set, in an order that precedence allows, and to dock. It gives the
value of each action in any state of the same instance, which the network learns in the lessons,
before MaskablePPO.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]
Ints = NDArray[np.int32]
_CHUNK = 128  # number of sets that are compared first
_EQUAL = 1e-5  # tolerance of equal prizes


@dataclass(frozen=True)
class RemainingRoutes:
    """A batch of routes still to be driven, each with m checkpoints, from 0 to m - 1."""

    start: Floats
    """time in s from the robot's node to the end of a visit, shape (batch, m)"""
    back: Floats
    """time in s from the robot's node to the dock, shape (batch,)"""
    between: Floats
    """time in s from the end of one visit (row) to the end of the next, shape (batch, m, m)"""
    home: Floats
    """time in s from each checkpoint to the dock, shape (batch, m)"""
    prizes: Floats
    """prize of each checkpoint, shape (batch, m)"""
    before: NDArray[np.bool_]
    """whether row must be visited before column, shape (batch, m, m)"""
    left: Floats
    """time left in s, shape (batch,)"""


class Oracle:
    """Exact values of all actions in all states of a batch of small route problems.

    A set of checkpoints is a bit mask.
    """

    def __init__(self, routes: RemainingRoutes) -> None:
        self.routes = routes
        batch, m = routes.prizes.shape
        self._bits = np.int32(1) << np.arange(m, dtype=np.int32)
        self._predecessors = (routes.before * self._bits[:, None]).sum(axis=1, dtype=np.int32)
        self._times = _docking_times(routes, self._predecessors)
        sets = np.arange(1 << m, dtype=np.int32)
        self._prize = np.zeros((batch, 1 << m), np.float32)
        self._needs = np.zeros((batch, 1 << m), np.int32)
        for k in range(m):
            with_k = slice(1 << k, 2 << k)
            self._prize[:, with_k] = self._prize[:, : 1 << k] + routes.prizes[:, k : k + 1]
            self._needs[:, with_k] = self._needs[:, : 1 << k] | self._predecessors[:, k : k + 1]
        self._needs &= ~sets
        self._sets = np.argsort(-self._prize, axis=1, kind="stable").astype(np.int32)

    def legal_actions(self, route_index: int, visited: int, travel: Floats, left: float) -> Ints:
        """Return the checkpoints that may be visited next on a route.

        Args:
            route_index: index of the route in the batch.
            visited: set of visited checkpoints, as a mask with bit i for checkpoint i.
            travel: times in s from the robot's node to the end of a visit of each checkpoint.
            left: time left in s.
        """
        free = (self._bits & visited) == 0
        free &= (self._predecessors[route_index] & ~np.int32(visited)) == 0
        return np.flatnonzero(free & (travel + self.routes.home[route_index] <= left)).astype(
            np.int32
        )

    def action_prizes_and_times(
        self, route_index: int, visited: int, travel: Floats, left: float, actions: Ints
    ) -> tuple[Floats, Floats]:
        """Return the values of legal actions on a route; see `legal_actions` for the arguments.

        Returns:
            The highest prize that can be won from each action on, its own included; and the least
            time in s from the present state until the robot is docked with that prize.
        """
        sets = self._sets[route_index]
        sets = sets[(sets & visited) == 0]
        best = np.full(len(actions), -1.0, np.float32)
        time = np.full(len(actions), np.inf, np.float32)
        bits, steps = self._bits[actions], travel[actions]
        done, size = 0, _CHUNK
        # The sets with the highest prizes come first, so most actions soon have their value.
        while done < len(sets):
            rest = sets[done : done + size]
            prize = self._prize[route_index][rest][:, None]
            times = self._times[route_index][rest][:, actions] + steps
            fits = times <= left
            fits &= (rest[:, None] & bits) == 0
            fits &= (self._needs[route_index][rest][:, None] & ~(bits | np.int32(visited))) == 0
            best = np.maximum(best, np.where(fits, prize, -1.0).max(axis=0))
            # Prizes are sums in single precision: equal ones may differ in their last bits.
            fits &= prize >= best - _EQUAL
            time = np.minimum(time, np.where(fits, times, np.inf).min(axis=0))
            if prize[-1, 0] < best.min() - _EQUAL:
                break
            done, size = done + size, size * 4
        return best + self.routes.prizes[route_index, actions], time


def _docking_times(routes: RemainingRoutes, predecessors: Ints) -> Floats:
    """Return the least time in s to visit all of a set and dock, from each checkpoint.

    The shape is (batch, 2^m, m): set, then checkpoint from which the robot departs; inf: impossible
    in any order that precedence within the set allows. The entries of checkpoints in the
    set have no meaning.
    """
    batch, m = routes.prizes.shape
    table = np.full((1 << m, batch, m), np.inf, np.float32)
    table[0] = routes.home
    for same_size in _sets_by_size(m):
        for k, sets in enumerate(same_size):
            if not len(sets):
                continue
            rest = sets ^ np.int32(1 << k)
            after = table[rest, :, k]
            after[(predecessors[:, k] & rest[:, None]) != 0] = np.inf
            best = after[:, :, None] + routes.between[None, :, :, k]
            table[sets] = np.minimum(table[sets], best, out=best)
    return np.ascontiguousarray(table.transpose(1, 0, 2))


@lru_cache(maxsize=4)
def _sets_by_size(m: int) -> list[list[Ints]]:
    """Return all sets of 1 to m members as bit masks; `[size - 1][k]` has those with member k."""
    sets = np.arange(1 << m, dtype=np.int32)
    counts = np.bitwise_count(sets)
    return [
        [sets[(counts == size) & (sets >> k & 1 == 1)] for k in range(m)]
        for size in range(1, m + 1)
    ]
