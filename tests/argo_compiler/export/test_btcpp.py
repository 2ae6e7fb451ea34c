"""Tests of exported behaviour trees in an interpreter; `btcpp_library.py` uses the library."""

from itertools import cycle

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.export.btcpp import to_btcpp
from argo_compiler.il import (
    EventKind,
    Group,
    JointState,
    Mission,
    OnFailure,
    Reaction,
    Response,
    Task,
)
from tests.argo_compiler.export import missions as m
from tests.argo_compiler.export.behaviour_tree import Interpreter, validate
from tests.argo_compiler.export.tree_missions import OUTCOMES, executed, tree_missions
from tests.conftest import examples
from tests.mission_parts import assume_sound
from tests.mission_writing import drive as task

STEPS = 40


@settings(max_examples=examples(80))
@given(st.one_of(m.structured_missions(), tree_missions(), tree_missions()), m.outcome_lists)
def test_tree_does_what_the_executor_does(mission, outcomes):
    assume_sound(mission)
    expected = executed(mission, outcomes, STEPS)
    log, outcome = Interpreter(to_btcpp(mission), cycle(outcomes)).run(STEPS)
    assert log == expected[0]
    if len(log) < STEPS:
        assert OUTCOMES[outcome - 1] == expected[1]


@settings(max_examples=examples(40))
@given(m.missions(), m.outcome_lists)
def test_any_mission_is_refused_or_exported_correctly(mission, outcomes):
    assume_sound(mission)
    try:
        text = to_btcpp(mission)
    except DiagnosticError as error:
        quoted_names = {"'" + t.name + "'" for t in mission.tasks}
        for diagnostic in error.diagnostics:
            assert diagnostic.code == "export.backward"
            assert any(name in diagnostic.message for name in quoted_names)
        return
    assert Interpreter(text, cycle(outcomes)).run(STEPS)[0] == executed(mission, outcomes, STEPS)[0]


def codes(mission):
    with pytest.raises(DiagnosticError) as caught:
        to_btcpp(mission)
    return [d.code for d in caught.value.diagnostics]


def test_one_error_lists_all_refusals_with_task_and_reason():
    reactions = (
        Reaction(event=EventKind.GAS_LEAK, response=Response.ABORT),
        Reaction(event=EventKind.HOT_SPOT, response=Response.REPORT),
    )
    measure = Task(name="C", action="MEASURE", object_id="{x}")
    tasks = (task("A", "B"), task("B", "A"), measure)
    mission = Mission(tasks=tasks, reactions=reactions)
    assert codes(mission) == ["export.reaction", "export.backward", "export.name"]
    with pytest.raises(DiagnosticError, match="task 'B' back to 'A'"):
        to_btcpp(mission)


@pytest.mark.parametrize("name", ["{a}", "a;b", "json:1", " {x} "])
def test_joint_names_that_the_library_interprets_are_refused(name):
    joints = JointState(names=(name,), positions=(0.5,))
    assert codes(Mission(tasks=(task("A", joint_states=joints),))) == ["export.name"]


def test_durations_beyond_the_limit_of_a_timeout_node_are_refused():
    group = Group(name="G", start="A", end="A", max_repeat_duration=5e6)
    assert codes(Mission(tasks=(task("A"),), groups=(group,))) == ["export.too-long"]


@given(st.text(min_size=1))
def test_any_name_is_exported_as_text(name):
    root = validate(to_btcpp(m.repeated(task(name))))
    shown = root.find(".//DriveTo").attrib["name"]
    printable = all(c in "\t\n\r" or " " <= c < "\x7f" for c in name)
    assert shown == name or not printable


def test_deep_nesting():
    groups = tuple(
        Group(name="/".join(["g"] * depth), start="A", end="A", max_repeat_count=2)
        for depth in range(1, 400)
    )
    text = to_btcpp(Mission(tasks=(task("A"),), groups=groups))
    assert text.count("<Repeat") == 399


def test_return_to_the_dock_is_a_task_of_the_tree():
    failing = task("A", on_failure=OnFailure.RETURN, retries=1)
    mission = Mission(tasks=(failing,), dock=m.HERE)
    log, outcome = Interpreter(
        to_btcpp(mission), cycle([(1, None, True), (1, None, True), (2, None, False)])
    ).run(STEPS)
    assert log == [(0, "A"), (1, "A"), (2, "return to dock")]
    assert OUTCOMES[outcome - 1] == "returned"
