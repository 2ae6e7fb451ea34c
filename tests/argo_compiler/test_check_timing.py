"""Diagnostics of `check` about waits, time windows, failures, readings, rounds and ranks."""

import pytest

from argo_compiler.base.model import Pose
from argo_compiler.checks import check
from argo_compiler.diagnostics import Severity
from argo_compiler.il import (
    Condition,
    ConditionType,
    JointState,
    Mission,
    Reaction,
    Task,
    TimeWindow,
    WaitRule,
)
from tests.argo_compiler.test_check import CHAIN, chain, codes, group, measure, when
from tests.mission_writing import wait

HERE = Pose(x=0, y=0, z=0, yaw=0)


@pytest.mark.rule("T1")
@pytest.mark.parametrize(
    "rule",
    [
        None,
        WaitRule(),
        WaitRule(limit=3),
        WaitRule(duration=3, event="all_clear"),
        WaitRule(duration=3, conditions=(Condition(type="READING_FAILED", object_id="1"),)),
    ],
)
def test_a_wait_says_how_long_in_one_way(rule):
    findings = check(Mission(tasks=(measure("A", "W"), wait("W", wait=rule))))
    assert "il.wait-rule" in [finding.code for finding in findings]


@pytest.mark.parametrize(
    ("task", "field"),
    [
        (wait("A", duration=1, object_id="1"), "object_id"),
        (wait("A", duration=1, retries=2), "retries"),
        (wait("A", duration=3, limit=5), "wait.limit"),
        (measure("A", wait=WaitRule(duration=3)), "wait"),
        (measure("A", failure_target="A"), "failure_target"),
        (measure("A", window=TimeWindow(latest=9, hard=False, missed_target="A")), "window.missed"),
        (measure("A", window=TimeWindow(earliest=9, missed_target="A")), "window.missed"),
        (Task(name="A", action="WAYPOINT", pose=HERE, reading_limit=3), "reading_limit"),
        (measure("A", "A", when("A", ConditionType.FAILED, low=3)), "param1"),
    ],
)
def test_what_has_no_effect_is_named(task, field):
    (finding,) = check(Mission(tasks=(task,)))
    assert (finding.code, finding.severity) == ("il.unused-field", Severity.WARNING)
    assert field in finding.subject


@pytest.mark.rule("T10")
def test_joint_states_may_give_any_of_the_three():
    joints = JointState(names=["a", "b"], velocities=[1, 2])
    assert codes(chain(tasks=(measure("A", joint_states=joints),))) == []


LATE = TimeWindow(latest=60)


@pytest.mark.rule("W7")
@pytest.mark.parametrize(
    ("tasks", "groups", "circle"),
    [
        ((wait("A", "A", duration=0),), (), True),
        ((wait("A", "B", duration=0), wait("B", "A", duration=0)), (), True),
        ((wait("A", "B", duration=0), wait("B", "A", duration=1)), (), False),
        ((wait("A", "A", event="all_clear", limit=1e-9),), (), True),
        ((wait("A", "A", event="all_clear", limit=1),), (), False),
        ((wait("A", "B", duration=0), measure("B", "A")), (), False),
        ((wait("A", "B", duration=0), measure("B", "A", window=LATE)), (), True),
        (
            (
                wait("A", "B", duration=0),
                measure("B", "A", window=TimeWindow(latest=60, missed_target="C")),
                measure("C"),
            ),
            (),
            False,
        ),
        ((measure("A", window=LATE),), (group("G", "A", "A", 1000),), False),
        ((measure("A", window=LATE),), (group("G", "A", "A", 1001),), True),
        ((measure("A", window=LATE),), (group("G", "A", "A", 0, max_repeat_duration=9),), True),
        ((measure("A", window=LATE),), (group("G", "A", "A", 5000, every=9),), False),
        (
            (measure("A", window=LATE),),
            (group("G", "A", "A", 100), group("G/H", "A", "A", 100)),
            True,
        ),
    ],
)
def test_no_circle_takes_no_time(tasks, groups, circle):
    found = codes(Mission(tasks=tasks, groups=groups))
    assert ("il.instant-loop" in found) == circle


@pytest.mark.rule("G14")
def test_each_branch_that_leaves_a_round_is_named():
    leaving = (
        measure("A", "B", when("D")),
        measure("B", "C", on_failure="branch", failure_target="D"),
        measure("C", "D", window=TimeWindow(latest=9, missed_target="D")),
        measure("D"),
    )
    findings = check(chain(group("G", "A", "C", 3), tasks=leaving))
    assert [f.subject for f in findings if f.code == "il.leaves-round"] == [
        "tasks['A'].transitions[1].target",
        "tasks['B'].failure_target",
        "tasks['C'].window.missed_target",
    ]
    assert codes(chain(group("G", "A", "C", 3))) == []
    # A single round loses none, and an endless group has no other way out.
    assert "il.leaves-round" not in codes(chain(group("G", "A", "C", 1), tasks=leaving))
    assert "il.leaves-round" not in codes(chain(group("G", "A", "C", 0), tasks=leaving))


def test_the_end_of_an_inner_group_may_leave_the_outer_one():
    groups = (group("G", "A", "C", 3), group("G/H", "A", "B", 2))
    tasks = (measure("A", "B"), measure("B", "D"), measure("C", "D"), measure("D"))
    assert codes(chain(*groups, tasks=tasks)) == ["il.leaves-round"]


@pytest.mark.rule("G9")
def test_a_group_that_ends_by_a_condition_is_not_endless():
    until = (Condition(type="MEASURED_VALUE_LESS", object_id="1", param1=3),)
    assert codes(chain(group("G", "A", "C", 0, until=until))) == []
    assert codes(chain(group("G", "A", "C", 0))) == ["il.endless-group"]
    odd = (Condition(type="MEASURED_VALUE_LESS", object_id="9", param1=3),)
    assert codes(chain(group("G", "A", "C", 2, until=odd))) == ["il.never-measured"]


def test_rounds_follow_each_other_a_second_apart_at_least():
    assert codes(chain(group("G", "A", "C", 3, every=0.5))) == ["il.group-period"]
    assert codes(chain(group("G", "A", "C", 3, every=1))) == []


@pytest.mark.parametrize("field", ["every", "until"])
def test_what_one_round_does_not_need_is_named(field):
    value = {"every": 9.0, "until": (Condition(type="READING_FAILED", object_id="1"),)}[field]
    assert codes(chain(group("G", "A", "C", 1, **{field: value}))) == ["il.unused-field"]


def reactions(*pairs):
    return Mission(tasks=CHAIN, dock=HERE, reactions=[Reaction(**fields) for fields in pairs])


@pytest.mark.rule("R7")
@pytest.mark.parametrize(
    ("first", "second", "told"),
    [
        ({"priority": 1}, {"priority": 1}, True),
        ({"priority": 1}, {"priority": 2}, False),
        ({}, {}, False),
        ({"priority": 1}, {"priority": 1, "response": "report"}, False),
        ({"priority": 1}, {"priority": 1, "response": "abort"}, False),
        ({"priority": 1, "until": "hot_spot"}, {"priority": 1}, False),
    ],
)
def test_reactions_of_which_one_would_wait_are_named(first, second, told):
    mission = reactions(
        {"event": "gas_leak", "response": "return", **first},
        {"event": "hot_spot", "response": "pause", **second},
    )
    assert codes(mission) == (["il.equal-priority"] if told else [])


def test_a_reaction_may_return_to_a_dock_of_its_own():
    own = {"event": "gas_leak", "response": "return", "pose": HERE, "area": 2}
    assert codes(Mission(tasks=CHAIN, reactions=[Reaction(**own)])) == []
    assert codes(reactions({"event": "gas_leak", "response": "return", "area": 2})) == [
        "il.unused-field"
    ]


@pytest.mark.parametrize(
    "fields",
    [
        {"response": "return", "hold_limit": 3},
        {"response": "abort", "hold_limit": 3},
        {"response": "pause", "on_limit": "end"},
    ],
)
def test_limits_of_holds_that_are_not_there_are_named(fields):
    assert codes(reactions({"event": "gas_leak", **fields})) == ["il.unused-field"]
