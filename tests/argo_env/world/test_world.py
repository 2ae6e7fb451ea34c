"""The simulated world reports contacts, obstacles and heights, and moves indicators."""

import math

import numpy as np
import pytest

import argo_env.world.world
from argo_compiler.base.errors import ArgoError
from argo_env.robot.pose import BodyPose
from argo_env.world.world import World

pytestmark = pytest.mark.physics


def touched(world, x, y, z, degrees=0.0, pitch=0.0):
    world.place_robot(BodyPose(x, y, z, math.radians(degrees), pitch))
    return {t.element for t in world.touches()}


@pytest.mark.parametrize("area", [1, 2])
def test_touches_nothing_in_a_docking_station(simulated_world, umad, area):
    dock = umad.docks[area]
    assert touched(simulated_world, dock.x, dock.y, dock.z, math.degrees(dock.yaw)) == set()


@pytest.mark.parametrize(
    ("x", "y", "z", "degrees"), [(1.9, 6.0, 2.5, 90), (8.0, 1.6, 12.5, 0), (8.0, 1.6, 0.0, 33)]
)
def test_standing_on_the_ground_is_no_contact(simulated_world, x, y, z, degrees):
    assert touched(simulated_world, x, y, z, degrees) == set()


@pytest.mark.parametrize(
    ("x", "y", "z", "element"),
    [
        (2.8, 3.65, 0.0, "floor 1 separator guard west"),
        (4.0, 0.1, 0.0, "floor 1 fence south-west"),
        (4.2, 6.4, 0.0, "contactor V-101"),
        (10.2, 6.8, 0.0, "regenerator V-102"),
        (8.0, 3.0, 0.0, "pump P-301"),
        (13.35, 7.3, 0.0, "riser 10"),
        (2.2, -2.55, -0.03, "docking station 1"),
        (6.0, 1.0, 0.9, "pressure gauge 1"),
    ],
)
def test_touch_names_the_element(simulated_world, x, y, z, element):
    assert element in touched(simulated_world, x, y, z)


def test_a_touch_has_its_point_and_depth(simulated_world):
    # The hull reaches 0.35 m ahead of the origin; the fence's rails are 4 cm thick.
    simulated_world.place_robot(BodyPose(4.0, 0.42, 0.0, math.radians(-90)))
    touches = [t for t in simulated_world.touches() if t.link == "base_link"]
    assert {t.element for t in touches} == {"floor 1 fence south-west"}
    # The shortest way out is 5 cm back, or 3 cm down from the knee rail.
    assert 0.025 <= max(t.depth for t in touches) <= 0.055
    for touch in touches:
        assert touch.point[1] == pytest.approx(0.1, abs=0.06)
        assert 3.7 <= touch.point[0] <= 4.3
    simulated_world.place_robot(BodyPose(4.0, 0.63, 0.0, math.radians(-90)))
    assert simulated_world.touches() == ()


def test_tracks_stand_where_the_body_must_not(simulated_world):
    """A robot that is sunk into the slab touches it with its base."""
    assert touched(simulated_world, 8.0, 1.6, -0.1) == set()
    assert touched(simulated_world, 8.0, 1.6, -0.15) == {"floor 1 slab"}


def test_raised_arm_touches_what_is_above(simulated_world, robot):
    # At the separator's end, at the height of its axis.
    simulated_world.set_arm_degrees(robot.arm_raised)
    try:
        simulated_world.place_robot(BodyPose(3.25, 4.2, 0.0, 0.0))
        links = {t.link for t in simulated_world.touches() if t.element == "separator V-201"}
        assert "sensor_head" in links
    finally:
        simulated_world.set_arm_degrees(robot.arm_stowed)


def test_a_robot_that_leans_to_its_left_touches_what_is_there(simulated_world, robot):
    simulated_world.set_arm_degrees(robot.arm_raised)
    try:
        for roll, leans in ((-0.3, {"separator V-201"}), (0.0, set()), (0.3, set())):
            simulated_world.place_robot(BodyPose(3.5, 3.2, 0.0, 0.0, roll=roll))
            touches = [t for t in simulated_world.touches() if t.link in {"forearm", "sensor_head"}]
            assert {t.element for t in touches} == leans
    finally:
        simulated_world.set_arm_degrees(robot.arm_stowed)


def test_obstacle_between_names_the_first_thing(simulated_world):
    clear = simulated_world.obstacle_between((4.0, 2.0, 1.5), (4.0, 1.0, 1.5))
    assert clear is None
    through = simulated_world.obstacle_between((2.0, 7.7, 1.0), (14.0, 7.7, 1.0))
    assert through == "contactor V-101"
    back = simulated_world.obstacle_between((14.0, 7.7, 1.0), (2.0, 7.7, 1.0))
    assert back in {"riser 10", "regenerator V-102"}
    assert simulated_world.obstacle_between((8.0, 1.6, 1.0), (8.0, 1.6, -1.0)) == "floor 1 slab"
    assert simulated_world.obstacle_between((6.0, 2.0, 1.2), (6.0, 0.7, 1.2)) == "pressure gauge 1"


def test_robot_is_no_obstacle(simulated_world):
    simulated_world.place_robot(BodyPose(8.0, 1.6, 0.0, 0.0))
    assert simulated_world.obstacle_between((8.0, 2.5, 0.4), (8.0, 0.7, 0.4)) is None


def test_heights(simulated_world):
    points = np.array([[8.0, 1.6], [8.0, -2.0], [1.9, 6.0], [0.85, 3.65], [4.0, 6.0]])
    below = np.array([1.0, 1.0, 3.0, 1.0, 12.0])
    # The slab, the gravel, floor 2, the first tread, and the void above all vessels' tops.
    heights = simulated_world.surface_or_ray_end_heights(points, below)
    assert heights == pytest.approx([0.0, -0.03, 2.5, 0.178571, 10.0], abs=1e-4)


def test_heights_of_more_points_than_a_batch_holds(simulated_world):
    points = np.tile([[8.0, 1.6], [8.0, -2.0]], (10_000, 1))
    heights = simulated_world.surface_or_ray_end_heights(points, np.ones(len(points)))
    assert heights[::2] == pytest.approx(np.zeros(10_000), abs=1e-4)
    assert heights[1::2] == pytest.approx(np.full(10_000, -0.03), abs=1e-4)


def test_heights_look_through_the_robot(simulated_world):
    simulated_world.place_robot(BodyPose(8.0, 1.6, 0.0, 0.0))
    assert simulated_world.surface_or_ray_end_heights(
        np.array([[8.0, 1.6]]), np.array([1.5])
    ) == pytest.approx(0.0)


@pytest.fixture
def clients(monkeypatch):
    """Return the list of connections that worlds open during the test."""
    opened, connect = [], argo_env.world.world.pybullet.connect

    def spy(*arguments):
        opened.append(connect(*arguments))
        return opened[-1]

    monkeypatch.setattr(argo_env.world.world.pybullet, "connect", spy)
    return opened


def indicators(client, site):
    """Return the position of each checkpoint's indicator, by the checkpoint's id."""
    bullet = argo_env.world.world.pybullet
    positions = {}
    for n in range(bullet.getNumBodies(physicsClientId=client)):
        body = bullet.getBodyUniqueId(n, physicsClientId=client)
        if bullet.getNumJoints(body, physicsClientId=client) != 1:
            continue
        joint = bullet.getJointInfo(body, 0, physicsClientId=client)
        if joint[1] != b"indicator":
            continue
        place = bullet.getBasePositionAndOrientation(body, physicsClientId=client)[0]
        nearest = min(site.checkpoints, key=lambda c: math.dist(c.position, place))
        # The centre of mass lies a little behind the face.
        assert math.dist(nearest.position, place) <= 0.05
        positions[nearest.id] = bullet.getJointState(body, 0, physicsClientId=client)[0]
    return positions


def test_two_worlds_are_independent(clients, umad, robot):
    with World(umad, robot) as a, World(umad, robot) as b:
        a.place_robot(BodyPose(2.8, 3.65, 0.0, 0.0))
        b.place_robot(BodyPose(8.0, 1.6, 0.0, 0.0))
        assert a.touches()
        assert not b.touches()
        for checkpoint in umad.checkpoints:
            a.show_value(checkpoint.id, checkpoint.range.high)
            b.show_value(checkpoint.id, checkpoint.range.low)
        high, low = (indicators(client, umad) for client in clients)
        kinds = {c.id: c.kind.value for c in umad.checkpoints}
        ends = {
            "pressure gauge": (math.radians(-135), math.radians(135)),
            "liquid level gauge": (-0.12, 0.12),
            "valve": (0.0, math.radians(90)),
        }
        assert low == pytest.approx({id: ends[kind][0] for id, kind in kinds.items()})
        assert high == pytest.approx({id: ends[kind][1] for id, kind in kinds.items()})
        a.show_value(1, 2.5)
        assert indicators(clients[0], umad)[1] == pytest.approx(math.radians(-67.5))
        assert indicators(clients[1], umad) == low


def test_window_without_a_display(monkeypatch, umad, robot, clients):
    monkeypatch.delenv("DISPLAY", raising=False)
    with pytest.raises(ArgoError, match="DISPLAY is not set"):
        World(umad, robot, gui=True)
    assert clients == []
