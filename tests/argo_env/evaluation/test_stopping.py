"""Intervals hold however an evaluation came to its end: simulated evaluations of known rates."""

import numpy as np
import pytest

from argo_env.evaluation.batches import batches
from argo_env.evaluation.case import EvaluationCase
from argo_env.evaluation.plan import EvaluationPlan, Stopping
from argo_env.evaluation.rates import IntervalMethod
from argo_env.evaluation.requirement import parse_requirement
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.row import RunOutcome, row_without_end
from argo_env.run.spec import RunSpec
from tests.conftest import examples


def simulated(plan, rng, share):
    """The results of an evaluation of runs of which such a share succeeds."""
    (case,) = plan.cases
    bare = row_without_end("", case, case.spec, RunOutcome.SUCCESS, "")
    rows = []
    for batch in batches(plan, rows):
        for run in batch:
            came = RunOutcome.SUCCESS if rng.random() < share else RunOutcome.FAILURE
            rows.append(bare.model_copy(update={"seed": run.seed, "outcome": came}))
    return EvaluationResults(plan, tuple(rows))


@pytest.mark.parametrize(("share", "asked"), [(0.85, 0.8), (0.9, 0.95)])
def test_the_interval_covers_where_a_requirement_decides_when_to_stop(mission, share, asked):
    """An exact interval covers the rate in 93 of 100 of the first ones only."""
    plan = EvaluationPlan(
        cases=(EvaluationCase(mission="m", spec=RunSpec(mission=mission, drive="route")),),
        seeds=tuple(range(400)),
        stopping=Stopping(require=(parse_requirement(f"success >= {asked}"),)),
    )
    evaluations = examples(400)
    rng = np.random.default_rng(9)
    held = groups = early = 0
    for _ in range(evaluations):
        results = simulated(plan, rng, share)
        rate = results.rate(plan.plans[0])
        (group,) = results.by_faults(plan.plans[0])
        assert rate.method is group.method is IntervalMethod.SEQUENCE
        held += rate.low <= share <= rate.high
        groups += group.rate.low <= share <= group.rate.high
        early += rate.runs < 400
    assert early > 0.1 * evaluations
    assert held == groups >= 0.945 * evaluations


def test_the_world_of_a_run_that_was_lost_is_left_out_and_not_counted(mission):
    spec = RunSpec(mission=mission, drive="route")
    cases = tuple(EvaluationCase(mission="m", faults=name, spec=spec) for name in "ab")
    plan = EvaluationPlan(cases=cases, seeds=tuple(range(10)))
    rows = []
    for run in plan.runs():
        lost = run.seed == 3 and run.case == 1
        came = RunOutcome.ERROR if lost else RunOutcome.SUCCESS
        rows.append(row_without_end(str(len(rows)), plan.cases[run.case], run.spec, came, ""))
    rate = EvaluationResults(plan, tuple(rows)).rate(plan.plans[0])
    assert (rate.runs, rate.lost) == (18, 1)
