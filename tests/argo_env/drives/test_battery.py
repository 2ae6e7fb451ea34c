"""The battery: the power drawn, the charge left, and its estimate from the voltage."""

import math
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_env.drives.battery import ESTIMATE_ERROR, Battery, estimated_charge, power_draw
from argo_env.robot.pose import BodyPose
from tests.conftest import examples

HERE = BodyPose(1.0, 2.0, 3.0, 0.5)


def test_lasts_as_long_as_its_energy(robot):
    battery = Battery(robot)
    hours = robot.battery / robot.power.driving
    for _ in range(100):
        battery.use(robot.power.driving, hours * 36.0)
    assert battery.charge == pytest.approx(0.0, abs=1e-9)
    battery.use(1.0, 1.0)
    assert battery.is_empty
    battery.use(-robot.power.charging, 3600.0)
    assert battery.charge == pytest.approx(robot.power.charging / robot.battery)
    battery.use(-robot.power.charging, 36000.0)
    assert battery.charge == 1.0


def test_a_worn_one_keeps_its_share_and_holds_less(robot):
    battery = Battery(robot)
    battery.charge = 0.6
    battery.scale_capacity_and_energy(0.5)
    assert battery.charge == pytest.approx(0.6)
    battery.use(robot.battery * 0.3, 3600.0)
    assert battery.charge == pytest.approx(0.0, abs=1e-9)


@settings(max_examples=examples(200), deadline=None)
@given(charge=st.floats(0.0, 1.0), watts=st.floats(-600.0, 400.0))
def test_the_voltage_tells_the_charge(robot, charge, watts):
    battery = Battery(robot)
    battery.charge = charge
    battery.use(watts, 1e-9)
    told = estimated_charge(battery.voltage, battery.current)
    assert told == pytest.approx(charge, abs=ESTIMATE_ERROR)
    assert 22.0 <= battery.voltage <= 29.5


def test_the_voltage_is_between_23_and_28_at_rest_and_falls(robot):
    battery = Battery(robot)
    volts = []
    for k in range(101):
        battery.charge = 1.0 - k / 100
        battery.use(0.0, 0.0)
        volts.append(battery.voltage)
    assert (volts[0], volts[-1]) == (28.0, 23.0)
    assert all(a > b for a, b in pairwise(volts))


@pytest.mark.parametrize(
    ("after", "measuring", "name"),
    [
        (HERE, False, "standing"),
        (HERE, True, "measuring"),
        (BodyPose(1.04, 2.0, 3.0, 0.5), False, "driving"),
        (BodyPose(1.0, 2.0, 3.0, 0.5 + math.radians(2.2)), False, "turning"),
        (BodyPose(1.01, 2.0, 3.01, 0.5, 0.55), False, "climbing"),
        (BodyPose(1.01, 2.0, 2.99, 0.5, 0.55), False, "descending"),
        (BodyPose(1.0005, 2.0, 3.0, 0.5005), False, "standing"),
    ],
)
def test_what_it_draws(robot, after, measuring, name):
    watts = power_draw(robot.power, HERE, after, 0.1, measuring)
    assert watts == getattr(robot.power, name)
