"""Where boxes tell that nothing is near, PyBullet finds no touch: as if it were asked each time."""

import math

import numpy as np
import pytest

from argo_env.robot.pose import BodyPose
from argo_env.world.placement import Placement
from argo_env.world.world import World

WALKS, STEPS = 12, 120


@pytest.fixture(scope="module")
def worlds(umad, robot):
    """Two equal worlds: one as it is, one that always looks."""
    with World(umad, robot) as usual, World(umad, robot) as always:
        always._is_clear = lambda: False
        yield usual, always


def found(world):
    """What is touched, apart from the order."""
    return sorted((t.link, t.element, t.point, t.depth) for t in world.touches())


def do(worlds, name, *arguments):
    return [getattr(world, name)(*arguments) for world in worlds]


def walk(rng, floors):
    """Poses of a robot that drives about, now and then jumps, and is sometimes tilted a little."""
    floor = floors[int(rng.integers(len(floors)))]
    x, y, yaw = rng.uniform(0.0, 12.0), rng.uniform(0.0, 9.0), rng.uniform(-math.pi, math.pi)
    speed, turn = rng.uniform(-0.06, 0.06), rng.uniform(-0.08, 0.08)
    for _ in range(STEPS):
        if rng.random() < 0.05:
            speed, turn = rng.uniform(-0.06, 0.06), rng.uniform(-0.08, 0.08)
        if rng.random() < 0.02:
            x, y = x + rng.uniform(-2.0, 2.0), y + rng.uniform(-2.0, 2.0)
        x, y, yaw = x + speed * math.cos(yaw), y + speed * math.sin(yaw), yaw + turn
        tilt = 0.05 * (rng.random() < 0.1)
        height = 0.02 * (rng.random() < 0.1)
        yield BodyPose(x, y, floor.z + height, yaw, tilt * rng.uniform(-1.0, 1.0))


@pytest.mark.parametrize("seed", range(WALKS))
def test_touches_are_those_of_looking_each_time(worlds, umad, robot, seed, monkeypatch):
    rng, usual = np.random.default_rng(seed), worlds[0]
    looks = []
    detect = usual._detect
    monkeypatch.setattr(usual, "_detect", lambda: (looks.append(1), detect()))
    touched = 0
    for k, pose in enumerate(walk(rng, umad.spec.floors)):
        do(worlds, "place_robot", pose)
        if k % 20 == 0:
            joints = {
                name: angle * rng.uniform(-1.0, 1.0) for name, angle in robot.arm_stowed.items()
            }
            do(worlds, "move_arm", joints if rng.random() < 0.3 else robot.arm_stowed)
        if k % 7 == 0:
            angle = float(rng.choice([0.0, math.radians(30.0), math.radians(-20.0)]))
            flippers = dict.fromkeys(("left_flipper_joint", "right_flipper_joint"), angle)
            do(worlds, "set_joints", flippers)
        one, other = (found(world) for world in worlds)
        assert one == other, pose
        touched += bool(one)
    assert len(looks) < STEPS or touched > STEPS / 2
    do(worlds, "move_arm", robot.arm_stowed)


def test_most_looks_are_spared_in_the_open(worlds, umad, monkeypatch):
    usual, looks = worlds[0], []
    dock = umad.docks[1]
    usual.place_robot(BodyPose(dock.x, dock.y, dock.z, dock.yaw))
    usual.touches()
    monkeypatch.setattr(usual, "_detect", lambda: looks.append(1))
    for k in range(100):
        usual.place_robot(BodyPose(8.0 + 0.01 * k, 1.6, 12.5, 0.0))
        assert usual.touches() == ()
    assert len(looks) < 5


def test_a_checkpoint_that_is_put_in_the_way_is_found(worlds, umad):
    """At a robot that stands still where nothing was near."""
    do(worlds, "place_robot", BodyPose(8.0, 1.6, 12.5, 0.0))
    for _ in range(2):
        assert [found(world) for world in worlds] == [[], []]
    checkpoint = umad.checkpoints[0]
    x, y, z = checkpoint.position
    do(worlds, "displace", checkpoint.id, Placement((8.35 - x, 1.6 - y, 12.7 - z)))
    one, other = (found(world) for world in worlds)
    assert one == other != []
    do(worlds, "displace", checkpoint.id, Placement())
    assert [found(world) for world in worlds] == [[], []]
