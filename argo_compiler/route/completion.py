"""The least that is still to come, for each set of steps made and each last node.

Windows and the battery are left out, so these are lower bounds for problems that have them: the
dynamic programme of `subsets`, backwards.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.network import Network
from argo_compiler.route.subsets import INF, Masks, Rules

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
        place = np.minimum(np.searchsorted(among, wanted), len(among) - 1)
        return place, among[place] == wanted


def _sets(layers: list[Masks], last: list[NDArray[np.bool_]], steps: int) -> Sets:
    places = None
    if steps <= _DENSE:
        places = np.full(1 << steps, -1, np.int32)
        for layer in layers:
            places[layer] = np.arange(len(layer), dtype=np.int32)
    return Sets(tuple(layers), tuple(last), places)


def all_sets(rules: Rules, nodes: list[int], must: np.int64, steps: int) -> Sets:
    """All sets that the order allows. `nodes`: one of each step; `must`: what the last one has."""
    masks = np.zeros(1, np.int64)
    layers = []
    while len(masks):
        layers.append(masks)
        following = [masks[rules.rows(masks, node)] | rules.bit[node] for node in nodes]
        masks = np.unique(np.concatenate([*following, masks[:0]]))
    return _sets(layers, [(layer & must) == must for layer in layers], steps)


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
    network: Network, rules: Rules, sets: Sets, arcs: NDArray[np.int32]
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
            following = found[-1]
            for node in range(m):
                rows = rules.rows(masks, node)
                place, there = sets.find(number + 1, masks[rows] | rules.bit[node])
                rows, place = rows[there], place[there]
                for kind in range(kinds):
                    onward = arcs[kind, None, :, node] + following[kind, place, node, None]
                    least[kind, rows] = np.minimum(least[kind, rows], onward)
        found.append(np.minimum(least, INF))
    return found[::-1]
