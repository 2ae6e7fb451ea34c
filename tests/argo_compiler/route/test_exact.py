"""What is suggested against trying all routes, for random problems with any mix of constraints."""

import os
from dataclasses import replace

import numpy as np
import pytest

from argo_compiler.route import (
    NEVER,
    Tour,
    evaluate,
    find_route,
    held_karp,
    labels,
    portfolio,
    suggest_route,
)
from argo_compiler.route.cp_sat import solve_cp_sat
from argo_compiler.route.first_routes import first_route
from argo_compiler.route.network import network
from argo_compiler.route.pruning import prune
from argo_compiler.route.search import Search
from tests.argo_compiler.route.brute_force import brute_force
from tests.argo_compiler.route.random_problems import random_problem

PROBLEMS = int(os.environ.get("ARGO_ROUTE_PROBLEMS", "120"))


@pytest.mark.parametrize("part", range(4))
def test_the_best_route_is_that_of_brute_force(part: int) -> None:
    for seed in range(part, PROBLEMS, 4):
        large = PROBLEMS >= 1000 or seed % 8 == 0
        problem = random_problem(np.random.default_rng(seed), 8 if large else 5)
        best = brute_force(problem)
        made = suggest_route(problem, time_limit=60.0, explain=False)
        assert made.proven, seed
        assert (None if made.route is None else (made.prize, made.cost)) == best, seed
        if made.route is not None:
            worth = evaluate(problem, made.route)
            assert worth.feasible, seed
            assert (worth.prize, worth.cost(problem.objective)) == best, seed
            assert made.gap == 0.0
            left_out = set(range(problem.size)) - set(made.order)
            assert set(made.dropped) == left_out


@pytest.mark.parametrize("solver", ["circuit", "times", "labels", "prices", "local"])
def test_each_solver_agrees_with_brute_force(solver: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(labels, "_FIRST_GOALS", 2)  # so that small problems have several groups
    compared = 0
    for seed in range(1000, 1000 + PROBLEMS // 2):
        problem = random_problem(np.random.default_rng(seed), 5)
        net = network(problem, lambda step: tuple(step.parts))
        pruned = prune(net)
        best = brute_force(problem)
        if not pruned.possible:
            assert best is None, seed
            continue
        found = _solved(solver, net, pruned)
        if found is None:
            continue
        compared += 1
        if solver == "local":
            # No proof: never better than the best, and feasible.
            assert found.path is None or best is not None, seed
            assert found.path is None or (found.prize, -found.cost) <= (best[0], -best[1]), seed
        else:
            assert found.proven, seed
            assert (None if found.path is None else (found.prize, found.cost)) == best, seed
    assert compared >= PROBLEMS // 8


@pytest.mark.parametrize("workers", [1, 2])
def test_searches_agree_with_brute_force(workers: int, monkeypatch: pytest.MonkeyPatch) -> None:
    # Problems as small as these would not be searched otherwise.
    monkeypatch.setattr(find_route, "solve", portfolio._searched)
    for seed in range(3000, 3000 + PROBLEMS // 20):
        problem = random_problem(np.random.default_rng(seed), 5)
        made = suggest_route(problem, 6.0, workers=workers, explain=False)
        assert made.proven, seed
        assert (None if made.route is None else (made.prize, made.cost)) == brute_force(problem)


def _solved(solver, net, pruned):  # type: ignore[no-untyped-def]
    clock = iter(range(10**9))
    search = Search(lambda: 0.0, 60.0, 0, 1, int(net.prize.sum()))
    if solver == "circuit":
        return solve_cp_sat(net, pruned, search)
    if solver == "times" and pruned.before.any():
        search.clock = lambda: float(next(clock))
        best, _ = first_route(net, pruned, search)
        search.clock = lambda: 0.0
        return solve_cp_sat(net, pruned, search, best, timed=True)
    if solver == "labels" and labels.applies(net):
        layers = held_karp.soonest_layers(net, pruned, 10**6, lambda: False)
        return labels.solve_labels(net, pruned, search, layers)
    if solver == "prices" and labels.applies(net) and not net.selective and len(net.prize):
        return labels.search_labels(net, pruned, search, None)
    if solver == "local":
        search.clock = lambda: float(next(clock))
        best, _ = first_route(net, pruned, search)
        return best
    return None


def test_the_time_that_is_given_is_kept_to_and_something_is_always_known() -> None:
    problem = _grid(70)
    made = suggest_route(problem, time_limit=0.3, explain=False)
    assert made.route is not None
    assert evaluate(problem, made.route).feasible
    assert 0 < made.bound <= made.cost
    assert made.gap is not None
    assert 0.0 <= made.gap < 1.0
    costs = [point.cost for point in made.history if point.cost is not None]
    assert costs == sorted(costs, reverse=True)
    bounds = [point.bound for point in made.history]
    assert bounds == sorted(bounds)


def test_a_large_problem_gets_a_route_and_a_bound() -> None:
    problem = _grid(400)
    made = suggest_route(problem, time_limit=2.0, explain=False)
    assert evaluate(problem, Tour(made.order)).feasible
    assert 0 < made.bound < made.cost
    assert any("too many" in reason for reason in made.reasons)


def test_equal_arguments_give_equal_routes_where_the_best_is_proven() -> None:
    for seed in (3, 12, 40):
        problem = random_problem(np.random.default_rng(seed), 6)
        first, again = (suggest_route(problem, 60.0, explain=False) for _ in range(2))
        assert first.proven
        assert (first.order, first.charges) == (again.order, again.charges)


def _grid(count: int):  # type: ignore[no-untyped-def]
    from argo_compiler.route import RouteProblem, Visit

    rng = np.random.default_rng(count)
    places = rng.integers(0, 1000, (count + 1, 2))
    way = np.abs(places[:, None] - places).sum(axis=2).astype(np.int64)
    way += np.maximum(places[None, :, 1] - places[:, None, 1], 0)
    assert way.max() < NEVER
    return RouteProblem(tuple(Visit(f"checkpoint {k}", 5) for k in range(count)), way)


def test_a_route_that_can_win_nothing_is_proven() -> None:
    problem = random_problem(np.random.default_rng(1071), 5)
    made = suggest_route(problem, 20.0)
    assert made.proven
    assert (made.order, made.prize, made.prize_bound) == ((), 0, 0)


def test_of_a_round_with_many_members_nothing_is_claimed() -> None:
    from argo_compiler.route import Round

    grid = _grid(12)
    problem = replace(grid, rounds=(Round("patrol", tuple(range(11)), repeat=2),))
    made = suggest_route(problem, time_limit=5.0, explain=False)
    assert evaluate(problem, Tour(made.order)).feasible
    assert not made.proven
    assert made.bound == 0
    assert any("too many members" in reason for reason in made.reasons)
