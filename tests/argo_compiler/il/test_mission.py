import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from argo_compiler.base.model import Pose
from argo_compiler.il import (
    Action,
    Condition,
    ConditionType,
    Group,
    JointState,
    Mission,
    Mode,
    Order,
    Stop,
    Task,
    Transition,
)

FLOATS = st.floats(allow_nan=False, allow_infinity=False)
TEXTS = st.text(max_size=8)
TASKS = st.builds(
    Task,
    name=st.text(min_size=1, max_size=8),
    action=st.sampled_from(Action),
    object_id=st.none() | TEXTS,
    pose=st.none() | st.builds(Pose, x=FLOATS, y=FLOATS, z=FLOATS, yaw=FLOATS),
    velocity=st.none() | st.floats(0.01, 2),
    joint_states=st.none()
    | st.builds(JointState, names=st.just(("arm_1",)), positions=st.tuples(FLOATS)),
    transitions=st.lists(
        st.builds(
            Transition,
            target=TEXTS,
            conditions=st.lists(
                st.builds(
                    Condition,
                    type=st.sampled_from(ConditionType),
                    object_id=TEXTS,
                    param1=FLOATS,
                    param2=st.none() | FLOATS,
                ),
                max_size=2,
            ).map(tuple),
        ),
        max_size=2,
    ).map(tuple),
)
MISSIONS = st.builds(
    Mission,
    designation=TEXTS,
    mode=st.sampled_from(Mode),
    order=st.sampled_from(Order),
    tasks=st.lists(TASKS, max_size=3).map(tuple),
    groups=st.lists(
        st.builds(
            Group,
            name=st.text(min_size=1, max_size=8),
            start=TEXTS,
            end=TEXTS,
            stop=st.sampled_from(Stop),
            max_repeat_count=st.integers(0, 10**6),
        ),
        max_size=2,
    ).map(tuple),
)


@settings(max_examples=50, deadline=None)
@given(MISSIONS)
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
