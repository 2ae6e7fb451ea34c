"""What every sensor can do: read a checkpoint from where the robot stands."""

from dataclasses import dataclass
from typing import Protocol

from argo_env.robot.pose import BodyPose


@dataclass(frozen=True)
class Measurement:
    """A value in the checkpoint's unit, the distance (m) that it was read from, and how sure the
    sensor is of it (0 to 1)."""

    value: float
    distance: float
    confidence: float = 1.0


class MeasurementError(Exception):
    """The checkpoint could not be read; the message says why."""


class PoorViewError(MeasurementError):
    """It could not be read from there, but perhaps from elsewhere."""


class Sensor(Protocol):
    """Reads checkpoints."""

    name: str

    def measure(self, checkpoint_id: int, pose: BodyPose) -> Measurement:
        """Reads the checkpoint with the robot at `pose`, its arm raised.

        Raises MeasurementError if that is not possible from there, NotFound for an unknown id.
        """
        ...
