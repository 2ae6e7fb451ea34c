"""The pose of the robot's body in the world."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Place = tuple[float, float, float, float, float]
"""x, y, z (m), yaw and pitch (rad) of a robot that does not roll"""
Places = NDArray[np.float64]
"""many of them, shape (n, 5)"""


def place_of(places: Places, number: int) -> Place:
    """One of many places."""
    x, y, z, yaw, pitch = places[number].tolist()
    return x, y, z, yaw, pitch


@dataclass(frozen=True)
class BodyPose:
    """Where the robot's origin is, on the ground between its tracks (m), and its attitude (rad).

    Pitch is positive with the front down, as a turn about the robot's y axis, roll with the right
    side down, as one about its x axis. Of fixed axes, roll comes first, then pitch, then yaw.
    """

    x: float
    y: float
    z: float
    yaw: float
    pitch: float = 0.0
    roll: float = 0.0
