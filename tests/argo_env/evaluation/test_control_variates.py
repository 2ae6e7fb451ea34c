"""Cheap runs that help expensive ones: measured first, and made only where they pay."""

import math

import numpy as np
import pytest

from argo_compiler.base.errors import ArgoError
from argo_env.evaluation.case import EvaluationCase
from argo_env.evaluation.control_variates import PILOT, run_with_control_variate, with_drive
from argo_env.evaluation.plan import EvaluationPlan
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.row import RunOutcome, RunRow, make_empty_row
from argo_env.run.spec import RunSpec
from tests.argo_env.evaluation.conftest import plan_of

MEAN = 700.0  # s that the expensive drive takes on average


def invented(seed: int, drive: str, together: bool) -> RunRow:
    """Worlds differ, and both drives see that they do; or each has worlds of its own."""
    world = np.random.default_rng(seed).normal(0.0, 60.0)
    own = np.random.default_rng((seed, len(drive))).normal(0.0, 60.0 if not together else 6.0)
    duration = (MEAN if drive == "kinematic" else 500.0) + (world if together else 0.0) + own
    spec = RunSpec.model_construct(
        site="umad", robot="tracker", drive=drive, sensor="ideal", seed=seed
    )
    case = EvaluationCase.model_construct(mission="m", policy="p", faults="none", spec=spec)
    row = make_empty_row(f"{drive} {seed}", case, spec, RunOutcome.SUCCESS, "invented")
    failed = RunOutcome.FAILURE if duration > 1.08 * MEAN else RunOutcome.SUCCESS
    return row.model_copy(update={"duration": duration, "outcome": failed})


class Made:
    """Makes rows, and counts the runs and what they cost (s): a cheap one a hundredth."""

    def __init__(self, together: bool = True) -> None:
        self.together = together
        self.known: set[str] = set()
        self.time = 0.0

    def __call__(self, plan: EvaluationPlan) -> EvaluationResults:
        rows = []
        for run in plan.runs():
            row = invented(run.seed, run.spec.drive, self.together)
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


def test_cheap_runs_that_tell_much_make_the_interval_narrow(expensive, tmp_path):
    made = Made()
    results, means = run_with_control_variate(expensive, "route", made, tmp_path, lambda: made.time)
    success, duration = means
    assert len(results.rows) == 200
    assert duration.control.correlation > 0.95
    assert duration.control.cost == pytest.approx(0.01)
    assert duration.controlled.high - duration.controlled.low < 0.5 * (
        duration.uncontrolled.high - duration.uncontrolled.low
    )
    assert duration.controlled.low <= MEAN <= duration.controlled.high
    assert (duration.expensive, made.count("kinematic")) == (200, 200)
    assert made.count("route") == 200 + duration.cheap
    # By the formula for how many there should be, which the tests of the statistics derive.
    most = max(mean.control.cheap_runs for mean in means if mean.control.pays)
    assert duration.cheap == math.ceil((most - 1) * 200)
    assert success.controlled is None or success.controlled.low <= 0.82 <= success.controlled.high


def test_cheap_runs_that_tell_nothing_are_made_in_the_first_worlds_only(expensive, tmp_path):
    made = Made(together=False)
    _, means = run_with_control_variate(expensive, "route", made, tmp_path, lambda: made.time)
    assert all(mean.controlled is None for mean in means)
    assert not any(mean.control.pays for mean in means)
    assert made.count("route") == PILOT


@pytest.mark.long
def test_what_was_measured_outlives_an_interruption(expensive, tmp_path):
    made = Made()
    _, first = run_with_control_variate(expensive, "route", made, tmp_path, lambda: made.time)
    known = set(made.known)
    _, again = run_with_control_variate(expensive, "route", made, tmp_path, lambda: made.time)
    assert again == first
    assert made.known == known


@pytest.mark.long
def test_of_few_failures_no_interval_is_told(expensive, tmp_path):
    def never_late(plan: EvaluationPlan) -> EvaluationResults:
        found = made(plan)
        rows = (row.model_copy(update={"outcome": RunOutcome.SUCCESS}) for row in found.rows)
        return EvaluationResults(plan, tuple(rows))

    made = Made()
    _, (success, duration) = run_with_control_variate(
        expensive, "route", never_late, tmp_path, lambda: made.time
    )
    assert success.controlled is None
    assert duration.controlled is not None


def test_the_cheap_plan_has_the_name_of_its_own_drive(expensive):
    assert [plan.drive for plan in expensive.plans] == ["kinematic"]
    assert [plan.drive for plan in with_drive(expensive, "route").plans] == ["route"]


def test_what_can_not_help_is_told(expensive):
    with pytest.raises(ArgoError, match="can't help itself"):
        with_drive(expensive, "kinematic")
    case = expensive.cases[0]
    other = case.model_copy(update={"mission": "another"})
    two = expensive.model_copy(update={"cases": (case, other)})
    with pytest.raises(ArgoError, match="give one mission"):
        with_drive(EvaluationPlan(cases=two.cases, seeds=(1,)), "route")
