"""Suggestions for random problems with any mix of constraints agree with brute force."""

from dataclasses import replace

import numpy as np
import pytest

from argo_compiler.route import (
    NEVER,
    EnergyBudget,
    Objective,
    Round,
    RouteProblem,
    Tour,
    Visit,
    evaluate,
    labels,
    suggest_route,
)
from tests.argo_compiler.route.random_problems import random_problem
from tests.argo_compiler.route.reference import best_value
from tests.conftest import examples, seeds

PROBLEMS = examples(480)


@pytest.mark.parametrize("part", range(4))
def test_the_best_route_is_that_of_brute_force(part: int) -> None:
    for seed in seeds(480)[part::4]:
        large = PROBLEMS >= 1000 or seed % 8 == 0
        problem = random_problem(np.random.default_rng(seed), 8 if large else 5)
        best = best_value(problem)
        made = suggest_route(problem, time_limit=60.0, explain=False)
        assert made.proven or made.infeasible, seed
        assert (None if made.route is None else (made.prize, made.cost)) == best, seed
        if made.route is not None:
            worth = evaluate(problem, made.route)
            assert worth.feasible, seed
            assert (worth.prize, worth.cost(problem.objective)) == best, seed
            assert made.gap == 0.0
            left_out = set(range(problem.size)) - set(made.order)
            assert set(made.dropped) == left_out


@pytest.mark.parametrize(
    ("solvers", "proves"),
    [
        (("CP-SAT",), 1.0),
        (("linear relaxation",), 0.3),
        (("first rules", "CP-SAT"), 1.0),
        (("Held-Karp",), 0.6),
        (("labels",), 0.4),
        (("beams of labels",), 0.3),
        (("ruin and recreate", "first rules"), 0.0),
        (("PyVRP", "exchange search"), 0.0),
        (("linear relaxation", "CP-SAT"), 1.0),
    ],
)
def test_each_solver_agrees_with_brute_force(
    solvers: tuple[str, ...], proves: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(labels, "_FIRST_GOALS", 2)  # so that small problems have several groups
    proven, tried = 0, range(1000, 1000 + PROBLEMS // (2 if proves else 12))
    for seed in tried:
        problem = random_problem(np.random.default_rng(seed), 5)
        limit = 20.0 if proves else 0.1
        made = suggest_route(problem, limit, explain=False, solvers=solvers)
        best, got = best_value(problem), None if made.route is None else (made.prize, made.cost)
        proven += made.proven or made.infeasible
        if made.proven or made.infeasible:
            assert got == best, seed
        elif best is not None:
            assert made.prize_bound >= best[0], seed
            assert made.prize_bound > best[0] or made.bound <= best[1], seed
    assert proven >= proves * len(tried)


def test_parallel_searches_agree_with_brute_force() -> None:
    solvers = ("first rules", "exchange search", "ruin and recreate", "CP-SAT")
    for seed in range(3000, 3000 + PROBLEMS // 20):
        problem = random_problem(np.random.default_rng(seed), 5)
        made = suggest_route(problem, 6.0, workers=2, explain=False, solvers=solvers)
        assert made.proven or made.infeasible, seed
        assert (None if made.route is None else (made.prize, made.cost)) == best_value(problem)


def test_a_short_search_has_a_route_and_a_bound() -> None:
    problem = _grid(70)
    made = suggest_route(problem, None, work_limit=1.0, explain=False)
    assert made.route is not None
    assert evaluate(problem, made.route).feasible
    assert 0 < made.bound <= made.cost
    assert made.gap is not None
    assert 0.0 <= made.gap < 1.0
    costs = [point.cost for point in made.history if point.cost is not None]
    assert costs == sorted(costs, reverse=True)
    bounds = [point.bound for point in made.history]
    assert bounds == sorted(bounds)


@pytest.mark.long
def test_a_large_problem_gets_a_route_and_a_bound() -> None:
    problem = _grid(400)
    made = suggest_route(problem, None, work_limit=2.0, explain=False)
    assert evaluate(problem, Tour(made.order)).feasible
    assert 0 < made.bound < made.cost
    assert any("too many" in reason for reason in made.reasons)


def test_equal_arguments_give_equal_routes_if_the_best_is_proven() -> None:
    for seed in (3, 12, 40):
        problem = random_problem(np.random.default_rng(seed), 6)
        first, again = (suggest_route(problem, 60.0, explain=False) for _ in range(2))
        assert first.proven or first.infeasible
        assert (first.order, first.charges) == (again.order, again.charges)


def _grid(count: int):  # type: ignore[no-untyped-def]

    rng = np.random.default_rng(count)
    points = rng.integers(0, 1000, (count + 1, 2))
    travel = np.abs(points[:, None] - points).sum(axis=2).astype(np.int64)
    travel += np.maximum(points[None, :, 1] - points[:, None, 1], 0)
    assert travel.max() < NEVER
    return RouteProblem(tuple(Visit(f"checkpoint {k}", 5) for k in range(count)), travel)


def test_a_route_that_can_win_nothing_is_proven() -> None:
    problem = random_problem(np.random.default_rng(1071), 5)
    made = suggest_route(problem, 20.0)
    assert made.proven
    assert (made.order, made.prize, made.prize_bound) == ((), 0, 0)


@pytest.mark.long
def test_nothing_is_proven_with_a_round_of_many_members() -> None:

    grid = _grid(12)
    problem = replace(grid, rounds=(Round("patrol", tuple(range(11)), repeat=2),))
    made = suggest_route(problem, None, work_limit=1.0, explain=False)
    assert evaluate(problem, Tour(made.order)).feasible
    assert not made.proven
    assert made.bound == 0
    assert any("too many orders" in reason for reason in made.reasons)


def test_a_round_that_can_not_be_reached() -> None:

    travel = np.array([[NEVER, NEVER, 1], [NEVER, 0, 1], [NEVER, NEVER, 3]])
    round_ = Round("patrol", (0, 1), repeat=0, duration=5)
    made = suggest_route(RouteProblem((Visit("a"), Visit("b")), travel, rounds=(round_,)))
    assert made.infeasible
    assert made.route is None


def test_labels_do_not_take_energy_for_travel() -> None:
    """The problems have a battery and latest times, but no visit to wait for."""
    rng = np.random.default_rng(3)
    for _ in range(60):
        n = 3
        travel, energy = rng.integers(0, 5, (2, n + 2, n + 2))
        visits = tuple(Visit(str(k), latest=int(rng.integers(2, 9))) for k in range(n))
        battery = EnergyBudget(energy, capacity=9)
        problem = RouteProblem(visits, travel, (), (), None, battery, ("dock",), Objective.TRAVEL)
        made = suggest_route(problem, 20.0, explain=False, solvers=("labels",))
        best = best_value(problem)
        assert made.proven or made.infeasible
        assert (None if made.route is None else (made.prize, made.cost)) == best
