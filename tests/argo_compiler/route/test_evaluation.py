"""Costs, waits and charges of routes are those computed by hand."""

import numpy as np
import pytest

from argo_compiler.base.errors import ArgoError, Invalid
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
from argo_compiler.route.tour_pauses import TourPause, pauses_by_position


def line(*visits: Visit, chargers: int = 0, **more) -> RouteProblem:  # type: ignore[no-untyped-def]
    """Visits at 10, 20, … on a line, start and end at 0, chargers at 5; a distance of 1 takes 1."""
    points = np.array([*(10 * (k + 1) for k in range(len(visits))), 0, *([5] * chargers)])
    travel = np.abs(points[:, None] - points).astype(np.int64)
    names = tuple(f"dock {k}" for k in range(chargers))
    return RouteProblem(visits, travel, chargers=names, **more)


A, B, C = (Visit(name, service=2, prize=k + 1) for k, name in enumerate("ABC"))


def test_travel_and_service() -> None:
    worth = evaluate(line(A, B, C), Tour((2, 0, 1)))
    assert worth.feasible
    assert worth.arrivals == (30, 52, 64)
    assert worth.duration == 30 + 2 + 20 + 2 + 10 + 2 + 20
    assert worth.prize == 6


def test_a_robot_that_is_early_waits_and_one_that_is_late_is_a_violation() -> None:
    early = Visit("A", 2, earliest=25, latest=40)
    late = Visit("B", 2, latest=24)
    worth = evaluate(line(early, late), Tour((0, 1)))
    assert worth.waiting == 15
    assert worth.arrivals == (25, 37)
    assert worth.violations == ("B begins at 37, after 24",)
    assert worth.cost(Objective.TRAVEL) == worth.cost(Objective.DURATION) - 15


def test_a_round_is_repeated() -> None:
    problem = line(A, B, C, rounds=(Round("round 1", (0, 1), repeat=3),))
    # To A 10, then A, 10, B; twice more: back 10, A, 10, B; on to C and to the end.
    assert evaluate(problem, Tour((0, 1, 2))).duration == 10 + 14 + 2 * (10 + 14) + 12 + 30


def test_a_round_with_a_duration_is_left_when_that_has_passed() -> None:
    hard = line(A, B, C, rounds=(Round("round 1", (0, 1), repeat=0, duration=60),))
    # The robot may be at A or B. C is 20 from A and 10 from B, and the longer drive counts.
    assert evaluate(hard, Tour((0, 1, 2))).duration == 60 + 20 + 2 + 30
    soft = line(A, B, C, rounds=(Round("round 1", (0, 1), repeat=0, duration=60, soft=True),))
    # Repetitions end at 24, 48 and 72.
    assert evaluate(soft, Tour((0, 1, 2))).duration == 72 + 10 + 2 + 30


def test_a_charge_takes_as_long_as_its_energy() -> None:
    energy = np.abs(np.subtract.outer([10, 20, 0, 5], [10, 20, 0, 5])).astype(np.int64)
    battery = EnergyBudget(energy, capacity=40, used=8, overhead=3)
    problem = line(A, B, chargers=1, battery=battery)
    assert evaluate(problem, Tour((0, 1))).violations == ("the battery is empty",)
    worth = evaluate(problem, Tour((0, 1), {0: 0}))
    # To the charger 5; 13 used: the charge takes 16 with its overhead; 5 on to A.
    assert worth.feasible
    assert worth.arrivals[0] == 5 + 3 + 13 + 5


@pytest.mark.parametrize(
    ("order", "violation"),
    [
        ((1, 0, 2), "A before B"),
        ((0, 1), "C is left out"),
        ((0, 1, 2, 2), "a visit is made twice"),
    ],
)
def test_violations_are_named(order: tuple[int, ...], violation: str) -> None:
    problem = line(A, B, C, precedences=(Precedence((0, 1), "A before B"),))
    assert violation in evaluate(problem, Tour(order)).violations


def test_a_needed_visit_must_be_made_and_one_that_only_comes_before_need_not() -> None:
    optional = tuple(Visit(name, 2, mandatory=False) for name in "AB")
    loose = line(*optional, precedences=(Precedence((0, 1), "A before B"),))
    assert evaluate(loose, Tour((1,))).feasible
    needed = line(*optional, precedences=(Precedence((0, 1), "A before B", needed=True),))
    assert evaluate(needed, Tour((1,))).violations == ("A before B: the first is left out",)
    assert evaluate(needed, Tour((0,))).feasible


def test_a_round_must_not_be_interrupted() -> None:
    problem = line(A, B, C, rounds=(Round("round 1", (0, 1)),))
    assert evaluate(problem, Tour((0, 2, 1))).violations == (
        "round 1 is incomplete or interrupted",
    )


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"travel": np.zeros((2, 2), np.int64)}, "shape (2, 2), not (3, 3)"),
        ({"travel": np.zeros((3, 3))}, "float64, not int64"),
        ({"travel": np.full((3, 3), -1)}, "not from 0"),
        ({"visits": (A, Visit("B", -1))}, "B has a negative"),
        ({"visits": (A, Visit("B", 1 << 31))}, "use a larger unit"),
        ({"visits": (A, Visit("B", prize=1 << 50))}, "prizes add up"),
        ({"rounds": (Round("r", (0,), repeat=1 << 40),)}, "repeated too often"),
        ({"max_duration": -1}, "maximum duration is negative"),
        ({"unit": 0.0}, "unit of time"),
        ({"precedences": (Precedence((0, 7), "A before H"),)}, "A before H: there are only"),
        ({"rounds": (Round("r", (0, 0)),)}, "round r has no members, one twice"),
        ({"rounds": (Round("r", (0,), repeat=0),)}, "number of rounds or a duration"),
        ({"rounds": (Round("r", (0,)),), "visits": (Visit("A", latest=9), B)}, "which repetition"),
        ({"chargers": ("dock",), "travel": np.zeros((4, 4), np.int64)}, "no battery"),
    ],
)
def test_parts_that_do_not_fit_are_refused(wrong: dict, words: str) -> None:  # type: ignore[type-arg]
    parts = {"visits": (A, B), "travel": np.zeros((3, 3), np.int64), **wrong}
    with pytest.raises(ArgoError, match="the route problem has a mistake") as raised:
        RouteProblem(**parts)
    assert words in str(raised.value)
    assert NEVER > 0


def test_a_charge_within_a_round_is_a_violation() -> None:
    problem = RouteProblem(
        (Visit("a"), Visit("b")),
        np.ones((4, 4), np.int64),
        rounds=(Round("both", (0, 1)),),
        battery=EnergyBudget(np.ones((4, 4), np.int64), capacity=9),
        chargers=("dock",),
    )
    assert evaluate(problem, Tour((0, 1), {0: 0, 2: 0})).feasible
    within = evaluate(problem, Tour((0, 1), {1: 0})).violations
    assert within == ("it charges within a round, or outside of the order",)


@pytest.mark.parametrize("route", [Tour((2,)), Tour((-1, 0)), Tour((0, 1), {0: 1})])
def test_a_route_of_another_problem_is_refused(route: Tour) -> None:
    with pytest.raises(Invalid, match=r"a (visit|charger) that does not exist"):
        evaluate(RouteProblem((Visit("a"), Visit("b")), np.ones((3, 3), np.int64)), route)


EQUAL = np.full((4, 4), 10)
"""equal travel times, for which arrivals are easy to compute"""


def test_the_route_waits_at_visits_with_windows() -> None:
    visits = (Visit("a", 5, earliest=12), Visit("b", 5, earliest=50), Visit("c", 5, earliest=3))
    problem = RouteProblem(visits, EQUAL)
    found = pauses_by_position(problem, Tour((2, 0, 1)))
    # Without waiting: c at 10, a at 25, b at 40.
    assert found == {2: (TourPause(10, visit=1),)}
    assert evaluate(problem, Tour((2, 0, 1))).waiting == 10


def test_a_charge_returns_the_used_energy() -> None:
    battery = EnergyBudget(EQUAL, capacity=35, used=3, overhead=4)
    problem = RouteProblem(
        (Visit("a"), Visit("b", earliest=60)), EQUAL, battery=battery, chargers=("dock",)
    )
    route = Tour((0, 1), {1: 0, 2: 0})
    # At the first charge (20 to 47), 3 + two legs are used; at the second one, two legs.
    assert pauses_by_position(problem, route) == {
        1: (TourPause(27, charger=0), TourPause(3, visit=1)),
        2: (TourPause(24, charger=0),),
    }
    assert evaluate(problem, route).duration == 60 + 10 + 24 + 10
