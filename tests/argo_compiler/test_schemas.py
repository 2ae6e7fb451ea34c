"""Tests that the shipped JSON Schemas are up to date and agree with the models."""

import json
from copy import deepcopy

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from jsonschema import Draft202012Validator
from pydantic import ValidationError

from argo_compiler.files.mission_file import mission_text
from argo_compiler.hfsm import Executor, Hfsm, Progress, lower
from argo_compiler.il import (
    Group,
    Mission,
)
from argo_compiler.schemas import SchemaName, read_schema
from argo_compiler.schemas.generate import MODELS, schema_text
from tests.mission_writing import drive, measure
from tests.missions_all import missions

VALIDATORS = {name: Draft202012Validator(json.loads(read_schema(name))) for name in SchemaName}
WRONG = [None, True, -1, 0.5, "", "FLY", [], {}, [[]], {"colour": 1}, 10**30, "2"]


@pytest.mark.parametrize("name", SchemaName)
def test_the_shipped_schema_is_that_of_the_model(name):
    assert read_schema(name) == schema_text(name), "out of date: run `make generated`"
    Draft202012Validator.check_schema(json.loads(read_schema(name)))


def test_fields_have_descriptions():
    schema = json.loads(read_schema(SchemaName.MISSION))
    assert (
        "robot's planning speed" in schema["$defs"]["Task"]["properties"]["velocity"]["description"]
    )
    assert "docking station" in schema["properties"]["dock"]["description"]


@settings(max_examples=60)
@given(missions())
def test_written_missions_are_valid(mission):
    VALIDATORS[SchemaName.MISSION].validate(json.loads(mission_text(mission)))
    VALIDATORS[SchemaName.MISSION].validate(mission.model_dump(mode="json"))


def paths(data, at=()):
    yield at
    for step, inner in (
        data.items()
        if isinstance(data, dict)
        else enumerate(data)
        if isinstance(data, list)
        else ()
    ):
        yield from paths(inner, (*at, step))


@settings(max_examples=200)
@given(missions(), st.data())
def test_schema_and_model_refuse_the_same_data(mission, data):
    """In each example, one value is replaced by another, or one field is removed."""
    changed = deepcopy(json.loads(mission_text(mission)))
    *path, last = data.draw(st.sampled_from([p for p in paths(changed) if p]))
    container = changed
    for step in path:
        container = container[step]
    if data.draw(st.booleans()):
        container[last] = data.draw(st.sampled_from(WRONG))
    else:
        del container[last]
    try:
        Mission.model_validate_json(json.dumps(changed), strict=True)
        accepted = True
    except ValidationError:
        accepted = False
    assert VALIDATORS[SchemaName.MISSION].is_valid(changed) == accepted


def test_machine_and_progress_are_accepted():
    group = Group(name="G", start="A", end="B", max_repeat_count=2)
    machine = lower(Mission(tasks=(measure("A", "B"), drive("B")), groups=(group,)))
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
