"""Faults on the command line: told as they are found, kept in the journal, shown in the report."""

import json
import re

import pytest

from tests.e2e.conftest import reported
from tests.e2e.test_errors import refused
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


def test_found_told_kept_and_shown(argo, folder):
    ran = argo(*RUN, "--report", "out", "--journal", "run.journal", cwd=folder, status=0)
    shown = ran.stdout + ran.stderr
    for kind in ("positive obstacle", "connection lost", "connection restored"):
        assert f"s: detected: {kind}: " in shown
    noticed = r"s: detected: gas leak: .*, noticed from floor 1 at \(\d\.\d\d, \d\.\d\d, 0\.02\)"
    assert re.search(noticed, shown)
    assert "4 findings" in ran.stdout
    assert "platform alarm did not happen: begins at 4000 s, the mission ended at" in ran.stdout
    record = reported(folder / "out")
    assert len(record.anomalies) == 5
    assert all((a.place or a.noticed_from) and a.floor == 1 for a in record.anomalies)
    assert [f.kind for f in record.faults] == [
        "brick", "abnormal_value", "connection_loss", "gas_leak", "platform_alarm",
    ]  # fmt: skip
    page = (folder / "out" / "report.html").read_text(encoding="utf-8")
    assert "<h2>Findings</h2>" in page
    assert "the base station answers" in page
    # From half of its journal it goes on with the same faults, and with one more event.
    cut(folder / "run.journal")
    go_on = ("resume", "run.journal", "--report", "again", "--event", "1=hot_spot")
    resumed = argo(*go_on, cwd=folder, status=0)
    again = reported(folder / "again")
    told = [a.kind for a in again.anomalies if a.is_reported]
    assert told == ["hot_spot"]
    assert "hot spot at " in resumed.stdout
    sensed = sorted(a.kind for a in again.anomalies if not a.is_reported)
    assert sensed == sorted(a.kind for a in record.anomalies)
    assert [r.value for r in again.readings] == [r.value for r in record.readings]
    assert any("hot spot" in step.cause for step in again.trace)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("faults:\n  - {kind: brick, floor: 3}\n", "faults[0] (brick): site yard has no floor 3"),
        ("faults:\n  - {kind: bricks}\n", "faults.yaml:2:5: error: faults[0]: no kind `bricks`"),
    ],
)
def test_faults_that_make_no_sense(argo, folder, text, says):
    (folder / "faults.yaml").write_text(text, encoding="utf-8")
    assert says in refused(argo(*RUN, cwd=folder))


def test_a_drive_without_a_world_finds_no_brick(argo, folder):
    assert "choose another drive" in refused(argo(*RUN, "--drive", "route", cwd=folder))


def test_the_schema(argo):
    fault = json.loads(argo("schema", "faults").stdout)["properties"]["faults"]["items"]
    assert "gas_leak" in fault["discriminator"]["mapping"]
