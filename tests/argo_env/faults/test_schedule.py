"""Faults that overlap: each lasts until its own end, whatever else ends before."""

import pytest

from argo_env.drives.battery import Battery
from argo_env.drives.powertrain import Powertrain
from argo_env.drives.route import RouteDrive
from argo_env.faults.kinds import settle
from argo_env.faults.schedule import Schedule
from argo_env.faults.targets import FaultTargets
from argo_env.robot.pose import BodyPose
from argo_env.sensing.ideal import IdealSensor
from argo_env.sensing.onboard_sensor import OnboardSensor
from argo_env.surroundings import Surroundings
from argo_env.surroundings.network import RadioNetwork
from argo_env.world.paper_world import PaperWorld
from tests.yard import faults_of

POSE = BodyPose(5.0, 2.5, 0.0, 0.0)


@pytest.fixture
def stage(umad, robot):
    world, truth = PaperWorld(umad, robot), {c.id: 0.0 for c in umad.checkpoints}
    sensor = OnboardSensor(IdealSensor(world, robot, truth), umad, 0)
    drive = Powertrain(RouteDrive(robot))
    return FaultTargets(
        world, truth, Surroundings(umad), drive, sensor, Battery(robot), RadioNetwork(umad)
    )


def along(stage, look, times, *data):
    """What `look` sees of the stage at those times."""
    faults = settle(faults_of(*data), stage.world.site, 0)
    schedule, seen = Schedule(faults, stage), []
    for now in times:
        schedule.advance(now)
        seen.append(look(stage))
    return seen


def fault(kind, at, until=None, **fields):
    return {"kind": kind, "at": at, "until": until, **fields}


def pressed(stage):
    return stage.drive.pressed


def test_the_alarm_sounds_until_the_last_one_ends(stage):
    alarms = fault("platform_alarm", 1, 5), fault("platform_alarm", 3, 8)
    seen = along(stage, lambda s: bool(s.surroundings.sources), (0, 2, 4, 6, 7.9, 8), *alarms)
    assert seen == [False, True, True, True, True, False]


def test_an_emergency_stop_holds_until_the_last_one_is_released(stage):
    stops = fault("emergency_stop", 10, 50), fault("emergency_stop", 30, 100)
    assert along(stage, pressed, (20, 40, 60, 99, 100), *stops) == [True] * 4 + [False]


def test_one_that_begins_as_another_ends(stage):
    stops = fault("emergency_stop", 10, 50), fault("emergency_stop", 50, 100)
    assert along(stage, pressed, (49, 50, 99, 100), *stops) == [True, True, True, False]


def test_of_slow_drives_the_slowest_counts(stage):
    slow = (
        fault("drive_dysfunction", 0, speed=0.5),
        fault("drive_dysfunction", 5, 10, speed=0.2),
        fault("drive_dysfunction", 6, 20, speed=0.7),
    )
    assert along(stage, lambda s: s.drive.share, (1, 7, 12, 30), *slow) == [0.5, 0.2, 0.5, 0.5]


def test_a_camera_that_has_failed_stays_so_when_its_noise_ends(stage):
    def how(stage):
        return stage.sensor.failed, stage.sensor.noise

    faults = (
        fault("sensor_dysfunction", 0, effect="fails"),
        fault("sensor_dysfunction", 5, 10, effect="noise", noise=0.2),
    )
    assert along(stage, how, (1, 6, 12), *faults) == [(True, 0.0), (True, 0.2), (True, 0.0)]


def test_of_values_that_which_began_last_counts_while_it_lasts(stage):
    faults = (
        fault("abnormal_value", 0, 30, checkpoint=1, value=7.0),
        fault("abnormal_value", 5, 20, checkpoint=1, value=9.0),
        fault("abnormal_value", 6, 15, checkpoint=2, value=0.0),
    )
    seen = along(stage, lambda s: s.truth[1], (1, 6, 16, 21, 30), *faults)
    assert seen == [7.0, 9.0, 9.0, 7.0, 0.0]


def test_a_checkpoint_that_was_moved_twice_goes_back_in_two_steps(stage):
    def way(offset):
        return {"checkpoint": 1, "offset": offset, "turn": 0.0, "roll": 0.0}

    def aside(stage):
        at = stage.world.site.checkpoint(1).position
        return round(stage.world.in_place(1).position[2] - at[2], 6)

    faults = (
        fault("displaced_checkpoint", 0, 30, **way([0, 0, 0.1])),
        fault("displaced_checkpoint", 5, 20, **way([0, 0, -0.05])),
    )
    assert along(stage, aside, (1, 6, 21, 30), *faults) == [0.1, -0.05, 0.1, 0.0]


def test_a_connection_is_back_when_nothing_shadows_it(stage):
    lost = fault("connection_loss", 1, 5), fault("connection_loss", 3, 8)
    seen = along(stage, lambda s: s.network.connected(POSE), (0, 4, 6, 8), *lost)
    assert seen == [True, False, False, True]
