"""Beams of labels: where the robot may be after so many steps, with two measures of how it got
there, and of those only the most promising."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.held_karp import INF, prizes
from argo_compiler.route.lower_bounds import LowerBound
from argo_compiler.route.network import StepNetwork
from argo_compiler.route.order_ideals import Bits
from argo_compiler.route.problem import NEVER, Objective
from argo_compiler.route.pruning import Pruned
from argo_compiler.route.search import Search
from argo_compiler.route.solution import LabelSolution

Vector = NDArray[np.int64]

_NODE, _LABEL = 1e-4, 1.5e-6
"""s for a node, and for each label that is gone on from to it"""
_DIRECT = -1
"""charger of a way without a charge"""


@dataclass(frozen=True, eq=False)
class Beam:
    """What a beam has found."""

    path: tuple[int, ...] | None
    charges: dict[int, int]
    complete: bool
    """whether nothing was dropped that might have led to a better path"""
    bound: int
    """no path costs less, unless it is the best known one"""


@dataclass(frozen=True, eq=False)
class _Labels:
    """Those of one layer: where the robot may be after so many steps."""

    mask: Vector
    last: Vector
    time: Vector
    other: Vector
    parent: Vector
    charger: Vector

    def take(self, rows: NDArray[np.int64] | NDArray[np.bool_]) -> "_Labels":
        parts = (self.mask, self.last, self.time, self.other, self.parent, self.charger)
        return _Labels(*(part[rows] for part in parts))


class Space:
    """What all beams that have the same guide share: its method `beam` is one search."""

    def __init__(
        self, network: StepNetwork, pruned: Pruned, bits: Bits, guide: LowerBound, *, level: bool
    ) -> None:
        """`level`: whether all routes that there are win the same: then cost counts."""
        self._network, self._pruned = network, pruned
        self._bits, self._guide, self._level = bits, guide, level
        self._battery = network.problem.battery
        # The other measure: energy, or travel where that is not the time as well.
        self._counts_travel = network.problem.waits

    def beam(self, width: int, best: LabelSolution | None, search: Search) -> Beam:
        """The best path of a search that keeps the `width` most promising labels of a layer."""
        upper = None if best is None or best.path is None else (best.prize, best.cost)
        layers = [self._start()]
        lost: int | None = None  # the least cost of the labels that were dropped
        end: tuple[tuple[int, int], int, int, int] | None = None
        for number in range(len(self._network.prize) + 1):
            labels = layers[number]
            if not len(labels.mask):
                break
            one = self._best_end(number, labels)
            if one is not None and (end is None or one[0] > end[0]):
                end = one
                if upper is None or one[0] > (upper[0], -upper[1]):
                    upper = one[0][0], -one[0][1]
            if number == len(self._network.prize):
                break
            following = self._next(number, labels, upper, search)
            if following is None:  # the time is over
                lost = 0
                break
            labels, least = following
            if len(labels.mask) > width:
                keep = np.sort(np.argsort(least, kind="stable")[:width])
                dropped = int(np.delete(least, keep).min())
                lost = dropped if lost is None else min(lost, dropped)
                labels = labels.take(keep)
            layers.append(labels)
        known = NEVER if upper is None else upper[1]
        bound = min(known, NEVER if lost is None else lost)
        bound = 0 if bound >= NEVER or not self._level else bound
        if end is None:
            return Beam(None, {}, lost is None, bound)
        path, charges = self._path(layers, *end[1:])
        return Beam(path, charges, lost is None, bound)

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
            more = way + service if self._counts_travel else 0
            yield self._leg(rows, time + way, other + more, way < NEVER, _DIRECT)
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
        self, number: int, labels: _Labels, upper: tuple[int, int] | None, search: Search
    ) -> tuple[_Labels, Vector] | None:
        """The labels of the next layer that may lead to a better path, and the least that a path
        of each can cost; None if the time is over before."""
        network, pruned = self._network, self._pruned
        rules = self._bits.layer(number)
        parts = [labels.take(np.zeros(0, np.int64))]
        for node in range(network.size):
            if search.remaining() <= 0.0:
                return None
            rows = rules.rows(labels.mask, node)
            rows = rows[pruned.arcs[labels.last[rows], node]]
            search.spend(_NODE + _LABEL * len(rows))
            earliest = int(network.earliest[network.step[node]])
            for origin, time, other, charger in self._legs(labels, rows, node):
                begin = np.maximum(time, earliest)
                fits = begin <= pruned.latest[node]
                origin = origin[fits]
                masks = rules.after(labels.mask[origin], node)
                time = begin[fits] + network.service[node]
                one = _Labels(
                    masks, np.full(len(origin), node), time, other[fits], origin, charger[fits]
                ).take(self._guide.within(number + 1, masks))
                if len(one.mask):
                    parts.append(one.take(self._promising(number + 1, one, upper)))
        fields = ("mask", "last", "time", "other", "parent", "charger")
        joined = _Labels(*(np.concatenate([getattr(p, f) for p in parts]) for f in fields))
        if not len(joined.mask):
            return joined, joined.time
        kept = joined.take(_undominated(joined))
        return kept, self._least(number + 1, kept)

    def _ends(self, number: int, labels: _Labels) -> Vector:
        """The soonest time at the end that a path of each label can have."""
        guide = self._guide.to_come(number, labels.mask, labels.last)
        end = labels.time + guide[0]
        if len(guide) > 1:
            assert self._battery is not None
            charged = labels.time + labels.other + guide[1] - self._battery.capacity
            end = np.maximum(end, charged)
        return np.asarray(end, np.int64)

    def _least(self, number: int, labels: _Labels) -> Vector:
        """The least cost of a path of each label."""
        if self._counts_travel:
            to_come = self._guide.to_come(number, labels.mask, labels.last)
            return np.asarray(labels.other + to_come[0])
        return self._ends(number, labels)

    def _promising(
        self, number: int, labels: _Labels, upper: tuple[int, int] | None
    ) -> NDArray[np.bool_]:
        """Whether labels may lead to a path that is better than the best known one."""
        last = min(self._network.limit, int(INF) - 1)
        promising = self._ends(number, labels) <= last
        if upper is not None and self._level:
            promising &= self._least(number, labels) < upper[1]
        return promising

    def _best_end(
        self, number: int, labels: _Labels
    ) -> tuple[tuple[int, int], int, int, int] | None:
        """Prize and cost (negative), layer, label and charger of the best path that ends here."""
        network = self._network
        masks = labels.mask
        rows = np.flatnonzero(self._guide.may_end(number, masks))
        best = None
        for origin, time, other, charger in self._legs(labels, rows, network.size):
            fits = time <= network.limit
            if not fits.any():
                continue
            won = prizes(network, masks[origin[fits]])
            costs = (other if self._counts_travel else time)[fits]
            if network.objective is Objective.PRIZE:
                costs = np.zeros_like(costs)
            k = int(np.lexsort((costs, -won))[0])
            worth = int(won[k]), -int(costs[k])
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


def _undominated(labels: _Labels) -> NDArray[np.int64]:
    """The rows of the labels than which none with the same set and last node is as good in both
    measures, in the order of sets, nodes and times."""
    if not len(labels.mask):
        return np.zeros(0, np.int64)
    order = np.lexsort((labels.other, labels.time, labels.last, labels.mask))
    mask, last = labels.mask[order], labels.last[order]
    changes = (np.diff(mask, prepend=mask[0]) != 0) | (np.diff(last, prepend=last[0]) != 0)
    group = np.cumsum(changes)
    # Shifted down from group to group, the smallest so far is that of the group.
    span = int(labels.other.max()) + 1
    shifted = labels.other[order] - group * span
    smallest = np.minimum.accumulate(shifted)
    first = np.diff(group, prepend=-1) != 0
    better = np.append(True, shifted[1:] < smallest[:-1])
    return np.asarray(order[first | better])
