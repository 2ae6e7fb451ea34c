"""A problem without a route has a smallest infeasible subset, in the mission's words."""

import json
from dataclasses import replace
from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest

from argo_compiler.files.route_problem_file import route_suggestion_text
from argo_compiler.route import NEVER, Precedence, Round, RouteProblem, Visit, suggest_route
from argo_compiler.route.infeasible_subset import requirements, with_only_requirements
from tests.argo_compiler.route.random_problems import random_problem
from tests.argo_compiler.route.reference import best_value


def hall(count: int, **more) -> RouteProblem:  # type: ignore[no-untyped-def]
    """Checkpoints 1, 2, … ten units of time from each other and from the start and end."""
    visits = more.pop("visits", tuple(Visit(f"checkpoint {k + 1}", 5) for k in range(count)))
    travel = more.pop("travel", np.full((count + 1, count + 1), 10, np.int64))
    return RouteProblem(visits, travel, **more)


def test_two_contradicting_precedences() -> None:
    problem = hall(
        9,
        precedences=(
            Precedence((0, 3), "checkpoint 1 before checkpoint 4"),
            Precedence((3, 7), "precise order 4, 8"),
            Precedence((7, 3), "checkpoint 8 before checkpoint 4"),
        ),
    )
    made = suggest_route(problem)
    assert made.infeasible
    assert made.route is None
    assert made.infeasible_subset == ("precise order 4, 8", "checkpoint 8 before checkpoint 4")


def test_the_shortest_of_several_cycles() -> None:
    pairs = [(0, 1), (1, 2), (2, 3), (3, 0), (2, 0)]
    problem = hall(
        5, precedences=tuple(Precedence(pair, f"{pair[0]} before {pair[1]}") for pair in pairs)
    )
    assert suggest_route(problem).infeasible_subset == ("0 before 1", "1 before 2", "2 before 0")


def test_too_little_time_names_as_few_visits_as_do_not_fit() -> None:
    problem = hall(6, max_duration=50, unit=60.0)
    # Three visits take 55 units, two 40.
    made = suggest_route(problem)
    assert len(made.infeasible_subset) == 4
    assert made.infeasible_subset[-1] == "within 50 min"
    assert all(words.endswith("is visited") for words in made.infeasible_subset[:3])
    assert "fewer requirements" in made.reasons[-1]


def test_a_window_against_a_precedence() -> None:
    visits = (
        Visit("checkpoint 1", 5, latest=20),
        Visit("checkpoint 2", 5, earliest=300, latest=400),
        Visit("checkpoint 3", 5, latest=500),
    )
    problem = hall(
        3, visits=visits, precedences=(Precedence((1, 0), "checkpoint 2 before checkpoint 1"),)
    )
    assert suggest_route(problem).infeasible_subset == (
        "checkpoint 2 before checkpoint 1",
        "checkpoint 1 by 20 s",
    )


def test_a_checkpoint_that_can_not_be_reached() -> None:
    travel = np.full((4, 4), 10, np.int64)
    travel[:, 1] = NEVER
    assert suggest_route(hall(3, travel=travel)).infeasible_subset == ("checkpoint 2 is visited",)


def test_a_round_against_a_precedence() -> None:
    problem = hall(
        3,
        rounds=(Round("round of floor 2", (0, 1), repeat=2),),
        precedences=(Precedence((0, 2, 1), "precise order 1, 3, 2"),),
    )
    assert suggest_route(problem).infeasible_subset == (
        "precise order 1, 3, 2",
        "round of floor 2 is complete and without interruption",
    )


@pytest.mark.parametrize("seed", range(0, 90, 3))
def test_an_infeasible_subset_is_infeasible_and_smaller_ones_are_not(seed: int) -> None:
    problem = random_problem(np.random.default_rng(seed), 4)
    if best_value(problem) is not None:
        return
    made = suggest_route(problem)
    assert made.infeasible_subset
    all_requirements = requirements(problem)
    others = [r for r in all_requirements if r.kind != "visit"]
    visits = [r for r in all_requirements if r.kind == "visit"]
    clash = [r for r in others if r.words in made.infeasible_subset]
    assert best_value(with_only_requirements(problem, visits + clash)) is None
    # No smaller number of requirements is infeasible with all the visits.
    for fewer in combinations(others, max(0, len(clash) - 1)):
        if len(clash):
            assert best_value(with_only_requirements(problem, [*visits, *fewer])) is not None


def test_nothing_of_a_suggestion_without_a_route_reads_as_one() -> None:
    made = suggest_route(hall(3, max_duration=1))
    described = (made.route, made.order, made.charges, made.dropped, made.prize, made.cost)
    assert described == (None,) * 6
    assert (made.infeasible, made.proven, made.gap) == (True, False, None)
    data = json.loads(route_suggestion_text(made))
    assert [data[name] for name in ("route", "prize", "cost", "dropped")] == [None] * 4
    assert (data["infeasible"], data["proven"]) == (True, False)


def test_a_search_that_finds_nothing_in_time_proves_nothing() -> None:
    unfit = SimpleNamespace(name="unfit", supports=lambda _: False)
    made = suggest_route(hall(3), 0.5, solvers=(unfit,))  # type: ignore[arg-type]
    assert (made.route, made.order, made.prize, made.cost) == (None,) * 4
    assert (made.infeasible, made.proven) == (False, False)


def test_a_route_without_visits_is_none_that_is_missing() -> None:
    problem = hall(2, max_duration=10)
    optional = tuple(replace(visit, mandatory=False, prize=1) for visit in problem.visits)
    made = suggest_route(replace(problem, visits=optional))
    assert (made.order, made.cost, made.dropped) == ((), 10, (0, 1))
    assert (made.infeasible, made.proven) == (False, True)
