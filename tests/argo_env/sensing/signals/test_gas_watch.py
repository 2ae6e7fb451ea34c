"""Gas leaks are detected by the gas or by the hiss; each and its end are reported once."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.il import EventKind
from argo_env.robot.pose import BodyPose
from argo_env.sensing.signals.gas_watch import (
    CLEAR_READINGS,
    GasSensor,
    GasWatch,
    Hysteresis,
    UltrasonicMicrophone,
)
from argo_env.sensing.watch import ReportedDetection
from argo_env.surroundings import GasLeak, Surroundings, Weather
from tests.argo_env.sensing.signals.plant import Z, detections_along, lane
from tests.conftest import examples

pytestmark = pytest.mark.physics

STAY = [(float(t), BodyPose(8.0, 2.0, Z, 0.0)) for t in range(400)]


def make_watch(site, world, site_map, seed=0, surroundings=None):
    surroundings = surroundings or Surroundings(site)
    rngs = [np.random.default_rng([seed, k]) for k in range(2)]
    gas, ear = GasSensor(surroundings, rngs[0]), UltrasonicMicrophone(surroundings, world, rngs[1])
    return GasWatch(gas, ear, site_map), surroundings


def on_pipe(rate=0.02):
    return GasLeak((6.0, 3.14, Z + 1.0), rate)


def test_clean_air_is_clean(site, world, site_map):
    for seed in range(5):
        assert detections_along(make_watch(site, world, site_map, seed)[0], STAY) == []


def test_a_leak_is_reported_once_and_its_end_when_it_is_closed(site, world, site_map):
    wind = Weather(wind=(0.7, -0.5))
    watch, surroundings = make_watch(site, world, site_map, surroundings=Surroundings(site, wind))
    assert detections_along(watch, STAY[:20]) == []
    surroundings.add(on_pipe(), 20.0)
    first = [f for t, p in STAY[20:120] for f in watch.update(t, p)]
    assert [detection.kind for detection in first] == [EventKind.GAS_LEAK]
    assert "near pipe 1" in first[0].detail
    here = STAY[0][1]
    assert first[0].noticed_from == (here.x, here.y, here.z)
    assert first[0].place is None, "the signals have no direction"
    surroundings.remove(on_pipe(), 120.0)
    later = [(t, f) for t, p in STAY[120:300] for f in watch.update(t, p)]
    assert [detection.kind for _, detection in later] == [EventKind.ALL_CLEAR]
    assert 120 + CLEAR_READINGS <= later[0][0] < 220
    surroundings.add(on_pipe(), 300.0)
    again = [f for t, p in STAY[300:] for f in watch.update(t, p)]
    assert [detection.kind for detection in again] == [EventKind.GAS_LEAK]


def events_of_drive(watch, *stays):
    """Return the events while the robot stands at each pose for its number of seconds in turn."""
    poses = [pose for pose, seconds in stays for _ in range(seconds)]
    return [(t, f.kind) for t, p in enumerate(poses) for f in watch.update(float(t), p)]


class TestAllClear:
    """It is given only where the robot has stood in the strongest signal of each leak."""

    def test_not_beside_a_narrow_plume_that_the_robot_has_crossed(self, site, world, site_map):
        air = Surroundings(site, Weather(wind=(0.0, -20.0)))
        watch, surroundings = make_watch(site, world, site_map, surroundings=air)
        surroundings.add(GasLeak((6.0, 20.0, Z + 0.5), 0.02), -100.0)
        crossing = [(BodyPose(4.2 + t / 5, 2.0, Z, 0.0), 1) for t in range(15)]
        beyond = BodyPose(8.4, 2.0, Z, 0.0)
        events = events_of_drive(watch, *crossing, (beyond, 300))
        assert [kind for _, kind in events] == [EventKind.GAS_LEAK]

    def test_not_behind_a_solid_that_hides_the_hiss(self, site, world, site_map):
        air = Surroundings(site, Weather(wind=(0.0, 8.0)))
        watch, surroundings = make_watch(site, world, site_map, surroundings=air)
        surroundings.add(GasLeak((12.0, 6.2, Z + 1.0), 0.002))  # behind the vessel
        heard, hidden = BodyPose(10.2, 6.5, Z, 0.0), BodyPose(10.4, 4.0, Z, 0.0)
        events = events_of_drive(watch, (heard, 60), (hidden, 300))
        assert [kind for _, kind in events] == [EventKind.GAS_LEAK]

    @pytest.mark.parametrize(
        "place", [BodyPose(8.0, 2.5, Z, 0.0), BodyPose(8.0, 2.0, Z + 2.5, 0.0)]
    )
    def test_only_where_the_robot_has_stood_in_the_strongest_signal(
        self, site, world, site_map, place
    ):
        watch, surroundings = make_watch(site, world, site_map)
        surroundings.add(on_pipe(), 0.0)
        here, weaker = BodyPose(8.0, 2.0, Z, 0.0), BodyPose(12.0, 2.0, Z, 0.0)
        begun = events_of_drive(watch, (weaker, 40), (here, 40))
        assert [kind for _, kind in begun] == [EventKind.GAS_LEAK]
        surroundings.remove(on_pipe(), 80.0)
        later = enumerate([place] * 200 + [weaker] * 200 + [here] * 400, start=80)
        cleared = [t for t, pose in later for _ in watch.update(float(t), pose)]
        assert cleared == [480 + CLEAR_READINGS - 1]

    def test_only_after_all_leaks(self, site, world, site_map):
        watch, surroundings = make_watch(site, world, site_map)
        one, other = on_pipe(), GasLeak((-40.0, 2.0, Z + 0.5), 0.02)
        surroundings.add(one, 0.0)
        surroundings.add(other, 0.0)
        here, there = BodyPose(8.0, 2.0, Z, 0.0), BodyPose(-39.0, 2.0, Z, 0.0)
        far = BodyPose(-80.0, 2.0, Z, 0.0)
        events = events_of_drive(watch, (here, 60), (far, 60), (there, 60), (far, 60))
        assert [kind for _, kind in events] == [EventKind.GAS_LEAK] * 2
        surroundings.remove(one, 240.0)
        assert [f for t in range(240, 500) for f in watch.update(float(t), here)] == []
        surroundings.remove(other, 500.0)
        later = [f.kind for t in range(500, 800) for f in watch.update(float(t), there)]
        assert later == [EventKind.ALL_CLEAR]


class TestResumed:
    """A new watch continues from the reports of the previous one."""

    def test_where_the_robot_stood_in_the_signal_is_forgotten(self, site, world, site_map):
        watch, surroundings = make_watch(site, world, site_map)
        watch.restore([ReportedDetection(EventKind.GAS_LEAK, STAY[0][1])], 0.0)
        assert detections_along(watch, STAY[:100]) == [], "it may never have stood there"
        surroundings.add(on_pipe(), 100.0)
        assert [f for t, p in STAY[100:200] for f in watch.update(t, p)] == []
        surroundings.remove(on_pipe(), 200.0)
        later = [f.kind for t, p in STAY[200:] for f in watch.update(t, p)]
        assert later == [EventKind.ALL_CLEAR]

    def test_a_reported_end_is_not_reported_again(self, site, world, site_map):
        watch, _ = make_watch(site, world, site_map)
        pose = STAY[0][1]
        watch.restore(
            [
                ReportedDetection(EventKind.GAS_LEAK, pose),
                ReportedDetection(EventKind.ALL_CLEAR, pose),
            ],
            0.0,
        )
        assert detections_along(watch, STAY[:60]) == []

    def test_a_leak_that_goes_on_is_not_reported_again_even_far_from_its_report(
        self, site, world, site_map
    ):
        watch, surroundings = make_watch(site, world, site_map)
        surroundings.add(on_pipe(), -1000.0)
        x, y, z, yaw = 20.0, 2.0, Z, 0.0
        watch.restore([ReportedDetection(EventKind.GAS_LEAK, BodyPose(x, y, z, yaw))], 0.0)
        assert detections_along(watch, STAY[:60]) == []

    def test_a_new_leak_is_reported(self, site, world, site_map):
        watch, surroundings = make_watch(site, world, site_map)
        watch.restore([ReportedDetection(EventKind.GAS_LEAK, BodyPose(40.0, 2.0, Z, 0.0))], 0.0)
        assert detections_along(watch, STAY[:30]) == []
        surroundings.add(on_pipe(), 30.0)
        later = [f.kind for t, p in STAY[30:90] for f in watch.update(t, p)]
        assert later == [EventKind.GAS_LEAK]


def test_upwind_a_leak_is_detected_by_its_hiss_only(site, world, site_map):
    wind = Weather(wind=(-1.0, 0.5))
    watch, surroundings = make_watch(site, world, site_map, surroundings=Surroundings(site, wind))
    surroundings.add(on_pipe())
    (_, _, detection), *rest = detections_along(watch, STAY[:60])
    assert not rest
    assert "a hiss" in detection.detail
    assert "ppm" not in detection.detail


def test_driving_away_is_no_all_clear(site, world, site_map):
    watch, surroundings = make_watch(site, world, site_map)
    surroundings.add(GasLeak((2.0, 3.0, Z + 0.5), 0.02))
    away = [(t, BodyPose(p.x - 40 * (t > 20), p.y, p.z, p.yaw)) for t, p in lane(1.0, 15.0)]
    assert [f.kind for *_, f in detections_along(watch, away)] == [EventKind.GAS_LEAK]


@settings(deadline=None, max_examples=examples(10))
@given(st.floats(2.0, 14.0), st.floats(0.01, 0.05), st.integers(0, 99))
def test_a_leak_beside_the_path_is_detected_and_nothing_without_it(
    site, world, site_map, x, rate, seed
):
    watch, surroundings = make_watch(site, world, site_map, seed)
    surroundings.add(GasLeak((x, 3.0, Z + 0.5), rate), 0.0)
    assert [f.kind for *_, f in detections_along(watch, lane(0.5, 15.0))] == [EventKind.GAS_LEAK]
    assert detections_along(make_watch(site, world, site_map, seed)[0], lane(0.5, 15.0)) == []


def test_the_sensor_shows_nine_tenths_after_its_time(site):
    class Still:
        def standard_normal(self, n=None):
            return 0.0 if n is None else np.zeros(n)

    surroundings = Surroundings(site)
    surroundings.add(GasLeak((7.0, 2.0, Z + 0.5), 0.05), -1e6)
    sensor = GasSensor(surroundings, Still())
    pose = BodyPose(9.0, 2.0, Z, 0.0)
    shown = [sensor.measure_methane_ppm(t, pose) for t in (0.0, GasSensor.T90, 1000.0)]
    assert shown[0] == GasSensor.BACKGROUND
    rise = (shown[1] - shown[0]) / (shown[2] - shown[0])
    assert abs(rise - 0.9) < 1e-9


@settings(deadline=None, max_examples=examples(50))
@given(st.lists(st.floats(20.001, 39.999), max_size=40), st.booleans())
def test_between_its_limits_a_hysteresis_stays_as_it_is(values, on):
    state = Hysteresis(40.0, 20.0, 3)
    for value in [50.0] * 5 if on else [0.0] * 5:
        state.update(value)
    assert all(state.update(value) is on for value in values)


def test_a_bang_is_no_hiss():
    state = Hysteresis(62.0, 55.0, 4)
    assert not any(state.update(v) for v in [45, 90, 45, 45, 88, 90, 45, 45, 45])
    assert [state.update(v) for v in [70, 70, 70, 70]] == [False, False, False, True]
