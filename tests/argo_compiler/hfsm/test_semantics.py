"""Semantics of missions: each rule on the smallest mission that shows it."""

import pytest

from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.hfsm import ActionSucceeded, Cause, Executor, ReadingKind, Tick, lower
from argo_compiler.il import (
    Action,
    Condition,
    ConditionType,
    Group,
    Mission,
    Stop,
    Task,
    TimeWindow,
    Transition,
)
from tests.argo_compiler.hfsm.play import build, drive, path
from tests.mission_writing import above
from tests.mission_writing import way as when


class TestTasks:
    @pytest.mark.rule("M3", "T5")
    def test_follow_their_transitions_until_one_has_none(self):
        executor = drive(build("A B C", transitions={"A": ["C"], "C": ["B"], "B": []}))
        assert path(executor) == "A@0 C@1 B@2 end@3"

    @pytest.mark.rule("T3")
    @pytest.mark.rule("C1", "C2")
    @pytest.mark.rule("G10")
    @pytest.mark.rule("G8")
    @pytest.mark.parametrize(("value", "expected"), [(5.0, "A@0 C@1 end@2"), (3.0, "A@0 B@1")])
    def test_unconditional_comes_last_wherever_it_stands(self, value, expected):
        mission = build("A B C", transitions={"A": ["B", when("C", above("A", 3))]})
        assert path(drive(mission, reads={"A": [value]})).startswith(expected)

    @pytest.mark.rule("T2")
    def test_first_transition_whose_conditions_all_hold(self):
        ways = {
            "A": [
                when("B", above("A", 1), above("A", 9)),
                when("C", above("A", 1)),
                when("D", above("A", 0)),
            ]
        }
        executor = drive(build("A B C D", transitions=ways), reads={"A": [5]})
        assert path(executor) == "A@0 C@1 D@2 end@3"
        assert executor.trace[1].cause is Cause.CONDITION
        assert executor.trace[1].conditions == ("#A > 1",)

    @pytest.mark.rule("M3", "T4")
    def test_mission_ends_when_no_condition_holds(self):
        executor = drive(build("A B", transitions={"A": [when("B", above("A", 1))]}))
        assert path(executor) == "A@0 end@1"
        assert executor.finished
        assert executor.configuration == ("mission", "done")

    @pytest.mark.rule("T8", "C4")
    def test_failure_is_recorded_and_the_mission_goes_on(self):
        ways = {"A": [when("C", above("A", -1)), "B"]}
        executor = drive(build("A B C", transitions=ways), reads={"A": [None]})
        assert path(executor) == "A@0 B@1 C@2 end@3"
        assert executor.trace[1].failure == "no view"
        assert str(executor.trace[1]) == "1 s: A -> B (default; failed: no view)"

    @pytest.mark.rule("T8", "C3", "C4", "C6")
    def test_failure_takes_the_place_of_the_value_before(self):
        executor = drive(
            build("A B", transitions={"B": [when("A", above("B", 0))]}), reads={"B": [1]}
        )
        assert executor.values["B"].value == 0
        mission = build("A", transitions={"A": [when("A", above("A", 0))]})
        executor = drive(mission, reads={"A": [4, None, 0]})
        assert [entry.failure for entry in executor.trace[1:]] == [None, "no view"]
        assert executor.readings["A"].kind is ReadingKind.FAILED
        assert executor.values == {}

    @pytest.mark.rule("C5")
    @pytest.mark.parametrize(("takes", "reached"), [(5.0, "A"), (5.5, "end")])
    def test_value_counts_up_to_its_greatest_age(self, takes, reached):
        mission = build("A B", transitions={"B": [when("A", above("A", 0, max_age=5))]})
        executor = drive(mission, takes={"B": takes}, reads={"A": [1, 0]})
        assert (executor.trace[2].target or "end") == reached

    @pytest.mark.parametrize("inclusive", [False, True])
    @pytest.mark.parametrize(
        ("type", "value", "holds"),
        [
            (ConditionType.LESS, 1.9, True),
            (ConditionType.LESS, 2.0, None),
            (ConditionType.LESS, 2.1, False),
            (ConditionType.GREATER, 1.9, False),
            (ConditionType.GREATER, 2.0, None),
            (ConditionType.GREATER, 2.1, True),
            (ConditionType.WITHIN, 1.9, False),
            (ConditionType.WITHIN, 2.0, None),
            (ConditionType.WITHIN, 2.5, True),
            (ConditionType.WITHIN, 3.0, None),
            (ConditionType.WITHIN, 3.1, False),
        ],
    )
    def test_comparisons_exclude_their_bounds(self, type, value, holds, inclusive):
        """On a bound (`holds` is None), `inclusive` decides."""
        condition = Condition(type=type, object_id="A", param1=2, param2=3, inclusive=inclusive)
        mission = build("A B C", transitions={"A": ["B", when("C", condition)]})
        expected = inclusive if holds is None else holds
        assert drive(mission, reads={"A": [value]}).trace[1].target == ("C" if expected else "B")

    @pytest.mark.rule("C3")
    def test_value_is_the_last_one_whoever_measured_it(self):
        ways = {"B": [when("D", above("A", 5)), "C"]}
        mission = build("A B C D", transitions=ways)
        again = mission.tasks[1].model_copy(update={"object_id": "A"})
        mission = mission.model_copy(
            update={"tasks": (mission.tasks[0], again, *mission.tasks[2:])}
        )
        assert path(drive(mission, reads={"A": [1], "B": [9]})) == "A@0 B@1 D@2 end@3"
        assert path(drive(mission, reads={"A": [9], "B": [1]})).startswith("A@0 B@1 C@2")

    @pytest.mark.rule("C4")
    @pytest.mark.parametrize("type", ConditionType)
    def test_what_was_never_measured_holds_never(self, type):
        bounds = {"param1": 0, "param2": 1} if type.compares else {"max_age": 1}
        never = Condition(type=type, object_id="B", **bounds)
        mission = build("A B C", transitions={"A": [when("C", never), "B"]})
        assert path(drive(mission)).startswith("A@0 B@1")

    @pytest.mark.rule("M5")
    def test_what_is_for_display_changes_nothing(self):
        mission = build("A B")
        shown = tuple(task.model_copy(update={"group": "G"}) for task in mission.tasks)
        shown_mission = mission.model_copy(update={"tasks": shown, "current": "B"})
        assert path(drive(shown_mission)) == path(drive(mission)) == "A@0 B@1 end@2"

    @pytest.mark.rule("T1", "G9")
    def test_what_has_no_meaning_is_refused(self):
        mission = build("A B", Group(name="G", start="A", end="B"), transitions={"B": ["A"]})
        with pytest.raises(DiagnosticError, match=r"il\.endless-group"):
            lower(mission)
        twice = build("A").model_copy(update={"tasks": build("A").tasks * 2})
        with pytest.raises(DiagnosticError, match=r"il\.duplicate-task"):
            lower(twice)
        task = build("A").tasks[0].model_copy(update={"object_id": None})
        with pytest.raises(DiagnosticError, match=r"il\.measure-without-object"):
            lower(Mission(tasks=(task,)))


class TestStart:
    @pytest.mark.rule("M1", "M2")
    def test_is_passed_over(self):
        start = Task(name="S", action=Action.START, transitions=(Transition(target="B"),))
        mission = build("A B")
        mission = mission.model_copy(update={"tasks": (start, *mission.tasks)})
        assert path(drive(mission)) == "B@0 end@1"

    @pytest.mark.rule("M1")
    def test_without_transition_leads_to_the_first_task(self):
        start = Task(name="S", action=Action.START)
        mission = build("A B")
        mission = mission.model_copy(update={"tasks": (*mission.tasks, start)})
        assert path(drive(mission)) == "A@0 B@1 end@2"

    @pytest.mark.rule("M2")
    def test_alone_is_a_mission_that_has_ended(self):
        mission = Mission(tasks=(Task(name="S", action=Action.START),))
        executor = Executor(lower(mission))
        assert executor.start(0) == ()
        assert executor.finished


class TestRounds:
    @pytest.mark.rule("G1", "G5", "G8")
    def test_count_is_the_number_of_rounds_in_all(self):
        mission = build("A B C", Group(name="G", start="A", end="B", max_repeat_count=2))
        executor = drive(mission)
        assert path(executor) == "A@0 B@1 A@2 B@3 C@4 end@5"
        assert executor.trace[2].repeated == "G"

    @pytest.mark.rule("G5", "G7")
    def test_inner_decides_first_and_is_entered_anew(self):
        groups = (
            Group(name="G", start="A", end="B", max_repeat_count=2),
            Group(name="G/H", start="B", end="B", max_repeat_count=2),
        )
        executor = drive(build("A B C", *groups))
        assert path(executor) == "A@0 B@1 B@2 A@3 B@4 B@5 C@6 end@7"

    @pytest.mark.rule("G1", "G7")
    def test_groups_of_the_same_range_multiply(self):
        groups = (
            Group(name="G/H", start="A", end="A", max_repeat_count=3),
            Group(name="G", start="A", end="A", max_repeat_count=2),
        )
        executor = drive(build("A B", *groups))
        assert path(executor) == "A@0 A@1 A@2 A@3 A@4 A@5 B@6 end@7"

    @pytest.mark.rule("G2")
    def test_entry_in_the_middle_is_round_one(self):
        group = Group(name="G", start="B", end="C", max_repeat_count=2)
        executor = drive(build("A B C D", group, transitions={"A": ["C"]}))
        assert path(executor) == "A@0 C@1 B@2 C@3 D@4 end@5"

    @pytest.mark.rule("G4")
    def test_jump_inside_changes_no_round(self):
        group = Group(name="G", start="A", end="B", max_repeat_count=2)
        mission = build("A B C", group, transitions={"B": [when("A", above("B", 0)), "C"]})
        executor = drive(mission, reads={"B": [1, 0, 0]})
        assert path(executor) == "A@0 B@1 A@2 B@3 A@4 B@5 C@6 end@7"

    @pytest.mark.rule("G3")
    def test_condition_leaves_in_the_middle_and_entry_starts_anew(self):
        group = Group(name="G", start="A", end="B", max_repeat_count=2)
        ways = {"A": [when("C", above("A", 0)), "B"], "C": [when("A", above("A", 0))]}
        executor = drive(build("A B C", group, transitions=ways), reads={"A": [0, 1, 0, 0]})
        assert path(executor) == "A@0 B@1 A@2 C@3 A@4 B@5 A@6 B@7 C@8 end@9"

    @pytest.mark.rule("G6")
    def test_unconditional_to_a_member_after_the_last_round_enters_anew(self):
        group = Group(name="G", start="A", end="B", max_repeat_count=2)
        ways = {"B": ["A"], "A": [when("C", above("A", 0)), "B"], "C": []}
        executor = drive(build("A B C", group, transitions=ways), reads={"A": [0, 0, 0, 0, 1]})
        assert path(executor) == "A@0 B@1 A@2 B@3 A@4 B@5 A@6 B@7 A@8 C@9 end@10"
        assert [e.cause for e in executor.trace if e.source == "B"] == [
            Cause.REPEAT,
            Cause.DEFAULT,
            Cause.REPEAT,
            Cause.DEFAULT,
        ]

    @pytest.mark.rule("G9")
    def test_endless_group_is_left_by_a_condition(self):
        group = Group(name="G", start="A", end="B")
        ways = {"B": ["C", when("C", above("B", 0))]}
        executor = drive(build("A B C", group, transitions=ways), reads={"B": [0, 0, 1]})
        assert path(executor) == "A@0 B@1 A@2 B@3 A@4 B@5 C@6 end@7"


class TestDurations:
    def group(self, stop: Stop, duration: float, count: int = 0, name: str = "G") -> Group:
        return Group(
            name=name,
            start="A",
            end="B",
            max_repeat_duration=duration,
            max_repeat_count=count,
            stop=stop,
        )

    @pytest.mark.rule("G10")
    def test_hard_leaves_at_once(self):
        executor = drive(build("A B C", self.group(Stop.HARD, 2.5)))
        assert path(executor) == "A@0 B@1 A@2 C@2.5 end@3.5"
        assert executor.trace[3].timed_out == "G"
        assert str(executor.trace[3]) == "2.5 s: A -> C (time of 'G' is up)"

    @pytest.mark.rule("G11")
    def test_action_that_ends_with_the_time_has_ended(self):
        executor = drive(build("A B C", self.group(Stop.HARD, 3)), reads={"A": [1, 2]})
        assert path(executor) == "A@0 B@1 A@2 B@3 C@3 end@4"
        assert executor.values["A"].value == 2

    @pytest.mark.rule("G8", "G10")
    @pytest.mark.parametrize(
        ("stop", "duration", "count", "expected"),
        [
            (Stop.SOFT, 3, 0, "A@0 B@1 A@2 B@3 C@4 end@5"),
            (Stop.SOFT, 2, 0, "A@0 B@1 C@2 end@3"),  # no round is wanted exactly at its time
            (Stop.HARD, 9, 1, "A@0 B@1 C@2 end@3"),
            (Stop.HARD, 2.5, 9, "A@0 B@1 A@2 C@2.5 end@3.5"),
        ],
    )
    def test_whichever_limit_comes_first(self, stop, duration, count, expected):
        assert path(drive(build("A B C", self.group(stop, duration, count)))) == expected

    @pytest.mark.rule("G2")
    def test_clock_starts_at_the_entry(self):
        group = Group(name="G", start="B", end="B", max_repeat_duration=1.5)
        executor = drive(build("A B C", group), takes={"A": 10})
        assert path(executor) == "A@0 B@10 B@11 C@11.5 end@12.5"

    def test_mission_ends_if_the_end_leads_nowhere(self):
        assert path(drive(build("A B", self.group(Stop.HARD, 0.5)))) == "A@0 end@0.5"

    @pytest.mark.rule("G7", "G10")
    def test_time_out_lets_outer_groups_decide(self):
        groups = (
            Group(name="G", start="Z", end="B", max_repeat_count=2),
            self.group(Stop.HARD, 1.5, name="G/H"),
        )
        executor = drive(build("Z A B C", *groups))
        assert path(executor) == "Z@0 A@1 B@2 Z@2.5 A@3.5 B@4.5 C@5 end@6"
        assert executor.trace[3].timed_out == "G/H"
        assert executor.trace[3].repeated == "G"

    @pytest.mark.rule("G11")
    def test_outermost_of_several_is_left(self):
        groups = (
            Group(name="G", start="A", end="C", max_repeat_duration=0.5),
            Group(name="G/H", start="A", end="B", max_repeat_duration=0.5),
        )
        executor = drive(build("A B C D", *groups))
        assert path(executor) == "A@0 D@0.5 end@1.5"

    @pytest.mark.rule("G6")
    def test_time_out_back_into_the_group_enters_it_anew(self):
        mission = build("A B", self.group(Stop.HARD, 1.5), transitions={"B": ["A"]})
        executor = drive(mission, max_actions=5)
        assert path(executor) == "A@0 B@1 A@1.5 B@2.5 A@3 B@4"


@pytest.mark.rule("G13", "W5", "W7")
def test_window_that_is_over_is_missed_when_the_round_is_due():
    """Otherwise rounds without a limit would follow each other in no time."""
    mission = build("A", Group(name="G", start="A", end="A", every=10, until=(above("A", 9),)))
    window = TimeWindow(latest=5)
    task = mission.tasks[0].model_copy(update={"window": window})
    executor = Executor(lower(mission.model_copy(update={"tasks": (task,)})))
    executor.start(0)
    executor.handle(ActionSucceeded("A", 0), 3)
    assert executor.handle(Tick(), 7) == ()
    assert executor.active_task == "A"
    assert not executor.progress().failed
    assert executor.handle(Tick(), 10) == ()
    assert (executor.progress().failed, executor.rounds["G"]) == (True, 3)
