"""Effects of a visit's own times: waits, windows, limits and planned rounds."""

import pytest

from argo_compiler.base.model import Pose
from argo_compiler.hfsm import (
    ActionFailed,
    ActionStopped,
    ActionSucceeded,
    ByHand,
    CancelAction,
    Cause,
    Executor,
    GiveBack,
    Occurred,
    Outcome,
    Pause,
    Progress,
    ReadingGiven,
    ReadingKind,
    Resume,
    StartAction,
    TakeOver,
    Tick,
    lower,
)
from argo_compiler.hfsm.handover import hand_over, match_to_mission
from argo_compiler.il import (
    Action,
    Afterwards,
    Condition,
    ConditionType,
    EventKind,
    Group,
    Mission,
    Mode,
    OnFailure,
    Reaction,
    Response,
    Task,
    TimeWindow,
)
from tests.argo_compiler.hfsm.play import Play, failure, started, stopped, success
from tests.mission_writing import measure as task
from tests.mission_writing import wait
from tests.mission_writing import way as when

CLEAR = Occurred(EventKind.ALL_CLEAR)
DOCK = Pose(x=1, y=0, z=0)
HIGH = Condition(type=ConditionType.GREATER, object_id="A", param1=5)


def plan(*tasks, **fields):
    return Mission(tasks=tasks, dock=DOCK, **fields)


class TestWaits:
    @pytest.mark.rule("W1", "I5")
    def test_time_is_dated_when_it_was_over(self):
        play = Play(plan(wait("W", "A", duration=10), task("A")))
        assert (play.first_commands, play.running, play.next_deadline) == ([], None, 10)
        assert play.at(25, Tick()) == ["+A"]
        assert (play.trace[-1].time, play.trace[-1].detail) == (10, "waited 10 s")

    @pytest.mark.rule("W1")
    @pytest.mark.parametrize(("resumed", "ends"), [(5, 10), (30, 30)])
    def test_time_goes_on_while_interrupted(self, resumed, ends):
        play = Play(plan(wait("W", "A", duration=10), task("A")))
        play.at(2, Pause())
        assert play.next_deadline is None
        play.at(resumed, Resume())
        play.at(40, Tick())
        assert [e.time for e in play.trace if e.target == "A"] == [ends]

    @pytest.mark.rule("W2", "W3")
    @pytest.mark.parametrize(("at", "failed"), [(4, False), (10, False), (11, True)])
    def test_event_ends_it_up_to_its_limit(self, at, failed):
        play = Play(plan(wait("W", "A", event=EventKind.ALL_CLEAR, limit=10), task("A")))
        play.at(at, CLEAR)
        assert play.ended[0].failure == ("waited 10 s in vain" if failed else None)
        assert play.active_task == "A"

    @pytest.mark.rule("W2")
    def test_event_before_the_visit_does_not_count(self):
        play = Play(plan(task("A", "W"), wait("W", event=EventKind.ALL_CLEAR)))
        play.at(1, CLEAR)
        play.at(2, success("A"))
        assert (play.active_task, play.next_deadline) == ("W", None)
        play.at(3, CLEAR)
        assert play.finished

    @pytest.mark.rule("W2")
    def test_event_while_interrupted_counts_when_the_mission_goes_on(self):
        until = plan(
            wait("W", "A", event=EventKind.ALL_CLEAR, limit=10),
            task("A"),
            reactions=(Reaction(event=EventKind.ALL_CLEAR, response=Response.PAUSE),),
        )
        play = Play(until)
        assert play.at(4, CLEAR) == []
        assert (play.active_task, play.holding) == ("W", True)
        assert play.at(20, Resume()) == ["+A"]
        assert play.ended[0].failure is None

    @pytest.mark.rule("W2", "C8")
    def test_conditions_are_looked_at_when_a_reading_changes(self):
        old = HIGH.model_copy(update={"max_age": 3})
        play = Play(plan(wait("W", "B", conditions=(HIGH,)), task("A"), task("B")))
        play.at(1, ReadingGiven("A", 5))
        assert play.active_task == "W"
        assert play.at(2, ReadingGiven("A", 6)) == ["+B"]
        stale = Condition(type=ConditionType.STALE, object_id="A", max_age=3)
        play = Play(plan(wait("W", "B", conditions=(stale,)), task("A"), task("B")))
        play.at(1, ReadingGiven("A", 5))
        play.at(9, Tick())
        assert play.active_task == "W"  # it has been stale for long, but nobody has looked
        play.at(9, ReadingGiven("B", 1))
        assert play.active_task == "B"
        play = Play(plan(wait("W", "B", conditions=(old,)), task("A"), task("B")))
        play.at(1, Pause())
        play.at(2, ReadingGiven("A", 6))
        play.at(6, Resume())
        assert play.active_task == "W"

    @pytest.mark.rule("W3", "T7", "T8")
    def test_limit_leads_to_the_failure_branch(self):
        branch = {"on_failure": OnFailure.BRANCH, "failure_target": "B"}
        waiting = wait("W", "A", event=EventKind.ALL_CLEAR, limit=10, **branch)
        play = Play(plan(waiting, task("A"), task("B")))
        assert play.at(10, Tick()) == ["+B"]
        assert play.trace[-1].cause is Cause.FAILURE

    @pytest.mark.rule("G14", "W1")
    def test_ways_join_in_a_wait_of_no_time(self):
        ways = (when("End", HIGH), "B")
        tasks = (task("A", *ways), task("B", "End"), wait("End", "C", duration=0), task("C"))
        play = Play(
            plan(*tasks, groups=(Group(name="G", start="A", end="End", max_repeat_count=2),))
        )
        assert play.at(1, success("A", 9)) == ["+A"]
        assert play.rounds == {"G": 2}
        assert play.at(2, success("A", 1)) == ["+B"]
        assert play.at(3, success("B", 1)) == ["+C"]


class TestWindows:
    @pytest.mark.rule("W4", "W6")
    def test_action_is_told_when_it_may_begin(self):
        early = task("B", window=TimeWindow(earliest=50))
        executor = Executor(lower(plan(task("A", "B"), early)))
        executor.start(100)
        (command,) = executor.handle(ActionSucceeded("A"), 110)
        assert command == StartAction(early, 2, not_before=150)

    @pytest.mark.rule("W4")
    def test_wait_does_not_end_before(self):
        play = Play(plan(wait("W", duration=3, window=TimeWindow(earliest=9))))
        assert play.next_deadline == 9
        play.at(9, Tick())
        assert play.finished

    @pytest.mark.rule("W5", "W6", "C3", "M3")
    def test_missed_hard_window(self):
        window = TimeWindow(latest=20, missed_target="C")
        tasks = (task("A", "B"), task("B", "A", window=window, retries=3), task("C"))
        play = Play(plan(*tasks))
        play.at(5, success("A"))
        assert play.next_deadline == 20
        assert play.at(20, Tick()) == ["-B"]
        assert (play.active_task, play.trace[-1].cause) == ("C", Cause.MISSED)
        assert play.readings["B"].kind is ReadingKind.FAILED
        assert play.at(21, stopped("B")) == ["+C"]
        play.at(22, success("C"))
        assert play.outcome is Outcome.COMPLETED_WITH_FAILURES

    @pytest.mark.rule("W5")
    def test_what_ends_exactly_then_has_ended(self):
        play = Play(plan(task("A", window=TimeWindow(latest=20))))
        play.at(20, success("A"))
        assert play.outcome is Outcome.COMPLETED

    @pytest.mark.rule("W5")
    @pytest.mark.parametrize(("latest", "missed"), [(10, False), (9, True)])
    def test_wait_that_ends_exactly_then_has_ended(self, latest, missed):
        play = Play(plan(wait("W", duration=10, window=TimeWindow(latest=latest))))
        play.at(30, Tick())
        assert (play.ended[0].failure is not None) == missed

    @pytest.mark.rule("W5")
    def test_action_is_not_even_started_when_it_is_too_late(self):
        late = task("B", "C", window=TimeWindow(latest=5))
        play = Play(plan(task("A", "B"), late, task("C")))
        assert play.at(9, success("A")) == ["+C"]

    @pytest.mark.rule("W5")
    def test_takes_effect_when_the_mission_goes_on(self):
        play = Play(plan(task("A", "B", window=TimeWindow(latest=20)), task("B")))
        play.at(10, Pause())
        play.at(11, stopped("A"))
        assert play.at(30, Tick()) == []
        assert play.active_task == "A"
        assert play.at(40, Resume()) == ["+B"]
        assert play.trace[-1].time == 40

    @pytest.mark.rule("W5")
    def test_soft_window_changes_nothing(self):
        play = Play(plan(task("A", window=TimeWindow(latest=5, hard=False))))
        assert play.next_deadline is None
        play.at(9, success("A"))
        assert play.outcome is Outcome.COMPLETED


class TestTimeLimits:
    @pytest.mark.rule("T9", "T7")
    def test_attempt_that_takes_too_long_is_tried_again(self):
        play = Play(plan(task("A", "B", time_limit=10, retries=1), task("B")))
        assert play.at(12, Tick()) == ["-A"]
        assert (play.trace[-1].time, play.trace[-1].cause) == (10, Cause.RETRY)
        assert play.next_deadline is None
        assert play.at(13, stopped("A")) == ["+A"]
        assert play.next_deadline == 23
        assert play.at(23, Tick()) == ["-A"]
        assert play.ended[0].failure == "not done within 10 s"
        assert play.at(24, failure("A")) == ["+B"]

    @pytest.mark.rule("T9", "I3")
    def test_success_while_cancelled_ends_the_task(self):
        play = Play(plan(task("A", "B", time_limit=10, retries=1), task("B")))
        play.at(10, Tick())
        assert play.at(11, success("A", 3)) == ["+B"]
        assert [e.failure for e in play.ended] == [None]

    @pytest.mark.rule("T9", "I3")
    def test_success_after_it_failed_for_good_is_kept(self):
        play = Play(plan(task("A", "B", time_limit=10), task("B")))
        play.at(10, Tick())
        assert play.at(11, success("A", 3)) == ["+B"]
        assert play.values["A"].value == 3
        (tally,) = play.progress().tallies
        assert (tally.done, tally.failed, play.progress().failed) == (1, 1, True)

    @pytest.mark.rule("T9", "W4")
    def test_time_before_the_window_does_not_count(self):
        play = Play(plan(task("A", time_limit=10, window=TimeWindow(earliest=50))))
        assert play.next_deadline == 60

    @pytest.mark.rule("T9")
    def test_what_ends_exactly_then_has_ended(self):
        play = Play(plan(task("A", time_limit=10)))
        play.at(10, success("A"))
        assert play.outcome is Outcome.COMPLETED

    @pytest.mark.rule("T9", "I6")
    def test_interrupted_attempt_has_the_whole_limit_again(self):
        play = Play(plan(task("A", time_limit=10)))
        play.at(6, Pause())
        play.at(7, stopped("A"))
        assert play.next_deadline is None
        play.at(20, Resume())
        assert play.next_deadline == 30


class TestFailures:
    @pytest.mark.rule("T8", "G2", "G3")
    def test_branch_enters_groups_like_a_transition(self):
        failing = task("A", on_failure=OnFailure.BRANCH, failure_target="B")
        groups = (Group(name="G", start="B", end="B", max_repeat_count=2),)
        play = Play(plan(failing, task("B"), groups=groups))
        assert play.at(1, failure("A")) == ["+B"]
        assert play.rounds == {"G": 1}

    @pytest.mark.rule("M3", "T11")
    @pytest.mark.parametrize("optional", [False, True])
    def test_outcome_tells_of_failures_that_matter(self, optional):
        play = Play(plan(task("A", "B", optional=optional), task("B")))
        play.at(1, failure("A"))
        play.at(2, success("B"))
        failed = Outcome.COMPLETED_WITH_FAILURES
        assert play.outcome is (Outcome.COMPLETED if optional else failed)


class TestReadings:
    @pytest.mark.rule("C3", "C7")
    @pytest.mark.parametrize(
        ("event", "kind", "held"),
        [
            (ActionFailed("A", "dark", unreadable=True), "unreadable", {"UNREADABLE", "FAILED"}),
            (ActionSucceeded("A"), "unreadable", {"UNREADABLE", "FAILED"}),
            (
                ActionFailed("A", "no path", unreachable=True),
                "unreachable",
                {"UNREACHABLE", "FAILED"},
            ),
            (ActionFailed("A", "stuck"), "failed", {"FAILED"}),
            (ActionSucceeded("A", 1.0), "value", set()),
            (ActionSucceeded("A", 1.0, abnormal=True), "value", {"ABNORMAL"}),
        ],
    )
    def test_what_came_of_a_measurement(self, event, kind, held):
        for name in ("UNREADABLE", "UNREACHABLE", "FAILED", "ABNORMAL"):
            type = ConditionType[name]
            ways = (when("B", Condition(type=type, object_id="A")), "C")
            play = Play(plan(task("A", *ways), task("B"), task("C")))
            play.at(1, event)
            assert play.readings["A"].kind == kind
            assert (play.active_task == "B") == (type.name in held)

    @pytest.mark.rule("C5", "C7")
    @pytest.mark.parametrize(("at", "follows"), [(4, "C"), (5, "B")])
    def test_stale_is_older_than_its_age(self, at, follows):
        stale = Condition(type=ConditionType.STALE, object_id="A", max_age=3)
        ways = (when("B", stale), "C")
        play = Play(plan(task("A", "Z"), task("Z", *ways), task("B"), task("C")))
        play.at(1, success("A", 1.0))
        play.at(at, success("Z", 1.0))
        assert play.active_task == follows

    @pytest.mark.rule("C3", "T7")
    def test_attempts_and_stops_do_not_count(self):
        play = Play(plan(task("A", retries=1)))
        play.at(1, failure("A"))
        assert play.readings == {}
        play.at(2, Pause())
        play.at(2, stopped("A"))
        assert play.readings == {}

    @pytest.mark.rule("C3")
    @pytest.mark.parametrize("skipped", [False, True])
    def test_by_hand_without_a_value_leaves_none(self, skipped):
        play = Play(plan(task("A", "A")))
        play.at(1, success("A", 4.0))
        play.at(2, TakeOver())
        play.at(2, stopped("A"))
        play.at(3, GiveBack((ByHand(task="A", skipped=skipped),)))
        assert play.readings == {}


class TestRounds:
    def rounds(self, *tasks, **fields):
        return plan(*tasks, groups=(Group(name="G", start="A", end="A", **fields),))

    @pytest.mark.rule("G13")
    def test_begin_when_they_are_due_and_do_not_drift(self):
        play = Play(self.rounds(task("A"), max_repeat_count=4, every=10))
        assert play.at(3, success("A")) == []
        assert (play.active_task, play.rounds, play.next_deadline) == ("A", {"G": 2}, 10)
        assert play.progress().round_of == "G"
        assert play.at(10, Tick()) == ["+A"]
        assert play.trace[-1].cause is Cause.ROUND
        assert play.at(25, success("A")) == ["+A"]
        assert play.at(26, success("A")) == []
        assert play.next_deadline == 30

    @pytest.mark.rule("G13", "W1")
    def test_wait_counts_from_the_beginning_of_the_round(self):
        mission = plan(
            wait("W", "A", duration=4),
            task("A"),
            groups=(Group(name="G", start="W", end="A", max_repeat_count=2, every=10),),
        )
        play = Play(mission)
        play.at(4, Tick())
        play.at(5, success("A"))
        play.at(30, Tick())
        assert [e.time for e in play.trace if e.source == "W" and e.target == "A"] == [4, 14]

    @pytest.mark.rule("G8", "G13")
    def test_round_that_would_be_due_too_late_is_not_begun(self):
        play = Play(self.rounds(task("A"), max_repeat_duration=20, every=10))
        play.at(1, success("A"))
        play.at(10, Tick())
        play.at(11, success("A"))
        assert play.finished

    @pytest.mark.rule("G12", "G13")
    def test_clock_of_the_rounds_stands_with_the_mission(self):
        play = Play(self.rounds(task("A"), max_repeat_count=2, every=10))
        play.at(3, success("A"))
        play.at(4, Pause())
        play.at(9, Resume())
        assert play.next_deadline == 15

    @pytest.mark.rule("H1", "H2")
    def test_waits_for_the_round_after_a_handover(self):
        mission = self.rounds(task("A"), max_repeat_count=2, every=10)
        play = Play(mission)
        play.at(3, success("A"))
        later = Executor.restore(lower(mission), play.progress(), 100, away=50)
        assert later.start(100) == ()
        assert later.next_deadline == 107

    @pytest.mark.rule("G8")
    def test_until_ends_them(self):
        play = Play(self.rounds(task("A"), until=(HIGH,)))
        assert play.at(1, success("A", 5)) == ["+A"]
        assert play.at(2, success("A", 6)) == []
        assert play.finished


class TestOrder:
    @pytest.mark.rule("I5")
    def test_wait_ends_before_the_time_of_its_group_is_up(self):
        tasks = (wait("W", "A", duration=10), task("A"))
        groups = (Group(name="G", start="W", end="W", max_repeat_duration=10),)
        play = Play(plan(*tasks, groups=groups))
        play.at(10, Tick())
        assert [(e.time, e.cause) for e in play.trace[1:]] == [(10, Cause.DEFAULT)]

    @pytest.mark.rule("I5", "M4")
    def test_time_is_up_before_windows_are_missed(self):
        window = TimeWindow(latest=10)
        back = Reaction(event=EventKind.TIME_UP, response=Response.RETURN)
        play = Play(
            plan(task("A", "B", window=window), task("B"), max_duration=10, reactions=(back,))
        )
        play.at(10, Tick())
        assert (play.reaction, play.active_task) == (EventKind.TIME_UP, "A")

    @pytest.mark.rule("I5", "R5")
    def test_action_is_begun_anew_after_an_interruption_that_is_heard_of_when_it_is_over(self):
        hold = Reaction(
            event=EventKind.TIME_UP,
            response=Response.PAUSE,
            hold_limit=2,
            on_limit=Afterwards.RESUME,
        )
        plan_ = plan(task("A", time_limit=30), max_duration=5, reactions=(hold,))
        executor = started(plan_)
        (cancel,) = executor.handle(Tick(), 20)
        assert isinstance(cancel, CancelAction)
        (start,) = executor.handle(ActionStopped("A"), 21)
        assert isinstance(start, StartAction)
        assert executor.next_deadline == 51


class TestSupervision:
    @pytest.mark.rule("M9")
    def test_begins_paused(self):
        play = Play(plan(task("A"), mode=Mode.SUPERVISORY))
        assert (play.first_commands, play.paused) == ([], True)
        assert play.trace[-1].cause is Cause.PAUSE
        assert play.at(5, Resume()) == ["+A"]

    @pytest.mark.rule("M2", "M9")
    def test_start_alone_has_ended(self):
        alone = Mission(tasks=(Task(name="S", action=Action.START),), mode=Mode.SUPERVISORY)
        assert Play(alone).outcome is Outcome.COMPLETED


class TestByHand:
    @pytest.mark.rule("H3")
    @pytest.mark.parametrize(("age", "read"), [(None, 20), (5, 15)])
    def test_value_is_as_old_as_it_is(self, age, read):
        play = Play(plan(task("B", "A"), task("A", "B")))
        play.at(10, TakeOver())
        play.at(10, stopped("B"))
        play.at(20, GiveBack((ByHand(task="A", value=4, duration=60, age=age),)))
        play.at(30, success("B"))
        assert play.values["A"].time == read

    @pytest.mark.rule("H2", "H3")
    def test_second_handover_before_the_time_of_the_first_is_over(self):
        """The tasks of each handover take 60 s, and the ages of values are exact."""
        mission = plan(task("A", "B"), task("B", "C"), task("C"))
        play = Play(mission)
        play.at(10, TakeOver())
        play.at(10, stopped("A"))
        first = hand_over(play.progress(), [ByHand(task="A", value=4, duration=60)], away=60)
        executor = Executor.restore(lower(mission), first, 70)
        executor.start(70)
        executor.handle(Resume(), 70)
        executor.handle(TakeOver(), 75)
        (left,) = executor.progress().readings
        assert left.age == 5
        second = [ByHand(task="C", value=5, duration=60)]
        progress = hand_over(executor.progress(), second, away=30)
        assert progress.readings[0].age == 35
        again = Executor.restore(lower(mission), progress, 105)
        again.start(105)
        assert again.values["A"].time == 70
        assert again.progress().elapsed == 105

    @pytest.mark.rule("H3", "W1", "G13")
    def test_comes_before_the_wait(self):
        play = Play(plan(wait("W", "A", duration=60), task("A")))
        play.at(5, TakeOver())
        assert play.at(6, GiveBack((ByHand(task="W"),))) == ["+A"]

    @pytest.mark.rule("H3", "H2")
    @pytest.mark.parametrize("counts", [False, True])
    def test_its_time_is_that_of_groups_that_stood(self, counts):
        group = Group(
            name="G", start="A", end="B", max_repeat_duration=100, count_interruptions=counts
        )
        play = Play(plan(task("A", "B"), task("B"), groups=(group,)))
        play.at(10, TakeOver())
        play.at(10, stopped("A"))
        play.at(40, GiveBack((ByHand(task="A", duration=25),)))
        (clock,) = play.progress().groups
        assert clock.elapsed == (40 if counts else 35)


class TestStrictness:
    @pytest.mark.parametrize(
        "event",
        [
            Pause,
            "gas_leak",
            EventKind.GAS_LEAK,
            None,
            Occurred("gas_leak"),
            ReadingGiven("A", float("nan")),
            ReadingGiven("A", "7"),
            ReadingGiven(None, 7),
            ActionSucceeded("A", float("inf")),
            ActionSucceeded("A", 1.0, id=2),
            ActionFailed("A", "lost", id=0),
            GiveBack(("A",)),
        ],
    )
    def test_what_is_no_event_is_refused_and_changes_nothing(self, event):
        executor = started(plan(task("A", "B"), task("B")))
        before = executor.progress(), len(executor.trace)
        with pytest.raises(ValueError, match=r".+"):
            executor.handle(event, 5)
        assert (executor.progress(), len(executor.trace)) == before
        (command,) = executor.handle(ActionSucceeded("A", 1.0, id=1), 1)
        assert command.id == 2

    def test_end_that_is_delivered_twice_counts_once(self):
        groups = (Group(name="G", start="A", end="A", max_repeat_count=4),)
        executor = Executor(lower(plan(task("A"), groups=groups)))
        commands, delivered = executor.start(0), 0
        while commands:
            (command,) = commands
            end = ActionSucceeded("A", 1.0, id=command.id)
            delivered += 1
            commands = executor.handle(end, delivered)
            with pytest.raises(ValueError, match=r"another action|no action runs"):
                executor.handle(end, delivered)
        assert (delivered, executor.outcome) == (4, Outcome.COMPLETED)

    def test_unknown_checkpoint_may_be_told(self):
        executor = started(plan(task("A")))
        executor.handle(ReadingGiven("Z", 7), 1)
        assert executor.values["Z"].value == 7

    def test_no_call_from_inside_of_another(self):
        """A call is refused that comes from the clock which the executor reads."""
        executor = started(plan(task("A")))
        refused = []

        class Nosy(float):
            def __ge__(self, other):
                for call in (lambda: executor.handle(Tick(), 2.0), executor.progress):
                    with pytest.raises(ValueError, match="use one thread"):
                        call()
                    refused.append(call)
                return float(self) >= other

        executor.handle(Tick(), Nosy(1.0))
        assert refused
        assert executor.handle(Tick(), 2.0) == ()


class TestHistory:
    def test_views_are_what_had_happened(self):
        play = Play(plan(task("A", "A")))
        before = play.trace
        play.at(1, success("A"))
        assert (len(before), len(play.trace)) == (1, 2)
        assert play.trace[:1] == tuple(before)
        assert play.trace[-1] == list(play.trace)[1]
        assert before != play.trace
        with pytest.raises(IndexError):
            before[1]

    def test_progress_does_not_grow_with_the_rounds(self):
        play = Play(plan(task("A", "A")))
        sizes = set()
        for i in range(100, 200):
            play.at(i, success("A", 1.5))
            sizes.add(len(play.progress().model_copy(update={"elapsed": 0}).model_dump_json()))
        assert max(sizes) - min(sizes) < 5
        assert len(play.ended) == 100

    def test_ids_go_on_after_a_handover(self):
        mission = plan(task("A"))
        first = Executor(lower(mission))
        (begun,) = first.start(0)
        first.handle(Pause(), 1)
        first.handle(stopped("A"), 1)
        later = Executor.restore(lower(mission), first.progress(), 5)
        later.start(5)
        (command,) = later.handle(Resume(), 5)
        assert (begun.id, command.id) == (1, 2)

    def test_cancel_command_has_the_id(self):
        executor = started(plan(task("A", "B", time_limit=5), task("B")))
        (cancel,) = executor.handle(Tick(), 5)
        assert cancel == CancelAction("A", "not done within 5 s", 1)


class TestRemaining:
    def names(self, mission, active="A"):
        return [leaf.task.name for leaf in lower(mission, Progress(active=active)).leaves]

    @pytest.mark.rule("H5")
    def test_failure_branches_and_missed_windows_can_be_reached(self):
        window = TimeWindow(latest=20, missed_target="C")
        fields = {"on_failure": OnFailure.BRANCH, "failure_target": "B", "window": window}
        tasks = (task("A", **fields), task("B"), task("C"), task("D"))
        assert self.names(plan(*tasks)) == ["A", "B", "C"]
        soft = window.model_copy(update={"hard": False, "missed_target": None})
        first = tasks[0].model_copy(update={"window": soft})
        assert self.names(plan(first, *tasks[1:])) == ["A", "B"]

    @pytest.mark.rule("H5", "W3")
    @pytest.mark.parametrize(("limit", "expected"), [(None, "A C"), (5, "A B C")])
    def test_wait_without_a_limit_can_not_fail(self, limit, expected):
        branch = {"on_failure": OnFailure.BRANCH, "failure_target": "B"}
        waiting = wait("A", "C", event=EventKind.ALL_CLEAR, limit=limit, **branch)
        assert self.names(plan(waiting, task("B"), task("C"))) == expected.split()

    @pytest.mark.rule("H6", "G13")
    @pytest.mark.parametrize(("every", "kept"), [(10, "G"), (0, None)])
    def test_round_that_is_not_planned_any_more_is_not_awaited(self, every, kept):
        group = Group(name="G", start="A", end="A", max_repeat_count=3, every=10)
        play = Play(plan(task("A"), groups=(group,)))
        play.at(3, success("A"))
        edited = plan(task("A"), groups=(group.model_copy(update={"every": every}),))
        matched, findings = match_to_mission(play.progress(), edited)
        assert (matched.round_of, findings) == (kept, ())
        later = Executor.restore(lower(edited), matched, 3)
        assert len(later.start(3)) == (kept is None)
