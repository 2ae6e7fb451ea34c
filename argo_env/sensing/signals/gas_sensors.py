"""What tells of a leak: a gas sensor and an ultrasonic microphone."""

import math

import numpy as np

from argo_env.robot.pose import BodyPose
from argo_env.sensing.signals.frames import NOSE, on_site, point
from argo_env.surroundings import GasLeak, Surroundings
from argo_env.surroundings.gas import concentration
from argo_env.surroundings.ultrasound import leak_level
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
