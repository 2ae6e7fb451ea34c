"""The battery watch reports a low battery once, and again only after it was charged."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.hfsm import AwaitedCharge
from argo_compiler.il import Afterwards, EventKind, Reaction, Response
from argo_env.drives.battery import Battery
from argo_env.faults.robot import LowBattery
from argo_env.robot.pose import BodyPose
from argo_env.run.spec import RunConditions
from argo_env.sensing.battery_watch import MARGIN, BatteryWatch
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


LOW, CHARGED = EventKind.LOW_BATTERY, EventKind.BATTERY_CHARGED
CHARGING_W = -500.0


def reports(yard, charges, watts=0.0, level=0.3, watch=None):
    """Return the charges at which a watch reports something, and what."""
    battery = Battery(yard.robot)
    watch = watch or BatteryWatch(battery, level)
    watch._battery = battery
    found = []
    for charge in charges:
        battery.charge = charge
        battery.use(watts, 0.0)
        found += [(charge, detection.kind) for detection in watch.update(0.0, HERE)]
    return found


@pytest.mark.rule("R11")
@pytest.mark.parametrize("between", [1.0, 0.35, 0.311])
def test_a_low_battery_is_reported_again_when_the_charge_was_above_its_level(yard, between):
    charges = (0.35, 0.295, 0.2, between, 0.295)
    low = [(charge, kind) for charge, kind in reports(yard, charges) if kind is LOW]
    assert low == [(0.295, LOW), (0.295, LOW)]


@pytest.mark.rule("R11")
def test_a_low_battery_is_not_reported_again_because_of_an_estimate(yard):
    """The estimate is wrong by up to half a percent, and the level is 30 %."""
    assert reports(yard, (0.35, 0.295, 0.304, 0.295, 0.28, 0.25)) == [(0.295, LOW)]


@pytest.mark.rule("R11")
@pytest.mark.parametrize("charged", [0.12, 0.2, 0.3])
def test_the_energy_of_a_charging_that_was_cut_short_is_not_used_up_without_a_report(yard, charged):
    battery = Battery(yard.robot)
    watch = BatteryWatch(battery, 0.3)
    assert reports(yard, (0.35, 0.1), watch=watch)[-1] == (0.1, LOW)
    rising = [0.1 + k / 1000 for k in range(round(1000 * (charged - 0.1)) + 1)]
    assert reports(yard, rising, CHARGING_W, watch=watch) == []
    falling = [charged - k / 1000 for k in range(100)]
    ((at, kind),) = reports(yard, falling, 100.0, watch=watch)
    assert kind is LOW
    assert charged - 2 * MARGIN <= at < charged


@pytest.mark.rule("R11")
def test_a_wait_that_a_person_ends_at_once_counts_as_charging_too(yard):
    watch = BatteryWatch(Battery(yard.robot), 0.3)
    assert reports(yard, (0.35, 0.25), watch=watch) == [(0.25, LOW)]
    watch.awaited = (AwaitedCharge(None, 0.0),)
    watch.awaited = ()
    assert reports(yard, (0.25, 0.245), watch=watch) == []
    assert reports(yard, (0.239, 0.22), watch=watch) == [(0.239, LOW)]


@pytest.mark.rule("R11")
def test_a_reaction_that_ends_without_charging_rearms_the_watch(yard):
    watch = BatteryWatch(Battery(yard.robot), 0.3)
    assert reports(yard, (0.35, 0.25), watch=watch) == [(0.25, LOW)]
    watch.is_answered = True
    assert reports(yard, (0.249, 0.2), watch=watch) == []
    watch.is_answered = False
    assert reports(yard, (0.199, 0.185), watch=watch) == [(0.185, LOW)]


@pytest.mark.rule("R12")
def test_a_time_of_charging_counts_only_while_the_battery_charges(yard):
    watch = BatteryWatch(Battery(yard.robot), 0.2)
    watch.awaited = (AwaitedCharge(0.0, 0.0, while_charging=True),)
    assert reports(yard, (0.5, 0.4), watch=watch) == []
    assert not watch.has_awaited_charge
    assert reports(yard, (0.4,), CHARGING_W, watch=watch) == [(0.4, CHARGED)]


@pytest.mark.rule("R12")
@pytest.mark.parametrize(
    ("awaited", "now", "charge", "charged"),
    [
        ([AwaitedCharge(0.6, 0.0)], 1.0, 0.59, False),
        ([AwaitedCharge(0.6, 0.0)], 1.0, 0.61, True),
        ([AwaitedCharge(0.6, 5.0)], 4.0, 0.61, False),
        ([AwaitedCharge(0.6, 5.0)], 5.0, 0.61, True),
        ([AwaitedCharge(0.0, 5.0)], 5.0, 0.31, True),
        ([AwaitedCharge(0.0, 5.0, while_charging=True)], 5.0, 0.31, False),
        ([AwaitedCharge(0.0, 5.0, while_charging=True)], 5.0, 1.0, True),
        ([AwaitedCharge(None, 0.0)], 1.0, 0.98, False),
        ([AwaitedCharge(None, 0.0)], 1.0, 1.0, True),
        ([AwaitedCharge(1.0, 0.0)], 1.0, 1.0, True),
        ([AwaitedCharge(0.6, 0.0), AwaitedCharge(0.8, 0.0)], 1.0, 0.7, False),
        ([AwaitedCharge(0.6, 0.0), AwaitedCharge(0.8, 0.0)], 1.0, 0.81, True),
        ([], 1.0, 1.0, False),
    ],
)
def test_a_charge_is_reported_when_the_mission_waits_for_it(yard, awaited, now, charge, charged):
    battery = Battery(yard.robot)
    watch = BatteryWatch(battery)
    watch.awaited = tuple(awaited)
    battery.charge = charge
    found = [detection.kind for detection in watch.update(now, HERE)]
    assert found == ([CHARGED] if charged else [])


SHARES = st.floats(0.0, 1.0)


@settings(max_examples=examples(500), deadline=None)
@given(
    level=SHARES,
    was_low=st.booleans(),
    awaited=st.lists(
        st.builds(
            AwaitedCharge,
            st.one_of(st.none(), SHARES),
            st.sampled_from([0.0, 5.0]),
            st.booleans(),
        ),
        max_size=2,
    ),
    charges=st.lists(SHARES, min_size=1, max_size=6),
    watts=st.floats(-600.0, 400.0),
)
def test_skipped_updates_would_have_detected_nothing(yard, level, was_low, awaited, charges, watts):
    battery = Battery(yard.robot)
    watch, skipping = BatteryWatch(battery, level), BatteryWatch(battery, level)
    if was_low:
        battery.charge = 0.0
        for each in (watch, skipping):
            each.update(0.0, HERE)
    watch.awaited = skipping.awaited = tuple(awaited)
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
