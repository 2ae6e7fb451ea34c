"""Pose of the robot's body in the world, also as tuples and arrays."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

PoseTuple = tuple[float, float, float, float, float]
"""x, y, z (m), yaw and pitch (rad) of a robot that does not roll"""
PoseArray = NDArray[np.float64]
"""poses of a robot that does not roll, shape (n, 5); columns as in `PoseTuple`"""


def pose_tuple_at(poses: PoseArray, index: int) -> PoseTuple:
    """Return the pose at an index of an array of poses as a tuple."""
    x, y, z, yaw, pitch = poses[index].tolist()
    return x, y, z, yaw, pitch


@dataclass(frozen=True)
class BodyPose:
    """Position (m) of the robot's origin, on the ground between its tracks, and attitude (rad).

    Pitch is a rotation about the robot's y axis, positive with the front down. Roll is a rotation
    about its x axis, positive with the right side down. About fixed axes, roll is applied first,
    then pitch, then yaw.
    """

    x: float
    y: float
    z: float
    yaw: float
    pitch: float = 0.0
    roll: float = 0.0
