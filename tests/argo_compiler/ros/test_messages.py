"""Missions as messages: nothing is lost, and the definitions stay what they are."""

import math
import re

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.il import (
    Action,
    EventKind,
    Group,
    JointState,
    Mission,
    Reaction,
    Response,
    Task,
)
from argo_compiler.model import Pose
from argo_compiler.ros import (
    from_message,
    message_package,
    ros1_types,
    ros2_types,
    to_message,
)
from argo_compiler.ros.package import SPECIFICATION, definitions
from tests.conftest import examples
from tests.missions_all import FLOATS, carried_missions

VERSIONS = pytest.mark.parametrize("types", [ros1_types(), ros2_types()], ids=["ros1", "ros2"])

MD5 = {
    "MissionCondition": "69191ebaf9edf61ebc61d3cef1e20932",
    "MissionGroup": "4bc930166bfc849b3edd644d928bd131",
    "MissionReaction": "74c86b44cbe829fa74577b11abf486ce",
    "MissionSpecification": "386ae4047552ccd4eb43836c23ea9856",
    "MissionTask": "6b3230ef9bbc9b47aa0829a98693ea59",
    "MissionTransition": "3931aca7bfe094f6c3be4bc482d2116f",
}
"""As `genmsg` 0.6 of ROS 1 computes them from the same files."""
TYPE_HASH = "RIHS01_5f48a25d0aa7552b4ee9792a4ec686e4164a191a611cc79aec79428435130e54"


@VERSIONS
@settings(max_examples=examples(60), deadline=None)
@given(mission=carried_missions())
@example(mission=Mission())
def test_every_mission_comes_back_unchanged(types, mission):
    content = types.encode(to_message(mission, types))
    back = from_message(types.decode(content), types, "bag")
    assert back == mission
    assert back.model_dump_json() == mission.model_dump_json()  # the sign of 0, int and float


def test_ros_1_and_ros_2_bytes_say_the_same():
    mission = Mission(
        tasks=(Task(name="A", action=Action.WAYPOINT, pose=Pose(x=1, y=2, z=3, yaw=4)),),
        reactions=(Reaction(event=EventKind.GAS_LEAK, response=Response.ABORT),),
    )
    ros1, ros2 = ros1_types(), ros2_types()
    content = ros1.encode(to_message(mission, ros1))
    # JointState differs by the header's sequence number, so that rosbags has to convert it.
    converted = bytes(ros2.store.ros1_to_cdr(content, SPECIFICATION))
    assert from_message(ros2.decode(converted), ros2, "bag") == mission


@pytest.mark.parametrize("message", MD5)
def test_definitions_have_the_sums_that_ros_1_knows_them_by(message):
    name = f"argo_mission_msgs/msg/{message}"
    assert ros1_types().store.generate_msgdef(name)[1] == MD5[message]


def test_definitions_have_the_hash_that_ros_2_knows_them_by():
    assert ros2_types().digest() == TYPE_HASH
    assert ros1_types().digest() == MD5["MissionSpecification"]


def test_definitions_keep_the_rules_of_both_versions():
    assert {name.rpartition("/")[2] for name in definitions()} == set(MD5)
    for text in definitions().values():
        lines = [line.split("#")[0].strip() for line in text.splitlines()]
        for line in filter(None, lines):
            # ROS 2 is the stricter one about names; a string constant would swallow a comment.
            assert re.fullmatch(
                r"(bool|uint8|u?int64|float64|string|geometry_msgs/Pose|sensor_msgs/JointState"
                r"|Mission[A-Z][a-z]+)(\[\])? ([a-z](_?[a-z0-9]+)*|[A-Z](_?[A-Z0-9]+)*=\d+)",
                line,
            ), line
        assert text.isascii()


def test_package_lists_its_messages():
    package = message_package()
    listed = re.findall(rb"^\s+(Mission\w+\.msg)$", package["CMakeLists.txt"], re.MULTILINE)
    assert sorted(f"msg/{name.decode()}" for name in listed) == sorted(
        path for path in package if path.startswith("msg/")
    )
    assert b"<name>argo_mission_msgs</name>" in package["package.xml"]


@settings(deadline=None)
@given(yaw=FLOATS, x=FLOATS)
@example(yaw=math.pi, x=0.0)
@example(yaw=-math.pi, x=0.0)
@example(yaw=3 * math.pi, x=1e308)
@example(yaw=5e-324, x=-0.0)
@example(yaw=1e300, x=0.0)
def test_poses_keep_their_last_digit_and_whole_turns(yaw, x):
    types = ros2_types()
    mission = Mission(dock=Pose(x=x, y=0, z=0, yaw=yaw))
    message = to_message(mission, types)
    q = message.dock.orientation
    assert math.hypot(q.x, q.y, q.z, q.w) == pytest.approx(1)
    assert from_message(message, types, "bag") == mission


@settings(deadline=None)
@given(
    yaw=st.floats(-math.pi, math.pi),
    size=st.floats(1e-100, 1e100),
    sign=st.sampled_from([1, -1]),
    planned=st.floats(-10, 10),
)
def test_the_orientation_counts_where_the_heading_is_another(yaw, size, sign, planned):
    types = ros2_types()
    message = to_message(Mission(dock=Pose(x=0, y=0, z=0, yaw=yaw)), types)
    message.dock.orientation.z *= sign * size
    message.dock.orientation.w *= sign * size
    message.dock_yaw = planned
    read = from_message(message, types, "bag").dock.yaw
    assert math.cos(read - yaw) == pytest.approx(1)
    assert read == planned or -math.pi <= read <= math.pi


@pytest.mark.parametrize(
    ("orientation", "reason"),
    [
        ((0.0, 0.0, 0.0, 0.0), "length 0"),
        ((0.0, 0.1, 0.0, 1.0), "tilted"),
        ((0.0, 0.0, math.nan, 1.0), "not finite"),
    ],
)
def test_orientations_that_are_no_heading_are_refused(orientation, reason):
    types = ros1_types()
    message = to_message(Mission(dock=Pose(x=0, y=0, z=0)), types)
    q = message.dock.orientation
    q.x, q.y, q.z, q.w = orientation
    with pytest.raises(DiagnosticError, match=rf"^bag: error: dock: the orientation.*{reason}"):
        from_message(message, types, "bag")


def plan():
    types = ros2_types()
    joints = JointState(names=("arm",), positions=(1.0,))
    task = Task(name="A", action=Action.MEASURE, object_id="1", joint_states=joints)
    mission = Mission(
        tasks=(task,),
        groups=(Group(name="G", start="A", end="A", max_repeat_count=2),),
        reactions=(Reaction(event=EventKind.TIME_UP, response=Response.PAUSE),),
    )
    return to_message(mission, types), types


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda m: setattr(m, "version", 0), "has version 0 of the messages"),
        (lambda m: setattr(m, "version", 3), "has version 3 of the messages"),
        (lambda m: setattr(m, "mode", 7), "mode: is 7"),
        (lambda m: setattr(m, "max_duration", -1.0), "max_duration: "),
        (lambda m: setattr(m, "max_duration", math.inf), "max_duration: "),
        (lambda m: setattr(m.tasks[0], "action", 0), "tasks[0].action: is 0"),
        (lambda m: setattr(m.tasks[0], "name", ""), "tasks[0].name: "),
        (lambda m: setattr(m.tasks[0], "velocity", math.nan), "tasks[0].velocity: "),
        (lambda m: setattr(m.tasks[0], "on_failure", 9), "tasks[0].on_failure: is 9"),
        (lambda m: setattr(m.tasks[0].joint_states, "effort", [1.0]), "tasks[0].joint_states: "),
        (lambda m: setattr(m.groups[0], "stop", 2), "groups[0].stop: is 2"),
        (lambda m: setattr(m.reactions[0], "event", 0), "reactions[0].event: is 0"),
        (lambda m: setattr(m.reactions[0], "until", 99), "reactions[0].until: is 99"),
    ],
)
def test_what_a_mission_can_not_hold_is_refused_by_its_place(change, said):
    message, types = plan()
    change(message)
    with pytest.raises(DiagnosticError) as caught:
        from_message(message, types, "bag")
    (finding,) = caught.value.diagnostics
    assert finding.message.startswith(said)


def test_flags_decide_whether_a_field_counts():
    message, types = plan()
    message.current, message.start_area, message.tasks[0].source_line = "A", 3, 7
    message.tasks[0].has_object_id = False
    read = from_message(message, types, "bag")
    assert (read.current, read.start_area, read.dock) == (None, None, None)
    assert (read.tasks[0].source, read.tasks[0].object_id) == (None, None)


@pytest.mark.parametrize(
    ("task", "said"),
    [
        (Task(name="A", action=Action.START, retries=2**64), "tasks['A'].retries: 184467"),
        (Task(name="A", action=Action.START, group="\ud800"), "tasks['A'].group: is no text"),
    ],
)
def test_what_a_message_can_not_hold_is_refused_by_its_place(task, said):
    with pytest.raises(DiagnosticError) as caught:
        to_message(Mission(tasks=(task,)), ros1_types())
    (finding,) = caught.value.diagnostics
    assert finding.code.startswith("export.")
    assert finding.message.startswith(said)


def test_the_largest_numbers_fit():
    types = ros1_types()
    mission = Mission(
        tasks=(Task(name="A", action=Action.START, retries=2**64 - 1),), start_area=-(2**63)
    )
    assert (
        from_message(types.decode(types.encode(to_message(mission, types))), types, "") == mission
    )
