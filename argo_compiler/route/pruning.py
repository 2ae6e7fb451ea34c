"""Pruning of a network: removal of the steps and arcs that no route can have."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.network import StepNetwork, compose_relations
from argo_compiler.route.problem import NEVER

_MOST_NODES = 300
"""highest number of nodes whose shortest paths take almost no time to compute"""


@dataclass(frozen=True, eq=False)
class Pruned:
    """Steps, arcs, time windows and precedences of a network after pruning."""

    arcs: NDArray[np.bool_]
    """true if column may come directly after row, shape (m + 1, m + 1)"""
    steps: NDArray[np.bool_]
    """true if a route may make the step, shape (s,)"""
    earliest: NDArray[np.int64]
    """earliest begin of each node, shape (m,)"""
    latest: NDArray[np.int64]
    """latest begin of each node, shape (m,)"""
    needs: NDArray[np.bool_]
    """`StepNetwork.needs`, and the needs that follow from the windows"""
    before: NDArray[np.bool_]
    """`StepNetwork.before`, and the order that follows from the windows"""
    possible: bool
    """false if the pruning proves that there is no route"""


def prune(network: StepNetwork) -> Pruned:
    """Return what travel times, precedences, windows and the limit leave possible in a network."""
    m, step = network.node_count, network.step
    best = least_arc_times_without_service(network)
    earliest, latest = _windows(network, best)
    arcs: NDArray[np.bool_] = best < NEVER
    needs, before = _orders(network, earliest, latest)
    steps: NDArray[np.bool_] = _possible_steps(needs, before)
    alive = steps[step] & (earliest <= latest)
    np.fill_diagonal(arcs, False)
    arcs[:m, :m] &= step[:, None] != step[None, :]
    # `column` can't come directly after `row` if it must come before `row`, or if it needs a step
    # between the two.
    between = compose_relations(needs, needs)
    apart: NDArray[np.bool_] = np.logical_or(before.T, between)
    arcs[:m, :m] &= ~apart[step][:, step]
    arcs[m, :m] &= (needs.sum(axis=0) == 0)[step]
    arcs[:m, m] &= ((needs & network.mandatory).sum(axis=1) == 0)[step]
    begun = np.append(earliest + network.service, 0)
    arcs[:, :m] &= begun[:, None] + best[:, :m] <= latest[None, :]
    arcs[:m, m] &= begun[:m] + best[:m, m] <= network.limit
    arcs[:m, :] &= alive[:, None]
    arcs[:, :m] &= alive[None, :]
    reachable: NDArray[np.bool_] = np.zeros(len(steps), np.bool_)
    reachable[step[arcs[:, :m].any(axis=0) & arcs[:m, :].any(axis=1)]] = True
    steps &= reachable
    # `needs` is transitively closed, so one pass removes all steps that need a removed one.
    steps &= ~(needs & ~steps[:, None]).any(axis=0)
    arcs[:m, :] &= steps[step][:, None]
    arcs[:, :m] &= steps[step][None, :]
    possible = bool(steps[network.mandatory].all())
    return Pruned(arcs, steps, earliest, latest, needs, before, possible)


def _orders(
    network: StepNetwork, earliest: NDArray[np.int64], latest: NDArray[np.int64]
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return `needs` and `before` of the network, with what follows from the windows.

    If `column` is too late even after `row` at its earliest, it must come before `row`.
    """
    if not network.has_windows and network.limit >= NEVER:
        return network.needs, network.before
    m, count = network.node_count, len(network.prize)
    distances = path_time_lower_bounds(network)
    late = earliest[:, None] + network.service[:, None] + distances > latest[None, :]
    too_late = np.ones((count, count), np.bool_)
    for i in range(m):
        np.logical_and.at(too_late, (network.step[i], network.step), late[i])
    np.fill_diagonal(too_late, False)
    before = network.before | too_late.T
    needs = network.needs | (too_late.T & network.mandatory[:, None])
    while True:
        wider = needs | compose_relations(needs, needs)
        if (wider == needs).all():
            return needs, before | needs
        needs = wider


def least_arc_times_without_service(network: StepNetwork) -> NDArray[np.int64]:
    """Return the least time of each arc, straight or by a charger, without service and charging.

    It is a lower bound on the time from row to column, shape (m + 1, m + 1).
    """
    best = network.time.copy()
    battery = network.problem.battery
    for station in network.chargers:
        assert battery is not None
        by_charger = station.to[:, None] + battery.overhead + station.out[None, :]
        best = np.minimum(best, np.where(by_charger >= NEVER, NEVER, by_charger))
    return best


def horizon(network: StepNetwork) -> int:
    """Return an upper bound on the end of all routes that wait no longer than necessary."""
    return min(network.limit, horizon_without_limit(network))


def horizon_without_limit(network: StepNetwork) -> int:
    """Return the horizon of a network without its limit on the duration."""
    arcs = least_arc_times_without_service(network)
    arcs = np.where(arcs >= NEVER, 0, arcs)
    total = int(np.append(network.service, 0).sum() + arcs.max(axis=0).sum())
    battery = network.problem.battery
    if battery is not None:
        tos = [int(np.where(s.to >= NEVER, 0, s.to).max()) for s in network.chargers]
        outs = [int(np.where(s.out >= NEVER, 0, s.out).max()) for s in network.chargers]
        charge = battery.capacity + battery.overhead + max(tos, default=0) + max(outs, default=0)
        total += charge * (len(network.prize) + 1)
    direct = int(network.time[:, :].max(initial=0, where=network.time < NEVER))
    total += direct * (len(network.prize) + 1)
    return int(network.earliest.max(initial=0)) + total


def _possible_steps(needs: NDArray[np.bool_], before: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return, for each step, whether neither it nor a step it needs must come before itself."""
    # In the transitive closure, each step of a cycle needs itself.
    impossible = np.diagonal(before | needs)
    impossible = impossible | (needs & impossible[:, None]).any(axis=0)
    possible: NDArray[np.bool_] = ~impossible
    return possible


def _windows(
    network: StepNetwork, best: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the earliest and the latest begin of each node.

    The earliest is not before the end of the shortest path from the start; the latest leaves the
    time of the shortest path to the end. As arcs may violate the triangle inequality, these are
    shortest paths over any nodes, with their services.
    """
    m = network.node_count
    graph = best.astype(np.float64)
    graph[:m, :] += network.service[:, None]
    graph[best >= NEVER] = np.inf
    # Node m is both the start and the end, so no path needs to go through it.
    from_start = _shortest_path_lengths(graph[m, :m], graph[:m, :m])
    to_end = _shortest_path_lengths(graph[:m, m], graph[:m, :m].T)
    arrival = np.where(np.isfinite(from_start), from_start, NEVER).astype(np.int64)
    remaining = np.where(np.isfinite(to_end), to_end, NEVER).astype(np.int64)
    earliest = np.maximum(network.earliest[network.step], arrival)
    limit = network.limit
    latest = (
        np.where(remaining >= NEVER, -1, limit - remaining)
        if limit < NEVER
        else np.where(remaining >= NEVER, -1, NEVER)
    )
    return earliest, np.minimum(network.latest[network.step], latest)


def path_time_lower_bounds(network: StepNetwork) -> NDArray[np.int64]:
    """Return lower bounds on the time from the end of one node to the begin of another.

    Shape (m, m), by paths over any nodes. The bounds are the times of the shortest paths if the
    network has at most _MOST_NODES nodes.
    """
    m = network.node_count
    least = least_arc_times_without_service(network)[:m, :m]
    if m > _MOST_NODES:  # a path over another node has at least two arcs
        np.fill_diagonal(least, NEVER)
        out = least.min(axis=1) + network.service.min()
        by_others: NDArray[np.int64] = out[:, None] + least.min(axis=0)
        return np.minimum(np.minimum(least, by_others), NEVER)
    for through in range(m):
        by_node = least[:, through, None] + network.service[through] + least[None, through, :]
        np.minimum(least, by_node, out=least)
    return np.minimum(least, NEVER)


def _shortest_path_lengths(
    first: NDArray[np.float64], onward: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Compute the lengths of the shortest paths to all nodes, by Dijkstra's algorithm.

    `first`: length of the first arc to each node; `onward`: lengths of the arcs between nodes, from
    row to column (E. W. Dijkstra, Numerische Mathematik 1, 1959).
    """
    length, ahead = first.copy(), first.copy()
    for _ in range(len(length)):
        at = int(ahead.argmin())
        ahead[at] = np.inf
        by_node = length[at] + onward[at]
        ahead = np.where(by_node < length, by_node, ahead)
        length = np.minimum(length, by_node)
    return length
