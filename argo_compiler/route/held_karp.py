"""Exact dynamic programming over the sets of steps that an order allows to have been made.

Held and Karp's programme, layer by layer in NumPy: after k steps it holds, for each set of k steps
that may come first (an ideal of the partial order) and each last node, the soonest time when the
robot is done there. To be sooner is never worse, so time windows, limits and what is left out cost
nothing more. What limits it is the number of sets: they are counted first.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from argo_compiler.route.network import StepNetwork
from argo_compiler.route.order_ideals import Bits, Masks
from argo_compiler.route.problem import RouteProblem
from argo_compiler.route.pruning import Pruned, longest, shortest
from argo_compiler.route.search import Search

INF = np.int32(1 << 29)
"""more than any time"""
_MOST_SETS = 1_500_000
_MOST_WORK = 24_000_000
"""sets times nodes"""
_FEW_SETS = 30_000
"""that take no time worth speaking of; of steps in any order, CP-SAT proves more sooner"""
_NOMINAL = 2e-7
"""s for a set and a node"""


@dataclass(frozen=True, eq=False)
class Layer:
    """The sets of k steps, sorted, and the soonest times at their last nodes, shape (sets, m)."""

    masks: Masks
    times: NDArray[np.int32]
    origin: NDArray[np.int32]
    """the row of the set of k - 1 steps that each was reached from, shape of `times`"""


def count_sets(
    network: StepNetwork, pruned: Pruned, most: int, over: Callable[[], bool] = lambda: False
) -> int:
    """How many sets of steps the order allows; more than `most` when they are so many, or when
    counting them is `over` before it is done."""
    bits = Bits(network, pruned)
    if not bits.fits:
        return most + 1
    first_node = {int(step): node for node, step in reversed(list(enumerate(network.step)))}
    if bits.shared:
        return _count(bits, list(first_node.values()), most, over)
    # The product over the parts of the order that have nothing to do with each other.
    total = 1
    _, part = connected_components(pruned.needs, directed=False)
    for number in range(int(part.max(initial=-1)) + 1):
        nodes = [first_node[s] for s in np.flatnonzero(part == number).tolist() if s in first_node]
        total *= _count(bits, nodes, most // total, over)
        if total > most:
            break
    return total


def _count(bits: Bits, nodes: list[int], most: int, over: Callable[[], bool]) -> int:
    masks, total, size = np.zeros(1, np.int64), 1, 0
    while len(masks) and total <= most:
        if over():
            return most + 1
        rules = bits.layer(size)
        following = [
            rules.after(masks[rules.rows(masks, node)], node) for node in nodes if rules.open[node]
        ]
        masks = np.unique(np.concatenate([*following, masks[:0]]))
        total, size = total + len(masks), size + 1
    return total


def small_layers(search: Search) -> list[Layer] | None:
    """The layers of a search's network, if they are few enough to be gone through."""
    network, pruned = search.network, search.pruned
    most = min(_MOST_SETS, _MOST_WORK // max(1, network.size))
    part = search.share(0.7)
    if not search.timed:
        most = min(most, int(part.remaining() / (_NOMINAL * max(1, network.size))))
    sets = count_sets(network, pruned, most, lambda: part.remaining() <= 0.0)
    ordered = network.windowed or pruned.before.any() or network.problem.battery is not None
    # Windows may leave much fewer sets than the order does.
    few = sets <= (most if ordered else _FEW_SETS) or network.windowed
    if not few or longest(network) >= INF or not Bits(network, pruned).fits:
        search.add_reason(f"{int(pruned.steps.sum())} steps allow too many sets to go through")
        return None
    layers = soonest_layers(network, pruned, most, lambda: part.remaining() <= 0.0)
    if layers is None:
        search.add_reason("there are too many sets to go through, or there was no time for them")
        return None
    count = 1 + sum(len(layer.masks) for layer in layers)
    search.spend(count * network.size * _NOMINAL)
    search.add_reason(f"order and time allow {count} sets of {int(pruned.steps.sum())} steps")
    return layers


class HeldKarp:
    """Goes through all sets, where the soonest is always the best: where there is no battery, and
    the waiting for windows counts."""

    name = "Held-Karp"

    def supports(self, problem: RouteProblem, /) -> bool:
        return problem.battery is None and not problem.waits

    def solve(self, search: Search, /) -> None:
        layers = small_layers(search)
        if layers is None:
            return
        best = best_path(search.network, layers, search.pruned)
        if best is None:
            search.report_infeasible()
            return
        search.offer(best.path)
        found = search.best
        assert found is not None
        search.report_bounds(best.prize, found.cost, best.prize)


@dataclass(frozen=True)
class BestPath:
    """A path that wins the most, and among those is the soonest at the end."""

    path: tuple[int, ...]
    prize: int
    end: int


def soonest_layers(
    network: StepNetwork, pruned: Pruned, most: int, over: Callable[[], bool]
) -> list[Layer] | None:
    """The layers of a network whose battery is never empty; None if they have more than `most`
    sets, or the time is over before."""
    arcs = arcs_of(network, pruned, shortest(network))
    latest = np.minimum(pruned.latest, INF - 1)
    earliest = network.earliest[network.step]
    layers, total = [], 0
    for layer in soonest(network, Bits(network, pruned), arcs, earliest, latest, over):
        total += len(layer.masks)
        if total > most:
            return None
        layers.append(layer)
    return None if over() else layers


def best_path(network: StepNetwork, layers: list[Layer], pruned: Pruned) -> BestPath | None:
    """The best path that the layers hold; None: there is none."""
    best = _best_end(network, Bits(network, pruned), layers)
    if best is None:
        return None
    prize, end, number, row, node = best
    arcs = arcs_of(network, pruned, shortest(network))
    return BestPath(_path(network, arcs, layers, number, row, node), prize, end)


def arcs_of(network: StepNetwork, pruned: Pruned, times: NDArray[np.int64]) -> NDArray[np.int32]:
    """The arcs that are left, INF for the others; to the end from everywhere."""
    arcs = np.minimum(times, INF).astype(np.int32)
    allowed = pruned.arcs.copy()
    allowed[network.size, network.size] = True
    arcs[~allowed] = INF
    return arcs


def soonest(
    network: StepNetwork,
    bits: Bits,
    arcs: NDArray[np.int32],
    earliest: Masks,
    latest: Masks,
    over: Callable[[], bool] = lambda: False,
) -> Iterator[Layer]:
    """The layers from that of the first steps on, for arcs between nodes that begin when they may
    (`earliest`, `latest`, shape (m,)); not all of them when the time is over."""
    m, size = network.size, 0
    masks, times = np.zeros(1, np.int64), np.zeros((1, 1), np.int32)
    onward = arcs[m:, :]  # from the start; afterwards from all nodes
    while True:
        rules = bits.layer(size)
        origins, parts, ends = [], [], []
        nodes = np.flatnonzero(rules.open).tolist()
        for node in nodes:
            if over():
                return
            rows = rules.rows(masks, node)
            arrival = (times[rows] + onward[None, :, node]).min(axis=1)
            begin = np.maximum(arrival, earliest[node])
            in_time = begin <= latest[node]
            origins.append(rows[in_time])
            parts.append(rules.after(masks[rows[in_time]], node))
            ends.append(begin[in_time] + network.service[node])
        masks, place = np.unique(np.concatenate([*parts, masks[:0]]), return_inverse=True)
        if not len(masks):
            return
        size += 1
        times = np.full((len(masks), m), INF, np.int32)
        origin = np.full((len(masks), m), -1, np.int32)
        first = 0
        for node, rows, end in zip(nodes, origins, ends, strict=True):
            there = place[first : first + len(end)]
            times[there, node], origin[there, node] = end, rows
            first += len(end)
        keep = _in_time(network, bits, latest, size, masks, times)
        masks, times, origin = masks[keep], times[keep], origin[keep]
        yield Layer(masks, times, origin)
        onward = arcs[:m, :]


def ends(network: StepNetwork, arcs: NDArray[np.int32], layer: Layer) -> Masks:
    """The soonest time at the end for each set of a layer."""
    home = arcs[: network.size, network.size]
    return np.asarray((layer.times + home).min(axis=1), np.int64)


def _in_time(
    network: StepNetwork,
    bits: Bits,
    latest: Masks,
    size: int,
    masks: Masks,
    times: NDArray[np.int32],
) -> NDArray[np.bool_]:
    """Whether each mandatory step that is still to be made can begin in time."""
    at = times.min(axis=1)
    keep = np.ones(len(masks), np.bool_)
    last = np.full(len(network.prize), -1, np.int64)
    np.maximum.at(last, network.step, latest)
    doubt, sure = bits.in_doubt(size), bits.surely(size)
    ahead = network.mandatory & ~sure & (last < INF - 1)
    keep &= at <= last[ahead & ~doubt].min(initial=int(INF))
    for s in np.flatnonzero(ahead & doubt).tolist():
        keep &= (masks & bits.bit(s) != 0) | (at <= last[s])
    return keep


def prizes(network: StepNetwork, masks: Masks) -> Masks:
    """What the steps of each set are worth; everything where nothing may be left out."""
    if not network.selective:
        return np.full(len(masks), network.prize.sum())
    total = np.zeros(len(masks), np.int64)
    for s, prize in enumerate(network.prize.tolist()):
        total += ((masks >> s) & 1) * prize
    return total


def may_end(network: StepNetwork, bits: Bits, size: int, masks: Masks) -> NDArray[np.bool_]:
    """Whether sets of that size have all that must be made."""
    if not network.selective:
        return np.full(len(masks), size == len(network.prize))
    all_of = bits.mask(network.mandatory)
    return np.asarray((masks & all_of) == all_of)


def _best_end(
    network: StepNetwork, bits: Bits, layers: list[Layer]
) -> tuple[int, int, int, int, int] | None:
    """The prize, end, layer, row and last node of the best path; layer -1: straight to the end."""
    m = network.size
    home = np.minimum(shortest(network)[:, m], INF).astype(np.int32)
    limit = min(network.limit, int(INF) - 1)
    none = may_end(network, bits, 0, np.zeros(1, np.int64)).all()
    best = (0, -int(home[m]), -1, 0, 0) if none and home[m] <= limit else None
    for number, layer in enumerate(layers):
        whole = layer.times + home[:m]
        nodes = whole.argmin(axis=1)
        end = whole[np.arange(len(whole)), nodes].astype(np.int64)
        rows = np.flatnonzero(may_end(network, bits, number + 1, layer.masks) & (end <= limit))
        if not len(rows):
            continue
        won = prizes(network, layer.masks[rows])
        pick = int(np.lexsort((end[rows], -won))[0])
        row = int(rows[pick])
        one = (int(won[pick]), -int(end[row]), number, row, int(nodes[row]))
        best = one if best is None else max(best, one, key=lambda end: end[:2])
    return None if best is None else (best[0], -best[1], *best[2:])


def _path(
    network: StepNetwork,
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
    while number > 0:
        row = int(layers[number].origin[row, node])
        number -= 1
        times = layers[number].times[row]
        node = int((times + arcs[: network.size, node]).argmin())
        path.append(node)
    return tuple(reversed(path))
