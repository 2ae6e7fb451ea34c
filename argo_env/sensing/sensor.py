"""Interface of the sensors that read checkpoints, with their measurements and errors."""

from dataclasses import dataclass
from typing import Protocol

from argo_env.robot.pose import BodyPose


@dataclass(frozen=True)
class Measurement:
    """Result of a successful measurement at a checkpoint."""

    value: float
    """in the checkpoint's unit"""
    distance: float
    """m, from which the value was read"""
    confidence: float = 1.0
    """0 to 1: how sure the sensor is of the value"""


class MeasurementError(Exception):
    """Raised when a checkpoint can't be read; the message states the reason."""


class PoorViewError(MeasurementError):
    """Raised when a checkpoint can't be read from this pose, but perhaps from another one."""


class Sensor(Protocol):
    """Interface of a sensor that reads checkpoints."""

    name: str

    def measure(self, checkpoint_id: int, pose: BodyPose) -> Measurement:
        """Read the checkpoint with the robot at `pose` and its arm raised.

        Raises:
            MeasurementError: the checkpoint can't be read from this pose.
            NotFound: the site has no checkpoint of this id.
        """
        ...
