"""A simulation stepped and commanded: by hand, by `simulate` and by an environment alike."""

import json
import pickle
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.base.errors import ArgoError, Conflict, Invalid, NotFound, Unavailable
from argo_compiler.hfsm import (
    ActionSucceeded,
    ByHand,
    Cancel,
    Executor,
    GiveBack,
    Occurred,
    Outcome,
    Pause,
    Resume,
    TakeOver,
    Tick,
    lower,
)
from argo_compiler.il import EventKind, Reaction, Response
from argo_env.envs.inspection_run import Inspection, initial_mission
from argo_env.faults.checkpoints import AbnormalValue
from argo_env.faults.plant import GasLeakFault
from argo_env.faults.robot import ConnectionLoss, DriveDysfunction, LowBattery, SensorDysfunction
from argo_env.faults.walkway import Brick
from argo_env.planning.opening import OpenedSite
from argo_env.run.journal import open_journal
from argo_env.run.machine import OpenMachine
from argo_env.run.observer import Observer
from argo_env.run.record import RunRecord
from argo_env.run.run_commands import InjectFault, StopRun
from argo_env.run.session import resume, run, simulate
from argo_env.run.simulation import Simulation
from argo_env.run.spec import RunSpec, logged_events, read_spec
from argo_env.run.validation import check_run
from tests.conftest import examples
from tests.yard import (
    Entries,
    cut,
    journaled,
    measure,
    mission,
    simulation_of,
    site_of,
    steps,
    take_over,
    until,
    waypoint,
    write_site,
)

PLAN = mission(measure(1), waypoint("A", 4.05, 2.05), measure(2), measure(3), end_area=1)
SHORT = mission(waypoint("A", 2.05, 1.55), measure(1))
PLANS = {"route": PLAN, "kinematic": PLAN, "tracked": SHORT}
FAULTS = (
    AbnormalValue(checkpoint=2, value=9.0, at=3.0),
    DriveDysfunction(at=2.0, until=15.0, speed=0.4),
    ConnectionLoss(at=4.0, until=9.0),
)
EVENTS = logged_events(
    (6.0, Pause()), (8.5, Resume()), (10.0, Occurred(EventKind.HOT_SPOT, "told"))
)


@pytest.fixture(params=["route", "kinematic", "tracked"])
def drive(request):
    return request.param


def spec_of(drive, **fields):
    usual = {"mission": PLANS[drive], "site": "yard", "seed": 5}
    return RunSpec(drive=drive, **(usual | fields))


def read(record):
    return [(r.task, r.value, r.normal) for r in record.readings]


class TestTheSameWhoeverSteps:
    def test_by_hand_and_by_simulate(self, site, drive):
        spec = spec_of(drive, faults=FAULTS, events=EVENTS)
        whole, single = Entries(), Entries()
        record = simulate(spec, site, observers=[whole])
        with simulation_of(spec, site, observers=[single]) as simulation:
            while not simulation.ended:
                simulation.step()
        assert single.all == whole.all
        assert simulation.record() == record
        assert record.result.outcome is Outcome.COMPLETED
        assert len(record.interruptions) == 1

    def test_by_tasks_given_one_by_one(self, site, drive):
        """Environments append each task when the previous one has ended."""
        start = PLAN.tasks[0].pose
        spec = spec_of(drive, mission=initial_mission(site, start), faults=FAULTS)
        given, whole = Entries(), Entries()
        with Inspection(check_run(spec, site), 600.0, [given]) as inspection:
            results = [inspection.measure_checkpoint(1)]
            if drive != "tracked":
                results += [
                    inspection.measure_checkpoint(2),
                    inspection.measure_checkpoint(2),
                    inspection.drive_to(start),
                ]
            inspection.end_mission()
            record = inspection.record()
        names = [task.name for task in record.mission.tasks]
        assert names == ["START", "read 1", "read 2", "read 2 (2)", "drive"][: 1 + len(results)]
        planned = spec.model_copy(update={"mission": record.mission})
        assert simulate(planned, site, observers=[whole]) == record
        assert given.all == whole.all
        assert record.result.success
        assert [d.reading for d in results if d.reading] == list(record.readings)
        noticed = [a for a in record.anomalies if a.kind is not EventKind.ABNORMAL_READING]
        assert [a for d in results for a in d.anomalies] == noticed


@pytest.fixture(scope="module")
def whole(site):
    """Return the readings of runs without a pause, and their numbers of steps, by drive."""
    runs = {}
    for drive in PLANS:
        with simulation_of(spec_of(drive), site) as simulation:
            record = simulation.run()
            runs[drive] = read(record), round(simulation.now / simulation.setup.drive.time_step)
            assert record.readings
    return runs


@pytest.mark.physics
class TestPausing:
    def pause(self, site, drive, at, pause):
        with simulation_of(spec_of(drive), site) as simulation:
            steps(simulation, at)
            simulation.handle(Pause())
            until(simulation, lambda: simulation.task is None)
            stood = simulation.pose
            steps(simulation, pause)
            assert simulation.pose == stood or drive == "tracked"
            simulation.handle(Resume())
            return simulation.run()

    @settings(max_examples=examples(8))
    @given(drive=st.sampled_from(["route", "kinematic"]), data=st.data())
    def test_at_any_step(self, site, whole, drive, data):
        readings, most = whole[drive]
        at, pause = data.draw(st.integers(0, most - 1)), data.draw(st.integers(1, 40))
        record = self.pause(site, drive, at, pause)
        assert read(record) == readings
        assert record.result.outcome is Outcome.COMPLETED
        assert [i.event for i in record.interruptions] == [None]

    @pytest.mark.parametrize("share", [0.3, 0.9])
    def test_with_the_tracked_drive(self, site, whole, share):
        readings, most = whole["tracked"]
        assert read(self.pause(site, "tracked", int(share * most), 5)) == readings


@pytest.mark.long
def test_eight_threads_give_what_each_gives_alone(site):
    drives = [*3 * ["route", "kinematic"], "route", "tracked"]
    specs = [spec_of(drive, faults=FAULTS, seed=seed) for seed, drive in enumerate(drives)]
    alone = [simulate(spec, site) for spec in specs]
    together = Barrier(len(specs))

    def one(spec):
        together.wait()
        return simulate(spec, site)

    with ThreadPoolExecutor(len(specs)) as pool:
        assert list(pool.map(one, specs)) == alone


class TestRecordAtAnyMoment:
    def test_it_tells_what_has_been_and_changes_nothing(self, site):
        spec = spec_of("route", faults=FAULTS)
        reference = simulate(spec, site)
        with simulation_of(spec, site) as simulation:
            first = simulation.record()
            assert (first.result.duration, first.tasks) == (0.0, ())
            while not simulation.ended:
                steps(simulation, 1)
                if round(simulation.now * 10) % 7:
                    continue
                record = simulation.record()
                assert record.result.duration == simulation.now
                for name in ("tasks", "readings", "anomalies", "trace"):
                    so_far = getattr(record, name)
                    assert so_far == getattr(reference, name)[: len(so_far)]
                if not simulation.ended:
                    assert "has not ended after" in record.result.verdict
                    assert (record.result.success, record.result.outcome) == (False, None)
            assert simulation.record() == reference
        assert RunRecord.model_validate_json(record.model_dump_json()) == record


class TestSteering:
    @pytest.fixture
    def simulation(self, site):
        with simulation_of(spec_of("route"), site) as simulation:
            yield simulation

    def test_a_fault_from_now_on(self, simulation):
        steps(simulation, 30)
        simulation.handle(InjectFault(SensorDysfunction(effect="fails")))
        record = simulation.run()
        assert record.readings == ()
        (fault,) = record.faults
        assert (fault.kind, fault.at) == ("sensor_dysfunction", 3.0)
        assert [a.kind for a in record.anomalies] == [EventKind.DYSFUNCTION]
        assert "failed: MEASURE 1, MEASURE 2, MEASURE 3" in record.result.verdict

    def test_a_fault_that_comes_later_and_ends(self, simulation):
        steps(simulation, 10)
        simulation.handle(InjectFault(ConnectionLoss(at=5.0, until=9.0)))
        lost, restored = simulation.run().anomalies
        assert (lost.kind, restored.kind) == (
            EventKind.CONNECTION_LOST, EventKind.CONNECTION_RESTORED,
        )  # fmt: skip
        assert 5.0 < lost.t < 9.0 <= restored.t

    @pytest.mark.parametrize(
        ("event", "kind", "says"),
        [
            (InjectFault(Brick(floor=1)), Conflict, "can only begin with the run"),
            (InjectFault(LowBattery(charge=0.3)), Conflict, "can only begin with the run"),
            (InjectFault(GasLeakFault(place=(2.0, 2.0, 1.0))), Conflict, "`route` has no world"),
            (
                InjectFault(ConnectionLoss(until=0.5)), Invalid,
                r"would end at 0.5 s, and it is 1 s already",
            ),
            (InjectFault(AbnormalValue(checkpoint=99)), ArgoError, "has no checkpoint 99"),
            *((wrong, Invalid, None) for wrong in (
                InjectFault(None), StopRun(5), Occurred("nonsense"), GiveBack(5), GiveBack((5,)),
                Occurred("time_up"),
            )),
            *((untold, Invalid, r"outside|occurs by itself") for untold in (
                ActionSucceeded("MEASURE 1"), Occurred(EventKind.TIME_UP), "pause", None,
            )),
        ],
    )  # fmt: skip
    def test_what_can_not_be_told_changes_nothing(self, simulation, event, kind, says):
        steps(simulation, 10)
        before = simulation.record()
        with pytest.raises(kind, match=says):
            simulation.handle(event)
        assert simulation.record() == before

    def test_a_person_takes_over_and_gives_back(self, simulation):
        steps(simulation, 40)
        simulation.handle(TakeOver())
        done = (ByHand(task="MEASURE 1", value=4.25), ByHand(task="MEASURE 3", skipped=True))
        with pytest.raises(Conflict, match="'MEASURE 1' has not ended yet"):
            simulation.handle(GiveBack(done))
        until(simulation, lambda: simulation.task is None)
        steps(simulation, 100)
        simulation.handle(GiveBack(done))
        record = simulation.run()
        assert record.result.outcome is Outcome.COMPLETED
        assert [(t.task, t.outcome) for t in record.tasks] == [
            ("MEASURE 1", "interrupted"), ("A", "done"), ("MEASURE 2", "done"),
        ]  # fmt: skip
        assert [r.task for r in record.readings] == ["MEASURE 2"]
        causes = [step.cause for step in record.trace]
        assert "pause (a person takes over)" in causes
        assert sum("done by hand" in cause for cause in causes) == 2
        (pause,) = record.interruptions
        assert (pause.start, pause.event) == (4.0, None)
        assert simulation.machine.progress().readings[0].value == 4.25

    @pytest.mark.parametrize(
        ("done", "says"),
        [
            (
                ByHand(task="MEASURE 9"),
                "'MEASURE 9' was done by hand, but the mission plan does not",
            ),
            (ByHand(task="A", value=3.0), "'A', which measures nothing"),
        ],
    )
    def test_what_nobody_can_have_done(self, simulation, done, says):
        take_over(simulation, after=40)
        with pytest.raises(Invalid, match=says):
            simulation.handle(GiveBack((done,)))

    @pytest.mark.parametrize(
        ("done", "verdict"),
        [
            ([{"task": "MEASURE 2", "skipped": True}], "skipped by a person: MEASURE 2"),
            ([{"task": "MEASURE 2", "value": 5.0}], "done by hand: MEASURE 2"),
            (
                [{"task": "MEASURE 1", "value": 5.0}, {"task": "MEASURE 2", "skipped": True}],
                "done by hand: MEASURE 1; skipped by a person: MEASURE 2",
            ),
        ],
    )
    def test_the_verdict_tells_what_a_person_did(self, site, done, verdict):
        """A task counts as done by hand or skipped even if the robot had begun it."""
        spec = RunSpec(mission=mission(measure(1), measure(2)), site="yard", drive="route")
        with simulation_of(spec, site) as simulation:
            until(simulation, lambda: simulation.task.name == done[0]["task"])
            take_over(simulation, after=5)
            simulation.handle(GiveBack(tuple(ByHand(**fields) for fields in done)))
            record = simulation.run()
        assert done[0]["task"] in {t.task for t in record.tasks if t.outcome == "interrupted"}
        assert record.result.success
        assert record.result.verdict == f"the mission was completed; {verdict}"

    def test_what_was_skipped_is_told_where_the_mission_is_no_success(self, simulation):
        take_over(simulation, after=40)
        simulation.handle(GiveBack((ByHand(task="MEASURE 3", skipped=True),)))
        verdict = simulation.run().result.verdict
        assert verdict == (
            "the robot is not docked in starting area 1; skipped by a person: MEASURE 3"
        )

    def test_nothing_is_given_back_while_the_robot_comes_to_rest(self, simulation):
        steps(simulation, 40)
        simulation.handle(TakeOver())
        with pytest.raises(Conflict, match="'MEASURE 1' has not ended yet"):
            simulation.handle(GiveBack())

    def test_stopping(self, simulation):
        steps(simulation, 25)
        simulation.handle(StopRun("the tide came in"))
        record = simulation.record()
        assert (record.result.verdict, record.result.outcome) == (
            "the tide came in; 0 of 3 checkpoints read, not #1, #2, #3; "
            "not done: MEASURE 1, A, MEASURE 2, MEASURE 3; "
            "the robot is not docked in starting area 1", None,
        )  # fmt: skip
        assert (record.result.duration, record.tasks[-1].outcome) == (2.5, "cancelled")
        for after in (simulation.step, lambda: simulation.handle(Pause())):
            with pytest.raises(Conflict, match=r"the run has ended, at 2\.5 s"):
                after()
        assert simulation.run() is record

    def test_cancelling(self, simulation):
        steps(simulation, 25)
        simulation.handle(Cancel())
        assert not simulation.ended
        assert simulation.run().result.outcome is Outcome.CANCELLED

    def test_what_occurs_is_reacted_to(self, site):
        answer = Reaction(event=EventKind.GAS_LEAK, response=Response.ABORT)
        plan = PLAN.model_copy(update={"reactions": (answer,)})
        spec = spec_of("route", mission=plan)
        with simulation_of(spec, site) as simulation:
            steps(simulation, 25)
            simulation.handle(Occurred(EventKind.GAS_LEAK, "a nose"))
            assert simulation.run().result.outcome is Outcome.ABORTED

    def test_a_paused_robot_waits_as_long_as_it_is_stepped(self, simulation):
        steps(simulation, 25)
        simulation.handle(Pause())
        steps(simulation, 3000)
        assert not simulation.ended
        assert "nothing more occurs" in simulation.run().result.verdict

    def test_tasks_are_not_given_to_a_mission(self, simulation):
        with pytest.raises(Conflict, match="the mission of this run is fixed"):
            simulation.append_task(waypoint("B", 2.0, 2.0))


class TestGivenEvents:
    @pytest.mark.parametrize("at", [4.0, 4.1, 8.0])
    def test_a_robot_is_given_back_once_it_has_come_to_rest(self, site, at):
        done = GiveBack((ByHand(task="MEASURE 1", value=3.0),))
        events = logged_events((4.0, TakeOver()), (at, done), (9.0, Pause()), (9.5, Resume()))
        record = simulate(spec_of("route", events=events), site)
        assert record.result.outcome is Outcome.COMPLETED
        assert [r.task for r in record.readings] == ["MEASURE 2", "MEASURE 3"]
        taken, paused = record.interruptions
        rest = next(t.end for t in record.tasks if t.task == "MEASURE 1")
        assert (taken.start, paused.start) == (4.0, 9.0)
        assert max(rest, at) <= taken.end < 9.0

    def test_a_spec_that_is_refused_leaves_no_journal(self, site, tmp_path):
        spec = spec_of("route", events=logged_events((3.0, GiveBack((ByHand(task="zz"),)))))
        with pytest.raises(Invalid, match="give_back given at 3 s"):
            simulate(spec, site, journal=tmp_path / "run.journal")
        assert list(tmp_path.iterdir()) == []

    def test_a_robot_that_nobody_has_taken_over(self, site):
        spec = spec_of("route", events=logged_events((4.0, GiveBack())))
        with pytest.raises(Conflict, match=r"back by 4 s, and nobody .* 'MEASURE 1' runs"):
            simulate(spec, site)

    @pytest.mark.parametrize(
        ("given", "says"),
        [
            (
                logged_events((3.0, GiveBack((ByHand(task="zz"),)))),
                "give_back given at 3 s: .*'zz'",
            ),
            (logged_events((-3.0, Pause())), "no event can occur at -3 s"),
            (logged_events((float("nan"), Pause())), "no event can occur at nan s"),
            (
                logged_events((3.0, Tick())),
                "tick given at 3 s: events of kind `tick` come from the run itself",
            ),
            (
                logged_events((3.0, ActionSucceeded("zz"))),
                "events of kind `succeeded` come from the run itself",
            ),
            (logged_events((3.0, Occurred(EventKind.TIME_UP))), "occurs by itself"),
            ([(3.0, Pause())], "convert events and their times with `logged_events`"),
        ],
    )
    def test_what_no_run_can_be_given(self, site, given, says):
        with pytest.raises(Invalid, match=says):
            simulation_of(spec_of("route"), site, events=given)

    @pytest.mark.parametrize(
        "event", ["x", None, Occurred("nonsense"), GiveBack(5), GiveBack((5,))]
    )
    def test_what_is_no_event(self, event):
        with pytest.raises(Invalid):
            logged_events((1.0, event))


class TestOpenMachine:
    def test_a_task_at_a_time(self, site):
        spec = spec_of("route", mission=initial_mission(site, PLAN.tasks[0].pose))
        machine = OpenMachine(spec.mission)
        with Simulation(machine, site, spec) as simulation:
            steps(simulation, 20)
            assert (simulation.task, simulation.ended) == (None, False)
            simulation.append_task(measure(2))
            with pytest.raises(Conflict, match="'MEASURE 2' is still running"):
                simulation.append_task(measure(3))
            until(simulation, lambda: simulation.task is None)
            simulation.handle(Pause())
            simulation.append_task(measure(3))
            assert simulation.task is None
            simulation.handle(Resume())
            assert simulation.task.name == "MEASURE 3"
            machine.close()
            record = simulation.run()
        assert [r.checkpoint for r in record.readings] == [2, 3]
        assert record.tasks[0].start == 2.0
        assert record.result.outcome is Outcome.COMPLETED


@pytest.fixture(scope="module")
def steered(site, tmp_path_factory):
    """Return the record of a run with commands from outside, and the path of its journal."""
    path = tmp_path_factory.mktemp("steered") / "run.journal"
    spec = spec_of("route")
    with journaled(path, spec, site) as simulation:
        steps(simulation, 20)
        simulation.handle(InjectFault(AbnormalValue(checkpoint=3, value=8.0)))
        take_over(simulation, after=10)
        steps(simulation, 30)
        simulation.handle(GiveBack((ByHand(task="MEASURE 1", value=3.0),)))
        record = simulation.run()
        return record, path


class TestJournalOfASteeredRun:
    def test_it_ends_as_it_has_ended(self, site, steered):
        record, path = steered
        with open_journal(path) as journal:
            assert journal.had_ended_when_opened
            assert resume(journal, site) == record
        assert record.readings[-1].value == 8.0

    @pytest.mark.parametrize("share", [0.1, 0.2, 0.25, 0.3, 0.5, 0.8])
    def test_it_goes_on_from_anywhere(self, site, steered, tmp_path, share):
        record, whole = steered
        path = tmp_path / "run.journal"
        cut(whole, share, path)
        with open_journal(path) as journal:
            told = journal.entries
            events = () if any(e.events and e.events[0].kind == "give_back" for e in told) else (
                logged_events((0.0, GiveBack((ByHand(task="MEASURE 1", value=3.0),))))
            )  # fmt: skip
            taken_over = any(e.events and e.events[0].kind == "take_over" for e in told)
            again = resume(journal, site, events=events if taken_over else ())
        assert again.result.outcome is Outcome.COMPLETED
        assert again.resumed == (told[-1].t,)
        reached_in = any(e.faults for e in told)
        assert again.faults == (record.faults if reached_in else ())
        known = {r.task: r.value for r in again.readings}
        assert set(known) == {"MEASURE 2", "MEASURE 3"} | (set() if taken_over else {"MEASURE 1"})
        assert (known["MEASURE 3"] == 8.0) is reached_in


class TestSpec:
    def test_it_goes_through_json(self):
        spec = spec_of("kinematic", faults=FAULTS, events=EVENTS, values={2: 4.5})
        assert read_spec(spec.model_dump_json()) == spec
        assert pickle.loads(pickle.dumps(spec)) == spec

    @pytest.mark.parametrize(
        ("change", "says"),
        [
            ({"seed": -1}, "spec.json: seed: `seed` has to be at least 0"),
            ({"speed": 3}, "spec.json: speed: "),
            ({"mission": None}, "spec.json: mission: "),
            ({"events": [[3.0, {"kind": "succeeded", "task": "A"}]]}, "spec.json: events: "),
            ({"events": [[-3.0, {"kind": "pause"}]]}, "no event can occur at -3 s"),
            ({"events": [[3.0, {"kind": "occurred", "event": "time_up"}]]}, "occurs by itself"),
            ({"events": [[3.0, {"kind": "pause", "value": 3}]]}, "no event of kind pause has"),
            ({"faults": [{"kind": "flood"}]}, r"spec.json: faults\[0\]: "),
        ],
    )
    def test_what_is_none(self, change, says):
        data = json.loads(spec_of("route").model_dump_json()) | change
        with pytest.raises(Invalid, match=says):
            read_spec(json.dumps(data), "spec.json")

    def test_no_json(self):
        with pytest.raises(Unavailable, match=r"spec\.json is damaged: line 1, column 2"):
            read_spec(b"{", "spec.json")

    def test_a_worker_runs_it(self, site, tmp_path):
        """A worker process opens the site by the reference in the spec."""
        file = write_site(tmp_path / "yard.yaml")
        spec = spec_of("route", site=file)
        sent = pickle.loads(pickle.dumps((run, spec)))
        assert sent[0](sent[1]) == simulate(spec, site)

    def test_an_area_that_is_not_there(self, site):
        plan = mission(waypoint("A", 2.05, 2.05), end_area=7)
        with pytest.raises(NotFound, match="no starting area 7; there are: 1"):
            simulate(RunSpec(mission=plan, site="yard", drive="route"), site)


class TestWhatDoesNotFitTogether:
    def test_another_site_than_the_spec_names(self, site):
        spec = spec_of("route", site="umad", mission=PLAN.model_copy(update={"site": ""}))
        for begin in (lambda: simulate(spec, site), lambda: simulation_of(spec, site)):
            with pytest.raises(Conflict, match="names site umad, and the site given is yard"):
                begin()

    def test_a_mission_of_another_site(self, site):
        spec = spec_of("route", mission=PLAN.model_copy(update={"site": "umad"}))
        with pytest.raises(Conflict, match="planned for site umad, and the site is yard"):
            simulate(spec, site)

    def test_a_run_that_was_checked_on_another_site(self, site):
        known, other = (
            check_run(spec_of("route"), site),
            OpenedSite.from_site(site_of(name="other")),
        )
        for begin in (
            lambda: simulate(known, other),
            lambda: Simulation(Executor(lower(PLAN)), other, known),
        ):
            with pytest.raises(Conflict, match="planned for site yard, and the site is other"):
                begin()
        assert simulate(known) == simulate(known, site) == simulate(known.spec, site)

    def test_the_machine_of_another_mission(self, site):
        with pytest.raises(Conflict, match="not that of the spec's mission"):
            Simulation(Executor(lower(SHORT)), site, spec_of("route"))

    def test_a_machine_that_was_used(self, site):
        machine = Executor(lower(PLAN))
        with Simulation(machine, site, spec_of("route")) as simulation:
            steps(simulation, 3)
        with pytest.raises(Conflict, match="has been started already"):
            Simulation(machine, site, spec_of("route"))


def observer_that_acts(method, action):
    """Return an observer that calls `action` in its method of this name."""
    observer = Observer()
    setattr(observer, method, lambda *_: action())
    return observer


class TestObservers:
    @pytest.mark.parametrize("method", ["on_entry", "on_entry_applied", "on_step"])
    @pytest.mark.parametrize(
        "action", [lambda s: s.handle(Pause()), lambda s: s.step(), lambda s: s.run()]
    )
    def test_they_can_not_steer(self, site, method, action):
        observer = observer_that_acts(method, lambda: action(simulation))
        with (
            simulation_of(spec_of("route"), site, observers=[observer]) as simulation,
            pytest.raises(Conflict, match="between two steps"),
        ):
            steps(simulation, 20)

    @pytest.mark.parametrize("method", ["on_entry", "on_entry_applied", "on_step"])
    def test_what_they_raise_breaks_the_run_off(self, site, method):
        def fail():
            if simulation.now == 2.0:
                raise OSError("no room")

        observer = observer_that_acts(method, fail)
        with simulation_of(spec_of("route"), site, observers=[observer]) as simulation:
            with pytest.raises(OSError, match="no room"):
                simulation.run()
            for use in (simulation.step, simulation.run, lambda: simulation.handle(Pause())):
                with pytest.raises(Conflict, match="an error has ended the simulation, at 2 s"):
                    use()

    def test_what_is_refused_breaks_nothing(self, site):
        with simulation_of(spec_of("route"), site) as simulation:
            steps(simulation, 20)
            with pytest.raises(Invalid):
                simulation.handle(None)
            assert simulation.run() == simulate(spec_of("route"), site)


def test_a_closed_simulation_is_of_no_use(site, drive):
    simulation = simulation_of(spec_of(drive), site)
    steps(simulation, 3)
    record = simulation.record()
    simulation.close()
    for use in (simulation.step, simulation.run, lambda: simulation.handle(Pause())):
        with pytest.raises(Conflict, match="is closed"):
            use()
    assert simulation.record() == record
