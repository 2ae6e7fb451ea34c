"""Tests that messages preserve missions, and that the message definitions do not change."""

import math
import re

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from argo_compiler.base.model import Pose
from argo_compiler.diagnostics import DiagnosticError, Severity, Span
from argo_compiler.il import (
    Action,
    EventKind,
    Group,
    JointState,
    Mission,
    Reaction,
    Response,
    Task,
    TimeWindow,
    WaitRule,
)
from argo_compiler.ros import (
    from_message,
    message_package,
    ros1_types,
    ros2_types,
    to_message,
)
from argo_compiler.ros.package import SPECIFICATION, message_definitions
from tests.conftest import examples
from tests.mission_writing import drive, start
from tests.missions_all import FLOATS, carried_missions

VERSIONS = pytest.mark.parametrize("types", [ros1_types(), ros2_types()], ids=["ros1", "ros2"])

MD5 = {
    "MissionCondition": "373e61619283d54dd5196f7cbe897507",
    "MissionGroup": "56250824f44c2909419a503db4001238",
    "MissionPrecedence": "c0d0db6e21f3fc1eb068f9cc22ba8beb",
    "MissionReaction": "4924cc5577bff671afa31b4020d70e93",
    "MissionSpecification": "fe70f5f052581089a14b84965eb77b8b",
    "MissionTask": "1f5669cd5ca848bb62e8cabdebf98b59",
    "MissionTransition": "d905e07bc7439437900346fa76a3221e",
    "MissionWait": "e75f1aab910f777c0dd31d7cb9aa7589",
    "MissionWindow": "f61671b5696223a94cb58f0e3cf0ab2f",
}
"""MD5 sums that rosbags computes from the same files."""
TYPE_HASH = "RIHS01_769cda0ff62008ab21fc86e7bd5cf6d6dd9381b8dfb90d930271a6955ace9ef0"


@VERSIONS
@settings(max_examples=examples(60))
@given(mission=carried_missions())
@example(mission=Mission())
def test_decoding_a_message_returns_the_encoded_mission(types, mission):
    content = types.encode(to_message(mission, types))
    back = from_message(types.decode(content), types, "bag").mission
    assert back == mission
    assert back.model_dump_json() == mission.model_dump_json()  # the sign of 0, int and float


def test_ros_1_bytes_convert_to_ros_2_bytes_of_the_same_mission():
    mission = Mission(
        tasks=(Task(name="A", action=Action.WAYPOINT, pose=Pose(x=1, y=2, z=3, yaw=4)),),
        reactions=(Reaction(event=EventKind.GAS_LEAK, response=Response.ABORT),),
    )
    ros1, ros2 = ros1_types(), ros2_types()
    content = ros1.encode(to_message(mission, ros1))
    # JointState differs by the header's sequence number, so that rosbags has to convert it.
    converted = bytes(ros2.store.ros1_to_cdr(content, SPECIFICATION))
    assert from_message(ros2.decode(converted), ros2, "bag").mission == mission


@pytest.mark.parametrize("message", MD5)
def test_definitions_keep_their_md5_sums_of_ros_1(message):
    name = f"argo_mission_msgs/msg/{message}"
    assert ros1_types().store.generate_msgdef(name)[1] == MD5[message]


def test_definitions_keep_their_type_hash_of_ros_2():
    assert ros2_types().digest() == TYPE_HASH
    assert ros1_types().digest() == MD5["MissionSpecification"]


def test_definitions_are_valid_in_both_versions():
    assert {name.rpartition("/")[2] for name in message_definitions()} == set(MD5)
    for text in message_definitions().values():
        lines = [line.split("#")[0].strip() for line in text.splitlines()]
        for line in filter(None, lines):
            # ROS 2 has the stricter rules for names; a string constant would include a comment.
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


@given(yaw=FLOATS, x=FLOATS)
@example(yaw=math.pi, x=0.0)
@example(yaw=-math.pi, x=0.0)
@example(yaw=3 * math.pi, x=1e308)
@example(yaw=5e-324, x=-0.0)
@example(yaw=1e300, x=0.0)
def test_poses_keep_last_digits_and_full_turns_of_headings(yaw, x):
    types = ros2_types()
    mission = Mission(dock=Pose(x=x, y=0, z=0, yaw=yaw))
    message = to_message(mission, types)
    q = message.dock.orientation
    assert math.hypot(q.x, q.y, q.z, q.w) == pytest.approx(1)
    assert from_message(message, types, "bag").mission == mission


@given(
    yaw=st.floats(-math.pi, math.pi),
    size=st.floats(1e-100, 1e100),
    sign=st.sampled_from([1, -1]),
    planned=st.floats(-10, 10),
)
def test_the_orientation_is_used_if_the_heading_disagrees(yaw, size, sign, planned):
    types = ros2_types()
    message = to_message(Mission(dock=Pose(x=0, y=0, z=0, yaw=yaw)), types)
    message.dock.orientation.z *= sign * size
    message.dock.orientation.w *= sign * size
    message.dock_yaw = planned
    read = from_message(message, types, "bag").mission.dock.yaw
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
    task = Task(
        name="A",
        action=Action.MEASURE,
        object_id="1",
        joint_states=joints,
        wait=WaitRule(event=EventKind.ALL_CLEAR),
        window=TimeWindow(latest=60.0),
    )
    mission = Mission(
        tasks=(task,),
        groups=(Group(name="G", start="A", end="A", max_repeat_count=2),),
        reactions=(Reaction(event=EventKind.TIME_UP, response=Response.PAUSE),),
    )
    return to_message(mission, types), types


@pytest.mark.parametrize(
    ("change", "message_start"),
    [
        (lambda m: setattr(m, "version", 0), "the message has version 0 of the messages"),
        (lambda m: setattr(m, "version", 2), "the message has version 2 of the messages"),
        (lambda m: setattr(m, "mode", 7), "mode is 7"),
        (lambda m: setattr(m, "max_duration", -1.0), "max_duration: "),
        (lambda m: setattr(m, "max_duration", math.inf), "max_duration: "),
        (lambda m: setattr(m.tasks[0], "action", 0), "tasks[0].action is 0"),
        (lambda m: setattr(m.tasks[0], "name", ""), "tasks[0].name: "),
        (lambda m: setattr(m.tasks[0], "velocity", math.nan), "tasks[0].velocity: "),
        (lambda m: setattr(m.tasks[0], "on_failure", 9), "tasks[0].on_failure is 9"),
        (lambda m: setattr(m.tasks[0].window, "kind", 2), "tasks[0].window.kind is 2"),
        (lambda m: setattr(m.tasks[0].wait, "event", 99), "tasks[0].wait.event is 99"),
        (lambda m: setattr(m.tasks[0], "time_limit", -1.0), "tasks[0].time_limit: "),
        (lambda m: setattr(m.groups[0], "stop", 2), "groups[0].stop is 2"),
        (lambda m: setattr(m.reactions[0], "event", 0), "reactions[0].event is 0"),
        (lambda m: setattr(m.reactions[0], "until", 99), "reactions[0].until is 99"),
    ],
)
def test_the_error_names_a_value_that_a_mission_cannot_have(change, message_start):
    message, types = plan()
    change(message)
    with pytest.raises(DiagnosticError) as caught:
        from_message(message, types, "bag")
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.message.startswith(message_start)


def test_a_field_is_ignored_if_its_flag_is_false():
    message, types = plan()
    message.current, message.start_area, message.tasks[0].source_line = "A", 3, 7
    message.tasks[0].has_object_id = False
    read = from_message(message, types, "bag").mission
    assert (read.current, read.start_area, read.dock) == (None, None, None)
    assert (read.tasks[0].source, read.tasks[0].object_id) == (None, None)


@pytest.mark.parametrize(
    ("task", "message_start"),
    [
        (
            Task(name="A", action=Action.START, source=Span(line=2**63, column=1, length=1)),
            "tasks['A'].source.line: 9223372",
        ),
        (Task(name="A", action=Action.START, group="\ud800"), "tasks['A'].group is not text"),
    ],
)
def test_the_error_names_a_value_that_a_message_cannot_have(task, message_start):
    with pytest.raises(DiagnosticError) as caught:
        to_message(Mission(tasks=(task,)), ros1_types())
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.code.startswith("export.")
    assert diagnostic.message.startswith(message_start)


def test_the_largest_numbers_fit():
    types = ros1_types()
    mission = Mission(
        tasks=(start("A", retries=10**6, source=Span(line=2**63 - 1, column=1, length=1)),),
        start_area=-(10**9),
    )
    assert (
        from_message(types.decode(types.encode(to_message(mission, types))), types, "").mission
        == mission
    )


START = start("S", "A")


@pytest.mark.rule("T6")
def test_velocities_in_a_message_apply_to_the_path_to_the_next_task():
    types = ros2_types()
    mission = Mission(
        tasks=(START, drive("A", "B", velocity=0.5), drive("B", "C", velocity=0.25), drive("C"))
    )
    message = to_message(mission, types)
    assert [task.velocity for task in message.tasks] == [0.5, 0.25, 0.0, 0.0]
    assert from_message(message, types, "bag").mission == mission


@pytest.mark.parametrize(
    ("tasks", "groups", "named"),
    [
        ((drive("A", "B", velocity=0.5), drive("B")), (), "A"),  # no START has its velocity
        (
            (
                START,
                drive("A", "B", failure_target="C"),
                drive("B", velocity=0.5),
                drive("C"),
            ),
            (),
            "C",
        ),
        (
            (START, drive("A", "B", velocity=0.5), drive("B")),
            (Group(name="G", start="A", end="A", max_repeat_count=2),),
            "B",
        ),
        ((START, drive("A"), drive("B", velocity=0.5)), (), "B"),  # no task leads there
    ],
)
def test_velocities_that_depend_on_the_next_task_are_refused(tasks, groups, named):
    with pytest.raises(DiagnosticError) as caught:
        to_message(Mission(tasks=tasks, groups=groups), ros1_types())
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.code == "export.velocity"
    assert diagnostic.message.startswith(f"tasks['{named}'].velocity: ")


def test_the_lowest_of_several_velocities_is_used_with_a_warning():
    types = ros2_types()
    message = to_message(Mission(tasks=(START, drive("A", "B"), drive("B", "B"))), types)
    message.tasks[1].velocity, message.tasks[2].velocity = 0.5, 0.25
    received = from_message(message, types, "bag")
    assert [task.velocity for task in received.mission.tasks] == [None, None, 0.25]
    assert [(d.code, d.severity) for d in received.diagnostics] == [
        ("ros.velocity", Severity.WARNING)
    ]
