"""The camera sensor reads checkpoints from pictures, and gives a reason when it can't."""

import math

import numpy as np
import pytest

from argo_compiler.base.catalog import CheckpointKind
from argo_compiler.base.errors import NotFound
from argo_env.robot.pose import BodyPose
from argo_env.sensing.sensor import MeasurementError
from argo_env.sensing.vision.faces import draw_face, face_file
from argo_env.sensing.vision.sensor import CameraSensor
from argo_env.site.shapes import Box
from argo_env.world.placement import AS_PLANNED, Placement, draw_checkpoint_placement
from tests.processes import run_python

pytest.importorskip("cv2")
from PIL import Image

DIAL, LEVEL, VALVE = 1, 2, 4
ALLOWED = {DIAL: 0.2, LEVEL: 2.0, VALVE: 5.0}  # bar, %, deg


@pytest.fixture
def set_checkpoint(simulated_world, navigator, umad, robot):
    """Place the robot before a checkpoint that shows a value; restore everything at the end."""
    screens = []

    def set_up(id, value, placement=AS_PLANNED, light=1.0):
        view_pose = navigator.plan_to_view(umad.docks[1], id).end
        pose = BodyPose(view_pose.x, view_pose.y, view_pose.z, view_pose.yaw)
        simulated_world.place_robot(pose)
        simulated_world.set_arm_degrees(robot.arm_raised)
        simulated_world.show_value(id, value)
        simulated_world.set_displacement(id, placement)
        simulated_world.light = light
        return pose

    set_up.world, set_up.screens = simulated_world, screens
    yield set_up
    simulated_world.light = 1.0
    simulated_world.set_arm_degrees(robot.arm_stowed)
    for id in ALLOWED:
        simulated_world.set_displacement(id, AS_PLANNED)
    for screen in screens:
        simulated_world.remove_screen(screen)


@pytest.mark.parametrize(
    "id",
    [
        DIAL,
        pytest.param(LEVEL, marks=pytest.mark.long),
        pytest.param(VALVE, marks=pytest.mark.long),
    ],
)
def test_reads_any_value_where_planned(set_checkpoint, umad, id):
    scale = umad.checkpoint(id).range
    rng = np.random.default_rng(id)
    for share in (0.0, 1.0, *rng.uniform(size=2)):
        value = scale.low + float(share) * (scale.high - scale.low)
        pose = set_checkpoint(id, value)
        measurement = CameraSensor(set_checkpoint.world, seed=3).measure(id, pose)
        assert measurement.value == pytest.approx(value, abs=ALLOWED[id] / 2)
        assert scale.low <= measurement.value <= scale.high
        assert 0.9 <= measurement.confidence <= 1.0
        assert 0.3 <= measurement.distance <= 2.0


@pytest.mark.parametrize(
    ("id", "value", "placement", "light"),
    [
        (DIAL, 7.3, Placement((0.05, 0.03, -0.06), math.radians(40), math.radians(-70)), 1.0),
        (DIAL, 1.2, Placement((-0.07, 0.0, 0.05), math.radians(-35), math.radians(85)), 0.35),
        pytest.param(
            LEVEL,
            81.0,
            Placement((0.04, -0.05, 0.06), math.radians(-45)),
            0.4,
            marks=pytest.mark.long,
        ),
        (VALVE, 62.0, Placement((0.0, 0.06, 0.04), math.radians(30), math.radians(-80)), 0.5),
    ],
)
def test_reads_a_displaced_turned_and_dim_checkpoint(set_checkpoint, id, value, placement, light):
    pose = set_checkpoint(id, value, placement, light)
    measurement = CameraSensor(set_checkpoint.world, seed=5).measure(id, pose)
    assert measurement.value == pytest.approx(value, abs=ALLOWED[id])


def test_looks_past_an_obstacle(set_checkpoint, umad):
    pose = set_checkpoint(DIAL, 4.4)
    x, y, z = umad.checkpoint(DIAL).position
    screen = Box((x, y + 0.25, z), (0.05, 0.01, 0.4))
    set_checkpoint.screens.append(set_checkpoint.world.add_screen("board", screen, (0.4, 0.4, 0.4)))
    measurement = CameraSensor(set_checkpoint.world, seed=1).measure(DIAL, pose)
    assert measurement.value == pytest.approx(4.4, abs=0.2)


@pytest.mark.parametrize("id", [DIAL, LEVEL, VALVE])
def test_too_dark(set_checkpoint, id):
    pose = set_checkpoint(id, 30.0 if id != DIAL else 3.0, light=0.02)
    with pytest.raises(MeasurementError, match="too dark"):
        CameraSensor(set_checkpoint.world).measure(id, pose)


@pytest.mark.long
def test_an_absent_checkpoint_is_not_found(set_checkpoint):
    pose = set_checkpoint(DIAL, 3.0, Placement((0.0, 0.0, -30.0)))
    with pytest.raises(MeasurementError, match="pressure gauge 1: not found"):
        CameraSensor(set_checkpoint.world).measure(DIAL, pose)


@pytest.mark.long
def test_a_hidden_checkpoint_is_not_read(set_checkpoint, umad):
    pose = set_checkpoint(VALVE, 45.0)
    x, y, z = umad.checkpoint(VALVE).position
    board = Box((x + 0.15, y, z), (0.01, 1.2, 1.2))
    set_checkpoint.screens.append(set_checkpoint.world.add_screen("board", board, (0.4, 0.4, 0.4)))
    with pytest.raises(MeasurementError, match=r"valve R25: (not found|hidden|the camera)"):
        CameraSensor(set_checkpoint.world).measure(VALVE, pose)


def test_from_too_far_away(set_checkpoint):
    pose = set_checkpoint(DIAL, 3.0)
    away = BodyPose(pose.x, pose.y + 6.0, pose.z, pose.yaw)
    with pytest.raises(MeasurementError, match="can't get it in view"):
        CameraSensor(set_checkpoint.world).measure(DIAL, away)


def test_unknown_checkpoint(set_checkpoint):
    with pytest.raises(NotFound):
        CameraSensor(set_checkpoint.world).measure(99, set_checkpoint(DIAL, 3.0))


def test_equal_seeds_give_equal_readings_and_pictures_are_reported(set_checkpoint):
    pose = set_checkpoint(DIAL, 6.1, light=0.6)
    world, shots = set_checkpoint.world, []
    before = world.joint_positions(("arm_yaw", "arm_elbow", "camera_pan"))
    world.on_shot = shots.append
    try:
        first = CameraSensor(world, seed=8).measure(DIAL, pose)
        count = len(shots)
        again = CameraSensor(world, seed=8).measure(DIAL, pose)
        other = CameraSensor(world, seed=9).measure(DIAL, pose)
    finally:
        world.on_shot = None
    assert first == again
    assert first.value != other.value
    assert world.joint_positions(("arm_yaw", "arm_elbow", "camera_pan")) == before
    assert count >= 2
    for first_shot, second_shot in zip(shots[:count], shots[count:], strict=False):
        assert np.array_equal(first_shot.pixels, second_shot.pixels)
        assert first_shot.pixels.dtype == np.uint8
        assert first_shot.rotation.T @ first_shot.rotation == pytest.approx(np.eye(3), abs=1e-9)


@pytest.mark.parametrize("kind", CheckpointKind)
def test_shipped_faces_are_the_drawn_ones(kind):
    with Image.open(face_file(kind)) as image:
        shipped = np.asarray(image.convert("L"), dtype=float)
    drawn = np.asarray(draw_face(kind).convert("L"), dtype=float)
    assert shipped.shape == drawn.shape
    # Fonts differ a little from version to version.
    assert np.abs(shipped - drawn).mean() <= 3.0


def test_placements_fill_what_the_rules_allow():
    rng = np.random.default_rng(0)
    drawn = [draw_checkpoint_placement(rng) for _ in range(500)]
    distances = [math.hypot(*p.offset) for p in drawn]
    assert 0.095 < max(distances) <= 0.1
    # Half of a sphere's volume lies beyond 0.79 of its radius.
    assert 0.4 < np.mean(np.array(distances) > 0.0794) < 0.6
    for angle in ("turn", "roll"):
        values = [getattr(p, angle) for p in drawn]
        assert -math.pi / 2 <= min(values) < -1.5
        assert 1.5 < max(values) <= math.pi / 2
    assert draw_checkpoint_placement(rng, keep_upright=True).roll == 0.0


def test_importing_argo_env_needs_no_opencv():
    code = "import sys, argo_env.run.session; print('cv2' in sys.modules)"
    assert run_python("-c", code).stdout.strip() == "False"
