"""How the robot rests on the ground: against a linear programme, and on the site's stairs."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.optimize import linprog

from argo_compiler.base.model import Pose
from argo_env.drives import support
from argo_env.drives.support import STEP, GroundMemory, ground_memory, resting, resting_poses
from argo_env.navigation.path import Motion
from argo_env.site.shapes import Box

SLOPE = math.degrees(math.atan2(2.5 / 14, 0.28))


def lowest_line(offsets, heights):
    """Height at 0 of the line above all points that is lowest there."""
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
    middle, slope = resting(offsets, heights)
    assert middle.shape == slope.shape == (len(heights),)
    for row, m, s in zip(heights, middle, slope, strict=True):
        assert m == pytest.approx(lowest_line(offsets, row), abs=1e-6)
        assert (m + s * offsets >= row - 1e-6).all()


@given(st.floats(-1, 1), st.floats(-1, 1))
def test_rests_on_a_plane_as_it_is(height, slope):
    offsets = np.linspace(-0.45, 0.45, 18)
    middle, found = resting(offsets, (height + slope * offsets)[None, :])
    assert middle[0] == pytest.approx(height, abs=1e-9)
    assert found[0] == pytest.approx(slope, abs=1e-9)


def drive(x0, y0, z0, x1, y1, z1, yaw):
    yaw = math.radians(yaw)
    return Motion(Pose(x=x0, y=y0, z=z0, yaw=yaw), Pose(x=x1, y=y1, z=z1, yaw=yaw))


@pytest.mark.parametrize("height", [0.0, 2.5, 12.5])
def test_level_on_a_deck(simulation, robot, height):
    poses = resting_poses(simulation, drive(1.9, 2.5, height, 1.9, 9.0, height, 90), robot)
    assert max(abs(p.pitch) for p in poses) <= math.radians(0.5)
    assert max(abs(p.z - height) for p in poses) <= 0.002
    assert max(math.dist((a.x, a.y), (b.x, b.y)) for a, b in pairwise(poses)) <= STEP
    assert (poses[0].x, poses[0].y, poses[-1].x, poses[-1].y) == pytest.approx((1.9, 2.5, 1.9, 9.0))


def test_level_all_round_while_turning(simulation, robot):
    here = Pose(x=8.05, y=-2.05, z=-0.03, yaw=0.0)
    poses = resting_poses(simulation, Motion(here, here, turn=3.0), robot)
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
def on_flight(request, simulation, robot):
    motion = FLIGHTS[request.param]
    return motion, resting_poses(simulation, motion, robot)


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


def above_ground(simulation, poses):
    """How high (m) the body is above what is below its tracks."""
    # Below both tracks, for what lies between treads is no ground.
    sides = [(-math.sin(p.yaw) * d, math.cos(p.yaw) * d) for p in poses for d in (-0.23, 0.23)]
    points = np.repeat([[p.x, p.y] for p in poses], 2, axis=0) + np.array(sides)
    below = np.repeat([p.z + 0.5 for p in poses], 2)
    surface = simulation.heights(points, below).reshape(-1, 2).max(axis=1)
    return np.array([p.z for p in poses]) - surface


def test_body_keeps_to_the_surface_of_a_flight(on_flight, simulation):
    """Under the tracks' middle nothing rises into the body, and the ends stand on the flat."""
    _, poses = on_flight
    above = above_ground(simulation, poses)
    assert above.min() >= -0.02
    for end in (above[0], above[-1]):
        assert end == pytest.approx(0.0, abs=0.01)


def test_climb_is_monotonous(on_flight):
    motion, poses = on_flight
    rise = np.diff([p.z for p in poses]) * math.copysign(1.0, motion.end.z - motion.start.z)
    assert rise.min() >= -0.002
    assert rise.sum() == pytest.approx(abs(motion.end.z - motion.start.z), abs=0.005)


def test_goes_on_where_the_motion_before_ended(simulation, robot):
    """A flight that is driven in pieces, with seams anywhere, is climbed without jumps."""
    whole = FLIGHTS[1]
    seams = [whole.at(share) for share in np.linspace(0.0, 1.0, 12)]
    parts = [resting_poses(simulation, Motion(a, b), robot) for a, b in pairwise(seams)]
    for before, after in pairwise(parts):
        assert (after[0].z, after[0].pitch) == pytest.approx((before[-1].z, before[-1].pitch))


def test_ground_that_is_remembered_is_not_probed_again(simulation, robot, monkeypatch):
    memory = GroundMemory()
    motion = drive(1.9, 2.5, 2.5, 1.9, 9.0, 2.5, 90)
    first = memory.resting_poses(simulation, motion, robot)
    assert first == resting_poses(simulation, motion, robot)
    monkeypatch.setattr(support, "resting_poses", None)
    assert memory.resting_poses(simulation, drive(1.9, 2.5, 2.5, 1.9, 9.0, 2.5, 90), robot) == first


def test_where_something_may_move_the_ground_is_probed_each_time(simulation, umad, robot):
    """Beside a checkpoint, and all over while there is a screen."""
    memory = GroundMemory()
    motion = drive(1.9, 2.5, 2.5, 1.9, 9.0, 2.5, 90)
    level = memory.resting_poses(simulation, motion, robot)
    number = simulation.add_screen("plank", Box((1.9, 6.0, 2.55), (1.0, 1.0, 0.1)), (1, 0, 0))
    try:
        assert max(p.z for p in memory.resting_poses(simulation, motion, robot)) > 2.59
    finally:
        simulation.remove_screen(number)
    assert memory.resting_poses(simulation, motion, robot) == level
    x, y, z = umad.checkpoints[0].position
    beside = drive(x, y - 0.8, z - 0.4, x + 0.5, y - 0.8, z - 0.4, 0)
    assert memory.resting_poses(simulation, beside, robot) is not memory.resting_poses(
        simulation, beside, robot
    )


def test_other_ground_has_a_memory_of_its_own(umad, robot):
    size = robot.track_length, robot.track_gauge
    assert ground_memory(umad.elements, *size) is ground_memory(tuple(umad.elements), *size)
    assert ground_memory(umad.elements, *size) is not ground_memory(umad.elements[1:], *size)
