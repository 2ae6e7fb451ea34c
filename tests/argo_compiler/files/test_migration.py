"""Tests that files of older versions keep their meaning, or a warning reports the change."""

import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.files.mission_file import decode_mission
from argo_compiler.il import Group, Mission, Stop
from argo_compiler.il.velocities import (
    MISSION_START,
    approach_to_departure_velocities,
    departure_to_approach_velocities,
    possible_successor_pairs,
)
from tests.mission_writing import drive

LOW = {"type": "MEASURED_VALUE_LESS", "object_id": "1", "param1": 1}
DOCK = {"x": 0.0, "y": 0.0, "z": 0.0, "yaw": 0.0}


def read(version=2, **data):
    return decode_mission(json.dumps({"version": version, **data}).encode(), "old.json")


def task(name, *targets, velocity=None, action="MEASURE", **fields):
    data = {"name": name, "action": action, "transitions": [{"target": t} for t in targets]}
    if action == "MEASURE":
        data["object_id"] = "1"
    if velocity is not None:
        data["velocity"] = velocity
    return data | fields


def velocities(mission):
    return {task.name: task.velocity for task in mission.tasks}


@pytest.mark.rule("M6", "T6")
@pytest.mark.parametrize("version", [1, 2])
def test_a_velocity_moves_from_the_previous_task_to_the_task_it_leads_to(version):
    start = task("S", "A", action="START", velocity=0.2)
    file = read(version, tasks=[start, task("A", "B", velocity=0.3), task("B")])
    assert velocities(file.mission) == {"S": None, "A": 0.2, "B": 0.3}
    assert file.mission.version == 4
    assert not file.changes


@pytest.mark.rule("M6")
def test_the_lowest_of_different_velocities_is_used_and_reported():
    file = read(tasks=[task("A", "C", velocity=0.3), task("B", "C", velocity=0.5), task("C", "B")])
    assert velocities(file.mission)["C"] == 0.3
    (change,) = file.changes
    assert change.code == "file.meaning-changed"
    assert "'C'" in change.message
    (placed,) = file.diagnostics_with_positions(file.changes)
    assert placed.span is not None


def test_the_path_to_the_next_round_has_a_velocity_too():
    groups = [{"name": "G", "start": "A", "end": "B", "max_repeat_count": 3}]
    file = read(
        tasks=[
            task("S", "A", action="START", velocity=0.2),
            task("A", "B", velocity=0.4),
            task("B", velocity=0.2),
        ],
        groups=groups,
    )
    assert velocities(file.mission) == {"S": None, "A": 0.2, "B": 0.4}
    assert not file.changes


@pytest.mark.rule("M6")
@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({"mode": "supervisory", "tasks": [task("A")]}, "starts paused"),
        ({"tasks": [task("A", pose=DOCK)]}, "was never used"),
        (
            {"tasks": [task("A", transitions=[{"target": "A", "conditions": [LOW]}])]},
            "earlier measurement",
        ),
        (
            {
                "tasks": [task("A")],
                "reactions": [
                    {"event": "low_battery", "response": "pause", "priority": 3},
                    {"event": "emergency_stop", "response": "abort", "priority": 1},
                ],
            },
            "before all others",
        ),
    ],
)
def test_a_change_of_meaning_is_reported(data, message):
    file = read(**data)
    (change,) = file.changes
    assert message in change.message
    assert change.hint
    assert not decode_mission(
        json.dumps({**file.mission.model_dump(mode="json")}).encode(), "new.json"
    ).changes


@pytest.mark.rule("M6")
@pytest.mark.parametrize(
    ("data", "field"),
    [
        ({"tasks": [task("A", window={"latest": 9})]}, "tasks[0].window"),
        ({"tasks": [task("A"), task("W", action="WAIT")]}, "tasks[1].action"),
        (
            {"tasks": [task("A")], "groups": [{"name": "G", "start": "A", "end": "A", "every": 9}]},
            "groups[0].every",
        ),
    ],
)
def test_a_file_may_only_have_the_fields_of_its_version(data, field):
    with pytest.raises(DiagnosticError) as caught:
        read(**data)
    (fault,) = caught.value.diagnostics
    assert (fault.code, fault.subject) == ("file.wrong-field", field)
    assert fault.span is not None
    assert "version" in fault.hint
    read(3, **data)


UNREACHABLE = {"type": "READING_UNREACHABLE", "object_id": "1"}


@pytest.mark.rule("M6")
@pytest.mark.parametrize(
    ("data", "field"),
    [
        (
            {"reactions": [{"event": "low_battery", "response": "pause", "charge_to": 0.6}]},
            "reactions[0].charge_to",
        ),
        (
            {"tasks": [task("W", action="WAIT", wait={"event": "all_clear", "charge_for": 9})]},
            "tasks[0].wait.charge_for",
        ),
        (
            {"tasks": [task("A", transitions=[{"target": "A", "conditions": [UNREACHABLE]}])]},
            "tasks[0].transitions[0].conditions[0].type",
        ),
        (
            {"tasks": [task("W", action="WAIT", wait={"conditions": [UNREACHABLE]})]},
            "tasks[0].wait.conditions[0].type",
        ),
        (
            {
                "tasks": [task("A")],
                "groups": [{"name": "G", "start": "A", "end": "A", "until": [UNREACHABLE]}],
            },
            "groups[0].until[0].type",
        ),
    ],
)
def test_version_3_has_no_charges_and_no_unreachable_readings(data, field):
    with pytest.raises(DiagnosticError) as caught:
        read(3, **data)
    (fault,) = caught.value.diagnostics
    assert (fault.code, fault.subject) == ("file.wrong-field", field)
    assert fault.span is not None
    read(4, **data)


@pytest.mark.rule("M6")
def test_a_mission_of_version_3_means_the_same_today():
    data = {
        "tasks": [task("A", velocity=0.3, pose=DOCK)],
        "reactions": [{"event": "gas_leak", "response": "pause"}],
    }
    file = read(3, **data)
    assert not file.changes
    assert file.mission == read(4, **data).mission


def test_missing_priorities_stay_0_and_unused_poses_stay_unused():
    file = read(
        dock=DOCK,
        tasks=[task("A")],
        reactions=[
            {"event": "gas_leak", "response": "return", "pose": {**DOCK, "x": 9.0}},
            {"event": "low_battery", "response": "return", "priority": 2},
        ],
    )
    assert [(r.priority, r.pose) for r in file.mission.reactions] == [(0, None), (2, None)]


@st.composite
def routes(draw):
    """Draw a mission of drives in which each task has at most one transition."""
    names = [f"T{i}" for i in range(draw(st.integers(1, 6)))]
    speeds = st.sampled_from([None, 0.2, 0.4])
    ways_on = st.lists(st.sampled_from(names), max_size=1)
    tasks = tuple(drive(name, *draw(ways_on), velocity=draw(speeds)) for name in names)
    first, last = sorted(draw(st.tuples(*[st.integers(0, len(names) - 1)] * 2)))
    group = Group(
        name="G",
        start=names[first],
        end=names[last],
        max_repeat_count=2,
        max_repeat_duration=draw(st.sampled_from([0, 60])),
        stop=draw(st.sampled_from(Stop)),
    )
    return Mission(tasks=tasks, groups=draw(st.sampled_from([(), (group,)])))


@settings(max_examples=200)
@given(routes())
def test_each_path_keeps_its_velocity_or_its_task_is_reported(mission):
    there, differ = departure_to_approach_velocities(mission)
    old_velocities, new_velocities = velocities(mission), velocities(there)
    for source, target in possible_successor_pairs(mission):
        old = None if source == MISSION_START else old_velocities[source]
        assert new_velocities[target] == old or target in differ


@settings(max_examples=200)
@given(routes())
def test_converting_velocities_to_version_2_and_back_changes_nothing(mission):
    on, differ = approach_to_departure_velocities(mission)
    if not differ:
        there, _ = departure_to_approach_velocities(on)
        reached = {target for _, target in possible_successor_pairs(mission)}
        assert all(velocities(there)[t] == velocities(mission)[t] for t in reached)
