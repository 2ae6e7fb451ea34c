"""Runs that continue another run, with the same mission or an edited one."""

from collections import Counter

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from argo_compiler.base.errors import Conflict, Invalid
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.hfsm import ByHand, Executor, GiveBack, Outcome, TakeOver, lower
from argo_compiler.il import EventKind, Group
from argo_compiler.il.mission import TimeWindow
from argo_env.faults.checkpoints import AbnormalValue
from argo_env.run.initial_state import KnownAnomaly
from argo_env.run.journal import open_journal
from argo_env.run.record import Anomaly, WindowOutcome
from argo_env.run.run_commands import DoByHand
from argo_env.run.session import resume, simulate
from argo_env.run.simulation import Simulation
from argo_env.run.spec import RunSpec
from tests.conftest import examples
from tests.yard import cut, journaled, measure, mission, simulation_of, take_over, to_rest, waypoint

PARTS = (
    measure(1), measure(2), measure(3), waypoint("A", 4.05, 2.05), waypoint("B", 2.05, 1.55),
)  # fmt: skip
PLAN = mission(measure(1), waypoint("A", 4.05, 2.05), measure(2), waypoint("B", 2.05, 1.55))


def spec_of(plan, **fields):
    return RunSpec(mission=plan, site="yard", drive="route", seed=3, **fields)


def take_over_after(simulation, reached):
    """Take the robot over once the record has `reached` done tasks, and let it come to rest."""
    while sum(t.outcome == "done" for t in simulation.record().tasks) < reached:
        simulation.step()
    take_over(simulation, after=3)


def make_continuation(site, plan, reached, **fields):
    """Return a closed simulation with `reached` done tasks, and the spec that continues it."""
    with simulation_of(spec_of(plan, **fields), site) as first:
        take_over_after(first, reached)
        return first, first.continuation_spec(plan)


def tallies_by_task(progress):
    return {t.task: (t.done + t.by_hand, t.failed) for t in progress.tallies}


def readings_by_object(progress):
    return {r.object_id: (r.kind, r.value, r.abnormal) for r in progress.readings}


@st.composite
def plans(draw):
    """Draw a mission of a few tasks in some order, perhaps with a group of two or three rounds."""
    tasks = draw(st.permutations(PARTS))[: draw(st.integers(2, 5))]
    first = draw(st.integers(0, len(tasks) - 1))
    last = draw(st.integers(first, len(tasks) - 1))
    rounds = draw(st.integers(1, 3))
    names = {"start": tasks[first].name, "end": tasks[last].name}
    return mission(*tasks, groups=(Group(name="G", max_repeat_count=rounds, **names),))


@pytest.mark.rule("H4", "H5", "H6", "H7")
@pytest.mark.parametrize("how", ["given back", "gone on", "edited"])
@settings(max_examples=examples(15), deadline=None)
@given(plans(), st.integers(1, 900), st.data())
def test_before_by_hand_and_after_are_the_whole_mission(site, how, plan, at, data):
    """The tasks before, by hand and after are those of the mission, edited or not."""
    edited = plan
    if how == "edited":
        last = waypoint("LAST", 5.05, 2.05)
        edited = mission(*plan.tasks[1:], last, groups=plan.groups)
    with simulation_of(spec_of(plan), site) as first:
        for _ in range(at):
            if not first.ended:
                first.step()
        assume(not first.ended)
        take_over(first)
        assume(not first.ended)
        done = do_some_by_hand(data, plan, first)
        if how == "given back":
            first.handle(GiveBack(done))
            records = (first.run(),)
            last = first.machine.progress()
        else:
            assume(first.machine.progress().active is not None)
            spec = first.continuation_spec(edited, done)
            assert spec.beginning.progress.elapsed == pytest.approx(first.now)
            with simulation_of(RunSpec.model_validate_json(spec.model_dump_json()), site) as rest:
                assert (rest.pose, rest.now) == (first.pose, pytest.approx(first.now))
                records = (first.record(), rest.run())
                last = rest.machine.progress()
            assert (
                records[1].result.duration
                >= records[1].began
                == spec.beginning.mission_seconds_at_start
            )
    with simulation_of(spec_of(edited), site) as whole:
        expected = whole.run()
        assert tallies_by_task(last) == tallies_by_task(whole.machine.progress())
        assert readings_by_object(last) == readings_by_object(whole.machine.progress())
    assert records[-1].result.success is expected.result.success is True
    # Each visit was made once, by whomever.
    made = Counter(t.task for r in records for t in r.tasks if t.outcome == "done")
    made += Counter(one.task for one in done if one.skipped)
    assert made == Counter(t.task for t in expected.tasks)


def do_some_by_hand(data, plan, simulation):
    """Do some of the remaining tasks by hand in any order, and perhaps skip one; return them."""
    remaining = list(remaining_tasks(plan, simulation))
    names = (
        data.draw(st.lists(st.sampled_from(remaining), max_size=3, unique=True))
        if remaining
        else []
    )
    for name in names:
        simulation.handle(DoByHand(plan.task(name)))
        to_rest(simulation)
    skipped = data.draw(st.sampled_from(["", *(n for n in remaining if not n.startswith("M"))]))
    more = [ByHand(task=skipped, skipped=True)] if skipped and skipped not in names else []
    return (*simulation.done_by_hand, *more)


def remaining_tasks(plan, simulation):
    """Yield the tasks whose visits have not all ended, the current one included."""
    counts = tallies_by_task(simulation.machine.progress())
    group = plan.groups[0]
    names = [t.name for t in plan.tasks[1:]]
    inside = names[names.index(group.start) : names.index(group.end) + 1]
    for name in names:
        rounds = group.max_repeat_count if name in inside else 1
        if counts.get(name, (0, 0))[0] < rounds:
            yield name


class TestRecord:
    def test_the_verdict_tells_what_was_done_before(self, site):
        first, spec = make_continuation(site, PLAN, 2)
        record = simulate(spec, site)
        assert record.result.outcome is Outcome.COMPLETED
        assert record.result.verdict == (
            "the mission was completed; done before this run: MEASURE 1, A"
        )
        assert [t.task for t in record.tasks] == ["MEASURE 2", "B"]
        assert [tally.task for tally in record.before] == ["MEASURE 1", "A"]
        assert record.path[0].t == record.began == first.now
        assert record.result.distance > first.record().result.distance
        assert record.path[0].charge == pytest.approx(first.record().path[-1].charge, abs=1e-3)

    def test_what_failed_before_is_missing(self, site):
        off = waypoint("off the slab", 50.0, 50.0)
        plan = mission(off, measure(1), measure(2))
        with simulation_of(spec_of(plan), site) as first:
            take_over_after(first, 1)
            spec = first.continuation_spec(plan)
            edited = first.continuation_spec(mission(measure(1), measure(2)))
        for one in (spec, edited):
            record = simulate(one, site)
            assert record.result.outcome is Outcome.COMPLETED_WITH_FAILURES
            assert record.result.verdict == "failed: off the slab"

    def test_times_are_those_of_the_whole_mission(self, site):
        window = TimeWindow(earliest=60.0)
        plan = mission(measure(1), measure(2), waypoint("B", 2.05, 1.55, window=window),
                       max_duration=65.0)  # fmt: skip
        _, spec = make_continuation(site, plan, 1)
        record = simulate(spec, site)
        run = record.tasks[-1]
        assert run.end == pytest.approx(60.0, abs=0.2)
        assert record.windows[0].kept is WindowOutcome.KEPT
        late = spec.mission.model_copy(update={"max_duration": 30.0})
        record = simulate(spec.model_copy(update={"mission": late}), site)
        assert record.result.within_max_duration is False

    def test_a_window_that_was_kept_before_is_not_said_to_be_open(self, site):
        window = TimeWindow(earliest=0.0, latest=500.0)
        plan = mission(measure(1, window=window), measure(2, window=window))
        _, spec = make_continuation(site, plan, 1)
        (run,) = simulate(spec, site).windows
        assert (run.task, run.kept) == ("MEASURE 2", WindowOutcome.KEPT)


class TestEdited:
    def test_new_tasks_are_done_and_old_ones_are_not(self, site):
        edited = mission(measure(1), measure(3), waypoint("B", 2.05, 1.55))
        with simulation_of(spec_of(PLAN), site) as first:
            take_over_after(first, 1)
            # It stands at a task that the edit must keep.
            with pytest.raises(DiagnosticError, match="which the mission plan does not have"):
                first.continuation_spec(edited)
            kept = mission(measure(1), waypoint("A", 4.05, 2.05), measure(3))
            spec = first.continuation_spec(kept)
        record = simulate(spec, site)
        assert [t.task for t in record.tasks] == ["A", "MEASURE 3"]

    def test_what_is_put_in_before_is_passed_over(self, site):
        early = mission(waypoint("EARLY", 2.05, 2.05), *PLAN.tasks[1:])
        with simulation_of(spec_of(PLAN), site) as first:
            take_over_after(first, 2)
            spec = first.continuation_spec(early)
        assert simulate(spec, site).result.verdict == (
            "the mission was completed; done before this run: MEASURE 1, A; passed over: EARLY"
        )

    def test_nothing_is_left(self, site):
        short = mission(measure(1))
        with simulation_of(spec_of(short), site) as whole:
            steps = 0
            while not whole.ended:
                whole.step()
                steps += 1
        # It has looked already, and the value counts though a person takes over.
        with simulation_of(spec_of(short), site) as first:
            take_over(first, after=steps - 1)
            assert not first.ended
            with pytest.raises(Conflict, match="nothing is left"):
                first.continuation_spec(mission(measure(1), measure(2)))
            first.handle(GiveBack())
            assert first.run().result.success

    def test_what_does_not_fit_is_told(self, site):
        with simulation_of(spec_of(PLAN), site) as first:
            take_over_after(first, 1)
            shorter = mission(measure(1), waypoint("A", 4.05, 2.05))
            spec = first.continuation_spec(shorter, [ByHand(task="MEASURE 2", value=3.0)])
        assert [d.code for d in spec.diagnostics] == ["handover.by-hand-gone"]
        assert simulate(spec, site).diagnostics == spec.diagnostics


def test_what_was_found_before_is_known(site):
    fault = AbnormalValue(checkpoint=1, value=9.0)
    first, spec = make_continuation(site, PLAN, 1, faults=(fault,))
    (known,) = spec.beginning.known
    assert known.anomaly == first.record().anomalies[0]
    told = Anomaly(t=1.0, kind=EventKind.POSITIVE_OBSTACLE, detail="a box", source="camera",
                   place=(3.0, 2.0, 0.0), extent=(2.9, 1.9, 3.1, 2.1))  # fmt: skip
    more = (known, KnownAnomaly(anomaly=told, pose=spec.beginning.pose))
    beginning = spec.beginning.model_copy(update={"known": more})
    with simulation_of(spec.model_copy(update={"beginning": beginning}), site) as rest:
        (closed,) = rest.setup.navigator.blockages
        take_over_after(rest, 1)
        assert rest.continuation_spec(PLAN).beginning.known[:2] == more
    assert closed.rect[0] < 2.9 < 3.1 < closed.rect[2]


class TestRefusals:
    def test_not_while_the_mission_goes_on(self, site):
        with simulation_of(spec_of(PLAN), site) as first:
            first.step()
            with pytest.raises(Conflict, match="take the robot over"):
                first.continuation_spec(PLAN)
            first.handle(TakeOver())
            with pytest.raises(Conflict, match="take the robot over"):
                first.continuation_spec(PLAN)
            to_rest(first)
            first.handle(DoByHand(PLAN.task("A")))
            with pytest.raises(Conflict, match="'A' by hand"):
                first.continuation_spec(PLAN)

    def test_what_nobody_did(self, site):
        with simulation_of(spec_of(PLAN), site) as first:
            take_over_after(first, 1)
            with pytest.raises(Invalid, match="MEASURE 9"):
                first.continuation_spec(PLAN, [ByHand(task="MEASURE 9")])

    def test_another_machine(self, site):
        _, spec = make_continuation(site, PLAN, 1)
        with pytest.raises(Conflict, match="machine"):
            Simulation(Executor(lower(PLAN)), site, spec)
        machine = Executor(lower(PLAN, spec.beginning.progress))
        with pytest.raises(Conflict, match="is not in the state in which the run begins"):
            Simulation(machine, site, spec)


@pytest.mark.parametrize("share", [0.2, 0.5, 0.8, 1.0])
def test_its_journal_goes_on_from_anywhere(site, tmp_path, share):
    _, spec = make_continuation(site, PLAN, 1)
    path = tmp_path / "run.journal"
    with journaled(path, spec, site) as rest:
        record = rest.run()
    cut(path, share)
    with open_journal(path) as journal:
        again = resume(journal, site)
    assert [(t.task, t.outcome) for t in again.tasks] == [(t.task, t.outcome) for t in record.tasks]
    assert again.result.verdict == record.result.verdict
    assert (again.began, again.before) == (record.began, record.before)
    if share == 1.0:
        assert again == record
