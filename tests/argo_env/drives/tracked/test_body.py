"""The body on its tracks: rest, speed, turns, flights, and repetition bit by bit."""

import math

import pytest

from argo_env.drives.tracked.belts import Traction
from argo_env.drives.tracked.body import TrackedBody
from argo_env.navigation.path import wrap
from argo_env.robot.pose import BodyPose
from tests.processes import run_python

pytestmark = pytest.mark.physics

GRAVEL = BodyPose(5.0, -2.05, -0.03, 0.0)
RISE, GOING = 0.178571, 0.28
SLOPE = math.atan2(RISE, GOING)
WEST = BodyPose(0.85, 5.3, (1.8 / GOING + 1) * RISE, math.radians(-90), SLOPE)


def seconds(body, t):
    body.advance(round(240 * t))


def test_mass_is_that_of_the_model(body):
    assert body.mass == pytest.approx(63.0)


def test_rests_level_where_it_is_put(body):
    body.reset(GRAVEL)
    seconds(body, 2.0)
    pose = body.pose
    assert (pose.x, pose.y, pose.z) == pytest.approx((5.0, -2.05, -0.03), abs=0.002)
    assert (pose.yaw, pose.pitch, body.roll) == pytest.approx((0.0, 0.0, 0.0), abs=0.002)
    assert body.velocity == pytest.approx((0.0, 0.0), abs=1e-3)
    assert body.pop_deepest_touches() == ()


@pytest.mark.parametrize(("heading", "up"), [(0.0, 1), (math.pi, -1)])
def test_leans_to_the_side_that_is_lower(body, robot, heading, up):
    """The edge of the slab carries a track, 3 cm above the gravel, which carries the other."""
    body.reset(BodyPose(8.0, 0.1, 0.0, heading))
    seconds(body, 1.0)
    lean = math.asin(0.03 / robot.track_gauge)
    assert body.pose.roll == pytest.approx(up * lean, rel=0.3)
    assert body.pose.pitch == pytest.approx(0.0, abs=0.002)


@pytest.mark.parametrize("speed", [0.4, 0.15, -0.25])
def test_drives_straight_at_the_speed_commanded(body, speed):
    body.reset(GRAVEL)
    body.command(speed, 0.0, 0.0)
    seconds(body, 1.0)
    before = body.pose
    seconds(body, 2.0)
    assert body.pose.x - before.x == pytest.approx(2.0 * speed, rel=0.03)
    assert body.pose.y == pytest.approx(before.y, abs=0.005)
    assert body.velocity[0] == pytest.approx(speed, rel=0.03)


@pytest.mark.parametrize("degrees", [22.5, -10.0])
def test_turns_in_place_at_the_rate_commanded(body, degrees):
    body.reset(GRAVEL)
    body.command(0.0, math.radians(degrees), 0.0)
    seconds(body, 1.5)
    before = body.pose
    seconds(body, 2.0)
    assert math.degrees(wrap(body.pose.yaw - before.yaw)) == pytest.approx(2 * degrees, rel=0.05)
    assert math.dist((body.pose.x, body.pose.y), (GRAVEL.x, GRAVEL.y)) <= 0.1


def test_belts_slip_in_a_turn(body):
    """Belts run faster than wheels without slip, since tracks slide sideways in a turn."""
    body.reset(GRAVEL)
    body.command(0.0, math.radians(22.5), 0.0)
    seconds(body, 3.0)
    left, right = body.belt_speeds
    assert right == pytest.approx(-left)
    assert 1.1 <= right / (0.23 * math.radians(22.5)) <= 2.0


def test_stops_within_the_braking_way(body):
    body.reset(GRAVEL)
    body.command(0.4, 0.0, 0.0)
    seconds(body, 1.0)
    x = body.pose.x
    body.command(0.0, 0.0, 0.0)
    seconds(body, 1.0)
    assert 0.05 <= body.pose.x - x <= 0.15
    assert body.velocity[0] == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("degrees", [-30.0, 20.0, 50.0])
def test_flippers_go_where_they_are_commanded(body, degrees):
    body.reset(GRAVEL)
    body.command(0.0, 0.0, math.radians(degrees))
    seconds(body, 1.5)
    assert math.degrees(body.flipper) == pytest.approx(degrees, abs=1.5)
    # Lowered, they lift the rear; raised, they change nothing.
    pitch = math.degrees(body.pose.pitch)
    assert pitch > 10.0 if degrees < 0 else abs(pitch) < 0.5


def test_stands_on_a_flight_without_sliding(body):
    body.reset(WEST)
    seconds(body, 1.0)
    before = body.pose
    seconds(body, 10.0)
    pose = body.pose
    places = [(p.x, p.y, p.z) for p in (before, pose)]
    assert math.dist(*places) <= 0.003
    assert pose.pitch == pytest.approx(SLOPE, abs=math.radians(1.5))


def test_slides_down_a_flight_without_grip(ground, robot):
    with TrackedBody(ground, robot, Traction(grip=0.3)) as body:
        body.reset(WEST)
        seconds(body, 2.0)
        assert body.pose.y < WEST.y - 0.3


def test_masses_are_scaled(ground, robot):
    with TrackedBody(ground, robot, mass_scale=1.05) as body:
        assert body.mass == pytest.approx(1.05 * 63.0)


def test_pressing_on_a_wall_is_a_touch(body):
    body.reset(BodyPose(2.5, 7.7, 0.0, 0.0))
    body.command(0.2, 0.0, 0.0)
    seconds(body, 1.5)
    assert {t.element for t in body.pop_deepest_touches()} == {"contactor V-101"}
    body.command(-0.2, 0.0, 0.0)
    seconds(body, 1.0)
    body.pop_deepest_touches()
    seconds(body, 0.5)
    assert body.pop_deepest_touches() == ()


def dance(body):
    """Return the exact poses of a motion with turns, flippers and a flight."""
    rows = []
    for speed, rate, flipper in ((0.3, 0.2, 0.4), (-0.2, -0.3, -0.3), (0.0, 0.4, 0.0)):
        body.command(speed, rate, flipper)
        body.advance(60)
        rows.append((body.pose, body.roll, body.velocity, body.flipper, body.belt_speeds))
    return rows


@pytest.mark.parametrize("pose", [GRAVEL, WEST])
def test_reset_is_the_same_bit_by_bit(body, pose):
    body.reset(pose)
    first = dance(body)
    body.advance(100)
    body.reset(WEST if pose is GRAVEL else GRAVEL)
    body.advance(50)
    body.reset(pose)
    assert dance(body) == first


@pytest.mark.parametrize("pose", [GRAVEL, WEST])
def test_restored_snapshot_goes_on_the_same_bit_by_bit(body, pose):
    body.reset(pose)
    body.command(-0.15, 0.1, 0.2)
    body.advance(77)
    moment = body.snapshot()
    first = dance(body)
    body.reset(GRAVEL)
    body.advance(33)
    body.restore(moment)
    assert dance(body) == first
    body.release(moment)


def test_a_body_of_its_own_process_does_the_same(ground, robot):
    with TrackedBody(ground, robot) as body:
        body.reset(WEST)
        here = repr(dance(body))
    code = """
from argo_env.robot.spec import load_robot
from argo_env.drives.tracked.body import TrackedBody
from argo_env.site import load_site
from argo_env.world.world import World
from tests.argo_env.drives.tracked.test_body import WEST, dance
robot = load_robot()
body = TrackedBody(World(load_site("umad"), robot), robot)
body.reset(WEST)
print(repr(dance(body)))
"""
    assert run_python("-c", code).stdout.strip() == here
