"""Headings as quaternions and back, without loss."""

import math

TILT = 1e-6
"""sine of half the angle to the vertical that still counts as upright"""
EQUAL = 1e-9
"""between components of unit quaternions, far more than mathematical libraries differ by"""


def to_quaternion(yaw: float) -> tuple[float, float]:
    """z and w of the unit quaternion of a turn about z by `yaw`; x and y are 0."""
    return math.sin(yaw / 2), math.cos(yaw / 2)


def to_yaw(x: float, y: float, z: float, w: float, planned: float = 0.0) -> float:
    """The heading of a quaternion of any length: `planned` itself where that is its heading, in
    (-pi, pi] otherwise.

    Raises ValueError, saying what is wrong with the quaternion.
    """
    length = math.hypot(x, y, z, w)
    if not (math.isfinite(length) and math.isfinite(planned)):
        raise ValueError("is not finite")
    if length == 0:
        raise ValueError("is a quaternion of length 0; no turn is (0, 0, 0, 1)")
    if math.hypot(x, y) > TILT * length:
        raise ValueError("is tilted; a pose of the robot has a heading only")
    z, w = z / length, w / length
    sine, cosine = to_quaternion(planned)
    # A quaternion and its negative are the same turn.
    if min(max(abs(z - sine), abs(w - cosine)), max(abs(z + sine), abs(w + cosine))) <= EQUAL:
        return planned
    yaw = 2 * math.atan2(z, w)
    return yaw - math.copysign(2 * math.pi, yaw) if abs(yaw) > math.pi else yaw
