"""Tests of the execution of evaluations on each back end, and of its intervals at any end."""

import numpy as np
import pytest

from argo_env.evaluation.case import EvaluationCase
from argo_env.evaluation.plan import EvaluationPlan, Stopping
from argo_env.evaluation.pool.backends import make_backend
from argo_env.evaluation.rates import Decision, IntervalMethod
from argo_env.evaluation.requirement import parse_requirement
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.row import RunOutcome, make_empty_row
from argo_env.evaluation.runner import EvaluationRunner, WorkOrder, batches_until_stop, execute_run
from argo_env.evaluation.store import RowStore, read_rows
from argo_env.evaluation.worlds import Variation
from argo_env.faults.loading import decode_faults
from argo_env.run.spec import RunSpec
from argo_env.worker_processes import context_with
from tests.argo_env.evaluation import work
from tests.argo_env.evaluation.conftest import plan_of, results_with, short_mission
from tests.conftest import examples

EMERGENCY = decode_faults(b"faults: [{kind: emergency_stop, at: 10}]", "test").faults


@pytest.fixture(scope="module")
def processes():
    """Yield worker processes forked from one that has imported all modules, as in `argo evaluate`.

    The workers of the fixture `backend` import the modules themselves.
    """
    context = context_with("argo_env.evaluation.runner")
    backend = make_backend("processes", 2, context=context)
    yield backend
    backend.close()


@pytest.fixture(scope="module")
def faulty(mission) -> EvaluationPlan:
    """Return a plan with and without an emergency stop that nobody releases, in varied worlds."""
    varied = Variation(speed=(0.8, 1.0), charge=(0.5, 1.0))
    names = ("none", "stop")
    return plan_of(mission, range(6), names, name="short", given=EMERGENCY, variation=varied)


@pytest.fixture(scope="module")
def expected_rows(faulty):
    """Return the rows of `faulty` that this process makes, one after the other."""
    return tuple(
        execute_run(
            WorkOrder(
                faulty.key(run),
                faulty.cases[run.case],
                run.spec,
                faulty.variation.values_for(run.seed),
            )
        )
        for run in faulty.runs()
    )


def evaluated(plan, backend, store=None, **options):
    runner = EvaluationRunner(plan, backend, store, **options)
    rows = list(runner.rows_as_completed())
    assert runner.progress.completed_runs == len(rows)
    return runner.results


def test_rows_are_equal_on_every_back_end(backend, faulty, expected_rows):
    results = evaluated(faulty, backend)
    assert results.rows == expected_rows
    assert results.outcomes == {RunOutcome.SUCCESS: 6, RunOutcome.FAILURE: 6}
    assert {row.faults for row in results.unsuccessful_rows} == {"stop"}
    assert all(
        row.place is not None and row.world["speed"] < 1 for row in results.unsuccessful_rows
    )
    assert all(row.detections[0].delay is not None for row in results.unsuccessful_rows)


@pytest.mark.long
def test_of_a_thousand_runs_one_that_kills_its_worker_is_a_row_with_its_reason(backend, plan):
    many = plan.model_copy(update={"seeds": tuple(range(1_000))})
    results = evaluated(many, backend, call=work.invented)
    assert [row.seed for row in results.rows] == list(range(1_000))
    (dead,) = [row for row in results.rows if row.outcome is RunOutcome.DIED]
    assert dead.seed == 500
    assert "worker process" in dead.reason
    rate = results.rate(many.plans[0])
    assert (rate.runs, rate.lost) == (999, 1)


@pytest.mark.long
def test_a_real_run_that_dies_does_not_end_the_others(processes, plan):
    results = evaluated(plan, processes, call=work.poisoned)
    assert results.outcomes == {RunOutcome.SUCCESS: 9, RunOutcome.DIED: 1}
    assert results.unsuccessful_rows[0].reason == "the worker process ended with code 7"


def test_an_error_of_the_simulator_is_an_outcome(processes, plan):
    results = evaluated(plan, processes, call=work.broken)
    assert results.outcomes == {RunOutcome.ERROR: 10}
    assert results.rows[3].reason == "RuntimeError: no run for 3"
    nowhere = plan.cases[0].spec.model_copy(update={"site": "nowhere"})
    case = plan.cases[0].model_copy(update={"spec": nowhere})
    row = execute_run(WorkOrder("k", case, nowhere, {}))
    assert row.outcome is RunOutcome.ERROR
    assert "nowhere" in row.reason


@pytest.mark.long
def test_a_run_that_takes_too_long_ends(processes, mission):
    # The tracked drive with a camera takes far longer than the limit.
    slow = RunSpec(mission=mission, drive="tracked", sensor="camera")
    plan = EvaluationPlan(cases=(EvaluationCase(mission="slow", spec=slow),), seeds=(1,))
    results = evaluated(plan, processes, limit=0.05)
    assert results.rows[0].outcome is RunOutcome.DIED
    assert results.rows[0].reason == "the run took longer than its time limit"


def test_only_missing_runs_are_executed(processes, plan, tmp_path):
    with RowStore(tmp_path) as store:
        first = evaluated(plan.model_copy(update={"seeds": (0, 2, 4)}), processes, store)
        runner = EvaluationRunner(plan, processes, store)
        list(runner.rows_as_completed())
        assert runner.progress.stored_runs == 3
        assert runner.results.rows[2] == first.rows[1]
    assert len(read_rows(tmp_path)) == 10
    with RowStore(tmp_path) as store:
        runner = EvaluationRunner(plan, processes, store)
        list(runner.rows_as_completed())
        assert runner.progress.stored_runs == 10


@pytest.mark.parametrize(
    ("required", "verdict"),
    [("success >= 0.7", Decision.MET), ("success >= 0.97", Decision.MISSED)],
)
def test_it_stops_when_a_requirement_is_decided(processes, plan, required, verdict):
    """The invented runs succeed in six of seven worlds."""
    stopping = Stopping(require=(parse_requirement(required),), every=50)
    many = plan.model_copy(update={"seeds": tuple(range(501, 3_000)), "stopping": stopping})
    results = evaluated(many, processes, call=work.invented)
    assert [judged.verdict for judged in results.verdicts] == [verdict]
    assert len(results.rows) < 1_000
    assert len(results.rows) % 50 == 0


@pytest.mark.long
def test_the_end_does_not_depend_on_the_number_of_workers(plan):
    stopping = Stopping(width=0.1, every=20)
    many = plan.model_copy(update={"seeds": tuple(range(501, 3_000)), "stopping": stopping})
    rows = []
    for workers in (1, 2):
        backend = make_backend("processes", workers)
        try:
            rows.append(evaluated(many, backend, call=work.invented).rows)
        finally:
            backend.close()
    assert rows[0] == rows[1]
    assert 150 < len(rows[0]) < 400


def test_strata_use_each_seed_once(processes, mission):
    weights = {"nothing": 0.95, "rare": 0.05}
    stopping = Stopping(every=20)
    strata = plan_of(mission, range(501, 801), weights, strata=True, stopping=stopping)
    results = evaluated(strata, processes, call=work.invented)
    assert len(results.rows) == 300
    assert len({row.seed for row in results.rows}) == 300
    rate = results.rate(strata.plans[0])
    assert rate.method is IntervalMethod.STRATA
    assert rate.low < 6 / 7 < rate.high


def test_runs_of_one_world_are_not_independent(processes, mission, plan):
    """With several sets of faults in the same worlds, the interval is one over worlds."""
    several = plan_of(mission, range(100), "abc")
    single = plan.model_copy(update={"seeds": tuple(range(100))})
    rate = evaluated(several, processes, call=work.invented).rate(several.plans[0])
    single_rate = evaluated(single, processes, call=work.invented).rate(single.plans[0])
    assert rate.method is IntervalMethod.SEQUENCE
    assert rate.runs == 300
    assert rate.high - rate.low > single_rate.high - single_rate.low


def test_the_frame_has_a_line_for_each_row(processes, faulty, expected_rows):
    frame = evaluated(faulty, processes).frame
    assert len(frame) == len(expected_rows)
    assert list(frame["outcome"][:2]) == ["success", "failure"]
    assert frame["world.speed"].between(0.8, 1.0).all()


def test_a_limit_that_is_missed_is_a_failure(processes):
    plan = plan_of(short_mission(limit=5.0), (1, 2), name="hurried")
    results = evaluated(plan, processes)
    assert results.outcomes == {RunOutcome.FAILURE: 2}
    assert "late" not in results.rows[0].reason
    assert results.rows[0].limit == 5.0


def simulated(plan, rng, share):
    """Return the results of an evaluation with random outcomes; `share` of the runs succeed."""
    (case,) = plan.cases
    empty = make_empty_row("", case, case.spec, RunOutcome.SUCCESS, "")
    rows = []
    for batch in batches_until_stop(plan, rows):
        for run in batch:
            outcome = RunOutcome.SUCCESS if rng.random() < share else RunOutcome.FAILURE
            rows.append(empty.model_copy(update={"seed": run.seed, "outcome": outcome}))
    return EvaluationResults(plan, tuple(rows))


@pytest.mark.long
@pytest.mark.parametrize(("share", "required"), [(0.85, 0.8), (0.9, 0.95)])
def test_the_interval_covers_if_a_requirement_decides_when_to_stop(mission, share, required):
    """With the first parameters, an exact interval would cover the rate in 93 of 100 cases only."""
    stopping = Stopping(require=(parse_requirement(f"success >= {required}"),))
    plan = plan_of(mission, range(400), stopping=stopping)
    evaluations = examples(400)
    rng = np.random.default_rng(9)
    covered = covered_groups = early = 0
    for _ in range(evaluations):
        results = simulated(plan, rng, share)
        rate = results.rate(plan.plans[0])
        (group,) = results.by_faults(plan.plans[0])
        assert rate.method is group.method is IntervalMethod.SEQUENCE
        covered += rate.low <= share <= rate.high
        covered_groups += group.rate.low <= share <= group.rate.high
        early += rate.runs < 400
    assert early > 0.1 * evaluations
    assert covered == covered_groups >= 0.945 * evaluations


def test_the_world_of_a_lost_run_does_not_count(mission):
    plan = plan_of(mission, range(10), "ab")
    lost = {"outcome": RunOutcome.ERROR}
    results = results_with(plan, lambda run: lost if (run.seed, run.case) == (3, 1) else {})
    rate = results.rate(plan.plans[0])
    assert (rate.runs, rate.lost) == (18, 1)
