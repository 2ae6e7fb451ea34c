"""Skipping PyBullet where bounding boxes show that nothing is near does not change the contacts."""

import math

import numpy as np
import pytest

from argo_env.drives.drive import DriveStatus
from argo_env.drives.kinematic import KinematicDrive
from argo_env.robot.pose import BodyPose
from argo_env.world.placement import Placement
from argo_env.world.world import World
from tests.conftest import examples

pytestmark = pytest.mark.physics

WALKS, STEPS = examples(12), 120


@pytest.fixture(scope="module")
def worlds(umad, robot):
    """Two equal worlds, of which the second one always asks PyBullet."""
    with World(umad, robot) as usual, World(umad, robot) as always:
        always._is_clear = lambda: False
        yield usual, always


def sorted_touches(world):
    """Return the contacts in a defined order."""
    return sorted((t.link, t.element, t.point, t.depth) for t in world.touches())


def call_both(worlds, name, *arguments):
    return [getattr(world, name)(*arguments) for world in worlds]


def walk(rng, floors):
    """Yield poses of a robot that drives about; sometimes it jumps or is slightly tilted."""
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


def flight(rng, floors):
    """Yield poses of a robot that moves through the air with any tilt, as if on stairs."""
    floor = floors[int(rng.integers(len(floors)))]
    position = np.array(
        [rng.uniform(0.0, 12.0), rng.uniform(0.0, 9.0), floor.z + rng.uniform(0, 2)]
    )
    yaw, pitch, roll = rng.uniform(-math.pi, math.pi), *rng.uniform(-0.7, 0.7, 2)
    for k in range(STEPS):
        if k % 20 == 0:
            speed, turns = rng.uniform(-0.06, 0.06, 3), rng.uniform(-0.05, 0.05, 3)
            turns *= rng.random(3) < 0.5
            roll *= rng.random() < 0.5
        if rng.random() < 0.02:
            position[:2] += rng.uniform(-2.0, 2.0, 2)
        position += speed
        yaw, pitch, roll = np.add((yaw, pitch, roll), turns).tolist()
        yield BodyPose(*position.tolist(), yaw, pitch, roll)


@pytest.mark.parametrize("make_poses", [walk, flight])
@pytest.mark.parametrize("seed", range(WALKS))
def test_touches_equal_those_of_asking_pybullet_each_time(
    worlds, umad, robot, seed, make_poses, monkeypatch
):
    rng, usual = np.random.default_rng(seed), worlds[0]
    detections = []
    detect = usual._detect
    monkeypatch.setattr(usual, "_detect", lambda: (detections.append(1), detect()))
    touched = 0
    for k, pose in enumerate(make_poses(rng, umad.spec.floors)):
        call_both(worlds, "place_robot", pose)
        if k % 20 == 0:
            joints = {
                name: angle * rng.uniform(-1.0, 1.0) for name, angle in robot.arm_stowed.items()
            }
            call_both(worlds, "set_arm_degrees", joints if rng.random() < 0.3 else robot.arm_stowed)
        if k % 7 == 0:
            angle = float(rng.choice([0.0, math.radians(30.0), math.radians(-20.0)]))
            flippers = dict.fromkeys(("left_flipper_joint", "right_flipper_joint"), angle)
            call_both(worlds, "set_joints", flippers)
        usual_touches, all_touches = (sorted_touches(world) for world in worlds)
        assert usual_touches == all_touches, pose
        touched += bool(usual_touches)
    assert len(detections) < STEPS or touched > STEPS / 2
    call_both(worlds, "set_arm_degrees", robot.arm_stowed)


def test_most_detections_are_skipped_in_the_open(worlds, umad, monkeypatch):
    usual, detections = worlds[0], []
    dock = umad.docks[1]
    usual.place_robot(BodyPose(dock.x, dock.y, dock.z, dock.yaw))
    usual.touches()
    monkeypatch.setattr(usual, "_detect", lambda: detections.append(1))
    for k in range(100):
        usual.place_robot(BodyPose(8.0 + 0.01 * k, 1.6, 12.5, 0.0))
        assert usual.touches() == ()
    assert len(detections) < 5


@pytest.mark.parametrize("ends", [(1, 2), (2, 1)])
def test_most_detections_are_skipped_on_stairs(
    worlds, robot, navigator, catalog, ends, monkeypatch
):
    start, end = (catalog.floor(number).patrol[0] for number in ends)
    path = navigator.plan(start, end)
    usual, always = worlds
    detections, detect = [], usual._detect
    monkeypatch.setattr(usual, "_detect", lambda: (detections.append(1), detect()))
    drive = KinematicDrive(usual, robot)
    drive.place_robot(BodyPose(start.x, start.y, start.z, start.yaw))
    drive.follow(path, None)
    steep = steep_detections = 0
    while drive.step() is DriveStatus.MOVING:
        before = len(detections)
        always.place_robot(drive.pose)
        always.set_joints(usual._posture)
        assert sorted_touches(usual) == sorted_touches(always) == []
        if abs(drive.pose.pitch) > 0.3:
            steep, steep_detections = steep + 1, steep_detections + len(detections) - before
    assert steep_detections < steep / 10 > 10


def test_a_checkpoint_that_is_moved_to_the_robot_is_touched(worlds, umad):
    """The robot stands still, and nothing was near it."""
    call_both(worlds, "place_robot", BodyPose(8.0, 1.6, 12.5, 0.0))
    for _ in range(2):
        assert [sorted_touches(world) for world in worlds] == [[], []]
    checkpoint = umad.checkpoints[0]
    x, y, z = checkpoint.position
    call_both(worlds, "set_displacement", checkpoint.id, Placement((8.35 - x, 1.6 - y, 12.7 - z)))
    usual_touches, all_touches = (sorted_touches(world) for world in worlds)
    assert usual_touches == all_touches != []
    call_both(worlds, "set_displacement", checkpoint.id, Placement())
    assert [sorted_touches(world) for world in worlds] == [[], []]
