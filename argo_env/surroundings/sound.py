"""Sound of pumps, of the alarm and of leaks, as pressure over time or as level.

A pump that runs well has spectral lines at its shaft's frequency and multiples of it, and at the
multiples of its blade-passing frequency, over broadband noise that falls by 3 dB per octave. Each
ball of a bearing that rolls over a spall in the outer race strikes it: with n balls there are
(1 - d/D cos φ) n / 2 impacts per turn, 3.57 for the common bearing 6205. Each impact makes the
housing ring (Randall and Antoni, Rolling element bearing diagnostics, 2011). Cavitation is
broadband noise from 1 kHz up. Levels fall by 6 dB with each doubling of the distance; solids and
air change these frequencies little over a few metres, and are left out.

The alarm is a tone of 1000 Hz, 1 s on and 1 s off. Tone and cadence are this project's own choice.

A leak hisses in the band about 40 kHz. The level of the jet grows with the mass that escapes, and
falls by 6 dB with each doubling of the distance and by the absorption of the air: L = L1 + 10
lg(rate / 10 g/s) - 20 lg(r / 1 m) - a r. Behind a solid only diffracted and reflected sound is
heard.
"""

import math
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from argo_env.seeding import generator
from argo_env.surroundings.surroundings import GasLeak, PumpFault

RATE = 16_000
"""samples a second"""
LENGTH = RATE
"""samples of a pump's sound, which can be repeated without a discontinuity"""
REFERENCE = 20e-6
"""Pa, reference pressure of 0 dB"""
BLADES = 6
PUMP_LEVEL, PUMP_NOISE = 85.0, 70.0
"""dB at 1 m: level of a pump's lines, and of its broadband noise"""
BEARING_LEVEL, CAVITATION_LEVEL = 74.0, 80.0
"""dB at 1 m: levels of the sounds that faults add"""
BEARING_ORDER = 3.57
"""impacts per turn of the shaft"""
RINGING, RINGING_TIME = 3600.0, 1e-3
"""Hz and s: frequency and decay time of the housing after an impact"""
SITE_NOISE = 62.0
"""dB, everywhere: wind, flow, and the robot's own fans"""
ALARM_TONE = 1000.0
"""Hz"""
ALARM_ON, ALARM_PERIOD = 1.0, 2.0
"""s: duration of a tone, and time from the start of one tone to the next"""


def pressure(level: float) -> float:
    """Return the root mean square pressure (Pa) of a level in dB."""
    return REFERENCE * 10 ** (level / 20)


@lru_cache(maxsize=64)
def shaft_turns_per_second(pump: str) -> float:
    """Return a pump's speed in turns per second, 24 or 25, which depends on its name only.

    It is that of a motor with four poles at 50 Hz, less slip, as the pump's type plate shows it.
    """
    return float(generator(0, "shaft", pump).integers(24, 26))


@lru_cache(maxsize=64)
def pump_sound(pump: str, fault: PumpFault | None) -> NDArray[np.float32]:
    """Return the pressure (Pa) at 1 m from the pump, as LENGTH samples that can be repeated.

    The array is cached and read-only.
    """
    rng = generator(0, "pump", pump)
    frequencies = np.fft.rfftfreq(LENGTH, 1 / RATE)
    orders = [(k, -12.0 - 3 * k) for k in range(1, 6)]
    orders += [(BLADES * k, -4.0 * (k - 1)) for k in range(1, 7)]
    lines = np.zeros(len(frequencies))
    for order, level in orders:
        lines[round(order * shaft_turns_per_second(pump) * LENGTH / RATE)] += 10 ** (level / 20)
    sound = _scale_to_level(
        _sound_from_spectrum(rng, lines), PUMP_LEVEL + float(rng.uniform(-2, 2))
    )
    falling = 1 / np.sqrt(np.maximum(frequencies, 20.0))
    sound += _scale_to_level(_sound_from_spectrum(rng, falling), PUMP_NOISE)
    if fault is PumpFault.BEARING:
        sound += _scale_to_level(
            _impacts(rng, BEARING_ORDER * shaft_turns_per_second(pump)), BEARING_LEVEL
        )
    elif fault is PumpFault.CAVITATION:
        sound += _scale_to_level(
            _sound_from_spectrum(rng, (frequencies > 1000.0) * 1.0), CAVITATION_LEVEL
        )
    result = sound.astype(np.float32)
    result.setflags(write=False)
    return result


def alarm_sound(start_seconds: float, samples: int, level: float) -> NDArray[np.float64]:
    """Return the pressure (Pa) of the alarm in `samples` samples from `start_seconds` on.

    There are RATE samples a second. Tones begin at the multiples of ALARM_PERIOD, whenever the
    alarm began.
    """
    time = start_seconds + np.arange(samples) / RATE
    tone = math.sqrt(2) * pressure(level) * np.sin(2 * math.pi * ALARM_TONE * time)
    return np.asarray(np.where(time % ALARM_PERIOD < ALARM_ON, tone, 0.0))


def _scale_to_level(sound: NDArray[np.float64], level: float) -> NDArray[np.float64]:
    return np.asarray(sound * (pressure(level) / np.sqrt(np.mean(sound**2))))


def _sound_from_spectrum(
    rng: np.random.Generator, amplitudes: NDArray[np.floating[Any]]
) -> NDArray[np.float64]:
    """Return a periodic sound with these amplitudes of its spectrum and random phases."""
    phases = np.exp(2j * math.pi * rng.random(len(amplitudes)))
    return np.asarray(np.fft.irfft(amplitudes * phases, LENGTH))


def _impacts(rng: np.random.Generator, rate: float) -> NDArray[np.float64]:
    """Return the ringing after impacts at `rate` (Hz), with small random slip of the balls.

    It has LENGTH samples, which can be repeated, and no unit: the caller scales it to a level.
    """
    count = round(rate * LENGTH / RATE)
    times = (np.arange(count) + 0.02 * rng.standard_normal(count)) / count * LENGTH
    train = np.zeros(LENGTH)
    train[times.astype(int) % LENGTH] = rng.uniform(0.8, 1.2, count)
    time = np.arange(LENGTH) / RATE
    ring = np.exp(-time / RINGING_TIME) * np.sin(2 * math.pi * RINGING * time)
    return np.asarray(np.fft.irfft(np.fft.rfft(train) * np.fft.rfft(ring), LENGTH))


LEAK_LEVEL = 90.0
"""dB at 1 m from a leak of 10 g/s; a choice of this project, in the range for which leak detectors
are sold"""
ABSORPTION = 1.32
"""dB/m at 40 kHz, 20 °C and 50 % relative humidity, by ISO 9613-1"""
SHADOW_LOSS = 20.0
"""dB by which the level is lower behind a solid"""


def leak_level(leak: GasLeak, distance: float, shadowed: bool) -> float:
    """Return the sound level (dB) of a leak at `distance` (m), behind a solid if `shadowed`.

    A distance below 0.1 m counts as 0.1 m.
    """
    r = max(distance, 0.1)
    level = LEAK_LEVEL + 10 * math.log10(leak.rate / 0.01) - 20 * math.log10(r) - ABSORPTION * r
    return level - SHADOW_LOSS * shadowed
