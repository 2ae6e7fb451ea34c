"""The least that is still to come, for each set of steps made and each last node.

Windows and the battery are left out, so these are lower bounds for problems that have them: the
dynamic programme of `held_karp`, backwards.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.held_karp import INF, may_end
from argo_compiler.route.network import StepNetwork
from argo_compiler.route.order_ideals import MOST_BITS, Bits, Masks

_DENSE = 22
"""steps up to which a table has the place of each set"""


@dataclass(frozen=True, eq=False)
class Sets:
    """Sets of k steps, by k, each list sorted."""

    layers: tuple[Masks, ...]
    last: tuple[NDArray[np.bool_], ...]
    """of each set, whether the route may end with it"""
    places: NDArray[np.int32] | None
    """of each mask, its place in its list, -1 for masks that are in none; None: too many masks"""

    def find(self, number: int, wanted: Masks) -> tuple[Masks, NDArray[np.bool_]]:
        """The places of sets in the list of that number, and whether they are there at all."""
        if self.places is not None:
            place = self.places[wanted].astype(np.int64)
            return place, place >= 0
        among = self.layers[number]
        if not len(among):
            return np.zeros(len(wanted), np.int64), np.zeros(len(wanted), np.bool_)
        place = np.minimum(np.searchsorted(among, wanted), len(among) - 1)
        return place, among[place] == wanted


def _sets(layers: list[Masks], last: list[NDArray[np.bool_]], bits: int) -> Sets:
    places = None
    if bits <= _DENSE:
        places = np.full(1 << bits, -1, np.int32)
        for layer in layers:
            places[layer] = np.arange(len(layer), dtype=np.int32)
    return Sets(tuple(layers), tuple(last), places)


def sets_of(network: StepNetwork, bits: Bits, layers: list[Masks]) -> Sets:
    """These sets of 0, 1 and so on steps."""
    last = [may_end(network, bits, size, masks) for size, masks in enumerate(layers)]
    # With bits that are shared, equal masks may stand for sets of different sizes.
    return _sets(layers, last, MOST_BITS if bits.shared else len(network.prize))


def sets_towards(goals: Masks, steps: int) -> Sets:
    """All subsets of some sets, which are those that the route may end with. `steps`: few enough
    for a table of all sets."""
    there = np.zeros(1 << steps, np.bool_)
    there[goals] = True
    goal = there.copy()
    for s in range(steps):
        halves = there.reshape(-1, 2, 1 << s)
        halves[:, 0, :] |= halves[:, 1, :]
    masks = np.flatnonzero(there)
    size = np.bitwise_count(masks)
    layers = [masks[size == k] for k in range(int(size.max(initial=0)) + 1)]
    return _sets(layers, [goal[layer] for layer in layers], steps)


def to_come(
    network: StepNetwork, bits: Bits, sets: Sets, arcs: NDArray[np.int32]
) -> list[NDArray[np.int32]]:
    """For each layer the least sum of arcs with which a set that may be the last is reached, and
    the end. `arcs`: some kinds of them, shape (kinds, m + 1, m + 1); shape of the result (kinds,
    sets, m + 1), the last column that from the start; INF where there is no way."""
    m, kinds = network.size, len(arcs)
    found: list[NDArray[np.int32]] = []
    for number in reversed(range(len(sets.layers))):
        masks = sets.layers[number]
        least = np.full((kinds, len(masks), m + 1), INF, np.int32)
        least[:, sets.last[number]] = arcs[:, None, :, m]
        if found:
            following, rules = found[-1], bits.layer(number)
            for node in range(m):
                rows = rules.rows(masks, node)
                place, there = sets.find(number + 1, rules.after(masks[rows], node))
                rows, place = rows[there], place[there]
                for kind in range(kinds):
                    onward = arcs[kind, None, :, node] + following[kind, place, node, None]
                    least[kind, rows] = np.minimum(least[kind, rows], onward)
        found.append(np.minimum(least, INF))
    return found[::-1]
