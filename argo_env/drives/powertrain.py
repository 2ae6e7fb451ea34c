"""The drive with what can stop it: an emergency stop, a dysfunction."""

import math
from collections.abc import Sequence

from argo_env.drives.drive import Drive, DriveStatus, Incident
from argo_env.drives.timed_drive import from_here
from argo_env.navigation.path import Path
from argo_env.robot.pose import BodyPose

STALLED = 30.0  # s without any motion after which a way is given up
_MOVED = 1e-3  # m or rad that count as a motion


class Powertrain:
    """A drive that may be held or slowed. Holds how it stands; faults change that."""

    def __init__(self, drive: Drive, usual_share: float = 1.0) -> None:
        """`usual_share`: of its speed, that the drive makes while nothing is wrong with it."""
        self._drive = drive
        self.name = drive.name
        self.time_step = drive.time_step
        self.pressed = False
        """whether the emergency stop is pressed: brakes hold the robot where it is"""
        self.held = 0
        """steps that the emergency stop has held it"""
        self.usual_share = usual_share
        """of its speed that the drive makes while nothing is wrong with it"""
        self.share = usual_share
        """of its speed that the drive makes now"""
        self.way: tuple[Path, float | None] | None = None
        """the path that it was told to follow, from where it was, and the velocity (m/s) on it;
        None: to stand"""
        self._credit = 0.0
        self._failure: str | None = None
        self._still = 0.0
        self._before: BodyPose | None = None

    @property
    def pose(self) -> BodyPose:
        return self._drive.pose

    @property
    def failure(self) -> str | None:
        return self._failure or self._drive.failure

    @property
    def incidents(self) -> Sequence[Incident]:
        return self._drive.incidents

    def place(self, pose: BodyPose) -> None:
        """Puts the robot there, at rest."""
        self.way = None
        self._drive.place(pose)

    def begin(self, path: Path, velocity: float | None) -> None:
        """Sets off along `path`, when it can."""
        self.way = from_here(path, self._drive.pose), velocity
        self._credit, self._still, self._failure = 0.0, 0.0, None
        self._drive.begin(path, velocity)

    def halt(self) -> None:
        """Stops and forgets the path."""
        self.way = None
        self._drive.halt()

    def step(self) -> DriveStatus:
        """Goes on for one time step; a robot that is slowed makes fewer of the drive's steps."""
        if self.pressed:
            self.held += 1
            return DriveStatus.ARRIVED if self.way is None else DriveStatus.MOVING
        if self.way is not None:
            self._credit += self.share
            if self._credit < 1.0 - 1e-9:
                return self._stalled()
            self._credit -= 1.0
        status = self._drive.step()
        if status is DriveStatus.ARRIVED:
            self.way = None
        return self._stalled() if status is DriveStatus.MOVING else status

    def _stalled(self) -> DriveStatus:
        """MOVING, or FAILED if the robot should have moved for long and has not."""
        here, before = self._drive.pose, self._before
        moved = before is None or (
            math.dist((here.x, here.y, here.z), (before.x, before.y, before.z)) > _MOVED
            or abs(here.yaw - before.yaw) > _MOVED
        )
        if moved:
            self._before, self._still = here, 0.0
        elif self.way is not None:
            self._still += self.time_step
            if self._still >= STALLED:
                self._failure = f"the robot has not moved for {STALLED:.0f} s"
                return DriveStatus.FAILED
        return DriveStatus.MOVING
