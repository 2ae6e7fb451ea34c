"""Hot spots are distinguished from surfaces that the sun or a running motor makes warm."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.il import EventKind
from argo_env.robot.pose import BodyPose
from argo_env.sensing.signals.heat_watch import HEIGHT, WIDTH, HeatWatch, ThermalCamera, find_spots
from argo_env.surroundings import HotSpot, Surroundings
from tests.argo_env.sensing.signals.plant import Z, detections_along, lane
from tests.conftest import examples

pytestmark = pytest.mark.physics

AIR = 20.0


def camera(site, world, seed=0, *sources):
    surroundings = Surroundings(site)
    for source in sources:
        surroundings.add(source)
    return ThermalCamera(surroundings, world, np.random.default_rng(seed))


def make_watch(site, world, site_map, seed=0, *sources):
    return HeatWatch(camera(site, world, seed, *sources), site_map, AIR)


def on_vessel(turn, up, **fields):
    """Return a spot on vessel V-1, at an angle from the x axis."""
    return HotSpot((12.0 + math.cos(turn), 5.0 + math.sin(turn), Z + up), **fields)


@settings(deadline=None, max_examples=examples(12))
@given(
    st.floats(-2.6, -1.3),
    st.floats(0.3, 1.6),
    st.floats(0.1, 0.25),
    st.floats(75, 200),
    st.integers(0, 99),
)
def test_a_spot_is_detected_at_its_position_and_nothing_without_it(
    site, world, site_map, turn, up, radius, temperature, seed
):
    spot = on_vessel(turn, up, radius=radius, temperature=temperature)
    detections = detections_along(make_watch(site, world, site_map, seed, spot), lane(5.0, 15.0))
    assert [f.kind for *_, f in detections] == [EventKind.HOT_SPOT]
    assert math.dist(detections[0][2].place, spot.place) < 0.6
    assert "on vessel V-1" in detections[0][2].detail
    assert detections_along(make_watch(site, world, site_map, seed), lane(5.0, 15.0)) == []


@pytest.mark.parametrize("seed", range(6))
def test_a_running_motor_is_warm_and_no_hot_spot(site, world, site_map, seed):
    image = camera(site, world, seed).take_image(BodyPose(3.0, 3.0, Z, math.pi / 2), 0.0)
    assert image.pixels.max() > 55.0
    assert find_spots(image, site_map, AIR) == ()


def test_a_hot_bearing_of_a_pump_is_a_hot_spot(site, world, site_map):
    bearing = HotSpot((3.32, 4.9, Z + 0.45), radius=0.1, temperature=110.0)
    image = camera(site, world, 0, bearing).take_image(BodyPose(3.0, 3.0, Z, math.pi / 2), 0.0)
    (spot,) = find_spots(image, site_map, AIR)
    assert spot.element == "pump P-1"


def test_a_spot_behind_a_vessel_is_not_seen(site, world):
    spot = on_vessel(math.pi / 2, 1.0)
    image = camera(site, world, 0, spot).take_image(BodyPose(12.0, 1.0, Z, math.pi / 2), 0.0)
    assert image.pixels.max() < 75.0  # no more than a motor
    spot = on_vessel(-math.pi / 2, 1.0)
    image = camera(site, world, 0, spot).take_image(BodyPose(12.0, 1.0, Z, math.pi / 2), 0.0)
    assert image.pixels.max() > 80.0


def test_a_spot_is_reported_once_and_again_after_it_was_gone(site, world, site_map):
    surroundings = Surroundings(site)
    watch = HeatWatch(ThermalCamera(surroundings, world, np.random.default_rng(0)), site_map, AIR)
    spot = on_vessel(-math.pi / 2, 1.0)
    pose, kinds = BodyPose(11.0, 1.0, Z, math.pi / 4), []
    for number in range(90):
        if number == 30:
            surroundings.remove(spot)
        if number in (0, 60):
            surroundings.add(spot)
        kinds.append(len(watch.update(3.0 * number, pose)))
    assert (sum(kinds[:30]), sum(kinds[30:60]), sum(kinds[60:])) == (1, 0, 1)


@settings(deadline=None, max_examples=examples(40))
@given(st.integers(0, HEIGHT - 1), st.integers(0, WIDTH - 1), st.floats(0.5, 9.0))
def test_a_place_is_projected_to_the_pixel_whose_ray_leads_to_it(site, world, row, column, depth):
    image = camera(site, world).take_image(BodyPose(5.0, 2.0, Z, 0.7, 0.2), 0.3)
    ray = image.rays(np.array([row]), np.array([column]))[0]
    r, c, ahead = image.row_column_depth(tuple((image.origin + depth * ray).tolist()))
    assert (r, c) == pytest.approx((row + 0.5, column + 0.5))
    assert 0 < ahead <= depth + 1e-9
