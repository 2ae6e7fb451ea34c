"""The kinematic drive: its times, poses and speeds on paths of the navigator."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.optimize import linprog

from argo_compiler.base.model import Pose
from argo_env.drives import kinematic
from argo_env.drives.drive import DriveStatus
from argo_env.drives.kinematic import (
    STEP,
    KinematicDrive,
    RestingPoseCache,
    rest_height_and_slope,
    resting_pose_cache,
    resting_poses,
)
from argo_env.navigation import Path
from argo_env.navigation.path import Motion, wrap
from argo_env.robot.spec import Calibration, MotionKind
from argo_env.site.shapes import Box
from tests.argo_env.drives.test_route import follow as follow_path
from tests.argo_env.drives.test_route import level


def as_told(robot):
    """The robot without a calibration reaches the commanded speed at once."""
    return robot.model_copy(update={"calibration": Calibration()})


def follow(world, robot, path, velocity=None, time_step=0.1):
    """Return the poses, at the start and after every step, and the drive."""
    drive = KinematicDrive(world, robot, time_step)
    return follow_path(drive, path, velocity), drive


@pytest.fixture(scope="module")
def paths(navigator, catalog):
    """Return a path on the flat, one up the stairs and one down the same stairs."""
    (a, b, *_), (c, *_) = (catalog.floor(n).patrol for n in (1, 2))
    return {"flat": navigator.plan(a, b), "up": navigator.plan(a, c), "down": navigator.plan(c, a)}


WAYS = pytest.mark.parametrize("way", ["flat", "up", "down"])


@WAYS
@pytest.mark.parametrize("velocity", [None, 0.2, 0.1])
def test_takes_the_duration_of_the_path(simulated_world, robot, paths, way, velocity):
    path = paths[way]
    poses, drive = follow(simulated_world, robot, path, velocity)
    taken = (len(poses) - 1) * drive.time_step
    assert taken == pytest.approx(path.duration(robot, velocity), abs=drive.time_step + 1e-6)


@WAYS
def test_arrives_at_the_end_pose(simulated_world, robot, paths, way):
    path = paths[way]
    poses, drive = follow(simulated_world, robot, path)
    end = drive.pose
    assert end == poses[-1]
    assert (end.x, end.y) == pytest.approx((path.end.x, path.end.y), abs=1e-9)
    assert end.z == pytest.approx(path.end.z, abs=0.01)
    assert wrap(end.yaw - path.end.yaw) == pytest.approx(0.0, abs=1e-9)
    assert end.pitch == pytest.approx(0.0, abs=0.01)
    assert drive.failure is None


@WAYS
def test_passes_every_vertex_at_its_time(simulated_world, robot, paths, way):
    path, step = paths[way], 0.05
    poses, _ = follow(simulated_world, robot, path, time_step=step)
    for t, x, y, _, yaw in path.timed_poses(robot):
        pose = poses[min(round(t / step), len(poses) - 1)]
        assert math.dist((pose.x, pose.y), (x, y)) <= robot.speed * step
        assert abs(wrap(pose.yaw - yaw)) <= robot.turn_rate_radians * step


@WAYS
@pytest.mark.parametrize("velocity", [None, 0.15])
def test_speed_and_turn_rate_are_kept(simulated_world, robot, paths, way, velocity):
    poses, drive = follow(simulated_world, robot, paths[way], velocity)
    most = drive.time_step * (velocity or robot.speed)
    turn = drive.time_step * robot.turn_rate_radians
    for a, b in pairwise(poses):
        assert math.dist((a.x, a.y), (b.x, b.y)) <= most + 1e-9
        assert abs(wrap(b.yaw - a.yaw)) <= turn + 1e-9
        # A path is straight from its foot to its head; the body tips a little faster at both.
        assert abs(b.z - a.z) <= 1.1 * most


def test_drives_at_the_velocity_asked_for_on_the_flat(simulated_world, robot):
    a, b = (Pose(x=x, y=-2.05, z=-0.03, yaw=0.0) for x in (5.05, 8.05))
    poses, drive = follow(simulated_world, as_told(robot), Path(a, (Motion(a, b),)), 0.3)
    steps = [math.dist((p.x, p.y), (q.x, q.y)) for p, q in pairwise(poses)]
    assert steps[:-1] == pytest.approx([0.3 * drive.time_step] * (len(steps) - 1))


@pytest.mark.parametrize(("way", "gear"), [("up", -1), ("down", 1)])
def test_heads_down_the_stairs_both_ways(simulated_world, robot, paths, way, gear):
    poses, _ = follow(simulated_world, as_told(robot), paths[way])
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
def test_no_pitch_on_the_flat_and_none_over_36_degrees(simulated_world, robot, paths, way):
    poses, _ = follow(simulated_world, robot, paths[way])
    assert max(abs(p.pitch) for p in poses) <= math.radians(36)
    if way == "flat":
        assert max(abs(p.pitch) for p in poses) <= math.radians(0.5)


def above_ground(simulated_world, poses):
    """Return the height (m) of the body above what is below its tracks."""
    # Below both tracks, for what lies between treads is no ground.
    sides = [(-math.sin(p.yaw) * d, math.cos(p.yaw) * d) for p in poses for d in (-0.23, 0.23)]
    points = np.repeat([[p.x, p.y] for p in poses], 2, axis=0) + np.array(sides)
    below = np.repeat([p.z + 0.5 for p in poses], 2)
    surface = simulated_world.surface_or_ray_end_heights(points, below).reshape(-1, 2).max(axis=1)
    return np.array([p.z for p in poses]) - surface


@WAYS
def test_body_neither_sinks_nor_hovers(simulated_world, robot, paths, way):
    poses, _ = follow(simulated_world, robot, paths[way])
    above = above_ground(simulated_world, poses)
    level = np.array([abs(p.pitch) < math.radians(2) for p in poses])
    assert above.min() >= -0.02
    assert above[level].max() <= 0.10


@WAYS
def test_touches_nothing_on_the_way(simulated_world, robot, paths, way):
    path = paths[way]
    drive = KinematicDrive(simulated_world, robot)
    drive.place_robot(level(path.start))
    drive.follow(path, None)
    while drive.step() is DriveStatus.MOVING:
        assert simulated_world.touches() == ()


def test_small_and_large_steps_agree(simulated_world, robot, paths):
    small, _ = follow(simulated_world, robot, paths["up"], time_step=0.05)
    large, _ = follow(simulated_world, robot, paths["up"], time_step=0.2)
    for k, pose in enumerate(large[:-1]):
        other = small[4 * k]
        assert (pose.x, pose.y, pose.z, pose.pitch) == pytest.approx(
            (other.x, other.y, other.z, other.pitch), abs=1e-6
        )
        assert abs(wrap(pose.yaw - other.yaw)) <= 1e-6
    assert large[-1] == small[-1]


def test_one_step_goes_over_many_short_motions(simulated_world, robot):
    robot = as_told(robot)
    corners = [Pose(x=5.05 + 0.01 * k, y=-2.05, z=-0.03, yaw=0.0) for k in range(6)]
    path = Path(corners[0], tuple(Motion(a, b) for a, b in pairwise(corners)))
    poses, _ = follow(simulated_world, robot, path)
    assert [p.x for p in poses] == pytest.approx([5.05, 5.09, 5.10])


def test_turns_over_the_seam_of_angles(simulated_world, robot):
    a = Pose(x=5.05, y=-2.05, z=-0.03, yaw=math.radians(170))
    b = a.model_copy(update={"yaw": math.radians(-170)})
    poses, drive = follow(simulated_world, robot, Path(a, (Motion(a, b, turn=math.radians(20)),)))
    assert all(-math.pi < p.yaw <= math.pi for p in poses)
    assert drive.pose.yaw == pytest.approx(b.yaw)


def test_arrives_at_once_without_motions(simulated_world, robot):
    here = Pose(x=8.05, y=-2.05, z=-0.03, yaw=1.0)
    poses, _ = follow(simulated_world, robot, Path(here, ()))
    assert poses == [level(here), level(here)]


def test_halt_stops_at_once(simulated_world, robot, paths):
    path = paths["flat"]
    drive = KinematicDrive(simulated_world, robot)
    drive.place_robot(level(path.start))
    drive.follow(path, None)
    for _ in range(60):
        drive.step()
    here = drive.pose
    assert math.dist((here.x, here.y), (path.start.x, path.start.y)) > 0.1
    drive.halt()
    assert drive.pose == here
    assert drive.step() is DriveStatus.ARRIVED
    assert drive.pose == here


def test_goes_on_from_where_it_was_halted(simulated_world, robot, paths, navigator, catalog):
    drive = KinematicDrive(simulated_world, robot)
    drive.place_robot(level(paths["flat"].start))
    drive.follow(paths["flat"], None)
    lattice = navigator.lattice.state_poses()[:, :2]
    while not 0.03 < np.hypot(*(lattice - (drive.pose.x, drive.pose.y)).T).min() < 0.1:
        assert drive.step() is DriveStatus.MOVING
    here = drive.pose
    drive.halt()
    goal = catalog.floor(1).patrol[3]
    path = navigator.plan(Pose(x=here.x, y=here.y, z=here.z, yaw=here.yaw), goal)
    drive.follow(path, None)
    steps, last = 1, here
    while drive.step() is DriveStatus.MOVING:
        moved = math.dist((last.x, last.y), (drive.pose.x, drive.pose.y))
        assert moved <= 1.001 * robot.speed * drive.time_step
        steps, last = steps + 1, drive.pose
    aside = math.dist((here.x, here.y), (path.start.x, path.start.y))
    assert 0.03 < aside < 0.1
    shift = robot.motion_time(MotionKind.AHEAD, aside)
    assert steps * 0.1 == pytest.approx(path.duration(robot) + shift, abs=0.1 + 1e-6)
    assert (drive.pose.x, drive.pose.y) == pytest.approx((path.end.x, path.end.y))


SLOPE = math.degrees(math.atan2(2.5 / 14, 0.28))


def lowest_line(offsets, heights):
    """Return the height at 0 of the line above all points that is lowest there."""
    solution = linprog(
        [1.0, 0.0],
        A_ub=np.column_stack([-np.ones(len(offsets)), -offsets]),
        b_ub=-heights,
        bounds=[(None, None)] * 2,
    )
    assert solution.success
    return solution.fun


@st.composite
def ground(draw):
    sizes = st.integers(1, 8)
    place = st.floats(0.01, 0.5)
    behind = draw(arrays(float, draw(sizes), elements=place, unique=True))
    ahead = draw(arrays(float, draw(sizes), elements=place, unique=True))
    offsets = np.concatenate([-np.sort(behind)[::-1], np.sort(ahead)])
    rows = draw(st.integers(1, 3))
    heights = draw(arrays(float, (rows, len(offsets)), elements=st.floats(-1.0, 1.0, width=32)))
    return offsets, heights


@given(ground())
def test_rests_on_the_lowest_line_above_the_ground(ground):
    offsets, heights = ground
    middle, slope = rest_height_and_slope(offsets, heights)
    assert middle.shape == slope.shape == (len(heights),)
    for row, m, s in zip(heights, middle, slope, strict=True):
        assert m == pytest.approx(lowest_line(offsets, row), abs=1e-6)
        assert (m + s * offsets >= row - 1e-6).all()


@given(st.floats(-1, 1), st.floats(-1, 1))
def test_rests_on_a_plane_as_it_is(height, slope):
    offsets = np.linspace(-0.45, 0.45, 18)
    middle, found = rest_height_and_slope(offsets, (height + slope * offsets)[None, :])
    assert middle[0] == pytest.approx(height, abs=1e-9)
    assert found[0] == pytest.approx(slope, abs=1e-9)


def drive(x0, y0, z0, x1, y1, z1, yaw):
    yaw = math.radians(yaw)
    return Motion(Pose(x=x0, y=y0, z=z0, yaw=yaw), Pose(x=x1, y=y1, z=z1, yaw=yaw))


@pytest.mark.parametrize("height", [0.0, 2.5, 12.5])
def test_level_on_a_deck(simulated_world, robot, height):
    poses = resting_poses(simulated_world, drive(1.9, 2.5, height, 1.9, 9.0, height, 90), robot)
    assert max(abs(p.pitch) for p in poses) <= math.radians(0.5)
    assert max(abs(p.z - height) for p in poses) <= 0.002
    assert max(math.dist((a.x, a.y), (b.x, b.y)) for a, b in pairwise(poses)) <= STEP
    assert (poses[0].x, poses[0].y, poses[-1].x, poses[-1].y) == pytest.approx((1.9, 2.5, 1.9, 9.0))


def test_level_all_round_while_turning(simulated_world, robot):
    here = Pose(x=8.05, y=-2.05, z=-0.03, yaw=0.0)
    poses = resting_poses(simulated_world, Motion(here, here, turn=3.0), robot)
    assert poses[-1].yaw - poses[0].yaw == pytest.approx(3.0)
    assert [p.z for p in poses] == pytest.approx([-0.03] * len(poses), abs=1e-6)
    assert [p.pitch for p in poses] == pytest.approx([0.0] * len(poses), abs=1e-6)


# A flight of each kind, from 0.8 m before its foot to 0.8 m past its head: straight flights rise
# north in the west tower, half flights east and west in the east tower.
FLIGHTS = [
    drive(0.85, 7.94, 5.0, 0.85, 2.7, 2.5, -90),
    drive(0.85, 2.7, 2.5, 0.85, 7.94, 5.0, -90),
    drive(15.38, 5.05, 3.75, 12.1, 5.05, 2.5, 180),
    drive(15.38, 6.05, 3.75, 12.1, 6.05, 5.0, 0),
]


@pytest.fixture(scope="module", params=range(len(FLIGHTS)), ids=str)
def on_flight(request, simulated_world, robot):
    motion = FLIGHTS[request.param]
    return motion, resting_poses(simulated_world, motion, robot)


def test_pitch_in_the_middle_of_a_flight(on_flight):
    motion, poses = on_flight
    low, high = sorted((motion.start.z, motion.end.z))
    inner = [p for p in poses if low + 0.55 <= p.z <= high - 0.55]
    assert inner
    for pose in inner:
        # Headed down the flight, whichever way it moves: the front is down.
        assert math.degrees(pose.pitch) == pytest.approx(SLOPE, abs=1.5)


def test_pitch_on_a_flight_is_bounded(on_flight):
    _, poses = on_flight
    assert max(abs(p.pitch) for p in poses) <= math.radians(36)


def test_body_keeps_to_the_surface_of_a_flight(on_flight, simulated_world):
    """Under the tracks' middle nothing rises into the body, and the ends stand on the flat."""
    _, poses = on_flight
    above = above_ground(simulated_world, poses)
    assert above.min() >= -0.02
    for end in (above[0], above[-1]):
        assert end == pytest.approx(0.0, abs=0.01)


def test_climb_is_monotonous(on_flight):
    motion, poses = on_flight
    rise = np.diff([p.z for p in poses]) * math.copysign(1.0, motion.end.z - motion.start.z)
    assert rise.min() >= -0.002
    assert rise.sum() == pytest.approx(abs(motion.end.z - motion.start.z), abs=0.005)


def test_continues_where_the_previous_motion_ended(simulated_world, robot):
    """A flight that is driven in pieces, with seams anywhere, is climbed without jumps."""
    whole = FLIGHTS[1]
    seams = [whole.pose_at(share) for share in np.linspace(0.0, 1.0, 12)]
    parts = [resting_poses(simulated_world, Motion(a, b), robot) for a, b in pairwise(seams)]
    for before, after in pairwise(parts):
        assert (after[0].z, after[0].pitch) == pytest.approx((before[-1].z, before[-1].pitch))


def test_ground_of_a_cached_motion_is_not_probed_again(simulated_world, robot, monkeypatch):
    cache = RestingPoseCache()
    motion = drive(1.9, 2.5, 2.5, 1.9, 9.0, 2.5, 90)
    first = cache.resting_poses(simulated_world, motion, robot)
    assert first == resting_poses(simulated_world, motion, robot)
    monkeypatch.setattr(kinematic, "resting_poses", None)
    assert (
        cache.resting_poses(simulated_world, drive(1.9, 2.5, 2.5, 1.9, 9.0, 2.5, 90), robot)
        == first
    )


def test_where_something_may_move_the_ground_is_probed_each_time(simulated_world, umad, robot):
    """The ground is probed beside a checkpoint, and everywhere while there is a screen."""
    cache = RestingPoseCache()
    motion = drive(1.9, 2.5, 2.5, 1.9, 9.0, 2.5, 90)
    level = cache.resting_poses(simulated_world, motion, robot)
    number = simulated_world.add_screen("plank", Box((1.9, 6.0, 2.55), (1.0, 1.0, 0.1)), (1, 0, 0))
    try:
        assert max(p.z for p in cache.resting_poses(simulated_world, motion, robot)) > 2.59
    finally:
        simulated_world.remove_screen(number)
    assert cache.resting_poses(simulated_world, motion, robot) == level
    x, y, z = umad.checkpoints[0].position
    beside = drive(x, y - 0.8, z - 0.4, x + 0.5, y - 0.8, z - 0.4, 0)
    assert cache.resting_poses(simulated_world, beside, robot) is not cache.resting_poses(
        simulated_world, beside, robot
    )


def test_other_ground_has_a_cache_of_its_own(umad, robot):
    size = robot.track_length, robot.track_gauge
    assert resting_pose_cache(umad.elements, *size) is resting_pose_cache(
        tuple(umad.elements), *size
    )
    assert resting_pose_cache(umad.elements, *size) is not resting_pose_cache(
        umad.elements[1:], *size
    )
