"""The shipped JSON Schemas: up to date, and in agreement with the models."""

import json
from copy import deepcopy

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from jsonschema import Draft202012Validator
from pydantic import ValidationError

from argo_compiler.base.model import Pose
from argo_compiler.files.mission_file import mission_text
from argo_compiler.hfsm import Executor, Hfsm, Progress, lower
from argo_compiler.il import (
    Action,
    Afterwards,
    Condition,
    ConditionType,
    EventKind,
    Group,
    JointState,
    Mission,
    OnFailure,
    Reaction,
    Response,
    Stop,
    Task,
    Transition,
)
from argo_compiler.schemas import SchemaName, read_schema
from argo_compiler.schemas.generate import MODELS, schema_text

FLOATS = st.floats(allow_nan=False, allow_infinity=False)
POSITIVE = st.floats(0.001, 1e9)
TEXTS = st.text(max_size=6)
NAMES = st.text(min_size=1, max_size=6)
POSES = st.builds(Pose, x=FLOATS, y=FLOATS, z=FLOATS, yaw=FLOATS)
CONDITIONS = st.builds(
    Condition,
    type=st.sampled_from(ConditionType),
    id=TEXTS,
    object_id=TEXTS,
    param1=FLOATS,
    param2=st.none() | FLOATS,
    inclusive=st.booleans(),
    max_age=st.none() | POSITIVE,
)
TASKS = st.builds(
    Task,
    name=NAMES,
    action=st.sampled_from(Action),
    group=TEXTS,
    object_id=st.none() | TEXTS,
    pose=st.none() | POSES,
    velocity=st.none() | POSITIVE,
    joint_states=st.none()
    | st.builds(JointState, names=st.tuples(TEXTS), positions=st.tuples(FLOATS)),
    retries=st.integers(0, 9),
    on_failure=st.sampled_from(OnFailure),
    transitions=st.lists(
        st.builds(Transition, target=TEXTS, conditions=st.lists(CONDITIONS, max_size=2).map(tuple)),
        max_size=2,
    ).map(tuple),
)
GROUPS = st.builds(
    Group,
    name=NAMES,
    start=TEXTS,
    end=TEXTS,
    max_repeat_count=st.integers(0, 9),
    max_repeat_duration=st.floats(0, 1e6),
    count_interruptions=st.booleans(),
    stop=st.sampled_from(Stop),
)
REACTIONS = st.builds(
    Reaction,
    event=st.sampled_from(EventKind),
    response=st.sampled_from(Response),
    pose=st.none() | POSES,
    until=st.none() | st.sampled_from(EventKind),
    afterwards=st.sampled_from(Afterwards),
    priority=st.integers(-9, 9),
)
MISSIONS = st.builds(
    Mission,
    designation=TEXTS,
    max_duration=st.none() | POSITIVE,
    dock=st.none() | POSES,
    end_area=st.none() | st.integers(1, 3),
    tasks=st.lists(TASKS, min_size=1, max_size=3).map(tuple),
    groups=st.lists(GROUPS, max_size=2).map(tuple),
    reactions=st.lists(REACTIONS, max_size=2).map(tuple),
    current=st.none() | TEXTS,
)
VALIDATORS = {name: Draft202012Validator(json.loads(read_schema(name))) for name in SchemaName}
WRONG = [None, True, -1, 0.5, "", "FLY", [], {}, [[]], {"colour": 1}, 10**30, "2"]


@pytest.mark.parametrize("name", SchemaName)
def test_the_shipped_schema_is_the_models_own(name):
    assert read_schema(name) == schema_text(name), "out of date: run `make generated`"
    Draft202012Validator.check_schema(json.loads(read_schema(name)))


def test_fields_are_described():
    schema = json.loads(read_schema(SchemaName.MISSION))
    assert (
        "robot's planning speed" in schema["$defs"]["Task"]["properties"]["velocity"]["description"]
    )
    assert "docking station" in schema["properties"]["dock"]["description"]


@settings(deadline=None, max_examples=60)
@given(MISSIONS)
def test_what_is_written_is_accepted(mission):
    VALIDATORS[SchemaName.MISSION].validate(json.loads(mission_text(mission)))
    VALIDATORS[SchemaName.MISSION].validate(mission.model_dump(mode="json"))


def places(data, at=()):
    yield at
    for step, inner in (
        data.items()
        if isinstance(data, dict)
        else enumerate(data)
        if isinstance(data, list)
        else ()
    ):
        yield from places(inner, (*at, step))


@settings(deadline=None, max_examples=200)
@given(MISSIONS, st.data())
def test_schema_and_model_refuse_the_same(mission, data):
    """One value is replaced by another one, or a field is left out."""
    changed = deepcopy(json.loads(mission_text(mission)))
    *path, last = data.draw(st.sampled_from([p for p in places(changed) if p]))
    inside = changed
    for step in path:
        inside = inside[step]
    if data.draw(st.booleans()):
        inside[last] = data.draw(st.sampled_from(WRONG))
    else:
        del inside[last]
    try:
        Mission.model_validate_json(json.dumps(changed), strict=True)
        accepted = True
    except ValidationError:
        accepted = False
    assert VALIDATORS[SchemaName.MISSION].is_valid(changed) == accepted


def test_machine_and_progress_are_accepted():
    tasks = (
        Task(name="A", action=Action.MEASURE, object_id="1", transitions=(Transition(target="B"),)),
        Task(name="B", action=Action.WAYPOINT, pose=Pose(x=0, y=0, z=0)),
    )
    group = Group(name="G", start="A", end="B", max_repeat_count=2)
    machine = lower(Mission(tasks=tasks, groups=(group,)))
    executor = Executor(machine)
    executor.start(0.0)
    for name, value in (
        (SchemaName.MACHINE, machine),
        (SchemaName.PROGRESS, executor.progress()),
    ):
        assert isinstance(value, Hfsm | Progress)
        assert type(value) is MODELS[name]
        VALIDATORS[name].validate(value.model_dump(mode="json"))
        VALIDATORS[name].validate(value.model_dump(mode="json", exclude_defaults=True))
        assert not VALIDATORS[name].is_valid(value.model_dump(mode="json") | {"colour": 1})
