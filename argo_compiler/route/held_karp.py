"""Exact dynamic programming over the sets of steps that may come first in a route.

This is Held and Karp's programme, computed in layers with NumPy. Layer k holds, for each set of k
steps that may come first (an ideal of the partial order) and each last node, the earliest time at
which the robot completes the node. To be earlier is never worse, so time windows, limits and
optional steps add no states. The limit of the method is the number of sets, which is counted first.

A step is a visit or a round, and a node one of the modes in which a step can be made (see
`argo_compiler.route.network`). A path is a route as a sequence of nodes. The best path wins the
highest prize and, among equal prizes, ends first.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from argo_compiler.base.message import Message
from argo_compiler.route.network import StepNetwork
from argo_compiler.route.order_ideals import Masks, StepBits
from argo_compiler.route.problem import RouteProblem
from argo_compiler.route.pruning import (
    Pruned,
    horizon_without_limit,
    least_arc_times_without_service,
)
from argo_compiler.route.search import Search

INF = np.int32(1 << 29)
"""number above any time"""
_MOST_SETS = 1_500_000
_MOST_STATES = 24_000_000
"""highest number of sets times nodes"""
_FEW_SETS = 30_000
"""number of sets that take almost no time; with more sets of unordered steps, CP-SAT is faster"""
_TIME_PER_STATE = 2e-7
"""nominal s for one set and one node"""


@dataclass(frozen=True, eq=False)
class Layer:
    """Sorted sets of k steps, and the earliest times at their last nodes, shape (sets, m)."""

    masks: Masks
    times: NDArray[np.int32]
    origin: NDArray[np.int32]
    """row of the set of k - 1 steps before each last node, shape of `times`"""


def count_sets_up_to(
    network: StepNetwork,
    pruned: Pruned,
    most: int,
    is_time_up: Callable[[], bool] = lambda: False,
) -> int:
    """Count the sets of steps that a route may have made at some moment, as the precedences allow.

    Returns a number above `most` if there are more than `most`, if they do not fit into masks, or
    if the time is up before the end.
    """
    bits = StepBits(network, pruned)
    if not bits.fits:
        return most + 1
    first_node = {int(step): node for node, step in reversed(list(enumerate(network.step)))}
    if bits.shared:
        return _count(bits, list(first_node.values()), most, is_time_up)
    # The number is the product over the components of the order that are independent.
    total = 1
    _, component = connected_components(pruned.needs, directed=False)
    for number in range(int(component.max(initial=-1)) + 1):
        nodes = [
            first_node[s] for s in np.flatnonzero(component == number).tolist() if s in first_node
        ]
        total *= _count(bits, nodes, most // total, is_time_up)
        if total > most:
            break
    return total


def _count(bits: StepBits, nodes: list[int], most: int, is_time_up: Callable[[], bool]) -> int:
    masks, total, size = np.zeros(1, np.int64), 1, 0
    while len(masks) and total <= most:
        if is_time_up():
            return most + 1
        rules = bits.layer(size)
        following = [
            rules.with_node(masks[rules.rows_node_may_follow(masks, node)], node)
            for node in nodes
            if rules.open[node]
        ]
        masks = np.unique(np.concatenate([*following, masks[:0]]))
        total, size = total + len(masks), size + 1
    return total


def layers_if_few(search: Search) -> list[Layer] | None:
    """Compute the layers of a search's network, or return None if they have too many sets.

    Always adds a reason to the search: the number of sets, or why there are no layers.
    """
    network, pruned = search.network, search.pruned
    most = min(_MOST_SETS, _MOST_STATES // max(1, network.node_count))
    share = search.with_time_share(0.7)
    if not search.timed:
        most = min(
            most, int(share.remaining_time() / (_TIME_PER_STATE * max(1, network.node_count)))
        )
    sets = count_sets_up_to(network, pruned, most, lambda: share.remaining_time() <= 0.0)
    is_ordered = network.has_windows or pruned.before.any() or network.problem.battery is not None
    # Windows may leave much fewer sets than the precedences do.
    is_few = sets <= (most if is_ordered else _FEW_SETS) or network.has_windows
    if not is_few or horizon_without_limit(network) >= INF or not StepBits(network, pruned).fits:
        search.add_reason(
            Message("{sum} steps allow too many sets to check all", sum=int(pruned.steps.sum()))
        )
        return None
    layers = compute_layers(network, pruned, most, lambda: share.remaining_time() <= 0.0)
    if layers is None:
        search.add_reason(
            Message("there are too many sets to check all, or the time was too short")
        )
        return None
    count = 1 + sum(len(layer.masks) for layer in layers)
    search.spend(count * network.node_count * _TIME_PER_STATE)
    search.add_reason(
        Message(
            "order and time allow {count} sets of {sum} steps",
            count=count,
            sum=int(pruned.steps.sum()),
        )
    )
    return layers


class HeldKarp:
    """Solver that enumerates all sets, for problems in which the earliest time is always best.

    These are problems without a battery, in which waiting for windows counts.
    """

    name = "Held-Karp"

    def supports(self, problem: RouteProblem, /) -> bool:
        return problem.battery is None and not problem.has_free_waiting

    def solve(self, search: Search, /) -> None:
        layers = layers_if_few(search)
        if layers is None:
            return
        best = best_path(search.network, layers, search.pruned)
        if best is None:
            search.report_infeasible()
            return
        search.offer(best.path)
        solution = search.best
        assert solution is not None
        search.report_bounds(best.prize, solution.cost, best.prize)


@dataclass(frozen=True)
class BestPath:
    """Path with the highest prize, and the earliest end at that prize."""

    path: tuple[int, ...]
    prize: int
    end: int


def compute_layers(
    network: StepNetwork, pruned: Pruned, most: int, is_time_up: Callable[[], bool]
) -> list[Layer] | None:
    """Compute the layers of a network, as if the battery was never empty.

    Returns None if they have more than `most` sets, or if the time is up before the end.
    """
    arcs = times_of_allowed_arcs(network, pruned, least_arc_times_without_service(network))
    latest = np.minimum(pruned.latest, INF - 1)
    earliest = network.earliest[network.step]
    layers, total = [], 0
    for layer in iter_layers(
        network, StepBits(network, pruned), arcs, earliest, latest, is_time_up
    ):
        total += len(layer.masks)
        if total > most:
            return None
        layers.append(layer)
    return None if is_time_up() else layers


def best_path(network: StepNetwork, layers: list[Layer], pruned: Pruned) -> BestPath | None:
    """Return the best path of the layers, or None if there is none.

    A path may end in any layer, if it has made all mandatory steps and is within the limit of time.
    It is traced back from its end.
    """
    best = _best_end(network, StepBits(network, pruned), layers)
    if best is None:
        return None
    prize, end, number, row, node = best
    arcs = times_of_allowed_arcs(network, pruned, least_arc_times_without_service(network))
    return BestPath(_trace_path(network, arcs, layers, number, row, node), prize, end)


def times_of_allowed_arcs(
    network: StepNetwork, pruned: Pruned, times: NDArray[np.int64]
) -> NDArray[np.int32]:
    """Return `times` for the unpruned arcs and that from start to end, and INF for the others."""
    arcs = np.minimum(times, INF).astype(np.int32)
    allowed = pruned.arcs.copy()
    allowed[network.node_count, network.node_count] = True
    arcs[~allowed] = INF
    return arcs


def iter_layers(
    network: StepNetwork,
    bits: StepBits,
    arcs: NDArray[np.int32],
    earliest: NDArray[np.int64],
    latest: NDArray[np.int64],
    is_time_up: Callable[[], bool] = lambda: False,
) -> Iterator[Layer]:
    """Yield the layers, from that of single steps on, until there are no more or the time is up.

    `arcs`: times of arcs, shape (m + 1, m + 1); `earliest`, `latest`: limits on the begin of each
    node, shape (m,).
    """
    m, size = network.node_count, 0
    masks, times = np.zeros(1, np.int64), np.zeros((1, 1), np.int32)
    onward = arcs[m:, :]  # from the start; afterwards from all nodes
    while True:
        rules = bits.layer(size)
        origins, parts, ends = [], [], []
        nodes = np.flatnonzero(rules.open).tolist()
        for node in nodes:
            if is_time_up():
                return
            rows = rules.rows_node_may_follow(masks, node)
            arrival = (times[rows] + onward[None, :, node]).min(axis=1)
            begin = np.maximum(arrival, earliest[node])
            in_time = begin <= latest[node]
            origins.append(rows[in_time])
            parts.append(rules.with_node(masks[rows[in_time]], node))
            ends.append(begin[in_time] + network.service[node])
        masks, inverse = np.unique(np.concatenate([*parts, masks[:0]]), return_inverse=True)
        if not len(masks):
            return
        size += 1
        times = np.full((len(masks), m), INF, np.int32)
        origin = np.full((len(masks), m), -1, np.int32)
        first = 0
        for node, rows, end in zip(nodes, origins, ends, strict=True):
            new_rows = inverse[first : first + len(end)]
            times[new_rows, node], origin[new_rows, node] = end, rows
            first += len(end)
        keep = _can_complete(network, bits, latest, size, masks, times)
        masks, times, origin = masks[keep], times[keep], origin[keep]
        yield Layer(masks, times, origin)
        onward = arcs[:m, :]


def earliest_ends_of_sets(
    network: StepNetwork, arcs: NDArray[np.int32], layer: Layer
) -> NDArray[np.int64]:
    """Return for each set of a layer the earliest end of a route that makes only its steps.

    It is at least INF if there is no such route.
    """
    to_end = arcs[: network.node_count, network.node_count]
    return np.asarray((layer.times + to_end).min(axis=1), np.int64)


def _can_complete(
    network: StepNetwork,
    bits: StepBits,
    latest: NDArray[np.int64],
    size: int,
    masks: Masks,
    times: NDArray[np.int32],
) -> NDArray[np.bool_]:
    """Return, for each set, whether it is early enough for each remaining mandatory step."""
    earliest = times.min(axis=1)
    keep = np.ones(len(masks), np.bool_)
    last = np.full(len(network.prize), -1, np.int64)
    np.maximum.at(last, network.step, latest)
    undecided, certain = bits.steps_in_only_some_sets(size), bits.steps_in_all_sets(size)
    ahead = network.mandatory & ~certain & (last < INF - 1)
    keep &= earliest <= last[ahead & ~undecided].min(initial=int(INF))
    for s in np.flatnonzero(ahead & undecided).tolist():
        keep &= (masks & bits.bit(s) != 0) | (earliest <= last[s])
    return keep


def prizes_of_sets(network: StepNetwork, masks: Masks) -> NDArray[np.int64]:
    """Return the sum of the prizes of each set of steps, shape (n,).

    If no step is optional, each sum is that of all steps, whatever the set.
    """
    if not network.selective:
        return np.full(len(masks), network.prize.sum())
    total = np.zeros(len(masks), np.int64)
    for s, prize in enumerate(network.prize.tolist()):
        total += ((masks >> s) & 1) * prize
    return total


def can_end(network: StepNetwork, bits: StepBits, size: int, masks: Masks) -> NDArray[np.bool_]:
    """Return, for each set of `size`, whether it contains all mandatory steps."""
    if not network.selective:
        return np.full(len(masks), size == len(network.prize))
    mandatory = bits.mask(network.mandatory)
    return np.asarray((masks & mandatory) == mandatory)


def _best_end(
    network: StepNetwork, bits: StepBits, layers: list[Layer]
) -> tuple[int, int, int, int, int] | None:
    """Return the prize, end time, layer, row and last node of the best path, or None.

    Layer -1 means that the path has no nodes.
    """
    m = network.node_count
    to_end = np.minimum(least_arc_times_without_service(network)[:, m], INF).astype(np.int32)
    limit = min(network.limit, int(INF) - 1)
    may_be_empty = can_end(network, bits, 0, np.zeros(1, np.int64)).all()
    best = (0, -int(to_end[m]), -1, 0, 0) if may_be_empty and to_end[m] <= limit else None
    for number, layer in enumerate(layers):
        totals = layer.times + to_end[:m]
        nodes = totals.argmin(axis=1)
        end = totals[np.arange(len(totals)), nodes].astype(np.int64)
        rows = np.flatnonzero(can_end(network, bits, number + 1, layer.masks) & (end <= limit))
        if not len(rows):
            continue
        prizes = prizes_of_sets(network, layer.masks[rows])
        pick = int(np.lexsort((end[rows], -prizes))[0])
        row = int(rows[pick])
        candidate = (int(prizes[pick]), -int(end[row]), number, row, int(nodes[row]))
        best = candidate if best is None else max(best, candidate, key=lambda end: end[:2])
    return None if best is None else (best[0], -best[1], *best[2:])


def _trace_path(
    network: StepNetwork,
    arcs: NDArray[np.int32],
    layers: list[Layer],
    number: int,
    row: int,
    node: int,
) -> tuple[int, ...]:
    """Return the nodes of the path to a last node, traced back from there."""
    if number < 0:
        return ()
    path = [node]
    while number > 0:
        row = int(layers[number].origin[row, node])
        number -= 1
        times = layers[number].times[row]
        node = int((times + arcs[: network.node_count, node]).argmin())
        path.append(node)
    return tuple(reversed(path))
