"""Exact dynamic programming over the sets of steps that an order allows to have been made.

Held and Karp's programme, layer by layer in NumPy: after k steps it holds, for each set of k steps
that may come first (an ideal of the partial order) and each last node, the soonest time when the
robot is done there. To be sooner is never worse, so time windows, limits and what is left out cost
nothing more. What limits it is the number of sets: they are counted first.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from argo_compiler.route.found import Found, found, none_found
from argo_compiler.route.network import Network
from argo_compiler.route.problem import Objective
from argo_compiler.route.pruning import Pruned, shortest

Masks = NDArray[np.int64]

MOST_STEPS = 62
"""that fit a mask"""
INF = np.int32(1 << 29)
"""more than any time"""


@dataclass(frozen=True, eq=False)
class Layer:
    """The sets of k steps, sorted, and the soonest times at their last nodes, shape (sets, m)."""

    masks: Masks
    times: NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class Rules:
    """When a node may come next, as masks of steps; one entry for each node."""

    bit: Masks
    needs: Masks
    ruled_out_by: Masks

    def rows(self, masks: Masks, node: int) -> NDArray[np.int64]:
        """The rows of the sets after which the node may come."""
        needs = self.needs[node]
        taken = self.bit[node] | self.ruled_out_by[node]
        return np.flatnonzero(((masks & needs) == needs) & ((masks & taken) == 0))


def rules(network: Network, pruned: Pruned) -> Rules:
    """The rules of a network's nodes. A step that can't be made needs itself."""
    bits = np.int64(1) << np.arange(len(network.prize), dtype=np.int64)
    needs = np.array([int(bits[column].sum()) for column in pruned.needs.T], np.int64)
    ruled = np.array([int(bits[row].sum()) for row in pruned.before], np.int64)
    needs[~pruned.steps] |= bits[~pruned.steps]
    step = network.step
    return Rules(bits[step], needs[step], ruled[step])


def count_sets(network: Network, pruned: Pruned, most: int) -> int:
    """How many sets of steps the order allows, up to a little more than `most`: the product over
    the parts of the order that have nothing to do with each other."""
    if len(network.prize) > MOST_STEPS:
        return most + 1
    allowed = rules(network, pruned)
    first_node = {int(step): node for node, step in reversed(list(enumerate(network.step)))}
    _, part = connected_components(pruned.needs, directed=False)
    total = 1
    for number in range(int(part.max(initial=-1)) + 1):
        nodes = [first_node[s] for s in np.flatnonzero(part == number).tolist() if s in first_node]
        masks, sets = np.zeros(1, np.int64), 1
        while len(masks) and total * sets <= most:
            following = [masks[allowed.rows(masks, node)] | allowed.bit[node] for node in nodes]
            masks = np.unique(np.concatenate([*following, masks[:0]]))
            sets += len(masks)
        total *= sets
        if total > most:
            break
    return total


def applies(network: Network) -> bool:
    """Whether the soonest is always the best: the waiting of windows must count."""
    waits = network.objective is Objective.TRAVEL and network.windowed
    return not waits and network.problem.battery is None and len(network.prize) <= MOST_STEPS


def solve_subsets(network: Network, pruned: Pruned) -> Found:
    """A best path, or the proof that there is none."""
    if not pruned.possible:
        return none_found(network, proven=True)
    best = best_path(network, soonest_layers(network, pruned), pruned)
    if best is None:
        return none_found(network, proven=True)
    made = found(network, best.path, {}, best.prize, 0)
    return found(network, best.path, {}, best.prize, made.cost)


@dataclass(frozen=True)
class BestPath:
    """A path that wins the most, and among those is the soonest at the end."""

    path: tuple[int, ...]
    prize: int
    end: int


def soonest_layers(network: Network, pruned: Pruned) -> list[Layer]:
    """The layers of a network whose battery is never empty."""
    arcs = arcs_of(network, pruned, shortest(network))
    latest = np.minimum(pruned.latest, INF - 1)
    earliest = network.earliest[network.step]
    return list(soonest(network, rules(network, pruned), arcs, earliest, latest))


def best_path(network: Network, layers: list[Layer], pruned: Pruned) -> BestPath | None:
    """The best path that the layers hold; None: there is none."""
    best = _best_end(network, layers)
    if best is None:
        return None
    prize, end, number, row, node = best
    arcs = arcs_of(network, pruned, shortest(network))
    return BestPath(_path(network, arcs, layers, number, row, node), prize, end)


def arcs_of(network: Network, pruned: Pruned, times: NDArray[np.int64]) -> NDArray[np.int32]:
    """The arcs that are left, INF for the others; to the end from everywhere."""
    arcs = np.minimum(times, INF).astype(np.int32)
    allowed = pruned.arcs.copy()
    allowed[network.size, network.size] = True
    arcs[~allowed] = INF
    return arcs


def soonest(
    network: Network,
    allowed: Rules,
    arcs: NDArray[np.int32],
    earliest: Masks,
    latest: Masks,
) -> Iterator[Layer]:
    """The layers from that of the first steps on, for arcs between nodes that begin when they may
    (`earliest`, `latest`, shape (m,))."""
    m = network.size
    masks, times = np.zeros(1, np.int64), np.zeros((1, 1), np.int32)
    onward = arcs[m:, :]  # from the start; afterwards from all nodes
    while True:
        parts, ends = [], []
        for node in range(m):
            rows = allowed.rows(masks, node)
            arrival = (times[rows] + onward[None, :, node]).min(axis=1)
            begin = np.maximum(arrival, earliest[node])
            in_time = begin <= latest[node]
            parts.append(masks[rows[in_time]] | allowed.bit[node])
            ends.append(begin[in_time] + network.service[node])
        masks, place = np.unique(np.concatenate([*parts, masks[:0]]), return_inverse=True)
        if not len(masks):
            return
        times = np.full((len(masks), m), INF, np.int32)
        first = 0
        for node, end in enumerate(ends):
            times[place[first : first + len(end)], node] = end
            first += len(end)
        keep = _in_time(network, latest, masks, times)
        masks, times = masks[keep], times[keep]
        yield Layer(masks, times)
        onward = arcs[:m, :]


def ends(network: Network, arcs: NDArray[np.int32], layer: Layer) -> Masks:
    """The soonest time at the end for each set of a layer."""
    home = arcs[: network.size, network.size]
    return np.asarray((layer.times + home).min(axis=1), np.int64)


def _in_time(
    network: Network, latest: Masks, masks: Masks, times: NDArray[np.int32]
) -> NDArray[np.bool_]:
    """Whether each mandatory step that is still to be made can begin in time."""
    at = times.min(axis=1)
    keep = np.ones(len(masks), np.bool_)
    for s in np.flatnonzero(network.mandatory).tolist():
        last = max(int(latest[node]) for node in network.nodes_of(s))
        if last < INF - 1:
            keep &= ((masks >> s) & 1 == 1) | (at <= last)
    return keep


def prizes(network: Network, masks: Masks) -> Masks:
    """What the steps of each set are worth."""
    total = np.zeros(len(masks), np.int64)
    for s, prize in enumerate(network.prize.tolist()):
        total += ((masks >> s) & 1) * prize
    return total


def must(network: Network) -> np.int64:
    """The mask of the steps that must be made."""
    steps = np.flatnonzero(network.mandatory).astype(np.int64)
    return np.int64((np.int64(1) << steps).sum())


def _best_end(network: Network, layers: list[Layer]) -> tuple[int, int, int, int, int] | None:
    """The prize, end, layer, row and last node of the best path; layer -1: straight to the end."""
    m, all_of = network.size, must(network)
    home = np.minimum(shortest(network)[:, m], INF).astype(np.int32)
    limit = min(network.limit, int(INF) - 1)
    best = (0, -int(home[m]), -1, 0, 0) if not all_of and home[m] <= limit else None
    for number, layer in enumerate(layers):
        whole = layer.times + home[:m]
        nodes = whole.argmin(axis=1)
        end = whole[np.arange(len(whole)), nodes].astype(np.int64)
        rows = np.flatnonzero(((layer.masks & all_of) == all_of) & (end <= limit))
        if not len(rows):
            continue
        won = prizes(network, layer.masks[rows])
        pick = int(np.lexsort((end[rows], -won))[0])
        row = int(rows[pick])
        one = (int(won[pick]), -int(end[row]), number, row, int(nodes[row]))
        best = one if best is None else max(best, one, key=lambda found: found[:2])
    return None if best is None else (best[0], -best[1], *best[2:])


def _path(
    network: Network,
    arcs: NDArray[np.int32],
    layers: list[Layer],
    number: int,
    row: int,
    node: int,
) -> tuple[int, ...]:
    """The nodes of the path that ends there, back from its end."""
    if number < 0:
        return ()
    path = [node]
    mask = int(layers[number].masks[row])
    while number > 0:
        number, mask = number - 1, mask & ~(1 << int(network.step[node]))
        layer = layers[number]
        times = layer.times[int(np.searchsorted(layer.masks, mask))]
        node = int((times + arcs[: network.size, node]).argmin())
        path.append(node)
    return tuple(reversed(path))
