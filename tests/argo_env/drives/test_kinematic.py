"""The kinematic drive: times, places and speeds of what it does, on paths of the navigator."""

import math
from itertools import pairwise

import numpy as np
import pytest

from argo_compiler.base.model import Pose
from argo_env.drives.drive import DriveStatus
from argo_env.drives.kinematic import KinematicDrive
from argo_env.navigation import Path
from argo_env.navigation.path import Motion, wrap
from argo_env.robot.calibration import Calibration, MotionKind
from argo_env.robot.pose import BodyPose
from tests.argo_env.drives.test_support import above_ground


def body(pose):
    return BodyPose(pose.x, pose.y, pose.z, pose.yaw)


def as_told(robot):
    """The robot without a calibration: it goes at the speed that it is told, at once."""
    return robot.model_copy(update={"calibration": Calibration()})


def follow(world, robot, path, velocity=None, time_step=0.1):
    """The poses from the start on after every step, and the drive."""
    drive = KinematicDrive(world, robot, time_step)
    drive.place(body(path.start))
    drive.begin(path, velocity)
    poses = [drive.pose]
    status = DriveStatus.MOVING
    while status is DriveStatus.MOVING:
        assert len(poses) < 100_000
        status = drive.step()
        poses.append(drive.pose)
    assert status is DriveStatus.ARRIVED
    return poses, drive


@pytest.fixture(scope="module")
def paths(navigator, catalog):
    """A way on the flat, one up the stairs and the same down."""
    (a, b, *_), (c, *_) = (catalog.floor(n).patrol for n in (1, 2))
    return {"flat": navigator.plan(a, b), "up": navigator.plan(a, c), "down": navigator.plan(c, a)}


WAYS = pytest.mark.parametrize("way", ["flat", "up", "down"])


@WAYS
@pytest.mark.parametrize("velocity", [None, 0.2, 0.1])
def test_takes_the_duration_of_the_path(simulation, robot, paths, way, velocity):
    path = paths[way]
    poses, drive = follow(simulation, robot, path, velocity)
    taken = (len(poses) - 1) * drive.time_step
    assert taken == pytest.approx(path.duration(robot, velocity), abs=drive.time_step + 1e-6)


@WAYS
def test_arrives_at_the_end_pose(simulation, robot, paths, way):
    path = paths[way]
    poses, drive = follow(simulation, robot, path)
    end = drive.pose
    assert end == poses[-1]
    assert (end.x, end.y) == pytest.approx((path.end.x, path.end.y), abs=1e-9)
    assert end.z == pytest.approx(path.end.z, abs=0.01)
    assert wrap(end.yaw - path.end.yaw) == pytest.approx(0.0, abs=1e-9)
    assert end.pitch == pytest.approx(0.0, abs=0.01)
    assert drive.failure is None


@WAYS
def test_passes_every_vertex_at_its_time(simulation, robot, paths, way):
    path, step = paths[way], 0.05
    poses, _ = follow(simulation, robot, path, time_step=step)
    for t, x, y, _, yaw in path.timed(robot):
        pose = poses[min(round(t / step), len(poses) - 1)]
        assert math.dist((pose.x, pose.y), (x, y)) <= robot.speed * step
        assert abs(wrap(pose.yaw - yaw)) <= robot.turn_rate_radians * step


@WAYS
@pytest.mark.parametrize("velocity", [None, 0.15])
def test_speed_and_turn_rate_are_kept(simulation, robot, paths, way, velocity):
    poses, drive = follow(simulation, robot, paths[way], velocity)
    most = drive.time_step * (velocity or robot.speed)
    turn = drive.time_step * robot.turn_rate_radians
    for a, b in pairwise(poses):
        assert math.dist((a.x, a.y), (b.x, b.y)) <= most + 1e-9
        assert abs(wrap(b.yaw - a.yaw)) <= turn + 1e-9
        # A path is straight from its foot to its head; the body tips a little faster at both.
        assert abs(b.z - a.z) <= 1.1 * most


def test_drives_at_the_velocity_asked_for_on_the_flat(simulation, robot):
    a, b = (Pose(x=x, y=-2.05, z=-0.03, yaw=0.0) for x in (5.05, 8.05))
    poses, drive = follow(simulation, as_told(robot), Path(a, (Motion(a, b),)), 0.3)
    steps = [math.dist((p.x, p.y), (q.x, q.y)) for p, q in pairwise(poses)]
    assert steps[:-1] == pytest.approx([0.3 * drive.time_step] * (len(steps) - 1))


@pytest.mark.parametrize(("way", "gear"), [("up", -1), ("down", 1)])
def test_heads_down_the_stairs_both_ways(simulation, robot, paths, way, gear):
    poses, _ = follow(simulation, as_told(robot), paths[way])
    tilted = [(a, b) for a, b in pairwise(poses) if a.pitch > math.radians(25)]
    assert len(tilted) > 50
    for a, b in tilted:
        ahead = (b.x - a.x) * math.cos(a.yaw) + (b.y - a.y) * math.sin(a.yaw)
        assert ahead * gear > 0
        assert (b.z - a.z) * gear < 0
        # Straight up or down, with no turn.
        assert abs(ahead) == pytest.approx(math.dist((a.x, a.y), (b.x, b.y)), abs=1e-6)
    slopes = [math.dist((a.x, a.y, a.z), (b.x, b.y, b.z)) for a, b in tilted]
    allowed = robot.stair_down_speed if gear == 1 else robot.stair_up_speed
    assert np.median(slopes) == pytest.approx(0.1 * allowed, rel=0.05)


@WAYS
def test_no_pitch_on_the_flat_and_none_over_36_degrees(simulation, robot, paths, way):
    poses, _ = follow(simulation, robot, paths[way])
    assert max(abs(p.pitch) for p in poses) <= math.radians(36)
    if way == "flat":
        assert max(abs(p.pitch) for p in poses) <= math.radians(0.5)


@WAYS
def test_body_neither_sinks_nor_hovers(simulation, robot, paths, way):
    poses, _ = follow(simulation, robot, paths[way])
    above = above_ground(simulation, poses)
    level = np.array([abs(p.pitch) < math.radians(2) for p in poses])
    assert above.min() >= -0.02
    assert above[level].max() <= 0.10


@WAYS
def test_touches_nothing_on_the_way(simulation, robot, paths, way):
    path = paths[way]
    drive = KinematicDrive(simulation, robot)
    drive.place(body(path.start))
    drive.begin(path, None)
    while drive.step() is DriveStatus.MOVING:
        assert simulation.touches() == ()


def test_small_and_large_steps_agree(simulation, robot, paths):
    small, _ = follow(simulation, robot, paths["up"], time_step=0.05)
    large, _ = follow(simulation, robot, paths["up"], time_step=0.2)
    for k, pose in enumerate(large[:-1]):
        other = small[4 * k]
        assert (pose.x, pose.y, pose.z, pose.pitch) == pytest.approx(
            (other.x, other.y, other.z, other.pitch), abs=1e-6
        )
        assert abs(wrap(pose.yaw - other.yaw)) <= 1e-6
    assert large[-1] == small[-1]


def test_one_step_goes_over_many_short_motions(simulation, robot):
    robot = as_told(robot)
    corners = [Pose(x=5.05 + 0.01 * k, y=-2.05, z=-0.03, yaw=0.0) for k in range(6)]
    path = Path(corners[0], tuple(Motion(a, b) for a, b in pairwise(corners)))
    poses, _ = follow(simulation, robot, path)
    assert [p.x for p in poses] == pytest.approx([5.05, 5.09, 5.10])


def test_turns_over_the_seam_of_angles(simulation, robot):
    a = Pose(x=5.05, y=-2.05, z=-0.03, yaw=math.radians(170))
    b = a.model_copy(update={"yaw": math.radians(-170)})
    poses, drive = follow(simulation, robot, Path(a, (Motion(a, b, turn=math.radians(20)),)))
    assert all(-math.pi < p.yaw <= math.pi for p in poses)
    assert drive.pose.yaw == pytest.approx(b.yaw)


def test_arrives_at_once_without_motions(simulation, robot):
    here = Pose(x=8.05, y=-2.05, z=-0.03, yaw=1.0)
    poses, _ = follow(simulation, robot, Path(here, ()))
    assert poses == [body(here), body(here)]


def test_halt_stops_at_once(simulation, robot, paths):
    path = paths["flat"]
    drive = KinematicDrive(simulation, robot)
    drive.place(body(path.start))
    drive.begin(path, None)
    for _ in range(60):
        drive.step()
    here = drive.pose
    assert math.dist((here.x, here.y), (path.start.x, path.start.y)) > 0.1
    drive.halt()
    assert drive.pose == here
    assert drive.step() is DriveStatus.ARRIVED
    assert drive.pose == here


def test_goes_on_from_where_it_was_halted(simulation, robot, paths, navigator, catalog):
    drive = KinematicDrive(simulation, robot)
    drive.place(body(paths["flat"].start))
    drive.begin(paths["flat"], None)
    lattice = navigator.lattice.poses()[:, :2]
    while not 0.03 < np.hypot(*(lattice - (drive.pose.x, drive.pose.y)).T).min() < 0.1:
        assert drive.step() is DriveStatus.MOVING
    here = drive.pose
    drive.halt()
    goal = catalog.floor(1).patrol[3]
    path = navigator.plan(Pose(x=here.x, y=here.y, z=here.z, yaw=here.yaw), goal)
    drive.begin(path, None)
    steps, last = 1, here
    while drive.step() is DriveStatus.MOVING:
        moved = math.dist((last.x, last.y), (drive.pose.x, drive.pose.y))
        assert moved <= 1.001 * robot.speed * drive.time_step
        steps, last = steps + 1, drive.pose
    aside = math.dist((here.x, here.y), (path.start.x, path.start.y))
    assert 0.03 < aside < 0.1
    shift = robot.seconds(MotionKind.AHEAD, aside)
    assert steps * 0.1 == pytest.approx(path.duration(robot) + shift, abs=0.1 + 1e-6)
    assert (drive.pose.x, drive.pose.y) == pytest.approx((path.end.x, path.end.y))
