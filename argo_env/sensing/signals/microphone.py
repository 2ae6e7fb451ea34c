"""The microphone: sound pressure over time, as all that sounds adds up where the robot is."""

import math
from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from argo_env.robot.pose import BodyPose
from argo_env.sensing.signals.frames import NOSE, on_site
from argo_env.site import Site
from argo_env.site.shapes import Vector
from argo_env.surroundings import Alarm, PumpFault, PumpSound, Surroundings
from argo_env.surroundings.sound import (
    LENGTH,
    RATE,
    SITE_NOISE,
    alarm_sound,
    pressure,
    pump_sound,
)

HEARING = 20.0  # m up to which a pump is heard over the site's noise
NEAREST = 0.5  # m: nearer to the middle of a pump its level does not grow
PUMP_HEIGHT = 0.42
"""m of a pump's shaft over its floor"""
BANG_SHARE, BANG = 0.01, 90.0
"""share of the recordings in which metal strikes metal somewhere, and its level (dB)"""


def pump_places(site: Site) -> dict[str, Vector]:
    """The middle of each pump, by name, in m."""
    return {
        pump.name: (*pump.center, floor.z + PUMP_HEIGHT)
        for floor in site.spec.floors
        for pump in floor.pumps
    }


def hear(
    ear: Vector,
    places: Iterable[tuple[str, Vector]],
    faults: Mapping[str, PumpFault],
    count: int,
    rng: np.random.Generator,
) -> NDArray[np.float32]:
    """Pa, `count` samples: the site and its pumps, some of which have faults, as heard at `ear`."""
    samples = rng.standard_normal(count, dtype=np.float32)
    samples *= np.float32(pressure(SITE_NOISE))
    if rng.random() < BANG_SHARE:
        fading = np.exp(-np.arange(count) / (0.02 * RATE))
        samples += pressure(BANG) * fading * rng.standard_normal(count)
    heard = [(name, d) for name, place in places if (d := math.dist(ear, place)) <= HEARING]
    starts = rng.integers(LENGTH - count, size=len(heard)).tolist()
    for (name, distance), start in zip(heard, starts, strict=True):
        sound = pump_sound(name, faults.get(name))[start : start + count]
        samples += sound * np.float32(1 / max(distance, NEAREST))
    return samples


class Microphone:
    """Records sound."""

    def __init__(self, surroundings: Surroundings, rng: np.random.Generator) -> None:
        self._surroundings = surroundings
        self._places = pump_places(surroundings.site)
        self._rng = rng

    def record(self, now: float, pose: BodyPose, duration: float) -> NDArray[np.float32]:
        """Pa, RATE samples a second, over `duration` (s) from time `now` (s) on."""
        count = round(duration * RATE)
        x, y, z = on_site(pose, NOSE).tolist()
        sources = self._surroundings.sources
        faults = {s.pump: s.fault for s in sources if isinstance(s, PumpSound)}
        samples = hear((x, y, z), self._places.items(), faults, count, self._rng)
        for source in sources:
            if isinstance(source, Alarm):
                samples += alarm_sound(now, count, source.level)
        return samples
