"""The compiled local search agrees with brute force, and its routes are feasible."""

from importlib import import_module
from itertools import combinations

import numpy as np
import pytest

from argo_compiler.route import (
    Objective,
    Precedence,
    RouteProblem,
    Visit,
    evaluate,
    suggest_route,
)
from tests.argo_compiler.route.random_problems import random_problem
from tests.argo_compiler.route.reference import best_value
from tests.conftest import examples, sample

pytest.importorskip("numba")
ONLY = ("exchange search",)


def with_orders(seed: int, count: int, orders: int) -> RouteProblem:
    rng = np.random.default_rng(seed)
    travel = rng.integers(1, 50, (count + 1, count + 1))
    pairs = [sorted(rng.choice(count, 2, replace=False).tolist()) for _ in range(orders)]
    precedences = tuple(Precedence(tuple(pair), "an order") for pair in pairs)
    visits = tuple(Visit(f"checkpoint {k}", 1) for k in range(count))
    return RouteProblem(visits, travel, precedences)


@pytest.mark.long
def test_small_problems_of_any_kind_are_solved_as_well_as_by_brute_force() -> None:
    reached = possible = 0
    for seed in sample(range(2000, 2060)):
        problem = random_problem(np.random.default_rng(seed), 6)
        best = best_value(problem)
        if best is None or problem.battery is not None or problem.size < 2:
            continue
        made = suggest_route(problem, None, work_limit=0.2, explain=False, solvers=ONLY)
        possible += 1
        found = (0, 0) if made.route is None else (made.prize, made.cost)  # to do nothing is best
        reached += found == best
    assert possible > examples(20)
    assert reached == possible


@pytest.mark.parametrize("seed", range(4))
def test_the_order_is_kept_and_better_routes_are_found(seed: int) -> None:
    problem = with_orders(seed, 40, 60)
    first = suggest_route(problem, None, work_limit=0.05, explain=False, solvers=("first rules",))
    made = suggest_route(
        problem, None, work_limit=0.3, explain=False, solvers=("first rules", *ONLY)
    )
    assert made.route is not None
    assert made.cost < 0.8 * first.cost
    assert evaluate(problem, made.route).feasible
    for one, other in combinations(made.order, 2):
        assert not any(p.sequence == (other, one) for p in problem.precedences)


def test_it_is_deterministic_under_a_limit_of_work() -> None:
    problem = with_orders(9, 60, 40)
    costs = [
        suggest_route(problem, None, work_limit=0.2, seed=seed, explain=False, solvers=ONLY).history
        for seed in (0, 0)
    ]
    assert [p.cost for p in costs[0]] == [p.cost for p in costs[1]]


def test_it_is_compiled_once_for_small_and_large_problems() -> None:
    for size in (5, 40):
        suggest_route(with_orders(3, size, 4), None, work_limit=0.05, explain=False, solvers=ONLY)
    kernel = import_module("argo_compiler.route.exchange_kernel")
    assert len(kernel.anneal.signatures) == 1
    assert len(kernel.set_line.signatures) == 1


def test_it_finds_no_route_without_time_to_compile() -> None:
    made = suggest_route(with_orders(1, 30, 10), 0.001, explain=False, solvers=ONLY)
    assert not made.proven


def test_prizes_within_a_limit() -> None:
    """The limit lets the robot reach half of the visits, which are on a line, one unit apart."""
    points = np.append(np.arange(1, 21), 0)
    travel = np.abs(points[:, None] - points).astype(np.int64)
    visits = tuple(Visit(f"checkpoint {k}", 0, False, 1) for k in range(20))
    needs = Precedence(tuple(range(20)), "outwards", needed=True)
    for objective in Objective:
        problem = RouteProblem(visits, travel, (needs,), max_duration=20, objective=objective)
        made = suggest_route(problem, None, work_limit=0.3, explain=False, solvers=ONLY)
        assert made.prize == 10
        assert made.order == tuple(range(10))
