"""Leaks, pumps and the alarm have their levels and spectra, and surfaces their temperatures."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_env.site.shapes import Role
from argo_env.surroundings import GasLeak, PumpFault, Weather
from argo_env.surroundings.heat import highest_temperature_without_fault, surface_temperatures
from argo_env.surroundings.sound import (
    ABSORPTION,
    ALARM_TONE,
    BEARING_ORDER,
    LENGTH,
    RATE,
    REFERENCE,
    SHADOW_LOSS,
    alarm_sound,
    leak_level,
    pump_sound,
    shaft_turns_per_second,
)
from tests.conftest import examples

PUMPS = st.sampled_from(["pump P-301", "pump P-302", "P-9"])


def level(samples):
    return 20 * np.log10(np.sqrt(np.mean(np.square(samples, dtype=np.float64))) / REFERENCE)


@settings(deadline=None, max_examples=examples(50))
@given(st.floats(0.2, 20.0), st.floats(0.001, 0.2))
def test_a_hiss_falls_by_6_db_with_each_doubling_and_by_absorption(r, rate):
    leak = GasLeak((0, 0, 0), rate)
    fall = leak_level(leak, r, False) - leak_level(leak, 2 * r, False)
    assert fall == pytest.approx(20 * np.log10(2) + ABSORPTION * r)
    assert leak_level(leak, r, False) - leak_level(leak, r, True) == pytest.approx(SHADOW_LOSS)
    assert leak_level(GasLeak((0, 0, 0), 2 * rate), r, False) > leak_level(leak, r, False)


@settings(deadline=None, max_examples=examples(10))
@given(PUMPS)
def test_a_pump_hums_at_its_blades_passing(pump):
    sound = pump_sound(pump, None)
    power = np.abs(np.fft.rfft(sound)) ** 2
    assert level(sound) == pytest.approx(85.0, abs=3.0)
    assert np.argmax(power) * RATE / LENGTH == pytest.approx(6 * shaft_turns_per_second(pump))
    assert np.array_equal(sound, pump_sound(pump, None))
    # The step from the end back to the start is not greater than the steps within.
    steps = np.abs(np.diff(sound))
    assert abs(sound[0] - sound[-1]) <= steps.max()


@settings(deadline=None, max_examples=examples(10))
@given(PUMPS, st.sampled_from(PumpFault))
def test_a_fault_adds_to_high_frequencies_and_leaves_the_lines(pump, fault):
    normal, faulty = (np.abs(np.fft.rfft(pump_sound(pump, f))) ** 2 for f in (None, fault))
    line = round(6 * shaft_turns_per_second(pump) * LENGTH / RATE)
    assert faulty[line] == pytest.approx(normal[line], rel=0.05)
    high = slice(2000 * LENGTH // RATE, 7000 * LENGTH // RATE)
    assert faulty[high].sum() > 2 * normal[high].sum()


@pytest.mark.parametrize("fault", [None, *PumpFault])
def test_only_a_bearing_rings_with_its_balls(fault):
    sound = np.asarray(pump_sound("P-1", fault), dtype=np.float64)
    spectrum = np.fft.rfft(sound)
    spectrum[: 2500 * LENGTH // RATE] = 0
    envelope = np.abs(np.fft.rfft(np.fft.irfft(spectrum, LENGTH) ** 2))
    rate = BEARING_ORDER * shaft_turns_per_second("P-1") * LENGTH / RATE
    modulation = envelope[round(0.97 * rate) : round(1.03 * rate) + 1].max() / envelope[0]
    assert (modulation > 0.4) == (fault is PumpFault.BEARING)


def test_the_alarm_sounds_a_second_and_is_silent_a_second():
    sound = alarm_sound(0.0, 4 * RATE, 85.0).reshape(4, RATE)
    assert [level(part + 1e-12) > 80 for part in sound] == [True, False, True, False]
    assert level(sound[0]) == pytest.approx(85.0, abs=0.1)
    assert np.argmax(np.abs(np.fft.rfft(sound[0]))) == ALARM_TONE
    later = alarm_sound(1.5, RATE, 85.0)
    assert not later[: RATE // 2].any()
    assert np.allclose(later[RATE // 2 :], sound[0][: RATE // 2], atol=1e-9)


@settings(deadline=None, max_examples=examples(50))
@given(st.sampled_from(Role), st.floats(0, np.pi), st.floats(0, 2 * np.pi), st.floats(-10, 40))
def test_no_sound_surface_is_warmer_than_its_role_allows(role, tilt, turn, air):
    normal = [np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), np.cos(tilt)]
    weather = Weather(temperature=air)
    warm = surface_temperatures([role], np.array([normal]), weather)[0]
    assert warm <= highest_temperature_without_fault(role, air) + 1e-2
    night = surface_temperatures(
        [role], np.array([normal]), Weather(temperature=air, sun=(0, 0, 0))
    )[0]
    assert night <= warm


def test_the_sky_is_cold():
    assert surface_temperatures([None], np.zeros((1, 3)), Weather())[0] < Weather().temperature
