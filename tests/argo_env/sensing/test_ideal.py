"""The ideal sensor returns true values where a camera could see the face, and reasons elsewhere."""

import math

import numpy as np
import pytest

from argo_compiler.base.errors import NotFound
from argo_env.robot.pose import BodyPose
from argo_env.sensing.ideal import IdealSensor, draw_nominal_values
from argo_env.sensing.sensor import MeasurementError
from tests.yard import gauged


@pytest.fixture(scope="module")
def truth(umad):
    return draw_nominal_values(umad, np.random.default_rng(7))


@pytest.fixture(scope="module")
def sensor(simulated_world, robot, truth):
    return IdealSensor(simulated_world, robot, truth)


def in_front_of(umad, robot, id, distance, degrees=0.0):
    """Return a robot's pose with its camera `distance` (m) from the middle of the face.

    The line of sight is `degrees` to the side of the face's normal.
    """
    checkpoint = umad.checkpoint(id)
    floor = next(f for f in umad.spec.floors if f.number == checkpoint.floor)
    along, _, up = robot.sensor.offset
    rise = floor.z + up - checkpoint.position[2]
    away = math.sqrt(distance**2 - rise**2)
    angle = checkpoint.yaw + math.radians(degrees)
    x = checkpoint.position[0] + 0.02 * math.cos(checkpoint.yaw) + away * math.cos(angle)
    y = checkpoint.position[1] + 0.02 * math.sin(checkpoint.yaw) + away * math.sin(angle)
    yaw = angle + math.pi
    return BodyPose(x - along * math.cos(yaw), y - along * math.sin(yaw), floor.z, yaw)


@pytest.mark.parametrize("id", [1, 8])
@pytest.mark.parametrize(("distance", "degrees"), [(0.4, 0), (0.9, 0), (0.9, 45), (0.9, -45)])
def test_reads_the_true_value(sensor, truth, umad, robot, id, distance, degrees):
    measurement = sensor.measure(id, in_front_of(umad, robot, id, distance, degrees))
    assert measurement.value == truth[id]
    assert measurement.distance == pytest.approx(distance, abs=1e-6)


@pytest.mark.parametrize("distance", [0.29, 2.01, 3.0])
def test_out_of_range(sensor, umad, robot, distance):
    with pytest.raises(
        MeasurementError, match=rf"pressure gauge 1 is {distance:.2f} m away.*0\.3 m to 2\.0 m"
    ):
        sensor.measure(1, in_front_of(umad, robot, 1, distance))


@pytest.mark.parametrize("degrees", [61, -70, 150, 180])
def test_too_oblique(sensor, umad, robot, degrees):
    with pytest.raises(MeasurementError, match=r"pressure gauge 1 is seen at \d+ degrees"):
        sensor.measure(1, in_front_of(umad, robot, 1, 1.0, degrees))


def test_hidden_behind_something(sensor, umad, robot):
    # Valve R9 is 0.2 m above the deck: from afar the line of sight meets the railing's rail.
    reasons = []
    for distance in np.linspace(1.0, 2.0, 41):
        for degrees in (0, 20, 40):
            try:
                sensor.measure(19, in_front_of(umad, robot, 19, distance, degrees))
            except MeasurementError as error:
                reasons.append(str(error))
    hidden = [r for r in reasons if "hidden" in r]
    assert hidden
    assert all(r.startswith("valve R9 is hidden behind floor 6 railing") for r in hidden)


@pytest.mark.parametrize("id", [2, 5, 9, 14, 17, 19])
def test_planned_view_is_a_view(navigator, sensor, truth, umad, id):
    end = navigator.plan_to_view(umad.docks[1], id).end
    measurement = sensor.measure(id, BodyPose(end.x, end.y, end.z, end.yaw))
    assert measurement.value == truth[id]


def test_unknown_checkpoint(sensor):
    with pytest.raises(NotFound):
        sensor.measure(99, BodyPose(0.0, 0.0, 0.0, 0.0))


def test_drawn_values_are_nominal_and_the_seeds_own(umad, truth):
    assert draw_nominal_values(umad, np.random.default_rng(7)) == truth
    assert draw_nominal_values(umad, np.random.default_rng(8)) != truth
    for seed in range(20):
        values = draw_nominal_values(umad, np.random.default_rng(seed))
        assert set(values) == {c.id for c in umad.checkpoints}
        for checkpoint in umad.checkpoints:
            value = values[checkpoint.id]
            assert checkpoint.nominal.contains(value)
            assert value == round(value, 2)


@pytest.mark.parametrize(
    ("low", "high", "least", "most"),
    [(2.001, 2.004, 2.001, 2.004), (4.996, 4.996, 4.996, 4.996), (9.0, 12.0, 9.0, 10.0)],
)
def test_drawn_values_are_nominal_however_narrow_that_is(low, high, least, most):
    site = gauged(low, high)
    for seed in range(100):
        values = draw_nominal_values(site, np.random.default_rng(seed)).values()
        assert all(least <= value <= most for value in values)
