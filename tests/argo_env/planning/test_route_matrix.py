"""Travel times between a mission's tasks, compared with those of runs."""

import numpy as np
import pytest

import argo_env.planning.route_matrix as route_matrix
from argo_compiler.base.errors import ArgoError
from argo_compiler.base.model import Pose
from argo_compiler.il import Order
from argo_compiler.reorder.requirements import Requirements
from argo_compiler.reorder.rewriting import apply_route
from argo_compiler.route import Tour, evaluate
from argo_env.navigation import Navigator
from argo_env.planning.route_matrix import make_mission_problem, mission_travel
from argo_env.planning.travel import SiteTravel
from argo_env.run.record import Reordering
from tests.yard import (
    cut,
    fast_setup,
    measure,
    mission,
    resumed,
    run_with,
    simulated,
    waypoint,
)

STEP = 0.1  # s of the drive


def driven(changed, yard):
    """Return the duration of a mission's run, in s."""
    return run_with(changed, fast_setup(yard)).result.duration


def around(**fields):
    places = waypoint("A", 2, 2), waypoint("B", 5.5, 3.5), waypoint("C", 5.5, 1.5)
    return mission(*places, order=Order.ANY, **fields)


def test_ways_between_places_take_as_long_as_driven(yard):
    plain = around()
    slow = plain.model_copy(
        update={
            "tasks": tuple(t.model_copy(update={"velocity": 0.2}) for t in plain.tasks),
        }
    )
    for written in (plain, slow):
        planned = make_mission_problem(written, yard, Requirements())
        for order in ((0, 1, 2), (2, 0, 1), (1, 2, 0)):
            predicted = evaluate(planned.problem, Tour(order)).duration * planned.problem.unit
            changed = apply_route(planned, Tour(order))
            assert driven(changed, yard) == pytest.approx(predicted, abs=len(order) * STEP)


def test_a_mission_with_checkpoints_takes_about_as_long(yard):
    written = mission(measure(1), waypoint("A", 5.5, 2), measure(3), measure(2), order=Order.ANY)
    planned = make_mission_problem(written, yard, Requirements())
    for order in ((0, 1, 2, 3), (3, 2, 1, 0), (1, 3, 0, 2)):
        predicted = evaluate(planned.problem, Tour(order)).duration * planned.problem.unit
        assert driven(apply_route(planned, Tour(order)), yard) == pytest.approx(predicted, rel=0.1)


def test_many_places_are_reckoned_over_the_lattice(yard, monkeypatch):
    written = mission(measure(1), waypoint("A", 5.5, 2, velocity=0.2), measure(3))
    exact = mission_travel(written, yard, SiteTravel(yard))
    monkeypatch.setattr(route_matrix, "MOST_PLANNED", 2)
    monkeypatch.setattr(route_matrix, "NEAREST", 1)
    rough = mission_travel(written, yard, SiteTravel(yard))
    assert np.array_equal(rough.work, exact.work)
    assert np.array_equal(
        rough.time[:, 1], exact.time[:, 1]
    )  # a path with a velocity of its own is planned
    away = ~np.eye(4, 3, dtype=bool)
    assert np.abs(rough.time - exact.time)[away].sum() <= 0.2 * exact.time[away].sum()
    assert (rough.energy >= exact.energy - 1e-9)[2:][away[2:]].all()


def test_a_small_battery_brings_in_the_docking_stations(yard):
    weak = Navigator(yard.site, yard.robot.model_copy(update={"battery": 1.5}))
    planned = make_mission_problem(around(), weak, Requirements())
    assert planned.problem.chargers == ("docking station 1",)
    assert planned.problem.battery is not None
    assert make_mission_problem(around(), yard, Requirements()).problem.battery is None


def test_a_task_that_can_not_be_carried_out_is_named(yard):
    written = mission(measure(1), waypoint("far", 60, 60), measure(3))
    with pytest.raises(ArgoError, match="can't carry out task 'far'"):
        make_mission_problem(written, yard, Requirements())


def test_an_area_is_where_a_mission_without_a_pose_starts(yard):
    travel = SiteTravel(yard)
    written = mission(measure(1), measure(3))
    start = written.tasks[0].model_copy(update={"pose": None})
    docked = written.model_copy(update={"tasks": (start, *written.tasks[1:]), "start_area": 1})
    assert travel.start_pose(docked) == yard.snap_keeping_heading(Pose(x=1.05, y=1.05, z=0.0))
    assert (mission_travel(docked, yard, travel).time < np.inf).all()


def test_a_resumed_run_still_says_in_what_order_it_is(yard, tmp_path):
    said = Reordering(
        written=("A", "B"), order=("B", "A"), written_duration=90.0, duration=80.0, bound=80.0,
        proven=True,
    )  # fmt: skip
    written = mission(waypoint("B", 5.5, 3.5), waypoint("A", 2, 2))
    place = tmp_path / "run.journal"
    whole = simulated(written, yard, drive="route", journal=place, reordering=said)
    assert whole.reordering == said
    cut(place)
    assert resumed(place, yard).reordering == said
