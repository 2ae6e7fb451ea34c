"""The camera's arm has PyBullet's kinematics, and avoids contacts."""

import math
from itertools import product

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from argo_compiler.base.errors import Unreachable
from argo_env.navigation.views import face_normal
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import robot_folder
from argo_env.run.action import TURNS
from argo_env.sensing.vision.align import FacePose
from argo_env.sensing.vision.arm import JOINTS, forward_kinematics, inverse_kinematics
from argo_env.sensing.vision.views import plan_views_cheapest_first, solids_with_box_near
from argo_env.site.shapes import Box
from argo_env.world.pybullet_client import pybullet
from tests.argo_env.robot.test_models import load
from tests.conftest import examples

LENS = 0.07  # m ahead of the camera's link
LIMITS = {"arm_yaw": 3.1, "arm_shoulder": 1.75, "arm_elbow": 2.9, "arm_wrist": 2.9}

angles = st.tuples(*(st.floats(-LIMITS.get(name, 2.5), LIMITS.get(name, 2.5)) for name in JOINTS))
poses = st.builds(
    BodyPose,
    *[st.floats(-20, 20)] * 3,
    st.floats(-4, 4),
    st.floats(-0.6, 0.6),
    st.floats(-0.6, 0.6),
)


@pytest.fixture(scope="module")
def tracker(client, robot):
    return client, *load(client, robot_folder() / robot.urdf)


def by_pybullet(tracker, joints, pose):
    """Return position and axes of the lens according to PyBullet, for the robot at `pose`."""
    client, body, infos = tracker
    base = pybullet.getDynamicsInfo(body, -1, physicsClientId=client)
    base_pose = pybullet.multiplyTransforms(
        (pose.x, pose.y, pose.z),
        pybullet.getQuaternionFromEuler((pose.roll, pose.pitch, pose.yaw)),
        base[3],
        base[4],
    )
    pybullet.resetBasePositionAndOrientation(body, *base_pose, physicsClientId=client)
    for name, angle in zip(JOINTS, joints, strict=True):
        pybullet.resetJointState(body, infos[name][0], angle, physicsClientId=client)
    state = pybullet.getLinkState(
        body, infos["camera_pan"][0], computeForwardKinematics=True, physicsClientId=client
    )
    axes = np.array(pybullet.getMatrixFromQuaternion(state[5])).reshape(3, 3)
    return np.array(state[4]) + LENS * axes[:, 0], axes


@given(joints=angles, pose=poses)
@settings(max_examples=examples(60), deadline=None)
def test_forward_kinematics_equals_that_of_pybullet(tracker, joints, pose):
    camera = forward_kinematics(np.array(joints), pose)
    lens, axes = by_pybullet(tracker, joints, pose)
    assert camera.position == pytest.approx(lens, abs=1e-5)
    assert camera.rotation[:, 2] == pytest.approx(axes[:, 0], abs=1e-5)
    assert camera.rotation[:, 1] == pytest.approx(-axes[:, 2], abs=1e-5)


@given(joints=angles, pose=poses, reach=st.floats(0.3, 2.0))
@example(joints=(1.0, 0.0, 0.0, 0.0, 2.0), pose=BodyPose(0.0, 0.0, 0.0, 0.0), reach=1.0)
@settings(max_examples=examples(60), deadline=None)
def test_inverse_kinematics_brings_the_lens_there(tracker, joints, pose, reach):
    camera = forward_kinematics(np.array(joints), pose)
    target = camera.position + reach * camera.rotation[:, 2]
    solutions = list(inverse_kinematics(camera.position, target, pose))
    for solution in solutions:
        again = forward_kinematics(solution, pose)
        assert again.position == pytest.approx(camera.position, abs=1e-6)
        assert again.rotation[:, 2] == pytest.approx(camera.rotation[:, 2], abs=1e-6)
        for name, angle in zip(JOINTS, solution, strict=True):
            low, high = tracker[2][name][8:10]
            assert low <= angle <= high
    assert solutions, "the given joints are one solution at least"


@pytest.fixture
def place_before(simulated_world, navigator, umad):
    """Place the robot where it sees a checkpoint; return the checkpoint, the pose and the face."""

    def place(id):
        checkpoint = umad.checkpoint(id)
        view_pose = navigator.plan_to_view(umad.docks[1], id).end
        pose = BodyPose(view_pose.x, view_pose.y, view_pose.z, view_pose.yaw)
        simulated_world.place_robot(pose)
        return checkpoint, pose, FacePose(*checkpoint.position, checkpoint.yaw, 0.0)

    return place


@pytest.mark.parametrize("id", [1, 2, 4, 5, 10, 12, 16, 19])
def test_planned_views_touch_nothing_and_see_the_checkpoint(
    id, place_before, simulated_world, umad, robot
):
    checkpoint, pose, face = place_before(id)
    solids = solids_with_box_near(umad, face.center, 1.5)
    views = plan_views_cheapest_first(simulated_world, pose, face, solids, 0.05, (), 0.5)
    obliqueness = []
    for _, view in zip(range(6), views, strict=False):
        simulated_world.set_joints(dict(zip(JOINTS, view.joints.tolist(), strict=True)))
        assert simulated_world.touches() == ()
        sensor = robot.sensor
        assert sensor.min_range <= view.distance <= sensor.max_range
        sight = view.camera.position - face.center
        angle = math.acos(sight @ face_normal(checkpoint) / np.linalg.norm(sight))
        assert view.obliqueness == pytest.approx(angle, abs=1e-6)
        obliqueness.append(math.degrees(angle))
    simulated_world.set_arm_degrees(robot.arm_stowed)
    assert min(obliqueness) <= 40


def poses_between(robot, joints):
    """Yield joint positions between the raised arm and `joints`, by name, in rad."""
    raised = np.radians([robot.arm_raised[name] for name in JOINTS])
    for share in np.linspace(0.0, 1.0, 120):
        yield dict(zip(JOINTS, (raised + share * (joints - raised)).tolist(), strict=True))


@pytest.mark.parametrize("id", [1, 2, 4, 5, 10])
def test_the_arm_reaches_a_view_past_an_obstacle(id, place_before, simulated_world, robot):
    _, pose, face = place_before(id)

    def best_view():
        return next(plan_views_cheapest_first(simulated_world, pose, face, (), 0.05, (), 0.5))

    direct = best_view()
    path = list(poses_between(robot, direct.joints))
    # A small box on the path of the camera, away from both ends.
    camera = forward_kinematics(np.array([*path[60].values()]), pose)
    middle = camera.position - LENS * camera.rotation[:, 2]
    box = Box(tuple(middle.tolist()), (0.05, 0.05, 0.05))
    screen = simulated_world.add_screen("box", box, (0.4, 0.4, 0.4))
    try:
        assert simulated_world.arm_obstacle(path[0], 0.0) is None
        assert simulated_world.arm_obstacle(path[-1], 0.02) is None
        assert simulated_world.arm_obstacle(path[60], 0.0) == "box"
        around_box = best_view()
        assert not np.array_equal(around_box.joints, direct.joints)
        for positions in poses_between(robot, around_box.joints):
            assert simulated_world.arm_obstacle(positions, 0.0) is None
    finally:
        simulated_world.remove_screen(screen)
        simulated_world.set_arm_degrees(robot.arm_stowed)


def test_the_arm_check_moves_nothing_and_names_the_obstacle(simulated_world, robot):
    simulated_world.place_robot(BodyPose(3.25, 4.2, 0.0, 0.0))
    before = simulated_world.joint_positions(JOINTS)
    raised = {name: math.radians(angle) for name, angle in robot.arm_raised.items()}
    assert simulated_world.arm_obstacle(raised, 0.02) == "separator V-201"
    folded = dict.fromkeys(JOINTS, 0.0) | {"arm_shoulder": 1.7, "arm_elbow": 0.3}
    simulated_world.place_robot(BodyPose(8.0, 1.6, 0.0, 0.0))
    assert simulated_world.arm_obstacle(folded, 0.02) == "base_link"
    assert simulated_world.arm_obstacle(raised, 0.02) is None
    assert simulated_world.joint_positions(JOINTS) == before


def test_the_arm_is_raised_at_every_view_without_contact(simulated_world, navigator, robot):
    stowed, raised = (
        np.radians([pose[name] for name in JOINTS]) for pose in (robot.arm_stowed, robot.arm_raised)
    )
    dock = navigator.site.docks[1]
    for checkpoint, turned in product(navigator.site.checkpoints, TURNS):
        try:
            at = navigator.plan_to_view(dock, checkpoint.id, turned).end
        except Unreachable:
            continue
        simulated_world.place_robot(BodyPose(at.x, at.y, at.z, at.yaw))
        for share in np.linspace(0.0, 1.0, 25):
            joints = (stowed + share * (raised - stowed)).tolist()
            positions = dict(zip(JOINTS, joints, strict=True))
            assert simulated_world.arm_obstacle(positions, 0.0) is None, checkpoint.id
