"""Handover of a mission to a person and back."""

from collections import Counter, defaultdict

import pytest
from hypothesis import given, reject, settings
from hypothesis import strategies as st

from argo_compiler.base.errors import ArgoError
from argo_compiler.base.model import Pose
from argo_compiler.diagnostics import has_errors
from argo_compiler.diagnostics.codes import CODES
from argo_compiler.hfsm import (
    ActionFailed,
    ActionStopped,
    ActionSucceeded,
    ByHand,
    Executor,
    GiveBack,
    Hfsm,
    Pause,
    Progress,
    Resume,
    TakeOver,
    Tick,
    lower,
)
from argo_compiler.hfsm.handover import hand_over, match_to_mission
from argo_compiler.hfsm.progress import GroupProgress, Phase, Reacting, ReadingProgress, Waiting
from argo_compiler.il import EventKind, Group, Mission, OnFailure, Reaction, Response
from tests.argo_compiler.hfsm.play import started
from tests.argo_compiler.hfsm.random_missions import missions, result_lists
from tests.conftest import examples
from tests.mission_parts import assume_sound
from tests.mission_writing import drive
from tests.mission_writing import measure as task

VISITS = 40
PAUSE = Pause()


class Site:
    """World that executes actions; the n-th execution of a task is the same, whoever does it.

    An action that a person interrupts later takes only its remaining time.
    """

    def __init__(self, outcomes):
        self.outcomes = outcomes
        self.executions = Counter()
        self.spent = 0
        self.interrupted = None
        self.log = defaultdict(list)
        """by task: for each execution, its duration, its value, and whether it succeeded"""

    def outcome(self, name, number):
        # Not the same for all tasks, but the same in each run.
        doing = self.outcomes[(number * 3 + len(name)) % len(self.outcomes)]
        return doing.seconds, doing.value if name.startswith("M") else None, doing.failed

    def run(self, executor, now, visits):
        """Run until `visits` visits have ended, or the mission has."""
        for _ in range(10 * VISITS):
            if executor.finished or count_visits(executor.progress()) >= visits:
                return now
            now = self.step(executor, now)
        # The time of a group may be up again and again before any of its tasks has ended.
        reject()

    def step(self, executor, now, until=None):
        """Run to the next event, or to the time `until` if that comes first; return the time."""
        name = executor.running.name
        duration, value, failed = self.outcome(name, self.executions[name])
        ends_at = now + duration - self.spent
        due = executor.next_deadline
        if until is not None and until < min(ends_at, ends_at if due is None else due):
            self.spent += until - now
            return until
        if due is not None and due < ends_at:
            (cancel,) = executor.handle(Tick(), due)
            executor.handle(ActionStopped(cancel.task), due)
            self.ended(name, due - now, None, done=False)
            return due
        if failed:
            executor.handle(ActionFailed(name, "failed"), ends_at)
        else:
            executor.handle(ActionSucceeded(name, value), ends_at)
        self.ended(name, ends_at - now, value, done=not failed)
        return ends_at

    def ended(self, name, seconds, value, done):
        self.log[name].append((seconds + self.spent, value, done))
        self.executions[name] += 1
        self.spent = 0

    def pause(self, executor, now, by=PAUSE):
        self.interrupted = executor.running and executor.running.name
        for cancel in executor.handle(by, now):
            executor.handle(ActionStopped(cancel.task), now)


def count_visits(progress):
    """Return the number of visits that have ended."""
    return sum(t.done + t.failed + t.by_hand for t in progress.tallies)


def state_without_times(progress):
    """Return the progress without times and commands of persons."""
    return {
        "ended": {t.task: (t.done + t.by_hand, t.failed) for t in progress.tallies},
        "active": progress.active,
        "attempt": progress.attempt,
        "groups": progress.groups,
        "readings": {r.object_id: (r.kind, r.value) for r in progress.readings},
        "outcome": progress.outcome,
    }


def order(*executors):
    """Return the visits that have ended, in order, and whether they failed."""
    return [(e.task, e.failure is not None) for executor in executors for e in executor.ended]


def run_whole_and_interrupted(mission, outcomes, at, by=PAUSE):
    """Return a complete run, a run that a person interrupts, and the time of the interruption.

    Each run is an executor and its site.
    """
    whole, once = started(assume_sound(mission)), Site(outcomes)
    once.run(whole, 0, VISITS)
    live, site = started(mission), Site(outcomes)
    now = 0
    while not live.finished and now < at and count_visits(live.progress()) < VISITS:
        now = site.step(live, now, until=at)
    site.pause(live, now, by)
    return (whole, once), (live, site), now


@pytest.mark.rule("H2", "H3", "H4", "H5")
@settings(max_examples=examples(200))
@given(missions(events=False), result_lists, st.integers(0, 60), st.data())
def test_before_by_hand_and_after_are_the_whole_mission(mission, outcomes, at, data):
    (whole, once), (first, site), _ = run_whole_and_interrupted(mission, outcomes, at)
    before = first.progress()
    by_hand = list(done_by_hand(data, site, once.log))
    text = hand_over(before, by_hand).model_dump_json()

    progress = Progress.model_validate_json(text)
    rest = Hfsm.model_validate_json(lower(mission, progress).model_dump_json())
    away = sum(done.duration for done in by_hand)
    second = Executor.restore(rest, progress, 1000, away)
    second.start(1000)
    second.handle(Resume(), 1000)
    site.run(second, 1000, VISITS)

    after = second.progress()
    if not whole.finished:
        # What was done by hand may have carried it further.
        once.run(whole, whole_time(whole), count_visits(after))
    assert state_without_times(after) == state_without_times(whole.progress())
    assert order(first, second) == order(whole)
    assert sum(t.by_hand for t in after.tallies) == len(by_hand) - len(after.by_hand)


@pytest.mark.rule("H7")
@settings(max_examples=examples(100))
@given(missions(events=False), result_lists, st.integers(0, 60), st.integers(0, 30), st.data())
def test_giving_back_is_a_progress_handed_over_and_gone_on_from(mission, outcomes, at, more, data):
    """A machine that was taken over and given back has the state of one restored meanwhile."""
    (_, once), (live, site), now = run_whole_and_interrupted(mission, outcomes, at, TakeOver())
    before = live.progress()
    by_hand = tuple(done_by_hand(data, site, once.log))
    away = sum(done.duration for done in by_hand) + more
    restored = Executor.restore(lower(mission), hand_over(before, by_hand, away), now + away)
    restored.start(now + away)
    expected = restored.handle(Resume(), now + away)
    assert live.handle(GiveBack(by_hand), now + away) == expected
    assert state_without_times(live.progress()) == state_without_times(restored.progress())
    assert live.progress().readings == restored.progress().readings
    assert live.progress().by_hand == restored.progress().by_hand
    assert live.progress().elapsed == pytest.approx(restored.progress().elapsed)
    assert live.next_deadline == restored.next_deadline


def whole_time(executor):
    return executor.trace[0].time + executor.progress().elapsed


def done_by_hand(data, site, log):
    """Yield some of the next executions of tasks, with the results that the robot had."""
    for name, executions in log.items():
        count = data.draw(st.integers(0, 4), label=f"by hand: {name}")
        for seconds, value, done in executions[site.executions[name] :][:count]:
            # A person who reads nothing leaves no reading, the robot an unreadable one.
            if not done or name.startswith("return") or (name.startswith("M") and value is None):
                break
            skipped = value is None and data.draw(st.booleans())
            left = seconds
            if name == site.interrupted:
                left, site.spent, site.interrupted = seconds - site.spent, 0, None
            yield ByHand(task=name, value=value, duration=left, skipped=skipped)
            site.executions[name] += 1


def line(*groups, **fields):
    """Return a mission of A, B, C and D, one after the other."""
    tasks = (task("A", "B"), task("B", "C"), task("C", "D"), task("D"))
    return Mission(tasks=tasks, groups=groups, dock=Pose(x=0, y=0, z=0), **fields)


class TestByHand:
    @pytest.mark.rule("H3")
    def test_present_and_later_tasks_are_passed_over(self):
        mission = line(Group(name="G", start="B", end="D", max_repeat_duration=60))
        progress = Progress(
            active="B", groups=(GroupProgress(group="G", round=1, elapsed=10),), elapsed=20
        )
        done = [ByHand(task="B", value=4, duration=5), ByHand(task="D", skipped=True)]
        executor = Executor.restore(lower(mission), hand_over(progress, done, away=30), 100)
        (command,) = executor.start(100)
        assert command.task.name == "C"
        assert executor.next_deadline == 145
        assert executor.values["B"].value == 4
        assert [(e.target, e.by_hand) for e in executor.trace] == [("B", False), ("C", True)]
        assert executor.progress().elapsed == 50
        (command,) = executor.handle(ActionSucceeded("C"), 101)
        assert command.task.name == "B"
        ended = [(e.task, e.by_hand) for e in executor.ended]
        assert ended == [("B", True), ("C", False), ("D", True)]

    @pytest.mark.rule("H3")
    def test_task_of_which_the_time_was_up_has_ended(self):
        mission = line(Group(name="G", start="A", end="C", max_repeat_duration=60))
        progress = Progress(active="A", groups=(GroupProgress(group="G", round=1, elapsed=50),))
        done = hand_over(progress, [ByHand(task="A", value=1, duration=20)])
        executor = Executor.restore(lower(mission), done, 0)
        (command,) = executor.start(0)
        assert command.task.name == "D"
        assert [e.task for e in executor.ended] == ["A"]

    @pytest.mark.rule("H2", "H3")
    @pytest.mark.parametrize(("age", "old"), [(None, 500), (5, 505)])
    def test_what_was_read_ages_from_when_the_robot_was_given_back(self, age, old):
        progress = Progress(active="A", paused=True)
        kept = hand_over(progress, [ByHand(task="A", value=1, age=age)], away=10)
        executor = Executor.restore(lower(line()), kept, 1000, away=500)
        executor.start(1000)
        executor.handle(Resume(), 1000)
        assert executor.values["A"].time == 1000 - old

    def test_waits_while_the_mission_is_paused(self):
        progress = hand_over(Progress(active="A", paused=True), [ByHand(task="A")])
        executor = Executor.restore(lower(line()), progress, 0)
        assert executor.start(0) == ()
        assert executor.progress().by_hand == (ByHand(task="A", age=0),)
        (command,) = executor.handle(Resume(), 1)
        assert command.task.name == "B"

    @pytest.mark.rule("H7")
    @pytest.mark.parametrize("counts", [False, True])
    @pytest.mark.parametrize("durations", [(0, 0), (8, 4), (8, 40)])
    def test_their_time_is_no_part_of_the_interruption(self, counts, durations):
        """Their duration is added once, when the machine reaches the tasks done by hand."""
        group = Group(
            name="G", start="A", end="D", max_repeat_duration=90, count_interruptions=counts
        )
        live = started(line(group))
        live.handle(ActionSucceeded("A", 4), 5)
        live.handle(TakeOver(), 10)
        live.handle(ActionStopped("B"), 10)
        first, later = durations
        done = (ByHand(task="B", value=2, duration=first), ByHand(task="D", duration=later))
        progress = hand_over(live.progress(), done, away=40)
        restored = Executor.restore(lower(line(group)), progress, 50)
        restored.start(50)
        assert live.handle(GiveBack(done), 50) == restored.handle(Resume(), 50)
        for at in (50, 60):
            if at == 60:
                assert live.handle(Tick(), at) == restored.handle(Tick(), at)
            assert state_without_times(live.progress()) == state_without_times(restored.progress())
            assert live.next_deadline == restored.next_deadline

    def test_not_while_an_action_runs(self):
        executor = started(line())
        executor.handle(TakeOver(), 1)
        with pytest.raises(ValueError, match="while the action of 'A' still runs"):
            executor.handle(GiveBack((ByHand(task="A"),)), 2)
        assert executor.paused
        executor.handle(ActionStopped("A"), 3)
        (command,) = executor.handle(GiveBack((ByHand(task="A"),)), 4)
        assert command.task.name == "B"
        assert "pause (a person takes over)" in [e.why for e in executor.trace]


class TestTimeAway:
    @pytest.mark.rule("H2")
    def test_counts_for_ages_for_the_mission_and_where_asked_for(self):
        limits = {"start": "A", "end": "D", "max_repeat_duration": 60}
        counts = Group(name="G", count_interruptions=True, **limits)
        stands = Group(name="G/H", **limits)
        groups = tuple(GroupProgress(group=g, round=1, elapsed=10) for g in ("G", "G/H"))
        readings = (ReadingProgress(object_id="A", value=1, age=3),)
        progress = Progress(active="B", groups=groups, readings=readings, elapsed=10)
        executor = Executor.restore(lower(line(counts, stands)), progress, 1000, away=20)
        executor.start(1000)
        later = executor.progress()
        assert {g.group: g.elapsed for g in later.groups} == {"G": 30, "G/H": 10}
        assert (later.readings[0].age, later.elapsed) == (23, 30)
        assert executor.next_deadline == 1030


class TestRemaining:
    def names(self, mission, progress):
        hfsm = lower(mission, progress)
        assert Hfsm.model_validate_json(hfsm.model_dump_json()) == hfsm
        return [leaf.task.name for leaf in hfsm.leaves]

    @pytest.mark.rule("H5")
    def test_what_lies_behind_is_gone(self):
        assert self.names(line(), Progress(active="C")) == ["C", "D"]

    @pytest.mark.rule("H5")
    @pytest.mark.parametrize(("round", "expected"), [(1, "A B C D"), (2, "B C D")])
    def test_last_round_does_not_come_back(self, round, expected):
        mission = line(Group(name="G", start="A", end="C", max_repeat_count=2))
        progress = Progress(active="B", groups=(GroupProgress(group="G", round=round, elapsed=1),))
        assert self.names(mission, progress) == expected.split()

    @pytest.mark.rule("H5")
    def test_last_round_of_a_group_that_is_entered_again(self):
        tasks = (task("A", "B"), task("B", "C"), task("C", "B"))
        group = Group(name="G", start="A", end="B", max_repeat_count=2)
        progress = Progress(active="B", groups=(GroupProgress(group="G", round=2, elapsed=1),))
        assert self.names(Mission(tasks=tasks, groups=(group,)), progress) == ["A", "B", "C"]

    def test_way_back_is_kept_where_a_task_may_need_it(self):
        tasks = (task("A", "B", on_failure=OnFailure.RETURN), task("B"))
        mission = Mission(tasks=tasks, dock=Pose(x=0, y=0, z=0))
        assert self.names(mission, Progress(active="A")) == ["A", "B", "return to dock"]
        assert self.names(mission, Progress(active="B")) == ["B"]

    def test_nothing_is_left_of_a_mission_that_has_ended(self):
        assert self.names(line(), Progress(active=None, outcome="completed")) == []

    def test_task_that_is_not_there(self):
        with pytest.raises(ArgoError, match="task 'Z', which the mission does not have"):
            lower(line(), Progress(active="Z"))


class TestMatch:
    def codes(self, progress, mission):
        matched, findings = match_to_mission(progress, mission)
        assert (matched is None) == has_errors(findings)
        assert all(CODES[f.code].severity is f.severity and f.hint for f in findings)
        if matched is not None:
            Executor.restore(lower(mission, matched), matched, 0).start(0)
        return matched, [f.code for f in findings]

    @pytest.mark.rule("H6")
    def test_new_group_begins_and_old_one_keeps_its_round(self):
        groups = (GroupProgress(group="G", round=2, elapsed=9),)
        mission = line(
            Group(name="G", start="A", end="C", max_repeat_count=5),
            Group(name="G/H", start="B", end="B", max_repeat_count=2),
        )
        matched, codes = self.codes(Progress(active="B", groups=groups), mission)
        assert matched.groups == (*groups, GroupProgress(group="G/H", round=1, elapsed=0))
        assert codes == ["handover.new-group"]

    @pytest.mark.rule("H6")
    def test_group_that_is_gone(self):
        groups = (GroupProgress(group="G", round=2, elapsed=9),)
        matched, codes = self.codes(Progress(active="B", groups=groups), line())
        assert (matched.groups, codes) == ((), ["handover.group-gone"])

    @pytest.mark.rule("H6")
    def test_task_that_is_gone_needs_a_decision(self):
        assert self.codes(Progress(active="Z"), line()) == (None, ["handover.task-gone"])
        back = Progress(active="return to dock")
        assert self.codes(back, line()) == (None, ["handover.no-return"])

    @pytest.mark.rule("H6")
    def test_what_was_done_by_hand_and_does_not_fit(self):
        done = (ByHand(task="Z"), ByHand(task="W", value=3))
        mission = line().model_copy(update={"tasks": (*line().tasks, drive("W"))})
        matched, codes = self.codes(Progress(active="A", by_hand=done), mission)
        assert matched.by_hand == done[1:]
        assert codes == ["handover.by-hand-gone", "handover.by-hand-value"]

    @pytest.mark.rule("H6")
    @pytest.mark.parametrize("response", [None, Response.REPORT, Response.ABORT])
    def test_reactions_that_are_gone_pause_the_mission(self, response):
        leak, low = EventKind.GAS_LEAK, EventKind.LOW_BATTERY
        progress = Progress(
            active="A",
            reaction=Reacting(event=leak, phase=Phase.HOLDING),
            waiting=(Waiting(event=low),),
        )
        kept = () if response is None else (Reaction(event=leak, response=response),)
        matched, codes = self.codes(progress, line(reactions=kept))
        assert (matched.paused, matched.reaction, matched.waiting) == (True, None, ())
        assert codes == ["handover.reaction-gone"] * 2
        both = tuple(Reaction(event=e, response=Response.PAUSE) for e in (leak, low))
        assert self.codes(progress, line(reactions=both)) == (progress, [])

    def test_mission_that_has_ended_matches_all(self):
        ended = Progress(active=None, outcome="cancelled")
        assert match_to_mission(ended, line()) == (ended, ())
