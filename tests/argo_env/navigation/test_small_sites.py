"""Tests with sites so small that the fastest path can be calculated by hand."""

import math

import pytest

from argo_compiler.base.errors import ArgoError, Unreachable
from argo_compiler.base.model import Pose
from argo_env.navigation import Navigator
from argo_env.robot.spec import Calibration, load_robot
from tests.yard import site_of


@pytest.fixture(scope="module")
def robot():
    """A robot that drives exactly at its planned speeds, so that times can be calculated."""
    return load_robot().model_copy(update={"calibration": Calibration()})


def navigator(robot, floors, ground=(0, 0, 12, 12), towers=(), areas=None):
    site = site_of(
        ground=ground,
        towers=towers,
        floors=[{"number": n, **floor} for n, floor in enumerate(floors, 1)],
        areas=areas or [{"number": 1, "dock": [1.05, 1.05, 180]}],
    )
    return Navigator(site, robot)


def pose(x, y, degrees=0.0, z=0.02):
    return Pose(x=x, y=y, z=z, yaw=math.radians(degrees))


@pytest.fixture(scope="module")
def yard(robot):
    slab = {"z": 0.02, "railed": False, "walkways": {"slab": [2, 2, 11, 11]}}
    return navigator(robot, [slab])


@pytest.fixture(scope="module")
def walled_yard(robot):
    slab = {"z": 0.02, "railed": False, "walkways": {"slab": [0, 0, 12, 12]}}
    # A wall across the yard that leaves 2 m at its north end.
    return navigator(robot, [{**slab, "barriers": {"wall": [[6.0, 0.0], [6.0, 10.0]]}}])


@pytest.mark.parametrize(
    ("start", "goal", "seconds"),
    [
        (pose(3.05, 3.05), pose(8.05, 3.05), 5 / 0.4),
        (pose(3.05, 3.05), pose(8.05, 3.05, 90), 5 / 0.4 + 90 / 22.5),
        (pose(3.05, 3.05, 45), pose(6.05, 6.05, 45), math.sqrt(18) / 0.4),
        (pose(3.05, 3.05), pose(3.05, 3.05, 180), 180 / 22.5),
        (pose(5.05, 3.05), pose(4.05, 3.05), 1 / 0.25),  # backwards
        (pose(9.05, 3.05), pose(4.05, 3.05, 180), 180 / 22.5 + 5 / 0.4),
        (pose(3.05, 3.05), pose(3.05, 7.05, 90), 90 / 22.5 + 4 / 0.4),
        # Not along the lattice: turn by atan(1/4), drive, turn back.
        (
            pose(3.05, 3.05),
            pose(7.05, 4.05),
            2 * math.degrees(math.atan2(1, 4)) / 22.5 + math.sqrt(17) / 0.4,
        ),
        (
            pose(3.05, 3.05),
            pose(5.05, 8.05, 90),
            90 / 22.5 + math.sqrt(29) / 0.4,
        ),
    ],
)
def test_duration_on_an_open_yard(yard, robot, start, goal, seconds):
    assert yard.plan(start, goal).duration(robot) == pytest.approx(seconds, rel=0.02)


def test_backwards_is_gear_minus_one(yard):
    (motion,) = yard.plan(pose(5.05, 3.05), pose(4.05, 3.05)).motions
    assert motion.gear == -1


def test_duration_round_a_wall(walled_yard, robot):
    """The path leads straight to a point beside the wall's end, past it, and straight on."""
    path = walled_yard.plan(pose(5.05, 4.05, 90), pose(6.95, 4.05, -90))
    # The lower bound is the shortest line around the wall's end, and the half turn.
    clear = robot.footprint.half_width + 0.02
    around = math.hypot(0.95, 5.95 + clear)
    bound = 2 * around / 0.4 + 180 / 22.5
    assert bound <= path.duration(robot) + 1e-6
    assert path.duration(robot) <= 1.15 * bound


def two_storeys(robot):
    """Return the navigator of a slab, and a deck at the head of one straight flight along x."""
    flight = {
        "name": "flight",
        "foot": [4.0, 3.0, 0.0],
        "yaw": 0,
        "risers": 14,
        "rise": 2.5 / 14,
        "going": 0.28,
        "width": 0.9,
    }
    head = 4.0 + 13 * 0.28
    return navigator(
        robot,
        [
            {"z": 0.0, "railed": False, "walkways": {"slab": [0, 0, 14, 6]}},
            {"z": 2.5, "walkways": {"deck": [head, 1.0, head + 4.0, 5.0]}},
        ],
        ground=(0, 0, 14, 6),
        towers=[{"name": "tower", "flights": [flight]}],
    )


def test_duration_over_a_flight(robot):
    yard = two_storeys(robot)
    # The robot faces away from the flight and drives straight back and up, and back the same way.
    below, above = pose(2.05, 3.05, 180, z=0.0), pose(9.55, 3.05, 180, z=2.5)
    up, down = yard.plan(below, above), yard.plan(above, below)
    run, slope = 14 * 0.28, math.hypot(14 * 0.28, 2.5)
    flat = 7.5 - run
    # The robot is tilted over the flight's length and up to its own length more.
    length = robot.footprint.front + robot.footprint.rear
    for path, on_flat, on_stairs in (
        (up, robot.reverse_speed, robot.stair_up_speed),
        (down, robot.speed, robot.stair_down_speed),
    ):
        least = slope / on_stairs + flat / on_flat
        most = (slope + length) / on_stairs + (flat - length) / on_flat
        assert 0.9 * least <= path.duration(robot) <= 1.05 * most
        assert not any(m.turn for m in path.motions)
    assert up.total_ascent == pytest.approx(2.5)
    assert down.total_ascent == pytest.approx(0.0)
    assert {m.gear for m in up.motions} == {-1}
    assert {m.gear for m in down.motions} == {1}


def two_platforms(robot, width):
    """Return the navigator of two railed platforms with a walkway between them.

    Only the west platform's railing has a gate.
    """
    return navigator(
        robot,
        [
            {
                "z": 0.05,
                "walkways": {
                    "west": [4.0, 4.0, 7.0, 7.0],
                    "walkway": [7.0, 5.0, 10.0, 5.0 + width],
                    "east": [10.0, 4.0, 13.0, 7.0],
                },
                "gates": {"gate": [3.8, 4.0, 4.2, 7.0]},
            }
        ],
        ground=(0, 0, 15, 10),
    )


def test_walkway_of_seventy_centimetres_is_used(robot):
    yard = two_platforms(robot, 0.7)
    path = yard.plan(yard.site.docks[1], pose(11.5, 5.5, z=0.05))
    assert math.dist((path.end.x, path.end.y), (11.5, 5.5)) < 0.1


@pytest.mark.parametrize("width", [0.5, 0.6])
def test_walkway_narrower_than_the_robot_is_not_entered(robot, width):
    yard = two_platforms(robot, width)
    dock = yard.site.docks[1]
    assert yard.plan(dock, pose(5.5, 5.5, z=0.05)).motions
    for goal in (pose(11.5, 5.5, z=0.05), pose(8.5, 5.25, z=0.05)):
        with pytest.raises(Unreachable, match="no place that the robot can reach"):
            yard.plan(dock, goal)


def test_site_whose_dock_is_blocked(robot):
    slab = {"z": 0.0, "railed": False, "walkways": {"slab": [0, 0, 5, 5]}}
    with pytest.raises(ArgoError, match="docking station 1"):
        _ = navigator(
            robot,
            [{**slab, "vessels": [{"name": "V", "center": [1, 1, 1], "radius": 1, "length": 2}]}],
        ).lattice


def test_site_whose_docks_are_separated(robot):
    slab = {"z": 0.0, "railed": False, "walkways": {"slab": [0, 0, 12, 12]}}
    separated = {**slab, "barriers": {"wall": [[6.0, 0.0], [6.0, 12.0]]}}
    areas = [{"number": 1, "dock": [2.05, 2.05, 180]}, {"number": 2, "dock": [10.05, 2.05, 0]}]
    with pytest.raises(ArgoError, match="no path from one docking station to another"):
        _ = navigator(robot, [separated], areas=areas).lattice
