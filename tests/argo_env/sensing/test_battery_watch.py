"""The battery watch reports a low battery once, and again only after it was charged."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.il import Afterwards, EventKind, Reaction, Response
from argo_env.drives.battery import Battery
from argo_env.faults.robot import LowBattery
from argo_env.robot.pose import BodyPose
from argo_env.run.spec import RunConditions
from argo_env.sensing.onboard import BatteryWatch
from tests.conftest import examples
from tests.yard import measure, mission, simulated

HERE = BodyPose(0.0, 0.0, 0.0, 0.0)


def reaction(level):
    return Reaction(
        event=EventKind.LOW_BATTERY,
        response=Response.PAUSE,
        until=EventKind.ALL_CLEAR,
        hold_limit=1,
        on_limit=Afterwards.RESUME,
        battery_below=level,
    )


@pytest.mark.physics
@pytest.mark.rule("R11")
@pytest.mark.parametrize(("level", "low"), [(None, False), (0.4, False), (0.6, True)])
def test_a_mission_states_below_which_charge_the_battery_is_low(yard, level, low):
    plan = mission(measure(1), reactions=(reaction(level),))
    record = simulated(plan, yard, faults=(LowBattery(charge=0.5),))
    assert (EventKind.LOW_BATTERY in {a.kind for a in record.anomalies}) == low


@pytest.mark.physics
@pytest.mark.parametrize(("fault", "charge"), [(0.5, 0.3), (0.2, 0.2)])
def test_a_low_battery_never_raises_the_charge(yard, fault, charge):
    spec = RunConditions(charge=0.3)
    record = simulated(
        mission(measure(1)), yard, faults=(LowBattery(charge=fault),), conditions=spec
    )
    assert record.path[0].charge == pytest.approx(charge, abs=0.01)


@pytest.mark.rule("R11")
def test_a_low_battery_is_reported_once_and_again_after_it_was_charged(yard):
    battery = Battery(yard.robot)
    watch = BatteryWatch(battery, 0.3)
    kinds = []
    for charge in (0.35, 0.25, 0.2, 0.35, 0.25, 1.0, 0.5, 0.25):
        battery.charge = charge
        kinds += [detection.kind for detection in watch.update(0.0, HERE)]
    assert kinds == [EventKind.LOW_BATTERY, EventKind.BATTERY_CHARGED, EventKind.LOW_BATTERY]


SHARES = st.floats(0.0, 1.0)


@settings(max_examples=examples(500), deadline=None)
@given(
    level=SHARES,
    was_low=st.booleans(),
    charges=st.lists(SHARES, min_size=1, max_size=6),
    watts=st.floats(-600.0, 400.0),
)
def test_skipped_updates_would_have_detected_nothing(yard, level, was_low, charges, watts):
    battery = Battery(yard.robot)
    watch, skipping = BatteryWatch(battery, level), BatteryWatch(battery, level)
    if was_low:
        battery.charge = 0.0
        for each in (watch, skipping):
            each.update(0.0, HERE)
    if not watch.can_skip_updates(min(charges), max(charges)):
        return
    for charge in charges:
        battery.charge = charge
        battery.use(watts, 0.0)
        assert not watch.update(1.0, HERE)
    for charge in (0.0, 1.0, 0.0):
        battery.charge = charge
        kinds = [[d.kind for d in each.update(2.0, HERE)] for each in (watch, skipping)]
        assert kinds[0] == kinds[1], "both report the same later"
