"""Protocol of drives, which move the robot along a path, and angles of the robot's flippers."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

from argo_env.navigation.path import Path
from argo_env.robot.pose import BodyPose


class DriveStatus(StrEnum):
    """Status of a drive after a step."""

    MOVING = "moving"
    ARRIVED = "arrived"
    FAILED = "failed"


class Trouble(StrEnum):
    """Kind of fault of the drive while the robot follows a path."""

    SLIPPING = "slipping"
    STUCK = "stuck"
    TIPPED = "tipped over"


@dataclass(frozen=True)
class Incident:
    """Fault of the drive that occurred, with details and the robot's pose."""

    trouble: Trouble
    detail: str
    pose: BodyPose


class Drive(Protocol):
    """Protocol of a drive, which moves the robot along paths.

    A drive may compute poses, or forces that make the world move the robot.
    """

    name: str
    time_step: float
    """s of simulated time that one step takes"""

    @property
    def pose(self) -> BodyPose:
        """Present pose of the robot."""
        ...

    @property
    def failure(self) -> str | None:
        """Description of why the drive can't go on, after `step` returned FAILED; else None."""
        ...

    @property
    def incidents(self) -> Sequence[Incident]:
        """Faults of the drive since the last `place_robot`, even if the robot could continue."""
        ...

    def place_robot(self, pose: BodyPose) -> None:
        """Put the robot at the pose, at rest, without driving there; discard the path."""
        ...

    def follow(self, path: Path, velocity: float | None) -> None:
        """Start to follow `path`, which begins where the robot is.

        `velocity` (m/s) is the planned speed on the flat; None means the robot's own speed.
        """
        ...

    def step(self) -> DriveStatus:
        """Continue on the path for one time step, and return the status after it."""
        ...

    def halt(self) -> None:
        """Stop, and discard the path.

        The steps that follow return MOVING while the robot comes to rest, then ARRIVED.
        """
        ...


RAISED = math.radians(30.0)
"""angle of the flippers on the flat, in rad, tips up"""
FLAT = 0.0
"""angle of the flippers on a flight, in rad"""
FLIPPER_RATE = math.radians(110.0)
"""speed of the flippers in rad/s (public model files of the taurob tracker)"""
