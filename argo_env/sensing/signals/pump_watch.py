"""Watch for pumps that sound different from their baseline."""

import math
from collections import deque
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy
from numpy.typing import NDArray

from argo_compiler.base.message import Message
from argo_compiler.il import EventKind
from argo_env.robot.pose import BodyPose
from argo_env.seeding import generator
from argo_env.sensing.signals.frames import NOSE, to_rounded_vector, to_site
from argo_env.sensing.signals.microphone import NEAREST, Microphone, pump_positions, sound_at
from argo_env.sensing.watch import Detection
from argo_env.site import Site
from argo_env.site.shapes import Vector
from argo_env.surroundings.sound import BEARING_ORDER, RATE, shaft_turns_per_second

RECORDING = 0.25  # s
NEAR = 5.0
"""m from the nearest pump within which the watch records"""
BLOCKS = 5  # of a recording, whose powers are compared
BAND = (2000.0, 7000.0)
"""Hz, above the spectral lines of a normal pump"""
BANG = 2.0
"""times the median power of the blocks; a block with more power has a bang of metal on metal, which
is over within one block"""
LOUD = 10**0.2
"""times the power of all normal pumps together from which a recording is abnormal: 2 dB, which is
12 times the standard deviation"""
WORST = 100.0
"""times its own power (20 dB) that a fault adds to a pump at most; a louder sound comes from
elsewhere"""
LEAST = 1.5
"""times its own power that a fault adds to a pump at least (4 dB in all)"""
MAX_RECORDINGS, MIN_RECORDINGS = 8, 3
"""number of abnormal recordings in a row that are stored, and that a detection needs"""
QUIET_RECORDINGS, QUIET_RANGE = 4, 2.0
"""number of normal recordings within this distance (m) from a pump until its fault is over"""
SPREAD, FLOOR = 0.1, 0.06
"""standard deviation of a recording's excess power, as a share of the excess and as a share of the
normal power; about twice the measured values"""
MISFIT = 3.0  # mean square of the deviations up to which faults of pumps explain the recordings
PROOF = 16.0  # sum of squared deviations that only this pump's fault explains: 4 deviations
AUDIBLE_RANGE = 12.0  # m from a recording within which a pump may be its cause
BEARING_SHARE = 0.3
"""share of the excess that varies at a bearing's impact rate, from which there are impacts; impacts
alone have 0.6 or more, steady noise has 0.1"""
RINGING_BAND = (2500.0, 5000.0)
"""Hz, in which housings ring"""
SLIP = 0.03
"""share by which the balls may slip"""
RINGS, RECORDINGS_PER_RING = (0.8, 1.6, 3.2), 3
"""m from each pump at which the baseline was recorded, and the number of recordings at each"""


@dataclass(frozen=True)
class Baseline:
    """Power in the noise band (as `noise_band_power_unless_bang`) when all pumps run well."""

    site: float
    """power of the site itself"""
    pumps: dict[str, float]
    """power of each pump at 1 m, by its name"""


@dataclass(frozen=True)
class AbnormalRecording:
    """A recording whose power is higher than the baseline explains."""

    listener: Vector
    """m, position of the microphone"""
    normal: float
    """expected power in the noise band if all pumps run well"""
    excess: float
    """measured power beyond the normal one"""
    envelope_spectrum: NDArray[np.float64]
    """share, 0 to 1, of the sound that varies at each rate, one value each 1 / RECORDING Hz"""


def noise_band_power_unless_bang(samples: NDArray[np.float32]) -> float | None:
    """Return the mean power in `BAND`, which has no spectral lines of normal pumps.

    `samples` are a recording (Pa, RATE samples a second). The power is half the mean square of
    their part in the band (Pa²). Returns None if it has a bang of metal.
    """
    blocks = samples.reshape(BLOCKS, -1)
    bins_per_hertz = blocks.shape[1] / RATE
    spectra = np.fft.rfft(blocks)[
        :, round(BAND[0] * bins_per_hertz) : round(BAND[1] * bins_per_hertz)
    ]
    powers = (spectra.real**2 + spectra.imag**2).sum(axis=1) / blocks.shape[1] ** 2
    return None if powers.max() > BANG * np.median(powers) else float(powers.mean())


def envelope_spectrum(samples: NDArray[np.float32]) -> NDArray[np.float64]:
    """Return the spectrum of a recording's squared envelope in the ringing band.

    The magnitudes are relative to that at 0 Hz; there is one for each 1 / duration Hz.
    See Randall and Antoni, Rolling element bearing diagnostics, 2011.
    """
    bins_per_hertz = len(samples) / RATE
    part = np.fft.rfft(samples)[
        round(RINGING_BAND[0] * bins_per_hertz) : round(RINGING_BAND[1] * bins_per_hertz)
    ]
    # The part of the spectrum is that of the band's analytic signal, shifted to 0 Hz.
    result = np.abs(np.fft.rfft(np.abs(np.fft.ifft(part)) ** 2))
    return np.asarray(result / result[0])


@lru_cache(maxsize=16)
def learn_baseline(positions: tuple[tuple[str, Vector], ...]) -> Baseline:
    """Return the baseline of the pumps with these names and positions (m).

    It is fitted to recordings around the pumps.
    The recordings are simulated with all pumps running well, as if made at commissioning.
    """
    rng = generator(0, "commissioning")
    listeners, powers = [], []
    for _, (x, y, z) in positions:
        for distance in RINGS:
            for angle in rng.uniform(0.0, 2 * math.pi, RECORDINGS_PER_RING).tolist():
                listener = (x + distance * math.cos(angle), y + distance * math.sin(angle), z)
                band_power = noise_band_power_unless_bang(
                    sound_at(listener, positions, {}, round(RECORDING * RATE), rng)
                )
                if band_power is not None:
                    listeners.append(listener)
                    powers.append(band_power)
    shares = np.column_stack(
        [np.ones(len(listeners)), _attenuation(listeners, [position for _, position in positions])]
    )
    parts, _ = scipy.optimize.nnls(shares / np.array(powers)[:, None], np.ones(len(powers)))
    site, *pumps = parts.tolist()
    return Baseline(site, dict(zip((name for name, _ in positions), pumps, strict=True)))


class PumpWatch:
    """Watch for pumps whose faults explain why recordings near them are louder than normal.

    The power of a fault falls with the square of the distance, so recordings at several positions
    tell pumps apart: a pump is reported only if faults of the other pumps don't explain the same.
    The watch holds the last abnormal recordings and the pumps that it has reported.
    """

    name = "pumps"
    period = 2.0

    def __init__(self, microphone: Microphone, site: Site) -> None:
        self._microphone = microphone
        self._positions = pump_positions(site)
        self._recordings: deque[AbnormalRecording] = deque(maxlen=MAX_RECORDINGS)
        self._reported: dict[str, int] = {}
        """number of normal recordings beside each reported pump since the last abnormal one"""

    def update(self, now: float, pose: BodyPose) -> tuple[Detection, ...]:
        listener = to_rounded_vector(to_site(pose, NOSE))
        if all(math.dist(listener, position) > NEAR for position in self._positions.values()):
            self._recordings.clear()
            return ()
        samples = self._microphone.record_sound(now, pose, RECORDING)
        band_power = noise_band_power_unless_bang(samples)
        if band_power is None:
            return ()
        baseline = learn_baseline(tuple(self._positions.items()))
        pump_powers = np.array(list(baseline.pumps.values()))
        normal = baseline.site + float(
            _attenuation([listener], list(self._positions.values()))[0] @ pump_powers
        )
        if band_power <= LOUD * normal:
            # A fault that begins or ends must not be mixed with the recordings made earlier.
            self._recordings.clear()
            self._count_quiet(listener)
            return ()
        self._recordings.append(
            AbnormalRecording(listener, normal, band_power - normal, envelope_spectrum(samples))
        )
        self._reported = dict.fromkeys(self._reported, 0)
        if len(self._recordings) < MIN_RECORDINGS:
            return ()
        return tuple(
            self._detection(name)
            for name in faulty_pumps(tuple(self._recordings), self._positions, baseline)
            if name not in self._reported
        )

    def _detection(self, pump: str) -> Detection:
        is_only_pump = not self._reported
        self._reported[pump] = 0
        rate = BEARING_ORDER * shaft_turns_per_second(pump) * RECORDING
        low, high = math.floor(rate * (1 - SLIP)), math.ceil(rate * (1 + SLIP))
        best = max(self._recordings, key=lambda recording: recording.excess / recording.normal)
        total = best.excess + best.normal
        swell = float(best.envelope_spectrum[low : high + 1].max()) * total / best.excess
        # With another faulty pump near, the impacts may come from that one.
        impacts = is_only_pump and swell > BEARING_SHARE
        description = (
            Message("with impacts as of a bearing") if impacts else Message("louder over 2 kHz")
        )
        detail = Message("{pump} sounds {description}", pump=pump, description=description)
        return Detection(EventKind.ABNORMAL_SOUND, detail, self._positions[pump])

    def _count_quiet(self, listener: Vector) -> None:
        """Count a normal recording for reported pumps near it; drop those with QUIET_RECORDINGS."""
        for name in self._reported:
            self._reported[name] += math.dist(listener, self._positions[name]) <= QUIET_RANGE
        self._reported = {
            name: count for name, count in self._reported.items() if count < QUIET_RECORDINGS
        }


def faulty_pumps(
    recordings: tuple[AbnormalRecording, ...], positions: dict[str, Vector], baseline: Baseline
) -> list[str]:
    """Return the names of the pumps that must have a fault, given abnormal recordings.

    These are pumps near a recording without whose fault the recordings can't be explained. The
    list is empty if faults of pumps don't explain the recordings at all. `positions` (m) are those
    of all pumps by name.
    """
    listeners = [recording.listener for recording in recordings]
    distance = {
        name: min(math.dist(listener, position) for listener in listeners)
        for name, position in positions.items()
    }
    names = [
        name for name in positions if distance[name] <= AUDIBLE_RANGE and baseline.pumps[name] > 0.0
    ]
    excess = np.array([recording.excess for recording in recordings])
    deviation = np.hypot(
        SPREAD * excess, FLOOR * np.array([recording.normal for recording in recordings])
    )
    pump_powers = np.array([baseline.pumps[name] for name in names])
    # Solve for the power that each pump's fault adds, as a multiple of the pump's own power.
    per_pump = (
        _attenuation(listeners, [positions[name] for name in names])
        * pump_powers
        / deviation[:, None]
    )
    measured = excess / deviation
    if not names:
        return []
    added, residual = _fit_faults(per_pump, measured)
    if residual > MISFIT * len(recordings):
        return []
    return [
        name
        for k, name in enumerate(names)
        if distance[name] <= NEAR
        and added[k] >= LEAST
        and _fit_faults(np.delete(per_pump, k, axis=1), measured)[1] - residual >= PROOF
    ]


def _fit_faults(
    per_pump: NDArray[np.float64], measured: NDArray[np.float64]
) -> tuple[NDArray[np.float64], float]:
    """Fit the excess powers `measured` by the pumps' faults, each 0 to WORST times the pump's own.

    Returns these multiples, and the sum of squares that remains. `per_pump` has a column for each
    pump and a row for each recording, as `measured`; both are divided by the deviations of the
    recordings.
    """
    if not per_pump.shape[1]:
        return np.empty(0), float(measured @ measured)
    fit = scipy.optimize.lsq_linear(per_pump, measured, (0.0, WORST), method="bvls")
    return fit.x, 2 * float(fit.cost)


def _attenuation(listeners: list[Vector], positions: list[Vector]) -> NDArray[np.float64]:
    """Return the power of each pump at each listener over that at 1 m, shape (listeners, pumps)."""
    offset = np.array(listeners)[:, None, :] - np.array(positions)
    return np.asarray(1 / np.maximum((offset**2).sum(axis=2), NEAREST**2))
