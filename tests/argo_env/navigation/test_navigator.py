"""Tests of paths on the site UMAD."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.sparse.csgraph import dijkstra

from argo_compiler.base.errors import ArgoError, NotFound, Unreachable
from argo_compiler.base.model import Pose
from argo_env.navigation import Navigator
from argo_env.navigation.navigator import SNAP_DISTANCE
from argo_env.navigation.views import camera_positions, sight_target
from tests.argo_env.navigation.conftest import footprint_box


def pose_of(navigator, state):
    ((x, y, z, yaw),) = navigator.lattice.state_poses(np.array([state])).tolist()
    return Pose(x=round(x, 6), y=round(y, 6), z=round(z, 6), yaw=yaw)


def random_pose(navigator, rng):
    """Return the pose of a random state of the lattice."""
    return pose_of(navigator, rng.integers(navigator.lattice.size))


@pytest.fixture(scope="module")
def views(navigator):
    """The path from each dock to each checkpoint."""
    return {
        (dock, checkpoint.id): navigator.plan_to_view(pose, checkpoint.id)
        for dock, pose in navigator.site.docks.items()
        for checkpoint in navigator.site.checkpoints
    }


@pytest.fixture(scope="module")
def routes(navigator, views):
    """Paths from each dock to each checkpoint, and between random poses."""
    rng = np.random.default_rng(5)
    paths = list(views.values())
    for _ in range(3):
        start = random_pose(navigator, rng)
        paths += [navigator.plan(start, random_pose(navigator, rng)) for _ in range(3)]
    return paths


def apart(a, b):
    return math.dist((a.x, a.y, a.z), (b.x, b.y, b.z))


def turned(a, b):
    return abs((b - a + math.pi) % (2 * math.pi) - math.pi)


def check_continuous(path):
    here = path.start
    for motion in path.motions:
        assert apart(motion.start, here) < 1e-6
        assert turned(motion.start.yaw, here.yaw) < 1e-6
        if motion.turn:
            assert apart(motion.start, motion.end) < 1e-9
            assert turned(motion.start.yaw + motion.turn, motion.end.yaw) < 1e-6
            assert abs(motion.turn) < 2 * math.pi
            assert motion.gear == 1
            assert not motion.on_stairs
        else:
            assert motion.length > 0
            assert turned(motion.start.yaw, motion.end.yaw) < 1e-6
            direction = math.atan2(motion.end.y - motion.start.y, motion.end.x - motion.start.x)
            # Rounded lattice poses leave a little.
            assert (
                turned(direction + (math.pi if motion.gear < 0 else 0.0), motion.start.yaw) < 1e-3
            )
        here = motion.end
    assert path.end == here


def test_paths_are_continuous(routes):
    for path in routes:
        check_continuous(path)


def test_neighbouring_motions_differ(routes):
    """Consecutive turns are one motion."""
    for path in routes:
        for a, b in pairwise(path.motions):
            assert not (a.turn and b.turn)


def test_backwards_up_and_forwards_down(routes):
    climbs = 0
    for path in routes:
        for motion in path.motions:
            rise = motion.end.z - motion.start.z
            if motion.on_stairs:
                assert abs(rise) > 0.1
                assert motion.gear == (-1 if rise > 0 else 1)
                climbs += rise > 0
            else:
                assert abs(rise) < 0.2 + 1e-9
    assert climbs > 20


def test_durations_are_the_sum_of_the_motions(routes, robot):
    for path in routes:
        total = 0.0
        for motion in path.motions:
            if motion.turn:
                pace = robot.calibration.turn
                nominal = math.degrees(abs(motion.turn)) / robot.turn_rate
            elif motion.on_stairs:
                up = motion.end.z > motion.start.z
                pace = robot.calibration.up if up else robot.calibration.down
                speed = robot.stair_up_speed if up else robot.stair_down_speed
                nominal = apart(motion.start, motion.end) / speed
            else:
                ahead = motion.gear > 0
                pace = robot.calibration.ahead if ahead else robot.calibration.reverse
                speed = robot.speed if ahead else robot.reverse_speed
                nominal = apart(motion.start, motion.end) / speed
            total += nominal / pace.share + pace.lost
        assert path.duration(robot) == pytest.approx(total)
        times = path.timed_poses(robot)
        assert times.shape == (len(path.motions) + 1, 5)
        assert times[-1, 0] == pytest.approx(total)
        assert (np.diff(times[:, 0]) > 0).all()
        assert times[-1, 1:].tolist() == [path.end.x, path.end.y, path.end.z, path.end.yaw]
        assert path.length == pytest.approx(
            sum(apart(a, b) for a, b in pairwise([path.start, *(m.end for m in path.motions)]))
        )
        # A velocity has no effect where the robot can't drive as fast; a lower one takes longer.
        assert path.duration(robot, 0.2) >= total - 1e-9
        assert path.duration(robot, robot.speed) == pytest.approx(total)
        assert path.duration(robot, 0.8) <= total + 1e-9


def test_smoothed_paths_beat_the_lattice(navigator, robot):
    """A path takes no longer than the cheapest path from state to state, with the same end."""
    rng = np.random.default_rng(6)
    for source in rng.integers(navigator.lattice.size, size=3):
        costs = dijkstra(navigator.lattice.costs, indices=source)
        for target in rng.integers(navigator.lattice.size, size=4):
            start, goal = (pose_of(navigator, state) for state in (source, target))
            path = navigator.plan(start, goal)
            # The lattice counts the time lost with each motion by its turns only.
            lost = sum(robot.calibration.pace_for(m.kind).lost for m in path.motions)
            assert path.duration(robot) <= costs[target] + lost + 0.01
            for end, wanted in ((path.start, start), (path.end, goal)):
                assert apart(end, wanted) < 1e-6
                assert turned(end.yaw, wanted.yaw) < 1e-6


def test_driven_paths_touch_nothing(routes, umad_world, robot, obstacles):
    checked = 0
    for path in routes[::4]:
        for motion in path.motions:
            count = 1 + math.ceil(max(motion.length / 0.1, abs(motion.turn) / math.radians(7.5)))
            # On stairs the robot is tilted, so its box is higher; the handrails' gap is upright.
            low, high = (0.3, 0.8) if motion.on_stairs else (0.06, 0.99)
            for share in np.linspace(0.0, 1.0, count):
                pose = motion.pose_at(share)
                touched = umad_world.touched(
                    *footprint_box(robot, low, high),
                    (pose.x, pose.y, pose.z),
                    pose.yaw,
                    ["railing"] if motion.on_stairs else obstacles,
                )
                assert not touched, (pose, touched)
                checked += 1
    assert checked > 3000


def test_every_floor_is_reached_from_every_dock_and_back(navigator, umad):
    for dock in umad.docks.values():
        for floor in umad.spec.floors:
            goal = Pose(x=6.75, y=10.25, z=floor.z, yaw=0.0)
            there = navigator.plan(dock, goal)
            assert apart(there.end, goal) < 0.1
            back = navigator.plan(there.end, dock)
            assert apart(back.end, dock) < 0.1
            assert turned(back.end.yaw, dock.yaw) < 1e-9
            check_continuous(there)
            check_continuous(back)
            assert there.total_ascent >= floor.z
            assert there.total_ascent - back.total_ascent == pytest.approx(
                floor.z - umad.spec.ground_z
            )


def test_every_checkpoint_is_seen_from_the_end_of_its_path(views, umad, umad_world, robot):
    sensor = robot.sensor
    assert len(views) == 40
    for (_, id), path in views.items():
        checkpoint = umad.checkpoint(id)
        assert abs(path.end.z - umad.spec.floors[checkpoint.floor - 1].z) < 0.05
        pose = np.array([[path.end.x, path.end.y, path.end.z, path.end.yaw]])
        camera = camera_positions(pose, robot)[0]
        sight = sight_target(checkpoint) - camera
        distance = np.linalg.norm(sight)
        assert sensor.min_range <= distance <= sensor.max_range
        normal = np.array([math.cos(checkpoint.yaw), math.sin(checkpoint.yaw), 0.0])
        angle = math.degrees(math.acos(-sight @ normal / distance))
        assert angle <= sensor.max_obliqueness + 1e-6
        ((material, point),) = umad_world.rays([camera], [camera + sight])
        assert material is None, (checkpoint, material, point)


def test_unknown_checkpoint(navigator, umad):
    with pytest.raises(NotFound):
        navigator.plan_to_view(umad.docks[1], 99)


@pytest.mark.long
def test_same_query_same_path(navigator, umad, robot):
    again = Navigator(umad, robot)
    goal = Pose(x=12.4, y=1.6, z=7.5, yaw=1.0)
    start = umad.docks[2]
    first = navigator.plan(start, goal)
    navigator.plan(goal, start)
    assert navigator.plan(start, goal) == first
    assert again.plan(start, goal) == first
    assert again.plan_to_view(start, 14) == navigator.plan_to_view(start, 14)


@pytest.mark.parametrize(
    "position",
    [
        (6.8, 10.4, 3.8),  # in the air between floors
        (4.2, 7.7, 0.0),  # inside a vessel
        (4.2, 7.7, 5.0),
        (30.0, 0.0, 0.0),  # beyond the ground
        (6.8, 10.4, 14.9),  # above the top floor
        (6.8, 10.4, -3.0),
        (8.0, 5.5, 7.5),  # over the drop in the middle of floor 4
    ],
)
def test_positions_that_cannot_be_reached(navigator, umad, position):
    pose = Pose(x=position[0], y=position[1], z=position[2], yaw=0.0)
    wanted = f"({position[0]:.2f}, {position[1]:.2f}, {position[2]:.2f})"
    for refused in (
        lambda: navigator.plan(umad.docks[1], pose),
        lambda: navigator.plan(pose, umad.docks[1]),
        lambda: navigator.plan_to_view(pose, 1),
        lambda: navigator.snap_keeping_heading(pose),
    ):
        with pytest.raises(Unreachable) as caught:
            refused()
        assert isinstance(caught.value, ArgoError)
        assert wanted in str(caught.value)
        assert "0.5 m" in str(caught.value)


def test_snapping_keeps_the_heading_and_is_idempotent(navigator, umad):
    for x, y in ((12.4, 3.0), (11.8, 6.0), (6.8, 1.9), (6.8, 1.45)):
        wanted = Pose(x=x, y=y, z=2.5, yaw=0.3)
        snapped = navigator.snap_keeping_heading(wanted)
        assert snapped.yaw == wanted.yaw
        assert apart(snapped, wanted) <= SNAP_DISTANCE
        assert navigator.snap_keeping_heading(snapped) == snapped
        path = navigator.plan(umad.docks[1], wanted)
        assert apart(path.end, wanted) <= SNAP_DISTANCE


def test_with_enough_clearance_the_path_ends_at_the_requested_pose(navigator, umad):
    for yaw in (0.0, 1.0, -2.5, 3.1):
        wanted = Pose(x=8.02, y=-2.03, z=umad.spec.ground_z, yaw=yaw)
        path = navigator.plan(umad.docks[1], wanted)
        assert apart(path.end, wanted) <= 0.051
        assert turned(path.end.yaw, yaw) < 1e-9


def test_path_to_the_own_pose_has_no_motions(navigator, umad):
    dock = navigator.snap_keeping_heading(umad.docks[1])
    path = navigator.plan(dock, dock)
    assert path.motions == ()
    assert path.end == path.start


def test_turns_at_turning_poses_touch_nothing(navigator, umad, umad_world, robot, obstacles):
    low, high = footprint_box(robot, 0.06, 0.99)
    for floor in umad.spec.floors:
        poses = navigator.turning_poses(floor.number)
        assert len(poses)
        assert np.abs(poses[:, 2] - floor.z).max() <= 0.01
        for x, y, z, _ in np.random.default_rng(7).permutation(poses)[:25]:
            for yaw in np.radians(np.arange(0, 360, 7.5)):
                touched = umad_world.touched(low, high, (x, y, z), yaw, obstacles)
                assert not touched, (x, y, z, yaw, touched)


def test_turning_poses_are_those_with_all_turns(navigator, umad):
    lattice = navigator.lattice
    source, target = lattice.costs.tocoo().coords
    turning = source[lattice.cell[source] == lattice.cell[target]]
    moves = np.bincount(lattice.cell[turning], minlength=navigator.surface.size)
    for floor in umad.spec.floors:
        level = np.abs(navigator.surface.z - floor.z) <= 0.01
        wanted = navigator.surface.cell_positions()[np.flatnonzero((moves == 16) & level)]
        assert navigator.turning_poses(floor.number)[:, :3].tolist() == wanted.tolist()
