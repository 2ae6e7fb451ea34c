"""Dynamic programming with two measures: time, and energy since the last charge or travel.

Where the soonest is not always the best (a battery to be charged on the way; waiting that does not
count), each set and last node has many labels, of which none is better in both measures. Labels
that can't lead to a better route than the best known one are dropped: what is still to come is
known from the problem without windows and battery. Narrow beams, wider from one to the next, find
routes; one that had to drop nothing for its width proves the best.
"""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.beam_search import Beam, Space
from argo_compiler.route.completion_bounds import Sets, sets_of, sets_towards
from argo_compiler.route.held_karp import (
    INF,
    Layer,
    arcs_of,
    best_path,
    ends,
    may_end,
    prizes,
    small_layers,
    soonest,
)
from argo_compiler.route.lower_bounds import PriceGuide, TableGuide
from argo_compiler.route.modes import plus
from argo_compiler.route.network import StepNetwork
from argo_compiler.route.order_ideals import Bits
from argo_compiler.route.path_timing import PathTiming
from argo_compiler.route.problem import Objective, RouteProblem
from argo_compiler.route.pruning import Pruned, longest, shortest
from argo_compiler.route.search import Search
from argo_compiler.route.solution import LabelSolution, make_solution, no_solution

Vector = NDArray[np.int64]

WIDTHS = (300, 3_000, 30_000, 300_000, 2_000_000)
"""labels in a layer, from one beam to the next"""
_NARROWER = (1_000, 10_000, 100_000, 500_000)
"""the same where sets are not kept apart from labels"""
_FIRST_GOALS = 64
_MOST_OPTIONAL = 22
"""steps where something may be left out: then tables of all their subsets are made"""


def _applies(problem: RouteProblem) -> bool:
    """Whether two measures are needed, and enough."""
    return problem.waits != (problem.battery is not None)


class Labels:
    """Goes through all sets, if they are few enough, with the labels of each."""

    name = "labels"

    def supports(self, problem: RouteProblem, /) -> bool:
        return _applies(problem)

    def solve(self, search: Search, /) -> None:
        network = search.network
        if network.selective and len(network.prize) > _MOST_OPTIONAL:
            return
        layers = small_layers(search)
        if layers is not None:
            _tell(search, solve_labels(network, search.pruned, search, layers))


class LabelBeams:
    """Beams of labels with prices for what is still to come, for any number of sets."""

    name = "beams of labels"

    def supports(self, problem: RouteProblem, /) -> bool:
        return _applies(problem) and not problem.selective

    def solve(self, search: Search, /) -> None:
        network, pruned = search.network, search.pruned
        if longest(network) < INF and Bits(network, pruned).fits:
            _tell(search, search_labels(network, pruned, search, None))


def _tell(search: Search, found: LabelSolution) -> None:
    if found.path is not None:
        search.offer(found.path, found.charges)
    elif found.proven:
        search.report_infeasible()
        return
    least = found.prize_bound if search.network.selective else 0
    search.report_bounds(found.prize_bound, found.bound, least)


def solve_labels(
    network: StepNetwork, pruned: Pruned, search: Search, layers: list[Layer]
) -> LabelSolution:
    """The best path that the beams find until the deadline, and its bounds. `layers`: those of the
    network without a battery."""
    start: LabelSolution | None = None
    soon = best_path(network, layers, pruned)
    if soon is None:
        return no_solution(network, proven=True)
    # If the battery lasts for the best route without a battery, that is it.
    timing = PathTiming(network)
    label = timing.follow(soon.path)
    if label is not None:
        one = make_solution(network, soon.path, dict(label.charges), int(network.prize.sum()), 0)
        search.offer(soon.path, dict(label.charges))
        if label.time == soon.end and network.objective is not Objective.TRAVEL:
            return make_solution(network, soon.path, dict(label.charges), soon.prize, one.cost)
        start = one
    if network.selective:
        return _by_prize(network, pruned, search, layers, start)
    bits = Bits(network, pruned)
    sets = [np.zeros(1, np.int64), *(layer.masks for layer in layers)]
    del layers
    space = _with_tables(network, pruned, sets_of(network, bits, sets))
    return _widening(network, space, search, WIDTHS, start)


def search_labels(
    network: StepNetwork, pruned: Pruned, search: Search, start: LabelSolution | None
) -> LabelSolution:
    """The best path that the beams find until the deadline, and its bounds, with as many sets as
    there may be. For networks in which nothing may be left out, and whose steps `Bits` fit."""
    bits = Bits(network, pruned)
    kinds = _kinds(network)
    space = Space(network, pruned, bits, PriceGuide(network, pruned, bits, kinds), level=True)
    return _widening(network, space, search, _NARROWER, start)


def _kinds(network: StepNetwork) -> list[Vector]:
    """The costs of arcs that bounds are made from: time, and time and energy together."""
    service = np.append(network.service, 0)[None, :]
    kinds = [plus(shortest(network), service)]
    if network.problem.battery is not None and network.chargers:
        kinds.append(plus(_times_and_energies(network), service))
    return kinds


def _with_tables(network: StepNetwork, pruned: Pruned, sets: Sets) -> Space:
    bits = Bits(network, pruned)
    kinds = np.stack([arcs_of(network, pruned, kind) for kind in _kinds(network)])
    guide = TableGuide(network, bits, sets, kinds)
    layers = zip(sets.layers, sets.last, strict=True)
    worth = np.concatenate([prizes(network, layer[last]) for layer, last in layers])
    return Space(network, pruned, bits, guide, level=bool((worth == worth[:1]).all()))


def _widening(
    network: StepNetwork,
    space: Space,
    search: Search,
    widths: tuple[int, ...],
    start: LabelSolution | None,
) -> LabelSolution:
    """Beams, each wider than the one before, until one drops nothing or the time is over."""
    prize, bound, best = int(network.prize.sum()), 0, start
    for width in widths:
        beam = space.beam(width, best, search)
        best = _better(network, search, beam, best)
        if beam.complete:
            if best is None or best.path is None:
                return no_solution(network, proven=True)
            return make_solution(network, best.path, best.charges, prize, best.cost)
        bound = max(bound, beam.bound)
        search.report_bounds(bound=bound)
        if search.remaining() <= 0.0:
            break
    if best is None or best.path is None:
        return no_solution(network, proven=False, bound=bound)
    return make_solution(network, best.path, best.charges, prize, bound)


def _by_prize(
    network: StepNetwork,
    pruned: Pruned,
    search: Search,
    layers: list[Layer],
    start: LabelSolution | None,
) -> LabelSolution:
    """The sets that could be made in time without windows and battery, from those of the highest
    prize down, so many at once: which of them can be made, and then at which least cost."""
    goals, worth = _goals(network, pruned, layers)
    most, best, first, size = int(worth.max(initial=-1)), start, 0, _FIRST_GOALS
    while first < len(goals):
        search.report_bounds(prize_bound=most)
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
            if complete or search.remaining() <= 0.0:
                break
        if best is not None and best.path is not None and complete and best.prize >= lowest:
            return _cheapest(network, pruned, search, best, goals[worth == best.prize])
        if not complete:
            break
        first, size = after, size * 4
        most = int(worth[after]) if after < len(goals) else -1
    if best is None or best.path is None:
        return no_solution(network, proven=most < 0)
    return make_solution(network, best.path, best.charges, max(most, best.prize), 0)


def _cheapest(
    network: StepNetwork, pruned: Pruned, search: Search, best: LabelSolution, goals: Vector
) -> LabelSolution:
    """The cheapest path to any of the goals, which are all of those with the best prize."""
    search.report_bounds(prize_bound=best.prize)
    if network.objective is Objective.PRIZE:
        return make_solution(network, best.path or (), best.charges, best.prize, 0)
    space = _with_tables(network, pruned, sets_towards(goals, len(network.prize)))
    cheapest = _widening(network, space, search, WIDTHS, best)
    return make_solution(network, cheapest.path or (), cheapest.charges, best.prize, cheapest.bound)


def _better(
    network: StepNetwork, search: Search, beam: Beam, best: LabelSolution | None
) -> LabelSolution | None:
    """The better of a beam's path and the best so far."""
    if beam.path is None:
        return best
    one = make_solution(network, beam.path, beam.charges, int(network.prize.sum()), 0)
    if not one.better_than(best):
        return best
    search.offer(one.path or (), one.charges)
    return one


def _goals(network: StepNetwork, pruned: Pruned, layers: list[Layer]) -> tuple[Vector, Vector]:
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
    network: StepNetwork, arcs: NDArray[np.int32], layers: Iterable[Layer]
) -> tuple[Vector, Vector]:
    """All sets that can be made, and their soonest ends."""
    m = network.size
    masks, at_end = [np.zeros(1, np.int64)], [arcs[m:, m].astype(np.int64)]
    for layer in layers:
        masks.append(layer.masks)
        at_end.append(ends(network, arcs, layer))
    return np.concatenate(masks), np.concatenate(at_end)


def _times_and_energies(network: StepNetwork) -> NDArray[np.int64]:
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
