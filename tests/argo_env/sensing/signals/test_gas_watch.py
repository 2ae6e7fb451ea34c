"""Gas leaks: found by the gas or by the hiss, told once, and over when they are over."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.il import EventKind
from argo_env.robot.pose import BodyPose
from argo_env.sensing.signals.gas_watch import GasSensor, GasWatch, Hysteresis, UltrasonicMicrophone
from argo_env.sensing.watch import Told
from argo_env.surroundings import GasLeak, Surroundings, Weather
from tests.argo_env.sensing.signals.plant import Z, lane, told
from tests.conftest import examples

STANDING = [(float(t), BodyPose(8.0, 2.0, Z, 0.0)) for t in range(400)]


def watch(site, world, site_map, seed=0, around=None):
    around = around or Surroundings(site)
    rngs = [np.random.default_rng([seed, k]) for k in range(2)]
    gas, ear = GasSensor(around, rngs[0]), UltrasonicMicrophone(around, world, rngs[1])
    return GasWatch(gas, ear, site_map), around


def on_pipe(rate=0.02):
    return GasLeak((6.0, 3.14, Z + 1.0), rate)


def test_clean_air_is_clean(site, world, site_map):
    for seed in range(5):
        assert told(watch(site, world, site_map, seed)[0], STANDING) == []


def test_a_leak_is_told_once_and_is_over_when_it_is_closed(site, world, site_map):
    wind = Weather(wind=(0.7, -0.5))
    eye, around = watch(site, world, site_map, around=Surroundings(site, wind))
    assert told(eye, STANDING[:20]) == []
    around.add(on_pipe(), 20.0)
    first = [f for t, p in STANDING[20:120] for f in eye.look(t, p)]
    assert [finding.kind for finding in first] == [EventKind.GAS_LEAK]
    assert "near pipe 1" in first[0].detail
    here = STANDING[0][1]
    assert first[0].noticed_from == (here.x, here.y, here.z)
    assert first[0].place is None, "the signals do not tell from where they come"
    around.remove(on_pipe(), 120.0)
    then = [f for t, p in STANDING[120:300] for f in eye.look(t, p)]
    assert [finding.kind for finding in then] == [EventKind.ALL_CLEAR]
    around.add(on_pipe(), 300.0)
    again = [f for t, p in STANDING[300:] for f in eye.look(t, p)]
    assert [finding.kind for finding in again] == [EventKind.GAS_LEAK]


class TestResumed:
    """The watch is a new one, and remembers what the one before has told."""

    def test_what_is_over_meanwhile_is_told(self, site, world, site_map):
        eye, _ = watch(site, world, site_map)
        eye.remember([Told(EventKind.GAS_LEAK, STANDING[0][1])], 0.0)
        assert [f.kind for *_, f in told(eye, STANDING[:60])] == [EventKind.ALL_CLEAR]

    def test_what_was_over_is_not_told_again(self, site, world, site_map):
        eye, _ = watch(site, world, site_map)
        pose = STANDING[0][1]
        eye.remember([Told(EventKind.GAS_LEAK, pose), Told(EventKind.ALL_CLEAR, pose)], 0.0)
        assert told(eye, STANDING[:60]) == []

    def test_what_goes_on_is_not_told_again_even_far_from_where_it_was(self, site, world, site_map):
        eye, around = watch(site, world, site_map)
        around.add(on_pipe(), -1000.0)
        x, y, z, yaw = 20.0, 2.0, Z, 0.0
        eye.remember([Told(EventKind.GAS_LEAK, BodyPose(x, y, z, yaw))], 0.0)
        assert told(eye, STANDING[:60]) == []

    def test_another_one_is(self, site, world, site_map):
        eye, around = watch(site, world, site_map)
        eye.remember([Told(EventKind.GAS_LEAK, BodyPose(40.0, 2.0, Z, 0.0))], 0.0)
        assert told(eye, STANDING[:30]) == []
        around.add(on_pipe(), 30.0)
        then = [f.kind for t, p in STANDING[30:90] for f in eye.look(t, p)]
        assert then == [EventKind.GAS_LEAK]


def test_upwind_it_is_heard_and_not_smelt(site, world, site_map):
    wind = Weather(wind=(-1.0, 0.5))
    eye, around = watch(site, world, site_map, around=Surroundings(site, wind))
    around.add(on_pipe())
    (_, _, finding), *rest = told(eye, STANDING[:60])
    assert not rest
    assert "a hiss" in finding.detail
    assert "ppm" not in finding.detail


def test_driving_away_is_no_all_clear(site, world, site_map):
    eye, around = watch(site, world, site_map)
    around.add(GasLeak((2.0, 3.0, Z + 0.5), 0.02))
    away = [(t, BodyPose(p.x - 40 * (t > 20), p.y, p.z, p.yaw)) for t, p in lane(1.0, 15.0)]
    assert [f.kind for *_, f in told(eye, away)] == [EventKind.GAS_LEAK]


@settings(deadline=None, max_examples=examples(10))
@given(st.floats(2.0, 14.0), st.floats(0.01, 0.05), st.integers(0, 99))
def test_a_leak_beside_the_way_is_found_and_without_it_nothing(
    site, world, site_map, x, rate, seed
):
    eye, around = watch(site, world, site_map, seed)
    around.add(GasLeak((x, 3.0, Z + 0.5), rate), 0.0)
    assert [f.kind for *_, f in told(eye, lane(0.5, 15.0))] == [EventKind.GAS_LEAK]
    assert told(watch(site, world, site_map, seed)[0], lane(0.5, 15.0)) == []


def test_the_sensor_shows_nine_tenths_after_its_time(site):
    class Still:
        def standard_normal(self, n=None):
            return 0.0 if n is None else np.zeros(n)

    around = Surroundings(site)
    around.add(GasLeak((7.0, 2.0, Z + 0.5), 0.05), -1e6)
    sensor = GasSensor(around, Still())
    pose = BodyPose(9.0, 2.0, Z, 0.0)
    shown = [sensor.read(t, pose) for t in (0.0, GasSensor.T90, 1000.0)]
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
