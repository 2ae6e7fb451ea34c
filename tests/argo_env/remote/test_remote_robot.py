"""Missions on a remote robot that loses its connection now and then."""

from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.base.errors import Unavailable
from argo_compiler.hfsm import Cancel, GiveBack, Outcome
from argo_compiler.il import EventKind
from argo_env.remote.channel import Channel
from argo_env.remote.messages import EndReport, FoundReport, message_schemas
from argo_env.remote.robot import RemoteRobot
from argo_env.run.run_commands import DoByHand, StopRun
from argo_env.run.spec import RunSpec
from tests.argo_env.remote.fakes import FakeRobot, Time, Wires
from tests.conftest import examples
from tests.yard import (
    journaled,
    measure,
    mission,
    simulation_of,
    steps,
    take_over,
    waypoint,
)

PLAN = mission(measure(1), waypoint("A", 4.05, 2.05), measure(2), waypoint("B", 2.05, 1.55))
SPEC = RunSpec(mission=PLAN, site="yard", drive="route")
NAMES = ["MEASURE 1", "A", "MEASURE 2", "B"]


class Yard:
    """A remote robot in the yard, the link to it, and Argo's side of the link."""

    def __init__(self, yard, seed=0, loss=0.0, values=None):
        self.navigator = yard
        self.wires = Wires(Random(seed), loss)
        self.time = Time()
        self.robot = FakeRobot(self.wires, self.time, values)
        self.robot.pose = PLAN.tasks[0].pose
        self.time.others.append(self.robot)
        self._sessions = 0

    def remote(self, patience=10.0):
        self._sessions += 1
        channel = Channel(self.wires.end(0), f"argo {self._sessions}", self.time)
        return RemoteRobot(
            self.navigator, channel, "run 1", self.time, self.time.sleep, patience=patience
        )


@pytest.fixture
def there(yard):
    return Yard(yard)


@pytest.fixture
def simulation(there, site):
    """Yield a run of the mission on the remote robot."""
    with simulation_of(SPEC, site, robot=there.remote()) as simulation:
        yield simulation


def done(record):
    return [t.task for t in record.tasks if t.outcome == "done"]


def test_a_mission_is_executed(yard, site):
    there = Yard(yard, values={"2": 9.0})
    with simulation_of(SPEC, site, robot=there.remote()) as simulation:
        record = simulation.run()
    assert record.result.outcome is Outcome.COMPLETED
    assert done(record) == NAMES
    assert [(r.value, r.normal) for r in record.readings] == [(3.0, True), (9.0, False)]
    assert (record.drive, record.sensor) == ("remote", "remote")
    assert record.path[-1].charge == 0.5
    assert (record.path[-1].x, record.path[-1].y) == (2.05, 1.55)
    (finding,) = record.findings
    assert finding.is_reading
    assert record.result.duration == pytest.approx(there.time.now - 1_000_000.0, abs=0.3)


@settings(max_examples=examples(30), deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([0.1, 0.3, 0.6]))
def test_nothing_is_lost_and_nothing_is_done_twice(yard, site, seed, loss):
    there = Yard(yard, seed, loss)
    with simulation_of(SPEC, site, robot=there.remote(patience=100)) as simulation:
        record = simulation.run()
    assert done(record) == NAMES
    assert set(there.robot.begun.values()) == set(there.robot.finished.values()) == {1}
    assert len(there.robot.finished) == 4


class TestConnection:
    def test_nothing_is_assumed_without_a_connection(self, there, simulation):
        steps(simulation, 5)
        assert simulation.silent_since is None
        there.wires.broken = True
        before = simulation.record().tasks
        at = simulation.now
        steps(simulation, 100)
        assert there.robot.finished  # Argo can't know this yet
        assert simulation.record().tasks == before
        assert simulation.task.name == "MEASURE 1"
        assert simulation.silent_since == pytest.approx(at, abs=0.2)
        there.wires.broken = False
        record = simulation.run()
        assert simulation.silent_since is None
        assert done(record) == NAMES
        assert record.tasks[0].end > 10.0

    def test_a_stop_is_under_way_until_the_robot_confirms_it(self, there, simulation):
        steps(simulation, 5)
        there.wires.broken = True
        simulation.handle(Cancel())
        steps(simulation, 3)
        assert not simulation.ended
        there.robot.TICKS = 1000
        there.robot.doing = (there.robot.doing[0], 1000)
        steps(simulation, 30)
        assert not simulation.ended
        there.wires.broken = False
        record = simulation.run()
        assert record.result.outcome is Outcome.CANCELLED
        assert there.robot.stopped == ["run 1/1"]

    def test_an_unreachable_robot_is_an_error(self, yard):
        there = Yard(yard)
        there.wires.broken = True
        with pytest.raises(Unavailable, match="has not reported its pose within 10 s"):
            there.remote()

    @pytest.mark.parametrize("broken", [False, True])
    def test_a_run_that_ends_stops_the_robot(self, yard, site, broken):
        there = Yard(yard)
        remote = there.remote()
        with simulation_of(SPEC, site, robot=remote) as simulation:
            steps(simulation, 5)
            there.wires.broken = broken
            simulation.handle(StopRun())
            assert remote.wait_acknowledged(2.0) is not broken
        assert there.robot.stopped == ([] if broken else ["run 1/1"])


class TestRestartedRobot:
    @pytest.mark.parametrize("forget", [False, True])
    def test_an_action_that_it_does_not_know_fails(self, there, simulation, forget):
        steps(simulation, 5)
        there.robot.boot(forget)
        record = simulation.run()
        assert record.tasks[0].outcome == "failed"
        assert "the robot has restarted" in record.tasks[0].reason
        assert done(record) == NAMES[1:]

    def test_ends_that_it_reports_again_count(self, there, simulation):
        steps(simulation, 5)
        there.wires.broken = True
        steps(simulation, 20)
        there.robot.boot()
        for report in there.robot.ended.values():
            there.robot._channel.post(report)
        there.wires.broken = False
        record = simulation.run()
        assert done(record) == NAMES
        assert set(there.robot.begun.values()) == {1}


class TestRestartedArgo:
    @pytest.mark.parametrize("at", [3, 12, 14, 16, 20, 30])
    def test_an_action_continues(self, yard, site, tmp_path, at):
        """The robot continued while Argo was not running; no action is executed twice."""
        there, path = Yard(yard), tmp_path / "run.journal"
        with journaled(path, SPEC, site, robot=there.remote()) as simulation:
            steps(simulation, at)
        there.time.sleep(0.1)
        there.time.sleep(0.1)
        with journaled(path, SPEC, site, robot=there.remote()) as simulation:
            record = simulation.run()
        assert done(record) == NAMES
        assert set(there.robot.begun.values()) == {1}
        assert len(record.resumed) == 1

    def test_an_action_by_hand_is_stopped(self, yard, site, tmp_path):
        there, path = Yard(yard), tmp_path / "run.journal"
        with journaled(path, SPEC, site, robot=there.remote()) as simulation:
            take_over(simulation, after=3)
            simulation.handle(DoByHand(PLAN.task("A")))
            steps(simulation, 3)
        there.robot.TICKS = 1000
        with journaled(path, SPEC, site, robot=there.remote()) as simulation:
            steps(simulation, 5)
            assert there.robot.doing is None
            there.robot.TICKS = 12
            assert simulation.taken_over
            simulation.handle(DoByHand(PLAN.task("A")))
            while simulation.by_hand:
                simulation.step()
            simulation.handle(GiveBack(simulation.done_by_hand))
            record = simulation.run()
        assert record.result.verdict == "the mission was completed; done by hand: A"
        assert [t.outcome_in_words for t in record.tasks[:3]] == [
            "interrupted", "interrupted by hand", "done by hand",
        ]  # fmt: skip


class TestReports:
    def test_what_the_robot_finds_is_recorded(self, there, simulation):
        steps(simulation, 3)
        there.robot._channel.post(FoundReport(event=EventKind.GAS_LEAK, detail="840 ppm"))
        there.robot._channel.post(FoundReport(event=EventKind.TIME_UP))
        record = simulation.run()
        (found,) = record.anomalies
        assert (found.kind, found.detail, found.source) == ("gas_leak", "840 ppm", "robot")

    @pytest.mark.parametrize("text", ["", "[]", "nonsense", '{"sender": 1}', "\0", "9" * 5000])
    def test_invalid_messages_are_ignored(self, there, simulation, text):
        steps(simulation, 3)
        there.wires.carry(1, text)
        assert done(simulation.run()) == NAMES

    def test_an_invalid_end_is_a_failure(self, there, simulation):
        steps(simulation, 3)
        there.robot._channel.post(EndReport.model_construct(id="run 1/1", outcome="perhaps"))
        steps(simulation, 3)
        (run,) = simulation.record().tasks
        assert (run.task, run.outcome) == ("MEASURE 1", "failed")
        assert "invalid report of the action's end" in run.reason

    def test_the_schemas_describe_each_message(self):
        schemas = message_schemas()
        assert {"start", "cancel"} == set(schemas["order"]["discriminator"]["mapping"])
        assert {"state", "ended", "found"} == set(schemas["report"]["discriminator"]["mapping"])
        assert "number" in schemas["envelope"]["properties"]
