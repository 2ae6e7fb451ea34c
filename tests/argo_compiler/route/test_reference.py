"""Evaluations and claims about routes agree with a reference implementation."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.route import (
    NEVER,
    EnergyBudget,
    Objective,
    Precedence,
    Round,
    RouteProblem,
    RouteSuggestion,
    Tour,
    Visit,
    evaluate,
    suggest_route,
)
from tests.argo_compiler.route.odd_problems import odd_problem, odd_tour
from tests.argo_compiler.route.reference import Best, Reference
from tests.conftest import examples, seeds

NUMBERS = st.integers(0, 2**32)
"""numbers of odd problems"""
UNPROVEN = "not proven"
TIME_LIMITS = (2.0, 60.0)
"""time limits in s, tried until one leads to a proof: most problems take some hundredths"""

TRAVEL = np.array([[50, 10, 100], [12, 60, 13], [14, 15, 16]])
"""travel times between two visits, the start and the end"""


def two_visits(*rounds: Round) -> RouteProblem:
    return RouteProblem((Visit("a", 1), Visit("b", 2)), TRAVEL.copy(), rounds=rounds)


def numbered(number: int, timed: bool) -> RouteProblem:
    """Return the odd problem with this number."""
    return odd_problem(np.random.default_rng([number, timed]), timed)


def error_in(problem: RouteProblem, suggestion: RouteSuggestion, best: Best | None) -> str:
    """Return the first false claim of a suggestion, or that it is not proven; empty: neither."""
    if suggestion.route is None:
        if suggestion.infeasible and best is not None:
            return "false infeasibility"
        if suggestion.proven:
            return "a proof of a route that there is not"
    else:
        reference = Reference(problem)
        end = reference.evaluate(suggestion.route)
        if end is None or best is None:
            return "an infeasible route"
        if (reference.prize(suggestion.route.order), reference.cost(end)) != (
            suggestion.prize,
            suggestion.cost,
        ):
            return "wrong prize or cost"
        if suggestion.proven and (suggestion.prize, suggestion.cost) != (best.prize, best.cost):
            return "false proof"
        if suggestion.proven and (suggestion.prize_bound, suggestion.bound) != (
            suggestion.prize,
            suggestion.cost,
        ):
            return "proven, but not by its bounds"
        if set(suggestion.dropped) != set(range(problem.size)) - set(suggestion.route.order):
            return "wrong visits left out"
    if best is not None:
        if suggestion.prize_bound < best.prize:
            return "a route wins more than the bound"
        if suggestion.prize_bound == best.prize and suggestion.bound > best.cost:
            return "a route costs less than the bound"
        if any(p.prize_bound < best.prize or p.bound > best.cost for p in suggestion.history):
            return "a bound in the history is wrong"
    return "" if suggestion.proven or suggestion.infeasible else UNPROVEN


def require_true(problem: RouteProblem) -> None:
    """Require that all claims of `suggest_route` are true, and that it proves its result."""
    best = Reference(problem).best()
    for time_limit in TIME_LIMITS:
        suggestion = suggest_route(problem, time_limit, explain=False)
        error = error_in(problem, suggestion, best)
        if error != UNPROVEN:
            break
    assert not error, (problem, suggestion, best)


@pytest.mark.parametrize("timed", [False, True])
def test_evaluation_agrees_with_the_reference(timed: bool) -> None:
    rng = np.random.default_rng([timed, 2])
    possible = 0
    for number in seeds(800):
        problem = numbered(number, timed)
        reference = Reference(problem)
        for _ in range(5):
            tour = odd_tour(rng, problem)
            evaluation, end = evaluate(problem, tour), reference.evaluate(tour)
            assert evaluation.feasible == (end is not None), (number, tour, evaluation.violations)
            if end is not None:
                possible += 1
                assert evaluation.prize == reference.prize(tour.order)
                assert (evaluation.duration, evaluation.waiting) == (end.time, end.waiting)
                assert evaluation.cost(problem.objective) == reference.cost(end), (number, tour)
    assert possible > examples(400)


@settings(max_examples=examples(1600))
@given(NUMBERS)
def test_every_claim_is_true(number: int) -> None:
    require_true(numbered(number, timed=False))


@settings(max_examples=examples(400))
@given(NUMBERS)
def test_every_claim_is_true_of_rounds_that_last_for_some_time(number: int) -> None:
    require_true(numbered(number, timed=True))


@pytest.mark.parametrize(
    ("duration", "soft", "end"),
    [
        (26, False, 26 + 100),  # interrupted, left from the member farthest from the end
        (27, False, 27 + 13),  # complete exactly when the duration has passed
        (28, False, 28 + 100),
        (27, True, 27 + 13),
        (28, True, 27 + 25 + 13),  # one more repetition
    ],
)
def test_when_a_round_ends(duration: int, soft: bool, end: int) -> None:
    problem = two_visits(Round("r", (0, 1), repeat=0, duration=duration, soft=soft))
    robot = Reference(problem).evaluate(Tour((0, 1)))
    assert robot is not None
    assert robot.time == evaluate(problem, Tour((0, 1))).duration == end


def test_the_later_of_two_rounds_with_the_same_members_is_the_inner_one() -> None:
    thrice, timed = Round("a", (0, 1), repeat=3), Round("b", (0, 1), 0, duration=28, soft=True)
    for rounds, end in (((timed, thrice), 27 + 2 * 25), ((thrice, timed), 27 + 25 + 4 * 25)):
        problem = two_visits(*rounds)
        robot = Reference(problem).evaluate(Tour((0, 1)))
        assert robot is not None
        assert robot.time == evaluate(problem, Tour((0, 1))).duration == end + 13


def test_nested_soft_rounds_with_an_optional_visit() -> None:
    travel = [
        [2, 3, 2, 2, 3],
        [2, 2, 1, 0, 3],
        [2, 0, 0, 2, 3],
        [1, 2, 0, 1, 3],
        [NEVER, 2, 1, 2, 3],
    ]
    service_and_prize = [(2, 3), (0, 4), (2, 4), (8, 2)]
    problem = RouteProblem(
        tuple(Visit(f"{k}", s, k == 1, p) for k, (s, p) in enumerate(service_and_prize)),
        np.array(travel),
        precedences=(Precedence((0, 3), "0 before 3", needed=True),),
        rounds=(
            Round("r0", (2, 0, 3), repeat=0, duration=11, soft=True),
            Round("r1", (2,), repeat=0, duration=25, soft=True),
            Round("r2", (1,), repeat=2, duration=22, soft=True),
        ),
        max_duration=46,
    )
    suggestion = suggest_route(problem, explain=False)
    assert (suggestion.proven, suggestion.prize, suggestion.cost) == (True, 13, 46)
    assert suggestion.order == (1, 2, 0, 3)
    require_true(problem)


@pytest.mark.parametrize("seed", range(20))
def test_a_round_with_a_duration_and_the_same_round_once(seed: int) -> None:
    rng = np.random.default_rng([seed, 3])
    longest = int(rng.choice([5, 20, 60]))
    rounds = [
        Round("for a time", (1, 3, 2, 4), repeat=0, duration=107),
        Round("once", (1, 3, 2, 4), repeat=1),
        Round("alone", (0,), repeat=1),
    ]
    problem = RouteProblem(
        tuple(Visit(f"{k}", int(rng.integers(longest))) for k in range(6)),
        rng.integers(0, longest + 1, (7, 7)),
        rounds=tuple(rounds[int(k)] for k in rng.permutation(3)),
        objective=Objective.TRAVEL,
    )
    require_true(problem)


@pytest.mark.parametrize("seed", range(10))
def test_a_round_of_all_with_a_battery_and_a_charger(seed: int) -> None:
    rng = np.random.default_rng([seed, 4])
    for _ in range(20):
        longest = int(rng.integers(1, 5))
        problem = RouteProblem(
            tuple(Visit(f"{k}", int(rng.integers(0, 3))) for k in range(4)),
            rng.integers(0, longest + 1, (6, 6)),
            rounds=(Round("r", (0, 1, 2, 3), repeat=0, duration=6, soft=True),),
            battery=EnergyBudget(
                rng.integers(0, longest + 1, (6, 6)),
                capacity=int(rng.integers(longest, 6 * longest)),
                used=int(rng.integers(0, longest + 1)),
                overhead=int(rng.integers(0, 3)),
            ),
            chargers=("c",),
        )
        require_true(problem)
