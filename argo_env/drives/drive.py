"""The protocol of drives, which move the robot along a path, its flippers raised or flat."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

from argo_env.navigation.path import Path
from argo_env.robot.pose import BodyPose


class DriveStatus(StrEnum):
    """How a drive stands after a step."""

    MOVING = "moving"
    ARRIVED = "arrived"
    FAILED = "failed"


class Trouble(StrEnum):
    """What can go wrong on the way."""

    SLIPPING = "slipping"
    STUCK = "stuck"
    TIPPED = "tipped over"


@dataclass(frozen=True)
class Incident:
    """Something that went wrong, and where."""

    trouble: Trouble
    detail: str
    pose: BodyPose


class Drive(Protocol):
    """Moves the robot. A drive may compute poses, or forces that make the world move it."""

    name: str
    time_step: float
    """s of simulated time that one step takes"""

    @property
    def pose(self) -> BodyPose:
        """Where the robot is now."""
        ...

    @property
    def failure(self) -> str | None:
        """After FAILED: what happened, in words."""
        ...

    @property
    def incidents(self) -> Sequence[Incident]:
        """What went wrong since the robot was placed, whether it went on or not."""
        ...

    def place(self, pose: BodyPose) -> None:
        """Puts the robot there, at rest."""
        ...

    def begin(self, path: Path, velocity: float | None) -> None:
        """Sets off along `path`, which begins where the robot is; `velocity` (m/s) is that of the
        plan on the flat, None the robot's own."""
        ...

    def step(self) -> DriveStatus:
        """Goes on for one time step."""
        ...

    def halt(self) -> None:
        """Stops and forgets the path. The steps that follow say MOVING while the robot comes to
        rest, then ARRIVED."""
        ...


RAISED = math.radians(30.0)
"""rad, of the flippers, tips up: on the flat"""
FLAT = 0.0
"""rad, of the flippers: on a flight"""
RATE = math.radians(110.0)
"""rad/s, of the flippers (public model files of the taurob tracker)"""
