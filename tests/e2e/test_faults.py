"""Faults on the command line: printed when detected, stored in the journal, shown in the report."""

import json
import re

import pytest

from tests.e2e.conftest import read_run_record
from tests.e2e.test_errors import require_refusal
from tests.yard import cut, measure, mission, waypoint, write_yard

FAULTS = """\
faults:
  - {kind: brick, floor: 1, place: [3.0, 2.0], yaw: 0}
  - {kind: abnormal_value, checkpoint: 3, value: 8.0, at: 5}
  - {kind: connection_loss, at: 4, until: 12}
  - {kind: gas_leak, at: 5, place: [3.0, 3.0, 0.8], rate: 0.03}
  - {kind: platform_alarm, at: 4000}
"""
RUN = ("run", "mission.json", "--site", "yard.yaml", "--faults", "faults.yaml")


@pytest.fixture
def folder(tmp_path):
    write_yard(tmp_path, mission=mission(waypoint("A", 5.05, 2.55), measure(3)))
    (tmp_path / "faults.yaml").write_text(FAULTS, encoding="utf-8")
    return tmp_path


@pytest.mark.physics
def test_faults_are_detected_logged_and_reported(argo, folder):
    ran = argo(*RUN, "--report", "out", "--journal", "run.journal", cwd=folder, status=0)
    shown = ran.stdout + ran.stderr
    for kind in ("positive obstacle", "connection lost", "connection restored"):
        assert f"s: detected: {kind}: " in shown
    noticed = r"s: detected: gas leak: .*, noticed from floor 1 at \(\d\.\d\d, \d\.\d\d, 0\.02\)"
    assert re.search(noticed, shown)
    assert "4 findings" in ran.stdout
    assert "platform alarm did not happen: begins at 4000 s, the mission ended at" in ran.stdout
    record = read_run_record(folder / "out")
    assert len(record.anomalies) == 5
    assert all((a.place or a.noticed_from) and a.floor == 1 for a in record.anomalies)
    assert [f.kind for f in record.faults] == [
        "brick", "abnormal_value", "connection_loss", "gas_leak", "platform_alarm",
    ]  # fmt: skip
    page = (folder / "out" / "report.html").read_text(encoding="utf-8")
    assert "<h2>Findings</h2>" in page
    assert "the base station answers" in page
    # Resumed from half of its journal, the run has the same faults and one more event.
    cut(folder / "run.journal")
    go_on = ("resume", "run.journal", "--report", "again", "--event", "1=hot_spot")
    resumed = argo(*go_on, cwd=folder, status=0)
    again = read_run_record(folder / "again")
    reported = [a.kind for a in again.anomalies if a.is_reported_from_outside]
    assert reported == ["hot_spot"]
    assert "hot spot at " in resumed.stdout
    sensed = sorted(a.kind for a in again.anomalies if not a.is_reported_from_outside)
    assert sensed == sorted(a.kind for a in record.anomalies)
    assert [r.value for r in again.readings] == [r.value for r in record.readings]
    assert any("hot spot" in step.cause for step in again.trace)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("faults:\n  - {kind: brick, floor: 3}\n", "faults[0] (brick): site yard has no floor 3"),
        ("faults:\n  - {kind: bricks}\n", "faults.yaml:2:5: error: faults[0]: no kind `bricks`"),
    ],
)
def test_invalid_faults_are_refused(argo, folder, text, message):
    (folder / "faults.yaml").write_text(text, encoding="utf-8")
    assert message in require_refusal(argo(*RUN, cwd=folder))


def test_obstacles_are_refused_with_the_route_drive(argo, folder):
    assert "choose another drive" in require_refusal(argo(*RUN, "--drive", "route", cwd=folder))


def test_the_schema_lists_the_kinds_of_faults(argo):
    fault = json.loads(argo("schema", "faults").stdout)["properties"]["faults"]["items"]
    assert "gas_leak" in fault["discriminator"]["mapping"]
