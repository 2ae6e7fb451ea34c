"""The drive with what can stop it: an emergency stop, a dysfunction."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_env.drives.blocked_way import PATIENCE, first_still, has_moved
from argo_env.drives.drive import Drive, DriveStatus, Incident
from argo_env.drives.timed_drive import TimedDrive, from_here
from argo_env.navigation.path import Path
from argo_env.robot.pose import BodyPose, Place, Places, place_of

_SLOWEST = 0.02  # share of the speed below which a robot may be taken for a stalled one


@dataclass(frozen=True, eq=False)
class StepsAhead:
    """The next steps, none of which has been made."""

    places: Places
    """where the robot is after each of them"""
    made: NDArray[np.int64]
    """how many steps the drive has made by then, shape (n,)"""


_NO_STEPS = StepsAhead(np.empty((0, 5)), np.empty(0, dtype=np.int64))


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

    @property
    def glides(self) -> bool:
        """Whether nothing can happen to the robot where it is, so that many steps can be made at
        once."""
        return isinstance(self._drive, TimedDrive) and self._drive.glides

    def steps_ahead(self, most: int) -> StepsAhead:
        """The next steps, as far as the robot is held or surely moves on, and nothing can happen to
        it: at most so many."""
        drive = self._drive
        if self.way is None or not isinstance(drive, TimedDrive):
            return _NO_STEPS
        here = np.array([_place(drive.pose)])
        if self.pressed:
            return StepsAhead(here.repeat(most, axis=0), np.zeros(most, dtype=np.int64))
        if self.share < _SLOWEST or self._before is None:
            return _NO_STEPS
        made = self._drives_steps(most, drive.steps_left)
        places = drive.places_ahead(int(made[-1]) if len(made) else 0)
        made = made[: np.searchsorted(made, first_still(_place(self._before), places))]
        if not self._makes_every_step:
            places = np.concatenate([here, places])[made]
        return StepsAhead(places[: len(made)], made)

    def go_on(self, ahead: StepsAhead, done: int, count: int) -> None:
        """Makes so many of the steps ahead, after those that were done."""
        if self.pressed:
            self.held += count
            return
        drive = self._drive
        assert isinstance(drive, TimedDrive)
        first = int(ahead.made[done - 1]) if done else 0
        last = done + count - 1
        made = int(ahead.made[last])
        if self._makes_every_step:
            self._still = 0.0
        else:
            before = first
            for by_then in ahead.made[done : done + count].tolist():
                self._credit += self.share
                if by_then > before:
                    self._credit -= 1.0
                    before, self._still = by_then, 0.0
                else:
                    self._still += self.time_step
        drive.go_to(place_of(ahead.places, last), made - first)
        if made > first:
            self._before = drive.pose

    @property
    def _makes_every_step(self) -> bool:
        """Whether the drive is not slowed, and makes as many steps as there are."""
        return self.share == 1.0 and not self._credit

    def _drives_steps(self, most: int, left: int) -> NDArray[np.int64]:
        """How many steps the drive has made after each of the next ones, up to those left."""
        if self._makes_every_step:
            return np.arange(1, min(most, left) + 1)
        made, counts, credit = 0, [], self._credit
        for _ in range(most):
            credit += self.share
            if credit >= 1.0 - 1e-9:
                credit -= 1.0
                made += 1
            if made > left:
                break
            counts.append(made)
        return np.array(counts, dtype=np.int64)

    def _stalled(self) -> DriveStatus:
        """MOVING, or FAILED if the robot should have moved for long and has not."""
        here, before = self._drive.pose, self._before
        moved = before is None or has_moved(_place(before), _place(here))
        if moved:
            self._before, self._still = here, 0.0
        elif self.way is not None:
            self._still += self.time_step
            if self._still >= PATIENCE:
                self._failure = f"the robot has not moved for {PATIENCE:.0f} s"
                return DriveStatus.FAILED
        return DriveStatus.MOVING


def _place(pose: BodyPose) -> Place:
    return pose.x, pose.y, pose.z, pose.yaw, pose.pitch
