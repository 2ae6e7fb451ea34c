"""Travel times for the analysis, compared with those of the simulated robot."""

import pytest

from argo_compiler.analysis import Leg, NoPath, analyse, unproved_bounds
from argo_compiler.base.model import Pose
from argo_compiler.il import Action, Mission, Task
from argo_env.planning.travel import SiteTravel
from tests.yard import in_order, measure, simulated

STEP = 0.1  # s of the drive, within which a sum of times may be rounded differently


@pytest.fixture(scope="module")
def travel(navigator):
    return SiteTravel(navigator)


def test_mission_1_takes_as_long_as_planned(shipped, catalog, travel, sheet_run):
    record, _ = sheet_run
    mission = shipped("mission_1.txt", start_area=1, end_area=2).mission
    found = analyse(mission, catalog, travel)
    assert found.diagnostics == ()
    assert found.duration.least == found.duration.most
    assert found.duration.least.value == pytest.approx(record.result.duration, abs=STEP)
    ends = {stretch.task: stretch.until for stretch in found.duration.least.path}
    assert ends == {t.task: pytest.approx(t.end, abs=STEP) for t in record.tasks}


@pytest.mark.long
def test_protocol_2_lies_between_the_bounds(shipped, catalog, travel, protocol_record):
    found = analyse(shipped("protocol_2.txt").mission, catalog, travel)
    simulated = protocol_record.result.duration
    assert found.duration.least.value <= simulated + STEP
    assert simulated <= found.duration.most.value + STEP
    # A hard stop leaves open where the robot is, and nothing else.
    assert found.duration.most.value - found.duration.least.value < 0.15 * simulated


@pytest.mark.parametrize(
    ("sheet", "areas"),
    [("mission_1.txt", {"start_area": 1, "end_area": 2}), ("protocol_2.txt", {})],
)
def test_what_the_sheets_take_at_least_is_shown(shipped, catalog, travel, sheet, areas):
    mission = shipped(sheet, **areas).mission
    hurried = mission.model_copy(update={"max_duration": 60.0, "reactions": ()})
    found = analyse(hurried, catalog, travel)
    assert "analysis.too-long" in {d.code for d in found.diagnostics}
    assert unproved_bounds(hurried, catalog, travel, found) == ()
    assert found.witnesses.least.time.end == pytest.approx(found.duration.least.value)


@pytest.mark.physics
def test_velocities_count_for_the_way_to_the_task(navigator, catalog, travel):
    start = Task(name="S", action=Action.START)
    tasks = in_order(start, measure(1, velocity=0.2), measure(4, velocity=0.8))
    mission = Mission(tasks=tasks, start_area=1)
    found = analyse(mission, catalog, travel)
    record = simulated(mission, navigator)
    assert found.duration.most.value == pytest.approx(record.result.duration, abs=STEP)


def test_ways_that_do_not_exist_say_why(travel):
    start = travel.start_pose(Mission(tasks=(measure(1),)))
    far = Task(name="far", action=Action.WAYPOINT, pose=Pose(x=500, y=0, z=0))
    away = travel.leg_with_action(start, far, None)
    assert isinstance(away, NoPath)
    assert "(500.00, 0.00, 0.00)" in away.reason
    unknown = travel.leg_with_action(start, measure(9999), None)
    assert isinstance(unknown, NoPath)
    assert "9999" in unknown.reason


def test_energy_follows_from_times_and_powers(navigator, travel):
    robot = navigator.robot
    start = travel.start_pose(Mission(tasks=(measure(1),)))
    leg = travel.leg_with_action(start, measure(8), None)
    assert isinstance(leg, Leg)
    assert leg.work == pytest.approx(robot.sensor.measuring_time)
    powers = robot.power.model_dump().values()
    watts = (leg.energy - leg.work_energy) * 3600 / (leg.duration - leg.work)
    assert min(powers) < watts < max(powers)
    assert leg.work_energy * 3600 / leg.work == pytest.approx(robot.power.measuring)
    assert 500 <= travel.battery <= 1000
