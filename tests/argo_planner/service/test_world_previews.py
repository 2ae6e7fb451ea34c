"""Previews agree with the drive without forces, with and without obstacles."""

import math
from itertools import pairwise

import numpy as np
import pytest

from argo_compiler.base.errors import Conflict, NotFound
from argo_compiler.base.model import Pose
from argo_compiler.il import Condition, ConditionType, Group, Mission, TimeWindow, Transition
from argo_env.planning.opening import OpenedSite
from argo_env.run.journal import open_journal
from argo_env.run.session import resume, simulate
from argo_env.run.spec import RunSpec
from argo_planner.service.world.description import describe_world, world_digest
from argo_planner.service.world.obstacles import with_obstacles
from argo_planner.service.world.previews import WayKind, preview_mission, preview_path
from tests.argo_planner.service.test_world_standing import crate
from tests.mission_writing import drive as waypoint
from tests.mission_writing import measure as measuring
from tests.mission_writing import start as starting
from tests.mission_writing import wait
from tests.yard import in_order


def chain(*tasks, **fields):
    return Mission(site="umad", start_area=1, tasks=in_order(*tasks), **fields)


def measure(id, *ways, **fields):
    return measuring(f"M{id}", *ways, object_id=str(id), **fields)


def random_tasks(site, rng, count):
    for k in range(count):
        velocity = float(rng.choice([0.1, 0.3])) if rng.random() < 0.3 else None
        if rng.random() < 0.5:
            chosen = site.site.checkpoints[int(rng.integers(len(site.site.checkpoints)))]
            yield measure(chosen.id, velocity=velocity).model_copy(update={"name": f"T{k}"})
        else:
            places = site.navigator.turning_poses(int(rng.integers(1, 4)))
            x, y, z, _ = places[int(rng.integers(len(places)))].tolist()
            pose = Pose(x=x, y=y, z=z, yaw=float(rng.uniform(-3, 3)))
            yield waypoint(f"T{k}", pose=pose, velocity=velocity)


def simulate_mission(site, mission, drive="route"):
    spec = RunSpec(mission=mission, site=site.reference, drive=drive, seed=1)
    return simulate(spec, site)


@pytest.mark.parametrize("seed", range(3))
def test_previewed_times_are_those_of_the_drive(site, seed):
    mission = chain(*random_tasks(site, np.random.default_rng(seed), 8))
    seen, record = preview_mission(site, mission), simulate_mission(site, mission)
    assert not seen.at_least
    assert [way.target for way in seen.ways] == [run.task for run in record.tasks]
    for way, run in zip(seen.ways, record.tasks, strict=True):
        assert run.outcome == "done"
        assert run.end - run.start == pytest.approx(way.way.time, abs=0.01)
        assert run.distance == pytest.approx(way.way.distance, abs=0.01)
        assert run.climbed == pytest.approx(way.way.climb, abs=0.01)
    assert seen.time == pytest.approx(record.tasks[-1].end, abs=0.1)


def test_a_path_is_drawn_from_the_start_of_the_robot_to_its_end(site):
    dock = site.site.docks[1]
    way = preview_path(site, dock, measure(20))
    assert math.dist(way.points[0][1:4], (dock.x, dock.y, dock.z)) < 0.3
    assert way.points[-1][1:4] == pytest.approx((way.end.x, way.end.y, way.end.z), abs=1e-3)
    assert all(a[0] <= b[0] for a, b in pairwise(way.points))
    length = sum(math.dist(a[1:4], b[1:4]) for a, b in pairwise(way.points))
    assert length == pytest.approx(way.distance, abs=0.01)
    assert way.points[-1][0] + way.work == pytest.approx(way.time, abs=0.11)
    assert preview_path(site, dock, way.end).work == 0


def test_an_unreachable_pose_is_reported_with_a_reason(site):
    nowhere = Pose(x=100, y=0, z=0)
    way = preview_path(site, site.site.docks[1], nowhere)
    assert way.time is None
    assert "no place that the robot can reach" in way.problem
    seen = preview_mission(site, chain(waypoint("far", pose=nowhere), measure(1)))
    assert seen.problems == (f"task 'far': {way.problem}",)
    assert seen.at_least == ("there is no path to task 'far'",)
    assert seen.ways[1].way.time > 0


def test_branches_rounds_and_waits_are_distinguished(site):
    hot = Condition(type=ConditionType.ABNORMAL, object_id="1")
    tasks = (
        measure(1, Transition(target="M3", conditions=(hot,)), "M2"),
        measure(2, "rest"),
        wait("rest", duration=30.0),
        measure(3, "M4"),
        measure(4, window=TimeWindow(earliest=10.0)),
    )
    groups = (Group(name="round", start="M1", end="M2", max_repeat_count=3),)
    seen = preview_mission(site, Mission(site="umad", tasks=tasks, groups=groups))
    kinds = {(w.source, w.target): w.kind for w in seen.ways}
    assert kinds == {
        (None, "M1"): WayKind.DEFAULT,
        ("M1", "M2"): WayKind.DEFAULT,
        ("M2", "rest"): WayKind.DEFAULT,
        ("M1", "M3"): WayKind.BRANCH,
        ("M2", "M1"): WayKind.ROUND,
        ("M3", "M4"): WayKind.OTHER,
    }
    assert not seen.at_least
    assert seen.time == pytest.approx(sum(w.way.time for w in seen.ways[:3]) + 30, abs=0.01)
    back = preview_path(site, seen.ways[1].way.end, tasks[0])
    assert back == next(w.way for w in seen.ways if w.kind is WayKind.ROUND)


def test_totals_state_which_times_are_unknown(site):
    waiting = wait("wait", "M1", event="all_clear", limit=60.0)
    late = measure(1, "wait", window=TimeWindow(earliest=500.0))
    seen = preview_mission(site, Mission(site="umad", tasks=(late, waiting)))
    assert len(seen.at_least) == 3
    assert preview_mission(site, Mission(site="umad")).ways == ()
    broken = measure(1, "gone")
    with pytest.raises(NotFound, match="no task 'gone'"):
        preview_mission(site, Mission(site="umad", tasks=(broken,)))


@pytest.mark.physics
def test_previews_and_runs_avoid_an_obstacle_alike(site):
    start, goal = Pose(x=4.0, y=1.5, z=0.0), Pose(x=4.0, y=10.0, z=0.0, yaw=1.57)
    free = preview_path(site, start, goal)
    middle = next(p for p in free.points if p[0] > free.time / 2)
    before = free.points[free.points.index(middle) - 1]
    x, y = ((a + b) / 2 for a, b in zip(before[1:3], middle[1:3], strict=True))
    crates = (crate("a", x, y, 0.0, (0.4, 0.4, 0.8), 0.3),)
    round_it = preview_path(site, start, goal, crates)
    assert round_it.time > free.time
    tasks = starting("START", pose=start), waypoint("there", pose=goal)
    mission, changed_site = chain(*tasks), with_obstacles(site, crates)
    seen = preview_mission(site, mission, crates)
    for drive in ("route", "kinematic"):
        record = simulate_mission(changed_site, mission, drive)
        (run,) = record.tasks
        assert run.outcome == "done"
        assert run.end - run.start == pytest.approx(seen.ways[0].way.time, abs=0.1)
        assert not record.contacts
        assert not record.anomalies
    # Without the obstacle in the plan the robot touches it.
    unaware = OpenedSite.from_navigator(site.navigator.with_added_blockages((), changed_site.site))
    touched = simulate_mission(unaware, mission, "kinematic").contacts
    assert {contact.element for contact in touched} == {"obstacle a"}


def test_checkpoints_behind_obstacles_are_reported(site):
    whole = describe_world(site)
    assert all(c.problem is None and c.stands is not None for c in whole.checkpoints)
    feet = (
        (tower.name, min((flight.foot for flight in tower.flights), key=lambda foot: foot[2]))
        for tower in site.site.spec.towers
    )
    wall = tuple(crate(f"{name} 1", x, y, 0.0, (2.5, 2.5, 2.0), 0.0) for name, (x, y, _) in feet)
    description = describe_world(site, wall)
    assert description.obstacles == wall
    assert description.digest == world_digest(site, wall) != whole.digest
    for before, after in zip(whole.checkpoints, description.checkpoints, strict=True):
        if before.floor > 1:
            assert after.stands is None
            assert "can't be" in after.problem or "no path" in after.problem
            way = preview_path(site, site.site.docks[1], measure(before.id), wall)
            assert way.problem
    assert any(c.stands for c in description.checkpoints if c.floor == 1)


def test_the_description_agrees_with_the_site(site):
    description = describe_world(site)
    assert description.model_validate_json(description.model_dump_json()) == description
    assert [f.number for f in description.floors] == [1, 2, 3, 4, 5, 6]
    for floor in description.floors:
        x0, y0, x1, y1 = floor.bounds
        area = sum((p[2] - p[0]) * (p[3] - p[1]) for p in floor.plates)
        assert 0 < area <= (x1 - x0) * (y1 - y0) + 1e-6
    for checkpoint in description.checkpoints:
        away = math.dist(checkpoint.position[:2], (checkpoint.stands.x, checkpoint.stands.y))
        assert away < site.robot.sensor.max_range + 1.0
        assert site.site.floor_at(checkpoint.stands.z) == checkpoint.floor


def test_a_run_is_resumed_only_with_the_same_obstacles(site, tmp_path):
    place = site.navigator.turning_poses(1)[5].tolist()
    one, other = (
        with_obstacles(site, (crate("a", *place[:3], (0.4, 0.4, high)),)) for high in (0.8, 0.9)
    )
    mission, journal = chain(measure(1)), tmp_path / "run.journal"
    spec = RunSpec(mission=mission, site=site.reference, drive="route")
    simulate(spec, one, journal=journal, interrupted=lambda: True)
    for changed in (site, other):
        with open_journal(journal) as book, pytest.raises(Conflict, match="alterations"):
            resume(book, changed)
    with open_journal(journal) as book:
        assert resume(book, one).result.success
