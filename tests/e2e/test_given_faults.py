"""Inputs on which an older Argo failed, by the command line."""

import json

import pytest


def report_of(argo, folder, *arguments):
    """Run a mission, and return the report's data."""
    argo("run", *arguments, "--report", folder / "report", status=None)
    return json.loads((folder / "report" / "report.json").read_text(encoding="utf-8"))


@pytest.mark.long
@pytest.mark.physics
@pytest.mark.rule("R11")
@pytest.mark.parametrize(
    ("script", "more"), [("low_rearm.txt", []), ("low_early.txt", ["--event", "300=resume"])]
)
def test_the_guard_fires_again_after_a_charging_that_was_cut_short(
    argo, fault_inputs, tmp_path, script, more
):
    faults = fault_inputs / "charge31.yaml"
    run = ["--faults", faults, "--drive", "route", *more]
    report = report_of(argo, tmp_path, fault_inputs / script, *run)
    assert sum(found["kind"] == "low_battery" for found in report["anomalies"]) > 1
    assert min(sample["charge"] for sample in report["path"]) > 0.2


@pytest.mark.physics
@pytest.mark.rule("C7")
def test_a_checkpoint_behind_blocked_stairs_is_unreachable(argo, fault_inputs, tmp_path):
    script = tmp_path / "blocked.txt"
    script.write_text(
        "Start in starting area 1\nCheck #8. If it is unreachable, check #4.\nGo home\n"
    )
    faults = fault_inputs / "both_blocked.yaml"
    report = report_of(argo, tmp_path, script, "--faults", faults, "--drive", "kinematic")
    done = [task["task"] for task in report["tasks"] if task["outcome"] == "done"]
    assert done == ["MEASURE 4", "DOCK"]
