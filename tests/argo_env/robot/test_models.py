"""URDF models of the robot and of the checkpoints, as two parsers read them."""

import itertools
import math
import shutil

import numpy as np
import pytest
import yourdfpy
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from argo_compiler.base.catalog import CheckpointKind
from argo_compiler.base.errors import ArgoError, Invalid, NotFound
from argo_compiler.il import Mission, Task
from argo_env.files import cache, resources
from argo_env.planning.opening import open_site
from argo_env.recording.messages import attitude
from argo_env.robot.pose import BodyPose
from argo_env.robot.robot_model import add_vectors, from_rpy, multiply, read_model, rotate
from argo_env.robot.spec import RobotSpec, load_robot, revalidated_robot, robot_folder
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec
from argo_env.world.pybullet_client import pybullet
from tests.conftest import examples

CHECKPOINTS = sorted(p.stem for p in (resources.urdf_folder() / "checkpoints").glob("*.urdf"))
FLIPPERS = ("left_flipper_joint", "right_flipper_joint")


@pytest.fixture
def urdf(robot):
    return yourdfpy.URDF.load(str(robot_folder() / robot.urdf), load_meshes=False)


def surface_points(part):
    """Return points, shape (n, 3), whose hull is the box, cylinder or mesh, in the link's frame."""
    geometry = part.geometry
    if geometry.mesh is not None:
        text = (resources.urdf_folder() / "checkpoints" / geometry.mesh.filename).read_text()
        lines = (line.split() for line in text.splitlines())
        points = np.array([line[1:] for line in lines if line and line[0] == "v"], dtype=float)
    elif geometry.box is not None:
        points = np.array(list(itertools.product((-0.5, 0.5), repeat=3))) * geometry.box.size
    else:
        angle = np.linspace(0.0, 2 * math.pi, 721)
        circle = geometry.cylinder.radius * np.array([np.cos(angle), np.sin(angle)]).T
        half = geometry.cylinder.length / 2
        points = np.vstack([np.column_stack([circle, np.full(721, z)]) for z in (-half, half)])
    origin = np.eye(4) if part.origin is None else part.origin
    return points @ origin[:3, :3].T + origin[:3, 3]


def box_around(urdf, links=None, joints=None, parts="collisions"):
    """Return the low and high corners of the box around `links`, in the base's frame.

    The positions of the `joints` are in degrees.
    """
    positions = dict.fromkeys(urdf.actuated_joint_names, 0.0) | (joints or {})
    urdf.update_cfg({name: math.radians(angle) for name, angle in positions.items()})
    points = []
    for link in links or urdf.link_map:
        pose = urdf.get_transform(link, urdf.base_link)
        for part in getattr(urdf.link_map[link], parts):
            points.append(surface_points(part) @ pose[:3, :3].T + pose[:3, 3])
    points = np.vstack(points)
    return points.min(axis=0), points.max(axis=0)


def load(client, path):
    body = pybullet.loadURDF(str(path), useFixedBase=True, physicsClientId=client)
    joints = [
        pybullet.getJointInfo(body, k, physicsClientId=client)
        for k in range(pybullet.getNumJoints(body, physicsClientId=client))
    ]
    return body, {info[1].decode(): info for info in joints}


def test_both_parsers_find_the_same_joints(client, robot, urdf):
    _, joints = load(client, robot_folder() / robot.urdf)
    assert set(joints) == set(urdf.joint_map)
    for name in urdf.actuated_joint_names:
        limit = urdf.joint_map[name].limit
        assert joints[name][8:10] == pytest.approx((limit.lower, limit.upper))
    assert set(robot.arm_stowed) == set(robot.arm_raised)
    assert set(urdf.actuated_joint_names) == set(robot.arm_stowed) | set(FLIPPERS)


@pytest.mark.parametrize(("link", "y"), [("left_track", 0.23), ("right_track", -0.23)])
def test_tracks(urdf, link, y):
    low, high = box_around(urdf, [link])
    assert high - low == pytest.approx([1.0, 0.13, 0.35], abs=1e-3)
    assert (high + low)[:2] / 2 == pytest.approx([0.0, y], abs=1e-3)
    assert low[2] == pytest.approx(0.0, abs=1e-6)


def test_tracks_measure_059_m_over_all(urdf, robot):
    low, high = box_around(urdf, ["left_track", "right_track"])
    assert (high - low)[1] == pytest.approx(0.59, abs=1e-3)
    assert robot.track_gauge == pytest.approx(0.46)
    assert robot.track_length <= (high - low)[0]


def test_flippers(urdf):
    low, high = box_around(urdf, ["left_flipper"])
    assert (high - low)[0] == pytest.approx(1.05, abs=1e-3)
    tracks, _ = box_around(urdf, ["left_track"])
    assert tracks[0] - low[0] == pytest.approx(0.05, abs=1e-3)
    for name in FLIPPERS:
        limit = urdf.joint_map[name].limit
        assert np.degrees([limit.lower, limit.upper]) == pytest.approx([-30, 50], abs=0.01)
        assert math.degrees(limit.velocity) == pytest.approx(110, abs=1)


@pytest.mark.parametrize(("link", "next_joint", "length"), [
    ("upper_arm", "arm_elbow", 0.55),
    ("forearm", "arm_wrist", 0.43),
])  # fmt: skip
def test_arm_links(urdf, link, next_joint, length):
    low, high = box_around(urdf, [link])
    assert (high - low)[2] == pytest.approx(length, abs=1e-3)
    assert np.linalg.norm(urdf.joint_map[next_joint].origin[:3, 3]) == pytest.approx(length)


@pytest.mark.parametrize("pose", ["arm_stowed", "arm_raised"])
def test_arm_poses_are_within_the_limits(urdf, robot, pose):
    for name, angle in getattr(robot, pose).items():
        limit = urdf.joint_map[name].limit
        assert limit.lower <= math.radians(angle) <= limit.upper


@pytest.mark.parametrize("flippers", [0, 30])
@pytest.mark.parametrize("parts", ["collisions", "visuals"])
def test_footprint_and_height_cover_the_driving_robot(urdf, robot, flippers, parts):
    joints = robot.arm_stowed | dict.fromkeys(FLIPPERS, flippers)
    low, high = box_around(urdf, joints=joints, parts=parts)
    footprint = robot.footprint
    assert high[0] <= footprint.front + 0.01
    assert -low[0] <= footprint.rear + 0.01
    assert max(high[1], -low[1]) <= footprint.half_width + 0.01
    assert high[2] <= robot.driving_height
    # Flippers that are raised do not reach into the ground.
    assert low[2] >= -1e-6


def test_footprint_is_no_larger_than_the_robot(urdf, robot):
    low, high = box_around(urdf, joints=robot.arm_stowed)
    assert high[0] == pytest.approx(robot.footprint.front, abs=0.01)
    assert -low[0] == pytest.approx(robot.footprint.rear, abs=0.01)
    assert high[1] == pytest.approx(robot.footprint.half_width, abs=0.01)


def test_raised_arm_puts_the_camera_where_it_is_planned(urdf, robot):
    urdf.update_cfg({name: math.radians(angle) for name, angle in robot.arm_raised.items()})
    pose = urdf.get_transform("sensor_head", urdf.base_link)
    assert math.dist(pose[:3, 3], robot.sensor.offset) <= 0.03
    # The camera looks ahead.
    assert pose[:3, 0] == pytest.approx([1, 0, 0], abs=0.02)


def test_camera_of_the_robot_in_pybullet(client, robot):
    body, joints = load(client, robot_folder() / robot.urdf)
    for name, angle in robot.arm_raised.items():
        pybullet.resetJointState(body, joints[name][0], math.radians(angle), physicsClientId=client)
    head = pybullet.getLinkState(
        body, joints["arm_wrist"][0], computeForwardKinematics=True, physicsClientId=client
    )[4]
    assert math.dist(head, robot.sensor.offset) <= 0.03


def test_the_error_of_an_unknown_robot_lists_the_known_ones():
    with pytest.raises(ArgoError, match="no robot `rover`; there are: tracker"):
        load_robot("rover")


@pytest.mark.parametrize("name", ["../../x", "../robot/tracker", "/x", "", ".", "tracker.yaml"])
def test_the_name_of_a_robot_stays_in_its_folder(name, tmp_path, monkeypatch):
    shutil.copytree(robot_folder(), tmp_path / "a" / "robot")
    shutil.copy(robot_folder() / "tracker.yaml", tmp_path / "x.yaml")
    monkeypatch.setattr("argo_env.robot.spec.robot_folder", lambda: tmp_path / "a" / "robot")
    with pytest.raises(NotFound, match="there are: tracker"):
        load_robot(name)


@pytest.mark.parametrize("model", ["../tracker.urdf", "/tracker.urdf", "a/b.urdf", "..", ""])
def test_the_model_of_a_robot_is_a_file_beside_its_description(model, robot):
    with pytest.raises(Invalid, match="is not the name of a file beside the description"):
        revalidated_robot(robot.model_copy(update={"urdf": model}))


@pytest.mark.parametrize("name", ["name: tracker", "name: !!binary VMOkbmtjaGVu"])
def test_a_description_from_the_cache_is_as_the_file_says(name, tmp_path, monkeypatch):
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path / "cache"))
    robots = []
    for folder in (tmp_path / "first", tmp_path / "second"):
        shutil.copytree(robot_folder(), folder)
        described = (folder / "tracker.yaml").read_text().replace("name: tracker", name)
        (folder / "tracker.yaml").write_text(described)
        with monkeypatch.context() as patch:
            patch.setattr("argo_env.robot.spec.robot_folder", lambda folder=folder: folder)
            robots.append(load_robot())
    first, second = robots
    assert second == first
    assert second.model_fields_set == first.model_fields_set
    assert first.name in ("tracker", "Tänkchen")
    assert len(list((tmp_path / "cache").glob("**/fields.txt"))) == 2


def test_there_is_a_model_of_every_kind_of_checkpoint():
    assert {k.value.replace(" ", "_") for k in CheckpointKind} == set(CHECKPOINTS)


@pytest.mark.parametrize("name", CHECKPOINTS)
def test_checkpoint(client, name):
    path = resources.urdf_folder() / "checkpoints" / f"{name}.urdf"
    _, joints = load(client, path)
    assert set(joints) == {"indicator"}
    urdf = yourdfpy.URDF.load(str(path), load_meshes=False)
    assert urdf.actuated_joint_names == ["indicator"]
    # The face is at the front: nothing but the indicator stands out of the plane x = 0.
    _, high = box_around(urdf, [urdf.base_link], parts="visuals")
    assert high[0] == pytest.approx(0.0, abs=0.005)
    _, high = box_around(urdf, parts="visuals")
    assert 0.0 <= high[0] <= 0.01
    _, high = box_around(urdf)
    assert high[0] <= 0.0


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [
        ("pressure_gauge", math.radians(-135), math.radians(135)),
        ("liquid_level_gauge", -0.12, 0.12),
        ("valve", 0.0, math.radians(90)),
    ],
)
def test_indicator_covers_the_scale(client, name, low, high):
    _, joints = load(client, resources.urdf_folder() / "checkpoints" / f"{name}.urdf")
    assert joints["indicator"][8:10] == pytest.approx((low, high), abs=1e-5)


def without(joint: str, *poses: str) -> RobotSpec:
    """Return the tracker without a joint in some of the arm's poses."""
    robot = load_robot()
    without_joint = {
        pose: {name: angle for name, angle in getattr(robot, pose).items() if name != joint}
        for pose in poses
    }
    return robot.model_copy(update=without_joint)


@pytest.mark.parametrize("pose", ["arm_stowed", "arm_raised"])
def test_a_joint_that_only_one_pose_of_the_arm_has(pose: str):
    odd = without("arm_yaw", pose)
    with pytest.raises(ValidationError, match="only one of them has: arm_yaw"):
        RobotSpec(**dict(odd))
    with pytest.raises(Invalid, match="only one of them has: arm_yaw"):
        open_site("darmstadt", odd)


def test_a_joint_that_the_model_does_not_have():
    robot = load_robot()
    arm = {pose: {**getattr(robot, pose), "tail": 0.0} for pose in ("arm_stowed", "arm_raised")}
    with pytest.raises(Invalid, match=r"must name joints of tracker\.urdf; it has no tail"):
        open_site("darmstadt", robot.model_copy(update=arm))
    with pytest.raises(Invalid, match=r"the robot's model rover\.urdf can't be read"):
        open_site("darmstadt", robot.model_copy(update={"urdf": "rover.urdf"}))


@pytest.mark.physics
def test_an_arm_that_does_not_turn_reads_as_the_ideal_sensor_does_and_aims_no_camera():
    site = open_site("darmstadt", without("arm_yaw", "arm_stowed", "arm_raised"))
    mission = Mission(tasks=(Task(name="A", action="MEASURE", object_id="1"),))
    spec = RunSpec(mission=mission, site="darmstadt")
    assert simulate(spec, site).result.success
    with pytest.raises(Invalid, match="robot tracker has no arm_yaw: use the sensor `ideal`"):
        simulate(spec.model_copy(update={"sensor": "camera"}), site)


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
        value = data.draw(angles) if joint.is_movable else 0.0
        pybullet.resetJointState(robot, numbers[joint.name], value, physicsClientId=client)
        position, rotation = joint.child_pose(value)
        where, how = places[joint.parent]
        places[joint.child] = add_vectors(where, rotate(how, position)), multiply(how, rotation)
    for joint in model.joints:
        state = pybullet.getLinkState(
            robot, numbers[joint.name], computeForwardKinematics=True, physicsClientId=client
        )
        position, rotation = places[joint.child]
        assert position == pytest.approx(state[4], abs=1e-5)
        assert abs(sum(a * b for a, b in zip(rotation, state[5], strict=True))) == pytest.approx(
            1.0, abs=1e-6
        )


@pytest.mark.physics
@settings(deadline=None, max_examples=examples(50))
@given(st.tuples(angles, angles, angles))
def test_rpy_means_what_it_means_to_pybullet_also_where_a_body_is_recorded(rpy) -> None:
    roll, pitch, yaw = rpy
    theirs = pybullet.getQuaternionFromEuler(rpy)
    for mine in (from_rpy(rpy), attitude(BodyPose(1.0, 2.0, 3.0, yaw, pitch, roll))):
        assert abs(sum(a * b for a, b in zip(mine, theirs, strict=True))) == pytest.approx(1.0)


def test_visuals_are_parsed(body) -> None:
    client, robot = body
    looks = read_model(FILE).visuals
    boxes = [look for parts in looks.values() for look in parts]
    drawn = pybullet.getVisualShapeData(robot, physicsClientId=client)
    assert len(boxes) == len(drawn)
    assert sorted(round(look.colour[0], 3) for look in boxes) == sorted(
        round(shape[7][0], 3) for shape in drawn
    )
