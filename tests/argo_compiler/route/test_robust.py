"""The probability that a route is completed, and the search for robust routes."""

from dataclasses import replace
from itertools import permutations
from math import exp, log, log1p, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import binom, norm

from argo_compiler.base.errors import ArgoError
from argo_compiler.route import (
    NEVER,
    EnergyBudget,
    Objective,
    Precedence,
    Round,
    RouteProblem,
    Tour,
    Visit,
    evaluate,
)
from argo_compiler.route.robust import suggest_robust_route
from argo_compiler.route.robust_sampling import Draws, completion_probability, estimate_completion
from argo_compiler.route.robust_spread import CAUTIOUS, SIMULATED, TravelSpread
from tests.argo_compiler.route.random_problems import random_problem
from tests.conftest import examples

SAMPLES = 20_000
NEAR = 5.0 * 0.5 / sqrt(SAMPLES)
"""five standard deviations of an estimate"""


def chain(legs, service=0, **limits):
    """Problem with only one possible order of visits, and with given travel times between them."""
    n = len(legs) - 1
    travel = np.full((n + 1, n + 1), NEVER)
    for k, leg in enumerate(legs):
        travel[k - 1 if k else n, k] = leg
    problem = RouteProblem(tuple(Visit(f"{k}", service) for k in range(n)), travel, **limits)
    return problem, Tour(tuple(range(n)))


def probability(problem, route, samples=SAMPLES, seed=1, **spread):
    rng = np.random.default_rng(seed)
    return completion_probability(problem, route, TravelSpread(**spread), samples, rng)


def log_normal(ratio, deviation):
    """Probability that a log-normal factor of mean 1 is at most the ratio."""
    variance = log1p(deviation**2)
    return norm.cdf((log(ratio) + variance / 2) / sqrt(variance))


@st.composite
def routes(draw):
    """Random problems, each with a route that may or may not be feasible."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    problem = random_problem(rng)
    made = [v for v in range(problem.size) if problem.visits[v].mandatory or rng.random() < 0.6]
    order = [*map(int, rng.permutation(made))]
    for round_ in sorted(problem.rounds, key=lambda round_: len(round_.members)):
        inside = [v for v in order if v in round_.members]
        if inside and rng.random() < 0.9:  # most orders would split the round
            at = order.index(inside[0])
            inside += [v for v in round_.members if v not in inside]
            before = [v for v in order[:at] if v not in round_.members]
            order = before + inside + [v for v in order[at:] if v not in round_.members]
    charges = {}
    if problem.chargers:
        charges = {
            int(k): int(rng.integers(len(problem.chargers)))
            for k in range(len(order) + 1)
            if rng.random() < 0.3
        }
    return problem, Tour(tuple(order), charges)


@settings(max_examples=examples(150))
@given(case=routes())
def test_without_spread_the_simulation_agrees_with_the_evaluation(case):
    problem, route = case
    exact = evaluate(problem, route)
    found = probability(problem, route, samples=3)
    assert found.probability == float(exact.feasible)
    if exact.feasible:
        assert (found.duration, found.duration_95) == (exact.duration, exact.duration)


def test_an_infeasible_order_is_never_completed():
    problem, _ = chain([0, 0, 0])
    problem = replace(problem, visits=(*problem.visits, Visit("2")), travel=np.zeros((4, 4), int))
    with_round = replace(problem, rounds=(Round("round", (0, 2)),))
    for order, expected in [
        ((0, 1, 2), 0.0),
        ((1, 2, 0), 1.0),
        ((0, 1), 0.0),
        ((2, 2, 0, 1), 0.0),
    ]:
        assert probability(with_round, Tour(order), samples=2).probability == expected
    ordered = replace(problem, precedences=(Precedence((2, 0), "2 before 0"),))
    for order, expected in [((0, 1, 2), 0.0), ((1, 2, 0), 1.0)]:
        assert probability(ordered, Tour(order), samples=2).probability == expected


@settings(max_examples=examples(40))
@given(case=routes(), limits=st.tuples(*[st.integers(0, 2000)] * 2), seed=st.integers(0, 99))
def test_more_time_is_never_worse(case, limits, seed):
    problem, route = case
    less, more = (
        probability(replace(problem, max_duration=limit), route, 50, seed, common=0.2, way=0.2)
        for limit in sorted(limits)
    )
    assert less.probability <= more.probability
    assert less.low <= less.probability <= less.high
    assert less.duration == more.duration


@pytest.mark.parametrize("limit", [80, 100, 130])
def test_one_leg_and_one_common_factor(limit):
    expected = log_normal(limit / 100, 0.3)
    problem, route = chain([100], max_duration=limit)
    assert probability(problem, route, way=0.3).probability == pytest.approx(expected, abs=NEAR)
    problem, route = chain([30, 20, 40, 10], max_duration=limit)
    found = probability(problem, route, common=0.3)
    assert found.probability == pytest.approx(expected, abs=NEAR)
    assert found.low < expected < found.high
    assert found.duration == pytest.approx(100, abs=5 * 30 / sqrt(SAMPLES))


@pytest.mark.parametrize("margin", [-1.0, 0.0, 1.5])
def test_many_legs_are_normal(margin):
    legs = [20 + k % 7 for k in range(80)]
    deviation = 0.1 * sqrt(sum(leg**2 for leg in legs))
    problem, route = chain(legs, max_duration=round(sum(legs) + margin * deviation))
    exact = norm.cdf((problem.max_duration - sum(legs)) / deviation)
    found = probability(problem, route, way=0.1).probability
    assert found == pytest.approx(exact, abs=NEAR + 0.005)  # the sum is not quite normal


def test_repeated_measurements_are_binomial():
    problem, route = chain([5] * 11, service=10, max_duration=55 + 100 + 25)
    found = probability(problem, route, repeat_chance=0.2).probability
    assert found == pytest.approx(binom.cdf(2, 10, 0.2), abs=NEAR)


def test_delays():
    problem, route = chain([10], max_duration=40)
    found = probability(problem, route, delay_chance=0.4, delay=20.0).probability
    assert found == pytest.approx(1 - 0.4 * exp(-30 / 20), abs=NEAR)
    tenths = replace(problem, unit=0.1, travel=problem.travel * 10, max_duration=400)
    again = probability(tenths, route, delay_chance=0.4, delay=20.0).probability
    assert again == found


def test_waiting_absorbs_delays():
    problem, route = chain([100, 50])
    visit = replace(problem.visits[0], earliest=300, latest=310)
    windowed = replace(problem, visits=(visit,), max_duration=350)
    found = probability(windowed, route, common=0.1)
    assert 0.45 < found.probability < 0.6  # after the window the second leg decides
    assert probability(replace(windowed, max_duration=400), route, common=0.1).probability == 1.0


def test_an_empty_battery_ends_a_route():
    problem, route = chain([100, 100])
    energy = np.where(problem.travel == NEVER, 0, problem.travel)
    powered = replace(problem, battery=EnergyBudget(energy, capacity=230))
    expected = log_normal(1.15, 0.2)
    found = probability(powered, route, common=0.2).probability
    assert found == pytest.approx(expected, abs=NEAR)
    assert probability(powered, route).probability == 1.0


def test_all_routes_have_the_same_samples():
    problem, route = chain([30, 20, 40], max_duration=90)
    draws = Draws(CAUTIOUS, 500, np.random.default_rng(3))
    assert estimate_completion(problem, route, draws) == estimate_completion(problem, route, draws)
    assert probability(problem, route, 500, 3, way=0.2) == probability(
        problem, route, 500, 3, way=0.2
    )
    with pytest.raises(ArgoError, match="0 samples"):
        probability(problem, route, samples=0)


UNEVEN = np.array([
    # even: 0, 1 in 41 each; uneven: 1, 0 in 10, 10 and 100
    [0, 41, 100],
    [10, 0, 41],
    [41, 10, 0],
])  # fmt: skip


def test_a_longer_route_may_be_more_robust():
    problem = RouteProblem((Visit("a"), Visit("b")), UNEVEN, max_duration=150)
    spread = TravelSpread(way=0.3)
    found = suggest_robust_route(problem, spread, time_limit=2.0)
    assert found.nominal.order == (1, 0)
    assert found.route.order == (0, 1)
    assert found.completion.probability > found.nominal_completion.probability + 0.03
    assert found.dropped_for_robustness == ()


@pytest.mark.parametrize("objective", [Objective.DURATION, Objective.PRIZE])
def test_the_prize_is_maximised_at_the_confidence(objective):
    travel = np.abs(np.subtract.outer([10, 20, 30, 40, 0], [10, 20, 30, 40, 0]))
    visits = tuple(Visit(f"{k}", 20, mandatory=k == 0, prize=3) for k in range(4))
    problem = RouteProblem(visits, travel, max_duration=161, objective=objective)
    found = suggest_robust_route(problem, CAUTIOUS, time_limit=2.0, confidence=0.9)
    assert len(found.nominal.order) == 4
    assert found.nominal_completion.probability < 0.9 <= found.completion.probability
    assert len(found.route.order) == 3
    assert found.prize == 9
    assert found.dropped_for_robustness == (3,)
    risky = suggest_robust_route(problem, CAUTIOUS, time_limit=2.0, confidence=0.01)
    assert len(risky.route.order) == 4


@settings(max_examples=examples(5))
@given(seed=st.integers(0, 999))
def test_never_less_sure_than_the_usual_route(seed):
    problem = random_problem(np.random.default_rng(seed))
    try:
        found = suggest_robust_route(problem, CAUTIOUS, time_limit=0.6, seed=seed, confidence=1.0)
    except ArgoError:
        return
    assert found.completion.probability >= found.nominal_completion.probability
    limitless = replace(
        problem,
        visits=tuple(replace(visit, earliest=0, latest=None) for visit in problem.visits),
        max_duration=None,
    )
    if problem.battery is None:
        assert evaluate(limitless, found.route).feasible


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_route_is_near_the_most_robust_order(seed):
    rng = np.random.default_rng(seed)
    problem = RouteProblem(
        tuple(Visit(f"{k}", 20) for k in range(5)), rng.integers(20, 300, (6, 6)), max_duration=700
    )
    found = suggest_robust_route(problem, CAUTIOUS, time_limit=2.0, seed=seed, confidence=1.0)
    draws = Draws(CAUTIOUS, 2000, rng)
    every = [estimate_completion(problem, Tour(order), draws) for order in permutations(range(5))]
    best = max(estimate.probability for estimate in every)
    assert 0.2 < best < 1.0
    assert estimate_completion(problem, found.route, draws).probability >= best - 0.01


def test_a_perfect_nominal_route_ends_the_search():
    problem = RouteProblem((Visit("a"), Visit("b")), UNEVEN)
    found = suggest_robust_route(problem, SIMULATED, time_limit=5.0)
    assert (found.tried, found.route) == (1, found.nominal.route)
    assert found.completion.probability == 1.0


def test_a_problem_without_a_route_is_refused():
    problem, _ = chain([100, 100], max_duration=150)
    with pytest.raises(ArgoError, match="there is no route"):
        suggest_robust_route(problem, CAUTIOUS, time_limit=1.0)
    with pytest.raises(ArgoError, match="a confidence of 0"):
        suggest_robust_route(problem, CAUTIOUS, confidence=0.0)


def test_each_order_is_counted_once():
    problem = RouteProblem((Visit("a"), Visit("b")), UNEVEN, max_duration=150)
    found = suggest_robust_route(problem, TravelSpread(way=0.3), time_limit=2.0)
    assert found.tried == 2
