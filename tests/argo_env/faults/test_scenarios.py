"""Each kind of fault in a mission on UMAD: found by sensing, and answered as the mission says."""

from dataclasses import dataclass
from itertools import pairwise

import pytest

from argo_compiler.hfsm import Outcome, Resume
from argo_compiler.il import EventKind
from argo_env.faults.kinds import KINDS
from argo_env.faults.reading import read_faults
from argo_env.files import resources
from argo_env.run.spec import logged_events
from tests.campaigns.faults import random_mission
from tests.conftest import seeds
from tests.yard import Watching, simulated

FOLDER = resources.scenarios() / "umad" / "faults"
SEED = 3


@dataclass(frozen=True)
class Answer:
    """What a run with the fault is to be like."""

    found: tuple[EventKind, ...] = ()
    """in this order, and nothing else"""
    mission: str = "ground"
    outcome: Outcome = Outcome.COMPLETED
    drives_to: str | None = None
    """the drive of the reaction"""
    interrupted: bool = False
    detour: bool = False
    """whether it has to go a longer way"""
    looks_again: bool = False
    """whether a checkpoint is read from another view only"""
    operator: float | None = None
    """s, when a person lets the mission go on"""


CHARGED = Answer(
    (EventKind.LOW_BATTERY, EventKind.BATTERY_CHARGED),
    drives_to="react to low_battery",
    interrupted=True,
)
GIVEN_UP = Answer(
    (EventKind.DYSFUNCTION,),
    outcome=Outcome.RETURNED,
    drives_to="react to dysfunction",
    interrupted=True,
)
ANSWERS = {
    "abnormal_value": Answer((EventKind.ABNORMAL_READING,)),
    # It is read all the same; nothing is wrong with the process.
    "displaced_checkpoint": Answer(detour=True, looks_again=True),
    "gas_leak": Answer(
        (EventKind.GAS_LEAK, EventKind.ALL_CLEAR), drives_to="react to gas_leak", interrupted=True
    ),
    "hot_spot": Answer((EventKind.HOT_SPOT,)),
    "abnormal_pump": Answer((EventKind.ABNORMAL_SOUND, EventKind.ABNORMAL_SOUND)),
    "platform_alarm": Answer(
        (EventKind.PLATFORM_ALARM,),
        drives_to="react to platform_alarm",
        interrupted=True,
        operator=150.0,
    ),
    "brick": Answer((EventKind.POSITIVE_OBSTACLE,), detour=True),
    "missing_plate": Answer((EventKind.NEGATIVE_OBSTACLE,), "upstairs", detour=True),
    "blocked_stairs": Answer((EventKind.POSITIVE_OBSTACLE,), "upstairs", detour=True),
    "low_battery": CHARGED,
    "worn_battery": CHARGED,
    "connection_loss": Answer(
        (EventKind.CONNECTION_LOST, EventKind.CONNECTION_RESTORED), interrupted=True
    ),
    "emergency_stop": Answer((EventKind.EMERGENCY_STOP,), interrupted=True, operator=70.0),
    "sensor_dysfunction": GIVEN_UP,
    "drive_dysfunction": GIVEN_UP,
}


def test_no_kind_is_untested():
    assert set(ANSWERS) == set(KINDS)


@pytest.fixture(scope="module")
def missions(shipped):
    return {name: shipped(f"../faults/{name}.txt").mission for name in ("ground", "upstairs")}


@pytest.fixture(scope="module")
def clean(missions, navigator):
    """The missions' runs without a fault."""
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
def test_found_and_answered(missions, navigator, clean, kind):
    answer = ANSWERS[kind]
    events = () if answer.operator is None else logged_events((answer.operator, Resume()))
    faults = read_faults(FOLDER / f"{kind}.yaml")
    told = []
    record = simulated(
        missions[answer.mission],
        navigator,
        seed=SEED,
        faults=faults,
        events=events,
        observers=[Watching(announce=told.append)],
    )
    usual = clean[answer.mission]
    assert tuple(a.kind for a in record.anomalies) == answer.found
    for fault, anomaly in zip(record.faults, record.anomalies, strict=False):
        assert anomaly.t >= fault.begins
        if kind == "abnormal_pump":
            assert fault.pump in anomaly.detail
    assert all(a.t > 0 and 0 < a.confidence <= 1 for a in record.anomalies)
    noticed = [a for a in record.anomalies if a.kind is not EventKind.ABNORMAL_READING]
    assert [n for n in told if n not in record.readings] == noticed
    assert record.result.outcome is answer.outcome
    assert record.contacts == ()
    assert {f.kind for f in record.faults} == {f.kind for f in faults}
    assert bool(record.interruptions) is answer.interrupted
    drives = [t.task for t in record.tasks if t.task.startswith("react to")]
    assert drives == ([] if answer.drives_to is None else [answer.drives_to])
    # Each event stands in the trace of the machine, at its time.
    for anomaly in record.anomalies:
        words = anomaly.kind.replace("_", " ")
        assert any(words in step.cause and step.t == anomaly.t for step in record.trace)
    if answer.outcome is Outcome.COMPLETED:
        assert record.result.success
        assert [r.checkpoint for r in record.readings] == [r.checkpoint for r in usual.readings]
        assert (max(r.views for r in record.readings) > 1) == answer.looks_again
    if kind != "abnormal_value":
        values = [r.value for r in usual.readings]
        assert [r.value for r in record.readings] == values[: len(record.readings)]
    if answer.detour:
        assert record.result.distance > usual.result.distance
    if answer.operator is not None:
        assert record.interruptions[-1].end == answer.operator


@pytest.mark.parametrize("seed", seeds(1))
def test_no_false_alarm_in_a_random_mission(navigator, seed):
    """One of those that `python -m tests.campaigns.faults --clean 100` runs."""
    mission = random_mission(navigator, 100 + seed)
    record = simulated(mission, navigator, seed=100 + seed)
    assert record.anomalies == ()
    assert record.result.success
