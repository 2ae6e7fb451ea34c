"""Drives that go by a timetable and know no forces: what they share, and the route drive, which
puts the robot at its place along the path by travel times only."""

import math
from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.model import Pose
from argo_env.drives.drive import DriveStatus, Incident
from argo_env.drives.timetable import Timetable, steps
from argo_env.navigation.path import Motion, Path, wrap
from argo_env.robot.pose import BodyPose, Place, Places
from argo_env.robot.spec import RobotSpec

_SAME_PLACE = 1e-3  # m


class TimedDrive(ABC):
    """Is where the timetable says, and nothing goes wrong. Holds the pose, the path and the time
    on it; how the robot stands at a place of the path, the drives that build on it say."""

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

    def place(self, pose: BodyPose) -> None:
        """Puts the robot there, at rest."""
        self.halt()
        self._pose = pose

    def begin(self, path: Path, velocity: float | None) -> None:
        """Sets off along `path` at `velocity` (m/s) on the flat, or at the robot's own speeds."""
        self._timetable = Timetable(from_here(path, self._pose), self._robot, velocity)
        self._steps = 0

    def halt(self) -> None:
        """Stops where it is and forgets the path."""
        self._timetable = None

    def step(self) -> DriveStatus:
        """Moves along the path for one time step, over as many motions as that takes."""
        if self._timetable is None:
            return DriveStatus.ARRIVED
        self._steps += 1
        arrived = self._steps >= steps(self._timetable.duration, self.time_step)
        place = self._timetable.at(math.inf if arrived else self._steps * self.time_step)
        if place is not None:
            self._pose = self._pose_at(*place)
        if not arrived:
            return DriveStatus.MOVING
        self.halt()
        return DriveStatus.ARRIVED

    @property
    def steps_left(self) -> int:
        """Time steps before the one with which it arrives; 0 without a path."""
        if self._timetable is None:
            return 0
        return max(0, steps(self._timetable.duration, self.time_step) - self._steps - 1)

    @property
    @abstractmethod
    def glides(self) -> bool:
        """Whether nothing can happen to it where it is, so that many steps can be made at once."""

    def _times_ahead(self, count: int) -> NDArray[np.float64]:
        """s on the path after each of the next so many steps."""
        steps = np.arange(self._steps + 1, self._steps + count + 1, dtype=np.float64)
        return steps * self.time_step

    @abstractmethod
    def places_ahead(self, count: int) -> Places:
        """Where it is after each of the next so many steps, at most `steps_left`: what `step` would
        make of them one by one, to the last bit. Fewer where something can happen to it."""

    def go_to(self, place: Place, count: int) -> None:
        """So many steps have passed, after which it is at `place`."""
        self._steps += count
        self._pose = BodyPose(*place)

    @abstractmethod
    def _pose_at(self, motion: Motion, share: float) -> BodyPose:
        """How the robot stands after `share` of the motion, 0 to 1."""


def from_here(path: Path, pose: BodyPose) -> Path:
    """The path, with a straight shift to its start if that is beside a robot at `pose`: paths begin
    where the navigator's lattice has a state, some centimetres from a robot that was stopped, and
    at most the navigator's SNAP_DISTANCE. No tracked robot could shift sideways."""
    start = path.start
    if math.dist((start.x, start.y), (pose.x, pose.y)) < _SAME_PLACE:
        return path
    here = Pose(x=pose.x, y=pose.y, z=pose.z, yaw=start.yaw)
    return Path(here, (Motion(here, start), *path.motions))


class RouteDrive(TimedDrive):
    """Follows paths by the timetable, without a world below.

    It takes as long as the kinematic drive, and as the analysis of missions says. Height and pitch
    are those of the straight motions; whether the robot touches anything, nobody asks.
    """

    name = "route"

    def __init__(self, robot: RobotSpec, time_step: float = 0.1) -> None:
        super().__init__(robot, time_step)

    @property
    def glides(self) -> bool:
        return True

    def places_ahead(self, count: int) -> Places:
        assert self._timetable is not None
        places, first = np.empty((count, 5)), 0
        for motion, share in self._timetable.stretches(self._times_ahead(count)):
            rows = places[first : first + len(share)]
            for column, values in enumerate(motion.along(share)):
                rows[:, column] = values
            rows[:, 4] = np.where(share < 1.0, self._pitch(motion), 0.0)
            first += len(share)
        return places

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
        """rad, while it is under way on the motion."""
        if not motion.on_stairs:
            return 0.0
        return motion.gear * math.asin((motion.start.z - motion.end.z) / motion.length)
