"""Each kind of fault is detected in a mission on UMAD, which reacts as its script states."""

from dataclasses import dataclass
from itertools import pairwise

import pytest

from argo_compiler.hfsm import Outcome, Resume
from argo_compiler.il import EventKind
from argo_env.faults.kinds import KINDS
from argo_env.faults.loading import read_faults
from argo_env.files import resources
from argo_env.run.spec import logged_events
from tests.campaigns.faults import random_mission
from tests.conftest import seeds
from tests.yard import Watching, simulated

pytestmark = pytest.mark.physics

FOLDER = resources.scenarios_folder() / "umad" / "faults"
SEED = 3


@dataclass(frozen=True)
class ExpectedRun:
    """Expected run with a fault."""

    findings: tuple[EventKind, ...] = ()
    """all findings, in this order"""
    mission: str = "ground"
    outcome: Outcome = Outcome.COMPLETED
    drives_to: str | None = None
    """name of the reaction's task"""
    interrupted: bool = False
    detour: bool = False
    """True if the robot has to take a longer path"""
    needs_another_view: bool = False
    """True if a checkpoint can be read from another view only"""
    operator: float | None = None
    """s, when a person resumes the mission"""


CHARGED = ExpectedRun(
    (EventKind.LOW_BATTERY, EventKind.BATTERY_CHARGED),
    drives_to="react to low_battery",
    interrupted=True,
)
ABORTED = ExpectedRun(
    (EventKind.DYSFUNCTION,),
    outcome=Outcome.RETURNED,
    drives_to="react to dysfunction",
    interrupted=True,
)
EXPECTED_RUNS = {
    "abnormal_value": ExpectedRun((EventKind.ABNORMAL_READING,)),
    # The checkpoint can still be read, and its value is normal.
    "displaced_checkpoint": ExpectedRun(detour=True, needs_another_view=True),
    "gas_leak": ExpectedRun(
        (EventKind.GAS_LEAK, EventKind.ALL_CLEAR), drives_to="react to gas_leak", interrupted=True
    ),
    "hot_spot": ExpectedRun((EventKind.HOT_SPOT,)),
    "abnormal_pump": ExpectedRun((EventKind.ABNORMAL_SOUND, EventKind.ABNORMAL_SOUND)),
    "platform_alarm": ExpectedRun(
        (EventKind.PLATFORM_ALARM,),
        drives_to="react to platform_alarm",
        interrupted=True,
        operator=150.0,
    ),
    "brick": ExpectedRun((EventKind.POSITIVE_OBSTACLE,), detour=True),
    "missing_plate": ExpectedRun((EventKind.NEGATIVE_OBSTACLE,), "upstairs", detour=True),
    "blocked_stairs": ExpectedRun((EventKind.POSITIVE_OBSTACLE,), "upstairs", detour=True),
    "low_battery": CHARGED,
    "worn_battery": CHARGED,
    "connection_loss": ExpectedRun(
        (EventKind.CONNECTION_LOST, EventKind.CONNECTION_RESTORED), interrupted=True
    ),
    "emergency_stop": ExpectedRun((EventKind.EMERGENCY_STOP,), interrupted=True, operator=70.0),
    "sensor_dysfunction": ABORTED,
    "drive_dysfunction": ABORTED,
}


def test_no_kind_is_untested():
    assert set(EXPECTED_RUNS) == set(KINDS)


@pytest.fixture(scope="module")
def missions(shipped):
    return {name: shipped(f"../faults/{name}.txt").mission for name in ("ground", "upstairs")}


@pytest.fixture(scope="module")
def clean(missions, navigator):
    """Records of the missions without a fault, by name."""
    return {name: simulated(mission, navigator, seed=SEED) for name, mission in missions.items()}


@pytest.mark.parametrize("name", ["ground", "upstairs"])
def test_without_a_fault_nothing_is_reported(clean, name):
    record = clean[name]
    assert record.anomalies == ()
    assert record.interruptions == ()
    assert record.result.success
    assert record.faults == ()
    charges = [s.charge for s in record.path]
    assert charges[0] > 0.999
    assert all(a >= b for a, b in pairwise(charges))


@pytest.mark.parametrize("kind", KINDS)
def test_a_fault_is_detected_and_the_mission_reacts(missions, navigator, clean, kind):
    expected = EXPECTED_RUNS[kind]
    events = () if expected.operator is None else logged_events((expected.operator, Resume()))
    faults = read_faults(FOLDER / f"{kind}.yaml")
    announced = []
    record = simulated(
        missions[expected.mission],
        navigator,
        seed=SEED,
        faults=faults,
        events=events,
        observers=[Watching(announce=announced.append)],
    )
    usual = clean[expected.mission]
    assert tuple(a.kind for a in record.anomalies) == expected.findings
    for fault, anomaly in zip(record.faults, record.anomalies, strict=False):
        assert anomaly.t >= fault.start_time
        if kind == "abnormal_pump":
            assert fault.pump in anomaly.detail
    assert all(a.t > 0 and 0 < a.confidence <= 1 for a in record.anomalies)
    noticed = [a for a in record.anomalies if a.kind is not EventKind.ABNORMAL_READING]
    assert [n for n in announced if n not in record.readings] == noticed
    assert record.result.outcome is expected.outcome
    assert record.contacts == ()
    assert {f.kind for f in record.faults} == {f.kind for f in faults}
    assert bool(record.interruptions) is expected.interrupted
    drives = [t.task for t in record.tasks if t.task.startswith("react to")]
    assert drives == ([] if expected.drives_to is None else [expected.drives_to])
    # Each event is in the trace of the machine, at its time.
    for anomaly in record.anomalies:
        words = anomaly.kind.replace("_", " ")
        assert any(words in step.cause and step.t == anomaly.t for step in record.trace)
    if expected.outcome is Outcome.COMPLETED:
        assert record.result.success
        assert [r.checkpoint for r in record.readings] == [r.checkpoint for r in usual.readings]
        assert (max(r.views for r in record.readings) > 1) == expected.needs_another_view
    if kind != "abnormal_value":
        values = [r.value for r in usual.readings]
        assert [r.value for r in record.readings] == values[: len(record.readings)]
    if expected.detour:
        assert record.result.distance > usual.result.distance
    if expected.operator is not None:
        assert record.interruptions[-1].end == expected.operator


@pytest.mark.parametrize("seed", seeds(1))
def test_no_false_alarm_in_a_random_mission(navigator, seed):
    """The mission is one of those that `python -m tests.campaigns.faults --clean 100` runs."""
    mission = random_mission(navigator, 100 + seed)
    record = simulated(mission, navigator, seed=100 + seed)
    assert record.anomalies == ()
    assert record.result.success
