"""A search finds a first route soon, and keeps its limits, also for large problems."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse.csgraph import shortest_path

from argo_compiler.route import Precedence, RouteProblem, evaluate, suggest_route
from argo_compiler.route.network import build_network
from argo_compiler.route.pruning import path_time_lower_bounds
from argo_compiler.route.stop import FirstFeasible
from benchmarks.routes_limits import KINDS, random_problem


class Clock:
    """Clock that advances by a step at each call."""

    def __init__(self, step: float) -> None:
        self.now, self._step = 0.0, step

    def __call__(self) -> float:
        self.now += self._step
        return self.now


def of_kind(kind: str, size: int) -> RouteProblem:
    rng = np.random.default_rng(size)
    return KINDS[kind](random_problem(size, rng), rng)


def clashing(size: int) -> RouteProblem:
    """Problem with a cycle of precedences between five visits."""
    pairs = [(k, (k + 1) % 5) for k in range(5)]
    order = tuple(Precedence(pair, "{} before {}".format(*pair)) for pair in pairs)
    return replace(of_kind("plain", size), precedences=order)


@pytest.mark.long
@pytest.mark.parametrize("size", [400, 1000])
@pytest.mark.parametrize("kind", KINDS)
def test_the_first_solver_finds_a_route(kind: str, size: int) -> None:
    problem = of_kind(kind, size)
    made = suggest_route(problem, stop=FirstFeasible(), solvers=["first rules"], clock=Clock(1e-6))
    assert made.route is not None
    assert evaluate(problem, made.route).feasible


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
def test_a_search_stops_soon_after_the_limit(kind: str) -> None:
    clock = Clock(0.002)
    made = suggest_route(of_kind(kind, 60), 1.0, clock=clock)
    assert made.route is not None
    assert clock.now <= 1.0 * 1.1 + 0.2


def test_an_explanation_without_time_states_that() -> None:
    clock = Clock(0.001)
    made = suggest_route(clashing(60), 0.5, clock=clock)
    assert made.route is None
    assert made.infeasible
    assert "no time" in made.reasons[-1]
    assert clock.now <= 0.5 * 1.1 + 0.2


def test_an_explanation_with_time_is_a_smallest_one() -> None:
    made = suggest_route(clashing(12), 20.0)
    assert made.infeasible_subset == tuple(f"{k} before {(k + 1) % 5}" for k in range(5))
    assert "fewer requirements" in made.reasons[-1]


def test_rounds_have_a_feasible_order_without_time_to_compare_orders() -> None:
    problem = of_kind("rounds", 30)
    made = suggest_route(problem, 2.0, clock=Clock(0.02))
    assert made.route is not None
    assert evaluate(problem, made.route).feasible
    assert not made.proven
    assert any("too many orders" in reason for reason in made.reasons)


def test_rounds_meet_precedences_without_time_to_compare_orders() -> None:
    problem = of_kind("rounds", 30)
    order = tuple(Precedence((k + 4, k, k + 2), "from the last") for k in range(0, 15, 5))
    problem = replace(problem, precedences=order)
    made = suggest_route(problem, 2.0, clock=Clock(0.02))
    assert made.route is not None
    assert evaluate(problem, made.route).feasible


@pytest.mark.parametrize("size", [40, 310])
def test_least_path_times_are_lower_bounds(size: int) -> None:
    rng = np.random.default_rng(size)
    travel = rng.integers(1, 1000, (size + 1, size + 1))  # without the triangle inequality
    problem = replace(random_problem(size, rng), travel=travel)
    service = np.array([visit.service for visit in problem.visits])
    arcs = travel[:size, :size] + service[:, None]
    shortest = shortest_path(arcs) - service[:, None]
    times = path_time_lower_bounds(build_network(problem, lambda step: tuple(step.parts)))
    off_diagonal = ~np.eye(size, dtype=np.bool_)
    assert (times <= shortest)[off_diagonal].all()
    assert (times <= travel[:size, :size])[off_diagonal].all()
