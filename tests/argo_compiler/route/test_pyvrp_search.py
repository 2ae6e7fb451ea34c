"""PyVRP as the only route solver, under a limit of work."""

from dataclasses import replace

import numpy as np
import pytest

from argo_compiler.route import NEVER, Precedence, Round, RouteProblem, Visit, evaluate
from argo_compiler.route.problem import EnergyBudget
from argo_compiler.route.pyvrp_search import PyvrpSearch
from argo_compiler.route.suggested import RouteSuggestion
from argo_compiler.route.suggestion import suggest_route
from tests.argo_compiler.route.random_problems import random_problem
from tests.argo_compiler.route.reference import best_value

pytest.importorskip("pyvrp")


def suggest(problem: RouteProblem, work: float = 0.04, seed: int = 1) -> RouteSuggestion:
    return suggest_route(
        problem, None, seed, explain=False, work_limit=work, solvers=(PyvrpSearch(),)
    )


def plain_problem(n: int, seed: int = 0) -> RouteProblem:
    """Visits in a square, each with a prize."""
    rng = np.random.default_rng(seed)
    points = rng.uniform(0, 100, (n + 1, 2))
    travel = np.rint(np.abs(points[:, None] - points).sum(axis=2)).astype(np.int64)
    visits = tuple(Visit(f"{k}", int(rng.integers(0, 9)), prize=k + 1) for k in range(n))
    return RouteProblem(visits, travel)


def test_best_routes_of_small_problems_with_any_constraints_it_supports():
    covered: set[str] = set()
    for seed in range(60):
        problem = replace(random_problem(np.random.default_rng(seed), 6), precedences=())
        if problem.battery is not None:
            continue
        counted = [replace(r, repeat=max(1, r.repeat), duration=0) for r in problem.rounds]
        problem = replace(problem, rounds=tuple(counted))
        best, suggestion = best_value(problem), suggest(problem)
        if best is None:
            assert suggestion.route is None
            continue
        assert suggestion.route is not None, seed
        assert evaluate(problem, suggestion.route).feasible
        assert (suggestion.prize, suggestion.cost) == best, seed
        covered |= {"rounds"} if problem.rounds else set()
        covered |= {"windows"} if any(v.latest is not None for v in problem.visits) else set()
        covered |= {"prizes"} if problem.selective else set()
        covered |= {"no path"} if (problem.travel == NEVER).any() else set()
    assert covered == {"rounds", "windows", "prizes", "no path"}


def test_same_route_for_the_same_seed_and_work():
    problem = plain_problem(40)
    optional = tuple(replace(visit, mandatory=False) for visit in problem.visits)
    for case in (problem, replace(problem, visits=optional, max_duration=300)):
        first, again = suggest(case), suggest(case)
        assert first.route == again.route
        curves = [[(p.work, p.prize, p.cost) for p in s.history] for s in (first, again)]
        assert curves[0] == curves[1]


def test_each_better_route_is_offered_at_once():
    problem = plain_problem(60)
    costs: list[int] = []
    found = suggest_route(
        problem,
        None,
        work_limit=0.3,
        solvers=(PyvrpSearch(),),
        on_best=lambda _, tour: costs.append(evaluate(problem, tour).duration),
    )
    assert len(costs) > 3
    assert costs == sorted(costs, reverse=True)
    assert costs[-1] == found.cost


def test_the_search_improves_a_given_route():
    problem = plain_problem(60)
    simple = suggest_route(problem, None, work_limit=0.1, solvers=("first rules",))
    better = suggest_route(problem, None, work_limit=0.1, solvers=("first rules", PyvrpSearch()))
    assert better.cost < simple.cost


def test_any_prize_comes_before_the_cost_also_if_prizes_are_huge():
    problem = plain_problem(6)
    for worth in (1, 1 << 35):
        visits = tuple(replace(v, mandatory=False, prize=v.prize * worth) for v in problem.visits)
        limited = replace(problem, visits=visits, max_duration=250)
        found = suggest(limited)
        assert (found.prize, found.cost) == best_value(limited)


def test_the_empty_route_is_offered_only_if_it_is_feasible():
    travel = np.array([[0, NEVER], [NEVER, 7]])
    visit = Visit("a", mandatory=False, prize=1)
    found = suggest(RouteProblem((visit,), travel, max_duration=7))
    assert found.route is not None
    assert found.order == ()
    assert suggest(RouteProblem((visit,), travel, max_duration=6)).route is None
    assert suggest(RouteProblem((), travel[1:, 1:])).cost == 7


def test_unsupported_problems():
    problem = plain_problem(4)
    ordered = replace(problem, precedences=(Precedence((0, 1), "0 before 1"),))
    within = replace(ordered, rounds=(Round("r", (0, 1), 2),))
    across = replace(ordered, rounds=(Round("r", (1, 2), 2),))
    powered = replace(problem, battery=EnergyBudget(problem.travel.copy(), 1000))
    solver = PyvrpSearch()
    assert [solver.supports(p) for p in (problem, ordered, within, powered)] == [
        True,
        False,
        True,
        False,
    ]
    assert suggest(within).order.index(0) + 1 == suggest(within).order.index(1)
    assert suggest(across).route is None
