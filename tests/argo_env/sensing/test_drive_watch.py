"""The drive watch reports a slow drive, and no other cause that delays the robot."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.base.model import Pose
from argo_compiler.hfsm import Pause, Resume
from argo_compiler.il import EventKind
from argo_env.drives.powertrain import Powertrain
from argo_env.drives.timed_drive import RouteDrive
from argo_env.robot.pose import BodyPose
from argo_env.run.journal import open_journal
from argo_env.run.spec import logged_events
from argo_env.sensing.onboard import WINDOW, DriveWatch
from tests.conftest import examples
from tests.yard import cut_after, faults_of, mission, resumed, simulated, waypoint

STEP = 0.1  # s
START = Pose(x=1.05, y=1.05, z=0.02)


def stop(at, until):
    return {"kind": "emergency_stop", "at": at, "until": until}


def report_times_along(yard, *goals, pressed=(), share=1.0):
    """Return the times (s) of reports and the duration (s) of a drive to the goals in turn.

    The emergency stop is pressed in the intervals `pressed` (s).
    """
    drive = Powertrain(RouteDrive(yard.robot))
    watch = DriveWatch(drive, yard.robot)
    drive.place_robot(BodyPose(START.x, START.y, START.z, START.yaw))
    drive.speed_share = share
    reports, step, here = [], 0, START
    for goal in goals:
        path = yard.plan(here, goal)
        here = path.end
        drive.follow(path, None)
        while drive.path_and_velocity is not None and step < 6000:
            step += 1
            drive.stop_pressed = any(a <= step * STEP < b for a, b in pressed)
            drive.step()
            if step % round(watch.period / STEP) == 3:
                reports += [step * STEP for _ in watch.update(step * STEP, drive.pose)]
    return reports, step * STEP


FAR, NEAR = Pose(x=6.05, y=4.05, z=0.02), Pose(x=5.05, y=1.05, z=0.02)


@settings(max_examples=examples(15), deadline=None)
@given(
    st.lists(
        st.tuples(st.floats(0, 60), st.sampled_from([0.1, 0.4, 0.9, 1.5, 9.0, 40.0])), max_size=9
    )
)
def test_emergency_stops_are_never_reported_as_a_slow_drive(yard, presses):
    pressed = [(at, at + seconds) for at, seconds in presses]
    reports, _ = report_times_along(yard, FAR, START, NEAR, pressed=pressed)
    assert reports == []


@pytest.mark.parametrize("pressed", [(), [(5.0, 15.0)], [(0.0, 30.0), (33.0, 33.5)]])
def test_a_slow_drive_is_reported_once_a_window_after_its_release(yard, pressed):
    reports, took = report_times_along(yard, FAR, START, pressed=pressed, share=0.4)
    released = max((end for _, end in pressed), default=0.0)
    assert len(reports) == 1
    assert reports[0] <= released + WINDOW + 2.0 < took


def test_after_a_release_the_position_on_the_path_is_kept(shipped, navigator):
    plan = shipped("mission_1.txt", start_area=1, end_area=2).mission
    record = simulated(plan, navigator, drive="route", faults=faults_of(stop(60, 120)))
    assert [a.kind for a in record.anomalies] == [EventKind.EMERGENCY_STOP]
    assert record.result.success


@pytest.mark.parametrize("until", [10.0, 29.0, 30.0, 31.0])
def test_a_run_that_is_resumed_during_or_after_a_stop_reports_no_slow_drive(yard, tmp_path, until):
    path = tmp_path / "run.journal"
    plan = mission(waypoint("A", 6.05, 4.05), waypoint("B", 1.55, 1.05), waypoint("C", 6.05, 4.05))
    simulated(plan, yard, drive="route", faults=faults_of(stop(6, 30)), journal=path)
    with open_journal(path) as journal:
        entries = sum(entry.t <= until for entry in journal.entries)
    cut_after(path, entries)
    record = resumed(path, yard)
    assert record.resumed
    assert [a.kind for a in record.anomalies] == [EventKind.EMERGENCY_STOP]
    assert record.result.success
    assert record.result.duration > 30 + WINDOW + 2


def test_the_shift_to_the_start_of_a_path_is_a_part_of_it(yard):
    # A very slow robot that was stopped beside the lattice needs seconds to return to it.
    plan = mission(waypoint("A", 2.05, 2.55, velocity=0.02))
    events = logged_events((56.8, Pause()), (61.8, Resume()))
    record = simulated(plan, yard, drive="route", events=events)
    assert [run.outcome for run in record.tasks] == ["interrupted", "done"]
    assert record.anomalies == ()
