"""Drives that follow a timetable without forces: their base class and the route drive.

The route drive computes the robot's pose along the path from travel times only.
"""

import math
from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.model import Pose
from argo_env.drives.drive import DriveStatus, Incident
from argo_env.drives.timetable import Timetable, count_steps
from argo_env.navigation.path import Motion, Path, wrap
from argo_env.robot.pose import BodyPose, PoseArray, PoseTuple
from argo_env.robot.spec import RobotSpec

_SAME_POSITION = 1e-3  # m


class TimedDrive(ABC):
    """Base of drives that follow a timetable exactly, without faults.

    It holds the pose, the timetable of the path and the steps made on it. Subclasses compute the
    robot's pose at a point of the path.
    """

    def __init__(self, robot: RobotSpec, time_step: float) -> None:
        self.time_step = time_step
        self._robot = robot
        self._pose = BodyPose(0.0, 0.0, 0.0, 0.0)
        self._timetable: Timetable | None = None
        self._steps = 0

    @property
    def pose(self) -> BodyPose:
        return self._pose

    @property
    def failure(self) -> str | None:
        return None

    @property
    def incidents(self) -> tuple[Incident, ...]:
        return ()

    def place_robot(self, pose: BodyPose) -> None:
        """Put the robot at the pose, at rest, without driving there; discard the path."""
        self.halt()
        self._pose = pose

    def follow(self, path: Path, velocity: float | None) -> None:
        """Start to follow `path` at `velocity` (m/s) on the flat, or at the robot's own speeds."""
        self._timetable = Timetable(
            path_with_initial_shift(path, self._pose), self._robot, velocity
        )
        self._steps = 0

    def halt(self) -> None:
        """Stop at the present pose, and discard the path."""
        self._timetable = None

    def step(self) -> DriveStatus:
        """Move along the path for one time step, which may span several motions."""
        if self._timetable is None:
            return DriveStatus.ARRIVED
        self._steps += 1
        arrived = self._steps >= count_steps(self._timetable.duration, self.time_step)
        progress = self._timetable.motion_and_share_at(
            math.inf if arrived else self._steps * self.time_step
        )
        if progress is not None:
            self._pose = self._pose_at(*progress)
        if not arrived:
            return DriveStatus.MOVING
        self.halt()
        return DriveStatus.ARRIVED

    @property
    def steps_left_before_arrival(self) -> int:
        """Number of time steps before the one in which the robot arrives; 0 without a path."""
        if self._timetable is None:
            return 0
        return max(0, count_steps(self._timetable.duration, self.time_step) - self._steps - 1)

    @property
    @abstractmethod
    def can_batch_steps(self) -> bool:
        """True if the robot can touch nothing where it is now: steps can be made in batches."""

    def _times_ahead(self, count: int) -> NDArray[np.float64]:
        """Return the time (s) since the start of the path after each of the next `count` steps."""
        steps = np.arange(self._steps + 1, self._steps + count + 1, dtype=np.float64)
        return steps * self.time_step

    @abstractmethod
    def poses_ahead(self, limit: int) -> PoseArray:
        """Return the poses after each of the next steps, up to `limit` of them, shape (n, 5).

        `limit` is at most `steps_left_before_arrival`. The poses equal those that `step` would lead
        to, to the last bit. There are fewer than `limit` if the robot might touch something on its
        path, or has to move its flippers.
        """

    def skip_to(self, pose: PoseTuple, count: int) -> None:
        """Count `count` steps as made, and set the robot to the pose after them."""
        self._steps += count
        self._pose = BodyPose(*pose)

    @abstractmethod
    def _pose_at(self, motion: Motion, share: float) -> BodyPose:
        """Return the robot's pose when a share, 0 to 1, of the motion is done."""


def path_with_initial_shift(path: Path, pose: BodyPose) -> Path:
    """Return the path, with a straight shift from the robot's pose to the path's start if needed.

    Paths begin at a state of the navigator's lattice. A robot that was stopped may be some
    centimetres away from it, at most the navigator's SNAP_DISTANCE. A tracked robot could not shift
    sideways.
    """
    start = path.start
    if math.dist((start.x, start.y), (pose.x, pose.y)) < _SAME_POSITION:
        return path
    here = Pose(x=pose.x, y=pose.y, z=pose.z, yaw=start.yaw)
    return Path(here, (Motion(here, start), *path.motions))


class RouteDrive(TimedDrive):
    """Drive that follows paths by the timetable, without a simulated world.

    It takes as long as the kinematic drive, and as the analysis of missions states. Height and
    pitch are those of the straight motions; contacts are not checked.
    """

    name = "route"

    def __init__(self, robot: RobotSpec, time_step: float = 0.1) -> None:
        super().__init__(robot, time_step)

    @property
    def can_batch_steps(self) -> bool:
        return True

    def poses_ahead(self, limit: int) -> PoseArray:
        assert self._timetable is not None
        poses, first = np.empty((limit, 5)), 0
        for motion, share in self._timetable.iter_motions_and_shares_at(self._times_ahead(limit)):
            rows = poses[first : first + len(share)]
            for column, values in enumerate(motion.coordinates_at(share)):
                rows[:, column] = values
            rows[:, 4] = np.where(share < 1.0, self._pitch(motion), 0.0)
            first += len(share)
        return poses

    def _pose_at(self, motion: Motion, share: float) -> BodyPose:
        a, b = motion.start, motion.end
        return BodyPose(
            a.x + share * (b.x - a.x),
            a.y + share * (b.y - a.y),
            a.z + share * (b.z - a.z),
            wrap(a.yaw + share * motion.turn),
            self._pitch(motion) if share < 1.0 else 0.0,
        )

    @staticmethod
    def _pitch(motion: Motion) -> float:
        """Return the pitch (rad, positive with the front down) while the robot is on the motion."""
        if not motion.on_stairs:
            return 0.0
        return motion.gear * math.asin((motion.start.z - motion.end.z) / motion.length)
