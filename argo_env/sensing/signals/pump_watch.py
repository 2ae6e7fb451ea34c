"""The watch for pumps that sound unlike themselves."""

import math
from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.il import EventKind
from argo_env.robot.pose import BodyPose
from argo_env.seeding import generator
from argo_env.sensing.signals.frames import NOSE, on_site, point
from argo_env.sensing.signals.microphone import Microphone, pump_places
from argo_env.sensing.watch import Finding
from argo_env.site import Site
from argo_env.site.shapes import Vector
from argo_env.surroundings import Surroundings
from argo_env.surroundings.sound import BEARING_ORDER, RATE, shaft_rate

RECORDING = 0.5  # s
NEAR = 3.5
"""m within which a pump stands out of the site's noise"""
NOISE_BAND = (2000.0, 7000.0)
"""Hz: over the lines of a sound pump"""
RINGING_BAND = (2500.0, 5000.0)
"""Hz: where housings ring"""
RESOLUTION = 0.03
"""share by which the balls may slip"""
RISE = {"noise": 4.0, "impacts": 8.0}
"""dB over the pump's baseline from which a feature is abnormal ..."""
DEVIATIONS = 6.0
"""... if that is also so many standard deviations of the baseline"""
LOOKS, VOTES = 4, 3
"""how many of the last recordings must be abnormal"""
RINGS, TAKES = (0.8, 1.4, 2.3, 3.6), 5
"""m from the pump at which its baseline is recorded, and how often at each"""
NORMAL = 1.48  # standard deviations of a normal distribution in its median absolute deviation
TELLING = 0.5  # dB of spread by which another pump must fit better than the nearest
AUDIBLE = 8.0  # m within which a pump with a fault may be the one that is heard
MEANING = {"noise": "louder over 2 kHz", "impacts": "with impacts as of a bearing"}


def features(samples: NDArray[np.float32], shaft: float, distance: float) -> dict[str, float]:
    """In dB: the level of the noise over the lines, brought to 1 m, and how much of the sound in
    the ringing band swells with the rate at which balls pass a spall, for a shaft of `shaft` turns
    a second: the squared envelope's line at that rate beside its mean (Randall and Antoni, 2011).
    """
    spectrum = np.fft.rfft(samples)
    line = len(samples) / RATE  # bins a hertz
    power = np.abs(spectrum[round(NOISE_BAND[0] * line) : round(NOISE_BAND[1] * line)]) ** 2
    nearer = 20 * math.log10(distance)
    noise = 10 * math.log10(float(power.sum()) / len(samples) ** 2) + nearer
    # A part of the spectrum alone is that of the band's analytic signal, moved to 0 Hz.
    ringing = np.fft.ifft(spectrum[round(RINGING_BAND[0] * line) : round(RINGING_BAND[1] * line)])
    envelope = np.abs(np.fft.rfft(np.abs(ringing) ** 2))
    rate = BEARING_ORDER * shaft * line
    low, high = math.floor(rate * (1 - RESOLUTION)), math.ceil(rate * (1 + RESOLUTION))
    swell = float(envelope[low : high + 1].max() / envelope[0])
    return {"noise": noise, "impacts": 10 * math.log10(swell)}


@dataclass(frozen=True)
class Baseline:
    """How a pump sounds when it is well: the middle of each feature at each of RINGS, and the
    standard deviation about it."""

    middle: dict[str, NDArray[np.float64]]
    deviation: dict[str, float]

    def abnormal(self, found: dict[str, float], distance: float) -> list[str]:
        """The features that have risen."""
        return [
            key
            for key, value in found.items()
            if value - float(np.interp(distance, RINGS, self.middle[key]))
            > max(RISE[key], DEVIATIONS * self.deviation[key])
        ]


def learn(site: Site, pump: str) -> Baseline:
    """The baseline as recorded once, when all pumps of the site ran well."""
    place = pump_places(site)[pump]
    rng = generator(0, "commissioning", pump)
    microphone = Microphone(Surroundings(site), rng)
    shaft = shaft_rate(pump)
    rings: list[list[dict[str, float]]] = []
    for distance in RINGS:
        takes = []
        for angle in rng.uniform(0.0, 2 * math.pi, TAKES):
            pose = _beside(place, distance, float(angle))
            takes.append(features(microphone.record(0.0, pose, RECORDING), shaft, distance))
        rings.append(takes)
    values = {k: np.array([[take[k] for take in takes] for takes in rings]) for k in RISE}
    # Medians, as metal may have struck metal in one of the takes.
    middle = {k: np.median(v, axis=1) for k, v in values.items()}
    spread = {k: float(np.median(np.abs(v - middle[k][:, None]))) for k, v in values.items()}
    return Baseline(middle, {k: NORMAL * v for k, v in spread.items()})


class PumpWatch:
    """Listens to the nearest pump while it is near enough, and compares it with its own baseline.

    Holds the baselines that it has needed, and what it has heard last.
    """

    name = "pumps"
    period = 2.0

    def __init__(self, microphone: Microphone, site: Site) -> None:
        self._microphone = microphone
        self._site = site
        self._places = pump_places(site)
        self._baselines: dict[str, Baseline] = {}
        self._last: deque[_Look] = deque(maxlen=LOOKS)
        self._told: set[str] = set()

    def look(self, now: float, pose: BodyPose) -> tuple[Finding, ...]:
        ear = point(on_site(pose, NOSE))
        near = {n: d for n, p in self._places.items() if (d := math.dist(ear, p)) <= NEAR}
        if not near:
            return ()
        nearest = min(near, key=lambda name: near[name])
        distance = max(near[nearest], RINGS[0])
        if nearest not in self._baselines:
            self._baselines[nearest] = learn(self._site, nearest)
        sound = self._microphone.record(now, pose, RECORDING)
        found = features(sound, shaft_rate(nearest), distance)
        risen = self._baselines[nearest].abnormal(found, distance)
        if self._last and self._last[-1].nearest != nearest:
            self._last.clear()
        level = found["noise"] - 20 * math.log10(distance)
        self._last.append(_Look(nearest, ear, level, bool(risen)))
        bad = [look for look in self._last if look.abnormal]
        if not bad and len(self._last) == LOOKS:
            self._told.discard(nearest)
        if not risen or len(bad) < VOTES:
            return ()
        pump = self._whose(bad)
        if pump in self._told:
            return ()
        self._told.add(pump)
        how = " and ".join(MEANING[key] for key in risen)
        return (Finding(EventKind.ABNORMAL_SOUND, f"{pump} sounds {how}", self._places[pump]),)

    def _whose(self, looks: list["_Look"]) -> str:
        """The pump that the sound comes from: the one from which the level falls as it should with
        the distance, if that tells pumps apart; else the nearest."""
        spread = {}
        for name, place in self._places.items():
            away = [math.dist(look.ear, place) for look in looks]
            if min(away) <= AUDIBLE:
                levels = [k.level + 20 * math.log10(d) for k, d in zip(looks, away, strict=True)]
                spread[name] = float(np.std(levels))
        nearest, best = looks[-1].nearest, min(spread, key=lambda name: spread[name])
        return best if spread[nearest] - spread[best] > TELLING else nearest


@dataclass(frozen=True)
class _Look:
    """One recording: the nearest pump, where it was taken (m), the level of the noise over the
    lines (dB), and whether that pump would be abnormal."""

    nearest: str
    ear: Vector
    level: float
    abnormal: bool


def _beside(place: Vector, distance: float, angle: float) -> BodyPose:
    """A pose with the microphone `distance` (m) from the place, in the direction `angle` (rad)."""
    x, y, z = place
    ahead, _, up = NOSE
    return BodyPose(
        x + distance * math.cos(angle) - ahead, y + distance * math.sin(angle), z - up, 0.0
    )
