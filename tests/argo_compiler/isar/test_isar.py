"""Tests of exporting missions to isar and importing them from isar."""

import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.model import Pose
from argo_compiler.checks import check
from argo_compiler.diagnostics import DiagnosticError, Severity
from argo_compiler.hfsm import lower
from argo_compiler.il import (
    Action,
    Condition,
    ConditionType,
    EventKind,
    Group,
    JointState,
    Mission,
    Mode,
    OnFailure,
    Reaction,
    Response,
    Task,
    TimeWindow,
    Transition,
)
from argo_compiler.isar import InspectionView, from_isar, read_isar, to_isar
from tests.argo_compiler.isar.conftest import assert_isar_accepts
from tests.mission_writing import checkpoint, drive, measure, start, wait, way

VIEWS = {
    "1": InspectionView(
        pose=Pose(x=1, y=2, z=0, yaw=math.pi), target=(0.5, 2, 1.2), name="valve R25"
    ),
    "2": InspectionView(pose=Pose(x=3, y=2, z=2.5), target=(4, 2, 3.5)),
}
CATALOG = Catalog(
    site="plant",
    checkpoints=tuple(checkpoint(id, 0, 90, 85, 90) for id in (1, 2)),
    areas=(),
    floors=(),
)


GAS = Reaction(event=EventKind.GAS_LEAK, response=Response.ABORT)
LOW = Condition(type=ConditionType.LESS, object_id="1", param1=1)
JOINTS = JointState(names=("arm",), positions=(1.0,))


def alone(task, **fields):
    return Mission(tasks=(task,), **fields)


def at_1(*ways, **fields):
    return measure("A", *ways, object_id="1", **fields)


def repeated(**limits):
    return alone(at_1(), groups=(Group(name="G", start="A", end="A", **limits),))


def export(mission, views=VIEWS):
    data = json.loads(to_isar(mission, lower(mission), views))
    assert_isar_accepts(data)
    return data


def test_a_mission_is_exported_as_a_definition():
    mission = Mission(
        designation="Round",
        tasks=(
            start("S", "A", pose=Pose(x=0, y=0, z=0)),
            measure("A", "B", object_id="1"),
            measure("B", object_id="2", pose=Pose(x=9, y=0, z=0)),
        ),
    )
    data = export(mission)
    assert data == export(mission)
    del data["id"]

    def at(x, y, z, **more):
        return {"x": x, "y": y, "z": z, **more, "frame_name": "asset"}

    def robot_pose(x, y, z, qz, qw):
        return {
            "position": at(x, y, z),
            "orientation": at(0, 0, qz, w=qw),
            "frame_name": "asset",
        }

    assert data == {
        "name": "Round",
        "start_pose": robot_pose(0, 0, 0, 0, 1),
        "tasks": [
            {
                "id": "A",
                "type": "inspection",
                "tag": "1",
                "pose": robot_pose(1, 2, 0, 1, pytest.approx(0)),
                "inspection": {
                    "type": "Image",
                    "inspection_target": at(0.5, 2, 1.2),
                    "inspection_description": "valve R25",
                },
            },
            {
                "id": "B",
                "type": "inspection",
                "tag": "2",
                "pose": robot_pose(9, 0, 0, 0, 1),
                "inspection": {"type": "Image", "inspection_target": at(4, 2, 3.5)},
            },
        ],
    }


def test_groups_with_a_count_are_unrolled():
    mission = Mission(
        tasks=(
            measure("A", "B", object_id="1"),
            measure("B", "C", object_id="2"),
            measure("C", object_id="1"),
        ),
        groups=(
            Group(name="G", start="A", end="C", max_repeat_count=2),
            Group(name="G/H", start="B", end="B", max_repeat_count=2),
        ),
    )
    data = export(mission)
    ids = [task["id"] for task in data["tasks"]]
    assert ids == ["A", "B", "B (2)", "C", "A (2)", "B (3)", "B (4)", "C (2)"]
    assert "".join(task["tag"] for task in data["tasks"]) == "12211221"


def test_a_wait_of_no_duration_is_not_exported():
    join = wait("J", duration=0)
    mission = Mission(
        tasks=(measure("A", "J", object_id="1"), join),
        groups=(Group(name="G", start="A", end="J", max_repeat_count=2),),
    )
    assert [task["id"] for task in export(mission)["tasks"]] == ["A", "A (2)"]


def test_a_last_drive_to_the_dock_is_the_return_to_home():
    dock = Pose(x=0, y=0, z=0, yaw=1)
    home = Task(name="home", action=Action.WAYPOINT, pose=dock)
    for fields in ({"dock": dock}, {"end_area": 1}):
        data = export(Mission(**fields, tasks=(measure("A", "home", object_id="1"), home)))
        assert data["tasks"][1]["type"] == "return_to_home"
        imported = from_isar(data, "isar").mission
        assert imported.dock == imported.tasks[1].pose
        assert imported.dock.yaw == pytest.approx(1)
        assert [t["id"] for t in export(imported)["tasks"]] == ["A", "home"]


@pytest.mark.parametrize(
    ("code", "mission", "message"),
    [
        ("task", alone(at_1(retries=1)), "'A' has retries"),
        ("task", alone(at_1(velocity=1)), "'A' has a velocity"),
        ("task", alone(at_1(on_failure=OnFailure.ABORT)), "'A' has a failure policy"),
        ("task", alone(at_1(joint_states=JOINTS)), "'A' has joint states"),
        ("task", alone(at_1(time_limit=9)), "'A' has a time limit"),
        ("task", alone(at_1(reading_limit=9)), "'A' has a reading limit"),
        ("task", alone(at_1(window=TimeWindow(latest=9))), "'A' has a time window"),
        ("task", alone(wait("W", duration=9)), "'W' has a wait"),
        ("group", repeated(max_repeat_count=2, every=9), "'G' is repeated at fixed times"),
        ("group", repeated(until=(LOW,)), "'G' is repeated until"),
        ("task", alone(at_1(way("A", LOW))), "'A' has conditions"),
        ("reaction", alone(at_1(), reactions=(GAS,)), "gas_leak"),
        ("mode", alone(at_1(), mode=Mode.SUPERVISORY), "supervisory"),
        ("group", repeated(max_repeat_duration=9), "'G' is repeated for a duration"),
        ("waypoint", alone(drive("W")), "'W' only drives"),
        ("no-target", alone(measure("A", object_id="3")), "checkpoint '3' of task 'A'"),
        ("endless", alone(at_1("A")), "more than 10000 tasks"),
        ("endless", repeated(max_repeat_count=10**9), "more than 10000 tasks"),
        ("empty", alone(Task(name="S", action=Action.START)), "without tasks"),
    ],
)
def test_features_that_isar_lacks_are_refused(code, mission, message):
    with pytest.raises(DiagnosticError) as caught:
        to_isar(mission, lower(mission), VIEWS)
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.code == f"export.isar-{code}"
    assert message in diagnostic.message
    assert diagnostic.hint


COORDINATES = st.floats(-1e6, 1e6)
POSES = st.builds(
    Pose, x=COORDINATES, y=COORDINATES, z=COORDINATES, yaw=st.floats(-math.pi, math.pi)
)


@given(
    stops=st.lists(st.tuples(st.sampled_from("12"), POSES), min_size=1, max_size=5),
    start=st.none() | POSES,
    designation=st.text(st.characters(exclude_categories=["Cs"]), min_size=1),
)
def test_importing_an_export_gives_the_same_inspections(stops, start, designation):
    names = [f"T{i}" for i in range(len(stops))]
    tasks = [
        measure(name, *names[i + 1 : i + 2], object_id=object_id, pose=pose)
        for i, (name, (object_id, pose)) in enumerate(zip(names, stops, strict=True))
    ]
    if start:
        first = (Transition(target=names[0]),)
        tasks.insert(0, Task(name="START", action=Action.START, pose=start, transitions=first))
    mission = Mission(designation=designation, tasks=tuple(tasks))
    imported = from_isar(export(mission), "isar")
    assert not imported.diagnostics
    turned = [task.pose.yaw - back.pose.yaw for task, back in zip_tasks(mission, imported.mission)]
    # A quaternion changes the last digits of a heading, and -pi comes back as pi.
    assert [math.cos(turn) for turn in turned] == pytest.approx([1.0] * len(turned))
    assert with_zero_headings(imported.mission) == with_zero_headings(mission)


def zip_tasks(left, right):
    return zip(left.tasks, right.tasks, strict=True)


def with_zero_headings(mission):
    """Return the mission with all headings set to 0."""
    tasks = tuple(
        task.model_copy(update={"pose": task.pose.model_copy(update={"yaw": 0.0})})
        for task in mission.tasks
    )
    return mission.model_copy(update={"tasks": tasks})


def definition(**task):
    """Return the example in isar's README ("Running a robot mission"), in the frame `asset`."""
    point = {"x": 1.0, "y": 1.0, "z": 1.0, "frame_name": "asset"}
    data = {
        "id": "example ID",
        "type": "inspection",
        "pose": {
            "position": point,
            "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0, "frame_name": "asset"},
            "frame_name": "asset",
        },
        "inspection": {
            "type": "Image",
            "inspection_target": point,
            "inspection_description": "Example description",
            "duration": None,
        },
        "tag": "valve R2",
        "zoom": None,
    }
    return {"id": "example ID", "tasks": [data | task], "name": "Example name"}


def test_a_definition_is_imported():
    imported = from_isar(definition(), "isar", CATALOG)
    assert not imported.diagnostics
    (task,) = imported.mission.tasks
    assert (task.name, task.action, task.object_id) == ("example ID", Action.MEASURE, "2")
    assert imported.mission.designation == "Example name"
    assert not check(imported.mission, CATALOG)


def test_the_body_of_a_request_is_imported_too(tmp_path):
    path = tmp_path / "isar.json"
    path.write_text(json.dumps({"mission_definition": definition()}))
    assert read_isar(path.read_bytes(), str(path), CATALOG) == from_isar(
        definition(), str(path), CATALOG
    )


def test_a_warning_reports_each_ignored_field():
    robot = definition()["tasks"][0]["pose"] | {"frame_name": "robot"}
    data = definition(pose=robot, zoom={"objectWidth": 1, "objectHeight": 1}, analysis=["x"])
    imported = from_isar(data | {"start_pose": robot}, "isar", CATALOG)
    assert [(f.severity, f.message.split(" is ignored")[0]) for f in imported.diagnostics] == [
        (Severity.WARNING, "start_pose"),
        (Severity.WARNING, "tasks[0].analysis"),
        (Severity.WARNING, "tasks[0].pose"),
        (Severity.WARNING, "tasks[0].zoom"),
    ]
    start, task = imported.mission.tasks
    assert (start.pose, task.pose) == (None, None)
    assert not check(imported.mission, CATALOG)


def test_a_pose_with_an_orientation_of_zeros_is_ignored():
    data = definition()
    data["tasks"][0]["pose"]["orientation"]["w"] = 0
    imported = from_isar(data, "isar")
    assert "length 0" in imported.diagnostics[0].message
    assert imported.mission.tasks[0].pose is None


@pytest.mark.parametrize(
    ("data", "code", "message"),
    [
        (definition(tag=None), "tag", "tasks[0] has no tag"),
        (definition(inspection=None), "inspection", "tasks[0] has no inspection"),
        (
            definition(
                inspection={
                    "type": "Audio",
                    "inspection_target": {"x": 0, "y": 0, "z": 0},
                    "duration": 3,
                }
            ),
            "inspection-type",
            "tasks[0] is an inspection of type Audio",
        ),
        (definition(type="fly"), "wrong-field", "tasks[0].type: "),
        (definition(pose={}), "wrong-field", "tasks[0].pose.position: "),
        ({"tasks": 3}, "wrong-field", "tasks: "),
        ([], "wrong-field", "the mission: "),
    ],
)
def test_inspections_that_argo_cannot_do_are_refused(data, code, message):
    with pytest.raises(DiagnosticError) as caught:
        from_isar(data, "isar")
    errors = [f for f in caught.value.diagnostics if f.severity is Severity.ERROR]
    assert errors[0].code == f"isar.{code}"
    assert errors[0].message.startswith(message)


@pytest.mark.parametrize(
    "content",
    [
        '{"version": 2, "designation": "\\"inspection\\"", "tasks": []}',
        '{"tasks": [{"name": "inspection", "action": "MEASURE", "pose": null}], "inspection": 1}',
        '["inspection"]',
        '{"inspection": ',
        '{"x": "inspection", "y": ' + "[" * 100_000,
        b"\xff",
    ],
)
def test_a_file_without_a_definition_is_not_imported(tmp_path, content):
    path = tmp_path / "plan.json"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    assert read_isar(path.read_bytes(), str(path)) is None
    assert read_isar(b"", "empty.json") is None
