"""Verdicts on transitions in cases with known answers."""

import pytest

from argo_compiler.analysis import Verdict, analyse
from argo_compiler.il import (
    Condition,
    ConditionType,
    Group,
    OnFailure,
    TimeWindow,
    Transition,
)
from tests.argo_compiler.analysis.building import CATALOG, mission, task, transition
from tests.mission_writing import checkpoint, wait

NEVER, AFTER, POSSIBLE, ALWAYS = (
    Verdict.NEVER,
    Verdict.AFTER_FAILURE,
    Verdict.POSSIBLE,
    Verdict.ALWAYS,
)


def analyse_tasks(*tasks, **more):
    """Return the analysis of a mission with the catalogue."""
    return analyse(mission(*tasks, **more), CATALOG)


def codes(analysis):
    return sorted(d.code.removeprefix("analysis.") for d in analysis.diagnostics)


def verdicts(analysis, name):
    return [t.verdict for t in analysis.task_facts(name).transitions]


@pytest.mark.parametrize(
    ("tests", "expected"),
    [
        ([["1 > 12"]], [NEVER, ALWAYS]),
        ([["1 > 10"]], [NEVER, ALWAYS]),
        ([["1 >= 10"]], [POSSIBLE, POSSIBLE]),
        ([["1 < 0"]], [NEVER, ALWAYS]),
        ([["1 <= 0"]], [POSSIBLE, POSSIBLE]),
        ([["1 < 11"]], [ALWAYS, AFTER]),
        ([["1 >= 0"]], [ALWAYS, AFTER]),
        ([["1 > 0"]], [POSSIBLE, POSSIBLE]),
        ([["0 < 1 < 10"]], [POSSIBLE, POSSIBLE]),
        ([["0 <= 1 <= 10"]], [ALWAYS, AFTER]),
        ([["-5 < 1 < 0"]], [NEVER, ALWAYS]),
        ([["1 < 5"], ["1 >= 5"]], [POSSIBLE, ALWAYS, AFTER]),
        ([["1 < 5"], ["1 > 5"]], [POSSIBLE, POSSIBLE, POSSIBLE]),
        ([["1 < 5"], ["1 < 3"]], [POSSIBLE, NEVER, POSSIBLE]),
        ([["1 < 5"], ["2 < 1 < 7"]], [POSSIBLE, POSSIBLE, POSSIBLE]),
        ([["1 < 5"], ["1 < 8"], ["5 <= 1 <= 7"]], [POSSIBLE, POSSIBLE, NEVER, POSSIBLE]),
        ([["1 < 3", "1 > 5"]], [NEVER, ALWAYS]),
        ([["1 < 6", "1 > 5"]], [POSSIBLE, POSSIBLE]),
        ([["2 < 6"]], [POSSIBLE, POSSIBLE]),
        ([["1 < 6", "2 < 6"]], [POSSIBLE, POSSIBLE]),
    ],
)
def test_transitions_of_the_task_that_measures(tests, expected):
    ways = [transition("B", *texts) for texts in tests]
    analysis = analyse_tasks(task("Am1", *ways, "C"), "B", "C")
    assert verdicts(analysis, "Am1") == expected
    if NEVER in expected and "2 < 6" not in str(tests):
        assert "transition-never" in codes(analysis)


def test_without_a_catalogue_a_checkpoint_may_show_anything():
    analysis = analyse(mission(task("Am1", transition("B", "1 > 12"), "C"), "B", "C"))
    assert verdicts(analysis, "Am1") == [POSSIBLE, POSSIBLE]


def test_a_value_is_known_along_the_path():
    analysis = analyse_tasks(
        task("Am1", transition("Low", "1 < 5"), "High"),
        task("Low", transition("Never", "1 > 6"), transition("Join", "1 < 5"), "Never"),
        task("High", transition("Never", "1 < 5"), "Join"),
        task("Never", "Join"),
        task("Join", transition("Am1", "1 > 9"), "End"),
        "End",
    )
    assert verdicts(analysis, "Low") == [NEVER, ALWAYS, NEVER]
    # If the measurement failed there is no value, and no condition holds.
    assert verdicts(analysis, "High") == [NEVER, ALWAYS]
    assert analysis.task_facts("Never").verdict is NEVER
    assert verdicts(analysis, "Join") == [POSSIBLE, POSSIBLE]


def test_measuring_again_forgets_the_old_value():
    again = [
        task("Am1", transition("B", "1 < 5"), "End"),
        "B",
        task("Cm1", transition("Am1", "1 > 6"), "End"),
        "End",
    ]
    assert verdicts(analyse_tasks(*again), "Cm1") == [POSSIBLE, POSSIBLE]


def test_an_old_value_may_be_too_old_for_any_verdict_but_never():
    old = mission(
        task("Am1", transition("Low", "1 < 5"), "Low2"),
        task(
            "Low",
            transition("End", "1 < 5", max_age=20),
            transition("End", "1 > 5", max_age=20),
            "End",
        ),
        task("Low2", "End"),
        "End",
    )
    assert verdicts(analyse(old, CATALOG), "Low") == [POSSIBLE, NEVER, POSSIBLE]


def test_what_only_a_failure_leads_to():
    analysis = analyse_tasks(
        task("Am1", transition("Low", "1 < 5"), transition("High", "1 >= 5"), "Broken"),
        task("Low"),
        task("High"),
        task("Broken", transition("Low", "1 < 20")),
    )
    assert analysis.task_facts("Broken").verdict is AFTER
    assert verdicts(analysis, "Broken") == [NEVER]
    assert analysis.task_facts("Low").verdict is POSSIBLE


def test_after_an_abort_nothing_follows():
    aborts = task(
        "Am1", transition("Low", "1 < 5"), transition("Low", "1 >= 5"), on_failure=OnFailure.ABORT
    )
    assert analyse_tasks(aborts, "Low").ends is POSSIBLE


def test_why_a_task_is_unreachable():
    found = analyse_tasks(
        task("Am1", transition("X", "1 > 12"), transition("Y", "2 > 1"), "End"),
        task("X", "Behind"),
        task("Y", "End"),
        task("Behind", "End"),
        task("Alone", "End"),
        task("End", "Lastm2"),
        "Lastm2",
    )
    lost = {d.subject: d for d in found.diagnostics if d.code == "analysis.unreachable-task"}
    assert found.reachable == {"Am1", "End", "Lastm2"}
    assert sorted(lost) == [f"tasks['{name}']" for name in ("Alone", "Behind", "X", "Y")]
    assert "checkpoint 1 (valve R1) shows 0 to 10" in lost["tasks['X']"].message
    assert "no path measures it before" in lost["tasks['Y']"].message
    assert "only 'X' leads to it" in lost["tasks['Behind']"].message
    assert "no transition leads to it" in lost["tasks['Alone']"].message
    assert all(d.hint for d in found.diagnostics)


def test_transitions_that_are_never_and_always_taken_are_reported():
    found = analyse_tasks(task("Am1", transition("B", "1 < 4"), transition("B", "1 < 3"), "B"), "B")
    assert codes(found) == ["transition-never"]
    assert found.diagnostics[0].subject == "tasks['Am1'].transitions[1]"
    assert "can only be 4 to 10 here" in found.diagnostics[0].message
    found = analyse_tasks(task("Am1", transition("B", "1 < 11"), "B"), "B")
    assert codes(found) == ["transition-always"]
    complete = task("Am1", transition("B", "1 < 5"), transition("B", "1 >= 5"), "B")
    assert codes(analyse_tasks(complete, "B")) == []


def test_values_that_are_compared_before_they_are_measured():
    found = analyse_tasks(
        task("Am1", transition("Bm2", "1 < 5"), "C"),
        "Bm2",
        task("C", transition("End", "2 < 5"), transition("End", "3 < 5"), "Dm3"),
        "Dm3",
        "End",
    )
    assert codes(found) == ["maybe-unmeasured", "never-measured"]
    maybe, never = sorted(found.diagnostics, key=lambda d: d.code)
    assert "such as Am1 > C" in maybe.message
    assert maybe.subject == "tasks['C'].transitions[0]"
    assert never.subject == "tasks['C'].transitions[1]"


@pytest.mark.parametrize(
    ("group", "repeats", "ends"),
    [
        ({"max_repeat_count": 1}, NEVER, POSSIBLE),
        ({"max_repeat_count": 2}, POSSIBLE, POSSIBLE),
        ({"max_repeat_duration": 5}, POSSIBLE, POSSIBLE),
        ({}, POSSIBLE, NEVER),
    ],
)
def test_rounds_of_a_group(group, repeats, ends):
    found = analyse_tasks(
        "A",
        task("Bm1", transition("Out", "1 > 5"), "C"),
        task("C", "End"),
        "Out",
        "End",
        groups=[Group(name="G", start="A", end="C", **group)],
    )
    facts = found.groups[0]
    assert (facts.repeats, facts.ends) == (repeats, ends)
    assert verdicts(found, "C") == [NEVER if ends is NEVER else POSSIBLE]


def on_reading(kind, target, object_id="1", **more):
    return Transition(
        target=target, conditions=(Condition(type=kind, object_id=object_id, **more),)
    )


@pytest.mark.parametrize("kind", [ConditionType.FAILED, ConditionType.UNREADABLE])
@pytest.mark.rule("C3", "C7")
def test_a_reading_fails_only_after_a_failure(kind):
    analysis = analyse_tasks(task("Am1", on_reading(kind, "B"), "C"), "B", "C")
    assert verdicts(analysis, "Am1") == [AFTER, ALWAYS]
    unmeasured = analyse_tasks("X", task("A", on_reading(kind, "B"), "C"), "B", "C")
    assert verdicts(unmeasured, "A") == [NEVER, ALWAYS]


@pytest.mark.rule("C4")
def test_a_failed_measurement_leaves_nothing_of_the_value_before():
    high = task("Am1", transition("Bm1", "1 > 5"), "End")
    again = task("Bm1", on_reading(ConditionType.FAILED, "Known"), "End")
    known = task("Known", transition("Never", "1 > 5"), "End")
    analysis = analyse_tasks(high, again, known, "Never", "End")
    assert verdicts(analysis, "Known") == [NEVER, AFTER]


@pytest.mark.rule("W5", "C3")
def test_a_missed_window_leaves_a_failed_reading():
    late = task("Am1", on_reading(ConditionType.FAILED, "B"), "C", window=TimeWindow(latest=5))
    assert verdicts(analyse_tasks(late, "B", "C"), "Am1") == [POSSIBLE, POSSIBLE]


@pytest.mark.rule("C7")
def test_what_is_abnormal_lies_outside_the_nominal_range():
    narrow = CATALOG.model_copy(update={"checkpoints": (checkpoint(1, 0, 10, 2, 8),)})
    odd = on_reading(ConditionType.ABNORMAL, "Odd")
    plan = mission(task("Am1", odd, "End"), task("Odd", transition("X", "2 <= 1 <= 8")), "X", "End")
    analysis = analyse(plan, narrow)
    assert verdicts(analysis, "Am1") == [POSSIBLE, POSSIBLE]
    assert verdicts(analysis, "Odd") == [NEVER]
    # Here all values that the checkpoint can show are normal.
    assert verdicts(analyse(plan, CATALOG), "Am1") == [NEVER, ALWAYS]


@pytest.mark.rule("C7")
def test_a_value_that_was_just_read_is_not_stale():
    stale = on_reading(ConditionType.STALE, "B", max_age=5)
    analysis = analyse_tasks(task("Am1", stale, "C"), "B", "C")
    assert verdicts(analysis, "Am1")[0] is not POSSIBLE
    later = analyse_tasks("Am1", task("A", stale, "C"), "B", "C")
    assert verdicts(later, "A") == [POSSIBLE, POSSIBLE]


@pytest.mark.rule("W2", "C8")
def test_a_value_that_is_waited_for_may_come_at_any_time():
    stand = wait("W", "B", conditions=transition("x", "2 > 5").conditions)
    plan = mission(
        task("Am1", transition("B", "2 < 3"), "W"), stand, task("B", transition("C", "2 < 3")), "C"
    )
    analysis = analyse(plan, CATALOG)
    assert verdicts(analysis, "Am1") == [POSSIBLE, POSSIBLE]
    assert verdicts(analysis, "B") == [POSSIBLE]


@pytest.mark.rule("C8")
def test_a_value_that_no_task_measures_may_be_reported_at_any_time():
    plan = mission(
        "A", task("B", transition("C", "2 > 5"), transition("C", "2 > 12"), "End"), "C", "End"
    )
    analysis = analyse(plan, CATALOG)
    assert verdicts(analysis, "B") == [POSSIBLE, NEVER, POSSIBLE]
    assert "C" in analysis.reachable
    assert analysis.diagnostics == ()
    rounds = Group(name="G", start="A", end="B", until=transition("x", "2 > 5").conditions)
    group = analyse_tasks("A", "B", "C", groups=(rounds,)).groups[0]
    assert (group.repeats, group.ends) == (POSSIBLE, POSSIBLE)


@pytest.mark.rule("I3")
def test_a_value_may_come_late_while_a_wait_is_already_over():
    """The cancelled action may still succeed after the WAIT has evaluated its conditions."""
    join = wait("J", transition("Low", "1 < 3"), "High", duration=0)
    late = task("Bm1", "End", window=TimeWindow(latest=5, missed_target="J"))
    plan = mission("Am1", late, join, task("Low", transition("High", "1 > 6")), "High", "End")
    assert verdicts(analyse(plan, CATALOG), "Low") == [POSSIBLE]


@pytest.mark.rule("G8")
def test_after_rounds_until_a_value_the_value_is_known():
    rounds = Group(name="G", start="Am1", end="B", until=transition("x", "1 > 5").conditions)
    leave = task("B", "C")
    plan = mission("Am1", leave, task("C", transition("D", "1 < 5")), "D", groups=(rounds,))
    assert verdicts(analyse(plan, CATALOG), "C") == [NEVER]
    counted = rounds.model_copy(update={"max_repeat_count": 3})
    assert verdicts(analyse(plan.model_copy(update={"groups": (counted,)}), CATALOG), "C") == [
        POSSIBLE
    ]
