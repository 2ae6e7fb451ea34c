"""The watch for pumps that sound unlike themselves."""

import math
from collections import deque
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy
from numpy.typing import NDArray

from argo_compiler.il import EventKind
from argo_env.robot.pose import BodyPose
from argo_env.seeding import generator
from argo_env.sensing.signals.frames import NOSE, on_site, point
from argo_env.sensing.signals.microphone import NEAREST, Microphone, hear, pump_places
from argo_env.sensing.watch import Detection
from argo_env.site import Site
from argo_env.site.shapes import Vector
from argo_env.surroundings.sound import BEARING_ORDER, RATE, shaft_rate

RECORDING = 0.25  # s
NEAR = 5.0
"""m from the nearest pump within which it listens"""
BLOCKS = 5  # of a recording, the power of which is looked at one by one
BAND = (2000.0, 7000.0)
"""Hz: over the lines of a sound pump"""
BANG = 2.0
"""times the middle block that no block may have; metal on metal is over within one"""
LOUD = 10**0.2
"""times what sound pumps make together from which a recording is abnormal: 2 dB, 12 times the
standard deviation"""
WORST = 100.0
"""times its own power (20 dB) that a fault may add to a pump; what would need more is elsewhere"""
LEAST = 1.5
"""times its own power that a fault adds at least (4 dB in all)"""
LOOKS, ENOUGH = 8, 3
"""abnormal recordings in a row that are kept, and that are needed"""
QUIET, BESIDE = 4, 2.0
"""normal recordings within so many m from a pump until what was told of it is over"""
SPREAD, FLOOR = 0.1, 0.06
"""standard deviation of what a recording has too much: share of that, and share of what is normal;
about twice what was measured"""
MISFIT = 3.0  # mean square of the deviations up to which the pumps explain what is heard
PROOF = 16.0  # sum of squared deviations that only this pump's fault explains: 4 deviations
HEARD = 12.0  # m from where it was recorded within which a pump may be what is heard
BEARING_SHARE = 0.3
"""of what there is too much: the part that swells with a bearing's rate; impacts alone have 0.6 or
more, and steady noise 0.1"""
RINGING_BAND = (2500.0, 5000.0)
"""Hz: where housings ring"""
SLIP = 0.03
"""share by which the balls may slip"""
RINGS, TAKES = (0.8, 1.6, 3.2), 3
"""m from each pump where its sound was recorded when all were well, and how often at each"""


@dataclass(frozen=True)
class Baseline:
    """The power over the lines when all is well: of the site, and of each pump at 1 m."""

    site: float
    pumps: dict[str, float]


@dataclass(frozen=True)
class AbnormalRecording:
    """One abnormal recording."""

    ear: Vector
    """m, where it was taken"""
    normal: float
    """the power over the lines there would be if all pumps were well"""
    excess: float
    """what is heard beyond that"""
    envelope: NDArray[np.float64]
    """how much of the sound swells at which rate, a line each 1 / RECORDING Hz; 1 for all of it"""


def power(samples: NDArray[np.float32]) -> float | None:
    """The mean power over the lines; None if metal has struck metal meanwhile."""
    blocks = samples.reshape(BLOCKS, -1)
    line = blocks.shape[1] / RATE  # bins a hertz
    spectra = np.fft.rfft(blocks)[:, round(BAND[0] * line) : round(BAND[1] * line)]
    powers = (spectra.real**2 + spectra.imag**2).sum(axis=1) / blocks.shape[1] ** 2
    return None if powers.max() > BANG * np.median(powers) else float(powers.mean())


def envelope(samples: NDArray[np.float32]) -> NDArray[np.float64]:
    """The spectrum of the squared envelope in the ringing band, beside its mean (Randall and
    Antoni, 2011)."""
    line = len(samples) / RATE
    part = np.fft.rfft(samples)[round(RINGING_BAND[0] * line) : round(RINGING_BAND[1] * line)]
    # A part of the spectrum alone is that of the band's analytic signal, moved to 0 Hz.
    result = np.abs(np.fft.rfft(np.abs(np.fft.ifft(part)) ** 2))
    return np.asarray(result / result[0])


@lru_cache(maxsize=16)
def learn(places: tuple[tuple[str, Vector], ...]) -> Baseline:
    """What was recorded once around the pumps, when all of them ran well."""
    rng = generator(0, "commissioning")
    ears, powers = [], []
    for _, (x, y, z) in places:
        for distance in RINGS:
            for angle in rng.uniform(0.0, 2 * math.pi, TAKES).tolist():
                ear = (x + distance * math.cos(angle), y + distance * math.sin(angle), z)
                heard = power(hear(ear, places, {}, round(RECORDING * RATE), rng))
                if heard is not None:
                    ears.append(ear)
                    powers.append(heard)
    reach = np.column_stack([np.ones(len(ears)), _reach(ears, [place for _, place in places])])
    parts, _ = scipy.optimize.nnls(reach / np.array(powers)[:, None], np.ones(len(powers)))
    site, *pumps = parts.tolist()
    return Baseline(site, dict(zip((name for name, _ in places), pumps, strict=True)))


class PumpWatch:
    """Listens while a pump is near, and finds the pumps whose faults explain what there is more to
    hear than when all were well.

    A fault's share falls with the square of the distance, so places tell pumps apart: a pump is
    told only if no faults of the others explain the same. Holds the last abnormal recordings.
    """

    name = "pumps"
    period = 2.0

    def __init__(self, microphone: Microphone, site: Site) -> None:
        self._microphone = microphone
        self._places = pump_places(site)
        self._looks: deque[AbnormalRecording] = deque(maxlen=LOOKS)
        self._told: dict[str, int] = {}
        """how many recordings beside it have been normal since"""

    def look(self, now: float, pose: BodyPose) -> tuple[Detection, ...]:
        ear = point(on_site(pose, NOSE))
        if all(math.dist(ear, place) > NEAR for place in self._places.values()):
            self._looks.clear()
            return ()
        samples = self._microphone.record(now, pose, RECORDING)
        heard = power(samples)
        if heard is None:
            return ()
        baseline = learn(tuple(self._places.items()))
        own = np.array(list(baseline.pumps.values()))
        normal = baseline.site + float(_reach([ear], list(self._places.values()))[0] @ own)
        if heard <= LOUD * normal:
            # What began or ended meanwhile must not be mixed with what was before.
            self._looks.clear()
            self._forget(ear)
            return ()
        self._looks.append(AbnormalRecording(ear, normal, heard - normal, envelope(samples)))
        self._told = dict.fromkeys(self._told, 0)
        if len(self._looks) < ENOUGH:
            return ()
        return tuple(
            self._detection(name)
            for name in culprits(tuple(self._looks), self._places, baseline)
            if name not in self._told
        )

    def _detection(self, pump: str) -> Detection:
        alone = not self._told
        self._told[pump] = 0
        rate = BEARING_ORDER * shaft_rate(pump) * RECORDING
        low, high = math.floor(rate * (1 - SLIP)), math.ceil(rate * (1 + SLIP))
        best = max(self._looks, key=lambda look: look.excess / look.normal)
        total = best.excess + best.normal
        swell = float(best.envelope[low : high + 1].max()) * total / best.excess
        # Beside another faulty pump the impacts may be that one's.
        impacts = alone and swell > BEARING_SHARE
        how = "with impacts as of a bearing" if impacts else "louder over 2 kHz"
        detail = f"{pump} sounds {how}"
        return Detection(EventKind.ABNORMAL_SOUND, detail, self._places[pump])

    def _forget(self, ear: Vector) -> None:
        """A normal recording was taken here: counts for the pumps that stand beside."""
        for name in self._told:
            self._told[name] += math.dist(ear, self._places[name]) <= BESIDE
        self._told = {name: count for name, count in self._told.items() if count < QUIET}


def culprits(
    looks: tuple[AbnormalRecording, ...], places: dict[str, Vector], baseline: Baseline
) -> list[str]:
    """The pumps near enough to be told without whose fault the looks can't be explained."""
    ears = [look.ear for look in looks]
    away = {name: min(math.dist(ear, place) for ear in ears) for name, place in places.items()}
    names = [name for name in places if away[name] <= HEARD and baseline.pumps[name] > 0.0]
    excess = np.array([look.excess for look in looks])
    deviation = np.hypot(SPREAD * excess, FLOOR * np.array([look.normal for look in looks]))
    own = np.array([baseline.pumps[name] for name in names])
    # Unknown is how many times its own power each pump has more.
    made = _reach(ears, [places[name] for name in names]) * own / deviation[:, None]
    wanted = excess / deviation
    if not names:
        return []
    more, rest = _explained(made, wanted)
    if rest > MISFIT * len(looks):
        return []
    return [
        name
        for k, name in enumerate(names)
        if away[name] <= NEAR
        and more[k] >= LEAST
        and _explained(np.delete(made, k, axis=1), wanted)[1] - rest >= PROOF
    ]


def _explained(
    made: NDArray[np.float64], wanted: NDArray[np.float64]
) -> tuple[NDArray[np.float64], float]:
    """The least squares that faults leave, none of them beyond WORST: how much each adds, and the
    sum of squares that is left."""
    if not made.shape[1]:
        return np.empty(0), float(wanted @ wanted)
    fit = scipy.optimize.lsq_linear(made, wanted, (0.0, WORST), method="bvls")
    return fit.x, 2 * float(fit.cost)


def _reach(ears: list[Vector], places: list[Vector]) -> NDArray[np.float64]:
    """The share of a pump's power at 1 m that arrives, shape (ears, places)."""
    apart = np.array(ears)[:, None, :] - np.array(places)
    return np.asarray(1 / np.maximum((apart**2).sum(axis=2), NEAREST**2))
