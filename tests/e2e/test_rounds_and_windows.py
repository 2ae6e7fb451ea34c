"""A run of a mission with waits, planned rounds, time windows and a group that ends at a value."""

from pathlib import Path

import pytest

from argo_compiler.hfsm import Outcome
from argo_env.run.record import WindowOutcome
from tests.e2e.conftest import read_run_record

SCENARIOS = Path(__file__).parents[2] / "scenarios" / "umad"
MISSION = SCENARIOS / "missions" / "rounds_and_windows.json"


@pytest.fixture(
    scope="module",
    params=["route", *(pytest.param(d, marks=pytest.mark.long) for d in ("kinematic", "tracked"))],
)
def completed_run(request, argo, tmp_path_factory):
    folder = tmp_path_factory.mktemp(request.param)
    result = argo(
        "run", MISSION, "--faults", SCENARIOS / "missions" / "falling_pressure.yaml",
        "--drive", request.param, "--report", folder,
    )  # fmt: skip
    return result, read_run_record(folder), folder


def test_the_check_finds_no_errors(argo) -> None:
    argo("check", MISSION, status=0)


def test_the_mission_is_completed_with_failures(completed_run) -> None:
    result, record, _ = completed_run
    assert result.returncode == 1, result.stderr
    assert record.result.outcome is Outcome.COMPLETED_WITH_FAILURES
    assert record.result.docked
    assert record.contacts == ()
    line = result.stdout.replace("\n", " ")
    assert "Completed with failures: missed the time window: Valve R25. 5 findings" in line


def test_a_task_waits(completed_run) -> None:
    result, record, _ = completed_run
    (settle,) = record.waits
    assert (settle.task, settle.start) == ("Settle", 0.0)
    assert settle.end == pytest.approx(15.0, abs=0.11)
    first = next(run for run in record.tasks if run.task == "Gauge 1")
    assert first.start == pytest.approx(settle.end, abs=0.11)
    assert "waits for" in result.stdout


def test_rounds_begin_when_they_are_due(completed_run) -> None:
    _, record, _ = completed_run
    patrol = [one for one in record.rounds if one.group == "Patrol"]
    assert [one.number for one in patrol] == [1, 2]
    assert patrol[1].due == pytest.approx(patrol[0].began + 75.0, abs=1e-6)
    assert patrol[1].began == patrol[1].due > patrol[1].since
    starts = [run.start for run in record.tasks if run.task == "Gauge 1"]
    assert starts == pytest.approx([one.began for one in patrol], abs=0.11)


def test_a_missed_window_leads_to_its_own_target(completed_run) -> None:
    _, record, _ = completed_run
    names = [run.task for run in record.tasks]
    assert names[names.index("Valve R25") + 1] == "Lookout"
    windows = {one.task: one for one in record.windows}
    assert windows["Valve R25"].kept is WindowOutcome.MISSED
    assert windows["Valve R25"].ended == pytest.approx(240.0)
    run = next(run for run in record.tasks if run.task == "Valve R25")
    assert (run.outcome, run.reason) == ("cancelled", "its time window is over")
    assert windows["Level"].kept is WindowOutcome.KEPT
    level = next(run for run in record.tasks if run.task == "Level")
    assert level.early[1] == 330.0
    assert level.measuring[0][0] == pytest.approx(330.0, abs=0.11)


def test_a_group_is_repeated_until_the_value_is_normal(completed_run) -> None:
    _, record, _ = completed_run
    watch = [one for one in record.rounds if one.group == "Watch"]
    read = [r.value for r in record.readings if r.task == "Pressure"]
    assert len(watch) == len(read) >= 2
    assert all(value == 7.5 for value in read[:-1])
    assert read[-1] < 5.0
    assert len(watch) < 8


def test_the_report_shows_waits_rounds_and_windows(completed_run) -> None:
    _, record, folder = completed_run
    page = (folder / "report.html").read_text(encoding="utf-8")
    for words in (
        "Waits, rounds and time windows", 'id="waits"', 'id="windows"', 'id="rounds"',
        "Settle: waits for 15 s", "hard time window, 00:00 to 04:00", "round 2 of Patrol is due",
        "Level: at its place, too early until 05:30", "a round every 75 s, 2 rounds at most",
        "until #1 &lt; 5", "time window missed", "Completed with failures",
    ):  # fmt: skip
        assert words in page, words
    watch = [one for one in record.rounds if one.group == "Watch"]
    assert f"Group Watch: {len(watch)} rounds" in page
