"""Evaluations from the plan to the rows, on each back end; intervals hold however they ended."""

import numpy as np
import pytest

from argo_env.evaluation.case import EvaluationCase
from argo_env.evaluation.plan import EvaluationPlan, Stopping
from argo_env.evaluation.pool.backends import make_backend
from argo_env.evaluation.rates import Decision, IntervalMethod
from argo_env.evaluation.requirement import parse_requirement
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.row import RunOutcome, make_empty_row
from argo_env.evaluation.runner import EvaluationRunner, WorkOrder, batches, execute_run
from argo_env.evaluation.store import RowStore, read_rows
from argo_env.evaluation.worlds import Variation
from argo_env.faults.loading import decode_faults
from argo_env.run.spec import RunSpec
from argo_env.worker_processes import context_with
from tests.argo_env.evaluation import work
from tests.argo_env.evaluation.conftest import came_to, plan_of, short_mission
from tests.conftest import examples

EMERGENCY = decode_faults(b"faults: [{kind: emergency_stop, at: 10}]", "test").faults


@pytest.fixture(scope="module")
def processes():
    """Return processes that are forked from one that has loaded all, as `argo evaluate` has them;
    those of `backend` load it themselves."""
    context = context_with("argo_env.evaluation.runner")
    made = make_backend("processes", 2, context=context)
    yield made
    made.close()


@pytest.fixture(scope="module")
def faulty(mission) -> EvaluationPlan:
    """With and without an emergency stop that nobody releases, in worlds that vary."""
    varied = Variation(speed=(0.8, 1.0), charge=(0.5, 1.0))
    names = ("none", "stop")
    return plan_of(mission, range(6), names, name="short", given=EMERGENCY, variation=varied)


@pytest.fixture(scope="module")
def alone(faulty):
    """The rows as this process makes them, one after the other."""
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
    evaluating = EvaluationRunner(plan, backend, store, **options)
    came = list(evaluating.rows_as_completed())
    assert evaluating.progress.completed_runs == len(came)
    return evaluating.results


def test_rows_are_equal_on_every_back_end(backend, faulty, alone):
    results = evaluated(faulty, backend)
    assert results.rows == alone
    assert results.outcomes == {RunOutcome.SUCCESS: 6, RunOutcome.FAILURE: 6}
    assert {row.faults for row in results.failing} == {"stop"}
    assert all(row.place is not None and row.world["speed"] < 1 for row in results.failing)
    assert all(row.detections[0].delay is not None for row in results.failing)


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
    assert results.failing[0].reason == "the worker process ended with code 7"


def test_what_goes_wrong_in_the_simulator_is_another_outcome(processes, plan):
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
    # Of so many steps that it takes far longer than it may.
    slow = RunSpec(mission=mission, drive="tracked", sensor="camera")
    plan = EvaluationPlan(cases=(EvaluationCase(mission="slow", spec=slow),), seeds=(1,))
    results = evaluated(plan, processes, limit=0.05)
    assert results.rows[0].outcome is RunOutcome.DIED
    assert results.rows[0].reason == "the run took longer than its time limit"


def test_only_what_is_missing_is_made(processes, plan, tmp_path):
    with RowStore(tmp_path) as store:
        first = evaluated(plan.model_copy(update={"seeds": (0, 2, 4)}), processes, store)
        evaluating = EvaluationRunner(plan, processes, store)
        list(evaluating.rows_as_completed())
        assert evaluating.progress.known == 3
        assert evaluating.results.rows[2] == first.rows[1]
    assert len(read_rows(tmp_path)) == 10
    with RowStore(tmp_path) as store:
        evaluating = EvaluationRunner(plan, processes, store)
        list(evaluating.rows_as_completed())
        assert evaluating.progress.known == 10


@pytest.mark.parametrize(
    ("required", "verdict"),
    [("success >= 0.7", Decision.MET), ("success >= 0.97", Decision.MISSED)],
)
def test_it_stops_when_a_requirement_is_decided(processes, plan, required, verdict):
    """Six of seven worlds succeed."""
    stopping = Stopping(require=(parse_requirement(required),), every=50)
    many = plan.model_copy(update={"seeds": tuple(range(501, 3_000)), "stopping": stopping})
    results = evaluated(many, processes, call=work.invented)
    assert [one.verdict for one in results.verdicts] == [verdict]
    assert len(results.rows) < 1_000
    assert len(results.rows) % 50 == 0


@pytest.mark.long
def test_what_is_stopped_for_does_not_depend_on_how_many_work(plan):
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


def test_strata_get_runs_where_they_tell_most(processes, mission):
    weights = {"nothing": 0.95, "rare": 0.05}
    stopping = Stopping(every=20)
    strata = plan_of(mission, range(501, 801), weights, strata=True, stopping=stopping)
    results = evaluated(strata, processes, call=work.invented)
    assert len(results.rows) == 300
    assert len({row.seed for row in results.rows}) == 300
    rate = results.rate(strata.plans[0])
    assert rate.method is IntervalMethod.STRATA
    assert rate.low < 6 / 7 < rate.high


def test_runs_of_one_world_are_no_independent_runs(processes, mission, plan):
    """The interval of several faults in the same worlds is that over worlds."""
    several = plan_of(mission, range(100), "abc")
    single = plan.model_copy(update={"seeds": tuple(range(100))})
    rate = evaluated(several, processes, call=work.invented).rate(several.plans[0])
    alone = evaluated(single, processes, call=work.invented).rate(single.plans[0])
    assert rate.method is IntervalMethod.SEQUENCE
    assert rate.runs == 300
    assert rate.high - rate.low > alone.high - alone.low


def test_the_frame_has_a_line_for_each_row(processes, faulty, alone):
    frame = evaluated(faulty, processes).frame
    assert len(frame) == len(alone)
    assert list(frame["outcome"][:2]) == ["success", "failure"]
    assert frame["world.speed"].between(0.8, 1.0).all()


def test_a_limit_that_is_missed_is_a_failure(processes):
    plan = plan_of(short_mission(limit=5.0), (1, 2), name="hurried")
    results = evaluated(plan, processes)
    assert results.outcomes == {RunOutcome.FAILURE: 2}
    assert "late" not in results.rows[0].reason
    assert results.rows[0].limit == 5.0


def simulated(plan, rng, share):
    """The results of an evaluation of runs of which such a share succeeds."""
    (case,) = plan.cases
    bare = make_empty_row("", case, case.spec, RunOutcome.SUCCESS, "")
    rows = []
    for batch in batches(plan, rows):
        for run in batch:
            came = RunOutcome.SUCCESS if rng.random() < share else RunOutcome.FAILURE
            rows.append(bare.model_copy(update={"seed": run.seed, "outcome": came}))
    return EvaluationResults(plan, tuple(rows))


@pytest.mark.long
@pytest.mark.parametrize(("share", "asked"), [(0.85, 0.8), (0.9, 0.95)])
def test_the_interval_covers_where_a_requirement_decides_when_to_stop(mission, share, asked):
    """An exact interval covers the rate in 93 of 100 of the first ones only."""
    stopping = Stopping(require=(parse_requirement(f"success >= {asked}"),))
    plan = plan_of(mission, range(400), stopping=stopping)
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
    plan = plan_of(mission, range(10), "ab")
    lost = {"outcome": RunOutcome.ERROR}
    results = came_to(plan, lambda run: lost if (run.seed, run.case) == (3, 1) else {})
    rate = results.rate(plan.plans[0])
    assert (rate.runs, rate.lost) == (18, 1)
