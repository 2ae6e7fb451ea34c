"""Missions whose loops or whose end depend on failures: each statement is true, and there is one.

The statements of the analysis are compared with runs of the executor.
"""

import re

import pytest
from hypothesis import HealthCheck, assume, event, given, settings
from hypothesis import strategies as st

from argo_compiler.analysis import analyse
from argo_compiler.base.catalog import Area, Catalog
from argo_compiler.base.model import Pose
from argo_compiler.checks import check
from argo_compiler.diagnostics import Severity, has_errors
from argo_compiler.hfsm import lower
from argo_compiler.il import (
    Action,
    EventKind,
    Group,
    Mission,
    OnFailure,
    Reaction,
    Response,
    Task,
    TimeWindow,
    Transition,
    WaitRule,
)
from tests.argo_compiler.analysis.building import ConstantTravel, mission, task
from tests.argo_compiler.analysis.test_soundness import steps_of
from tests.argo_compiler.analysis.worlds import MadeUpTravel, run
from tests.conftest import examples
from tests.mission_parts import HERE

CATALOG = Catalog(site="m", checkpoints=(), areas=(Area(number=1, dock=HERE),), floors=())
BRANCH = {"on_failure": OnFailure.BRANCH, "failure_target": "C"}
ENDINGS = {
    "branch": BRANCH,
    "abort": {"on_failure": OnFailure.ABORT},
    "return": {"on_failure": OnFailure.RETURN},
}
ABORT_AT_TIME = Reaction(event=EventKind.TIME_UP, response=Response.ABORT)


def made(*tasks, **fields):
    return mission(*tasks, dock=HERE, **fields)


def findings(plan, travel=None):
    return {
        d.code.removeprefix("analysis."): d
        for d in analyse(plan, CATALOG, travel or ConstantTravel(battery=None)).diagnostics
    }


def run_of(plan):
    return run(plan, lower(plan), CATALOG, ConstantTravel(), 1)


@pytest.mark.parametrize("ending", ENDINGS)
@pytest.mark.parametrize("optional", [False, True])
def test_a_loop_that_ends_by_a_time_limit_is_not_called_endless(ending, optional):
    """A drive takes 10 s, so B always fails, and with it the loop ends."""
    loop = task("B", "A", time_limit=1, optional=optional, **ENDINGS[ending])
    plan = made(task("A", "B"), loop, task("C"))
    found = findings(plan)
    found.pop("unreachable-task", None)  # C, if no branch leads there
    assert set(found) == {"time-limit"}
    message = found["time-limit"].message
    assert "so it fails if nothing interrupts it" in message
    assert "without a failure, the loop of tasks 'A' and 'B' and the mission would never" in message
    done = run_of(plan)
    assert done.finished
    assert any(ended.task == "B" and ended.failure for ended in done.executor.ended)


def test_an_endless_group_that_ends_by_a_time_limit():
    group = Group(name="G", start="A", end="B")
    plan = made(task("A", "B"), task("B", "C", time_limit=1, **BRANCH), "C", groups=(group,))
    assert set(findings(plan)) == {"time-limit"}
    assert run_of(plan).finished


def test_a_loop_behind_a_task_that_always_fails():
    plan = made(task("B", "D", time_limit=1, **BRANCH), task("C"), task("D", "D"))
    found = findings(plan)
    assert set(found) == {"time-limit"}
    assert "without a failure, the mission would never end" in found["time-limit"].message
    assert run_of(plan).finished


def test_a_time_limit_that_suffices_ends_nothing():
    plan = made(task("A", "B"), task("B", "A", time_limit=11, **BRANCH), task("C"))
    found = findings(plan)
    assert set(found) == {"endless-loop"}
    assert "nothing but a failure or a person ends the loop, and so the mission" in (
        found["endless-loop"].message
    )
    assert found["endless-loop"].severity is Severity.ERROR
    assert not run_of(plan).finished


def test_a_failure_that_leads_on_in_the_loop_ends_nothing():
    plan = made(task("A", "B"), task("B", "A", time_limit=1))
    found = findings(plan)
    assert set(found) == {"endless-loop", "time-limit"}
    assert "nothing but a person ends the loop, and so the mission" in found["endless-loop"].message
    assert "without a failure" not in found["time-limit"].message
    assert not run_of(plan).finished


def test_a_task_that_a_failure_brings_nearer_is_not_said_to_fail():
    """After B has failed, the robot is on its way, and D may be done in time."""
    plan = made(task("B", "D", time_limit=8), task("D", time_limit=9))
    messages = [d.message for d in analyse(plan, CATALOG, ConstantTravel()).diagnostics]
    assert any("'B'" in m and "so it fails" in m for m in messages)
    assert any("'D'" in m and "so it can't be done as planned" in m for m in messages)


WINDOW = TimeWindow(earliest=0, latest=60, hard=True)


@pytest.mark.parametrize("ending", ["missed", *ENDINGS])
def test_a_loop_that_ends_when_a_window_closes_has_a_limit(ending):
    fields = ENDINGS.get(ending, {})
    window = WINDOW.model_copy(update={"missed_target": "C" if ending == "missed" else None})
    plan = made(task("A", "B"), task("B", "A", window=window, **fields), task("C"))
    found = findings(plan, ConstantTravel(battery=5.0))
    found.pop("unreachable-task", None)
    assert set(found) == {"loop-until-window", "battery-maybe-exceeded"}
    assert "until the window of task 'B' closes, 1 min after" in found["loop-until-window"].message
    assert "without limit" not in found["battery-maybe-exceeded"].message
    done = run_of(plan)
    assert done.finished
    assert 60 <= done.now <= 90


def test_a_group_that_ends_when_a_window_closes():
    window = WINDOW.model_copy(update={"missed_target": "C"})
    group = Group(name="G", start="A", end="B")
    plan = made(task("A", "B"), task("B", "C", window=window), "C", groups=(group,), max_duration=9)
    found = findings(plan)
    assert set(found) == {"loop-until-window", "too-long"}
    assert found["loop-until-window"].message.startswith("group 'G' may be repeated until")


def test_a_window_in_a_loop_that_goes_on_without_it_ends_nothing():
    plan = made(task("A", "B"), task("B", "A", window=WINDOW), task("C"))
    found = findings(plan)
    assert {"endless-loop"} <= set(found)
    assert "loop-until-window" not in found
    assert not run_of(plan).finished


def test_a_wait_that_may_end_in_time_does_not_limit_the_loop():
    wait = Task(
        name="W",
        action=Action.WAIT,
        wait=WaitRule(event=EventKind.ALL_CLEAR, limit=5),
        transitions=(Transition(target="A"),),
        **BRANCH,
    )
    found = findings(made(task("A", "W"), wait, task("C")))
    assert set(found) == {"unbounded-loop"}
    assert "they can be left" in found["unbounded-loop"].message


def test_the_reaction_to_time_up_ends_a_loop():
    loop = (task("A", "B"), task("B", "A"))
    plan = made(*loop, reactions=(ABORT_AT_TIME,), max_duration=100)
    found = findings(plan)
    assert set(found) == {"endless-loop"}
    assert "nothing but the reaction to time_up, after 1 min 40 s, or a person" in (
        found["endless-loop"].message
    )
    assert found["endless-loop"].severity is Severity.WARNING
    assert run_of(plan).now == 100


def test_two_loops_without_an_exit():
    plan = made(
        Task(
            name="A",
            action=Action.WAIT,
            wait=WaitRule(event=EventKind.ALL_CLEAR, limit=5),
            on_failure=OnFailure.BRANCH,
            failure_target="C",
            transitions=(Transition(target="B"),),
        ),
        task("B", "B"),
        task("C", "C"),
    )
    codes = [d.code for d in analyse(plan, CATALOG, None).diagnostics]
    assert codes.count("analysis.endless-loop") == 2
    assert codes.count("analysis.no-end") == 1


def test_a_group_that_only_an_abort_ends_is_refused_with_the_truth():
    group = Group(name="G", start="A", end="B")
    plan = made(task("A", "B"), task("B", time_limit=1, **ENDINGS["abort"]), groups=(group,))
    (found,) = [d for d in check(plan) if d.code == "il.endless-group"]
    assert "without end unless a task fails" in found.message


CLOSES = 9
WINDOWED = re.compile("'([^']+)'")


@st.composite
def looping_missions(draw):
    """Draw missions with loops that failures, windows and limits of waits may leave."""
    size = draw(st.integers(2, 5))
    names = [f"T{i}" for i in range(size)]
    tasks = []
    for i, name in enumerate(names):
        policy = draw(st.sampled_from(OnFailure))
        following = draw(st.sampled_from([*names, names[(i + 1) % size], None]))
        missed = draw(st.sampled_from([None, *names]))
        fields = {
            "transitions": () if following is None else (Transition(target=following),),
            "on_failure": policy,
            "failure_target": draw(st.sampled_from(names)) if policy is OnFailure.BRANCH else None,
            "optional": draw(st.booleans()),
            "window": draw(
                st.sampled_from(
                    [None, None, TimeWindow(latest=CLOSES, hard=True, missed_target=missed)]
                )
            ),
        }
        if draw(st.integers(0, 4)) == 0:
            rule = draw(
                st.sampled_from([WaitRule(duration=1), WaitRule(event="all_clear", limit=3)])
            )
            tasks.append(Task(name=name, action=Action.WAIT, wait=rule, **fields))
            continue
        tasks.append(
            Task(
                name=name,
                action=Action.WAYPOINT,
                pose=Pose(x=i + 1, y=0, z=0),
                time_limit=draw(st.sampled_from([None, 0.5, 0.5, 1.5, 3.5, 50])),
                retries=draw(st.sampled_from([0, 0, 0, 1])),
                **fields,
            )
        )
    groups = ()
    if draw(st.booleans()):
        first = draw(st.integers(0, size - 1))
        last = draw(st.integers(first, size - 1))
        duration = draw(st.sampled_from([0, 0, 6]))
        groups = (
            Group(name="G", start=names[first], end=names[last], max_repeat_duration=duration),
        )
    ends = draw(st.booleans())
    return Mission(
        tasks=tuple(tasks),
        groups=groups,
        dock=HERE,
        reactions=(ABORT_AT_TIME,) if ends else (),
        max_duration=draw(st.sampled_from([None, 20])) if ends else None,
    )


def require_true(found, done):
    """Require that what the analysis states about failures and ends is true of a run.

    In the run nothing fails but by its limits and windows, and no event occurs but what is awaited.
    """
    executor = done.executor
    for d in found:
        code = d.code.removeprefix("analysis.")
        if code == "time-limit" and "so it fails" in d.message:
            left = [e for e in steps_of(done) if d.subject == f"tasks['{e.source}']"]
            assert all(entry.failure for entry in left), d
            event(f"fails for certain: {bool(left)}")
        if code == "loop-until-window":
            windowed = WINDOWED.findall(d.message.partition(" until ")[2])
            late = [e.source for e in steps_of(done) if e.source in windowed and e.time > CLOSES]
            assert len(late) == len(set(late)), d
            event(f"ends by its window: {bool(late)}")
        if code == "no-end" or (code == "endless-loop" and "so the mission" in d.message):
            by_time = "time_up" in d.message or "reaction" in d.message
            by_failure = "a failure" in d.message or "an action fails" in d.message
            failed = any(visit.failure for visit in executor.ended)
            assert (
                not done.finished
                or (by_time and executor.outcome == "aborted")
                or (by_failure and failed)
            ), d
            event(f"never ends: {not done.finished}")


@settings(
    max_examples=examples(200),
    suppress_health_check=[HealthCheck.filter_too_much, HealthCheck.too_slow],
)
@given(looping_missions(), st.integers(0, 10**6))
@pytest.mark.rule("T8", "T9", "W3", "W5")
def test_what_is_said_of_failures_and_ends_is_true_of_runs(plan, seed):
    assume(not has_errors(check(plan)))
    travel = MadeUpTravel(seed)
    travel.battery = None
    found = analyse(plan, CATALOG, travel).diagnostics
    hfsm = lower(plan)
    for k in range(3):
        require_true(found, run(plan, hfsm, CATALOG, travel, seed + k, steps=60))
    # One statement per fact: what ends by a sure failure is not called endless, and the other way.
    sure = [d for d in found if "without a failure" in d.message and "the mission" in d.message]
    codes = [d.code for d in found]
    assert not (sure and "analysis.no-end" in codes)
    assert not (sure and any("so the mission" in d.message for d in found))
    loops = [d for d in found if d.code == "analysis.endless-loop"]
    assert not (len(loops) == 1 and "analysis.no-end" in codes)
