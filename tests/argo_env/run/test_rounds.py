"""Rounds, waits and windows of the record, compared with the rules and with other ways to run."""

from itertools import accumulate, chain

from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.base.errors import Conflict
from argo_compiler.base.model import Pose
from argo_compiler.files.mission_file import read_mission
from argo_compiler.hfsm import (
    ActionFailed,
    ActionSucceeded,
    ByHand,
    Cancel,
    Executor,
    GiveBack,
    Occurred,
    Pause,
    Resume,
    TakeOver,
    Tick,
    lower,
)
from argo_compiler.il import (
    Action,
    Afterwards,
    EventKind,
    Group,
    Mission,
    Response,
    Stop,
    TimeWindow,
)
from argo_env.planning.opening import open_site
from argo_env.report.rounds import all_waits
from argo_env.report.timeline import draw_timeline
from argo_env.run.journal import open_journal
from argo_env.run.observer import Observer
from argo_env.run.record import WindowOutcome
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec, logged_events
from argo_env.run.visits_and_rounds import (
    rounds_from_trace,
    visits_from_trace,
    visits_with_windows,
    wait_runs,
)
from tests.argo_compiler.hfsm.random_missions import busy_cases, cases, missions
from tests.argo_compiler.hfsm.world import Pair, Ticks, World
from tests.argo_env.run.rules_of_rounds import RoundsReference, is_junction, recompute
from tests.conftest import examples
from tests.mission_parts import assume_sound
from tests.mission_writing import drive, reaction, wait
from tests.yard import cut_after, in_order, resumed

DOCK = Pose(x=1.05, y=1.05, z=0.02)


def rounds(record, group):
    return [(r.number, r.since, r.began, r.ended) for r in record.rounds if r.group == group]


def plan_of(*tasks, **fields):
    """Return a mission of the tasks in order, which starts in the dock of the yard."""
    return Mission(site="yard", start_area=1, tasks=in_order(*tasks), **fields)


def run(site, plan, *events, **fields):
    spec = RunSpec(mission=plan, site="yard", drive="route", events=logged_events(*events))
    return simulate(spec, site, **fields)


class TestZeroDuration:
    def test_all_rounds_are_there(self, site):
        tasks = (wait("a", duration=1), wait("b", duration=0), wait("c", duration=1))
        group = Group(name="g", start="b", end="b", max_repeat_count=4, every=5)
        record = run(site, plan_of(*tasks, groups=(group,)))
        assert rounds(record, "g") == [
            (1, 1, 1, 1), (2, 1, 6, 6), (3, 6, 11, 11), (4, 11, 16, 16),
        ]  # fmt: skip
        assert [r.due for r in record.rounds] == [1, 6, 11, 16]
        assert [w.task for w in record.waits] == ["a", "c"]

    def test_rounds_of_an_inner_group_are_not_merged(self, site):
        tasks = (wait("a", duration=10), wait("b", duration=0), wait("c", duration=1))
        outer = Group(name="g", start="a", end="b", max_repeat_count=3)
        inner = Group(name="g/h", start="a", end="a", max_repeat_count=1)
        record = run(site, plan_of(*tasks, groups=(outer, inner)))
        expected = [(10.0 * k, 10.0 * k, 10.0 * (k + 1)) for k in range(3)]
        assert rounds(record, "g") == [(k + 1, *times) for k, times in enumerate(expected)]
        assert rounds(record, "g/h") == [(1, *times) for times in expected]

    def test_so_are_those_of_the_given_missions(self, fault_inputs):
        umad = open_site("umad")
        by_file = {
            name: simulate(RunSpec(mission=plan, site="umad", drive="route"), umad)
            for name in ("round_one_missing", "nested_rounds_merged")
            for plan in [read_mission(fault_inputs / f"{name}.json")]
        }
        assert [n for n, *_ in rounds(by_file["round_one_missing"], "g")] == [1, 2, 3, 4]
        inner = rounds(by_file["nested_rounds_merged"], "g/h")
        assert [end - began for _, _, began, end in inner] == [10.0] * 3


def test_group_that_is_left_at_its_time_and_entered_again_at_once(site):
    """It has a round for each entry, also if its rounds are numbered alike."""
    tasks = (wait("a", duration=4), wait("b", duration=0, optional=True), wait("c", duration=1))
    outer = Group(name="g", start="a", end="a", max_repeat_duration=60)
    inner = Group(name="g/h", start="a", end="a", max_repeat_duration=2.5, stop=Stop.HARD)
    record = run(site, plan_of(*tasks, groups=(outer, inner)))
    assert [r[1:] for r in rounds(record, "g/h")] == [
        (2.5 * k, 2.5 * k, 2.5 * (k + 1)) for k in range(24)
    ]
    assert [r[0] for r in rounds(record, "g")] == [*range(1, 25)]


def test_round_that_begins_during_a_pause_is_due_then():
    """The robot ends the drive to the group only after it was paused."""
    plan = plan_of(
        drive("way", pose=DOCK),
        wait("a", duration=1),
        groups=(Group(name="g", start="a", end="a", max_repeat_count=2, every=20),),
    )
    executor = Executor(lower(plan))
    (start,) = executor.start(0)
    executor.handle(Pause(), 2)
    executor.handle(ActionSucceeded(start.task.name), 5)
    executor.handle(Resume(), 9)
    executor.handle(Tick(), 60)
    first, second = rounds_from_trace(executor.trace)
    assert (first.since, first.due, first.began) == (5, 5, 5)
    assert (second.due, second.began) == (29, 29)


class TestAwaited:
    """Rounds of every 20 s whose first task is in an inner group."""

    TASKS = (wait("a", duration=2), wait("b", duration=1), wait("c", duration=1))
    OUTER = Group(name="g", start="a", end="b", max_repeat_count=2, every=20)
    INNER = Group(name="g/h", start="a", end="a", max_repeat_count=2, every=3)
    PLAN = plan_of(*TASKS, groups=(OUTER, INNER))

    def test_inner_round_begins_with_the_awaited_one(self, site):
        record = run(site, self.PLAN)
        assert rounds(record, "g") == [(1, 0, 0, 6), (2, 6, 20, 26)]
        assert rounds(record, "g/h") == [
            (1, 0, 0, 2), (2, 2, 3, 5), (1, 20, 20, 22), (2, 22, 23, 25),
        ]  # fmt: skip
        waits = [(w.what, w.start, w.end) for w in all_waits(record) if "round" in w.what]
        assert ("the next round (g)", 6, 20) in waits
        assert len(waits) == 3

    def test_neither_round_nor_visit_has_begun_if_the_mission_ends_before(self, site):
        record = run(site, self.PLAN, (10.0, Occurred(EventKind.GAS_LEAK)), (12.0, Pause()))
        plan = self.PLAN.model_copy(
            update={"reactions": (reaction(EventKind.GAS_LEAK, Response.ABORT),)}
        )
        record = run(site, plan, (10.0, Occurred(EventKind.GAS_LEAK)))
        assert rounds(record, "g") == [(1, 0, 0, 6), (2, 6, None, 10)]
        assert [n for n, *_ in rounds(record, "g/h")] == [1, 2]
        assert [w.task for w in record.waits] == ["a", "a", "b"]
        (title,) = [w.what for w in all_waits(record) if w.end == 10]
        assert title == "the next round (g)"

    def test_first_task_done_by_hand_begins_the_round(self, site):
        by_hand = (TakeOver(), GiveBack((ByHand(task="a"),)))
        record = run(site, self.PLAN, *[(10.0, event) for event in by_hand])
        began = 10.0 + 0.1  # the robot is given back one step after it was taken over
        assert rounds(record, "g") == [(1, 0, 0, 6), (2, 6, began, began + 6)]
        assert [(w.task, w.start, w.end) for w in record.waits][3] == ("a", began, began)

    def test_pause_delays_it(self, site):
        record = run(site, self.PLAN, (10.0, Pause()), (15.0, Resume()))
        assert rounds(record, "g")[1][:3] == (2, 6, 25)
        assert [r.due for r in record.rounds if r.group == "g"] == [0, 25]

    def test_pause_that_counts_makes_it_late(self, site):
        counts = self.OUTER.model_copy(update={"count_interruptions": True})
        plan = plan_of(*self.TASKS, groups=(counts, self.INNER))
        record = run(site, plan, (10.0, Pause()), (30.0, Resume()))
        assert rounds(record, "g")[1][:3] == (2, 6, 30)
        assert [r.due for r in record.rounds if r.group == "g"] == [0, 20]


def test_first_round_at_the_start_is_no_wait_in_the_timeline(site):
    plan = plan_of(
        wait("a", duration=3), groups=(Group(name="g", start="a", end="a", max_repeat_count=2),)
    )
    assert "is due" not in str(draw_timeline(run(site, plan)))


def test_failure_of_a_reaction_is_none_of_the_task_that_it_interrupts():
    rest = wait("a", duration=60, window=TimeWindow(latest=90, hard=True))
    shelter = reaction(EventKind.GAS_LEAK, Response.SAFE_AREA, pose=DOCK, afterwards=Afterwards.END)
    plan = plan_of(rest, reactions=(shelter,))
    executor = Executor(lower(plan))
    executor.start(0)
    (drive,) = executor.handle(Occurred(EventKind.GAS_LEAK), 5)
    executor.handle(ActionFailed(drive.task.name, "no path"), 7)
    visits = tuple(visits_from_trace(executor.trace))
    assert [(w.end, w.ended, w.failure) for w in wait_runs(plan, visits, 7)] == [(7, True, None)]
    assert [w.kept for w in visits_with_windows(plan, visits)] == [WindowOutcome.LEFT]


class TestRandomMissions:
    @settings(max_examples=examples(120), deadline=None)
    @given(st.one_of(cases(), cases(), busy_cases()), st.sampled_from(Ticks))
    def test_rounds_waits_and_windows_are_those_of_the_rules(self, case, ticks):
        executor = Executor(lower(assume_sound(case.mission)))
        reference = RoundsReference(case.mission)
        World(Pair(executor, reference), case, ticks).run()
        assert [r.model_dump() for r in rounds_from_trace(executor.trace)] == reference.rounds
        visits = tuple(visits_from_trace(executor.trace))
        waits = [
            (w.task, w.start, w.end, w.ended, w.failure is not None)
            for w in wait_runs(case.mission, visits, reference.now)
        ]
        assert waits == [
            (task, start, end, how != "open", how == "failed")
            for task, start, end, how in reference.waits()
        ]
        windows = visits_with_windows(case.mission, visits)
        assert [(w.task, w.visited, w.ended, str(w.kept)) for w in windows] == reference.windows()

    @settings(max_examples=examples(12), deadline=None)
    @given(st.data())
    def test_all_ways_to_run_record_what_the_rules_say(self, site, tmp_path_factory, data):
        plan = data.draw(driven_missions())
        timed = data.draw(timed_events(plan))
        spec = RunSpec(mission=plan, site="yard", drive="route", events=logged_events(*timed))
        journal = tmp_path_factory.mktemp("runs") / "journal"
        watched = [Traces() for _ in range(3)]
        fast = outcome(spec, site, observers=watched[:1], journal=journal)
        slow = outcome(spec, site, observers=[watched[1], StepByStep()])
        if isinstance(fast, str):  # an event was refused
            assert slow == fast
            return
        # A measurement that the cut interrupts is repeated, which takes time.
        with open_journal(journal) as written:
            until_end = len(written.entries) - 1
        cut_after(journal, data.draw(st.integers(0, until_end)))
        after_crash = resumed(journal, site.navigator, observers=watched[2:])
        for record, watch in zip((fast, slow, after_crash), watched, strict=True):
            assert_rules(plan, record, watch.trace)
        assert slow.rounds == fast.rounds
        assert slow.waits == fast.waits
        assert slow.windows == fast.windows
        if all(task.wait is not None for task in plan.tasks):
            assert after_crash.rounds == fast.rounds
            assert after_crash.waits == fast.waits
            assert after_crash.windows == fast.windows


def assert_rules(plan, record, trace):
    """Assert that rounds, waits and windows are those that the rules make of the trace."""
    expected, visits = recompute(plan, trace)
    assert [(r.group, r.number, r.since, r.began, r.ended) for r in record.rounds] == expected
    tasks = {task.name: task for task in plan.tasks}
    end = record.result.duration
    assert [(w.task, w.start, w.end) for w in record.waits] == [
        (task, start, end if until is None else until)
        for task, start, until in visits
        if task in tasks and tasks[task].wait is not None and not is_junction(tasks[task])
    ]
    assert [(w.task, w.visited, w.ended) for w in record.windows if w.visited is not None] == [
        visit for visit in visits if visit[0] in tasks and tasks[visit[0]].window is not None
    ]


def outcome(spec, site, **options):
    """Return the record of a run, or the message of the event that was refused."""
    try:
        return simulate(spec, site, **options)
    except Conflict as error:
        return str(error)


def timed_events(plan):
    """Draw the events of a run, with a person's commands; the last one cancels it."""
    names = [task.name for task in plan.tasks if task.action is not Action.START]
    by_hand = st.builds(ByHand, task=st.sampled_from(names), duration=st.integers(0, 2))
    kinds = st.sampled_from([EventKind.GAS_LEAK, EventKind.LOW_BATTERY, EventKind.ALL_CLEAR])
    occurred = kinds.map(Occurred)
    given_back = st.lists(by_hand, max_size=1).map(lambda done: GiveBack(tuple(done)))
    # A command that is not possible yet, such as to resume, waits, and with it all later events.
    interruption = st.one_of(
        st.tuples(st.just(Pause()), st.lists(occurred, max_size=2), st.just(Resume())),
        st.tuples(st.just(TakeOver()), st.lists(occurred, max_size=2), given_back),
    ).map(lambda parts: [parts[0], *parts[1], parts[2]])
    groups = st.lists(st.one_of(occurred.map(lambda one: [one]), interruption), max_size=5)

    def at_times(events):
        gaps = st.lists(st.integers(0, 9), min_size=len(events), max_size=len(events))
        return gaps.map(lambda given: [*zip(map(float, accumulate(given)), events, strict=True)])

    return groups.map(lambda parts: [*chain(*parts), Cancel()]).flatmap(at_times)


@st.composite
def driven_missions(draw):
    """Draw a mission with the features of `missions`, in the yard."""
    plan = assume_sound(draw(missions()))
    tasks = tuple(
        task
        if task.pose is None
        else task.model_copy(update={"pose": Pose(x=2.05, y=2.05, z=0.02)})
        for task in plan.tasks
    )
    reactions = tuple(
        one if one.pose is None else one.model_copy(update={"pose": DOCK}) for one in plan.reactions
    )
    update = {"tasks": tasks, "reactions": reactions, "dock": DOCK, "site": "yard", "start_area": 1}
    return plan.model_copy(update=update)


class Traces(Observer):
    """Observer that keeps the machine's trace."""

    trace = ()

    def on_entry_applied(self, _, machine):
        self.trace = machine.trace


class StepByStep(Observer):
    """Observer of single steps, which rules batches out."""

    def on_step(self, now, action):
        """Do nothing."""
