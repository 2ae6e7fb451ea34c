"""No all-clear is given while a leak goes on; one that were given would be a false alarm."""

import pytest

from argo_compiler.il import EventKind
from argo_env import RunSpec, open_site, simulate
from argo_env.evaluation.detection import false_alarms
from argo_env.faults.loading import decode_faults
from argo_env.faults.plant import GasLeakFault, PlatformAlarm
from argo_env.report.html import page
from argo_env.run.causes import explain_false_all_clear, false_all_clears
from argo_env.run.record import Anomaly
from tests.whole_scripts import import_whole

MISSION = """Mission Protocol #1
In case of a gas leak, go to starting area 1, wait until all clear for at most 1 min, and resume.
1. Set the starting point in starting area 1.
2. Check checkpoint #5.
3. Return to the docking station in starting area 1.
"""
LEAK = GasLeakFault(at=60.0, place=(8.0, 6.0, 3.3), rate=0.02)


def run_with_leak(script, seed, faults):
    site = open_site("umad")
    mission = import_whole(script, site.catalog, source_name="mission.txt").mission
    return simulate(RunSpec(mission=mission, seed=seed, faults=faults), site)


def kinds_by_gas_watch(record):
    return [anomaly.kind for anomaly in record.anomalies if anomaly.source == "gas"]


@pytest.mark.physics
def test_a_robot_that_passes_a_hiss_again_and_again_gives_no_all_clear():
    assert kinds_by_gas_watch(run_with_leak(MISSION, 5, (LEAK,))) == [EventKind.GAS_LEAK]


@pytest.mark.physics
def test_no_all_clear_for_the_given_leak(fault_inputs):
    script = (fault_inputs / "false_allclear.txt").read_text(encoding="utf-8")
    name = "false_allclear.yaml"
    faults = decode_faults((fault_inputs / name).read_bytes(), name).faults
    assert kinds_by_gas_watch(run_with_leak(script, 2, faults)) == [EventKind.GAS_LEAK]


def anomaly(t, kind, source):
    at = (8.0, 2.0, 2.5) if source == "gas" else None
    return Anomaly(t=t, kind=kind, detail="", source=source, noticed_from=at)


@pytest.fixture(scope="module")
def quiet():
    """Return the spec and the record of a run by travel times, in which nothing is found."""
    site = open_site("umad")
    mission = import_whole(MISSION, site.catalog, source_name="mission.txt").mission
    values = {5: site.site.checkpoint(5).nominal.low}
    spec = RunSpec(mission=mission, drive="route", values=values)
    return spec, simulate(spec, site)


@pytest.mark.parametrize(
    ("fault", "kind", "source", "why"),
    [
        (LEAK, EventKind.GAS_LEAK, "gas", "the gas leak went on"),
        (PlatformAlarm(at=60.0), EventKind.PLATFORM_ALARM, "alarm", "the alarm went on"),
    ],
)
@pytest.mark.parametrize(
    ("until", "cleared_by_robot", "is_false"),
    [(None, True, True), (200.0, True, True), (95.0, True, False), (None, False, False)],
)
def test_an_all_clear_while_the_danger_goes_on_is_a_false_alarm(
    quiet, fault, kind, source, why, until, cleared_by_robot, is_false
):
    spec, record = quiet
    site = open_site("umad").site
    end = anomaly(100.0, EventKind.ALL_CLEAR, source if cleared_by_robot else "told")
    record = record.model_copy(
        update={
            "anomalies": (anomaly(70.0, kind, source), end),
            "faults": (fault.model_copy(update={"until": until}),),
        }
    )
    assert false_alarms(record, spec, site) == is_false
    text = f"the all-clear at 01:40 was false: {why}"
    assert [explain_false_all_clear(a) for a in false_all_clears(record, site)] == [text] * is_false
    assert (text[1:] in page(record, site)) == is_false


def test_each_false_all_clear_counts_once(quiet):
    spec, record = quiet
    found = [
        anomaly(float(t), kind, "gas")
        for t, kind in (
            (70, EventKind.GAS_LEAK),
            (80, EventKind.GAS_LEAK),
            (100, EventKind.ALL_CLEAR),
            (110, EventKind.GAS_LEAK),
            (150, EventKind.ALL_CLEAR),
        )
    ]
    record = record.model_copy(update={"anomalies": tuple(found), "faults": (LEAK,)})
    assert false_alarms(record, spec, open_site("umad").site) == 2
