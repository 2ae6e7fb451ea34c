"""The linear relaxation's bound is never above the best route of brute force."""

import time
from math import inf

import numpy as np
import pytest
from numpy.typing import NDArray

from argo_compiler.route import Objective, RouteProblem, Visit, suggest_route
from argo_compiler.route.linear_relaxation import LinearRelaxation
from argo_compiler.route.network import StepNetwork, build_network
from argo_compiler.route.pruning import Pruned, least_arc_times_without_service, prune
from argo_compiler.route.search import Search, SearchLimits
from tests.argo_compiler.route.random_problems import random_problem
from tests.argo_compiler.route.reference import best_value
from tests.conftest import seeds


def _relaxed(
    net: StepNetwork, pruned: Pruned, costs: NDArray[np.int64], least_prize: int | None
) -> LinearRelaxation:
    relaxation = LinearRelaxation(net, pruned, costs, least_prize)
    search = Search(net, pruned, SearchLimits(work=inf), 0, time.perf_counter)
    relaxation.solve(search, None)
    return relaxation


def _prizes(net: StepNetwork) -> NDArray[np.int64]:
    costs = np.zeros((net.node_count + 1, net.node_count + 1), np.int64)
    costs[:, :-1] = -net.prize[net.step]
    return costs


def _times(net: StepNetwork) -> NDArray[np.int64]:
    return np.asarray(least_arc_times_without_service(net) + np.append(net.service, 0))


def _require_best_route(
    net: StepNetwork, relaxation: LinearRelaxation, most: int, problem: RouteProblem
) -> None:
    """A best route has only the arcs that its value allows, and all mandatory steps."""
    route = suggest_route(problem, time_limit=60.0, explain=False).route
    assert route is not None
    path, charges = net.tour_path(route)
    if path is None or charges:
        return
    arcs, mandatory = relaxation.possible_arcs_and_required_steps(most)
    ends = [net.node_count, *path, net.node_count]
    assert arcs[ends[:-1], ends[1:]].all()
    assert set(np.flatnonzero(mandatory)) <= set(net.step[list(path)].tolist())


@pytest.mark.parametrize("part", range(4))
def test_no_bound_is_above_the_best_route(part: int) -> None:
    for seed in seeds(480)[part::4]:
        problem = random_problem(np.random.default_rng(50_000 + seed), 5)
        net = build_network(problem, lambda step: tuple(step.parts))
        pruned = prune(net)
        if not net.node_count or not pruned.possible:
            continue
        best = best_value(problem)
        won = _relaxed(net, pruned, _prizes(net), None)
        spent = _relaxed(net, pruned, _times(net), None if best is None else best[0] or None)
        if best is None:
            continue
        assert won.bound is not None, seed
        assert -won.bound >= best[0], seed
        _require_best_route(net, won, -best[0], problem)
        if problem.objective is not Objective.PRIZE:
            assert spent.bound is not None, seed
            assert spent.bound <= best[1], seed
            _require_best_route(net, spent, best[1], problem)


@pytest.mark.parametrize("size", [12, 20])
def test_arcs_of_the_best_route_are_left_at_its_cost(size: int) -> None:
    rng = np.random.default_rng(size)
    for _ in range(5):
        places = rng.uniform(0, 100, (size + 1, 2))
        travel = np.rint(np.abs(places[:, None] - places).sum(axis=2)).astype(np.int64)
        travel += rng.integers(0, 5, travel.shape)
        problem = RouteProblem(tuple(Visit(f"checkpoint {k}") for k in range(size)), travel)
        net = build_network(problem, lambda step: tuple(step.parts))
        pruned = prune(net)
        relaxation = _relaxed(net, pruned, _times(net), None)
        proven = suggest_route(problem, 60.0, explain=False, solvers=("first rules", "CP-SAT"))
        own = suggest_route(problem, 60.0, explain=False, solvers=("linear relaxation",))
        assert proven.proven
        assert own.proven
        assert own.cost == proven.cost
        assert relaxation.bound is not None
        assert 0.9 * own.cost <= relaxation.bound <= own.cost
        _require_best_route(net, relaxation, own.cost, problem)
        left, _ = relaxation.possible_arcs_and_required_steps(own.cost)
        assert left.sum() < pruned.arcs.sum() / 2
