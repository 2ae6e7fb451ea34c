"""Run conditions that are not as planned, and their effects on a run."""

import pytest

from argo_compiler.base.errors import NotFound
from argo_compiler.il import Action, Group, Mission, Task
from argo_env.faults.loading import decode_faults
from argo_env.planning.opening import open_site
from argo_env.run.journal import open_journal
from argo_env.run.session import resume, simulate
from argo_env.run.spec import RunConditions, RunSpec
from tests.yard import cut, from_place

START = open_site("umad").site.docks[1]
GAUGE = open_site("umad").site.checkpoint(4)


def mission_of_rounds(count: int) -> Mission:
    """Return a mission that reads one gauge `count` times."""
    return from_place(
        START,
        Task(name="GAUGE", action=Action.MEASURE, object_id="4", group="Again"),
        Task(name="AWAY", action=Action.WAYPOINT, pose=START, group="Again"),
        groups=(Group(name="Again", start="GAUGE", end="AWAY", max_repeat_count=count),),
    )


def run(count=1, mission=None, faults=(), seed=0, drive="route", journal=None, **conditions):
    run_conditions = RunConditions.model_validate(conditions)
    spec = RunSpec(
        mission=mission or mission_of_rounds(count), drive=drive, values={4: 2.0}, faults=faults,
        seed=seed, conditions=run_conditions,
    )  # fmt: skip
    return simulate(spec, journal=journal)


def timed_values(record):
    return [(reading.t, reading.value) for reading in record.readings]


def test_without_any_all_is_as_planned():
    assert [value for _, value in timed_values(run(3))] == [2.0, 2.0, 2.0]


def test_a_value_drifts_steps_and_stays_on_its_scale():
    profile = {"drift": 3.6, "steps": [{"at": 150.0, "change": -0.5}]}
    readings = timed_values(run(6, values={4: profile}))
    assert len(readings) == 6
    assert readings[0][0] < 150 < readings[-1][0]
    for t, value in readings:
        assert value == pytest.approx(2.0 + 0.001 * t - (0.5 if t >= 150 else 0.0), abs=0.0006)
    assert timed_values(run(1, values={4: {"drift": 1e6}}))[0][1] == GAUGE.range.high


def test_what_flickers_is_drawn_by_the_moment():
    flickers = {4: {"noise": 0.05}}
    values = [value for _, value in timed_values(run(6, values=flickers))]
    assert len(set(values)) > 3
    assert values == [value for _, value in timed_values(run(6, values=flickers))]
    assert values[:3] == [value for _, value in timed_values(run(3, values=flickers))]
    assert values != [value for _, value in timed_values(run(6, values=flickers, seed=1))]


def test_a_fault_of_a_value_comes_before_its_profile():
    high = 45.0
    fault = f"faults: [{{kind: abnormal_value, checkpoint: 4, value: {high}, at: 0, until: 150}}]"
    faults = decode_faults(fault.encode(), "test").faults
    for t, value in timed_values(run(6, faults=faults, values={4: {"drift": 3.6}})):
        assert value == pytest.approx(high if t < 150 else 2.0 + 0.001 * t, abs=0.0006)


def test_a_sensor_with_noise_reads_the_same_whatever_was_read_before():
    values = [value for _, value in timed_values(run(4, sensor_noise=0.01))]
    assert len(set(values)) > 1
    assert all(abs(value - 2.0) < 0.06 * (GAUGE.range.high - GAUGE.range.low) for value in values)
    assert values[:2] == [value for _, value in timed_values(run(2, sensor_noise=0.01))]


def test_the_robot_stands_elsewhere_and_gets_there_all_the_same():
    record = run(ahead=0.4, turned=30.0)
    first = record.path[0]
    assert (first.x, first.y) != (START.x, START.y)
    assert record.readings


def test_a_slow_drive_takes_longer():
    assert run(speed=0.8).result.duration > 1.1 * run().result.duration


def test_the_battery_is_as_it_is_said():
    assert run(charge=0.5).path[0].charge == pytest.approx(0.5, abs=0.001)
    spent, worn = (1 - run(capacity=share).path[-1].charge for share in (1.0, 0.5))
    assert worn == pytest.approx(2 * spent, rel=0.05)


def test_a_run_that_was_killed_goes_on_in_the_same_conditions(tmp_path):
    conditions = {
        "speed": 0.9,
        "sensor_noise": 0.01,
        "values": {4: {"drift": 3.6, "noise": 0.1}},
    }
    whole = run(4, journal=tmp_path / "whole", **conditions)
    cut(tmp_path / "whole", to=tmp_path / "part")
    resumed = resume(open_journal(tmp_path / "part"))
    assert timed_values(resumed)[:2] == timed_values(whole)[:2]
    assert len(resumed.readings) == 4


def test_a_profile_of_no_checkpoint_is_refused_first():
    with pytest.raises(NotFound, match="99"):
        run(values={99: {"drift": 1.0}})


@pytest.mark.physics
def test_friction_is_felt_by_the_tracked_drive_alone():
    there = START.model_copy(update={"x": START.x + 1.0})
    drive = from_place(START, Task(name="THERE", action=Action.WAYPOINT, pose=there))
    tracks = [run(mission=drive, drive="tracked", friction=f).path for f in (1.0, 0.5)]
    assert tracks[0] != tracks[1]
    cheap = [run(mission=drive, drive="kinematic", friction=f).path for f in (1.0, 0.5)]
    assert cheap[0] == cheap[1]
