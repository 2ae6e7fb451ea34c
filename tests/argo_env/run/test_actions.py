"""Attributes of a task for its action: pose, time limit for reading, joint states."""

import math

import pytest

from argo_compiler.base.model import Pose
from argo_compiler.il import JointState
from argo_env.sensing.sensor import Measurement, MeasurementError, PoorViewError
from tests.yard import (
    Entries,
    fast_setup,
    measure,
    mission,
    run_with,
    simulated,
    waypoint,
)

BEFORE_1 = Pose(x=2.55, y=2.55, z=0.02, yaw=math.radians(90))
AWAY = Pose(x=5.55, y=1.55, z=0.02, yaw=0.0)


class Fog:
    """Sensor whose first `failures` measurements fail, from whatever pose."""

    name = "fog"

    def __init__(self, failures, error=MeasurementError):
        self._failures, self._error = failures, error

    def measure(self, *_):
        self._failures -= 1
        if self._failures >= 0:
            raise self._error("fog")
        return Measurement(3.0, 1.0)


def foggy(yard, failures, error=MeasurementError):
    setup = fast_setup(yard)
    return type(setup)(setup.world, setup.navigator, setup.drive, Fog(failures, error))


def action_ends(plan, setup):
    """Return the events of actions' ends in a run, and its record."""
    entries = Entries()
    record = run_with(plan, setup, observers=[entries])
    kinds = ("succeeded", "failed", "stopped")
    return [e for entry in entries.all for e in entry.events if e.kind in kinds], record


class TestOwnPose:
    @pytest.mark.rule("T10")
    def test_it_measures_from_there(self, yard):
        record = simulated(mission(measure(1, pose=BEFORE_1)), yard, drive="route")
        last = record.path[-1]
        assert math.dist((last.x, last.y), (BEFORE_1.x, BEFORE_1.y)) <= 0.1
        assert last.yaw == pytest.approx(BEFORE_1.yaw, abs=0.1)
        assert record.readings[0].checkpoint == 1
        assert record.readings[0].views == 1

    def test_what_is_not_seen_from_there_is_unreadable_and_seen_from_nowhere_else(self, yard):
        record = simulated(mission(measure(1, pose=AWAY)), yard, drive="route")
        assert record.readings == ()
        assert record.tasks[0].outcome == "failed"
        assert "gauge 1 is" in record.tasks[0].reason
        last = record.path[-1]
        assert math.dist((last.x, last.y), (AWAY.x, AWAY.y)) <= 0.1

    def test_where_it_can_not_stand_it_fails_with_a_reason(self, yard):
        nowhere = Pose(x=30.0, y=0.0, z=0.0)
        (end,), record = action_ends(mission(measure(1, pose=nowhere)), fast_setup(yard))
        assert "no place that the robot can reach" in record.tasks[0].reason
        assert not end.unreadable


class TestReadings:
    @pytest.mark.rule("C3")
    def test_a_look_that_fails_is_unreadable(self, yard):
        (end,), _ = action_ends(mission(measure(1)), foggy(yard, 1))
        assert (end.kind, end.unreadable) == ("failed", True)

    def test_from_several_places_as_well(self, yard):
        (end,), _ = action_ends(mission(measure(1)), foggy(yard, 9, PoorViewError))
        assert (end.kind, end.unreadable) == ("failed", True)

    def test_a_place_that_is_not_reached_is_not(self, yard):
        (end,), _ = action_ends(mission(waypoint("A", 30, 30)), fast_setup(yard))
        assert (end.kind, end.unreadable) == ("failed", False)

    @pytest.mark.parametrize(("value", "abnormal"), [(4.9, False), (5.1, True)])
    def test_values_outside_the_nominal_range_are_abnormal(self, yard, value, abnormal):
        (end,), record = action_ends(mission(measure(1)), fast_setup(yard, {1: value}))
        assert (end.value, end.abnormal) == (value, abnormal)
        assert [a.kind.value for a in record.anomalies] == ["abnormal_reading"] * abnormal


class TestReadingLimit:
    @pytest.mark.rule("T10")
    def test_it_is_unreadable_after_that_long(self, yard):
        plan = mission(measure(1, reading_limit=1.0), waypoint("A", 2.05, 2.05))
        (failed, _), record = action_ends(plan, fast_setup(yard))
        assert (failed.kind, failed.unreadable) == ("failed", True)
        run = record.tasks[0]
        assert run.reason == "not read within 1 s"
        assert run.measuring_duration == pytest.approx(2.0, abs=0.2), "the arm is stowed again"

    def test_the_robot_looks_from_elsewhere_as_long_as_there_is_time(self, yard):
        (patient,), slow = action_ends(mission(measure(1)), foggy(yard, 1, PoorViewError))
        (hasty,), fast = action_ends(
            mission(measure(1, reading_limit=6.5)), foggy(yard, 1, PoorViewError)
        )
        assert (patient.kind, hasty.kind) == ("succeeded", "failed")
        assert hasty.unreadable
        assert fast.result.duration < slow.result.duration

    def test_a_limit_that_is_long_enough_changes_nothing(self, yard):
        plain = run_with(mission(measure(1)), fast_setup(yard))
        limited = run_with(mission(measure(1, reading_limit=60.0)), fast_setup(yard))
        assert limited.tasks == plain.tasks


class TestJoints:
    @pytest.mark.physics
    @pytest.mark.rule("T10")
    def test_joints_of_the_arm_are_moved_and_others_are_named(self, yard):
        joint = min(yard.robot.arm_raised)
        asked = JointState(names=(joint, "winch"), positions=(0.5, 1.0))
        plan = mission(measure(1, joint_states=asked))
        record = simulated(plan, yard)
        assert record.tasks[0].outcome == "done"
        assert record.tasks[0].unmoved == ("winch",)

    def test_without_a_world_nothing_moves(self, yard):
        asked = JointState(names=("winch",), positions=(1.0,))
        plan = mission(waypoint("A", 2.05, 2.05, joint_states=asked))
        assert simulated(plan, yard, drive="route").tasks[0].unmoved == ("winch",)

    def test_the_arm_goes_where_the_task_wants_it(self, yard):
        joint = min(yard.robot.arm_raised)
        seen = []
        setup = fast_setup(yard)
        asked = JointState(names=(joint,), positions=(0.5,))
        run_with(mission(measure(1, joint_states=asked)), setup)
        seen = [round(math.radians(told[joint]), 6) for told in setup.world.arm]
        assert 0.5 in seen
