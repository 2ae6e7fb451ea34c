"""Actions by hand: a person who has taken the robot over lets it drive and measure."""

import pytest

from argo_compiler.base.errors import Conflict, Invalid, NotFound
from argo_compiler.hfsm import ByHand, Cancel, GiveBack, Outcome, Pause, Resume
from argo_compiler.il import Action, Task
from argo_env.faults.checkpoints import AbnormalValue
from argo_env.run.journal import open_journal
from argo_env.run.run_commands import DoByHand, StopByHand
from argo_env.run.session import resume
from argo_env.run.spec import RunSpec, logged_events
from tests.yard import (
    journaled,
    measure,
    mission,
    simulation_of,
    steps,
    take_over,
    to_rest,
    waypoint,
)

PLAN = mission(measure(1), waypoint("A", 4.05, 2.05), measure(2))
SPEC = RunSpec(mission=PLAN, site="yard", drive="route", seed=3)
FIRST, SECOND = PLAN.task("MEASURE 1"), PLAN.task("MEASURE 2")
GAUGE_3 = Task(name="look at gauge 3", action=Action.MEASURE, object_id="3")
THERE = waypoint("there", 5.05, 2.05)


@pytest.fixture
def simulation(site):
    """Yield a simulation whose robot was taken over on its path to the first gauge, and rests."""
    with simulation_of(SPEC, site) as simulation:
        take_over(simulation, after=20)
        yield simulation


def do_by_hand(simulation, *tasks):
    """Let the robot do the tasks by hand, one after the other."""
    for task in tasks:
        simulation.handle(DoByHand(task))
        to_rest(simulation)


class TestDoing:
    def test_what_was_done_counts_once_the_robot_is_given_back(self, simulation):
        do_by_hand(simulation, SECOND, THERE)
        assert (simulation.pose.x, simulation.pose.y) == pytest.approx((5.05, 2.05))
        (done,) = simulation.done_by_hand
        reading, run = simulation.record().readings[0], simulation.record().tasks[-2]
        assert (done.task, done.value, done.abnormal) == (SECOND.name, reading.value, False)
        assert (done.duration, done.age) == (run.end - run.start, simulation.now - run.end)
        simulation.handle(GiveBack(simulation.done_by_hand))
        assert simulation.done_by_hand == ()
        record = simulation.run()
        assert record.result.outcome is Outcome.COMPLETED
        assert [(t.task, t.outcome_in_words) for t in record.tasks] == [
            ("MEASURE 1", "interrupted"), ("MEASURE 2", "done by hand"), ("there", "done by hand"),
            ("MEASURE 1", "done"), ("A", "done"),
        ]  # fmt: skip
        assert record.result.verdict == "the mission was completed; done by hand: MEASURE 2"

    def test_what_is_not_given_is_done_again(self, simulation):
        do_by_hand(simulation, FIRST)
        simulation.handle(Resume())
        record = simulation.run()
        assert [t.outcome_in_words for t in record.tasks if t.task == "MEASURE 1"] == [
            "interrupted", "done by hand", "done",
        ]  # fmt: skip
        assert record.result.verdict == "everything was done as planned"

    def test_a_person_adds_what_they_skip(self, simulation):
        do_by_hand(simulation, FIRST)
        skipped = ByHand(task="MEASURE 2", skipped=True)
        simulation.handle(GiveBack((*simulation.done_by_hand, skipped)))
        assert simulation.run().result.verdict == (
            "the mission was completed; done by hand: MEASURE 1; skipped by a person: MEASURE 2"
        )

    @pytest.mark.rule("C3", "C8")
    def test_the_machine_knows_what_was_read_at_once(self, simulation):
        do_by_hand(simulation, GAUGE_3)
        (reading,) = simulation.machine.progress().readings
        assert (reading.object_id, reading.age) == ("3", 0.0)
        record = simulation.record()
        assert reading.value == record.readings[0].value
        assert record.given_values == ()
        assert simulation.done_by_hand == ()

    @pytest.mark.rule("C3")
    def test_a_value_that_is_abnormal(self, site):
        spec = SPEC.model_copy(update={"faults": (AbnormalValue(checkpoint=1, value=9.0),)})
        with simulation_of(spec, site) as simulation:
            take_over(simulation, after=20)
            do_by_hand(simulation, FIRST)
            assert simulation.done_by_hand[0].abnormal
            assert simulation.machine.progress().readings[0].abnormal
            (finding,) = simulation.record().findings
            assert finding.is_reading

    def test_the_mission_stands_still_meanwhile(self, simulation):
        before = simulation.machine.progress()
        do_by_hand(simulation, THERE)
        after = simulation.machine.progress()
        assert (after.active, after.tallies) == (before.active, before.tallies)
        assert after.paused
        assert after.actions == before.actions

    def test_what_fails_by_hand_is_no_failure_of_the_mission(self, simulation):
        do_by_hand(simulation, waypoint("off the slab", 50.0, 50.0))
        assert simulation.record().tasks[-1].outcome_in_words == "failed by hand"
        assert simulation.done_by_hand == ()
        simulation.handle(GiveBack())
        assert simulation.run().result.verdict == "everything was done as planned"

    def test_a_run_does_not_end_as_the_robot_acts(self, simulation):
        simulation.handle(DoByHand(SECOND))
        record = simulation.run()
        assert [t.outcome_in_words for t in record.tasks] == ["interrupted", "done by hand"]
        assert "paused" in record.result.verdict


class TestStopping:
    def test_a_person_stops_it(self, simulation):
        simulation.handle(DoByHand(SECOND))
        simulation.step()
        assert simulation.by_hand == SECOND
        simulation.handle(StopByHand())
        to_rest(simulation)
        run = simulation.record().tasks[-1]
        assert (run.outcome_in_words, run.reason) == ("cancelled by hand", "a person stopped it")
        assert simulation.by_hand is None
        assert simulation.done_by_hand == ()
        do_by_hand(simulation, SECOND)
        assert simulation.done_by_hand

    def test_there_is_nothing_to_stop(self, simulation):
        with pytest.raises(Conflict, match="does nothing by hand"):
            simulation.handle(StopByHand())

    def test_the_mission_is_cancelled_meanwhile(self, simulation):
        simulation.handle(DoByHand(SECOND))
        simulation.step()
        simulation.handle(Cancel())
        record = simulation.record()
        assert record.result.outcome is Outcome.CANCELLED
        assert record.tasks[-1].outcome_in_words == "cancelled by hand"


class TestRefusals:
    def test_nobody_has_taken_over(self, site):
        with simulation_of(SPEC, site) as simulation:
            with pytest.raises(Conflict, match="'MEASURE 1' has not ended"):
                simulation.handle(DoByHand(SECOND))
            simulation.handle(Pause())
            to_rest(simulation)
            with pytest.raises(Conflict, match="nobody has taken the robot over"):
                simulation.handle(DoByHand(SECOND))

    def test_not_after_it_was_given_back(self, simulation):
        simulation.handle(GiveBack())
        simulation.handle(Pause())
        to_rest(simulation)
        assert not simulation.taken_over
        with pytest.raises(Conflict, match="nobody has taken the robot over"):
            simulation.handle(DoByHand(SECOND))

    @pytest.mark.parametrize("event", [GiveBack(), Resume(), DoByHand(THERE)])
    def test_while_an_action_by_hand_is_under_way(self, simulation, event):
        simulation.handle(DoByHand(SECOND))
        simulation.step()
        with pytest.raises(Conflict, match="MEASURE 2"):
            simulation.handle(event)
        to_rest(simulation)
        assert simulation.done_by_hand

    @pytest.mark.parametrize(
        ("task", "kind", "says"),
        [
            (None, Invalid, "None is not a task"),
            (Task(name="W", action=Action.START), Invalid, "does nothing"),
            (Task(name="W", action=Action.WAYPOINT), Invalid, "does not state where"),
            (Task(name="M", action=Action.MEASURE, object_id="9"), NotFound, "no checkpoint 9"),
            (THERE.model_copy(update={"name": "A"}), Invalid, "another task 'A'"),
        ],
    )
    def test_what_no_robot_does(self, simulation, task, kind, says):
        before = simulation.record()
        with pytest.raises(kind, match=says):
            simulation.handle(DoByHand(task))
        assert simulation.record() == before

    def test_a_resume_given_beforehand_waits_for_its_end(self, site):
        spec = SPEC.model_copy(update={"events": logged_events((4.0, Resume()))})
        with simulation_of(spec, site) as simulation:
            take_over(simulation, after=20)
            simulation.handle(DoByHand(SECOND))
            while simulation.by_hand:
                assert simulation.taken_over
                simulation.step()
            assert simulation.now > 4.0
            simulation.step()
            assert simulation.task == FIRST


@pytest.fixture(scope="module")
def content(site, tmp_path_factory):
    path = tmp_path_factory.mktemp("by_hand") / "run.journal"
    with journaled(path, SPEC, site) as simulation:
        take_over(simulation, after=20)
        do_by_hand(simulation, SECOND)
        simulation.handle(DoByHand(FIRST))
        steps(simulation, 12)
        simulation.handle(StopByHand())
        to_rest(simulation)
        simulation.handle(GiveBack(simulation.done_by_hand))
        record = simulation.run()
        return path.read_bytes(), record


class TestJournal:
    def test_it_ends_as_it_has_ended(self, site, content, tmp_path):
        path = tmp_path / "run.journal"
        path.write_bytes(content[0])
        with open_journal(path) as journal:
            assert resume(journal, site) == content[1]

    @pytest.mark.parametrize("killed", ["acting", "after"])
    def test_a_killed_run_stands_where_it_stood(self, site, content, tmp_path, killed):
        lines = content[0].splitlines(keepends=True)
        begun = [i for i, line in enumerate(lines) if b'"by_hand":{"name":"MEASURE' in line]
        ended = [i for i, line in enumerate(lines) if b'"outcome":"done"' in line]
        path = tmp_path / "run.journal"
        path.write_bytes(b"".join(lines[: begun[0] + 2 if killed == "acting" else ended[0] + 2]))
        with open_journal(path) as journal:
            kept = journal.entries
            with simulation_of(SPEC, site, past=kept, observers=[journal]) as simulation:
                assert (simulation.taken_over, simulation.task) == (True, None)
                assert simulation.now == kept[-1].t
                assert simulation.pose == kept[-1].body_pose
                names = [done.task for done in simulation.done_by_hand]
                assert names == ([] if killed == "acting" else ["MEASURE 2"])
                do_by_hand(simulation, FIRST)
                simulation.handle(GiveBack(simulation.done_by_hand))
                record = simulation.run()
        hows = [(t.task, t.outcome_in_words) for t in record.tasks]
        if killed == "acting":
            assert hows[1] == ("MEASURE 2", "interrupted by hand")
            assert hows[-1] == ("MEASURE 2", "done")
        assert record.result.success
        assert sum(how.startswith("done") for _, how in hows) == 3
        with open_journal(path) as journal:
            assert resume(journal, site) == record
