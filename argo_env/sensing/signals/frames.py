"""Positions of the sensors on the robot, and transforms from the robot's frame to the site's."""

import math

import numpy as np
from numpy.typing import NDArray

from argo_env.robot.pose import BodyPose
from argo_env.site.shapes import Vector

NOSE: Vector = (0.4, 0.0, 0.5)
"""m in the robot's frame: the gas sensor and the ultrasonic microphone"""


def rotation(pose: BodyPose) -> NDArray[np.float64]:
    """Return the rotation from the robot's frame to the site's, shape (3, 3).

    Its columns are the axes of the robot's frame (ahead, left, up).
    """
    c, s = math.cos(pose.yaw), math.sin(pose.yaw)
    down, level = math.sin(pose.pitch), math.cos(pose.pitch)
    return np.array([[c * level, -s, c * down], [s * level, c, s * down], [-down, 0.0, level]])


def to_site(pose: BodyPose, position: Vector) -> NDArray[np.float64]:
    """Return the site's coordinates of a point in the robot's frame, in m, shape (3,)."""
    ahead, left, up = position
    c, s = math.cos(pose.yaw), math.sin(pose.yaw)
    down, level = math.sin(pose.pitch), math.cos(pose.pitch)
    flat = level * ahead + down * up
    x, y, z = c * flat - s * left, s * flat + c * left, level * up - down * ahead
    return np.array([pose.x + x, pose.y + y, pose.z + z])


def to_rounded_vector(values: NDArray[np.float64]) -> Vector:
    """Convert an array of 3 coordinates (m) to a tuple, rounded to the millimetre."""
    x, y, z = (round(v, 3) for v in values.tolist())
    return x, y, z
