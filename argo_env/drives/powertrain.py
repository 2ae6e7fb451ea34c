"""Drive that an emergency stop or a fault of the drive can stop or slow down."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.message import Message
from argo_env.drives.drive import Drive, DriveStatus, Incident
from argo_env.drives.standstill import PATIENCE, first_motionless_step_from_1, has_moved_noticeably
from argo_env.drives.timed_drive import TimedDrive, path_with_initial_shift
from argo_env.navigation.path import Path
from argo_env.robot.pose import BodyPose, PoseArray, PoseTuple, pose_tuple_at

_SLOWEST = 0.02  # share of the speed, below which the drive may be judged to be stalled


@dataclass(frozen=True, eq=False)
class StepsAhead:
    """Predicted next steps, none of which has been made."""

    poses: PoseArray
    """pose of the robot after each step, shape (n, 5)"""
    drive_steps: NDArray[np.int64]
    """number of steps that the drive itself has made after each step, shape (n,)"""


_NO_STEPS = StepsAhead(np.empty((0, 5)), np.empty(0, dtype=np.int64))


class Powertrain:
    """Drive that an emergency stop can hold and a fault can slow down.

    It holds the drive, its path, and the state of the emergency stop and of the speed; faults
    change these two.
    """

    def __init__(self, drive: Drive, usual_speed_share: float = 1.0) -> None:
        """`usual_speed_share`: share of its normal speed that the drive reaches without a fault."""
        self._drive = drive
        self.name = drive.name
        self.time_step = drive.time_step
        self.stop_pressed = False
        """True if the emergency stop is pressed: the brakes hold the robot where it is"""
        self.held_steps = 0
        """number of steps in which the emergency stop has held the robot"""
        self.usual_speed_share = usual_speed_share
        """share of its speed that the drive reaches without a fault"""
        self.speed_share = usual_speed_share
        """share of its speed that the drive reaches now"""
        self.path_and_velocity: tuple[Path, float | None] | None = None
        """path to follow, from the robot's pose at its start, and velocity on it in m/s (None for
        the robot's own speed); the pair is None while the robot is to stand still"""
        self._credit = 0.0
        self._failure: str | None = None
        self._still_time = 0.0
        self._last_pose: BodyPose | None = None

    @property
    def pose(self) -> BodyPose:
        return self._drive.pose

    @property
    def failure(self) -> str | None:
        return self._failure or self._drive.failure

    @property
    def incidents(self) -> Sequence[Incident]:
        return self._drive.incidents

    def place_robot(self, pose: BodyPose) -> None:
        """Put the robot at the pose, at rest, without driving there; discard the path."""
        self.path_and_velocity = None
        self._drive.place_robot(pose)

    def follow(self, path: Path, velocity: float | None) -> None:
        """Start to follow `path` as soon as no emergency stop or fault holds the robot.

        `velocity` (m/s) is the planned speed on the flat; None means the robot's own speed.
        """
        self.path_and_velocity = path_with_initial_shift(path, self._drive.pose), velocity
        self._credit, self._still_time, self._failure = 0.0, 0.0, None
        self._drive.follow(path, velocity)

    def halt(self) -> None:
        """Stop, and discard the path."""
        self.path_and_velocity = None
        self._drive.halt()

    def step(self) -> DriveStatus:
        """Continue for one time step; a slowed robot makes fewer of the drive's steps."""
        if self.stop_pressed:
            self.held_steps += 1
            return DriveStatus.ARRIVED if self.path_and_velocity is None else DriveStatus.MOVING
        if self.path_and_velocity is not None:
            self._credit += self.speed_share
            if self._credit < 1.0 - 1e-9:
                return self._check_standstill()
            self._credit -= 1.0
        status = self._drive.step()
        if status is DriveStatus.ARRIVED:
            self.path_and_velocity = None
        return self._check_standstill() if status is DriveStatus.MOVING else status

    @property
    def can_batch_steps(self) -> bool:
        """True if the robot can touch nothing where it is now: steps can be made in batches."""
        return isinstance(self._drive, TimedDrive) and self._drive.can_batch_steps

    def steps_ahead(self, limit: int) -> StepsAhead:
        """Predict the next steps, up to `limit`, as far as the robot surely touches nothing.

        The emergency stop holds the robot in all of them, or the robot surely moves in all of them.
        """
        drive = self._drive
        if self.path_and_velocity is None or not isinstance(drive, TimedDrive):
            return _NO_STEPS
        here = np.array([_place(drive.pose)])
        if self.stop_pressed:
            return StepsAhead(here.repeat(limit, axis=0), np.zeros(limit, dtype=np.int64))
        if self.speed_share < _SLOWEST or self._last_pose is None:
            return _NO_STEPS
        made = self._count_drive_steps(limit, drive.steps_left_before_arrival)
        poses = drive.poses_ahead(int(made[-1]) if len(made) else 0)
        made = made[
            : np.searchsorted(made, first_motionless_step_from_1(_place(self._last_pose), poses))
        ]
        if not self._makes_every_step:
            poses = np.concatenate([here, poses])[made]
        return StepsAhead(poses[: len(made)], made)

    def make_predicted_steps(self, ahead: StepsAhead, made_before: int, count: int) -> None:
        """Make `count` of the steps of a prediction, after its first `made_before` steps.

        Earlier calls must have made those.
        """
        if self.stop_pressed:
            self.held_steps += count
            return
        drive = self._drive
        assert isinstance(drive, TimedDrive)
        first = int(ahead.drive_steps[made_before - 1]) if made_before else 0
        last = made_before + count - 1
        made = int(ahead.drive_steps[last])
        if self._makes_every_step:
            self._still_time = 0.0
        else:
            previous = first
            for drive_steps in ahead.drive_steps[made_before : made_before + count].tolist():
                self._credit += self.speed_share
                if drive_steps > previous:
                    self._credit -= 1.0
                    previous, self._still_time = drive_steps, 0.0
                else:
                    self._still_time += self.time_step
        drive.skip_to(pose_tuple_at(ahead.poses, last), made - first)
        if made > first:
            self._last_pose = drive.pose

    @property
    def _makes_every_step(self) -> bool:
        """True if the drive is not slowed: each time step is a step of the drive."""
        return self.speed_share == 1.0 and not self._credit

    def _count_drive_steps(self, limit: int, left: int) -> NDArray[np.int64]:
        """Return how many steps the drive has made after each of the next time steps.

        A slowed drive makes no step in some time steps. The result ends after `limit` time steps,
        or before the drive would make more than `left` steps.
        """
        if self._makes_every_step:
            return np.arange(1, min(limit, left) + 1)
        made, counts, credit = 0, [], self._credit
        for _ in range(limit):
            credit += self.speed_share
            if credit >= 1.0 - 1e-9:
                credit -= 1.0
                made += 1
            if made > left:
                break
            counts.append(made)
        return np.array(counts, dtype=np.int64)

    def _check_standstill(self) -> DriveStatus:
        """Return FAILED if the robot should have moved for PATIENCE s and has not, else MOVING."""
        here, before = self._drive.pose, self._last_pose
        moved = before is None or has_moved_noticeably(_place(before), _place(here))
        if moved:
            self._last_pose, self._still_time = here, 0.0
        elif self.path_and_velocity is not None:
            self._still_time += self.time_step
            if self._still_time >= PATIENCE:
                self._failure = Message(
                    "the robot has not moved for {patience:.0f} s", patience=PATIENCE
                )
                return DriveStatus.FAILED
        return DriveStatus.MOVING


def _place(pose: BodyPose) -> PoseTuple:
    return pose.x, pose.y, pose.z, pose.yaw, pose.pitch
