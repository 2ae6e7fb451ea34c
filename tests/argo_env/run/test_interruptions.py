"""Pauses, reactions and cancellations of a mission: the robot's behaviour, and the record."""

import math
import re
from collections import Counter
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.base.model import Pose
from argo_compiler.hfsm import Cancel, Occurred, Outcome, Pause, Resume
from argo_compiler.il import Afterwards, EventKind, Group, OnFailure, Response
from argo_env.formatting import min_sec_text
from argo_env.report import write_report
from argo_env.report.rounds import all_waits
from argo_env.run.record import RunRecord
from argo_env.run.spec import logged_events
from argo_env.run.verdict_line import Tone
from tests.argo_env.run.test_actions import foggy
from tests.conftest import examples
from tests.mission_writing import reaction as react
from tests.yard import fast_setup, measure, mission, run, run_with, simulated, waypoint

DOCK = Pose(x=1.05, y=1.05, z=0.02)
SHELTER = Pose(x=3.05, y=1.55, z=0.02)
NOWHERE = Pose(x=30.0, y=30.0, z=0.02)


def outcomes_of_tasks(record):
    return [(t.task, t.outcome) for t in record.tasks]


def position_at(record, t):
    sample = min(record.path, key=lambda s: abs(s.t - t))
    return sample.x, sample.y


MEASURE = mission(measure(1))


@pytest.fixture(scope="module")
def arrival(yard):
    """Return the time in s at which the robot has arrived at the first checkpoint."""
    record = run(yard, MEASURE)
    return record.result.duration - yard.robot.sensor.measuring_time


class TestCleanUp:
    def test_while_driving_the_robot_comes_to_rest(self, yard):
        record = run(yard, MEASURE, (3.0, Cancel()))
        (task,) = record.tasks
        assert (task.outcome, task.end) == ("cancelled", pytest.approx(3.1))
        assert record.result.outcome is Outcome.CANCELLED
        assert record.result.duration == task.end

    @pytest.mark.parametrize(
        ("after", "takes"), [(1.0, 1.0), (2.0, 2.0), (3.0, 8 / 3), (5.0, 8 / 3)]
    )
    def test_an_arm_that_is_raised_is_stowed(self, yard, arrival, after, takes):
        record = run(yard, MEASURE, (arrival + after, Cancel()))
        (task,) = record.tasks
        assert (task.outcome, record.readings) == ("cancelled", ())
        assert task.end - (arrival + after) == pytest.approx(takes, abs=0.11)

    @pytest.mark.parametrize("after", [5.5, 7.0, 7.9])
    def test_a_value_that_has_been_seen_counts(self, yard, arrival, after):
        record = run(yard, MEASURE, (arrival + after, Cancel()))
        assert outcomes_of_tasks(record) == [("MEASURE 1", "done")]
        assert [r.value for r in record.readings] == [2.5]
        assert record.result.outcome is Outcome.CANCELLED
        assert record.result.duration == pytest.approx(arrival + 8.0)

    def test_only_then_the_next_action_begins(self, yard, arrival):
        plan = mission(
            measure(1), reactions=(react(EventKind.GAS_LEAK, Response.SAFE_AREA, pose=SHELTER),)
        )
        setup = fast_setup(yard)
        events = ((arrival + 4.0, Occurred(EventKind.GAS_LEAK)),)
        record = run_with(plan, setup, events=logged_events(*events))
        first, second = record.tasks
        assert first.outcome == "interrupted"
        assert second.start == first.end
        assert first.end == pytest.approx(arrival + 4.0 + 8 / 3, abs=0.11)
        stowed, raised = yard.robot.arm_stowed, yard.robot.arm_raised
        assert setup.world.arm[:2] == [raised, stowed]


class TestPersons:
    def test_pause_and_resume(self, yard):
        record = run(yard, MEASURE, (3.0, Pause()), (20.0, Resume()))
        assert outcomes_of_tasks(record) == [("MEASURE 1", "interrupted"), ("MEASURE 1", "done")]
        assert record.tasks[0].reason == "the mission is paused"
        assert record.tasks[1].start == 20.0
        (interruption,) = record.interruptions
        assert (interruption.start, interruption.end, interruption.event) == (3.0, 20.0, None)
        assert position_at(record, 4.0) == position_at(record, 19.5)
        assert record.result.success
        causes = [step.cause for step in record.trace]
        assert any("pause" in c for c in causes)
        assert any("resume" in c for c in causes)

    def test_nobody_resumes(self, yard):
        record = run(yard, MEASURE, (3.0, Pause()))
        assert record.result.outcome is None
        assert not record.result.success
        assert "paused, and nothing more occurs" in record.result.verdict
        assert record.result.duration < 10.0

    def test_events_at_the_beginning(self, yard):
        record = run(yard, MEASURE, (0.0, Pause()), (0.0, Resume()), (0.05, Pause()), (5, Resume()))
        assert record.result.success
        assert record.tasks[-1].start == 5.0


class TestReactions:
    def test_to_a_safe_area_and_on(self, yard):
        shelter = react(
            EventKind.GAS_LEAK, Response.SAFE_AREA, pose=SHELTER, until=EventKind.ALL_CLEAR,
            afterwards=Afterwards.RESUME,
        )  # fmt: skip
        plan = mission(measure(1), waypoint("A", 4.05, 2.05), reactions=(shelter,))
        record = run(
            yard, plan, (4.0, Occurred(EventKind.GAS_LEAK, "a hiss")),
            (60.0, Occurred(EventKind.ALL_CLEAR)),
        )  # fmt: skip
        assert outcomes_of_tasks(record) == [
            ("MEASURE 1", "interrupted"), ("react to gas_leak", "done"), ("MEASURE 1", "done"),
            ("A", "done"),
        ]  # fmt: skip
        assert math.dist(position_at(record, 50.0), (SHELTER.x, SHELTER.y)) < 0.1
        assert record.tasks[2].start == 60.0
        (interruption,) = record.interruptions
        assert (interruption.start, interruption.end) == (4.0, 60.0)
        assert interruption.event is EventKind.GAS_LEAK
        assert record.result.success
        assert any("a hiss" in step.cause for step in record.trace)

    @pytest.mark.parametrize(
        ("reaction", "outcome", "says"),
        [
            (react(EventKind.HOT_SPOT, Response.ABORT), Outcome.ABORTED, "ended the mission"),
            (react(EventKind.HOT_SPOT, Response.RETURN), Outcome.RETURNED, "returned to its dock"),
            (
                react(EventKind.HOT_SPOT, Response.SAFE_AREA, pose=SHELTER),
                Outcome.SHELTERED,
                "went to a safe area",
            ),
            (
                react(EventKind.HOT_SPOT, Response.SAFE_AREA, pose=NOWHERE),
                Outcome.FAILED,
                "failed: react to hot_spot",
            ),
        ],
    )
    def test_that_end_the_mission(self, yard, tmp_path, reaction, outcome, says):
        plan = mission(measure(1), reactions=(reaction,), dock=DOCK, end_area=1)
        record = run(yard, plan, (4.0, Occurred(EventKind.HOT_SPOT)))
        assert record.result.outcome is outcome
        assert not record.result.success
        assert says in record.result.verdict
        assert record.result.docked is (outcome is Outcome.RETURNED)
        text = record.model_dump_json()
        assert RunRecord.model_validate_json(text) == record
        page = write_report(record, yard.site, tmp_path).read_text(encoding="utf-8")
        assert says in page
        assert "reaction: hot spot" in page

    @pytest.mark.parametrize("then", [Afterwards.END, Afterwards.WAIT, Afterwards.RESUME])
    def test_a_hold_that_its_limit_ended_is_told_so(self, yard, then):
        hold = react(
            EventKind.GAS_LEAK, Response.PAUSE, until=EventKind.ALL_CLEAR,
            afterwards=Afterwards.RESUME, hold_limit=20.0, on_limit=then,
        )  # fmt: skip
        plan = mission(measure(1), reactions=(hold,))
        record = run(yard, plan, (4.0, Occurred(EventKind.GAS_LEAK)))
        end = record.interruptions[0].end
        assert record.interruptions[0].limit_over
        assert (
            all_waits(record)[0].outcome == f"the limit of the hold was over at {min_sec_text(end)}"
        )
        cleared = (10.0, Occurred(EventKind.ALL_CLEAR))
        record = run(yard, plan, (4.0, Occurred(EventKind.GAS_LEAK)), cleared)
        assert [w.outcome for w in all_waits(record)] == ["over"]

    def test_report_interrupts_nothing(self, yard):
        plan = mission(measure(1), reactions=(react(EventKind.HOT_SPOT, Response.REPORT),))
        record = run(yard, plan, (4.0, Occurred(EventKind.HOT_SPOT)))
        plain = run(yard, plan)
        assert record.tasks == plain.tasks
        assert record.path == plain.path
        assert any("hot spot" in step.cause and step.t == 4.0 for step in record.trace)
        assert record.interruptions == ()

    @pytest.mark.parametrize("value", [5.5, 1.0])
    def test_to_an_abnormal_reading(self, yard, value):
        pause = react(EventKind.ABNORMAL_READING, Response.PAUSE)
        plan = mission(measure(1), measure(2), reactions=(pause,))
        record = run(yard, plan, (90.0, Resume()), values={1: value})
        assert outcomes_of_tasks(record) == [("MEASURE 1", "done"), ("MEASURE 2", "done")]
        assert [(r.value, r.normal) for r in record.readings] == [(value, False), (3.5, True)]
        assert record.tasks[1].start == 90.0
        (interruption,) = record.interruptions
        assert interruption.start == record.readings[0].t
        assert any(f"gauge 1 shows {value:g} bar" in step.cause for step in record.trace)

    def test_a_normal_reading_is_no_event(self, yard):
        abort = react(EventKind.ABNORMAL_READING, Response.ABORT)
        assert run(yard, mission(measure(1), reactions=(abort,))).result.success

    def test_an_abnormal_reading_without_a_reaction_is_reported(self, yard):
        record = run(yard, MEASURE, values={1: 9.0})
        assert record.result.success
        assert any("abnormal reading" in step.cause for step in record.trace)

    def test_when_the_time_is_up(self, yard):
        back = react(EventKind.TIME_UP, Response.RETURN)
        plan = mission(measure(1), measure(2), reactions=(back,), dock=DOCK, max_duration=20.0)
        record = run(yard, plan)
        assert outcomes_of_tasks(record) == [
            ("MEASURE 1", "done"), ("MEASURE 2", "interrupted"), ("react to time_up", "done"),
        ]  # fmt: skip
        assert record.interruptions[0].start == 20.0
        assert record.result.outcome is Outcome.RETURNED
        assert "of at most 20 s" in record.result.verdict

    def test_velocity_of_the_way_after_an_interruption(self, yard):
        """The path still leads to the same task, and a reaction drives at the planning speed."""
        shelter = react(
            EventKind.GAS_LEAK, Response.SAFE_AREA, pose=SHELTER, afterwards=Afterwards.RESUME
        )
        a, b = waypoint("A", 3.05, 2.05, velocity=0.2), waypoint("B", 4.55, 2.05, velocity=0.3)
        plan = mission(a, b, waypoint("C", 2.05, 2.05), reactions=(shelter,))
        setup = fast_setup(yard)
        run_with(plan, setup, events=logged_events((16.0, Occurred(EventKind.GAS_LEAK))))
        assert setup.drive.velocities == [0.2, None, 0.2, 0.3, None]


def test_velocity_of_a_way_back_to_the_same_task(yard):
    again = Group(name="Twice", start="A", end="A", max_repeat_count=2)
    plan = mission(waypoint("A", 3.05, 2.05, velocity=0.2), groups=(again,))
    setup = fast_setup(yard)
    run_with(plan, setup)
    assert setup.drive.velocities == [0.2, 0.2]


class TestFailures:
    def test_a_retry_that_succeeds_is_a_success(self, yard):
        record = run_with(mission(measure(1, retries=2)), foggy(yard, 2))
        assert [t.outcome for t in record.tasks] == ["failed", "failed", "done"]
        assert record.result.success

    def test_retries_that_all_fail_are_none(self, yard):
        record = run_with(mission(measure(1, retries=1), measure(2)), foggy(yard, 2))
        assert [t.outcome for t in record.tasks] == ["failed", "failed", "done"]
        assert "failed: MEASURE 1" in record.result.verdict

    @pytest.mark.parametrize(
        ("policy", "outcome", "then"),
        [
            (OnFailure.RETURN, Outcome.RETURNED, ["return to dock"]),
            (OnFailure.ABORT, Outcome.ABORTED, []),
        ],
    )
    def test_policies(self, yard, policy, outcome, then):
        plan = mission(measure(1, on_failure=policy), measure(2), dock=DOCK)
        record = run_with(plan, foggy(yard, 9))
        assert [t.task for t in record.tasks] == ["MEASURE 1", *then]
        assert record.result.outcome is outcome
        assert "failed: MEASURE 1" in record.result.verdict


@st.composite
def given_events(draw):
    kinds = st.sampled_from(
        [
            *(Occurred(k) for k in EventKind if k is not EventKind.TIME_UP),
            *(2 * [Pause(), Resume(), Resume()]),
            Cancel(),
        ]
    )
    times = st.integers(0, 900).map(lambda k: k / 10)
    return draw(st.lists(st.tuples(times, kinds), max_size=8))


@st.composite
def reactions(draw):
    drawn = []
    for event in draw(st.lists(st.sampled_from(EventKind), max_size=4, unique=True)):
        response = draw(st.sampled_from(Response))
        interrupts = response in {Response.PAUSE, Response.RETURN, Response.SAFE_AREA}
        until = draw(st.none() | st.sampled_from(EventKind)) if interrupts else None
        drives = response in {Response.RETURN, Response.SAFE_AREA}
        drawn.append(
            react(
                event,
                response,
                pose=SHELTER if response is Response.SAFE_AREA else None,
                until=until if until is not event else None,
                afterwards=draw(st.sampled_from(Afterwards)) if drives else Afterwards.END,
                priority=draw(st.integers(0, 2)),
            )
        )
    return tuple(drawn)


def check_findings(record, plan, events):
    """Each event is a finding or the end of one, and only findings make the headline amber."""
    occurred = [(t, e.event) for t, e in events if isinstance(e, Occurred)]
    reported = [(a.t, a.kind) for a in record.anomalies if a.is_reported_from_outside]
    assert not Counter(kind for _, kind in reported) - Counter(kind for _, kind in occurred)
    assert all(
        kind in [k for _, k in reported] for t, kind in occurred if t < record.result.duration
    )
    abnormal = [r for r in record.readings if not r.normal]
    ends = [a for a in record.anomalies if a.is_end]
    assert len(record.findings) == len(reported) - len(ends) + len(abnormal)
    answerable = {reaction.event for reaction in plan.reactions}
    assert not [f for f in record.findings if f.answered and f.kind not in answerable]
    headline = record.headline
    assert (headline.tone is Tone.GOOD) == (record.result.success and not record.findings)
    counts = re.findall(r"(\d+) findings?:", str(headline))
    assert counts == [str(len(record.findings))] * bool(record.findings)
    assert RunRecord.model_validate_json(record.model_dump_json()).headline == headline


@settings(max_examples=examples(40), deadline=None)
@given(given_events(), reactions(), st.none() | st.floats(5.0, 80.0))
def test_whatever_occurs(yard, events, answers, limit):
    plan = mission(
        measure(1), waypoint("A", 4.05, 2.05), measure(2), measure(3),
        reactions=answers, dock=DOCK, max_duration=limit,
    )  # fmt: skip
    record = run(yard, plan, *events, values={2: 5.5})
    assert run(yard, plan, *events, values={2: 5.5}) == record
    check_findings(record, plan, events)
    # One action at a time, each with its end; a reading belongs to one that is done.
    assert all(a.end <= b.start for a, b in pairwise(record.tasks))
    measured = [t for t in record.tasks if t.action == "MEASURE" and t.outcome == "done"]
    assert [(t.task, t.end) for t in measured] == [(r.task, r.t) for r in record.readings]
    readings = [r.checkpoint for r in record.readings]
    assert readings == [1, 2, 3][: len(readings)]
    assert all(a.end <= b.start for a, b in pairwise(record.interruptions))
    if record.result.outcome is Outcome.COMPLETED:
        assert readings == [1, 2, 3]
    elif record.result.outcome is None:
        assert "nothing more occurs" in record.result.verdict
    # While the mission stands still nothing but a reaction's drive begins.
    for interruption in record.interruptions:
        for task in record.tasks:
            if interruption.start < task.start < interruption.end:
                assert task.task.startswith("react to")
    for a, b in pairwise(record.path):
        assert math.dist((a.x, a.y), (b.x, b.y)) <= yard.robot.speed * (b.t - a.t) + 0.15


@pytest.mark.physics
def test_in_the_world(yard):
    """A reaction does the same with the simulated drive, sensor and contacts."""
    plan = mission(
        measure(1), dock=DOCK, reactions=(react(EventKind.LOW_BATTERY, Response.RETURN),)
    )
    events = logged_events((8.0, Occurred(EventKind.LOW_BATTERY)))
    record = simulated(plan, yard, events=events)
    assert outcomes_of_tasks(record) == [
        ("MEASURE 1", "interrupted"),
        ("react to low_battery", "done"),
    ]
    assert record.result.outcome is Outcome.RETURNED
    assert math.dist((record.path[-1].x, record.path[-1].y), (DOCK.x, DOCK.y)) < 0.1
