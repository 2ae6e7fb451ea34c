"""Sound: what pumps, the alarm and the site itself make of noise, as pressure over time.

A pump that runs well gives lines at its shaft's frequency and at the multiples of its blades'
passing, over broadband noise that falls by 3 dB an octave. A spall in the outer race of a bearing
with n balls is struck (1 - d/D cos φ) n / 2 times a turn, 3.57 times for the common 6205, and rings
each time (Randall and Antoni, Rolling element bearing diagnostics, 2011). Cavitation is broadband
noise from 1 kHz up. Levels fall by 6 dB with each doubling of the distance; solids and the air do
little to these frequencies over a few metres, and are left out.

The alarm is a tone of 1000 Hz, 1 s on and 1 s off. Tone and cadence are this project's own choice.

A leak hisses in the band about 40 kHz. A jet's level grows with the mass that escapes, and falls by
6 dB with each doubling of the distance and by the absorption of the air: L = L1 + 10 lg(rate / 10
g/s) - 20 lg(r / 1 m) - a r. Behind a solid there is only what is bent around it or thrown back.
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
"""samples of a pump's sound, which is repeated without a seam"""
REFERENCE = 20e-6
"""Pa, of 0 dB"""
BLADES = 6
PUMP_LEVEL, PUMP_NOISE = 85.0, 70.0
"""dB at 1 m: a pump as a whole, and the broadband part of it"""
BEARING_LEVEL, CAVITATION_LEVEL = 74.0, 80.0
"""dB at 1 m that a fault adds"""
BEARING_ORDER = 3.57
"""impacts a turn"""
RINGING, RINGING_TIME = 3600.0, 1e-3
"""Hz and s, of the housing that an impact excites"""
SITE_NOISE = 62.0
"""dB, everywhere: wind, flow, and the robot's own fans"""
ALARM_TONE = 1000.0
"""Hz"""
ALARM_ON, ALARM_PERIOD = 1.0, 2.0
"""s that the alarm sounds, and s from one tone to the next"""


def pressure(level: float) -> float:
    """Pa, root mean square, of a level in dB."""
    return REFERENCE * 10 ** (level / 20)


@lru_cache(maxsize=64)
def shaft_rate(pump: str) -> float:
    """Turns a second, as on the pump's type plate: a motor with four poles at 50 Hz, less slip."""
    return float(generator(0, "shaft", pump).integers(24, 26))


@lru_cache(maxsize=64)
def pump_sound(pump: str, fault: PumpFault | None) -> NDArray[np.float32]:
    """Pa at 1 m from the pump, LENGTH samples that repeat; the array can't be written."""
    rng = generator(0, "pump", pump)
    frequencies = np.fft.rfftfreq(LENGTH, 1 / RATE)
    orders = [(k, -12.0 - 3 * k) for k in range(1, 6)]
    orders += [(BLADES * k, -4.0 * (k - 1)) for k in range(1, 7)]
    lines = np.zeros(len(frequencies))
    for order, level in orders:
        lines[round(order * shaft_rate(pump) * LENGTH / RATE)] += 10 ** (level / 20)
    sound = _scaled(_sound(rng, lines), PUMP_LEVEL + float(rng.uniform(-2, 2)))
    falling = 1 / np.sqrt(np.maximum(frequencies, 20.0))
    sound += _scaled(_sound(rng, falling), PUMP_NOISE)
    if fault is PumpFault.BEARING:
        sound += _scaled(_impacts(rng, BEARING_ORDER * shaft_rate(pump)), BEARING_LEVEL)
    elif fault is PumpFault.CAVITATION:
        sound += _scaled(_sound(rng, (frequencies > 1000.0) * 1.0), CAVITATION_LEVEL)
    result = sound.astype(np.float32)
    result.setflags(write=False)
    return result


def alarm_sound(start: float, samples: int, level: float) -> NDArray[np.float64]:
    """Pa of the alarm from time `start` (s) on, while it sounds without an end."""
    time = start + np.arange(samples) / RATE
    tone = math.sqrt(2) * pressure(level) * np.sin(2 * math.pi * ALARM_TONE * time)
    return np.asarray(np.where(time % ALARM_PERIOD < ALARM_ON, tone, 0.0))


def _scaled(sound: NDArray[np.float64], level: float) -> NDArray[np.float64]:
    return np.asarray(sound * (pressure(level) / np.sqrt(np.mean(sound**2))))


def _sound(rng: np.random.Generator, amplitudes: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    """A sound that repeats, with the given amplitudes of its spectrum and random phases."""
    phases = np.exp(2j * math.pi * rng.random(len(amplitudes)))
    return np.asarray(np.fft.irfft(amplitudes * phases, LENGTH))


def _impacts(rng: np.random.Generator, rate: float) -> NDArray[np.float64]:
    """Impacts at `rate` (Hz), the balls slipping a little, and what rings after each."""
    count = round(rate * LENGTH / RATE)
    times = (np.arange(count) + 0.02 * rng.standard_normal(count)) / count * LENGTH
    train = np.zeros(LENGTH)
    train[times.astype(int) % LENGTH] = rng.uniform(0.8, 1.2, count)
    after = np.arange(LENGTH) / RATE
    ring = np.exp(-after / RINGING_TIME) * np.sin(2 * math.pi * RINGING * after)
    return np.asarray(np.fft.irfft(np.fft.rfft(train) * np.fft.rfft(ring), LENGTH))


LEVEL = 90.0
"""dB at 1 m from a leak of 10 g/s; our choice, in the range of leaks that detectors are sold for"""
ABSORPTION = 1.32
"""dB/m at 40 kHz, 20 °C and 50 % relative humidity, by ISO 9613-1"""
SHADOW = 20.0
"""dB that a solid takes away"""


def leak_level(leak: GasLeak, distance: float, shadowed: bool) -> float:
    """dB at `distance` (m) from the leak, in the shadow of a solid or not."""
    r = max(distance, 0.1)
    level = LEVEL + 10 * math.log10(leak.rate / 0.01) - 20 * math.log10(r) - ABSORPTION * r
    return level - SHADOW * shadowed
