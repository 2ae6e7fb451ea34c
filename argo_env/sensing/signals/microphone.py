"""Microphone of the robot: the sum of all sounds at its position, as pressure over time."""

import math
from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from argo_env.robot.pose import BodyPose
from argo_env.sensing.signals.frames import NOSE, to_site
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
NEAREST = 0.5  # m: nearer to the middle of a pump its level does not increase
PUMP_HEIGHT = 0.42
"""m, height of a pump's shaft over its floor"""
BANG_SHARE, BANG = 0.01, 90.0
"""share of the recordings in which metal strikes metal somewhere, and its level (dB)"""


def pump_positions(site: Site) -> dict[str, Vector]:
    """Return the position (m) of the middle of each pump, by the name of the pump."""
    return {
        pump.name: (*pump.center, floor.z + PUMP_HEIGHT)
        for floor in site.spec.floors
        for pump in floor.pumps
    }


def sound_at(
    listener: Vector,
    positions: Iterable[tuple[str, Vector]],
    faults: Mapping[str, PumpFault],
    count: int,
    rng: np.random.Generator,
) -> NDArray[np.float32]:
    """Return the sound of the site and its pumps at the position `listener`, in Pa.

    Args:
        listener: position in m.
        positions: names and positions (m) of the pumps.
        faults: faults of pumps by name; all other pumps run well.
        count: number of samples, `RATE` a second.
        rng: draws the noise, bangs, and where the pumps' repeated sounds start.
    """
    samples = rng.standard_normal(count, dtype=np.float32)
    samples *= np.float32(pressure(SITE_NOISE))
    if rng.random() < BANG_SHARE:
        fading = np.exp(-np.arange(count) / (0.02 * RATE))
        samples += pressure(BANG) * fading * rng.standard_normal(count)
    audible = [
        (name, d) for name, position in positions if (d := math.dist(listener, position)) <= HEARING
    ]
    starts = rng.integers(LENGTH - count, size=len(audible)).tolist()
    for (name, distance), start in zip(audible, starts, strict=True):
        sound = pump_sound(name, faults.get(name))[start : start + count]
        samples += sound * np.float32(1 / max(distance, NEAREST))
    return samples


class Microphone:
    """Microphone that records the sources that are in the surroundings at present."""

    def __init__(self, surroundings: Surroundings, rng: np.random.Generator) -> None:
        self._surroundings = surroundings
        self._positions = pump_positions(surroundings.site)
        self._rng = rng

    def record_sound(self, now: float, pose: BodyPose, duration: float) -> NDArray[np.float32]:
        """Record sound from time `now` (s) on for `duration` (s), with the robot at `pose`.

        Returns the pressure in Pa, RATE samples a second.
        """
        count = round(duration * RATE)
        x, y, z = to_site(pose, NOSE).tolist()
        sources = self._surroundings.sources
        faults = {s.pump: s.fault for s in sources if isinstance(s, PumpSound)}
        samples = sound_at((x, y, z), self._positions.items(), faults, count, self._rng)
        for source in sources:
            if isinstance(source, Alarm):
                samples += alarm_sound(now, count, source.level)
        return samples
