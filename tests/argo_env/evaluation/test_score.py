"""Tests of scores with rows made by hand."""

import pytest

from argo_compiler.diagnostics import DiagnosticError
from argo_env.evaluation.detection import FaultDetection
from argo_env.evaluation.row import RunOutcome
from argo_env.evaluation.score import mean_score, read_scoring, score_run
from tests.argo_env.evaluation.test_store import row

RULES = read_scoring()


def score(**changes):
    fields = {"tasks": 4, "done": 4, "docked": True, **changes}
    return score_run(row(1).model_copy(update=fields), RULES)


def test_a_run_without_faults_or_failures_has_all_points():
    assert score().total == RULES.max_score == 100


@pytest.mark.parametrize(
    ("changes", "total"),
    [
        ({"outcome": RunOutcome.FAILURE, "done": 2}, 100 - 40 * 0.35 - 40 * 0.3),
        ({"outcome": RunOutcome.FAILURE, "done": 4, "docked": False}, 100 - 12 - 6),
        ({"contacts": 1}, 85),
        ({"contacts": 5}, 70),
        ({"mishaps": 2}, 85),
        ({"false_alarms": 3}, 94),
        ({"detections": (FaultDetection(fault="brick", began=1.0, delay=None),)}, 82),
        ({"detections": (FaultDetection(fault="brick", began=1.0, delay=4.0),)}, 100),
        ({"done": 2}, 100),  # a successful mission with branches does not do all tasks
        ({"outcome": RunOutcome.FAILURE, "charge": 0.0}, 0),  # stands with an empty battery
        ({"charge": 0.01}, 100),
        ({"outcome": RunOutcome.ERROR}, 0),
        ({"outcome": RunOutcome.DIED}, 0),
    ],
)
def test_points_are_lost(changes, total):
    assert score(**changes).total == pytest.approx(total)


def test_the_mean_has_an_interval_over_worlds():
    rows = [row(seed, contacts=seed % 2, docked=True) for seed in range(40)]
    mean = mean_score(rows, RULES)
    assert mean.value == pytest.approx(92.5)
    assert 89 < mean.low < 92.5 < mean.high < 96


def test_a_users_file_is_read_and_its_errors_are_reported(tmp_path):
    own = tmp_path / "own.yaml"
    text = (
        "reliability: {weight: 10, tasks_done: 1, success: 0}\n"
        "robustness: {weight: 0, detected: 1, no_false_alarm: 0, goes_on: 0}\n"
        "safety: {weight: 0, contact: 1, mishap: 1}\n"
    )
    own.write_text(text)
    assert read_scoring(own).max_score == 10
    own.write_text(text.replace("tasks_done: 1", "tasks_done: 0.5"))
    with pytest.raises(DiagnosticError, match=r"add up to 0\.5"):
        read_scoring(own)
