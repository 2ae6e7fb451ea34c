"""Conversion of headings to quaternions and back, without loss."""

import math

TILT = 1e-6
"""sine of half the angle to the vertical that still counts as upright"""
EQUAL = 1e-9
"""tolerance between components of unit quaternions, far more than mathematical libraries differ
by"""


def to_quaternion(yaw: float) -> tuple[float, float]:
    """Return z and w of the unit quaternion of a turn about z by `yaw`; x and y are 0."""
    return math.sin(yaw / 2), math.cos(yaw / 2)


def to_yaw(x: float, y: float, z: float, w: float, snap_to_yaw: float = 0.0) -> float:
    """Return the heading of a quaternion of any length.

    The result is `snap_to_yaw` itself if that is the heading of the quaternion within EQUAL, also
    after whole turns, and lies in (-pi, pi] otherwise.

    Raises ValueError, with the fault of the quaternion as its message.
    """
    length = math.hypot(x, y, z, w)
    if not (math.isfinite(length) and math.isfinite(snap_to_yaw)):
        raise ValueError("is not finite")
    if length == 0:
        raise ValueError("is a quaternion of length 0; no turn is (0, 0, 0, 1)")
    if math.hypot(x, y) > TILT * length:
        raise ValueError("is tilted, but the robot's pose can only be turned about the z axis")
    z, w = z / length, w / length
    sine, cosine = to_quaternion(snap_to_yaw)
    # A quaternion and its negative are the same turn.
    if min(max(abs(z - sine), abs(w - cosine)), max(abs(z + sine), abs(w + cosine))) <= EQUAL:
        return snap_to_yaw
    yaw = 2 * math.atan2(z, w)
    return yaw - math.copysign(2 * math.pi, yaw) if abs(yaw) > math.pi else yaw
