"""Waits, planned rounds and time windows: the robot's behaviour, and the record."""

import pytest

from argo_compiler.hfsm import ByHand, GiveBack, Occurred, Outcome, Pause, Resume, TakeOver
from argo_compiler.hfsm.events import ReadingGiven
from argo_compiler.il import Condition, ConditionType, EventKind, Group, Mode, OnFailure, TimeWindow
from argo_env.report.rounds import all_waits, rounds_with_condition_values
from argo_env.run.journal import open_journal
from argo_env.run.record import RunRecord, WindowOutcome
from argo_env.run.spec import logged_events
from argo_env.run.verdict_line import Tone
from tests.mission_writing import above, wait, way
from tests.yard import (
    Entries,
    cut_after,
    fast_setup,
    measure,
    mission,
    resumed,
    run_with,
    simulated,
    waypoint,
)


def run(yard, plan, *events, values=None):
    record = run_with(plan, fast_setup(yard, values), events=logged_events(*events))
    assert RunRecord.model_validate_json(record.model_dump_json()) == record
    return record


HERE = waypoint("A", 2.05, 2.05)
THERE = waypoint("B", 4.05, 2.05)


class TestWaits:
    @pytest.mark.rule("W1")
    def test_the_robot_stands_so_long(self, yard):
        record = run(yard, mission(HERE, wait("REST", duration=30.0), THERE))
        (rest,) = record.waits
        assert rest.start == record.tasks[0].end
        assert rest.end - rest.start == pytest.approx(30.0, abs=0.11)
        assert record.tasks[1].start == pytest.approx(rest.end, abs=0.11)
        assert record.result.success
        assert record.headline.text == "everything was done as planned"
        assert [w.what for w in all_waits(record)] == ["30 s (REST)"]
        during = [(s.x, s.y) for s in record.path if rest.start < s.t < rest.end]
        assert len(during) > 30
        assert len(set(during)) == 1

    def test_a_wait_without_duration_is_only_a_place(self, yard):
        record = run(yard, mission(HERE, wait("JOIN", duration=0.0), THERE))
        assert record.waits == ()
        assert record.result.success

    @pytest.mark.rule("W2")
    def test_until_an_event(self, yard):
        plan = mission(HERE, wait("REST", event=EventKind.ALL_CLEAR), THERE)
        record = run(yard, plan, (40.0, Occurred(EventKind.ALL_CLEAR)))
        (rest,) = record.waits
        assert rest.end == 40.0
        assert rest.what == "all clear"
        assert "all clear" in rest.why
        assert record.result.success

    def test_until_an_event_that_does_not_come_the_run_ends(self, yard):
        plan = mission(HERE, wait("REST", event=EventKind.ALL_CLEAR), THERE)
        record = run(yard, plan)
        assert not record.result.success
        assert "waiting for an event, and nothing more occurs" in record.result.verdict
        assert [w.ended for w in record.waits] == [False]

    @pytest.mark.rule("W3")
    def test_a_limit_is_waited_for(self, yard):
        rest = wait("REST", event=EventKind.ALL_CLEAR, limit=20.0)
        record = run(yard, mission(HERE, rest, THERE))
        (waited,) = record.waits
        assert waited.end - waited.start == pytest.approx(20.0, abs=0.11)
        assert waited.failure == waited.why
        assert record.result.outcome is Outcome.COMPLETED_WITH_FAILURES
        assert record.result.verdict == "failed: REST"
        assert [w.outcome for w in all_waits(record)] == ["failed: waited 20 s in vain"]

    @pytest.mark.rule("C8")
    def test_until_somebody_tells_a_value(self, yard):
        rest = wait("REST", conditions=(above("3", 4.0),))
        plan = mission(HERE, rest, THERE)
        record = run(yard, plan, (30.0, ReadingGiven("3", 3.0)), (45.0, ReadingGiven("3", 9)))
        assert record.waits[0].end == 45.0
        assert [(v.t, v.value, v.normal) for v in record.given_values] == [
            (30.0, 3.0, True), (45.0, 9.0, False),
        ]  # fmt: skip
        assert record.result.success


class TestRounds:
    def group(self, **fields):
        return Group(name="Watch", start="A", end="B", **fields)

    @pytest.mark.rule("G13")
    def test_a_round_every_minute(self, yard):
        plan = mission(HERE, THERE, groups=(self.group(every=60.0, max_repeat_count=3),))
        record = run(yard, plan)
        assert [(r.number, r.due) for r in record.rounds] == [(1, 0.0), (2, 60.0), (3, 120.0)]
        assert [r.began for r in record.rounds] == [0.0, 60.0, 120.0]
        starts = [t.start for t in record.tasks if t.task == "A"]
        assert starts == pytest.approx([0.0, 60.0, 120.0], abs=0.11)
        assert [r.ended is not None for r in record.rounds] == [True] * 3
        assert record.result.success
        assert [w.what for w in all_waits(record)] == ["the next round (Watch)"] * 2

    def test_a_round_that_is_late_begins_at_once_and_the_plan_stays(self, yard):
        plan = mission(HERE, THERE, groups=(self.group(every=40.0, max_repeat_count=4),))
        record = run(yard, plan, (50.0, Pause()), (110.0, Resume()))
        # The clock of the group stands for 60 s, the second round is held up as well.
        assert [r.number for r in record.rounds] == [1, 2, 3, 4]
        assert [r.due for r in record.rounds][2:] == pytest.approx([140.0, 180.0], abs=0.11)
        assert all(r.began >= r.due - 1e-6 for r in record.rounds)

    def test_rounds_that_miss_a_window_at_once_have_begun_all_the_same(self, yard):
        first = waypoint("A", 2.05, 2.05, window=TimeWindow(latest=50.0, missed_target="B"))
        group = self.group(every=60.0, max_repeat_count=3)
        record = run(yard, mission(first, wait("B", duration=0.0), groups=(group,)))
        assert [r.began for r in record.rounds] == [0.0, 60.0, 120.0]
        assert [r.due for r in record.rounds] == [0.0, 60.0, 120.0]
        assert [w.kept for w in record.windows] == [WindowOutcome.KEPT] + [WindowOutcome.MISSED] * 2

    @pytest.mark.rule("G8")
    def test_until_a_value(self, yard):
        first = measure(1)
        group = Group(
            name="Watch", start="MEASURE 1", end="B", until=(above("1", 2.0),), max_repeat_count=5
        )
        record = run(yard, mission(first, THERE, groups=(group,)), values={1: 3.0})
        assert [(r.number, r.due, r.began) for r in record.rounds] == [(1, None, 0.0)]
        assert record.result.success

    @pytest.mark.rule("C3")
    def test_a_measurement_that_failed_is_what_the_round_ended_with(self, yard):
        first = measure(1).model_copy(update={"reading_limit": 0.01})
        group = Group(
            name="Watch", start="MEASURE 1", end="B", until=(above("1", 2.0),), max_repeat_count=1
        )
        plan = mission(first, THERE, groups=(group,))
        record = run(yard, plan, (0.5, ReadingGiven("1", 3.0)), values={1: 3.0})
        ((_, said),) = rounds_with_condition_values(record)
        assert said.startswith("#1: failed at ")

    def test_a_run_that_ends_before_a_round_is_due(self, yard):
        plan = mission(HERE, THERE, groups=(self.group(every=600.0, max_repeat_count=2),))
        record = run_with(plan, fast_setup(yard), interrupted=iter([False] * 500 + [True]).__next__)
        assert [(r.number, r.began) for r in record.rounds] == [(1, 0.0), (2, None)]
        assert all_waits(record)[-1].outcome == "still waiting at the end"


class TestWindows:
    @pytest.mark.rule("W4")
    def test_the_robot_goes_there_and_begins_at_the_place(self, yard):
        record = run(yard, mission(measure(1, window=TimeWindow(earliest=60.0))))
        task = record.tasks[0]
        assert task.start == 0.0
        assert task.early[0] < 40.0
        assert task.early[1] == 60.0
        assert task.measuring[0][0] == pytest.approx(60.0, abs=0.11)
        assert [w.kept for w in record.windows] == [WindowOutcome.KEPT]
        assert [w.what for w in all_waits(record)] == ["the time window (MEASURE 1)"]

    def test_it_stands_at_a_waypoint_as_well(self, yard):
        plan = mission(waypoint("A", 2.05, 2.05, window=TimeWindow(earliest=60.0)))
        assert run(yard, plan).tasks[0].end == pytest.approx(60.0, abs=0.11)

    def test_what_is_cancelled_before_it_begins_stops_at_once(self, yard):
        plan = mission(measure(1, window=TimeWindow(earliest=60.0)))
        record = run(yard, plan, (50.0, Pause()), (55.0, Resume()))
        assert [(t.task, t.outcome) for t in record.tasks] == [
            ("MEASURE 1", "interrupted"), ("MEASURE 1", "done"),
        ]  # fmt: skip
        assert record.tasks[0].end == pytest.approx(50.1)
        assert record.tasks[1].measuring[0][0] == pytest.approx(60.0, abs=0.11)

    @pytest.mark.rule("W5")
    def test_a_hard_window_that_is_missed_has_its_branch(self, yard):
        window = TimeWindow(latest=3.0, missed_target="C")
        late = waypoint("A", 2.05, 2.05, window=window, transitions=(way("B"),))
        tasks = late, THERE, waypoint("C", 3.05, 2.05)
        plan = mission(*tasks)
        record = run(yard, plan)
        assert [(t.task, t.outcome) for t in record.tasks] == [("A", "cancelled"), ("C", "done")]
        (seen,) = record.windows
        assert (seen.task, seen.kept, seen.ended, seen.hard) == (
            "A",
            WindowOutcome.MISSED,
            3.0,
            True,
        )
        assert record.result.outcome is Outcome.COMPLETED_WITH_FAILURES
        assert record.result.verdict == "missed the time window: A"
        assert record.headline.tone is Tone.NOTICE
        assert record.headline.word == "Completed with failures"
        assert not record.result.success

    def test_one_that_is_over_before_is_not_even_started(self, yard):
        late = waypoint("C", 3.05, 2.05, window=TimeWindow(latest=1.0))
        record = run(yard, mission(HERE, late))
        assert [t.task for t in record.tasks] == ["A"]
        assert [w.kept for w in record.windows] == [WindowOutcome.MISSED]
        assert "missed the time window: C" in record.result.verdict

    def test_a_soft_window_is_done_late_and_told(self, yard):
        late = waypoint("A", 2.05, 2.05, window=TimeWindow(latest=3.0, hard=False))
        record = run(yard, mission(late))
        assert [w.kept for w in record.windows] == [WindowOutcome.LATE]
        assert record.result.success
        assert record.headline.word == "Done, 1 late task"
        assert "A ended after its time window" in record.headline.text

    def test_one_that_is_never_come_to(self, yard):
        apart = waypoint("C", 3.05, 2.05, window=TimeWindow(latest=30.0))
        skip = THERE.model_copy(update={"transitions": ()})
        plan = mission(HERE, skip, apart)
        tasks = (*plan.tasks[:2], plan.tasks[2].model_copy(update={"transitions": ()}), apart)
        record = run(yard, plan.model_copy(update={"tasks": tasks}))
        assert [w.kept for w in record.windows] == [WindowOutcome.NOT_VISITED]

    def test_other_failures_are_none_of_the_window(self, yard):
        nowhere = waypoint("A", 30.0, 30.0, window=TimeWindow(latest=100.0))
        record = run(yard, mission(nowhere, THERE))
        assert [w.kept for w in record.windows] == [WindowOutcome.FAILED]
        assert record.result.verdict == "failed: A"


class TestFailures:
    @pytest.mark.rule("T11")
    def test_an_optional_task_that_failed_is_told_and_no_failure(self, yard):
        record = run(yard, mission(waypoint("A", 30.0, 30.0, optional=True), THERE))
        assert record.result.outcome is Outcome.COMPLETED
        assert record.result.success
        assert "optional tasks that failed: A" in record.result.verdict

    @pytest.mark.rule("T8")
    def test_a_branch_after_a_failure(self, yard):
        lost = waypoint(
            "A", 30.0, 30.0, on_failure=OnFailure.BRANCH, failure_target="C",
            transitions=(way("B"),),
        )  # fmt: skip
        record = run(yard, mission(lost, THERE, waypoint("C", 3.05, 2.05)))
        assert [(t.task, t.outcome) for t in record.tasks] == [("A", "failed"), ("C", "done")]
        assert record.headline.word == "Completed with failures"

    @pytest.mark.rule("T9")
    def test_a_time_limit(self, yard):
        slow = waypoint("A", 5.05, 2.05, time_limit=5.0)
        record = run(yard, mission(slow, THERE))
        assert [(t.task, t.outcome) for t in record.tasks] == [("A", "cancelled"), ("B", "done")]
        assert "within 5 s" in record.tasks[0].reason
        assert record.result.verdict == "failed: A"


class TestSupervision:
    PLAN = mission(HERE, mode=Mode.SUPERVISORY)

    @pytest.mark.rule("M9")
    def test_it_ends_if_nobody_lets_it_begin(self, yard):
        record = run(yard, self.PLAN)
        assert record.tasks == ()
        assert "a supervisory mission begins when a person resumes it" in record.result.verdict

    @pytest.mark.parametrize("begin", [Resume(), GiveBack()])
    def test_it_begins_when_a_person_lets_it(self, yard, begin):
        record = run(yard, self.PLAN, (5.0, begin))
        assert record.tasks[0].start == pytest.approx(5.0, abs=0.11)
        assert record.interruptions[0].start == 0.0
        assert record.result.success

    def test_take_over_and_give_back(self, yard):
        record = run(yard, mission(HERE), (5.0, TakeOver()), (9.0, GiveBack()))
        assert [t.outcome for t in record.tasks] == ["interrupted", "done"]
        assert record.tasks[1].start == pytest.approx(9.0, abs=0.11)


@pytest.mark.rule("I4")
def test_ends_have_the_ids_of_their_actions(yard):
    entries = Entries()
    run_with(mission(HERE, THERE), fast_setup(yard), observers=[entries])
    ids = [e.id for one in entries.all for e in one.events if e.kind == "succeeded"]
    assert ids == [1, 2]


def test_what_a_person_read_is_abnormal_outside_the_nominal_range(yard):
    entries = Entries()
    odd = Condition(type=ConditionType.ABNORMAL, object_id="1")
    first = measure(1, transitions=(way("B", odd),))
    plan = mission(first, HERE, THERE)
    done = GiveBack((ByHand(task="MEASURE 1", value=9.0),))
    events = logged_events((1.0, TakeOver()), (5.0, done))
    record = run_with(plan, fast_setup(yard), observers=[entries], events=events)
    assert [t.task for t in record.tasks if t.outcome == "done"] == ["B"]


@pytest.mark.rule("H2")
@pytest.mark.parametrize("until", [3.0, 30.0, 60.0, 95.0, 110.0, 135.0, 150.0])
def test_a_run_goes_on_in_a_wait_before_a_round_and_in_a_window(yard, tmp_path, until):
    """At these times the robot rests, drives, waits for a round, for a window, and for a value."""
    group = Group(name="Watch", start="A", end="B", max_repeat_count=2, every=70.0)
    told = wait("TOLD", conditions=(above("3", 4.0),), limit=100.0)
    plan = mission(
        wait("REST", duration=5.0), HERE, THERE,
        measure(1, window=TimeWindow(earliest=120.0)),
        told, waypoint("C", 3.05, 2.05, window=TimeWindow(latest=121.0), optional=True),
        groups=(group,),
    )  # fmt: skip
    path = tmp_path / "run.journal"
    events = logged_events((140.0, ReadingGiven("3", 9.0)))
    whole = simulated(plan, yard, drive="route", events=events, journal=path)
    with open_journal(path) as journal:
        count = sum(entry.t <= until for entry in journal.entries)
    cut_after(path, count)
    record = resumed(path, yard)
    assert record.resumed or until > whole.result.duration
    assert record.result.verdict == whole.result.verdict
    assert [(w.task, w.end, w.why) for w in record.waits] == [
        (w.task, w.end, w.why) for w in whole.waits
    ]
    assert [(r.number, r.due, r.began) for r in record.rounds] == [
        (r.number, r.due, r.began) for r in whole.rounds
    ]
    assert [(w.task, w.kept) for w in record.windows] == [(w.task, w.kept) for w in whole.windows]
    assert record.given_values == whole.given_values
