"""Watches in a run: updates at their periods, findings reported once, detours around obstacles."""

import math
from dataclasses import replace
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.base.model import Pose
from argo_compiler.hfsm import Cause, Occurred, Outcome, Resume
from argo_compiler.il import Afterwards, EventKind, OnFailure, Reaction, Response
from argo_env.faults.schedule import FaultSchedule
from argo_env.navigation import Blockage
from argo_env.robot.pose import BodyPose
from argo_env.run.action import TURNS
from argo_env.run.journal import open_journal
from argo_env.run.perception import Perception, blockage_from_anomaly
from argo_env.run.record import Anomaly
from argo_env.run.run_setup import RunSetup
from argo_env.run.session import resume
from argo_env.run.spec import logged_events
from argo_env.run.termination import SETTLING
from argo_env.sensing.sensor import Measurement, PoorViewError
from argo_env.sensing.signals.terrain_watch import ObstacleDetection
from argo_env.sensing.watch import Detection
from tests.conftest import examples
from tests.yard import (
    Watching,
    cut,
    cut_after,
    fast_setup,
    faults_of,
    measure,
    mission,
    opened,
    resumed,
    run_with,
    simulated,
    waypoint,
)

DOCK = Pose(x=1.05, y=1.05, z=0.02)


class Scripted:
    """Watch that makes each of the given detections once, at its time (s) or later."""

    name = "scripted"

    def __init__(self, *findings, period=0.5):
        self.period = period
        self._left = list(findings)
        self.looks = []

    def update(self, now, pose):
        self.looks.append((now, pose))
        due = [f for t, f in self._left if t <= now]
        self._left = [(t, f) for t, f in self._left if t > now]
        return tuple(due)


def run(yard, plan, *watches, values=None, events=(), announce=None):
    setup = fast_setup(yard, values)
    setup = RunSetup(setup.world, setup.navigator, setup.drive, setup.sensor, watches)
    return run_with(
        plan, setup, events=logged_events(*events), observers=[Watching(announce=announce)]
    )


def obstacle(x, y, half=0.15, kind=EventKind.POSITIVE_OBSTACLE):
    rect = (x - half, y - half, x + half, y + half)
    blockage = Blockage(rect, 0.02, "a crate")
    return ObstacleDetection(kind, "a crate", (x, y, 0.02), blockage=blockage)


class TestLooking:
    @settings(max_examples=examples(30), deadline=None)
    @given(periods=st.lists(st.sampled_from([0.1, 0.2, 0.5, 1.0, 3.0]), min_size=1, max_size=5))
    def test_each_watch_at_its_period(self, yard, periods):
        watches = [Scripted(period=p) for p in periods]
        perception = Perception(watches, yard.site, 0.1)
        for step in range(1, 121):
            perception.update(step, round(0.1 * step, 6), BodyPose(0, 0, 0, 0))
        for watch in watches:
            times = [now for now, _ in watch.looks]
            assert times[0] <= watch.period + 1e-9
            for a, b in pairwise(times):
                assert b - a == pytest.approx(watch.period)

    def test_what_is_found_is_told_and_reported(self, yard):
        leak = Detection(EventKind.GAS_LEAK, "gas, 300 ppm", (2.0, 2.0, 0.5), 0.9)
        told = []
        plan = mission(waypoint("A", 3.05, 2.05))
        record = run(yard, plan, Scripted((4.0, leak)), announce=told.append)
        (anomaly,) = record.anomalies
        assert told == [anomaly]
        assert (anomaly.t, anomaly.kind, anomaly.detail) == (4.0, leak.kind, leak.detail)
        assert (anomaly.place, anomaly.confidence, anomaly.source) == (leak.place, 0.9, "scripted")
        assert anomaly.floor == 1
        assert record.result.success
        assert [s.t for s in record.trace if "gas, 300 ppm" in s.cause] == [4.0]

    def test_what_has_no_place_tells_from_where_it_was_noticed(self, yard):
        leak = Detection(EventKind.GAS_LEAK, "gas, 300 ppm", noticed_from=(2.0, 2.0, 0.5))
        record = run(yard, mission(waypoint("A", 3.05, 2.05)), Scripted((4.0, leak)))
        (anomaly,) = record.anomalies
        assert (anomaly.place, anomaly.noticed_from, anomaly.floor) == (None, (2.0, 2.0, 0.5), 1)
        # Records of before know no `noticed_from`.
        old = anomaly.model_dump(mode="json")
        del old["noticed_from"]
        assert Anomaly.model_validate(old).noticed_from is None

    def test_a_reaction_answers_and_its_end_is_sensed_too(self, yard):
        shelter = Reaction(
            event=EventKind.GAS_LEAK, response=Response.RETURN, until=EventKind.ALL_CLEAR,
            afterwards=Afterwards.RESUME,
        )  # fmt: skip
        watch = Scripted(
            (4.0, Detection(EventKind.GAS_LEAK, "gas")),
            (40.0, Detection(EventKind.ALL_CLEAR, "none")),
        )
        plan = mission(waypoint("A", 5.05, 3.05), reactions=(shelter,), dock=DOCK)
        # Something that occurs later keeps the run from ending while it waits.
        record = run(yard, plan, watch, events=((60.0, Occurred(EventKind.HOT_SPOT)),))
        assert [(t.task, t.outcome) for t in record.tasks] == [
            ("A", "interrupted"), ("react to gas_leak", "done"), ("A", "done"),
        ]  # fmt: skip
        assert record.tasks[2].start == 40.0
        assert record.result.success

    def test_an_abnormal_reading_is_among_what_was_found(self, yard):
        record = run(yard, mission(measure(1)), values={1: 9.0})
        (anomaly,) = record.anomalies
        assert anomaly.kind is EventKind.ABNORMAL_READING
        assert anomaly.detail == "gauge 1 shows 9 bar"
        assert anomaly.t == record.readings[0].t


class TestObstacles:
    PLAN = mission(waypoint("A", 5.55, 2.55))

    def nearest(self, record, x, y):
        return min(math.dist((s.x, s.y), (x, y)) for s in record.path)

    def test_another_way_is_taken(self, yard):
        free = run(yard, self.PLAN)
        half_way = next(s for s in free.path if s.t >= 0.65 * free.result.duration)
        x, y = half_way.x, half_way.y
        assert self.nearest(free, x, y) < 0.1
        record = run(yard, self.PLAN, Scripted((3.0, obstacle(x, y))))
        assert record.result.success
        assert [t.outcome for t in record.tasks] == ["done"]
        assert self.nearest(record, x, y) > 0.29 + 0.15
        assert record.path[-1].x == pytest.approx(free.path[-1].x, abs=0.01)
        for a, b in pairwise(record.path):
            assert math.dist((a.x, a.y), (b.x, b.y)) <= 0.4 * (b.t - a.t) + 0.08

    def test_a_detour_leads_to_the_view_that_was_under_way(self, yard):
        looks = []

        class Turned:
            """Sensor for a checkpoint that can't be read from the first view."""

            name = "turned"

            def measure(self, _, pose):
                looks.append(pose)
                if len(looks) == 1:
                    raise PoorViewError("too much from the side")
                return Measurement(4.0, 1.0)

        class OnTheWay(Scripted):
            """Watch that finds an obstacle ahead once the robot drives to the next view."""

            def update(self, _, pose):
                if not looks or self._left:
                    return ()
                if math.dist((pose.x, pose.y), (looks[0].x, looks[0].y)) < 0.1:
                    return ()
                self._left = [Pose(x=pose.x, y=pose.y, z=pose.z, yaw=pose.yaw)]
                view = yard.plan_to_view(self._left[0], 1, TURNS[1]).end
                return (obstacle((pose.x + view.x) / 2, (pose.y + view.y) / 2, 0.05),)

        setup = fast_setup(yard)
        watch = OnTheWay(period=0.1)
        setup = replace(setup, sensor=Turned(), watches=(watch,))
        record = run_with(mission(measure(1)), setup)
        (found,), (reading,) = record.anomalies, record.readings
        assert record.result.success
        assert len(looks) == reading.views == 2
        aware = yard.with_added_blockages([blockage_from_anomaly(found)])
        unturned, turned = (aware.plan_to_view(watch._left[0], 1, t).end for t in TURNS[:2])
        assert math.dist((looks[1].x, looks[1].y), (turned.x, turned.y)) < 0.01
        assert math.dist((unturned.x, unturned.y), (turned.x, turned.y)) > 0.1

    def test_one_that_is_not_in_the_way_changes_nothing(self, yard):
        aside = obstacle(1.05, 4.0)
        record = run(yard, self.PLAN, Scripted((3.0, aside)))
        assert record.path == run(yard, self.PLAN).path
        assert len(record.anomalies) == 1

    @pytest.mark.parametrize(
        ("policy", "outcome"),
        [
            (OnFailure.CONTINUE, Outcome.COMPLETED_WITH_FAILURES),
            (OnFailure.RETURN, Outcome.RETURNED),
        ],
    )
    def test_without_another_way_the_task_fails_with_the_reason(self, yard, policy, outcome):
        rect = (3.4, 0.0, 3.6, 5.0)
        wall = ObstacleDetection(
            EventKind.NEGATIVE_OBSTACLE, "a trench", (3.5, 2.5, 0.02),
            blockage=Blockage(rect, 0.02, "a trench"),
        )  # fmt: skip
        plan = mission(
            waypoint("A", 5.55, 2.55, on_failure=policy), waypoint("B", 1.55, 1.55), dock=DOCK
        )
        record = run(yard, plan, Scripted((1.0, wall)))
        first, *rest = record.tasks
        assert (first.task, first.outcome) == ("A", "failed")
        assert "a trench" in first.reason
        assert [t.outcome for t in rest] == ["done"]
        assert record.result.outcome is outcome
        assert not record.result.success

    def test_a_pause_comes_first_then_the_detour(self, yard):
        pause = Reaction(event=EventKind.POSITIVE_OBSTACLE, response=Response.PAUSE)
        plan = mission(waypoint("A", 5.55, 2.55), reactions=(pause,))
        record = run(yard, plan, Scripted((3.0, obstacle(3.3, 1.8))), events=((30.0, Resume()),))
        assert [(t.task, t.outcome) for t in record.tasks] == [("A", "interrupted"), ("A", "done")]
        assert self.nearest(record, 3.3, 1.8) > 0.44
        assert record.tasks[1].start == 30.0


def anomaly(kind, t, place=None, source="scripted"):
    return Anomaly(t=t, kind=kind, detail="", source=source, place=place)


FAULTS = faults_of(
    {"kind": "brick", "floor": 1, "place": [3.0, 2.0], "yaw": 0},
    {"kind": "connection_loss", "at": 4, "until": 12},
    {"kind": "abnormal_value", "checkpoint": 3, "value": 8.0, "at": 5},
    {"kind": "low_battery", "charge": 0.202},
    {"kind": "worn_battery", "capacity": 0.1},
)


@pytest.fixture(scope="module")
def whole(yard, tmp_path_factory):
    path = tmp_path_factory.mktemp("whole") / "run.journal"
    plan = mission(waypoint("A", 5.05, 2.55), measure(3), waypoint("B", 1.55, 1.55))
    return path, simulated(plan, yard, seed=4, faults=FAULTS, journal=path)


class TestResumed:
    """Resumed runs, whose new watches find the same things again."""

    def look(self, yard, told, finding, now):
        perception = Perception((Scripted((0.0, finding), period=0.1),), yard.site, 0.1)
        perception.restore_anomalies([(a, BodyPose(0, 0, 0, 0)) for a in told], 100.0)
        return perception.update(round(now * 10), now, BodyPose(0, 0, 0, 0))

    def test_not_told_twice(self, yard):
        spot = Detection(EventKind.HOT_SPOT, "", (2.3, 2.2, 1.0))
        told = [anomaly(EventKind.HOT_SPOT, 90.0, (2.0, 2.0, 1.0))]
        assert self.look(yard, told, spot, 100.5) == ()
        assert self.look(yard, told, spot, 300.0) == ()

    def test_other_things_are_told(self, yard):
        at, away = (2.0, 2.0, 1.0), (4.0, 2.0, 1.0)
        told = [anomaly(EventKind.HOT_SPOT, 90.0, at)]
        for kind, place in (
            (EventKind.HOT_SPOT, away), (EventKind.HOT_SPOT, None), (EventKind.GAS_LEAK, at)
        ):  # fmt: skip
            assert len(self.look(yard, told, Detection(kind, "", place), 100.5)) == 1
        told = [anomaly(EventKind.HOT_SPOT, 90.0, at, source="another watch")]
        assert len(self.look(yard, told, Detection(EventKind.HOT_SPOT, "", at), 100.5)) == 1

    def test_a_watch_remembers_only_what_it_has_told_itself(self, yard):
        class Remembering(Scripted):
            def restore(self, told, now):
                self.told = [(each.kind, each.pose) for each in told], now

        watch = Remembering((0.0, Detection(EventKind.ALL_CLEAR, "", (2.0, 2.0, 1.0))), period=0.1)
        perception = Perception((watch,), yard.site, 0.1)
        pose = BodyPose(1, 2, 3, 0)
        own = anomaly(EventKind.ALL_CLEAR, 90.0, (2.0, 2.0, 1.0))
        other = anomaly(EventKind.GAS_LEAK, 95.0, source="another watch")
        perception.restore_anomalies([(own, pose), (other, pose)], 100.0)
        assert watch.told == ([(EventKind.ALL_CLEAR, pose)], 100.0)
        assert len(perception.update(1001, 100.1, pose)) == 1

    def test_obstacles_are_known_by_their_place(self, yard):
        told = [anomaly(EventKind.POSITIVE_OBSTACLE, 90.0, (2.0, 2.0, 0.02))]
        assert self.look(yard, told, obstacle(2.3, 2.2), 900.0) == ()
        assert len(self.look(yard, told, obstacle(4.0, 2.0), 100.5)) == 1

    @pytest.mark.physics
    def test_the_whole_run(self, whole):
        _, record = whole
        assert sorted(a.kind for a in record.anomalies) == sorted(
            [
                EventKind.POSITIVE_OBSTACLE, EventKind.CONNECTION_LOST,
                EventKind.CONNECTION_RESTORED, EventKind.LOW_BATTERY, EventKind.ABNORMAL_READING,
            ]
        )  # fmt: skip
        assert record.result.success

    @pytest.mark.physics
    def test_the_same_again(self, yard, whole):
        _, record = whole
        assert simulated(record.mission, yard, seed=4, faults=FAULTS) == record

    @pytest.mark.physics
    @pytest.mark.parametrize("share", [0.1, 0.3, 0.5, 0.8, 0.97])
    def test_a_run_that_was_cut_short(self, yard, whole, tmp_path, share):
        path, record = whole
        part = tmp_path / "cut.journal"
        cut(path, share, part)
        again = resumed(part, yard)
        assert again.result.success
        assert [r.value for r in again.readings] == [r.value for r in record.readings]
        assert sorted(a.kind for a in again.anomalies) == sorted(a.kind for a in record.anomalies)
        assert again.faults == record.faults
        assert again.contacts == ()
        assert again.path[-1].charge == pytest.approx(record.path[-1].charge, abs=0.01)

    @pytest.mark.physics
    def test_further_events_are_given_on_resuming_and_kept(self, yard, whole, tmp_path):
        path, _ = whole
        part = tmp_path / "cut.journal"
        cut(path, 1 / 3, part)
        events = logged_events(
            (2.0, Occurred(EventKind.HOT_SPOT)), (40.0, Occurred(EventKind.ALL_CLEAR))
        )
        with open_journal(part) as journal:
            began = journal.entries[-1].t
            first = resume(journal, opened(yard), events=events)
        reported = {s.cause: s.t for s in first.trace if s.cause.startswith(Cause.REPORT)}
        hot = [s.t for s in first.trace if "hot spot" in s.cause]
        assert hot == [pytest.approx(began + 0.1)], reported
        assert 40.0 in [s.t for s in first.trace if "all clear" in s.cause]
        # The journal knows them: the same again from it, without giving them anew.
        lines = part.read_bytes().splitlines(keepends=True)
        later = tmp_path / "later.journal"
        third = len(lines) // 3 + 2
        later.write_bytes(b"".join(lines[: third + 3]))
        second = resumed(later, yard)
        assert 40.0 in [s.t for s in second.trace if "all clear" in s.cause]
        assert [s.t for s in second.trace if "hot spot" in s.cause] == hot


LOST = Reaction(
    event=EventKind.CONNECTION_LOST, response=Response.PAUSE, until=EventKind.CONNECTION_RESTORED
)


class TestResumedWhileItWaits:
    """Resumed runs with the drive `route`, cut while a reaction waits for its end."""

    LOW = Reaction(
        event=EventKind.LOW_BATTERY, response=Response.RETURN, until=EventKind.BATTERY_CHARGED,
        afterwards=Afterwards.RESUME,
    )  # fmt: skip

    def cut_where(self, yard, tmp_path, reaction, faults, wanted):
        """Return the records of the complete run and of one cut at the wanted entry and resumed."""
        path = tmp_path / "run.journal"
        plan = mission(waypoint("A", 5.05, 2.55), reactions=(reaction,), dock=DOCK)
        whole = simulated(plan, yard, drive="route", faults=faults_of(*faults), journal=path)
        assert whole.result.success
        with open_journal(path) as journal:
            at = next(k for k, entry in enumerate(journal.entries) if wanted(entry))
        cut_after(path, at + 1)
        return whole, resumed(path, yard)

    @pytest.mark.parametrize("charge", [0.3, 0.7, 0.98])
    def test_charging(self, yard, tmp_path, charge):
        low = [{"kind": "low_battery", "charge": 0.202}, {"kind": "worn_battery", "capacity": 0.1}]
        whole, again = self.cut_where(
            yard, tmp_path, self.LOW, low, lambda e: e.charge > charge and e.t > 5
        )
        assert again.result.success
        kinds = [EventKind.LOW_BATTERY, EventKind.BATTERY_CHARGED]
        assert [a.kind for a in again.anomalies] == kinds
        assert again.result.duration == pytest.approx(whole.result.duration, abs=2.0)

    @pytest.mark.parametrize("cut", [5.0, 11.9, 12.1])
    def test_the_connection_is_back_before_or_after(self, yard, tmp_path, cut):
        loss = [{"kind": "connection_loss", "at": 2, "until": 12}]
        whole, again = self.cut_where(yard, tmp_path, LOST, loss, lambda e: e.t >= cut)
        kinds = [EventKind.CONNECTION_LOST, EventKind.CONNECTION_RESTORED]
        assert [a.kind for a in again.anomalies] == kinds
        assert again.result.success
        assert again.result.duration == pytest.approx(whole.result.duration, abs=2.0)

    def test_lost_once_more_right_after(self, yard, tmp_path):
        losses = [
            {"kind": "connection_loss", "at": 1, "until": 4},
            {"kind": "connection_loss", "at": 7, "until": 12},
        ]
        _, again = self.cut_where(yard, tmp_path, LOST, losses, lambda e: e.t >= 6)
        kinds = [EventKind.CONNECTION_LOST, EventKind.CONNECTION_RESTORED]
        assert [a.kind for a in again.anomalies] == 2 * kinds

    def test_a_stop_right_after_is_another_one(self, yard, tmp_path):
        stops = [
            {"kind": "emergency_stop", "at": 1, "until": 9},
            {"kind": "emergency_stop", "at": 10.1, "until": 16},
        ]
        whole, again = self.cut_where(yard, tmp_path, LOST, stops, lambda e: e.t >= 10)
        assert [a.t for a in again.anomalies] == [a.t for a in whole.anomalies] == [1.0, 10.1]


@pytest.mark.physics
class TestStandingStill:
    def run(self, yard, *faults, more=(), **fields):
        plan = mission(waypoint("A", 5.05, 2.55), *more, **fields)
        return simulated(plan, yard, faults=faults_of(*faults))

    def test_a_robot_that_waits_is_given_time_for_what_faults_lead_to(self, yard):
        lost = {"kind": "connection_loss", "at": 2}
        assert self.run(yard, lost | {"until": 200}, reactions=(LOST,)).result.success
        record = self.run(yard, lost, reactions=(LOST,))
        assert not record.result.success
        assert "nothing more occurs" in record.result.verdict
        assert record.result.duration == pytest.approx(record.anomalies[0].t + SETTLING, abs=0.2)

    def test_held_by_the_emergency_stop(self, yard):
        record = self.run(yard, {"kind": "emergency_stop", "at": 3})
        assert "held by its emergency stop" in record.result.verdict
        held = [s for s in record.path if s.t >= 3]
        assert len({(s.x, s.y) for s in held}) == 1
        assert math.dist((held[0].x, held[0].y), (record.path[0].x, record.path[0].y)) > 0.1

    def test_an_empty_battery_ends_the_run(self, yard):
        low = {"kind": "low_battery", "charge": 0.01}
        worn = {"kind": "worn_battery", "capacity": 0.04}
        record = self.run(yard, low, worn, more=[waypoint("B", 1.55, 1.55)])
        assert "the battery was empty" in record.result.verdict
        assert record.path[-1].charge == 0.0
        assert record.anomalies[0].kind is EventKind.LOW_BATTERY
        assert record.result.duration < 15

    def test_a_drive_that_stops_fails_the_task(self, yard):
        record = self.run(yard, {"kind": "drive_dysfunction", "at": 3, "speed": 0})
        assert [a.kind for a in record.anomalies] == [EventKind.DYSFUNCTION]
        assert "has not moved for 30 s" in record.tasks[0].reason


def test_a_schedule_begins_and_ends_in_order():
    told = []

    class Loud:
        def __init__(self, name, begins, ends):
            self.name, self.start_time, self.end_time = name, begins, ends

        def apply(self, _, now):
            told.append((now, self.name, "begins"))

        def revert(self, _, now):
            told.append((now, self.name, "ends"))

    schedule = FaultSchedule((Loud("a", 1.0, 3.0), Loud("b", 3.0, None), Loud("c", 0.0, 1.0)), None)
    for now in (0.0, 0.5, 2.0):
        schedule.advance(now)
    assert told == [(0.0, "c", "begins"), (1.0, "c", "ends"), (1.0, "a", "begins")]
    assert schedule.has_changes_left
    schedule.advance(99.0)
    assert told[3:] == [(3.0, "a", "ends"), (3.0, "b", "begins")]
    assert not schedule.has_changes_left
    assert schedule.latest_change_time_or_zero == 3.0
