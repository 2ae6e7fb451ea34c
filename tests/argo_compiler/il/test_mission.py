import pytest
from hypothesis import given, settings
from pydantic import ValidationError

from argo_compiler.il import (
    Action,
    Condition,
    ConditionType,
    Group,
    Mission,
    Task,
)
from tests.missions_all import missions


@settings(max_examples=50)
@given(missions())
def test_every_mission_is_written_and_read_back(mission):
    assert Mission.model_validate_json(mission.model_dump_json()) == mission


@pytest.mark.parametrize(
    ("model", "fields"),
    [
        (Task, {"name": "", "action": "START"}),
        (Task, {"name": "A", "action": "FLY"}),
        (Task, {"name": "A", "action": "START", "velocity": 0}),
        (Task, {"name": "A", "action": "START", "speed": 1}),
        (Group, {"name": "", "start": "A", "end": "B"}),
        (Group, {"name": "G", "start": "A", "end": "B", "max_repeat_count": -1}),
        (Group, {"name": "G", "start": "A", "end": "B", "max_repeat_duration": float("inf")}),
        (Condition, {"type": ConditionType.LESS, "object_id": "1", "param1": float("nan")}),
        (Condition, {"type": ConditionType.LESS, "object_id": "1", "param1": 1, "max_age": 0}),
        (Mission, {"version": 2}),
        (Mission, {"max_duration": 0}),
    ],
)
def test_wrong_shapes_are_refused(model, fields):
    with pytest.raises(ValidationError):
        model(**fields)


def test_missions_are_frozen():
    mission = Mission()
    with pytest.raises(ValidationError, match="frozen"):
        mission.designation = "other"


def test_task_is_found_by_name():
    task = Task(name="A", action=Action.START)
    assert Mission(tasks=(task,)).task("A") is task
    assert Mission(tasks=(task,)).task("B") is None
