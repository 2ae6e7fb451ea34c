import pytest
from pydantic import ValidationError

from argo_compiler.diagnostics import DiagnosticError, Span
from argo_compiler.export import to_mermaid
from argo_compiler.hfsm import (
    ActionSucceeded,
    Executor,
    Hfsm,
    StateTransition,
    TransitionKind,
    lower,
)
from argo_compiler.il import Group, Mission, Stop
from tests.argo_compiler.hfsm.play import build


@pytest.fixture
def nested():
    return build(
        "A B C D",
        Group(name="G", start="A", end="C", max_repeat_duration=60, source=Span(line=4, column=1)),
        Group(name="G/H", start="B", end="C", max_repeat_count=2, stop=Stop.SOFT),
    )


def test_errors_are_refused_with_all_findings():
    with pytest.raises(DiagnosticError, match=r"plan\.json: error: .*no tasks"):
        lower(Mission(), source_name="plan.json")


def test_hierarchy(nested):
    hfsm = lower(nested)
    assert {c.id: (c.parent, c.children, c.initial) for c in hfsm.composites} == {
        "mission": (None, ("group:G", "task:D", "done"), "task:A"),
        "group:G": ("mission", ("task:A", "group:G/H"), "task:A"),
        "group:G/H": ("group:G", ("task:B", "task:C"), "task:B"),
    }
    assert hfsm.composites[1].source == Span(line=4, column=1)
    assert {leaf.id: leaf.parent for leaf in hfsm.leaves} == {
        "task:A": "group:G",
        "task:B": "group:G/H",
        "task:C": "group:G/H",
        "task:D": "mission",
    }


def test_rounds_end_from_the_inside_out(nested):
    hfsm = lower(nested)
    end = hfsm.leaves[2]
    assert end.transitions == (StateTransition(kind=TransitionKind.DEFAULT, completes="group:G/H"),)
    _, outer, inner = hfsm.composites
    assert inner.transitions == (
        StateTransition(kind=TransitionKind.REPEAT, target="task:B", domain="group:G/H"),
        StateTransition(kind=TransitionKind.DEFAULT, completes="group:G"),
    )
    assert inner.timeout is None
    assert outer.transitions == (
        StateTransition(kind=TransitionKind.REPEAT, target="task:A", domain="group:G"),
        StateTransition(kind=TransitionKind.DEFAULT, target="task:D", domain="mission"),
    )
    assert outer.timeout == StateTransition(kind=TransitionKind.TIMEOUT, completes="group:G")


def test_task_and_group_may_have_the_same_name():
    hfsm = lower(build("A B", Group(name="A", start="A", end="A", max_repeat_count=2)))
    assert [c.id for c in hfsm.composites] == ["mission", "group:A"]


def test_written_and_read_back(nested):
    hfsm = lower(nested)
    assert Hfsm.model_validate_json(hfsm.model_dump_json()) == hfsm


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('"target":"task:D"', '"target":"task:X"'),
        ('"completes":"group:G"', '"completes":"group:X"'),
        ('"parent":"group:G/H"', '"parent":"group:X"'),
        ('"id":"task:B"', '"id":"task:A"'),
        ('"target":"task:D"', '"target":null'),
        ('"id":"mission"', '"id":"root"'),
        ('"parent":null', '"parent":"mission"'),
    ],
)
def test_file_with_broken_references_is_refused(nested, old, new):
    text = lower(nested).model_dump_json()
    assert old in text
    with pytest.raises(ValidationError):
        Hfsm.model_validate_json(text.replace(old, new))


def test_a_thousand_nested_groups():
    groups = (
        Group(name="/".join(["G"] * depth), start="B", end="C", max_repeat_duration=1 + depth)
        for depth in range(1, 1001)
    )
    hfsm = lower(build("A B C D", *groups))
    assert Hfsm.model_validate_json(hfsm.model_dump_json()) == hfsm
    assert to_mermaid(hfsm).count("<<choice>>") == 1000
    executor = Executor(hfsm)
    executor.start(0)
    executor.handle(ActionSucceeded("A"), 1)
    assert len(executor.configuration) == 1002
    executor.handle(ActionSucceeded("B"), 2)
    assert executor.next_deadline == 3
    executor.handle(ActionSucceeded("C"), 2000)
    assert executor.active_task == "D"


def test_ten_thousand_tasks():
    names = [f"T{i}" for i in range(10_000)]
    groups = (
        Group(name=f"G{i}", start=f"T{i}", end=f"T{i + 8}", max_repeat_count=2)
        for i in range(0, 10_000, 10)
    )
    hfsm = lower(build(" ".join(names), *groups))
    assert len(hfsm.leaves) == 10_000
    assert len(list(hfsm.transitions())) == 10_000 + 2 * 1000
