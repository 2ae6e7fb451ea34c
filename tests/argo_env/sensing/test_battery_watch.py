"""When the battery is called low, and when it is charged again."""

import pytest

from argo_compiler.il import Afterwards, EventKind, Reaction, Response
from argo_env.drives.battery import Battery
from argo_env.faults.robot import LowBattery
from argo_env.robot.pose import BodyPose
from argo_env.sensing.onboard import BatteryWatch
from tests.yard import measure, mission, simulated, yard

HERE = BodyPose(0.0, 0.0, 0.0, 0.0)


@pytest.fixture(scope="module")
def navigator():
    return yard()


def reaction(level):
    return Reaction(
        event=EventKind.LOW_BATTERY,
        response=Response.PAUSE,
        until=EventKind.ALL_CLEAR,
        hold_limit=1,
        on_limit=Afterwards.RESUME,
        battery_below=level,
    )


@pytest.mark.rule("R11")
@pytest.mark.parametrize(("level", "low"), [(None, False), (0.4, False), (0.6, True)])
def test_a_mission_says_from_which_charge_on_the_battery_is_low(navigator, level, low):
    plan = mission(measure(1), reactions=(reaction(level),))
    record = simulated(plan, navigator, faults=(LowBattery(charge=0.5),))
    assert (EventKind.LOW_BATTERY in {a.kind for a in record.anomalies}) == low


@pytest.mark.rule("R11")
def test_it_is_low_once_and_again_when_it_was_charged(navigator):
    battery = Battery(navigator.robot)
    watch = BatteryWatch(battery, 0.3)
    told = []
    for charge in (0.35, 0.25, 0.2, 0.35, 0.25, 1.0, 0.5, 0.25):
        battery.charge = charge
        told += [detection.kind for detection in watch.look(0.0, HERE)]
    assert told == [EventKind.LOW_BATTERY, EventKind.BATTERY_CHARGED, EventKind.LOW_BATTERY]
