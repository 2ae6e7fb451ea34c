"""Dynamic programming with two measures: time, and energy since the last charge or travel.

Where the soonest is not always the best (a battery to be charged on the way; waiting that does not
count), each set and last node has many labels, of which none is better in both measures. Labels
that can't lead to a better route than the best known one are dropped: what is still to come is
known from the problem without windows and battery. Narrow beams, wider from one to the next, find
routes; one that had to drop nothing for its width proves the best.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.along import Follower
from argo_compiler.route.completion import Sets, sets_of, sets_towards
from argo_compiler.route.found import Found, found, none_found
from argo_compiler.route.guides import Guide, PriceGuide, TableGuide
from argo_compiler.route.masks import Bits
from argo_compiler.route.modes import plus
from argo_compiler.route.network import Network
from argo_compiler.route.problem import NEVER, Objective
from argo_compiler.route.progress import Search
from argo_compiler.route.pruning import Pruned, shortest
from argo_compiler.route.subsets import (
    INF,
    Layer,
    arcs_of,
    best_path,
    ends,
    may_end,
    prizes,
    soonest,
)

Vector = NDArray[np.int64]

WIDTHS = (300, 3_000, 30_000, 300_000, 2_000_000)
"""labels in a layer, from one beam to the next"""
_NARROWER = (1_000, 10_000, 100_000, 500_000)
"""the same where sets are not kept apart from labels"""
_DIRECT = -1
_FIRST_GOALS = 64
_MOST_OPTIONAL = 22
"""steps where something may be left out: then tables of all their subsets are made"""


def applies(network: Network) -> bool:
    """Whether two measures are enough."""
    waits = network.objective is Objective.TRAVEL and network.windowed
    few = not network.selective or len(network.prize) <= _MOST_OPTIONAL
    return few and not (waits and network.problem.battery is not None)


def solve_labels(network: Network, pruned: Pruned, search: Search, layers: list[Layer]) -> Found:
    """The best path that the beams find until the deadline, and its bounds. `layers`: those of the
    network without a battery."""
    start: Found | None = None
    soon = best_path(network, layers, pruned)
    if soon is None:
        return none_found(network, proven=True)
    # If the battery lasts for the best route without a battery, that is it.
    follower = Follower(network)
    stand = follower.follow(soon.path)
    if stand is not None:
        one = found(network, soon.path, dict(stand.charges), int(network.prize.sum()), 0)
        search.route(one.prize, one.cost)
        if stand.time == soon.end and network.objective is not Objective.TRAVEL:
            return found(network, soon.path, dict(stand.charges), soon.prize, one.cost)
        start = one
    if network.selective:
        return _by_prize(network, pruned, search, layers, start)
    bits = Bits(network, pruned)
    sets = [np.zeros(1, np.int64), *(layer.masks for layer in layers)]
    del layers
    space = _with_tables(network, pruned, sets_of(network, bits, sets))
    return _widening(network, space, search, WIDTHS, start)


def search_labels(network: Network, pruned: Pruned, search: Search, start: Found | None) -> Found:
    """The best path that the beams find until the deadline, and its bounds, with as many sets as
    there may be. For networks in which nothing may be left out, and whose steps `Bits` fit."""
    bits = Bits(network, pruned)
    kinds = _kinds(network)
    space = _Space(network, pruned, bits, PriceGuide(network, pruned, bits, kinds), level=True)
    return _widening(network, space, search, _NARROWER, start)


def _kinds(network: Network) -> list[Vector]:
    """The costs of arcs that bounds are made from: time, and time and energy together."""
    service = np.append(network.service, 0)[None, :]
    kinds = [plus(shortest(network), service)]
    if network.problem.battery is not None and network.chargers:
        kinds.append(plus(_times_and_energies(network), service))
    return kinds


def _with_tables(network: Network, pruned: Pruned, sets: Sets) -> "_Space":
    bits = Bits(network, pruned)
    kinds = np.stack([arcs_of(network, pruned, kind) for kind in _kinds(network)])
    guide = TableGuide(network, bits, sets, kinds)
    layers = zip(sets.layers, sets.last, strict=True)
    worth = np.concatenate([prizes(network, layer[last]) for layer, last in layers])
    return _Space(network, pruned, bits, guide, level=bool((worth == worth[:1]).all()))


def _widening(
    network: Network,
    space: "_Space",
    search: Search,
    widths: tuple[int, ...],
    start: Found | None,
) -> Found:
    """Beams, each wider than the one before, until one drops nothing or the time is over."""
    prize, bound, best = int(network.prize.sum()), 0, start
    for width in widths:
        beam = space.beam(width, best, search)
        best = _better(network, search, beam, best)
        if beam.complete:
            if best is None or best.path is None:
                return none_found(network, proven=True)
            return found(network, best.path, best.charges, prize, best.cost)
        bound = max(bound, beam.bound)
        search.known(bound=bound)
        if search.left() <= 0.0:
            break
    if best is None or best.path is None:
        return none_found(network, proven=False, bound=bound)
    return found(network, best.path, best.charges, prize, bound)


def _by_prize(
    network: Network,
    pruned: Pruned,
    search: Search,
    layers: list[Layer],
    start: Found | None,
) -> Found:
    """The sets that could be made in time without windows and battery, from those of the highest
    prize down, so many at once: which of them can be made, and then at which least cost."""
    goals, worth = _goals(network, pruned, layers)
    most, best, first, size = int(worth.max(initial=-1)), start, 0, _FIRST_GOALS
    while first < len(goals):
        search.known(prize_bound=most)
        # All of one prize stay together.
        lowest = worth[min(first + size, len(goals)) - 1]
        after = int(np.searchsorted(-worth, -lowest, side="right"))
        some, complete = goals[first:after], False
        for width in WIDTHS:
            # Once one is found, only what is worth more is of interest.
            if best is not None and best.path is not None:
                some = some[prizes(network, some) > best.prize]
            if not len(some):
                complete = True
                break
            space = _with_tables(network, pruned, sets_towards(some, len(network.prize)))
            beam = space.beam(width, None, search)
            best, complete = _better(network, search, beam, best), beam.complete
            if complete or search.left() <= 0.0:
                break
        if best is not None and best.path is not None and complete and best.prize >= lowest:
            return _cheapest(network, pruned, search, best, goals[worth == best.prize])
        if not complete:
            break
        first, size = after, size * 4
        most = int(worth[after]) if after < len(goals) else -1
    if best is None or best.path is None:
        return none_found(network, proven=most < 0)
    return found(network, best.path, best.charges, max(most, best.prize), 0)


def _cheapest(
    network: Network, pruned: Pruned, search: Search, best: Found, goals: Vector
) -> Found:
    """The cheapest path to any of the goals, which are all of those with the best prize."""
    search.known(prize_bound=best.prize)
    if network.objective is Objective.PRIZE:
        return found(network, best.path or (), best.charges, best.prize, 0)
    space = _with_tables(network, pruned, sets_towards(goals, len(network.prize)))
    cheapest = _widening(network, space, search, WIDTHS, best)
    return found(network, cheapest.path or (), cheapest.charges, best.prize, cheapest.bound)


def _better(network: Network, search: Search, beam: "_Beam", best: Found | None) -> Found | None:
    """The better of a beam's path and the best so far."""
    if beam.path is None:
        return best
    one = found(network, beam.path, beam.charges, int(network.prize.sum()), 0)
    if not one.better_than(best):
        return best
    search.route(one.prize, one.cost)
    return one


def _goals(network: Network, pruned: Pruned, layers: list[Layer]) -> tuple[Vector, Vector]:
    """The sets that may be all that is made, and their prizes, which fall: what can't be made in
    time is not among them, the time for charging what is used at least included."""
    limit, m = min(network.limit, int(INF) - 1), network.size
    arcs = arcs_of(network, pruned, shortest(network))
    goals, end = _soonest_ends(network, arcs, layers)
    may = may_end(network, Bits(network, pruned), 0, goals)
    goals = goals[may & (end <= limit)]
    battery = network.problem.battery
    if battery is not None and network.limit < INF:
        spared = battery.capacity - battery.used
        arcs = arcs_of(network, pruned, _times_and_energies(network))
        late = np.full(m, min(limit + spared, int(INF) - 1), np.int64)
        charged = soonest(network, Bits(network, pruned), arcs, np.zeros(m, np.int64), late)
        whole, end = _soonest_ends(network, arcs, charged)
        goals = np.intersect1d(goals, whole[end - spared <= limit], assume_unique=True)
    goals = np.sort(goals)
    worth = prizes(network, goals)
    order = np.argsort(-worth, kind="stable")
    return goals[order], worth[order]


def _soonest_ends(
    network: Network, arcs: NDArray[np.int32], layers: Iterable[Layer]
) -> tuple[Vector, Vector]:
    """All sets that can be made, and their soonest ends."""
    m = network.size
    masks, at_end = [np.zeros(1, np.int64)], [arcs[m:, m].astype(np.int64)]
    for layer in layers:
        masks.append(layer.masks)
        at_end.append(ends(network, arcs, layer))
    return np.concatenate(masks), np.concatenate(at_end)


def _times_and_energies(network: Network) -> NDArray[np.int64]:
    """The least time and energy together that each arc takes, straight or by a charger."""
    battery = network.problem.battery
    assert battery is not None
    assert network.energy is not None
    both = plus(network.time, network.energy)
    for station in network.chargers:
        way = plus(station.to, station.to_energy)[:, None]
        onward = plus(station.out, station.out_energy)[None, :]
        both = np.minimum(both, plus(way + onward, battery.overhead))
    return both


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


class _Space:
    """What all beams that have the same guide share."""

    def __init__(
        self, network: Network, pruned: Pruned, bits: Bits, guide: Guide, *, level: bool
    ) -> None:
        """`level`: whether all routes that there are win the same: then cost counts."""
        self._network, self._pruned = network, pruned
        self._bits, self._guide, self._level = bits, guide, level
        self._battery = network.problem.battery
        # The other measure: energy, or travel where that is not the time as well.
        self._travels = network.windowed and network.objective is Objective.TRAVEL

    def beam(self, width: int, best: Found | None, search: Search) -> _Beam:
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
            return _Beam(None, {}, lost is None, bound)
        path, charges = self._path(layers, *end[1:])
        return _Beam(path, charges, lost is None, bound)

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
            more = way + service if self._travels else 0
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
            if search.left() <= 0.0:
                return None
            rows = rules.rows(labels.mask, node)
            rows = rows[pruned.arcs[labels.last[rows], node]]
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
        if self._travels:
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
            costs = (other if self._travels else time)[fits]
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
