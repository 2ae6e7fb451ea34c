"""Dynamic programming with two measures: time, and energy since the last charge or travel.

Where the soonest is not always the best (a battery to be charged on the way; waiting that does not
count), each set and last node has many labels, of which none is better in both measures. Labels
that can't lead to a better route than the best known one are dropped: what is still to come is
known from the problem without windows and battery. Narrow beams, wider from one to the next, find
routes; one that had to drop nothing for its width proves the best.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.completion import INF, Sets, all_sets, to_come
from argo_compiler.route.found import Found, found, none_found
from argo_compiler.route.network import Network
from argo_compiler.route.problem import NEVER, Objective
from argo_compiler.route.progress import Search
from argo_compiler.route.pruning import Pruned, shortest
from argo_compiler.route.subsets import MOST_STEPS, rules

Vector = NDArray[np.int64]

WIDTHS = (300, 3_000, 30_000, 300_000, 2_000_000)
"""labels in a layer, from one beam to the next"""
_DIRECT = -1


def applies(network: Network) -> bool:
    """Whether two measures are enough."""
    waits = network.objective is Objective.TRAVEL and network.windowed
    return len(network.prize) <= MOST_STEPS and not (waits and network.problem.battery is not None)


def solve_labels(
    network: Network, pruned: Pruned, search: Search, start: Found | None = None
) -> Found:
    """The best path that the beams find until the deadline, and its bounds."""
    if not pruned.possible:
        return none_found(network, proven=True)
    space = _Space(network, pruned)
    best, prize_bound, bound = start, int(network.prize[pruned.steps].sum()), 0
    for width in WIDTHS:
        beam = space.beam(width, best, search)
        if beam.path is not None:
            one = found(network, beam.path, beam.charges, prize_bound, 0)
            if one.better_than(best):
                best = one
                search.route(one.prize, one.cost)
        if beam.complete:
            if best is None or best.path is None:
                return none_found(network, proven=True)
            return found(network, best.path, best.charges, best.prize, best.cost)
        bound = max(bound, beam.bound)
        if not network.selective:
            search.known(bound=bound)
        if search.left() <= 0.0:
            break
    if best is None or best.path is None:
        return none_found(network, proven=False, bound=bound)
    return found(network, best.path, best.charges, prize_bound, bound)


@dataclass(frozen=True, eq=False)
class _Beam:
    path: tuple[int, ...] | None
    charges: dict[int, int]
    complete: bool
    """whether nothing was dropped that might have led to a better path"""
    bound: int
    """no path costs less, unless it is the best known one"""


@dataclass(frozen=True, eq=False)
class _Labels:
    """Those of one layer. `set`: the row of their set in the layer's list of sets."""

    set: Vector
    last: Vector
    time: Vector
    other: Vector
    parent: Vector
    charger: Vector

    def take(self, rows: NDArray[np.int64] | NDArray[np.bool_]) -> "_Labels":
        parts = (self.set, self.last, self.time, self.other, self.parent, self.charger)
        return _Labels(*(part[rows] for part in parts))


class _Space:
    """What all beams of a network share."""

    def __init__(self, network: Network, pruned: Pruned) -> None:
        self._network, self._pruned = network, pruned
        self._rules = rules(network, pruned)
        steps = range(len(network.prize))
        nodes = [network.nodes_of(s)[0] for s in steps if network.nodes_of(s)]
        self._sets: Sets = all_sets(self._rules, nodes)
        self._battery = network.problem.battery
        self._travels = self._battery is None  # the other measure: travel, else energy
        self._guides = [] if network.selective else self._make_guides()
        must = np.flatnonzero(network.mandatory).astype(np.int64)
        self._must = np.int64((np.int64(1) << must).sum())

    def _make_guides(self) -> list[list[NDArray[np.int32]]]:
        """What is still to come at least: in time, and in time and energy together."""
        network, pruned = self._network, self._pruned
        service = np.append(network.service, 0)
        time = np.minimum(shortest(network) + service[None, :], INF).astype(np.int32)
        time[~pruned.arcs] = INF
        if not len(network.prize):
            time = np.minimum(network.time, INF).astype(np.int32)
        guides = [to_come(network, self._rules, self._sets, time)]
        if self._battery is not None and network.chargers:
            assert network.energy is not None
            both = network.time + network.energy
            for station in network.chargers:
                way = station.to[:, None] + station.out[None, :] + self._battery.overhead
                both = np.minimum(
                    both, way + station.to_energy[:, None] + station.out_energy[None, :]
                )
            both = np.minimum(both + service[None, :], INF).astype(np.int32)
            both[~pruned.arcs] = INF
            guides.append(to_come(network, self._rules, self._sets, both))
        return guides

    def beam(self, width: int, best: Found | None, search: Search) -> _Beam:
        """The best path of a search that keeps the `width` most promising labels of a layer."""
        network = self._network
        upper = None if best is None or best.path is None else (best.prize, best.cost)
        layers = [self._start()]
        complete, bound = True, None
        end: tuple[tuple[int, int], int, int, int] | None = None
        for number in range(len(self._sets.layers)):
            labels = layers[number]
            one = self._best_end(number, labels)
            if one is not None and (end is None or one[0] > end[0]):
                end = one
                if upper is None or (one[0][0], -one[0][1]) > (upper[0], -upper[1]):
                    upper = one[0][0], -one[0][1]
            if number + 1 == len(self._sets.layers):
                break
            labels, least = self._next(number, labels, upper)
            if len(labels.set) > width or search.left() <= 0.0:
                keep = np.sort(np.argsort(least, kind="stable")[:width])
                complete = False
                lost = np.delete(least, keep).min(initial=NEVER)
                bound = lost if bound is None else min(bound, lost)
                labels = labels.take(keep)
            layers.append(labels)
        known = NEVER if upper is None else upper[1]
        least_cost = 0 if network.selective else int(min(known, bound or known))
        if end is None:
            return _Beam(None, {}, complete, least_cost if bound is not None else 0)
        path, charges = self._path(layers, *end[1:])
        return _Beam(path, charges, complete, least_cost)

    def _start(self) -> _Labels:
        used = 0 if self._battery is None else self._battery.used
        zero = np.zeros(1, np.int64)
        at = np.array([self._network.size])
        return _Labels(zero, at, zero, np.array([used]), zero - 1, zero + _DIRECT)

    def _legs(self, labels: _Labels, rows: Vector, node: int) -> Iterator[tuple[Vector, ...]]:
        """The ways from labels to a node (m: the end): rows, arrival, other measure, charger."""
        network, battery = self._network, self._battery
        last, time, other = labels.last[rows], labels.time[rows], labels.other[rows]
        way = network.time[last, node]
        if battery is None:
            service = int(network.service[node]) if node < network.size else 0
            there = way < NEVER
            yield self._leg(rows, time + way, other + way + service, there, _DIRECT)
            return
        assert network.energy is not None
        used = other + network.energy[last, node]
        there = (way < NEVER) & (used <= battery.capacity)
        yield self._leg(rows, time + way, used, there, _DIRECT)
        for number, station in enumerate(network.chargers):
            at = other + station.to_energy[last]
            way = station.to[last] + station.out[node]
            after = np.full(len(rows), station.out_energy[node])
            there = (way < NEVER) & (at <= battery.capacity) & (after <= battery.capacity)
            yield self._leg(rows, time + way + battery.overhead + at, after, there, number)

    @staticmethod
    def _leg(
        rows: Vector, time: Vector, other: Vector, there: NDArray[np.bool_], charger: int
    ) -> tuple[Vector, ...]:
        chargers = np.full(int(there.sum()), charger)
        return rows[there], time[there], other[there], chargers

    def _next(
        self, number: int, labels: _Labels, upper: tuple[int, int] | None
    ) -> tuple[_Labels, Vector]:
        """The labels of the next layer that may lead to a better path, and the least that a path
        of each can cost."""
        network, pruned = self._network, self._pruned
        masks, after = self._sets.layers[number], self._sets.layers[number + 1]
        parts: list[_Labels] = []
        of_label = masks[labels.set]
        for node in range(network.size):
            rows = self._rules.rows(of_label, node)
            rows = rows[pruned.arcs[labels.last[rows], node]]
            earliest = int(network.earliest[network.step[node]])
            for origin, time, other, charger in self._legs(labels, rows, node):
                begin = np.maximum(time, earliest)
                fits = begin <= pruned.latest[node]
                origin = origin[fits]
                sets = np.searchsorted(after, of_label[origin] | self._rules.bit[node])
                ends = begin[fits] + network.service[node]
                one = _Labels(
                    sets, np.full(len(origin), node), ends, other[fits], origin, charger[fits]
                )
                keep = self._promising(number + 1, one, upper)
                parts.append(one.take(keep))
        fields = ("set", "last", "time", "other", "parent", "charger")
        joined = _Labels(*(np.concatenate([getattr(p, f) for p in parts]) for f in fields))
        kept = joined.take(_undominated(joined, network.size))
        return kept, self._least(number + 1, kept)

    def _least(self, number: int, labels: _Labels) -> Vector:
        """The least cost of a path of each label; with something optional, how much it lacks."""
        if self._network.selective:
            made = self._prizes(self._sets.layers[number])[labels.set]
            rate = int(self._network.prize.sum()) / max(1, int(self._network.service.sum()) + 1)
            return np.asarray(labels.time * rate - made, np.int64)
        guides = [guide[number][labels.set, labels.last] for guide in self._guides]
        if self._travels:
            return np.asarray(self._cost(labels) + guides[0], np.int64)
        least = labels.time + guides[0]
        if len(guides) > 1:
            assert self._battery is not None
            charged = labels.time + labels.other + guides[1] - self._battery.capacity
            least = np.maximum(least, charged)
        return np.asarray(least, np.int64)

    def _cost(self, labels: _Labels) -> Vector:
        """What the objective makes small, so far."""
        travel = self._network.objective is Objective.TRAVEL and self._travels
        return labels.other if travel else labels.time

    def _promising(
        self, number: int, labels: _Labels, upper: tuple[int, int] | None
    ) -> NDArray[np.bool_]:
        """Whether labels may lead to a path that is better than the best known one."""
        if self._network.selective:
            if upper is None:
                return np.ones(len(labels.set), np.bool_)
            masks = self._sets.layers[number]
            most = (self._prizes(masks) + self._prizes_to_come(masks))[labels.set]
            home = shortest(self._network)[labels.last, self._network.size]
            return (most > upper[0]) | ((most == upper[0]) & (self._cost(labels) + home < upper[1]))
        least = self._least(number, labels)
        return least < (int(INF) if upper is None else min(upper[1], int(INF)))

    def _prizes(self, masks: Vector) -> Vector:
        total = np.zeros(len(masks), np.int64)
        for s, prize in enumerate(self._network.prize.tolist()):
            total += ((masks >> s) & 1) * prize
        return total

    def _prizes_to_come(self, masks: Vector) -> Vector:
        """The prizes of all that has not been made and could be."""
        possible = np.where(self._pruned.steps, self._network.prize, 0)
        total = np.zeros(len(masks), np.int64)
        for s, prize in enumerate(possible.tolist()):
            total += (((masks >> s) & 1) ^ 1) * prize
        return total

    def _best_end(
        self, number: int, labels: _Labels
    ) -> tuple[tuple[int, int], int, int, int] | None:
        """Prize and cost (negative), layer, label and charger of the best path that ends here."""
        network = self._network
        masks = self._sets.layers[number][labels.set]
        rows = np.flatnonzero((masks & self._must) == self._must)
        best = None
        for origin, time, other, charger in self._legs(labels, rows, network.size):
            fits = time <= network.limit
            if not fits.any():
                continue
            prizes = self._prizes(masks[origin[fits]])
            travel = network.objective is Objective.TRAVEL and self._travels
            costs = (other if travel else time)[fits]
            if network.objective is Objective.PRIZE:
                costs = np.zeros_like(costs)
            k = int(np.lexsort((costs, -prizes))[0])
            worth = int(prizes[k]), -int(costs[k])
            if best is None or worth > best[0]:
                best = worth, number, int(origin[fits][k]), int(charger[fits][k])
        return best

    def _path(
        self, layers: list[_Labels], number: int, row: int, charger: int
    ) -> tuple[tuple[int, ...], dict[int, int]]:
        charges = {} if charger == _DIRECT else {number: charger}
        path = []
        for k in range(number, 0, -1):
            labels = layers[k]
            path.append(int(labels.last[row]))
            if labels.charger[row] != _DIRECT:
                charges[k - 1] = int(labels.charger[row])
            row = int(labels.parent[row])
        return tuple(reversed(path)), charges


def _undominated(labels: _Labels, nodes: int) -> NDArray[np.int64]:
    """The rows of the labels than which none with the same set and last node is as good in both
    measures, in the order of sets, nodes and times."""
    if not len(labels.set):
        return np.zeros(0, np.int64)
    key = labels.set * nodes + labels.last
    order = np.lexsort((labels.other, labels.time, key))
    group = np.cumsum(np.diff(key[order], prepend=key[order[0]]) != 0)
    # Shifted down from group to group, the smallest so far is that of the group.
    span = int(labels.other.max()) + 1
    shifted = labels.other[order] - group * span
    smallest = np.minimum.accumulate(shifted)
    first = np.diff(group, prepend=-1) != 0
    better = np.append(True, shifted[1:] < smallest[:-1])
    return order[first | better]
