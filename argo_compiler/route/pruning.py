"""Which steps and arcs no route can have: what the solvers need not look at."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.network import StepNetwork, compose
from argo_compiler.route.problem import NEVER

_MOST_NODES = 300
"""whose shortest paths take no time worth speaking of"""


@dataclass(frozen=True, eq=False)
class Pruned:
    """What is left of a network."""

    arcs: NDArray[np.bool_]
    """shape (m + 1, m + 1): whether column may come right after row"""
    steps: NDArray[np.bool_]
    """whether a step may be made"""
    earliest: NDArray[np.int64]
    """when each node may begin at the soonest, shape (m,)"""
    latest: NDArray[np.int64]
    """when it must begin at the latest"""
    needs: NDArray[np.bool_]
    """`StepNetwork.needs` and what the windows add to it"""
    before: NDArray[np.bool_]
    """`StepNetwork.before` and what the windows add to it"""
    possible: bool
    """false: there is no route"""


def prune(network: StepNetwork) -> Pruned:
    """What is left when ways, precedence, windows and the limit are looked at arc by arc."""
    m, step = network.size, network.step
    best = shortest(network)
    earliest, latest = _windows(network, best)
    arcs: NDArray[np.bool_] = best < NEVER
    needs, before = _orders(network, earliest, latest)
    steps: NDArray[np.bool_] = _possible_steps(needs, before)
    alive = steps[step] & (earliest <= latest)
    np.fill_diagonal(arcs, False)
    arcs[:m, :m] &= step[:, None] != step[None, :]
    # Right after `row`, `column` must not be one that rules it out, nor one that some step between
    # them is needed for.
    between = compose(needs, needs)
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
    # `needs` is closed: what needs a step that can't be made can't be made either.
    steps &= ~(needs & ~steps[:, None]).any(axis=0)
    arcs[:m, :] &= steps[step][:, None]
    arcs[:, :m] &= steps[step][None, :]
    possible = bool(steps[network.mandatory].all())
    return Pruned(arcs, steps, earliest, latest, needs, before, possible)


def _orders(
    network: StepNetwork, earliest: NDArray[np.int64], latest: NDArray[np.int64]
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """The order between steps, and what follows from windows: if `column` can't be begun any more
    when `row` has been made at its soonest, it comes before it."""
    if not network.windowed and network.limit >= NEVER:
        return network.needs, network.before
    m, count = network.size, len(network.prize)
    apart = paths(network)
    late = earliest[:, None] + network.service[:, None] + apart > latest[None, :]
    too_late = np.ones((count, count), np.bool_)
    for i in range(m):
        np.logical_and.at(too_late, (network.step[i], network.step), late[i])
    np.fill_diagonal(too_late, False)
    before = network.before | too_late.T
    needs = network.needs | (too_late.T & network.mandatory[:, None])
    while True:
        wider = needs | compose(needs, needs)
        if (wider == needs).all():
            return needs, before | needs
        needs = wider


def shortest(network: StepNetwork) -> NDArray[np.int64]:
    """The times of the arcs, or by a charger where that is shorter than straight, without the time
    of charging itself: no way from row to column takes less."""
    best = network.time.copy()
    battery = network.problem.battery
    for station in network.chargers:
        assert battery is not None
        by_it = station.to[:, None] + battery.overhead + station.out[None, :]
        best = np.minimum(best, np.where(by_it >= NEVER, NEVER, by_it))
    return best


def horizon(network: StepNetwork) -> int:
    """A time when every route that does not wait longer than it must is at the end."""
    return min(network.limit, longest(network))


def longest(network: StepNetwork) -> int:
    """The same without the limit."""
    arcs = shortest(network)
    arcs = np.where(arcs >= NEVER, 0, arcs)
    total = int(np.append(network.service, 0).sum() + arcs.max(axis=0).sum())
    battery = network.problem.battery
    if battery is not None:
        ways = [int(np.where(s.to >= NEVER, 0, s.to).max()) for s in network.chargers]
        outs = [int(np.where(s.out >= NEVER, 0, s.out).max()) for s in network.chargers]
        charge = battery.capacity + battery.overhead + max(ways, default=0) + max(outs, default=0)
        total += charge * (len(network.prize) + 1)
    direct = int(network.time[:, :].max(initial=0, where=network.time < NEVER))
    total += direct * (len(network.prize) + 1)
    return int(network.earliest.max(initial=0)) + total


def _possible_steps(needs: NDArray[np.bool_], before: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Without the steps that would have to come before themselves, or need one that must."""
    # Of a circle of steps that are needed for each other, closed over, each needs itself.
    impossible = np.diagonal(before | needs)
    impossible = impossible | (needs & impossible[:, None]).any(axis=0)
    possible: NDArray[np.bool_] = ~impossible
    return possible


def _windows(
    network: StepNetwork, best: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """When each node may begin: no sooner than on the shortest way from the start, and no later
    than leaves time to get to the end. Ways need not keep the triangle inequality, so these are
    shortest paths, with services."""
    m = network.size
    graph = best.astype(np.float64)
    graph[:m, :] += network.service[:, None]
    graph[best >= NEVER] = np.inf
    # In the node m start and end are one; no path has a reason to go through it.
    ahead = _lengths(graph[m, :m], graph[:m, :m])
    back = _lengths(graph[:m, m], graph[:m, :m].T)
    soonest = np.where(np.isfinite(ahead), ahead, NEVER).astype(np.int64)
    left = np.where(np.isfinite(back), back, NEVER).astype(np.int64)
    earliest = np.maximum(network.earliest[network.step], soonest)
    limit = network.limit
    home = (
        np.where(left >= NEVER, -1, limit - left)
        if limit < NEVER
        else np.where(left >= NEVER, -1, NEVER)
    )
    return earliest, np.minimum(network.latest[network.step], home)


def paths(network: StepNetwork) -> NDArray[np.int64]:
    """At most the least time from the end of one node to the beginning of another, by whatever
    nodes, shape (m, m); that itself where there are not more than _MOST_NODES."""
    m = network.size
    least = shortest(network)[:m, :m]
    if m > _MOST_NODES:  # by another node, a way has at least two arcs
        np.fill_diagonal(least, NEVER)
        out = least.min(axis=1) + network.service.min()
        by_others: NDArray[np.int64] = out[:, None] + least.min(axis=0)
        return np.minimum(np.minimum(least, by_others), NEVER)
    for through in range(m):
        by_it = least[:, through, None] + network.service[through] + least[None, through, :]
        np.minimum(least, by_it, out=least)
    return np.minimum(least, NEVER)


def _lengths(first: NDArray[np.float64], onward: NDArray[np.float64]) -> NDArray[np.float64]:
    """The lengths of the shortest paths, from the lengths of their first arcs and of the others
    (E. W. Dijkstra, Numerische Mathematik 1, 1959)."""
    length, ahead = first.copy(), first.copy()
    for _ in range(len(length)):
        at = int(ahead.argmin())
        ahead[at] = np.inf
        by_it = length[at] + onward[at]
        ahead = np.where(by_it < length, by_it, ahead)
        length = np.minimum(length, by_it)
    return length
