"""What counts as found, and what as a false alarm: beside what was so in each world."""

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
from tests.campaigns.fault_causes import causes_of
from tests.campaigns.fault_pairs import draw
from tests.conftest import seeds

FAULTS = resources.scenarios() / "umad" / "faults"


def row_in(mission, **fields):
    """The row of a run by travel times in such a world."""
    spec = RunSpec(mission=mission, **{"drive": "route", **fields})
    return execute_run(WorkOrder("key", EvaluationCase(mission="short", spec=spec), spec, {}))


def nominal(checkpoint: int):
    return open_site("umad").site.checkpoint(checkpoint).nominal


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
def test_what_the_robot_rightly_finds_of_its_world_is_no_false_alarm(mission, world):
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


def test_a_fault_elsewhere_is_not_found_by_what_looks_the_same():
    site = open_site("umad")
    path = FAULTS / "ground.txt"
    mission = import_mission(Upload(path.name, path.read_bytes()), site, 1, 1).mission
    brick, stairs = (
        decode_faults((FAULTS / f"{name}.yaml").read_bytes(), name).faults[0]
        for name in ("brick", "blocked_stairs")
    )
    spec = RunSpec(mission=mission, seed=3, faults=(brick, stairs))
    record = simulate(spec, site)
    found = {one.fault: one.delay is not None for one in detections(record, site.site)}
    assert found == {"brick": True, "blocked_stairs": False}
    assert false_alarms(record, spec, site.site) == 0
    # Without the brick among what went wrong, what was found on the walkway was not so.
    other = record.model_copy(update={"faults": tuple(record.faults[1:])})
    assert false_alarms(other, spec, site.site) == 1


@pytest.mark.long
def test_findings_and_causes_as_another_reading_of_the_documentation_has_them():
    """Beside the causes that the measurements of faults know, in random runs with two faults."""
    seen = 0
    for number in seeds(100):
        spec = draw(number, "route").spec
        opened = open_site(spec.site)
        record = simulate(spec, opened)
        causes = [
            causes_of(finding, record.faults, opened.site)
            for finding in record.findings
            if not finding.is_reported
        ]
        assert false_alarms(record, spec, opened.site) == sum(not own for own in causes), number
        seen += len(causes)
        for one in detections(record, opened.site):
            moments = [
                finding.t
                for finding, own in zip(record.findings, causes, strict=True)
                if one.fault in {fault.kind for fault in own}
                # What a noisy camera takes a value for does not tell that it is noisy.
                and not (finding.is_reading and one.fault == "sensor_dysfunction")
            ]
            if one.delay is not None:
                assert any(abs(one.began + one.delay - t) < 1e-6 for t in moments), number
            else:
                same = [f for f in record.faults if f.kind == one.fault]
                assert len(moments) < len(same), number
    assert seen > 5
