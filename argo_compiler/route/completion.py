"""The least that is still to come, for each set of steps made and each last node.

Windows and the battery are left out, so these are lower bounds for problems that have them: the
same dynamic programme as `subsets`, backwards.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.network import Network
from argo_compiler.route.subsets import Masks, Rules

INF = np.int32(1 << 29)
"""more than any cost"""


@dataclass(frozen=True, eq=False)
class Sets:
    """The sets of k steps that the order allows, by k, each list sorted."""

    layers: tuple[Masks, ...]


def all_sets(rules: Rules, nodes: list[int]) -> Sets:
    """All sets. `nodes`: one of each step."""
    masks = np.zeros(1, np.int64)
    layers = []
    while len(masks):
        layers.append(masks)
        following = [masks[rules.rows(masks, node)] | rules.bit[node] for node in nodes]
        masks = np.unique(np.concatenate([*following, masks[:0]]))
    return Sets(tuple(layers))


def to_come(
    network: Network, rules: Rules, sets: Sets, arcs: NDArray[np.int32]
) -> list[NDArray[np.int32]]:
    """For each layer the least sum of arcs (shape (m + 1, m + 1)) that makes all other steps and
    ends, shape (sets, m + 1), the last column that from the start; INF where there is no way.

    For networks in which nothing may be left out.
    """
    m = network.size
    full = len(network.prize)
    least = np.full((len(sets.layers[-1]), m + 1), INF, np.int32)
    if len(sets.layers) == full + 1:
        least[:] = arcs[:, m]
    found = [least]
    for masks, after in zip(sets.layers[-2::-1], sets.layers[:0:-1], strict=True):
        following = found[-1]
        least = np.full((len(masks), m + 1), INF, np.int32)
        for node in range(m):
            rows = rules.rows(masks, node)
            to_end = following[np.searchsorted(after, masks[rows] | rules.bit[node]), node]
            least[rows] = np.minimum(least[rows], arcs[None, :, node] + to_end[:, None])
        found.append(np.minimum(least, INF))
    return found[::-1]
