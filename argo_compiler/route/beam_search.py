"""Beam search over labels with two measures, which keeps only the most promising of each layer.

A label describes the beginning of a path: the set of its steps, its last node, the time at which
the node is completed, and a second measure. Layer k has the labels of sets of k steps; parameters
`size` are this number.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.held_karp import INF, prizes_of_sets
from argo_compiler.route.lower_bounds import CompletionBound
from argo_compiler.route.network import StepNetwork
from argo_compiler.route.order_ideals import StepBits
from argo_compiler.route.problem import NEVER, Objective
from argo_compiler.route.pruning import Pruned
from argo_compiler.route.search import Search
from argo_compiler.route.solution import LabelSolution

Vector = NDArray[np.int64]

_TIME_PER_NODE, _TIME_PER_LABEL = 1e-4, 1.5e-6
"""nominal s for a node, and for each label that is extended to it"""
_DIRECT = -1
"""number in place of a charger's for a leg without a charge"""


@dataclass(frozen=True, eq=False)
class BeamResult:
    """Best path of one beam search, with a bound."""

    path: tuple[int, ...] | None
    charges: dict[int, int]
    complete: bool
    """true if no label was dropped that might have led to a better path"""
    bound: int
    """lower bound on the cost of all paths, at most the cost of the best known one"""


@dataclass(frozen=True, eq=False)
class _Labels:
    """Labels of one layer, as arrays with one entry per label."""

    mask: Vector
    last: Vector
    time: Vector
    second: Vector
    """second measure: energy used since the last charge, or travel"""
    parent: Vector
    """row of the label in the layer before"""
    charger: Vector

    def select(self, rows: NDArray[np.int64] | NDArray[np.bool_]) -> "_Labels":
        parts = (self.mask, self.last, self.time, self.second, self.parent, self.charger)
        return _Labels(*(part[rows] for part in parts))


class BeamSearch:
    """Data that all beam searches with the same completion bound share; `run` is one search."""

    def __init__(
        self,
        network: StepNetwork,
        pruned: Pruned,
        bits: StepBits,
        bound: CompletionBound,
        *,
        equal_prizes: bool,
    ) -> None:
        """Store what all searches on the network share.

        Args:
            network: steps, nodes and travel times of the problem.
            pruned: steps and arcs of the network that a route can have.
            bits: bits of the network's steps, for sets of steps as bit masks.
            bound: lower bound on the remaining cost of a route.
            equal_prizes: True if all possible routes win the same prize, so that the cost decides.
        """
        self._network, self._pruned = network, pruned
        self._bits, self._bound, self._equal_prizes = bits, bound, equal_prizes
        self._battery = network.problem.battery
        # The second measure is travel if waiting costs nothing, otherwise energy.
        self._counts_travel = network.problem.has_free_waiting

    def run(self, width: int, best: LabelSolution | None, search: Search) -> BeamResult:
        """Search with at most the `width` most promising labels of each layer.

        `best`: the best known path, which the search tries to improve.
        """
        upper = None if best is None or best.path is None else (best.prize, best.cost)
        layers = [self._start()]
        least_dropped: int | None = None  # the least cost of the labels that were dropped
        end: tuple[tuple[int, int], int, int, int] | None = None
        for size in range(len(self._network.prize) + 1):
            labels = layers[size]
            if not len(labels.mask):
                break
            candidate = self._best_end(size, labels)
            if candidate is not None and (end is None or candidate[0] > end[0]):
                end = candidate
                if upper is None or candidate[0] > (upper[0], -upper[1]):
                    upper = candidate[0][0], -candidate[0][1]
            if size == len(self._network.prize):
                break
            following = self._next_layer(size, labels, upper, search)
            if following is None:  # the time is up
                least_dropped = 0
                break
            labels, least = following
            if len(labels.mask) > width:
                keep = np.sort(np.argsort(least, kind="stable")[:width])
                dropped = int(np.delete(least, keep).min())
                least_dropped = dropped if least_dropped is None else min(least_dropped, dropped)
                labels = labels.select(keep)
            layers.append(labels)
        best_cost = NEVER if upper is None else upper[1]
        bound = min(best_cost, NEVER if least_dropped is None else least_dropped)
        bound = 0 if bound >= NEVER or not self._equal_prizes else bound
        if end is None:
            return BeamResult(None, {}, least_dropped is None, bound)
        path, charges = self._trace_path(layers, *end[1:])
        return BeamResult(path, charges, least_dropped is None, bound)

    def _start(self) -> _Labels:
        used = 0 if self._battery is None else self._battery.used
        zero = np.zeros(1, np.int64)
        at = np.array([self._network.node_count])
        return _Labels(zero, at, zero, np.array([used]), zero - 1, zero + _DIRECT)

    def _legs(self, labels: _Labels, rows: Vector, node: int) -> Iterator[tuple[Vector, ...]]:
        """Yield the feasible legs from labels to a node (m: the end), straight or by a charger.

        Each item has the rows of its labels, their arrival times, their second measures (energy
        used since the last charge, or travel), and the charger.
        """
        network, battery = self._network, self._battery
        last, time, second = labels.last[rows], labels.time[rows], labels.second[rows]
        drive = network.time[last, node]
        if battery is None:
            service = int(network.service[node]) if node < network.node_count else 0
            more = drive + service if self._counts_travel else 0
            yield self._leg(rows, time + drive, second + more, drive < NEVER, _DIRECT)
            return
        assert network.energy is not None
        used = second + network.energy[last, node]
        feasible = (drive < NEVER) & (used <= battery.capacity)
        yield self._leg(rows, time + drive, used, feasible, _DIRECT)
        for number, station in enumerate(network.chargers):
            charged = second + station.to_energy[last]
            drive = station.to[last] + station.out[node]
            after = np.full(len(rows), station.out_energy[node])
            feasible = (drive < NEVER) & (charged <= battery.capacity) & (after <= battery.capacity)
            yield self._leg(
                rows, time + drive + battery.overhead + charged, after, feasible, number
            )

    @staticmethod
    def _leg(
        rows: Vector, time: Vector, second: Vector, feasible: NDArray[np.bool_], charger: int
    ) -> tuple[Vector, ...]:
        chargers = np.full(int(feasible.sum()), charger)
        return rows[feasible], time[feasible], second[feasible], chargers

    def _next_layer(
        self, size: int, labels: _Labels, upper: tuple[int, int] | None, search: Search
    ) -> tuple[_Labels, Vector] | None:
        """Return the undominated labels of the next layer that may lead to a better path.

        With them returns, for each, a lower bound on the cost of all paths that continue it.
        Returns None if the time is up before the end. `labels` are those of the present layer,
        whose paths have `size` steps. `upper` is the prize and cost of the best known path.
        """
        network, pruned = self._network, self._pruned
        rules = self._bits.layer(size)
        parts = [labels.select(np.zeros(0, np.int64))]
        for node in range(network.node_count):
            if search.remaining_time() <= 0.0:
                return None
            rows = rules.rows_node_may_follow(labels.mask, node)
            rows = rows[pruned.arcs[labels.last[rows], node]]
            search.spend(_TIME_PER_NODE + _TIME_PER_LABEL * len(rows))
            earliest = int(network.earliest[network.step[node]])
            for origin, time, second, charger in self._legs(labels, rows, node):
                begin = np.maximum(time, earliest)
                fits = begin <= pruned.latest[node]
                origin = origin[fits]
                masks = rules.with_node(labels.mask[origin], node)
                time = begin[fits] + network.service[node]
                extended = _Labels(
                    masks, np.full(len(origin), node), time, second[fits], origin, charger[fits]
                ).select(self._bound.can_occur_in_route(size + 1, masks))
                if len(extended.mask):
                    parts.append(extended.select(self._is_promising(size + 1, extended, upper)))
        fields = ("mask", "last", "time", "second", "parent", "charger")
        joined = _Labels(*(np.concatenate([getattr(p, f) for p in parts]) for f in fields))
        if not len(joined.mask):
            return joined, joined.time
        undominated = joined.select(_undominated(joined))
        return undominated, self._least_costs(size + 1, undominated)

    def _least_end_times(self, size: int, labels: _Labels) -> Vector:
        """Return, for each label, a lower bound on the end time of all paths that continue it.

        `size` is the number of steps in the paths of the labels.
        """
        remaining = self._bound.remaining_cost_bounds(size, labels.mask, labels.last)
        end = labels.time + remaining[0]
        if len(remaining) > 1:
            assert self._battery is not None
            charged = labels.time + labels.second + remaining[1] - self._battery.capacity
            end = np.maximum(end, charged)
        return np.asarray(end, np.int64)

    def _least_costs(self, size: int, labels: _Labels) -> Vector:
        """Return, for each label, a lower bound on the cost of all paths that continue it."""
        if self._counts_travel:
            remaining = self._bound.remaining_cost_bounds(size, labels.mask, labels.last)
            return np.asarray(labels.second + remaining[0])
        return self._least_end_times(size, labels)

    def _is_promising(
        self, size: int, labels: _Labels, upper: tuple[int, int] | None
    ) -> NDArray[np.bool_]:
        """Return, for each label, whether it may lead to a path better than the best known one."""
        last = min(self._network.limit, int(INF) - 1)
        promising = self._least_end_times(size, labels) <= last
        if upper is not None and self._equal_prizes:
            promising &= self._least_costs(size, labels) < upper[1]
        return promising

    def _best_end(self, size: int, labels: _Labels) -> tuple[tuple[int, int], int, int, int] | None:
        """Return the best path that ends after this layer, or None if there is none.

        It is described by its prize and negative cost, its layer, label and last charger.
        """
        network = self._network
        masks = labels.mask
        rows = np.flatnonzero(self._bound.can_end(size, masks))
        best = None
        for origin, time, second, charger in self._legs(labels, rows, network.node_count):
            fits = time <= network.limit
            if not fits.any():
                continue
            prizes = prizes_of_sets(network, masks[origin[fits]])
            costs = (second if self._counts_travel else time)[fits]
            if network.objective is Objective.PRIZE:
                costs = np.zeros_like(costs)
            k = int(np.lexsort((costs, -prizes))[0])
            value = int(prizes[k]), -int(costs[k])
            if best is None or value > best[0]:
                best = value, size, int(origin[fits][k]), int(charger[fits][k])
        return best

    def _trace_path(
        self, layers: list[_Labels], size: int, row: int, charger: int
    ) -> tuple[tuple[int, ...], dict[int, int]]:
        charges = {} if charger == _DIRECT else {size: charger}
        path = []
        for k in range(size, 0, -1):
            labels = layers[k]
            path.append(int(labels.last[row]))
            if labels.charger[row] != _DIRECT:
                charges[k - 1] = int(labels.charger[row])
            row = int(labels.parent[row])
        return tuple(reversed(path)), charges


def _undominated(labels: _Labels) -> NDArray[np.int64]:
    """Return the rows of the labels that no other one with the same set and last node dominates.

    One dominates another if it is not higher in time and in the second measure. The rows are in the
    order of sets, nodes and times.
    """
    if not len(labels.mask):
        return np.zeros(0, np.int64)
    order = np.lexsort((labels.second, labels.time, labels.last, labels.mask))
    mask, last = labels.mask[order], labels.last[order]
    changes = (np.diff(mask, prepend=mask[0]) != 0) | (np.diff(last, prepend=last[0]) != 0)
    group = np.cumsum(changes)
    # Each group is shifted below the one before, so that the running minimum restarts with it.
    span = int(labels.second.max()) + 1
    shifted = labels.second[order] - group * span
    smallest = np.minimum.accumulate(shifted)
    first = np.diff(group, prepend=-1) != 0
    better = np.append(True, shifted[1:] < smallest[:-1])
    return np.asarray(order[first | better])
