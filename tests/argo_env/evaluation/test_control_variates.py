"""Tests of control variates: cheap runs are measured first, and made only if they pay."""

import math

import numpy as np
import pytest

from argo_compiler.base.errors import ArgoError
from argo_env.evaluation.case import EvaluationCase
from argo_env.evaluation.control_variates import PILOT, make_cheap_plan, run_with_control_variate
from argo_env.evaluation.plan import EvaluationPlan
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.row import RunOutcome, RunRow, make_empty_row
from argo_env.run.spec import RunSpec
from tests.argo_env.evaluation.conftest import plan_of

MEAN = 700.0  # s, mean duration of the expensive drive


def invented(seed: int, drive: str, correlated: bool) -> RunRow:
    """Return an invented row; the durations of both drives in a world are correlated or not."""
    world = np.random.default_rng(seed).normal(0.0, 60.0)
    noise = np.random.default_rng((seed, len(drive))).normal(0.0, 60.0 if not correlated else 6.0)
    duration = (MEAN if drive == "kinematic" else 500.0) + (world if correlated else 0.0) + noise
    spec = RunSpec.model_construct(
        site="umad", robot="tracker", drive=drive, sensor="ideal", seed=seed
    )
    case = EvaluationCase.model_construct(mission="m", policy="p", faults="none", spec=spec)
    row = make_empty_row(f"{drive} {seed}", case, spec, RunOutcome.SUCCESS, "invented")
    outcome = RunOutcome.FAILURE if duration > 1.08 * MEAN else RunOutcome.SUCCESS
    return row.model_copy(update={"duration": duration, "outcome": outcome})


class FakeRunner:
    """Fake of the execution: it invents rows, and counts the runs and their time (s).

    A cheap run takes a hundredth of the time of an expensive one.
    """

    def __init__(self, correlated: bool = True) -> None:
        self.correlated = correlated
        self.known: set[str] = set()
        self.time = 0.0

    def __call__(self, plan: EvaluationPlan) -> EvaluationResults:
        rows = []
        for run in plan.runs():
            row = invented(run.seed, run.spec.drive, self.correlated)
            if row.key not in self.known:
                self.time += 1.0 if run.spec.drive == "kinematic" else 0.01
                self.known.add(row.key)
            rows.append(row)
        return EvaluationResults(plan, tuple(rows))

    def count(self, drive: str) -> int:
        return sum(key.startswith(drive) for key in self.known)


@pytest.fixture(scope="module")
def expensive(mission) -> EvaluationPlan:
    return plan_of(mission, range(200), drive="kinematic")


def test_correlated_cheap_runs_make_the_interval_narrow(expensive, tmp_path):
    runner = FakeRunner()
    results, means = run_with_control_variate(
        expensive, "route", runner, tmp_path, lambda: runner.time
    )
    success, duration = means
    assert len(results.rows) == 200
    assert duration.control.correlation > 0.95
    assert duration.control.cost == pytest.approx(0.01)
    assert duration.controlled.high - duration.controlled.low < 0.5 * (
        duration.uncontrolled.high - duration.uncontrolled.low
    )
    assert duration.controlled.low <= MEAN <= duration.controlled.high
    assert (duration.expensive, runner.count("kinematic")) == (200, 200)
    assert runner.count("route") == 200 + duration.cheap
    # By the formula for the best number of cheap runs, which the tests of estimates check.
    most = max(mean.control.cheap_runs_per_expensive_run for mean in means if mean.control.pays)
    assert duration.cheap == math.ceil((most - 1) * 200)
    assert success.controlled is None or success.controlled.low <= 0.82 <= success.controlled.high


def test_uncorrelated_cheap_runs_are_made_in_the_pilot_only(expensive, tmp_path):
    runner = FakeRunner(correlated=False)
    _, means = run_with_control_variate(expensive, "route", runner, tmp_path, lambda: runner.time)
    assert all(mean.controlled is None for mean in means)
    assert not any(mean.control.pays for mean in means)
    assert runner.count("route") == PILOT


@pytest.mark.long
def test_the_measured_cost_survives_an_interruption(expensive, tmp_path):
    runner = FakeRunner()
    _, first = run_with_control_variate(expensive, "route", runner, tmp_path, lambda: runner.time)
    known = set(runner.known)
    _, again = run_with_control_variate(expensive, "route", runner, tmp_path, lambda: runner.time)
    assert again == first
    assert runner.known == known


@pytest.mark.long
def test_with_too_few_failures_success_has_no_controlled_interval(expensive, tmp_path):
    def never_late(plan: EvaluationPlan) -> EvaluationResults:
        results = runner(plan)
        rows = (row.model_copy(update={"outcome": RunOutcome.SUCCESS}) for row in results.rows)
        return EvaluationResults(plan, tuple(rows))

    runner = FakeRunner()
    _, (success, duration) = run_with_control_variate(
        expensive, "route", never_late, tmp_path, lambda: runner.time
    )
    assert success.controlled is None
    assert duration.controlled is not None


def test_the_cheap_plan_has_the_name_of_its_own_drive(expensive):
    assert [plan.drive for plan in expensive.plans] == ["kinematic"]
    assert [plan.drive for plan in make_cheap_plan(expensive, "route").plans] == ["route"]


def test_a_drive_or_plan_that_can_not_use_cheap_runs_is_refused(expensive):
    with pytest.raises(ArgoError, match="can't help itself"):
        make_cheap_plan(expensive, "kinematic")
    case = expensive.cases[0]
    other = case.model_copy(update={"mission": "another"})
    two = expensive.model_copy(update={"cases": (case, other)})
    with pytest.raises(ArgoError, match="give one mission"):
        make_cheap_plan(EvaluationPlan(cases=two.cases, seeds=(1,)), "route")
