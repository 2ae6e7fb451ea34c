"""The pose of the robot's body in the world."""

from dataclasses import dataclass


@dataclass(frozen=True)
class BodyPose:
    """Where the robot's origin is, on the ground between its tracks (m), and its attitude (rad).

    Pitch is positive with the front down, as a turn about the robot's y axis.
    """

    x: float
    y: float
    z: float
    yaw: float
    pitch: float = 0.0
