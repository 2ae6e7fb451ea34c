"""The robot's frames, compared with where PyBullet puts its links."""

import pybullet
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_env.recording.messages import attitude
from argo_env.robot.pose import BodyPose
from argo_env.robot.robot_model import add, from_rpy, multiply, read_model, rotate
from argo_env.robot.spec import load_robot, robot_folder
from tests.conftest import examples

FILE = robot_folder() / load_robot().urdf
angles = st.floats(-3.0, 3.0)


@pytest.fixture(scope="module")
def body(client):
    return client, pybullet.loadURDF(str(FILE), physicsClientId=client)


@settings(deadline=None, max_examples=examples(30))
@given(st.data())
def test_links_are_where_pybullet_has_them(body, data) -> None:
    client, robot = body
    model = read_model(FILE)
    root = pybullet.getBasePositionAndOrientation(robot, physicsClientId=client)
    inertial = pybullet.getDynamicsInfo(robot, -1, physicsClientId=client)[3:5]
    # PyBullet's base pose is that of the centre of mass.
    back = pybullet.invertTransform(*inertial)
    places = {"base_link": pybullet.multiplyTransforms(*root, *back)}
    numbers = {
        pybullet.getJointInfo(robot, k, physicsClientId=client)[1].decode(): k
        for k in range(pybullet.getNumJoints(robot, physicsClientId=client))
    }
    assert numbers.keys() == {joint.name for joint in model.joints}
    waiting = list(model.joints)
    while waiting:
        # URDF may name a link before the one that carries it.
        joint = next(joint for joint in waiting if joint.parent in places)
        waiting.remove(joint)
        value = data.draw(angles) if joint.moves else 0.0
        pybullet.resetJointState(robot, numbers[joint.name], value, physicsClientId=client)
        position, rotation = joint.at(value)
        where, how = places[joint.parent]
        places[joint.child] = add(where, rotate(how, position)), multiply(how, rotation)
    for joint in model.joints:
        state = pybullet.getLinkState(
            robot, numbers[joint.name], computeForwardKinematics=True, physicsClientId=client
        )
        position, rotation = places[joint.child]
        assert position == pytest.approx(state[4], abs=1e-5)
        assert abs(sum(a * b for a, b in zip(rotation, state[5], strict=True))) == pytest.approx(
            1.0, abs=1e-6
        )


@settings(deadline=None, max_examples=examples(50))
@given(st.tuples(angles, angles, angles))
def test_rpy_means_what_it_means_to_pybullet(rpy) -> None:
    mine, theirs = from_rpy(rpy), pybullet.getQuaternionFromEuler(rpy)
    assert abs(sum(a * b for a, b in zip(mine, theirs, strict=True))) == pytest.approx(1.0)


@settings(deadline=None, max_examples=examples(20))
@given(st.tuples(angles, angles, angles))
def test_a_body_is_recorded_with_its_roll(rpy) -> None:
    roll, pitch, yaw = rpy
    mine = attitude(BodyPose(1.0, 2.0, 3.0, yaw, pitch, roll))
    theirs = pybullet.getQuaternionFromEuler(rpy)
    assert abs(sum(a * b for a, b in zip(mine, theirs, strict=True))) == pytest.approx(1.0)


def test_looks_are_read(body) -> None:
    client, robot = body
    looks = read_model(FILE).looks
    boxes = [look for parts in looks.values() for look in parts]
    drawn = pybullet.getVisualShapeData(robot, physicsClientId=client)
    assert len(boxes) == len(drawn)
    assert sorted(round(look.colour[0], 3) for look in boxes) == sorted(
        round(shape[7][0], 3) for shape in drawn
    )
