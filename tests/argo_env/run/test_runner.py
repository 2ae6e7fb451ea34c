"""Runs of missions on UMAD: settings of a run, its record, and the robot's motion."""

import math
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import argo_env.run.termination
from argo_compiler.base.errors import ArgoError, Invalid
from argo_compiler.base.model import Pose
from argo_compiler.il import Action, Group, Mission, Task
from argo_compiler.il.docked import is_at_dock
from argo_env.faults.walkway import Brick
from argo_env.navigation import Path
from argo_env.navigation.path import Motion
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import MotionKind
from argo_env.run.drives_and_sensors import drive_names
from argo_env.run.record import Anomaly, RunRecord
from argo_env.run.run_setup import true_values
from argo_env.run.simulation import SAMPLE_PERIOD
from tests.mission_writing import above, way
from tests.yard import Watching, from_place, in_order, measure, resumed, simulated

pytestmark = pytest.mark.physics

FRONT = Pose(x=8.05, y=-2.05, z=-0.03, yaw=0.0)


def start(pose=FRONT, **fields):
    return Task(name="START", action=Action.START, pose=pose, **fields)


def waypoint(name, x, y, z=-0.03, degrees=0.0, **fields):
    pose = Pose(x=x, y=y, z=z, yaw=math.radians(degrees))
    return Task(name=name, action=Action.WAYPOINT, pose=pose, **fields)


def mission(*tasks, **fields):
    return Mission(site="umad", tasks=in_order(*tasks), **fields)


def names(record):
    return [t.task for t in record.tasks]


class TestSheet:
    def test_succeeds_in_the_order_asked_for(self, sheet_run):
        record, _ = sheet_run
        assert record.result.success
        assert names(record) == ["MEASURE 1", "MEASURE 4", "MEASURE 8", "DOCK"]
        assert [r.checkpoint for r in record.readings] == [1, 4, 8]
        assert {t.outcome for t in record.tasks} == {"done"}

    def test_ends_docked_in_time_without_a_contact(self, sheet_run, umad):
        record, _ = sheet_run
        assert record.result.docked is True
        assert record.contacts == ()
        assert record.result.max_duration == 1200.0
        assert record.result.duration <= 1200.0
        first, last = record.path[0], record.path[-1]
        for sample, dock in ((first, umad.docks[1]), (last, umad.docks[2])):
            assert math.dist((sample.x, sample.y, sample.z), (dock.x, dock.y, dock.z)) <= 0.1
        assert last.t == record.result.duration

    def test_tasks_follow_each_other_without_a_gap(self, sheet_run):
        record, _ = sheet_run
        assert record.tasks[0].start == 0.0
        assert record.tasks[-1].end == record.result.duration
        assert all(a.end == b.start for a, b in pairwise(record.tasks))
        assert [step.t for step in record.trace] == sorted(step.t for step in record.trace)
        assert record.trace[-1].target is None

    def test_path_samples(self, sheet_run):
        record, _ = sheet_run
        times = [s.t for s in record.path]
        assert all(a < b for a, b in pairwise(times))
        assert max(b - a for a, b in pairwise(times)) <= SAMPLE_PERIOD + 1e-6
        assert all(-math.pi < s.yaw <= math.pi + 1e-4 for s in record.path)
        assert {s.floor for s in record.path} == {1, 2}
        for a, b in pairwise(record.path):
            if a.floor != b.floor:
                assert abs(a.pitch) > math.radians(5), "floors change on stairs"

    def test_climbed_and_driven(self, sheet_run):
        record, _ = sheet_run
        assert record.result.climbed == pytest.approx(2.5 + 0.03, abs=0.05)
        assert sum(t.climbed for t in record.tasks) == pytest.approx(
            record.result.climbed, abs=1e-3
        )
        assert sum(t.distance for t in record.tasks) == pytest.approx(
            record.result.distance, abs=1e-3
        )
        sampled = sum(math.dist((a.x, a.y, a.z), (b.x, b.y, b.z)) for a, b in pairwise(record.path))
        assert sampled == pytest.approx(record.result.distance, rel=0.02)

    def test_readings_are_true_and_in_range(self, sheet_run, robot):
        record, _ = sheet_run
        tasks = {t.task: t for t in record.tasks}
        for reading in record.readings:
            assert reading.normal
            assert robot.sensor.min_range <= reading.distance <= robot.sensor.max_range
            assert reading.t == tasks[reading.task].end

    def test_observer_is_told_every_step(self, sheet_run):
        record, seen = sheet_run
        times = [now for now, _ in seen]
        assert all(a <= b for a, b in pairwise(times))
        assert times[-1] == record.result.duration
        assert len(seen) == round(record.result.duration / 0.1)
        told = list(dict.fromkeys(task.name for _, task in seen if task))
        assert told == names(record)
        assert seen[-1][1] is None

    def test_record_goes_through_json(self, sheet_run):
        record, _ = sheet_run
        assert RunRecord.model_validate_json(record.model_dump_json()) == record


class TestProtocol:
    def test_rounds_until_the_time_is_up(self, protocol_record):
        tasks = protocol_record.tasks
        cut = next(k for k, t in enumerate(tasks) if t.outcome == "cancelled")
        order = [f"WAYPOINT {k}" for k in (1, 2, 3, 4)]
        assert names(protocol_record)[: cut + 1] == [order[k % 4] for k in range(cut + 1)]
        assert cut >= 8, "two rounds at least"
        # The machine leaves the round at 600 s; the robot is at rest a step later.
        assert tasks[cut].end == pytest.approx(600.1)
        assert {t.outcome for t in tasks[:cut] + tasks[cut + 1 :]} == {"done"}

    def test_then_measures(self, protocol_record):
        assert names(protocol_record)[-2:] == ["MEASURE 2", "MEASURE 14"]
        assert protocol_record.tasks[-2].start == pytest.approx(600.1)
        assert [r.checkpoint for r in protocol_record.readings] == [2, 14]

    def test_succeeds_without_a_contact(self, protocol_record):
        assert protocol_record.result.success
        assert protocol_record.result.docked is None
        assert protocol_record.contacts == ()

    def test_climbs_to_the_fourth_floor(self, protocol_record):
        assert protocol_record.result.climbed == pytest.approx(7.53, abs=0.15)
        floors = [s.floor for s in protocol_record.path]
        assert list(dict.fromkeys(floors)) == [1, 2, 3, 4]
        # On the flat a floor is at its height.
        for sample in protocol_record.path:
            if abs(sample.pitch) < 1e-3 and sample.t < 600:
                assert -0.04 <= sample.z <= 0.03

    def test_does_not_jump_when_the_round_is_left(self, protocol_record, robot):
        for a, b in pairwise(protocol_record.path):
            moved = math.dist((a.x, a.y), (b.x, b.y))
            # The new path begins in the cell where the old one was left.
            assert moved <= robot.speed * (b.t - a.t) + 0.08


@pytest.fixture(scope="module")
def short():
    return mission(start(), measure(1), start_area=1)


def test_same_seed_same_record(short, navigator):
    first, second = (simulated(short, navigator, seed=5) for _ in range(2))
    assert first.model_dump_json() == second.model_dump_json()
    other = simulated(short, navigator, seed=6)
    assert other.readings[0].value != first.readings[0].value
    assert other.path == first.path


@pytest.mark.parametrize(
    ("value", "branch", "normal"), [(4.8, "HIGH", True), (5.5, "HIGH", False), (4.0, "LOW", True)]
)
def test_branches_on_the_measured_value(navigator, value, branch, normal):
    asked = measure(1, transitions=(way("HIGH", above("1", 4.5)), way("LOW")))
    tasks = (start(Pose(x=6.05, y=1.55, z=0.0)), asked)
    ends = (waypoint("HIGH", 7.05, 1.55, 0.0), waypoint("LOW", 5.05, 1.55, 0.0))
    # The two ends do not lead to each other.
    joined = mission(*tasks, ends[0]).tasks[:2] + ends
    record = simulated(Mission(site="umad", tasks=joined), navigator, values={1: value})
    assert record.result.success
    assert names(record) == ["MEASURE 1", branch]
    assert record.readings[0].value == value
    assert record.readings[0].normal is normal


def test_unreachable_waypoint_fails_with_a_reason(navigator):
    record = simulated(
        mission(start(), waypoint("ROOF", 8.0, 6.0, 20.0), waypoint("BACK", 8.55, -2.05)), navigator
    )
    failed = record.tasks[0]
    assert (failed.task, failed.outcome) == ("ROOF", "failed")
    assert "no place that the robot can reach" in failed.reason
    assert "(8.00, 6.00, 20.00)" in failed.reason
    assert not record.result.success
    assert "failed: ROOF" in record.result.verdict


def test_unknown_checkpoint_fails_with_a_reason(navigator):
    record = simulated(mission(start(), measure(99)), navigator)
    assert record.tasks[0].outcome == "failed"
    assert record.tasks[0].reason == "site umad has no checkpoint 99"
    assert not record.result.success
    assert record.readings == ()


def test_measurement_that_is_not_possible_fails(navigator):
    class Dreamer(Stub):
        """Navigator for which every checkpoint can be read from the robot's pose."""

        def plan_to_view(self, start, *_):
            return Path(start, ())

    record = simulated(mission(start(), measure(1)), Dreamer(navigator))
    assert record.tasks[0].outcome == "failed"
    assert "pressure gauge 1 is" in record.tasks[0].reason
    # It arrives in the first step and then takes its time to look.
    assert record.result.duration == pytest.approx(0.1 + navigator.robot.sensor.measuring_time)


def test_start_that_can_not_be_reached(navigator):
    with pytest.raises(ArgoError, match="no place that the robot can reach"):
        simulated(mission(start(Pose(x=8.0, y=6.0, z=20.0)), measure(1)), navigator)


@pytest.mark.parametrize("areas", [{"start_area": 7}, {"start_area": 1, "end_area": 7}])
def test_area_that_the_site_does_not_have(navigator, areas):
    with pytest.raises(ArgoError, match="umad has no starting area 7; there are: 1, 2"):
        simulated(mission(waypoint("A", 8.05, -2.05), **areas), navigator)


@pytest.mark.rule("T6")
def test_velocity_is_that_of_the_way_to_the_task(navigator):
    record = simulated(
        mission(
            start(velocity=0.1),
            waypoint("A", 11.05, -2.05, velocity=0.2),
            waypoint("B", 14.05, -2.05, velocity=0.3),
            waypoint("C", 17.05, -2.05),
        ),
        navigator,
    )
    took = {t.task: t.end - t.start for t in record.tasks}
    speeds = {"A": 0.2, "B": 0.3, "C": navigator.robot.speed}
    for name, speed in speeds.items():
        planned = navigator.robot.motion_time(MotionKind.AHEAD, 3.0, speed)
        assert took[name] == pytest.approx(planned, abs=0.2)


def test_too_long_is_no_success(navigator):
    record = simulated(mission(start(), waypoint("A", 11.05, -2.05), max_duration=5.0), navigator)
    assert record.tasks[0].outcome == "done"
    assert not record.result.within_max_duration
    assert not record.result.success
    assert "of at most 5 s" in record.result.verdict


def test_not_docked_is_no_success(navigator):
    record = simulated(mission(start(), waypoint("A", 9.05, -2.05), end_area=1), navigator)
    assert record.result.docked is False
    assert not record.result.success
    assert "not docked in starting area 1" in record.result.verdict


def test_the_dock_of_another_area_is_named(navigator):
    other = navigator.site.docks[2]
    there = Task(name="A", action=Action.WAYPOINT, pose=other)
    record = simulated(mission(start(), there, end_area=1), navigator)
    assert record.result.docked is False
    assert record.result.verdict == "the robot is docked in starting area 2, not in 1"


def test_endless_round_is_stopped(navigator, monkeypatch):
    monkeypatch.setattr(argo_env.run.termination, "TIME_LIMIT", 30.0)
    there, back = waypoint("A", 9.05, -2.05), waypoint("B", 8.05, -2.05)
    group = Group(name="Round", start="A", end="B", max_repeat_duration=1e6)
    record = simulated(mission(start(), there, back, groups=(group,)), navigator)
    assert record.result.duration == pytest.approx(30.0)
    assert not record.result.success
    assert "stopped after 30 s, Argo's limit for a run" in record.result.verdict
    assert record.tasks[-1].outcome == "cancelled"
    assert record.tasks[-1].reason == "the run was stopped"


def test_round_that_is_counted(navigator):
    there, back = waypoint("A", 9.05, -2.05), waypoint("B", 8.05, -2.05)
    group = Group(name="Round", start="A", end="B", max_repeat_count=2)
    record = simulated(mission(start(), there, back, groups=(group,)), navigator)
    assert names(record) == ["A", "B", "A", "B"]
    assert record.result.success


class Stub:
    """Navigator of which a test replaces some methods."""

    def __init__(self, navigator):
        self._navigator = navigator

    def __getattr__(self, name):
        return getattr(self._navigator, name)


class Blind(Stub):
    """Navigator that plans a straight path, even through obstacles."""

    def plan(self, start, goal):
        return Path(start, (Motion(start, goal),))


THROUGH_THE_FENCE = (
    start(Pose(x=3.05, y=1.55, z=0.0, yaw=math.radians(-90))),
    waypoint("OUT", 3.05, -1.45, -0.03, -90),
)


def test_contacts_are_counted(navigator):
    """The robot drives through a fence at y = 0.1, 4 cm thick; its hull spans -0.39 to 0.35 m."""
    record = simulated(mission(*THROUGH_THE_FENCE), Blind(navigator))
    assert record.tasks[0].outcome == "done"
    assert {c.element for c in record.contacts} == {"floor 1 fence south-west"}
    assert [c.start for c in record.contacts] == sorted(c.start for c in record.contacts)
    y = record.path[0].y
    (hull,) = (c for c in record.contacts if c.link == "base_link")
    speed = 3.0 / navigator.robot.motion_time(MotionKind.AHEAD, 3.0)
    assert hull.start == pytest.approx((y - 0.35 - 0.12) / speed, abs=0.25)
    assert hull.end == pytest.approx((y + 0.39 - 0.08) / speed, abs=0.25)
    # Of two rails and posts it is as deep as half the height of what overlaps, or more.
    assert 0.02 <= hull.depth <= 0.4
    assert hull.x == pytest.approx(3.05, abs=0.4)
    assert hull.y == pytest.approx(0.1, abs=0.1)
    # The tracks reach further to the front and come later off at the rear.
    tracks = [c for c in record.contacts if c.link == "left_track"]
    assert min(c.start for c in tracks) < hull.start
    assert max(c.end for c in tracks) > hull.end
    assert all(a.end < b.start for a, b in pairwise(tracks))


def test_contacts_at_two_times_are_two(navigator):
    back = waypoint("IN", 3.05, 1.55, 0.0, -90)
    record = simulated(mission(*THROUGH_THE_FENCE, back), Blind(navigator))
    hull = [c for c in record.contacts if c.link == "base_link"]
    assert len(hull) == 2
    assert hull[0].end < hull[1].start


def test_docked_within_a_tolerance(umad):
    dock = umad.docks[1]
    assert is_at_dock(BodyPose(dock.x, dock.y, dock.z, dock.yaw - 2 * math.pi), umad.docks[1])
    assert is_at_dock(BodyPose(dock.x + 0.09, dock.y, dock.z, dock.yaw), umad.docks[1])
    assert not is_at_dock(BodyPose(dock.x + 0.11, dock.y, dock.z, dock.yaw), umad.docks[1])
    assert not is_at_dock(BodyPose(dock.x, dock.y, dock.z, dock.yaw + 0.1), umad.docks[1])
    assert not is_at_dock(BodyPose(dock.x, dock.y, dock.z, dock.yaw), umad.docks[2])


@settings(max_examples=3, deadline=None)
@given(st.lists(st.integers(1, 8), min_size=1, max_size=3, unique=True))
def test_any_order_of_checkpoints_succeeds(navigator, ids):
    record = simulated(mission(*(measure(id) for id in ids), start_area=1), navigator)
    assert record.result.success
    assert [r.checkpoint for r in record.readings] == ids
    assert record.contacts == ()
    assert max(abs(s.pitch) for s in record.path) <= math.radians(36)


@pytest.fixture(scope="module")
def two_places():
    here, there = Pose(x=8.05, y=-2.05, z=-0.03), Pose(x=8.55, y=-2.05, z=-0.03)
    return from_place(here, Task(name="A", action=Action.WAYPOINT, pose=there))


def test_record_says_what_it_was_made_with(two_places, navigator):
    record = simulated(two_places, navigator, seed=11)
    assert (record.site, record.robot) == ("umad", "tracker")
    assert (record.drive, record.sensor) == ("kinematic", "ideal")
    assert record.seed == 11
    assert record.mission == two_places


def test_unknown_drive(two_places, navigator):
    with pytest.raises(ArgoError, match="no drive `rocket`; there are: route, kinematic, tracked"):
        simulated(two_places, navigator, drive="rocket")
    assert set(drive_names()) >= {"kinematic"}


def test_unknown_sensor(two_places, navigator):
    with pytest.raises(ArgoError, match="no sensor `nose`; there are: ideal"):
        simulated(two_places, navigator, sensor="nose")


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({99: 1.0}, "umad has no checkpoint 99"),
        ({1: 10.1}, r"checkpoint 1 \(pressure gauge 1\) shows 0 to 10 bar, not 10.1"),
        ({4: -0.1}, "shows 0 to 90 deg, not -0.1"),
    ],
)
def test_values_that_make_no_sense(two_places, navigator, values, message):
    with pytest.raises(ArgoError, match=message):
        simulated(two_places, navigator, values=values)


def test_given_values_replace_drawn_ones(umad):
    drawn, given = true_values(umad, 5, {}), true_values(umad, 5, {1: 0.0, 2: 100.0})
    assert given == drawn | {1: 0.0, 2: 100.0}


def test_window_without_a_display(two_places, navigator, monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    with pytest.raises(ArgoError, match="DISPLAY"):
        simulated(two_places, navigator, gui=True)


@pytest.mark.parametrize("pace", [0.0, -1.0, float("nan")])
def test_a_pace_that_makes_no_sense(two_places, navigator, pace):
    with pytest.raises(Invalid, match="more than 0"):
        simulated(two_places, navigator, pace=pace)


def test_pace_changes_nothing_but_the_time_it_takes(two_places, navigator):
    seen = []
    paced = simulated(
        two_places,
        navigator,
        pace=1000.0,
        observers=[Watching(lambda now, task: seen.append((now, task)))],
    )
    assert paced == simulated(two_places, navigator)
    assert seen[-1] == (paced.result.duration, None)


BRICK = Brick(floor=2, place=(12.2958, 5.05), yaw=22.05)
"""on the walkway behind the east tower: before it the robot has no room to turn"""


class KilledError(Exception):
    """Error that ends the process of a run."""


@pytest.mark.long
def test_goes_back_along_the_way_that_it_came(navigator, tmp_path):
    plan = from_place(navigator.site.docks[1], measure(15))
    place = tmp_path / "run.journal"

    def die(news):
        if isinstance(news, Anomaly):
            raise KilledError

    with pytest.raises(KilledError):
        simulated(
            plan,
            navigator,
            seed=11,
            faults=(BRICK,),
            journal=place,
            observers=[Watching(announce=die)],
        )
    record = resumed(place, navigator)
    (found,) = record.anomalies
    assert record.resumed == (found.t,)
    assert record.result.success
    assert record.contacts == ()
    here, *after = [s for s in record.path if found.t <= s.t <= found.t + 5]
    straight = [s for s in after if abs(s.yaw - here.yaw) < 0.01]
    back = max((math.dist((s.x, s.y), (here.x, here.y)), s) for s in straight)[1]
    ahead = (back.x - here.x) * math.cos(here.yaw) + (back.y - here.y) * math.sin(here.yaw)
    assert ahead < -0.2
