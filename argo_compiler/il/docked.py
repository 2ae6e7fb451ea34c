"""Test whether a robot is docked."""

import math
from typing import Protocol

from argo_compiler.base.model import Pose

DOCKED_DISTANCE_M = 0.1
DOCKED_ANGLE = math.radians(5.0)


class PoseLike(Protocol):
    """Anything with a position (m) and a heading (rad), such as a pose of the robot."""

    @property
    def x(self) -> float: ...
    @property
    def y(self) -> float: ...
    @property
    def z(self) -> float: ...
    @property
    def yaw(self) -> float: ...


def is_at_dock(robot: PoseLike, dock: Pose) -> bool:
    """Return True if the robot is at the dock: within 10 cm and 5 degrees of its pose."""
    distance = math.dist((robot.x, robot.y, robot.z), (dock.x, dock.y, dock.z))
    angle = math.pi - (math.pi - (robot.yaw - dock.yaw)) % (2 * math.pi)
    return distance <= DOCKED_DISTANCE_M and abs(angle) <= DOCKED_ANGLE
