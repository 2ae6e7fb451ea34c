"""The tracked drive: flights, landings, halts, and recovery when it can't continue."""

import math
from itertools import pairwise

import pytest

from argo_compiler.base.model import Pose
from argo_env.drives.drive import DriveStatus, Trouble
from argo_env.drives.tracked.drive import WINDOW, StallDetector, TrackedDrive
from argo_env.navigation.path import Motion, Path, wrap
from argo_env.robot.pose import BodyPose
from benchmarks.tracked import plan_stair_path
from tests.argo_env.drives.test_route import level
from tests.yard import simulated

pytestmark = pytest.mark.physics


def at(x, y, z, degrees=0.0):
    return Pose(x=x, y=y, z=z, yaw=math.radians(degrees))


def straight(a, length, gear=1):
    end = a.model_copy(
        update={
            "x": a.x + gear * length * math.cos(a.yaw),
            "y": a.y + gear * length * math.sin(a.yaw),
        }
    )
    return Path(a, (Motion(a, end, gear=gear),))


def follow(drive, path, velocity=None, most=2000, start=None, world=None, touched=None):
    """Follow the path; return the last status and the poses at the start and after each step."""
    drive.place_robot(start or level(path.start))
    drive.follow(path, velocity)
    status, poses = DriveStatus.MOVING, [drive.pose]
    while status is DriveStatus.MOVING:
        assert len(poses) < most
        status = drive.step()
        poses.append(drive.pose)
        if world is not None:
            touched |= {t.element for t in world.touches()}
    return status, poses


@pytest.mark.parametrize(
    ("tower", "up"),
    [
        ("west", True),
        pytest.param("east", False, marks=pytest.mark.long),
        pytest.param("west", False, marks=pytest.mark.long),
        pytest.param("east", True, marks=pytest.mark.long),
    ],
)
def test_takes_a_storey_of_each_tower(drive, ground, navigator, robot, tower, up):
    """The west tower has one long flight, the east tower two and a landing with a turn."""
    path = plan_stair_path(navigator, f"{tower} tower", 2, up)
    start = path.start
    begun = BodyPose(start.x + 0.03, start.y - 0.03, start.z, start.yaw + math.radians(4))
    touched = set()
    status, poses = follow(drive, path, start=begun, world=ground, touched=touched)
    assert (status, drive.failure) == (DriveStatus.ARRIVED, None)
    assert not [i for i in drive.incidents if i.trouble is not Trouble.SLIPPING]
    end, pose = path.end, drive.pose
    assert math.dist((pose.x, pose.y, pose.z), (end.x, end.y, end.z)) <= 0.05
    assert abs(wrap(pose.yaw - end.yaw)) <= math.radians(3)
    assert touched <= {"east tower 3-4 lower flight handrails"}
    pitches = [math.degrees(p.pitch) for p in poses]
    # The front is the lower end, both ways.
    assert max(pitches) == pytest.approx(34.0, abs=6.0)
    assert min(pitches) >= -4.0
    taken = (len(poses) - 1) * drive.time_step
    assert taken == pytest.approx(path.duration(robot), rel=0.25)


def test_keeps_the_velocity_of_the_plan(drive):
    path = straight(at(4.0, -2.05, -0.03), 3.0)
    _, slow = follow(drive, path, velocity=0.2)
    _, own = follow(drive, path)
    middle = slow[len(slow) // 2 - 10 : len(slow) // 2 + 10]
    assert math.dist((middle[0].x, 0), (middle[-1].x, 0)) / 1.9 == pytest.approx(0.2, rel=0.05)
    assert len(own) < 0.65 * len(slow)


def test_goes_back_to_its_line_from_beside_it(drive):
    path = straight(at(4.0, -2.05, -0.03), 3.0)
    start = BodyPose(4.0, -1.99, -0.03, math.radians(-6))
    status, poses = follow(drive, path, start=start)
    assert status is DriveStatus.ARRIVED
    assert poses[-1].y == pytest.approx(-2.05, abs=0.01)
    assert poses[-1].x == pytest.approx(7.0, abs=0.03)


@pytest.mark.parametrize("length", [0.1, 0.4])
def test_a_short_drive_from_beside_its_line_ends_as_the_path_is_turned(drive, length):
    path = straight(at(4.0, -2.05, -0.03), length)
    status, poses = follow(drive, path, start=BodyPose(4.0, -1.99, -0.03, math.radians(8)))
    assert status is DriveStatus.ARRIVED
    assert abs(poses[-1].yaw) <= math.radians(2)
    assert poses[-1].x == pytest.approx(4.0 + length, abs=0.03)


def test_turns_the_long_way_if_the_path_does(drive):
    a = at(5.0, -2.05, -0.03)
    b = a.model_copy(update={"yaw": math.radians(-100)})
    status, poses = follow(drive, Path(a, (Motion(a, b, turn=math.radians(260)),)))
    assert status is DriveStatus.ARRIVED
    assert any(abs(wrap(p.yaw - math.pi / 2)) < 0.1 for p in poses)
    assert wrap(poses[-1].yaw - b.yaw) == pytest.approx(0.0, abs=math.radians(3))


def test_arrives_without_motions(drive):
    here = at(5.0, -2.05, -0.03, 30)
    status, poses = follow(drive, Path(here, ()))
    assert status is DriveStatus.ARRIVED
    assert len(poses) <= 3


@pytest.mark.parametrize("seconds", [1.0, 3.0])
def test_halt_brakes_then_says_arrived(drive, seconds):
    path = straight(at(4.0, -2.05, -0.03), 4.0)
    drive.place_robot(level(path.start))
    drive.follow(path, None)
    for _ in range(round(seconds / drive.time_step)):
        assert drive.step() is DriveStatus.MOVING
    before = drive.pose
    drive.halt()
    assert drive.step() is DriveStatus.MOVING
    steps = 1
    while drive.step() is DriveStatus.MOVING:
        steps += 1
        assert steps < 30
    rest = drive.pose
    assert 0.0 < rest.x - before.x <= 0.15
    assert drive.step() is DriveStatus.ARRIVED
    assert math.dist((rest.x, rest.y), (drive.pose.x, drive.pose.y)) < 1e-3


@pytest.mark.long
def test_halts_on_a_flight_and_goes_on(drive, navigator):
    path = navigator.plan(at(1.9, 2.8, 2.5), at(1.9, 7.95, 5.0))
    drive.place_robot(level(path.start))
    drive.follow(path, None)
    while drive.pose.z < 3.2:
        assert drive.step() is DriveStatus.MOVING
    drive.halt()
    while drive.step() is DriveStatus.MOVING:
        pass
    held = drive.pose
    for _ in range(50):
        assert drive.step() is DriveStatus.ARRIVED
    assert math.dist((held.x, held.y, held.z), (drive.pose.x, drive.pose.y, drive.pose.z)) < 0.005
    here = drive.pose
    on = navigator.plan(Pose(x=here.x, y=here.y, z=here.z, yaw=here.yaw), path.end)
    drive.follow(on, None)
    while (status := drive.step()) is DriveStatus.MOVING:
        pass
    assert status is DriveStatus.ARRIVED
    assert math.dist((drive.pose.x, drive.pose.y), (path.end.x, path.end.y)) <= 0.05


def test_a_wall_on_the_path_is_reported_after_recovery_was_tried(drive):
    path = straight(at(1.9, 7.7, 0.0), 2.3)
    status, poses = follow(drive, path)
    assert status is DriveStatus.FAILED
    assert "stuck at" in drive.failure
    assert "contactor V-101" in drive.failure
    assert [i.trouble for i in drive.incidents].count(Trouble.STUCK) >= 1
    ahead = [p.x for p in poses]
    backwards = sum(max(0.0, a - b) for a, b in pairwise(ahead))
    assert backwards >= 0.4, "it has backed off more than once"
    assert max(abs(p.pitch) for p in poses) <= math.radians(20)
    drive.halt()
    while drive.step() is DriveStatus.MOVING:
        pass
    away = straight(at(drive.pose.x, drive.pose.y, 0.0), 0.4, gear=-1)
    drive.follow(away, None)
    assert drive.failure is None
    while (status := drive.step()) is DriveStatus.MOVING:
        pass
    assert status is DriveStatus.ARRIVED


def test_being_stuck_is_noticed_within_the_window(drive):
    drive.place_robot(BodyPose(1.9, 7.7, 0.0, 0.0))
    drive.follow(straight(at(1.9, 7.7, 0.0), 2.3), None)
    farthest, standing = -math.inf, 0.0
    while not drive.incidents:
        assert drive.step() is DriveStatus.MOVING
        standing = 0.0 if drive.pose.x > farthest + 0.01 else standing + drive.time_step
        farthest = max(farthest, drive.pose.x)
    assert 0.4 * WINDOW <= standing <= WINDOW


def test_tipping_over_is_reported(drive):
    drive.place_robot(BodyPose(5.0, -2.05, 0.6, 0.0, math.radians(75)))
    drive.follow(straight(at(5.0, -2.05, -0.03), 2.0), None)
    status = DriveStatus.MOVING
    for _ in range(50):
        status = drive.step()
        if status is not DriveStatus.MOVING:
            break
    assert status is DriveStatus.FAILED
    assert "tipped over" in drive.failure
    assert drive.incidents[-1].trouble is Trouble.TIPPED


def last_fault(detector, speeds, moved, rate=0.0, turned=0.0):
    """Return the last fault that the detector reports after longer than its window."""
    incident, x, yaw = None, 0.0, 0.0
    for _ in range(round((WINDOW + 1.0) / 0.05)):
        x, yaw = x + 0.05 * moved, yaw + 0.05 * turned
        incident = detector.update(BodyPose(x, 0.0, 0.0, yaw), 0.0, speeds, rate)
    return incident and incident.trouble


@pytest.mark.parametrize(
    ("commanded", "went", "trouble"),
    [
        (0.2, 0.19, None),
        (0.2, 0.07, Trouble.SLIPPING),
        (0.2, 0.01, Trouble.STUCK),
        (-0.2, -0.01, Trouble.STUCK),
        (0.0, 0.0, None),
    ],
)
def test_detector_compares_distances(commanded, went, trouble):
    assert last_fault(StallDetector(0.05), commanded, went) is trouble


@pytest.mark.parametrize(
    ("turned", "trouble"), [(0.38, None), (0.1, Trouble.SLIPPING), (0.0, Trouble.STUCK)]
)
def test_detector_compares_turns(turned, trouble):
    assert last_fault(StallDetector(0.05), 0.0, 0.0, rate=0.4, turned=turned) is trouble


@pytest.mark.long
def test_twins_drive_the_same_bit_by_bit(drive, ground, robot, navigator):
    path = navigator.plan(at(12.3, 5.55, 2.5), at(12.3, 5.55, 5.0))
    twin = TrackedDrive(ground, robot)
    for each in (drive, twin):
        each.place_robot(level(path.start))
        each.follow(path, 0.3)
    for _ in range(250):
        assert drive.step() is twin.step()
        assert drive.pose == twin.pose
    twin.body.close()


@pytest.mark.long
def test_mission_1_is_carried_out_without_a_contact(shipped, navigator):
    mission = shipped("mission_1.txt", start_area=1, end_area=2).mission
    record = simulated(mission, navigator, seed=3, drive="tracked")
    assert record.drive == "tracked"
    assert record.result.success, record.result.verdict
    assert record.result.docked
    assert record.contacts == ()
