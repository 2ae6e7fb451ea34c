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
from argo_compiler.route.problem import NEVER, Objective
from argo_compiler.route.pruning import Pruned, shortest

Masks = NDArray[np.int64]

MOST_STEPS = 62
"""that fit a mask"""
_INF = np.int32(1 << 29)


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
    layers = list(_layers(network, pruned))
    best = _best_end(network, layers)
    if best is None:
        return none_found(network, proven=True)
    prize, end, number, row, node = best
    path = _path(network, layers, number, row, node)
    bound = end if network.objective is Objective.DURATION else 0
    made = found(network, path, {}, prize, bound)
    if network.objective is Objective.TRAVEL:
        made = found(network, path, {}, prize, made.cost)
    return made


def _arcs(network: Network, pruned: Pruned) -> NDArray[np.int32]:
    arcs = np.minimum(shortest(network), _INF).astype(np.int32)
    arcs[~pruned.arcs] = _INF
    return arcs


def _layers(network: Network, pruned: Pruned) -> Iterator[Layer]:
    """The layers from that of the first steps on."""
    m, allowed = network.size, rules(network, pruned)
    arcs = _arcs(network, pruned)
    latest = np.minimum(pruned.latest, _INF - 1)
    earliest, service = network.earliest[network.step], network.service
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
            ends.append(begin[in_time] + service[node])
        masks, place = np.unique(np.concatenate([*parts, masks[:0]]), return_inverse=True)
        if not len(masks):
            return
        times = np.full((len(masks), m), _INF, np.int32)
        first = 0
        for node, end in enumerate(ends):
            times[place[first : first + len(end)], node] = end
            first += len(end)
        keep = _in_time(network, pruned, masks, times)
        masks, times = masks[keep], times[keep]
        yield Layer(masks, times)
        onward = arcs[:m, :]


def _in_time(
    network: Network, pruned: Pruned, masks: Masks, times: NDArray[np.int32]
) -> NDArray[np.bool_]:
    """Whether each mandatory step that is still to be made can begin in time."""
    soonest = times.min(axis=1)
    keep = np.ones(len(masks), np.bool_)
    for s in np.flatnonzero(network.mandatory).tolist():
        latest = max(int(pruned.latest[node]) for node in network.nodes_of(s))
        if latest < NEVER:
            keep &= ((masks >> s) & 1 == 1) | (soonest <= latest)
    return keep


def _best_end(network: Network, layers: list[Layer]) -> tuple[int, int, int, int, int] | None:
    """The prize, end, layer, row and last node of the best path; layer -1: straight to the end."""
    m = network.size
    home = np.minimum(shortest(network)[:, m], _INF).astype(np.int32)
    must = int((np.int64(1) << np.flatnonzero(network.mandatory).astype(np.int64)).sum())
    best = None
    if not must and home[m] <= min(network.limit, int(_INF) - 1):
        best = (0, -int(home[m]), -1, 0, 0)
    for number, layer in enumerate(layers):
        ends = layer.times + home[:m]
        nodes = ends.argmin(axis=1)
        end = ends[np.arange(len(ends)), nodes].astype(np.int64)
        whole = ((layer.masks & must) == must) & (end <= min(network.limit, int(_INF) - 1))
        rows = np.flatnonzero(whole)
        if not len(rows):
            continue
        prizes = np.zeros(len(rows), np.int64)
        for s, prize in enumerate(network.prize.tolist()):
            prizes += ((layer.masks[rows] >> s) & 1) * prize
        pick = int(np.lexsort((end[rows], -prizes))[0])
        row = int(rows[pick])
        one = (int(prizes[pick]), -int(end[row]), number, row, int(nodes[row]))
        best = one if best is None else max(best, one, key=lambda found: found[:2])
    return None if best is None else (best[0], -best[1], *best[2:])


def _path(
    network: Network, layers: list[Layer], number: int, row: int, node: int
) -> tuple[int, ...]:
    """The nodes of the path that ends there, back from its end."""
    if number < 0:
        return ()
    arcs = np.minimum(shortest(network), _INF).astype(np.int32)
    path = [node]
    mask = int(layers[number].masks[row])
    while number > 0:
        number, mask = number - 1, mask & ~(1 << int(network.step[node]))
        layer = layers[number]
        times = layer.times[int(np.searchsorted(layer.masks, mask))]
        node = int((times + arcs[: network.size, node]).argmin())
        path.append(node)
    return tuple(reversed(path))
