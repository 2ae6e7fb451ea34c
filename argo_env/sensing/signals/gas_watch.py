"""Gas leaks: a gas sensor, an ultrasonic microphone, and the watch that tells of leaks by both."""

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from argo_compiler.il import EventKind
from argo_env.robot.pose import BodyPose
from argo_env.sensing.signals.frames import NOSE, on_site, point
from argo_env.sensing.signals.site_map import SiteMap
from argo_env.sensing.watch import Detection, Told
from argo_env.site.shapes import Vector
from argo_env.surroundings import GasLeak, Surroundings
from argo_env.surroundings.gas import concentration
from argo_env.surroundings.sound import leak_level
from argo_env.world.world import World


class GasSensor:
    """A point sensor for methane. Holds its own slow answer and drift."""

    T90 = 5.0
    """s until it shows 90 % of a step"""
    NOISE = 2.0
    """ppm, standard deviation"""
    DRIFT = 3.0
    """ppm, standard deviation of its zero, which wanders"""
    DRIFT_TIME = 600.0
    """s in which the zero forgets where it was"""
    BACKGROUND = 1.9
    """ppm of methane in clean air"""
    GUSTS = 0.4
    """standard deviation of the logarithm of what eddies make of the mean concentration"""

    def __init__(self, surroundings: Surroundings, rng: np.random.Generator) -> None:
        self._surroundings = surroundings
        self._rng = rng
        self._shown = self.BACKGROUND
        self._zero = self.DRIFT * float(rng.standard_normal())
        self._last: float | None = None

    def read(self, now: float, pose: BodyPose) -> float:
        """ppm."""
        step = 0.0 if self._last is None else now - self._last
        self._last = now
        noise, drift, gust = map(float, self._rng.standard_normal(3))
        at = on_site(pose, NOSE)[None, :]
        around, ground = self._surroundings, self._surroundings.site.spec.ground_z
        mean = sum(
            float(concentration(release, around.weather, ground, at, now)[0])
            for release in around.releases
        )
        air = self.BACKGROUND + mean * math.exp(self.GUSTS * gust - self.GUSTS**2 / 2)
        self._shown += (air - self._shown) * (1 - math.exp(-step * math.log(10) / self.T90))
        kept = math.exp(-step / self.DRIFT_TIME)
        self._zero = kept * self._zero + self.DRIFT * math.sqrt(1 - kept**2) * drift
        return self._shown + self._zero + self.NOISE * noise


class UltrasonicMicrophone:
    """The sound level in the band about 40 kHz."""

    BACKGROUND = 45.0
    """dB"""
    NOISE = 1.5
    """dB, standard deviation"""
    BANG_SHARE = 0.01
    """share of the looks in which metal strikes metal somewhere"""
    BANG = (60.0, 90.0)
    """dB, from and to"""

    def __init__(self, surroundings: Surroundings, world: World, rng: np.random.Generator) -> None:
        self._surroundings = surroundings
        self._world = world
        self._rng = rng

    def read(self, pose: BodyPose) -> float:
        """dB."""
        noise = float(self._rng.standard_normal())
        bang, height = map(float, self._rng.random(2))
        levels = [self.BACKGROUND]
        if bang < self.BANG_SHARE:
            levels.append(self.BANG[0] + height * (self.BANG[1] - self.BANG[0]))
        for source in self._surroundings.sources:
            if isinstance(source, GasLeak):
                levels.append(self._heard(source, pose))
        return 10 * math.log10(sum(10 ** (level / 10) for level in levels)) + self.NOISE * noise

    def _heard(self, leak: GasLeak, pose: BodyPose) -> float:
        ear = on_site(pose, NOSE)
        way = np.array(leak.place) - ear
        distance = float(np.linalg.norm(way))
        # The leak lies in the surface of what leaks: what is next to it is no obstacle.
        free = self._world.ranges(point(ear), np.array([leak.place]))[0]
        return leak_level(leak, distance, bool(free < distance - 0.2))


GAS_ON, GAS_OFF = 40.0, 20.0
"""ppm from which there is gas, and under which there is none; noise and drift have a standard
deviation of 3.6 ppm about 1.9 ppm"""
HISS_ON, HISS_OFF = 62.0, 55.0
"""dB from which there is a hiss, and under which there is none"""
LOOKS, GAS_VOTES, HISS_VOTES = 5, 3, 4
"""how many of the last looks must agree; a bang is over after one"""
CLEAR_TIME = 10.0  # s without a signal until the danger is over
WARMING_UP = 15.0  # s after a run was resumed until the sensors show what went on meanwhile
SAME_PLACE = 8.0  # m from where a leak was told within which it is the same
NEAR = 3.0  # m from where it was strongest within which its absence means anything


class Hysteresis:
    """On when enough of the last values are high, off when all of them are low. Holds them."""

    def __init__(self, on: float, off: float, votes: int) -> None:
        self._limits = (on, off)
        self._votes = votes
        self._values: deque[float] = deque(maxlen=LOOKS)
        self.active = False

    def update(self, value: float) -> bool:
        """Whether it is on after this value."""
        self._values.append(value)
        on, off = self._limits
        if sum(v >= on for v in self._values) >= self._votes:
            self.active = True
        elif all(v < off for v in self._values):
            self.active = False
        return self.active


@dataclass
class _Leak:
    """A leak that has been told: where it was sensed, and where the most."""

    places: list[BodyPose]
    worst: BodyPose
    strength: float


class GasWatch:
    """Tells of each leak once, and that it is over when nothing is sensed any more where it was
    strongest.

    Holds what the sensors have shown, and where leaks have been told.
    """

    name = "gas"
    period = 1.0

    def __init__(self, gas: GasSensor, microphone: UltrasonicMicrophone, site_map: SiteMap) -> None:
        self._gas_sensor = gas
        self._microphone = microphone
        self._map = site_map
        self._gas = Hysteresis(GAS_ON, GAS_OFF, GAS_VOTES)
        self._hiss = Hysteresis(HISS_ON, HISS_OFF, HISS_VOTES)
        self._leaks: list[_Leak] = []
        self._here: _Leak | None = None
        self._quiet_since: float | None = None
        self._shown_from = 0.0  # s, when a signal that goes on would show

    def remember(self, told: Sequence[Told], now: float) -> None:
        """Takes a leak to be the worst where it was told."""
        for each in told:
            if each.kind is EventKind.GAS_LEAK:
                self._leaks.append(_Leak([each.pose], each.pose, 1.0))
            elif self._leaks:
                pose = each.pose
                self._leaks.remove(min(self._leaks, key=lambda leak: _apart(pose, leak.worst)))
        self._here = self._leaks[-1] if self._leaks else None
        self._shown_from = now + WARMING_UP

    def look(self, now: float, pose: BodyPose) -> tuple[Detection, ...]:
        ppm, level = self._gas_sensor.read(now, pose), self._microphone.read(pose)
        smelt, heard = self._gas.update(ppm), self._hiss.update(level)
        if not smelt and not heard:
            if now >= self._shown_from:
                self._here = None
            return self._all_clear(now, pose)
        self._quiet_since = None
        strength = max(ppm / GAS_ON, 10 ** ((level - HISS_ON) / 10))
        # As long as the signal does not stop, it is the same leak, however far its gas reaches.
        known = self._here or next((k for k in self._leaks if _near(k, pose)), None)
        self._here = known or _Leak([], pose, strength)
        if not _near(self._here, pose):
            self._here.places.append(pose)
        if strength > self._here.strength:
            self._here.worst, self._here.strength = pose, strength
        if known:
            return ()
        self._leaks.append(self._here)
        near = self._map.nearest_equipment((pose.x, pose.y, pose.z + 0.5))
        signs = [f"gas, {ppm:.0f} ppm"] * smelt + [f"a hiss, {level:.0f} dB at 40 kHz"] * heard
        detail = f"{' and '.join(signs)}, near {near}"
        return (Detection(EventKind.GAS_LEAK, detail, noticed_from=_place(pose)),)

    def _all_clear(self, now: float, pose: BodyPose) -> tuple[Detection, ...]:
        here = [leak for leak in self._leaks if _apart(pose, leak.worst) <= NEAR]
        if not here:
            self._quiet_since = None
            return ()
        self._quiet_since = now if self._quiet_since is None else self._quiet_since
        if now - self._quiet_since < CLEAR_TIME:
            return ()
        self._leaks = [leak for leak in self._leaks if leak not in here]
        detail = "there is no gas any more where it was"
        return (Detection(EventKind.ALL_CLEAR, detail, noticed_from=_place(pose)),)


def _place(pose: BodyPose) -> Vector:
    """Where it was noticed: the signals do not tell from where they come."""
    return pose.x, pose.y, pose.z


def _near(leak: _Leak, pose: BodyPose) -> bool:
    return any(_apart(pose, where) <= SAME_PLACE for where in leak.places)


def _apart(a: BodyPose, b: BodyPose) -> float:
    """m; a storey above or below is far away."""
    return math.dist((a.x, a.y, 3 * a.z), (b.x, b.y, 3 * b.z))
