"""What stands in a rig for the parts of a robot that is somewhere else."""

from collections.abc import Sequence
from typing import NoReturn

from argo_env.drives.drive import DriveStatus, Incident
from argo_env.navigation.path import Path
from argo_env.robot.pose import BodyPose
from argo_env.sensing.sensor import Measurement, MeasurementError


class ToldDrive:
    """Is where the robot told that it is. Nobody here can move it but by an order."""

    name = "remote"
    failure: str | None = None
    incidents: Sequence[Incident] = ()

    def __init__(self, time_step: float, pose: BodyPose) -> None:
        self.time_step = time_step
        self.pose = pose

    def place(self, pose: BodyPose) -> None:
        """A robot that is somewhere else stays where it is."""

    def begin(self, path: Path, velocity: float | None) -> NoReturn:
        raise NotImplementedError("a remote robot plans its own paths")

    def step(self) -> DriveStatus:
        return DriveStatus.ARRIVED

    def halt(self) -> None:
        """Orders do that."""


class ToldSensor:
    """Reads nothing here: the robot tells what it reads."""

    name = "remote"

    def measure(self, checkpoint_id: int, pose: BodyPose) -> Measurement:  # noqa: ARG002
        raise MeasurementError("a remote robot reads checkpoints itself")


class ToldPower:
    """The battery, as the robot told."""

    charge: float | None = None
    charging = False

    @property
    def empty(self) -> bool:
        return self.charge is not None and self.charge <= 0.0
