"""Limits, observers and custom solvers of a search."""

import os
import signal
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from argo_compiler.base.errors import Conflict, Invalid, NotFound, Unavailable
from argo_compiler.route import (
    Precedence,
    RouteProblem,
    SearchProgress,
    Tour,
    Visit,
    evaluate,
    suggest_route,
)
from argo_compiler.route.batch import suggest_routes
from argo_compiler.route.search import Search
from argo_compiler.route.solvers import InstalledSolver, discard_solver, register_solver
from argo_compiler.route.stop import (
    FirstFeasible,
    MaxGap,
    MaxIterations,
    MaxRuntime,
    MultipleCriteria,
    NoImprovement,
    StopCriterion,
)
from tests.argo_compiler.route.random_problems import random_problem

IMPROVING = ("first rules", "ruin and recreate")


def plain(count: int, seed: int = 0) -> RouteProblem:
    rng = np.random.default_rng(seed)
    points = rng.integers(0, 1000, (count + 1, 2))
    travel = np.abs(points[:, None] - points).sum(axis=2).astype(np.int64)
    return RouteProblem(tuple(Visit(f"checkpoint {k}", 5) for k in range(count)), travel)


class TestStopCriteria:
    @pytest.mark.parametrize(
        ("criterion", "is_met"),
        [
            (FirstFeasible(), lambda p: p.cost is not None),
            (MaxIterations(50), lambda p: p.iterations >= 50),
            (NoImprovement(iterations=30), lambda p: p.iterations - p.better[1] >= 30),
            (NoImprovement(seconds=0.2), lambda p: p.time - p.better[0] >= 0.2),
            (MaxRuntime(0.2), lambda p: p.time >= 0.2),
            (MaxGap(0.5), lambda p: p.gap is not None and p.gap <= 0.5),
            (lambda p: p.work > 0.01, lambda p: p.work > 0.01),
        ],
    )
    def test_a_search_ends_when_its_criterion_is_met(
        self, criterion: StopCriterion, is_met: Callable[[SearchProgress], bool]
    ) -> None:
        met: list[bool] = []

        def watched(progress: SearchProgress) -> bool:
            stops = criterion(progress)
            assert stops == is_met(progress)
            met.append(stops)
            return stops

        made = suggest_route(plain(40), 600.0, stop=watched, solvers=IMPROVING)
        assert met.index(True) == len(met) - 1
        assert made.route is not None
        assert evaluate(plain(40), made.route).feasible

    def test_any_of_several_criteria_ends_a_search(self) -> None:
        either = MultipleCriteria((MaxIterations(10**9), FirstFeasible()))
        assert suggest_route(plain(60), 600.0, stop=either).route is not None

    def test_no_improvement_needs_a_limit(self) -> None:
        with pytest.raises(Invalid, match="give iterations or seconds"):
            NoImprovement()

    @pytest.mark.parametrize("workers", [1, 2])
    def test_exceptions_of_a_criterion_are_passed_on(self, workers: int) -> None:
        def criterion(progress: SearchProgress) -> bool:
            if progress.cost is not None:
                raise ValueError("enough")
            return False

        with pytest.raises(ValueError, match="enough"):
            suggest_route(plain(60), 60.0, workers=workers, stop=criterion)


@pytest.mark.parametrize("workers", [1, 2])
def test_observers_see_the_curve_of_the_result(workers: int) -> None:
    problem = plain(45)
    routes: list[tuple[int | None, int]] = []
    bounds: list[int] = []
    made = suggest_route(
        problem,
        2.0,
        workers=workers,
        on_best=lambda p, tour: routes.append((p.cost, evaluate(problem, tour).duration)),
        on_bound=lambda p: bounds.append(p.bound),
    )
    assert routes
    if workers == 1:
        assert all(cost == duration for cost, duration in routes)
    assert bounds[-1] == made.bound == made.history[-1].bound
    costs = [p.cost for p in made.history if p.cost is not None]
    assert costs == sorted(costs, reverse=True)
    assert costs[-1] == made.cost
    assert [p.bound for p in made.history] == sorted(p.bound for p in made.history)


def test_exceptions_of_an_observer_are_passed_on() -> None:
    def observer(_progress: SearchProgress, _tour: Tour) -> None:
        raise KeyError("lost")

    with pytest.raises(KeyError, match="lost"):
        suggest_route(plain(30), 20.0, on_best=observer)


@pytest.mark.parametrize("seed", range(0, 40, 4))
def test_a_limit_of_work_gives_the_same_each_time(seed: int) -> None:
    problem = random_problem(np.random.default_rng(seed), 25)

    def found(slow: bool) -> tuple[object, ...]:
        def watch(_: SearchProgress) -> None:
            if slow:
                time.sleep(0.002)

        made = suggest_route(
            problem, None, 3, work_limit=0.4, on_bound=watch, on_best=lambda p, _: watch(p)
        )
        curve = [(p.work, p.iterations, p.prize, p.cost, p.bound) for p in made.history]
        return made.route, made.prize, made.bound, made.method, curve

    assert found(slow=False) == found(slow=True)


def test_impossible_limits_are_refused() -> None:
    for limits in ({"time_limit": 0.0}, {"time_limit": None}, {"work_limit": -1.0}, {"workers": 0}):
        with pytest.raises(Invalid, match="needs a limit of time or work"):
            suggest_route(plain(3), **limits)  # type: ignore[arg-type]


class Reversed:
    """Custom solver that offers the visits from the last to the first."""

    name = "reversed"

    def __init__(self, claim: int | None = None, supported: bool = True) -> None:
        self.calls, self._claim, self._supported = 0, claim, supported

    def supports(self, _problem: RouteProblem, /) -> bool:
        return self._supported

    def solve(self, search: Search, /) -> None:
        self.calls += 1
        search.offer_tour(Tour(tuple(reversed(range(search.problem.size)))))
        if self._claim is not None:
            search.report_bounds(bound=self._claim)


class TestCustomSolver:
    def test_it_takes_part_when_it_is_registered(self) -> None:
        solver = Reversed()
        register_solver(solver)
        try:
            with pytest.raises(Conflict, match="already"):
                register_solver(Reversed())
            made = suggest_route(plain(60), 0.5, solvers=("reversed",))
            suggest_route(plain(60), 0.5)
        finally:
            discard_solver("reversed")
        assert solver.calls > 1
        assert (made.method, made.order) == ("reversed", tuple(reversed(range(60))))
        with pytest.raises(NotFound, match="no route solver `reversed`"):
            suggest_route(plain(3), solvers=("reversed",))

    def test_it_takes_part_when_it_is_passed(self) -> None:
        line = plain(1)
        assert suggest_route(line, solvers=(Reversed(),)).order == (0,)
        refusing = Reversed(supported=False)
        assert suggest_route(line, solvers=(refusing,)).route is None
        assert refusing.calls == 0

    def test_its_false_claims_are_reported(self) -> None:
        with pytest.raises(Conflict, match="'reversed': its result contradicts"):
            suggest_route(plain(5), solvers=(Reversed(claim=10**9),))

    def test_proofs_of_an_installed_one_are_ignored(self) -> None:
        installed = InstalledSolver(Reversed(claim=10**9), "some-package 1.0")
        made = suggest_route(plain(5), solvers=(installed,))
        assert made.order == (4, 3, 2, 1, 0)
        assert not made.proven
        assert made.cost is not None
        assert made.bound <= made.cost

    def test_the_search_goes_on_without_an_installed_one_that_fails(self) -> None:
        class Failing(Reversed):
            def solve(self, _search: Search, /) -> None:
                raise ZeroDivisionError("a fault")

        installed = InstalledSolver(Failing(), "some-package 1.0")
        made = suggest_route(plain(60), 0.5, solvers=(installed, "first rules"))
        assert made.method == "first rules"
        message = "`reversed` of some-package 1.0 has failed (ZeroDivisionError: a fault)"
        assert any(message in reason for reason in made.reasons)

    def test_its_routes_must_be_feasible(self) -> None:
        ordered = replace(plain(2), precedences=(Precedence((0, 1), "0 before 1"),))
        with pytest.raises(
            Invalid, match="'reversed' offers a route that violates a constraint: 0 before"
        ):
            suggest_route(ordered, solvers=(Reversed(),))


class Killed(Reversed):
    """Solver that kills its process."""

    def solve(self, _search: Search, /) -> None:
        os.kill(os.getpid(), signal.SIGKILL)


class TestBatches:
    def test_they_give_the_same_as_single_calls(self) -> None:
        problems = [random_problem(np.random.default_rng(seed), 6) for seed in range(7)]
        alone = [suggest_route(problem, 60.0) for problem in problems]
        together = list(suggest_routes(problems, time_limit=60.0, stop=MaxGap(0.0)))
        assert [(m.route, m.cost) for m in together] == [(m.route, m.cost) for m in alone]

    def test_a_problem_that_can_t_be_searched_is_named(self) -> None:
        long = RouteProblem((Visit("a"),) * 600, np.full((601, 601), 1 << 30))
        many = [plain(3), long]
        with pytest.raises(Invalid, match=r"^problem 1: the times"):
            list(suggest_routes(many, time_limit=5.0))

    def test_a_killed_process_is_reported(self) -> None:
        with pytest.raises(Unavailable, match="a search process was killed"):
            list(suggest_routes([plain(3)], 1, time_limit=5.0, solvers=(Killed(),)))
