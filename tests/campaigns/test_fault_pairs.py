"""Runs with two faults each: what they find has a cause, and what has none would be noticed."""

import pytest

from argo_compiler.il import EventKind
from argo_env.faults.kinds import KINDS, FaultFile
from argo_env.planning import open_site
from argo_env.run.record import Anomaly
from tests.campaigns.fault_causes import given_up_without_cause, without_cause
from tests.campaigns.fault_pairs import draw, examine, pairs, undisturbed

SHORT = (("darmstadt", 2), ("darmstadt", 31))


@pytest.mark.parametrize(("drive", "runs"), [("route", 24), ("kinematic", 4)])
def test_what_is_found_has_a_cause(drive, runs):
    verdicts = [examine(number, drive, SHORT) for number in range(runs)]
    assert [said for v in verdicts for said in (*v.uncaused, *v.given_up)] == []
    assert sum(v.findings for v in verdicts) >= runs / 3
    assert any(v.case.resumed is not None for v in verdicts)


@pytest.mark.parametrize(("drive", "count"), [("route", 8), ("kinematic", 15)])
def test_every_pair_comes_once_in_a_round(drive, count):
    assert len(set(pairs(drive))) == len(pairs(drive)) == count**2
    assert {k for pair in pairs("kinematic") for k in pair} == set(KINDS)


def test_a_case_is_drawn_from_its_number():
    assert draw(7, "route", SHORT) == draw(7, "route", SHORT) != draw(71, "route", SHORT)
    assert "--first 7 --runs 1 --drive route" in str(draw(7, "route", SHORT))


FOUND = {
    "gas_leak": Anomaly(t=50, kind=EventKind.GAS_LEAK, detail="gas", source="gas"),
    "dysfunction": Anomaly(t=50, kind=EventKind.DYSFUNCTION, detail="0 %", source="drive"),
    "emergency_stop": Anomaly(
        t=50, kind=EventKind.EMERGENCY_STOP, detail="pressed", source="emergency stop"
    ),
}


@pytest.mark.parametrize(
    ("found", "fault", "caused"),
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
def test_a_cause_fits_in_kind_and_time(found, fault, caused):
    faults = FaultFile.model_validate({"faults": [fault]}).faults
    record = undisturbed("darmstadt", 2)[1]
    record = record.model_copy(update={"anomalies": (FOUND[found],), "faults": faults})
    assert (without_cause(record, open_site("darmstadt").site) == ()) is caused


def test_a_mission_that_is_given_up_needs_a_cause_too():
    record = undisturbed("darmstadt", 2)[1]
    assert given_up_without_cause(record) == ()
    result = record.result.model_copy(update={"success": False, "verdict": "it was given up"})
    assert given_up_without_cause(record.model_copy(update={"result": result}))
