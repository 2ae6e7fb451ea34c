"""Failures, reactions and commands of persons: each rule on the smallest mission that shows it."""

import pytest

from argo_compiler.base.model import Pose
from argo_compiler.hfsm import Cancel, Cause, Occurred, Outcome, Pause, Resume, Tick
from argo_compiler.il import Afterwards, EventKind, Group, Mission, OnFailure, Reaction, Response
from tests.argo_compiler.hfsm.play import Play, failure, stopped, success
from tests.mission_writing import measure as task

DOCK = Pose(x=1, y=0, z=0)
SHELTER = Pose(x=2, y=0, z=0)
LEAK, BATTERY = Occurred(EventKind.GAS_LEAK), Occurred(EventKind.LOW_BATTERY)
CLEAR, ALARM = Occurred(EventKind.ALL_CLEAR), Occurred(EventKind.PLATFORM_ALARM)


def plan(*tasks, **fields):
    return Mission(tasks=tasks or (task("A", "B"), task("B")), dock=DOCK, **fields)


def reaction(event, response, **fields):
    pose = SHELTER if response is Response.SAFE_AREA else None
    return Reaction(event=event.event, response=response, pose=pose, **fields)


def interrupted(by, **fields):
    """Return the play of a mission with these fields, in which an event stops A at 1 s."""
    play = Play(plan(**fields))
    play.at(1, by)
    play.at(1, stopped("A"))
    return play


class TestFailures:
    @pytest.mark.rule("T7")
    def test_retries_are_those_of_a_visit(self):
        play = Play(plan(task("A", "A", retries=1)))
        assert play.at(1, failure("A")) == ["+A"]
        assert play.trace[-1].cause is Cause.RETRY
        assert play.ended == ()
        assert play.at(2, failure("A")) == ["+A"]
        assert play.trace[-1].cause is Cause.DEFAULT
        assert play.at(3, failure("A")) == ["+A"]
        assert play.trace[-1].cause is Cause.RETRY
        assert [e.failure for e in play.ended] == ["stuck"]

    @pytest.mark.rule("T8")
    @pytest.mark.parametrize(
        ("drive", "outcome"),
        [
            (success("return to dock"), Outcome.RETURNED),
            (failure("return to dock"), Outcome.FAILED),
        ],
    )
    def test_return(self, drive, outcome):
        play = Play(plan(task("A", "B", on_failure=OnFailure.RETURN), task("B")))
        assert play.at(1, failure("A")) == ["+return to dock"]
        assert play.running.pose == DOCK
        assert play.at(2, drive) == []
        assert (play.outcome, play.finished) == (outcome, True)

    @pytest.mark.rule("T8")
    def test_abort_and_continue(self):
        play = Play(plan(task("A", "B"), task("B", "A", on_failure=OnFailure.ABORT)))
        assert play.at(1, failure("A")) == ["+B"]
        assert play.at(2, failure("B")) == []
        assert play.outcome is Outcome.ABORTED


class TestReactions:
    @pytest.mark.rule("R1")
    @pytest.mark.parametrize("known", [(), (reaction(LEAK, Response.REPORT),)])
    def test_report(self, known):
        play = Play(plan(reactions=known))
        assert play.at(3, Occurred(EventKind.GAS_LEAK, "at valve 2")) == []
        entry = play.trace[-1]
        assert (entry.time, entry.event, entry.detail) == (3, EventKind.GAS_LEAK, "at valve 2")
        assert (entry.source, entry.target) == ("A", "A")

    @pytest.mark.rule("R2", "R5", "G12")
    def test_return_and_resume(self):
        group = Group(name="G", start="A", end="B", max_repeat_duration=10)
        back = reaction(BATTERY, Response.RETURN, afterwards=Afterwards.RESUME)
        play = Play(plan(groups=(group,), reactions=(back,)))
        play.at(4, success("A", 7.0))
        assert play.at(5, BATTERY) == ["-B"]
        assert play.configuration == ("mission", "group:G", "task:B", "reaction:low_battery")
        assert play.next_deadline is None
        assert play.at(6, stopped("B")) == ["+react to low_battery"]
        assert play.running.pose == DOCK
        assert play.at(105, success("react to low_battery")) == ["+B"]
        assert (play.next_deadline, play.rounds) == (110, {"G": 1})
        assert play.progress().groups[0].elapsed == 5
        assert play.values["A"].value == 7
        assert play.reaction is None

    @pytest.mark.rule("R3", "R4")
    def test_pause_until(self):
        play = Play(plan(reactions=(reaction(LEAK, Response.PAUSE, until=CLEAR.event),)))
        assert play.at(1, LEAK) == ["-A"]
        assert play.at(2, stopped("A")) == []
        assert play.holding
        assert play.at(9, CLEAR) == ["+A"]

    @pytest.mark.rule("R3")
    def test_until_counts_from_the_event_on(self):
        shelter = reaction(
            LEAK, Response.SAFE_AREA, until=CLEAR.event, afterwards=Afterwards.RESUME
        )
        play = interrupted(LEAK, reactions=(shelter,))
        assert play.running.pose == SHELTER
        play.at(2, CLEAR)
        assert play.at(3, success("react to gas_leak")) == ["+A"]

    @pytest.mark.rule("R3")
    def test_person_ends_a_hold(self):
        play = interrupted(LEAK, reactions=(reaction(LEAK, Response.PAUSE),))
        assert (play.at(2, Pause()), play.at(3, Resume())) == ([], [])
        assert play.holding
        assert play.at(4, Resume()) == ["+A"]

    @pytest.mark.rule("R4")
    @pytest.mark.parametrize(
        ("response", "outcome"),
        [(Response.RETURN, Outcome.RETURNED), (Response.SAFE_AREA, Outcome.SHELTERED)],
    )
    def test_end(self, response, outcome):
        play = interrupted(LEAK, reactions=(reaction(LEAK, response),))
        play.at(3, success("react to gas_leak"))
        assert (play.outcome, play.finished, play.active_task) == (outcome, True, None)

    @pytest.mark.rule("R4")
    def test_wait(self):
        wait = reaction(LEAK, Response.RETURN, afterwards=Afterwards.WAIT)
        play = interrupted(LEAK, reactions=(wait,))
        assert play.at(3, success("react to gas_leak")) == []
        assert play.paused
        assert play.at(4, Resume()) == ["+A"]

    @pytest.mark.rule("R6")
    def test_abort(self):
        play = Play(plan(reactions=(reaction(LEAK, Response.ABORT),)))
        assert play.at(1, LEAK) == ["-A"]
        assert (play.outcome, play.finished) == (Outcome.ABORTED, False)
        assert play.at(2, stopped("A")) == []
        assert play.finished

    @pytest.mark.rule("R7")
    def test_priorities(self):
        low = reaction(LEAK, Response.PAUSE, until=CLEAR.event, priority=1)
        equal = reaction(BATTERY, Response.RETURN, afterwards=Afterwards.RESUME, priority=1)
        high = reaction(ALARM, Response.SAFE_AREA, afterwards=Afterwards.RESUME, priority=2)
        play = interrupted(LEAK, reactions=(low, equal, high))
        assert play.at(2, BATTERY) == []
        assert play.at(2, BATTERY) == []
        assert play.at(3, ALARM) == ["+react to platform_alarm"]
        assert [w.event for w in play.progress().waiting] == [LEAK.event, BATTERY.event]
        assert play.at(4, success("react to platform_alarm")) == []
        assert (play.reaction, play.holding) == (LEAK.event, True)
        assert play.at(5, CLEAR) == ["+react to low_battery"]
        assert play.at(6, success("react to low_battery")) == ["+A"]

    @pytest.mark.rule("R8")
    @pytest.mark.parametrize("afterwards", Afterwards)
    def test_drive_fails(self, afterwards):
        back = reaction(LEAK, Response.RETURN, afterwards=afterwards)
        play = interrupted(LEAK, reactions=(back,))
        play.at(3, failure("react to gas_leak"))
        ends = afterwards is Afterwards.END
        assert (play.outcome, play.paused) == (Outcome.FAILED if ends else None, not ends)

    @pytest.mark.rule("R9")
    def test_events_while_paused(self):
        back = reaction(LEAK, Response.RETURN, afterwards=Afterwards.RESUME)
        stop = reaction(ALARM, Response.ABORT)
        play = interrupted(Pause(), reactions=(back, stop))
        assert play.at(2, LEAK) == []
        assert play.at(3, Resume()) == ["+react to gas_leak"]
        play.at(4, Pause())
        play.at(4, stopped("react to gas_leak"))
        assert play.at(5, Resume()) == ["+react to gas_leak"]
        play.at(6, success("react to gas_leak"))
        play.at(7, Pause())
        play.at(8, ALARM)
        assert play.outcome is Outcome.ABORTED

    @pytest.mark.rule("R10")
    @pytest.mark.parametrize(("priority", "asked"), [(1, ["+A"]), (2, ["+react to all_clear"])])
    def test_event_that_ends_a_hold_and_has_a_reaction(self, priority, asked):
        hold = reaction(LEAK, Response.PAUSE, until=CLEAR.event, priority=1)
        home = reaction(CLEAR, Response.RETURN, priority=priority)
        play = interrupted(LEAK, reactions=(hold, home))
        assert play.at(2, CLEAR) == asked


class TestTimeUp:
    @pytest.mark.rule("M4")
    def test_occurs_once_and_the_mission_goes_on(self):
        play = Play(plan(max_duration=5))
        assert play.next_deadline == 5
        assert play.at(7, Tick()) == []
        assert play.next_deadline is None
        assert [(e.time, e.event) for e in play.trace[1:]] == [(5, EventKind.TIME_UP)]
        assert play.progress().time_up

    @pytest.mark.rule("M4")
    def test_counts_pauses_and_may_be_reacted_to(self):
        up = Reaction(event=EventKind.TIME_UP, response=Response.RETURN)
        play = interrupted(Pause(), max_duration=5, reactions=(up,))
        play.at(5, Tick())
        assert play.at(8, Resume()) == ["+react to time_up"]

    @pytest.mark.rule("M4")
    def test_mission_that_ends_just_then(self):
        play = Play(plan(task("A"), max_duration=5))
        play.at(5, success("A"))
        assert (play.outcome, play.progress().time_up) == (Outcome.COMPLETED, False)


class TestPersons:
    @pytest.mark.rule("I1")
    def test_pause_and_resume(self):
        play = Play(plan())
        assert play.at(1, Pause()) == ["-A"]
        assert play.at(2, Resume()) == []
        assert play.at(3, stopped("A")) == ["+A"]

    @pytest.mark.rule("I2")
    def test_cancel(self):
        play = Play(plan())
        assert play.at(1, Cancel()) == ["-A"]
        assert (play.outcome, play.finished) == (Outcome.CANCELLED, False)
        play.at(2, stopped("A"))
        assert play.finished

    @pytest.mark.rule("I3", "R5")
    def test_success_while_cancelled_counts(self):
        play = Play(plan())
        play.at(1, Pause())
        assert play.at(2, success("A", 4.0)) == []
        assert (play.active_task, play.values["A"].value) == ("B", 4)
        assert play.at(3, Resume()) == ["+B"]
        assert [e.task for e in play.ended] == ["A"]

    @pytest.mark.rule("I3")
    def test_failure_while_cancelled_is_a_stop(self):
        play = Play(plan(task("A", on_failure=OnFailure.ABORT)))
        play.at(1, Pause())
        play.at(2, failure("A"))
        assert (play.outcome, play.progress().attempt) == (None, 0)
        assert play.at(3, Resume()) == ["+A"]

    @pytest.mark.rule("I3", "I4", "I5")
    def test_next_action_waits_for_the_clean_up(self):
        group = Group(name="G", start="A", end="A", max_repeat_duration=5)
        play = Play(plan(groups=(group,)))
        assert play.at(6, Tick()) == ["-A"]
        assert (play.active_task, play.running.name, play.trace[-1].time) == ("B", "A", 5)
        assert play.at(7, Tick()) == []
        assert play.at(8, success("A", 1.0)) == ["+B"]
        assert (play.values["A"].value, play.active_task) == (1, "B")
        with pytest.raises(ValueError, match="'B' does"):
            play.at(9, success("A"))

    @pytest.mark.rule("I6")
    def test_retries_go_on_after_an_interruption(self):
        play = Play(plan(task("A", "B", retries=1), task("B")))
        play.at(1, failure("A"))
        play.at(2, Pause())
        play.at(2, stopped("A"))
        play.at(3, Resume())
        assert play.at(4, failure("A")) == ["+B"]

    @pytest.mark.rule("R5")
    def test_last_task_that_succeeds_while_cancelled_ends_the_mission_when_it_goes_on(self):
        play = Play(plan(task("A")))
        play.at(1, Pause())
        play.at(2, success("A"))
        assert (play.active_task, play.outcome) == (None, None)
        play.at(3, Resume())
        assert play.outcome is Outcome.COMPLETED

    @pytest.mark.rule("G12")
    def test_group_that_counts_interruptions_is_left_when_the_mission_goes_on(self):
        group = Group(name="G", start="A", end="A", max_repeat_duration=5, count_interruptions=True)
        play = interrupted(Pause(), groups=(group,))
        assert play.next_deadline is None
        assert play.at(9, Tick()) == []
        assert play.at(10, Resume()) == ["+B"]
        assert (play.trace[-1].cause, play.trace[-1].time) == (Cause.TIMEOUT, 10)
