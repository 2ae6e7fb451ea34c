"""When a robot counts as docked."""

import math
from typing import Protocol

from argo_compiler.base.model import Pose

DOCKED_DISTANCE_M = 0.1
DOCKED_ANGLE = math.radians(5.0)


class Standpoint(Protocol):
    """A point (m) and a heading (rad), whatever else is known about the robot that is there."""

    @property
    def x(self) -> float: ...
    @property
    def y(self) -> float: ...
    @property
    def z(self) -> float: ...
    @property
    def yaw(self) -> float: ...


def at_dock(robot: Standpoint, dock: Pose) -> bool:
    """Whether a robot is in the station of that pose: within 10 cm and 5 degrees."""
    away = math.dist((robot.x, robot.y, robot.z), (dock.x, dock.y, dock.z))
    turned = math.pi - (math.pi - (robot.yaw - dock.yaw)) % (2 * math.pi)
    return away <= DOCKED_DISTANCE_M and abs(turned) <= DOCKED_ANGLE
