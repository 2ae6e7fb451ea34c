"""Tests of duration curves, and of clusters of failed runs."""

import pytest

from argo_env.evaluation.results import (
    EvaluationResults,
    cluster_failures_by_location,
    duration_curve,
)
from argo_env.evaluation.row import RunOutcome, RunRow
from tests.argo_env.evaluation.conftest import plan_of
from tests.argo_env.evaluation.test_store import row as a_row


def row(seed, duration=None, faults="none", **other) -> RunRow:
    outcome = RunOutcome.FAILURE if duration is None else RunOutcome.SUCCESS
    fields = {"key": f"{faults}{seed}", "faults": faults, "outcome": outcome, "duration": duration}
    return a_row(seed, **(fields | other))


def results_of(mission, rows, faults=("none",)) -> EvaluationResults:
    return EvaluationResults(plan_of(mission, range(9), faults), tuple(rows))


def test_failed_runs_never_succeed(mission):
    rows = [row(0, 30.0), row(1, 10.0), row(2), row(3, 20.0, limit=25.0)]
    rows.append(row(4, outcome=RunOutcome.DIED))  # says nothing about the plan
    results = results_of(mission, rows)
    curve = duration_curve(results, results.plan.plans[0])
    assert curve.times == (10.0, 20.0, 30.0)
    assert curve.shares == pytest.approx((0.25, 0.5, 0.75))
    assert curve.limits == (25.0,)
    times = [curve.time_of_success_share(share) for share in (0.1, 0.5, 0.75, 0.9)]
    assert times == [10.0, 20.0, 30.0, None]


def test_cases_count_by_weight(mission):
    rows = [row(k, 10.0) for k in range(2)] + [row(k, 50.0, "rare") for k in range(8)]
    results = results_of(mission, rows, {"none": 0.9, "rare": 0.1, "not yet run": 1.0})
    curve = duration_curve(results, results.plan.plans[0])
    assert curve.shares[1] == pytest.approx(0.9)
    assert curve.final_success_share == pytest.approx(1.0)


def test_the_curve_without_runs_is_empty(mission):
    results = results_of(mission, ())
    curve = duration_curve(results, results.plan.plans[0])
    assert (curve.times, curve.final_success_share, curve.time_of_success_share(0.5)) == (
        (),
        0.0,
        None,
    )


def test_failures_within_half_a_metre_are_one_cluster():
    rows = [
        row(0, floor=1, place=(1.0, 1.0, 0.0), task="A"),
        row(1, floor=1, place=(5.0, 1.0, 0.0)),
        row(2, floor=1, place=(1.3, 1.3, 0.0), task="B"),
        row(3, floor=2, place=(1.0, 1.0, 2.5), task="A"),
        row(4, 10.0),
        row(5, task="C"),  # at an unknown location
    ]
    clusters = cluster_failures_by_location(rows)
    assert [(cluster.floor, cluster.runs) for cluster in clusters] == [(1, 2), (1, 1), (2, 1)]
    assert clusters[0].tasks == {"A": 1, "B": 1}
    assert clusters[1].tasks == {"no task": 1}
