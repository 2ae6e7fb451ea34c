"""Dynamic programming over labels with two measures: time, and energy used or travel.

A label describes the beginning of a path: the set of its steps, its last node and the two measures.
Energy counts since the last charge. The earliest time is not always best if the battery is charged
on the way, or if waiting costs nothing. So each set and last node has several labels that do not
dominate each other in the two measures. Labels that cannot lead to a better route than the best
known one are dropped, by a lower bound on their remaining cost from the problem without windows and
battery. Beam searches of increasing width find routes; one that drops no label for its width proves
the best route.
"""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.beam_search import BeamResult, BeamSearch
from argo_compiler.route.completion_bounds import StepSets, sets_in_layers, subsets_of
from argo_compiler.route.held_karp import (
    INF,
    Layer,
    best_path,
    can_end,
    earliest_ends_of_sets,
    iter_layers,
    layers_if_few,
    prizes_of_sets,
    times_of_allowed_arcs,
)
from argo_compiler.route.lower_bounds import DualBound, TableBound
from argo_compiler.route.modes import add_capped_at_never
from argo_compiler.route.network import StepNetwork
from argo_compiler.route.order_ideals import StepBits
from argo_compiler.route.path_timing import PathTiming
from argo_compiler.route.problem import Objective, RouteProblem
from argo_compiler.route.pruning import (
    Pruned,
    horizon_without_limit,
    least_arc_times_without_service,
)
from argo_compiler.route.search import Search
from argo_compiler.route.solution import LabelSolution, make_solution, no_solution

Vector = NDArray[np.int64]

WIDTHS = (300, 3_000, 30_000, 300_000, 2_000_000)
"""widths of the successive beam searches with tables, in labels per layer"""
_WIDTHS_WITHOUT_TABLES = (1_000, 10_000, 100_000, 500_000)
"""widths of the successive beam searches with dual prices, in labels per layer"""
_FIRST_GOALS = 64
"""number of goals in the first group that is searched by prize"""
_MOST_OPTIONAL = 22
"""highest number of steps with optional ones among them: there are tables of all their subsets"""


def _applies(problem: RouteProblem) -> bool:
    """Return True if a problem has a battery, or waiting that costs nothing, but not both.

    Then labels need a second measure besides time, and two are enough.
    """
    return problem.has_free_waiting != (problem.battery is not None)


class Labels:
    """Solver with labels and tables of all sets of steps, if they are few enough."""

    name = "labels"

    def supports(self, problem: RouteProblem, /) -> bool:
        return _applies(problem)

    def solve(self, search: Search, /) -> None:
        network = search.network
        if network.selective and len(network.prize) > _MOST_OPTIONAL:
            return
        layers = layers_if_few(search)
        if layers is not None:
            _report(search, solve_with_tables(network, search.pruned, search, layers))


class LabelBeams:
    """Solver with beams of labels and bounds from dual prices, for any number of sets."""

    name = "beams of labels"

    def supports(self, problem: RouteProblem, /) -> bool:
        return _applies(problem) and not problem.selective

    def solve(self, search: Search, /) -> None:
        network, pruned = search.network, search.pruned
        if horizon_without_limit(network) < INF and StepBits(network, pruned).fits:
            _report(search, solve_with_dual_prices(network, pruned, search, None))


def _report(search: Search, solution: LabelSolution) -> None:
    if solution.path is not None:
        search.offer(solution.path, solution.charges)
    elif solution.proven:
        search.report_infeasible()
        return
    least = solution.prize_bound if search.network.selective else 0
    search.report_bounds(solution.prize_bound, solution.bound, least)


def solve_with_tables(
    network: StepNetwork, pruned: Pruned, search: Search, layers: list[Layer]
) -> LabelSolution:
    """Return the best path that the beam searches find until the deadline, and bounds on all paths.

    `layers`: layers of the network without a battery.
    """
    start: LabelSolution | None = None
    earliest = best_path(network, layers, pruned)
    if earliest is None:
        return no_solution(network, proven=True)
    # If the battery lasts for the best route without a battery, that route is the best one.
    timing = PathTiming(network)
    label = timing.evaluate_path(earliest.path)
    if label is not None:
        followed = make_solution(
            network, earliest.path, dict(label.charges), int(network.prize.sum()), 0
        )
        search.offer(earliest.path, dict(label.charges))
        if label.time == earliest.end and network.objective is not Objective.TRAVEL:
            return make_solution(
                network, earliest.path, dict(label.charges), earliest.prize, followed.cost
            )
        start = followed
    if network.selective:
        return _solve_by_prize(network, pruned, search, layers, start)
    bits = StepBits(network, pruned)
    sets = [np.zeros(1, np.int64), *(layer.masks for layer in layers)]
    del layers
    beams = _search_with_tables(network, pruned, sets_in_layers(network, bits, sets))
    return _widen(network, beams, search, WIDTHS, start)


def solve_with_dual_prices(
    network: StepNetwork, pruned: Pruned, search: Search, start: LabelSolution | None
) -> LabelSolution:
    """Return the best path that the beam searches find until the deadline, and bounds on all paths.

    For any number of sets, in networks without optional steps whose bits fit into masks. `start`: a
    path that is known already, or None.
    """
    bits = StepBits(network, pruned)
    costs = _cost_matrices(network)
    beams = BeamSearch(
        network, pruned, bits, DualBound(network, pruned, bits, costs), equal_prizes=True
    )
    return _widen(network, beams, search, _WIDTHS_WITHOUT_TABLES, start)


def _cost_matrices(network: StepNetwork) -> list[Vector]:
    """Return the arc costs for bounds: times, and, with chargers, times plus energies."""
    service = np.append(network.service, 0)[None, :]
    matrices = [add_capped_at_never(least_arc_times_without_service(network), service)]
    if network.problem.battery is not None and network.chargers:
        matrices.append(add_capped_at_never(_times_and_energies(network), service))
    return matrices


def _search_with_tables(network: StepNetwork, pruned: Pruned, sets: StepSets) -> BeamSearch:
    bits = StepBits(network, pruned)
    costs = np.stack(
        [times_of_allowed_arcs(network, pruned, matrix) for matrix in _cost_matrices(network)]
    )
    bound = TableBound(network, bits, sets, costs)
    layers = zip(sets.layers, sets.can_end, strict=True)
    prizes = np.concatenate([prizes_of_sets(network, layer[ends]) for layer, ends in layers])
    return BeamSearch(network, pruned, bits, bound, equal_prizes=bool((prizes == prizes[:1]).all()))


def _widen(
    network: StepNetwork,
    beams: BeamSearch,
    search: Search,
    widths: tuple[int, ...],
    start: LabelSolution | None,
) -> LabelSolution:
    """Run beam searches of increasing width, until one drops no label or the time is up.

    Returns the best path found, at least as good as `start`, and bounds on all paths.
    """
    prize, bound, best = int(network.prize.sum()), 0, start
    for width in widths:
        beam = beams.run(width, best, search)
        best = _offer_if_better(network, search, beam, best)
        if beam.complete:
            if best is None or best.path is None:
                return no_solution(network, proven=True)
            return make_solution(network, best.path, best.charges, prize, best.cost)
        bound = max(bound, beam.bound)
        search.report_bounds(bound=bound)
        if search.remaining_time() <= 0.0:
            break
    if best is None or best.path is None:
        return no_solution(network, proven=False, bound=bound)
    return make_solution(network, best.path, best.charges, prize, bound)


def _solve_by_prize(
    network: StepNetwork,
    pruned: Pruned,
    search: Search,
    layers: list[Layer],
    start: LabelSolution | None,
) -> LabelSolution:
    """Search the goals from the highest prize down, in groups, and then for the least cost.

    Goals are the sets that are possible in time without windows and battery. The first part of the
    search finds the highest prize of a goal that is really possible, the second part the cheapest
    path to a goal with that prize.
    """
    goals, prizes = _goal_sets(network, pruned, layers)
    most, best, first, size = int(prizes.max(initial=-1)), start, 0, _FIRST_GOALS
    while first < len(goals):
        search.report_bounds(prize_bound=most)
        # Goals with equal prizes are in the same group.
        lowest = prizes[min(first + size, len(goals)) - 1]
        after = int(np.searchsorted(-prizes, -lowest, side="right"))
        group, complete = goals[first:after], False
        for width in WIDTHS:
            # With a path at hand, only goals with a higher prize matter.
            if best is not None and best.path is not None:
                group = group[prizes_of_sets(network, group) > best.prize]
            if not len(group):
                complete = True
                break
            beams = _search_with_tables(network, pruned, subsets_of(group, len(network.prize)))
            beam = beams.run(width, None, search)
            best, complete = _offer_if_better(network, search, beam, best), beam.complete
            if complete or search.remaining_time() <= 0.0:
                break
        if best is not None and best.path is not None and complete and best.prize >= lowest:
            return _cheapest(network, pruned, search, best, goals[prizes == best.prize])
        if not complete:
            break
        first, size = after, size * 4
        most = int(prizes[after]) if after < len(goals) else -1
    if best is None or best.path is None:
        return no_solution(network, proven=most < 0)
    return make_solution(network, best.path, best.charges, max(most, best.prize), 0)


def _cheapest(
    network: StepNetwork, pruned: Pruned, search: Search, best: LabelSolution, goals: Vector
) -> LabelSolution:
    """Return the cheapest path to any of the goals, which are all goals with the best prize."""
    search.report_bounds(prize_bound=best.prize)
    if network.objective is Objective.PRIZE:
        return make_solution(network, best.path or (), best.charges, best.prize, 0)
    beams = _search_with_tables(network, pruned, subsets_of(goals, len(network.prize)))
    cheapest = _widen(network, beams, search, WIDTHS, best)
    return make_solution(network, cheapest.path or (), cheapest.charges, best.prize, cheapest.bound)


def _offer_if_better(
    network: StepNetwork, search: Search, beam: BeamResult, best: LabelSolution | None
) -> LabelSolution | None:
    """Offer a beam's path if it is better than the best one, and return the better of the two."""
    if beam.path is None:
        return best
    solution = make_solution(network, beam.path, beam.charges, int(network.prize.sum()), 0)
    if not solution.better_than(best):
        return best
    search.offer(solution.path or (), solution.charges)
    return solution


def _goal_sets(network: StepNetwork, pruned: Pruned, layers: list[Layer]) -> tuple[Vector, Vector]:
    """Return the sets of steps that a route may make in time, and their prizes, highest first.

    The check of the time leaves out windows and the battery's state, but includes the least time to
    charge the energy used.
    """
    limit, m = min(network.limit, int(INF) - 1), network.node_count
    arcs = times_of_allowed_arcs(network, pruned, least_arc_times_without_service(network))
    goals, end = _earliest_ends(network, arcs, layers)
    may = can_end(network, StepBits(network, pruned), 0, goals)
    goals = goals[may & (end <= limit)]
    battery = network.problem.battery
    if battery is not None and network.limit < INF:
        available = battery.capacity - battery.used
        arcs = times_of_allowed_arcs(network, pruned, _times_and_energies(network))
        latest = np.full(m, min(limit + available, int(INF) - 1), np.int64)
        charged = iter_layers(
            network, StepBits(network, pruned), arcs, np.zeros(m, np.int64), latest
        )
        masks, end = _earliest_ends(network, arcs, charged)
        goals = np.intersect1d(goals, masks[end - available <= limit], assume_unique=True)
    goals = np.sort(goals)
    prizes = prizes_of_sets(network, goals)
    order = np.argsort(-prizes, kind="stable")
    return goals[order], prizes[order]


def _earliest_ends(
    network: StepNetwork, arcs: NDArray[np.int32], layers: Iterable[Layer]
) -> tuple[Vector, Vector]:
    """Return all sets of steps in the layers, with the empty one, and their earliest ends.

    An end is that of a route which makes only the steps of the set.
    """
    m = network.node_count
    masks, at_end = [np.zeros(1, np.int64)], [arcs[m:, m].astype(np.int64)]
    for layer in layers:
        masks.append(layer.masks)
        at_end.append(earliest_ends_of_sets(network, arcs, layer))
    return np.concatenate(masks), np.concatenate(at_end)


def _times_and_energies(network: StepNetwork) -> NDArray[np.int64]:
    """Return the least sum of time and energy (units) of each arc, straight or by a charger."""
    battery = network.problem.battery
    assert battery is not None
    assert network.energy is not None
    both = add_capped_at_never(network.time, network.energy)
    for station in network.chargers:
        inbound = add_capped_at_never(station.to, station.to_energy)[:, None]
        outbound = add_capped_at_never(station.out, station.out_energy)[None, :]
        both = np.minimum(both, add_capped_at_never(inbound + outbound, battery.overhead))
    return both
