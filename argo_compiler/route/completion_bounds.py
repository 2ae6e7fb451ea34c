"""Lower bounds on the remaining cost of a route, for each set of steps and each last node.

They come from the dynamic programme of `held_karp`, run backwards without time windows and without
the battery. So they are lower bounds for problems that have these.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.held_karp import INF, can_end
from argo_compiler.route.network import StepNetwork
from argo_compiler.route.order_ideals import MOST_BITS, Masks, StepBits

_DENSE = 22
"""highest number of steps for which a table has the index of each set"""


@dataclass(frozen=True, eq=False)
class StepSets:
    """Sets of k steps, in one sorted list for each k."""

    layers: tuple[Masks, ...]
    can_end: tuple[NDArray[np.bool_], ...]
    """for each set, whether the route may end with it"""
    index: NDArray[np.int32] | None
    """index of each mask in its list, -1 for masks in no list; None: there are too many masks"""

    def find(self, size: int, wanted: Masks) -> tuple[Masks, NDArray[np.bool_]]:
        """Return the indices of sets of `size` steps in their list, and whether each set is in it.

        `wanted` are the bit masks of the sets. The index of a set that is not in the list has no
        meaning.
        """
        if self.index is not None:
            index = self.index[wanted].astype(np.int64)
            return index, index >= 0
        masks = self.layers[size]
        if not len(masks):
            return np.zeros(len(wanted), np.int64), np.zeros(len(wanted), np.bool_)
        index = np.minimum(np.searchsorted(masks, wanted), len(masks) - 1)
        return index, masks[index] == wanted


def _make_step_sets(layers: list[Masks], ends: list[NDArray[np.bool_]], bits: int) -> StepSets:
    index = None
    if bits <= _DENSE:
        index = np.full(1 << bits, -1, np.int32)
        for layer in layers:
            index[layer] = np.arange(len(layer), dtype=np.int32)
    return StepSets(tuple(layers), tuple(ends), index)


def sets_in_layers(network: StepNetwork, bits: StepBits, layers: list[Masks]) -> StepSets:
    """Return the sets in `layers`, and for each whether a route may end with it.

    Layer k has the sets of k steps, as bit masks.
    """
    ends = [can_end(network, bits, size, masks) for size, masks in enumerate(layers)]
    # If steps share bits, sets of different sizes may have the same mask.
    return _make_step_sets(layers, ends, MOST_BITS if bits.shared else len(network.prize))


def subsets_of(goals: Masks, step_count: int) -> StepSets:
    """Return all subsets of `goals`, which are sets of steps; a route may end only with a goal.

    `step_count`: number of all steps, which must be low enough for a table of all sets.
    """
    is_subset = np.zeros(1 << step_count, np.bool_)
    is_subset[goals] = True
    is_goal = is_subset.copy()
    for s in range(step_count):
        halves = is_subset.reshape(-1, 2, 1 << s)
        halves[:, 0, :] |= halves[:, 1, :]
    masks = np.flatnonzero(is_subset)
    size = np.bitwise_count(masks)
    layers = [masks[size == k] for k in range(int(size.max(initial=0)) + 1)]
    return _make_step_sets(layers, [is_goal[layer] for layer in layers], step_count)


def completion_costs(
    network: StepNetwork, bits: StepBits, sets: StepSets, costs: NDArray[np.int32]
) -> list[NDArray[np.int32]]:
    """Compute, for each layer, the least cost from each set and last node to the end of a route.

    Args:
        network: The network with m nodes.
        bits: The bits of its steps.
        sets: The sets, and those with which a route may end.
        costs: Costs of arcs of several kinds, shape (kinds, m + 1, m + 1).

    Returns:
        One array per layer, shape (kinds, sets, m + 1), the last column from the start; INF where
        no route is possible.
    """
    m, kinds = network.node_count, len(costs)
    reversed_layers: list[NDArray[np.int32]] = []
    for size in reversed(range(len(sets.layers))):
        masks = sets.layers[size]
        least = np.full((kinds, len(masks), m + 1), INF, np.int32)
        least[:, sets.can_end[size]] = costs[:, None, :, m]
        if reversed_layers:
            following, rules = reversed_layers[-1], bits.layer(size)
            for node in range(m):
                rows = rules.rows_node_may_follow(masks, node)
                index, exists = sets.find(size + 1, rules.with_node(masks[rows], node))
                rows, index = rows[exists], index[exists]
                for kind in range(kinds):
                    onward = costs[kind, None, :, node] + following[kind, index, node, None]
                    least[kind, rows] = np.minimum(least[kind, rows], onward)
        reversed_layers.append(np.minimum(least, INF))
    return reversed_layers[::-1]
