"""The route drive: its times and poses against the analysis and the kinematic drive."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.analysis import analyse
from argo_compiler.base.errors import ArgoError
from argo_compiler.base.model import Pose
from argo_env.drives.drive import DriveStatus
from argo_env.drives.timed_drive import RouteDrive
from argo_env.drives.timetable import Timetable
from argo_env.navigation import Path
from argo_env.navigation.path import Motion, wrap
from argo_env.navigation.views import has_line_of_sight
from argo_env.planning.travel import SiteTravel
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import Calibration, MotionPace, load_robot
from argo_env.world.without_physics import WorldWithoutPhysics
from benchmarks.drives import random_mission
from tests.conftest import examples
from tests.yard import measure, simulated, waypoint
from tests.yard import mission as in_the_yard

ROBOT = load_robot()


def level(pose):
    return BodyPose(pose.x, pose.y, pose.z, pose.yaw)


def follow(drive, path, velocity=None):
    """Return the drive's poses at the start and after every step."""
    drive.place_robot(level(path.start))
    drive.follow(path, velocity)
    poses, status = [drive.pose], DriveStatus.MOVING
    while status is DriveStatus.MOVING:
        assert len(poses) < 100_000
        status = drive.step()
        poses.append(drive.pose)
    assert status is DriveStatus.ARRIVED
    return poses


@st.composite
def paths(draw):
    """Draw a path of turns and straight motions, forwards, backwards, up and down."""
    here = Pose(x=0.0, y=0.0, z=0.0, yaw=draw(st.floats(-3.0, 3.0)))
    motions = []
    for _ in range(draw(st.integers(0, 8))):
        if draw(st.booleans()):
            turn = draw(st.floats(0.05, 3.0)) * draw(st.sampled_from([1, -1]))
            end = here.model_copy(update={"yaw": wrap(here.yaw + turn)})
            motions.append(Motion(here, end, turn=turn))
        else:
            gear, stairs = draw(st.sampled_from([1, -1])), draw(st.booleans())
            length = draw(st.floats(0.01, 5.0))
            end = Pose(
                x=here.x + gear * length * math.cos(here.yaw),
                y=here.y + gear * length * math.sin(here.yaw),
                z=here.z - gear * length * 0.6 * stairs,
                yaw=here.yaw,
            )
            motions.append(Motion(here, end, gear=gear, on_stairs=stairs))
        here = end
    return Path(motions[0].start if motions else here, tuple(motions))


paces = st.builds(MotionPace, share=st.floats(0.5, 1.2), lost=st.floats(0.0, 3.0))
robots = st.builds(Calibration, ahead=paces, reverse=paces, up=paces, down=paces, turn=paces).map(
    lambda calibration: ROBOT.model_copy(update={"calibration": calibration})
)


@given(paths(), robots, st.sampled_from([None, 0.1, 0.3]), st.sampled_from([0.05, 0.1, 0.7]))
@settings(max_examples=examples(60), deadline=None)
def test_is_on_its_path_by_time(path, robot, velocity, time_step):
    drive = RouteDrive(robot, time_step)
    poses = follow(drive, path, velocity)
    duration = path.duration(robot, velocity)
    taken = (len(poses) - 1) * time_step
    assert duration - 1e-6 <= taken <= max(duration, 0.0) + time_step + 1e-6
    end = path.end
    assert poses[-1] == BodyPose(end.x, end.y, end.z, wrap(end.yaw)) or not path.motions
    # At its vertices by the path's own table, to within a step of the fastest.
    for t, x, y, z, _ in path.timed_poses(robot, velocity):
        near = poses[min(len(poses) - 1, math.ceil(t / time_step - 1e-9))]
        speeds = [m.drive_speed(robot, velocity) * 1.2 for m in path.motions if not m.turn]
        reach = max(speeds, default=0.0) * time_step + 1e-6
        assert math.dist((near.x, near.y, near.z), (x, y, z)) <= reach


@given(paths(), robots)
@settings(max_examples=examples(40), deadline=None)
def test_the_front_is_down_on_stairs_and_level_elsewhere(path, robot):
    drive = RouteDrive(robot)
    table = Timetable(path, robot)
    for k, pose in enumerate(follow(drive, path)[:-1]):
        if k == 0 or not path.motions:
            continue
        motion, share = table.motion_and_share_at(k * 0.1)
        slope = math.atan(0.6) if motion.on_stairs else 0.0
        assert pose.pitch == pytest.approx(slope, abs=1e-6)
        assert 0.0 <= share <= 1.0


def test_halt_stops_at_once_and_forgets_the_path():
    here = Pose(x=0, y=0, z=0, yaw=0)
    there = Pose(x=4, y=0, z=0, yaw=0)
    drive = RouteDrive(ROBOT)
    drive.place_robot(BodyPose(0, 0, 0, 0))
    drive.follow(Path(here, (Motion(here, there),)), 0.5)
    for _ in range(20):
        assert drive.step() is DriveStatus.MOVING
    stopped = drive.pose
    assert 0.5 < stopped.x < 1.1
    drive.halt()
    assert drive.step() is DriveStatus.ARRIVED
    assert drive.pose == stopped


@pytest.mark.physics
def test_a_mission_goes_as_with_the_kinematic_drive(yard):
    mission = in_the_yard(measure(1), waypoint("A", 5.05, 2.05, velocity=0.2), measure(3))
    route, kinematic = (
        simulated(mission, yard, drive=drive, seed=2) for drive in ("route", "kinematic")
    )
    assert route.drive == "route"
    assert route.tasks[-1].outcome == "done"
    assert [t.end for t in route.tasks] == [t.end for t in kinematic.tasks]
    assert [r.value for r in route.readings] == [r.value for r in kinematic.readings]
    assert len(route.path) == len(kinematic.path)
    for a, b in zip(route.path, kinematic.path, strict=True):
        assert (a.x, a.y) == pytest.approx((b.x, b.y), abs=1e-6)
        assert a.z == pytest.approx(b.z, abs=0.02)


@pytest.mark.parametrize("seed", [0, 3])
def test_a_mission_takes_exactly_as_long_as_planned(navigator, catalog, seed):
    mission = random_mission(navigator, seed)
    planned = analyse(mission, catalog, SiteTravel(navigator)).duration
    record = simulated(mission, navigator, drive="route", seed=seed)
    assert record.result.success
    assert record.result.docked
    assert planned.least.value == planned.most.value
    assert record.result.duration == pytest.approx(planned.least.value, abs=1e-6)
    ends = {stretch.task: stretch.until for stretch in planned.least.path}
    assert ends == {t.task: pytest.approx(t.end, abs=1e-6) for t in record.tasks}


def test_there_is_nothing_to_show_or_to_photograph(yard):
    mission = in_the_yard(measure(1))
    with pytest.raises(ArgoError, match="no world to show"):
        simulated(mission, yard, drive="route", gui=True)
    with pytest.raises(ArgoError, match="no world that the sensor `camera`"):
        simulated(mission, yard, drive="route", sensor="camera")


def test_lines_of_sight_are_those_of_the_world(umad, robot, simulated_world):
    """They agree with the geometry that plans views, and with rays in PyBullet."""
    paper, rng = WorldWithoutPhysics(umad, robot), np.random.default_rng(4)
    low, high = (0.0, 0.0, 0.1), (15.0, 10.0, 12.0)
    names = {e.name for e in umad.elements}
    same = seen = 0
    for _ in range(examples(600)):
        origin = rng.uniform(low, high)
        target = origin + rng.uniform(-2.0, 2.0, 3)
        found = paper.obstacle_between(tuple(origin.tolist()), tuple(target.tolist()))
        assert (found is None) == bool(has_line_of_sight(umad, origin[None, :], target)[0])
        seen += found is None
        hit = simulated_world.obstacle_between(tuple(origin.tolist()), tuple(target.tolist()))
        # A ray that begins inside of something, or meets a checkpoint, is another matter.
        same += found == hit or hit not in names
    assert 20 < seen < examples(600) - 20
    assert same >= 0.97 * examples(600)
