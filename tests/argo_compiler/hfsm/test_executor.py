import json

import pytest

from argo_compiler.base.errors import ArgoError
from argo_compiler.hfsm import (
    ActionFailed,
    ActionStopped,
    ActionSucceeded,
    CancelAction,
    Cause,
    EndedVisit,
    Executor,
    Measured,
    Pause,
    Progress,
    StartAction,
    Tick,
    lower,
)
from argo_compiler.hfsm.progress import Waiting
from argo_compiler.hfsm.trace import TracedRound
from argo_compiler.il import EventKind, Group, Stop
from tests.argo_compiler.hfsm.play import build, drive, started


@pytest.fixture
def mission():
    """A, then B and C in a group for 10 s, then D."""
    return build("A B C D", Group(name="G", start="B", end="C", max_repeat_duration=10))


@pytest.fixture
def executor(mission):
    return Executor(lower(mission))


class TestCommands:
    def test_start_and_end_of_actions(self, executor, mission):
        assert executor.start(5) == (StartAction(mission.tasks[0], 1),)
        assert executor.handle(Tick(), 6) == ()
        assert executor.handle(ActionSucceeded("A", 2.5), 7) == (StartAction(mission.tasks[1], 2),)
        assert executor.values == {"A": Measured(2.5, 7)}

    def test_time_out_cancels(self, executor, mission):
        executor.start(0)
        executor.handle(ActionSucceeded("A"), 1)
        assert executor.next_deadline == 11
        assert executor.handle(Tick(), 11) == (CancelAction("B", "the time of 'G' is up", 2),)
        assert executor.next_deadline is None
        assert executor.active_task == "D"
        assert executor.handle(Tick(), 12) == ()
        assert executor.handle(ActionStopped("B"), 13) == (StartAction(mission.tasks[3], 3),)

    def test_late_driver_gets_the_same_machine(self, executor, mission):
        executor.start(0)
        executor.handle(ActionSucceeded("A"), 1)
        commands = executor.handle(ActionSucceeded("B", 3.0), 20)
        assert commands == (StartAction(mission.tasks[3], 3),)
        assert executor.values["B"] == Measured(3, 20)
        assert [entry.time for entry in executor.trace[-2:]] == [11, 20]
        assert executor.trace[-1].cause is Cause.LATE

    def test_late_driver_starts_and_cancels_nothing_in_between(self):
        group = Group(name="G", start="A", end="A", max_repeat_duration=1)
        mission = build("A", group, transitions={"A": ["A"]})
        executor = started(mission)
        (cancel,) = executor.handle(Tick(), 3.5)
        assert isinstance(cancel, CancelAction)
        assert executor.handle(ActionStopped("A"), 3.5) == (StartAction(mission.tasks[0], 2),)
        assert [entry.time for entry in executor.trace] == [0, 1, 2, 3]

    def test_task_that_leads_to_itself_is_started_again(self):
        mission = build("A", transitions={"A": ["A"]})
        executor = started(mission)
        assert executor.handle(ActionSucceeded("A"), 0) == (StartAction(mission.tasks[0], 2),)

    def test_end_of_the_mission(self):
        executor = started(build("A"))
        assert executor.handle(ActionFailed("A", "blocked"), 1) == ()
        assert executor.finished
        assert executor.active_task is None


class TestViews:
    def test_before_the_start(self, executor):
        assert not executor.finished
        assert executor.active_task is None
        assert executor.configuration == ()
        assert executor.next_deadline is None
        assert executor.rounds == {}
        assert executor.values == {}
        assert executor.trace == ()

    def test_configuration_and_rounds(self):
        groups = (
            Group(name="G", start="A", end="B", max_repeat_count=2),
            Group(name="G/H", start="A", end="A", max_repeat_count=2),
        )
        executor = started(build("A B", *groups))
        executor.handle(ActionSucceeded("A"), 1)
        assert executor.configuration == ("mission", "group:G", "group:G/H", "task:A")
        assert executor.rounds == {"G": 1, "G/H": 2}
        executor.handle(ActionSucceeded("A"), 2)
        assert executor.configuration == ("mission", "group:G", "task:B")

    def test_trace_names_groups_left_and_rounds_that_begin(self):
        outer = Group(name="G", start="A", end="B", max_repeat_count=2, every=10)
        inner = Group(name="G/H", start="A", end="A", max_repeat_count=1)
        trace = drive(build("A B C", outer, inner), takes={"B": 2}).trace
        assert [(e.time, e.left, e.repeated, [r[:2] for r in e.rounds]) for e in trace] == [
            (0, (), None, [("G", 1), ("G/H", 1)]),
            (1, ("G/H",), None, []),
            (3, (), "G", [("G", 2)]),
            (10, (), None, [("G", 2), ("G/H", 1)]),
            (11, ("G/H",), None, []),
            (13, ("G",), None, []),
            (14, (), None, []),
        ]
        assert trace[2].rounds == (TracedRound("G", 2, due=10, awaited=True),)
        assert trace[3].rounds[0] == TracedRound("G", 2, due=10, awaited=False)

    def test_deadline_is_the_earliest_of_all_hard_groups(self):
        groups = (
            Group(name="G", start="A", end="B", max_repeat_duration=8),
            Group(name="G/H", start="A", end="A", max_repeat_duration=5),
            Group(name="G/H/I", start="A", end="A", max_repeat_duration=2, stop=Stop.SOFT),
        )
        executor = started(build("A B", *groups))
        assert executor.next_deadline == 5
        executor.handle(Tick(), 5)
        assert executor.next_deadline == 8

    def test_values_can_not_be_changed_from_outside(self, executor):
        executor.start(0)
        executor.values["A"] = Measured(1, 0)
        assert executor.values == {}


class TestMisuse:
    def test_before_the_start(self, executor):
        with pytest.raises(ValueError, match="call start first"):
            executor.handle(Tick(), 0)
        with pytest.raises(ValueError, match="call start first"):
            executor.progress()

    def test_second_start(self, executor):
        executor.start(0)
        with pytest.raises(ValueError, match="started already"):
            executor.start(0)

    def test_after_the_end(self):
        executor = started(build("A"))
        executor.handle(ActionSucceeded("A"), 1)
        assert executor.handle(Tick(), 2) == ()
        assert executor.handle(Pause(), 2) == ()
        with pytest.raises(ValueError, match="no action runs"):
            executor.handle(ActionSucceeded("A"), 2)

    @pytest.mark.parametrize("now", [float("nan"), float("inf"), 1e18])
    def test_no_time(self, executor, now):
        with pytest.raises(ValueError, match="not a time"):
            executor.start(now)

    @pytest.mark.parametrize(
        ("event", "now", "said"),
        [
            (Tick(), 4, r"4 s comes after 5 s"),
            (ActionSucceeded("B"), 6, "'A' does"),
            (ActionFailed("Z", "lost"), 6, "'A' does"),
            (ActionSucceeded("A", float("nan")), 6, "report that the action failed"),
        ],
    )
    def test_event_that_can_not_be(self, executor, event, now, said):
        executor.start(5)
        with pytest.raises(ValueError, match=said):
            executor.handle(event, now)

    def test_a_refused_event_changes_nothing(self, executor):
        executor.start(0)
        with pytest.raises(ValueError, match="does not run"):
            executor.handle(ActionSucceeded("B"), 9)
        executor.handle(ActionSucceeded("A"), 1)
        assert executor.active_task == "B"


class TestProgress:
    def test_goes_on_with_the_time_that_is_left(self, executor, mission):
        executor.start(0)
        executor.handle(ActionSucceeded("A", 7.0), 1)
        executor.handle(ActionFailed("B", "dark"), 4)
        written = executor.progress().model_dump_json()
        assert json.loads(written) == {
            "active": "C",
            "attempt": 0,
            "since": 0,
            "occurred": False,
            "round_of": None,
            "groups": [{"group": "G", "round": 1, "elapsed": 3, "counts_interruptions": False}],
            "readings": [
                {"object_id": "A", "kind": "value", "value": 7, "abnormal": False, "age": 3},
                {"object_id": "B", "kind": "failed", "value": None, "abnormal": False, "age": 0},
            ],
            "tallies": [
                {"task": "A", "done": 1, "failed": 0, "by_hand": 0},
                {"task": "B", "done": 0, "failed": 1, "by_hand": 0},
            ],
            "failed": True,
            "actions": 3,
            "elapsed": 4,
            "time_up": False,
            "paused": False,
            "reaction": None,
            "waiting": [],
            "outcome": None,
            "by_hand": [],
        }
        later = Executor.restore(lower(mission), Progress.model_validate_json(written), 100)
        assert later.start(100) == (StartAction(mission.tasks[2], 4),)
        assert later.next_deadline == 107
        assert later.values == {"A": Measured(7, 97)}
        assert later.trace[0].cause is Cause.RESTORE
        later.handle(ActionSucceeded("C"), 101)
        assert later.ended == (EndedVisit("C"),)
        assert [tally.task for tally in later.progress().tallies] == ["A", "B", "C"]

    def test_time_that_was_up_before(self, executor, mission):
        executor.start(0)
        executor.handle(ActionSucceeded("A"), 1)
        later = Executor.restore(lower(mission), executor.progress(), 50)
        assert later.start(70) == (StartAction(mission.tasks[3], 3),)
        assert later.trace[-1].time == 70

    def test_ended_mission_stays_ended(self):
        hfsm = lower(build("A"))
        executor = Executor(hfsm)
        executor.start(0)
        executor.handle(ActionSucceeded("A"), 1)
        later = Executor.restore(hfsm, executor.progress(), 5)
        assert later.start(5) == ()
        assert later.finished

    @pytest.mark.parametrize(
        ("progress", "message"),
        [
            (Progress(active="Z"), "'Z', which the mission does not have"),
            (Progress(active="B"), "'B' is in other groups"),
            (
                Progress(active="A", waiting=(Waiting(event=EventKind.GAS_LEAK),)),
                "gas_leak, which the mission does not have",
            ),
        ],
    )
    def test_of_another_mission(self, mission, progress, message):
        with pytest.raises(ArgoError, match=message):
            Executor.restore(lower(mission), progress, 0)
