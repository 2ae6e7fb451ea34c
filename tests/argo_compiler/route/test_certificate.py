"""Claims of route suggestions are confirmed, refuted or left open by independent checks."""

import ast
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from argo_compiler.route import (
    NEVER,
    Objective,
    Round,
    RouteProblem,
    RouteSuggestion,
    Tour,
    Visit,
    evaluate,
    suggest_route,
)
from argo_compiler.route import certificate as certificate_module
from argo_compiler.route.blocks import Blocks
from argo_compiler.route.certificate import Certificate, Claim, Judgement, certify
from argo_compiler.route.enumeration import Enumeration
from argo_compiler.route.relaxation import Relaxation
from tests.argo_compiler.route.random_problems import random_problem

CHECKING = {"blocks", "enumeration", "relaxation", "certificate"}
MAY_USE = CHECKING | {"problem", "evaluation", "suggested"}


def problems(first: int, count: int, most: int = 5) -> list[tuple[RouteProblem, RouteSuggestion]]:
    """Random small problems with their suggestions."""
    drawn = [
        random_problem(np.random.default_rng(seed), most) for seed in range(first, first + count)
    ]
    return [(p, suggest_route(p, time_limit=60.0, explain=False)) for p in drawn]


def check(problem: RouteProblem, suggestion: RouteSuggestion) -> Certificate:
    """Certificate without a limit of time."""
    return certify(problem, suggestion, 1.0, lambda: 0.0)


def judged(certificate: Certificate, claim: Claim) -> Judgement:
    found = certificate.find(claim)
    assert found is not None
    return found.judgement


@pytest.mark.parametrize("part", range(3))
def test_true_claims_are_confirmed(part: int) -> None:
    for problem, suggestion in problems(20 * part, 12):
        certificate = check(problem, suggestion)
        assert {one.judgement for one in certificate.claims} == {Judgement.CONFIRMED}
        claim = Claim.NONE if suggestion.route is None else Claim.BEST
        assert certificate.find(claim)
        assert not certificate.refuted


def test_wrong_claims_are_refuted_by_counterexamples() -> None:
    raised = lowered = found = 0
    for problem, best in problems(100, 24):
        if best.route is None:
            continue
        found += 1
        wrong = {
            Claim.BOUND: replace(best, bound=best.bound + 1),
            Claim.PRIZE_BOUND: replace(best, prize_bound=best.prize - 1),
            Claim.NONE: replace(best, route=None, prize=None, cost=None, infeasible=True),
            Claim.ROUTE: replace(best, cost=best.cost - 1),
        }
        for claim, suggestion in wrong.items():
            made = check(problem, suggestion).find(claim)
            assert made is not None
            assert made.judgement is Judgement.REFUTED
            if claim is not Claim.ROUTE:
                assert made.counterexample is not None
                worth = evaluate(problem, made.counterexample)
                assert worth.feasible
                assert (worth.prize, worth.cost(problem.objective)) == (best.prize, best.cost)
        raised += best.cost > 0
        lowered += best.prize > 0
    assert min(raised, lowered) > found // 2


def test_a_route_that_is_not_the_best_is_refuted() -> None:
    worse = 0
    for problem, best in problems(200, 30):
        if best.route is None or problem.selective or len(best.order) < 2:
            continue
        reversed_tour = Tour(best.order[::-1])
        worth = evaluate(problem, reversed_tour)
        cost = worth.cost(problem.objective)
        suggestion = replace(best, route=reversed_tour, cost=cost, bound=cost)
        certificate = check(problem, suggestion)
        expected = Judgement.CONFIRMED if worth.feasible else Judgement.REFUTED
        assert judged(certificate, Claim.ROUTE) is expected
        if cost > best.cost:
            worse += 1
            assert judged(certificate, Claim.BEST) is Judgement.REFUTED
    assert worse > 3


def test_unknown_visits_and_wrong_dropped_visits_are_refuted() -> None:
    problem, best = next(p for p in problems(300, 20) if p[1].order)
    other = replace(best, route=Tour((*best.order, problem.size)))
    assert judged(check(problem, other), Claim.ROUTE) is Judgement.REFUTED
    other = replace(best, dropped=(best.order[0],))
    assert judged(check(problem, other), Claim.ROUTE) is Judgement.REFUTED


@pytest.mark.parametrize("part", range(3))
def test_dominance_keeps_the_best_route_and_relaxations_are_bounds(part: int) -> None:
    tight = 0
    for seed in range(400 + 30 * part, 420 + 30 * part):
        problem = random_problem(np.random.default_rng(seed), 5)
        blocks = Blocks(problem, lambda: None)
        all_routes, undominated = Enumeration(blocks, None, int), Enumeration(blocks, None, int)
        all_routes.run(use_dominance=False)
        undominated.run(use_dominance=True)
        relaxation = Relaxation(blocks, lambda: 0.0, 1.0)
        prize = relaxation.prize_bound(-1)
        if all_routes.best is None:
            assert undominated.best is None
            tight += prize is None
            continue
        assert undominated.best is not None
        best, same = (evaluate(problem, route) for route in (all_routes.best, undominated.best))
        assert best.feasible
        assert same.feasible
        cost = best.cost(problem.objective)
        assert (best.prize, cost) == (same.prize, same.cost(problem.objective))
        assert prize is not None
        assert prize >= best.prize
        least = relaxation.cost_bound(best.prize, NEVER)
        assert least is not None
        assert least <= cost
        tight += (prize, least) == (best.prize, cost)
    assert tight > 8


def test_a_relaxation_confirms_bounds_of_problems_too_large_to_enumerate() -> None:
    rng = np.random.default_rng(0)
    travel = rng.integers(1, 1000, (31, 31)).astype(np.int64)
    problem = RouteProblem(tuple(Visit(f"checkpoint {k}", 5) for k in range(30)), travel)
    best = suggest_route(problem, 10.0, explain=False)
    certificate = check(problem, replace(best, bound=best.bound - 200, proven=False))
    assert judged(certificate, Claim.BOUND) is Judgement.CONFIRMED


def test_large_rounds_count_with_one_repetition_at_least() -> None:
    travel = np.full((11, 11), 10, np.int64)
    visits = tuple(Visit(f"checkpoint {k}", 5) for k in range(10))
    for round_, least in ((Round("patrol", tuple(range(9)), 2), 160), (_timed(50), 75)):
        problem = RouteProblem(visits, travel, (), (round_,))
        suggestion = RouteSuggestion(None, None, 0, None, least, proven=False)
        assert judged(check(problem, suggestion), Claim.BOUND) is Judgement.CONFIRMED
        certificate = check(problem, replace(suggestion, bound=least + 1))
        assert judged(certificate, Claim.BOUND) is Judgement.OPEN
        assert certificate.claims[-1].shown == (0, least)


def _timed(duration: int) -> Round:
    return Round("patrol", tuple(range(9)), 0, duration)


def test_the_best_order_of_a_round_may_be_a_longer_cycle() -> None:
    """The shortest cycle is not always the best order of a round with a duration."""
    travel = np.array([[0, 0, 4, 24], [8, 0, 32, 45], [59, 19, 0, 10], [4, 49, 21, 4]], np.int64)
    visits = tuple(Visit(f"checkpoint {k}", s) for k, s in enumerate((16, 19, 2)))
    problem = RouteProblem(visits, travel, (), (Round("patrol", (1, 0, 2), 0, 67, soft=True),))
    assert evaluate(problem, Tour((1, 0, 2))).duration == 108
    assert evaluate(problem, Tour((0, 1, 2))).duration == 83
    wrong = RouteSuggestion(Tour((1, 0, 2)), 0, 0, 108, 108, proven=True)
    certificate = check(problem, wrong)
    assert judged(certificate, Claim.ROUTE) is Judgement.CONFIRMED
    refuted = certificate.find(Claim.BEST)
    assert refuted in certificate.refuted
    assert refuted is not None
    assert refuted.counterexample == Tour((0, 1, 2))


def test_waiting_counts_only_where_it_costs() -> None:
    travel = np.full((2, 2), 10, np.int64)
    for objective, cost in (
        (Objective.DURATION, 110),
        (Objective.TRAVEL, 20),
        (Objective.PRIZE, 0),
    ):
        problem = RouteProblem((Visit("late", earliest=100),), travel, objective=objective)
        best = suggest_route(problem, 5.0)
        assert best.cost == cost
        assert all(o.judgement is Judgement.CONFIRMED for o in check(problem, best).claims)
        wrong = replace(best, bound=cost + 1)
        assert judged(check(problem, wrong), Claim.BOUND) is Judgement.REFUTED


def test_without_time_only_the_route_is_checked() -> None:
    ticks = iter(range(10**9))
    problem, best = next(p for p in problems(500, 20, 8) if len(p[1].order or ()) > 6)
    certificate = certify(problem, replace(best, bound=best.cost), 1e-9, lambda: float(next(ticks)))
    assert judged(certificate, Claim.ROUTE) is Judgement.CONFIRMED
    assert not certificate.refuted


def test_the_checks_use_no_code_of_the_solvers() -> None:
    folder = Path(certificate_module.__file__).parent
    for name in CHECKING:
        tree = ast.parse((folder / f"{name}.py").read_text())
        modules = {node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
        used = {m.rpartition(".")[2] for m in modules if m.startswith("argo_compiler.route")}
        assert used <= MAY_USE
    for path in folder.glob("*.py"):
        if path.stem not in CHECKING:
            named = {
                node.module
                for node in ast.walk(ast.parse(path.read_text()))
                if isinstance(node, ast.ImportFrom)
            }
            assert not named & {
                f"argo_compiler.route.{name}" for name in CHECKING - {"certificate"}
            }
