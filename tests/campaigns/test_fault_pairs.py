"""Tests of runs with two faults: findings have a cause, and one without a cause is noticed."""

import pytest

from argo_compiler.il import EventKind
from argo_env.faults.kinds import KINDS, FaultFile
from argo_env.planning import open_site
from argo_env.run.record import Anomaly
from tests.campaigns.fault_causes import failures_without_cause, findings_without_cause
from tests.campaigns.fault_pairs import draw_case, kind_pairs, run_case, run_without_faults

SHORT = (("darmstadt", 2), ("darmstadt", 31))


@pytest.mark.parametrize(("drive", "runs"), [("route", 24), ("kinematic", 4)])
def test_findings_have_a_cause(drive, runs):
    outcomes = [run_case(number, drive, SHORT) for number in range(runs)]
    assert [text for o in outcomes for text in (*o.uncaused, *o.failures)] == []
    assert sum(o.findings for o in outcomes) >= runs / 3
    assert any(o.case.resumed is not None for o in outcomes)


@pytest.mark.parametrize(("drive", "count"), [("route", 8), ("kinematic", 15)])
def test_each_pair_occurs_once_in_the_order(drive, count):
    assert len(set(kind_pairs(drive))) == len(kind_pairs(drive)) == count**2
    assert {k for pair in kind_pairs("kinematic") for k in pair} == set(KINDS)


def test_a_case_depends_on_its_number_only():
    assert (
        draw_case(7, "route", SHORT)
        == draw_case(7, "route", SHORT)
        != draw_case(71, "route", SHORT)
    )
    assert "--first 7 --runs 1 --drive route" in str(draw_case(7, "route", SHORT))


FINDINGS = {
    "gas_leak": Anomaly(t=50, kind=EventKind.GAS_LEAK, detail="gas", source="gas"),
    "dysfunction": Anomaly(t=50, kind=EventKind.DYSFUNCTION, detail="0 %", source="drive"),
    "emergency_stop": Anomaly(
        t=50, kind=EventKind.EMERGENCY_STOP, detail="pressed", source="emergency stop"
    ),
}


@pytest.mark.parametrize(
    ("finding", "fault", "caused"),
    [
        ("dysfunction", {"kind": "drive_dysfunction", "at": 30, "speed": 0.3}, True),
        ("dysfunction", {"kind": "drive_dysfunction", "at": 30, "until": 45, "speed": 0}, True),
        ("dysfunction", {"kind": "drive_dysfunction", "at": 10, "until": 30, "speed": 0}, False),
        ("dysfunction", {"kind": "drive_dysfunction", "at": 30, "speed": 0.8}, False),
        ("dysfunction", {"kind": "sensor_dysfunction", "at": 30}, False),
        ("dysfunction", {"kind": "emergency_stop", "at": 10, "until": 30}, False),
        ("emergency_stop", {"kind": "emergency_stop", "at": 50}, True),
        ("emergency_stop", {"kind": "emergency_stop", "at": 51}, False),
        ("gas_leak", {"kind": "platform_alarm", "at": 10}, False),
    ],
)
def test_a_cause_fits_in_kind_and_time(finding, fault, caused):
    faults = FaultFile.model_validate({"faults": [fault]}).faults
    record = run_without_faults("darmstadt", 2)[1]
    record = record.model_copy(update={"anomalies": (FINDINGS[finding],), "faults": faults})
    assert (findings_without_cause(record, open_site("darmstadt").site) == ()) is caused


def test_the_failure_of_a_mission_needs_a_cause_too():
    record = run_without_faults("darmstadt", 2)[1]
    assert failures_without_cause(record) == ()
    result = record.result.model_copy(update={"success": False, "verdict": "it was given up"})
    assert failures_without_cause(record.model_copy(update={"result": result}))
