"""Tests of detections and false alarms, compared with the true state of each world."""

import pytest

from argo_env.evaluation.case import EvaluationCase
from argo_env.evaluation.detection import detections, false_alarms
from argo_env.evaluation.runner import WorkOrder, execute_run
from argo_env.faults.loading import decode_faults
from argo_env.files import resources
from argo_env.planning.opening import open_site
from argo_env.run.session import simulate
from argo_env.run.spec import RunConditions, RunSpec, ValueProfile
from argo_planner.use_cases.importing import Upload, import_mission
from tests.campaigns.fault_causes import find_causes
from tests.campaigns.fault_pairs import draw_case
from tests.conftest import seeds

FAULTS = resources.scenarios_folder() / "umad" / "faults"


def row_in(mission, **fields):
    """Return the row of a run by travel times in a world with these fields of the spec."""
    spec = RunSpec(mission=mission, **{"drive": "route", **fields})
    return execute_run(WorkOrder("key", EvaluationCase(mission="short", spec=spec), spec, {}))


def nominal(checkpoint: int):
    return open_site("umad").site.checkpoint(checkpoint).nominal


@pytest.mark.physics
@pytest.mark.parametrize(
    "world",
    [
        {"values": {1: 9.9}},
        {"conditions": RunConditions(charge=0.15)},
        {"conditions": RunConditions(charge=0.2003)},
        {"conditions": RunConditions(speed=0.4), "drive": "kinematic"},
        {"conditions": RunConditions(sensor_noise=0.03), "drive": "kinematic", "values": {1: 9.9}},
        {"conditions": RunConditions(values={1: ValueProfile(drift=3600.0)})},
        {"conditions": RunConditions(values={1: ValueProfile(noise=30.0)}), "seed": 3},
    ],
    ids=["value", "charge", "nearly low", "slow", "noisy camera", "drift", "flicker"],
)
def test_a_true_finding_without_a_fault_is_no_false_alarm(mission, world):
    row = row_in(mission, **world)
    assert row.findings > 0
    assert row.false_alarms == 0


def test_a_value_that_only_noise_makes_abnormal_is_a_false_alarm(mission):
    edge = nominal(1).high
    rows = [
        row_in(
            mission,
            seed=seed,
            values={1: edge - 0.01},
            conditions=RunConditions(sensor_noise=0.009),
        )
        for seed in range(12)
    ]
    assert {row.false_alarms for row in rows} == {0, 1}
    assert all(row.false_alarms == row.abnormal for row in rows)


@pytest.mark.physics
def test_a_finding_does_not_count_for_a_fault_elsewhere():
    site = open_site("umad")
    path = FAULTS / "ground.txt"
    mission = import_mission(Upload(path.name, path.read_bytes()), site, 1, 1).mission
    brick, stairs = (
        decode_faults((FAULTS / f"{name}.yaml").read_bytes(), name).faults[0]
        for name in ("brick", "blocked_stairs")
    )
    spec = RunSpec(mission=mission, seed=3, faults=(brick, stairs))
    record = simulate(spec, site)
    found = {
        detection.fault: detection.delay is not None for detection in detections(record, site.site)
    }
    assert found == {"brick": True, "blocked_stairs": False}
    assert false_alarms(record, spec, site.site) == 0
    # Without the brick among the faults, the finding on the walkway is false.
    other = record.model_copy(update={"faults": tuple(record.faults[1:])})
    assert false_alarms(other, spec, site.site) == 1


@pytest.mark.long
def test_detections_and_false_alarms_agree_with_an_independent_implementation():
    """In random runs with two faults, they agree with the causes that `fault_causes` computes."""
    findings = 0
    for number in seeds(100):
        spec = draw_case(number, "route").spec
        opened = open_site(spec.site)
        record = simulate(spec, opened)
        causes = [
            find_causes(finding, record.faults, opened.site)
            for finding in record.findings
            if not finding.is_reported_from_outside
        ]
        no_cause = sum(not faults for faults in causes)
        assert false_alarms(record, spec, opened.site) == no_cause, number
        findings += len(causes)
        for detection in detections(record, opened.site):
            times = [
                finding.t
                for finding, faults in zip(record.findings, causes, strict=True)
                if detection.fault in {fault.kind for fault in faults}
                # A value that a noisy camera misreads does not show that the camera is noisy.
                and not (finding.is_reading and detection.fault == "sensor_dysfunction")
            ]
            if detection.delay is not None:
                found_at = detection.began + detection.delay
                assert any(abs(found_at - t) < 1e-6 for t in times), number
            else:
                same = [f for f in record.faults if f.kind == detection.fault]
                assert len(times) < len(same), number
    assert findings > 5
