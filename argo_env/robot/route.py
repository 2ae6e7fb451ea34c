"""The route drive: travel times only. The robot is at its place along the path by time."""

import math

from argo_env.navigation.path import Motion, Path, wrap
from argo_env.robot.drive import DriveStatus, Incident
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import RobotSpec
from argo_env.robot.timetable import Timetable, steps


class RouteDrive:
    """Follows paths by the timetable, without a world below. Holds the path and the time on it.

    It takes as long as the kinematic drive, and as the analysis of missions says. Height and pitch
    are those of the straight motions; whether the robot touches anything, nobody asks.
    """

    name = "route"

    def __init__(self, robot: RobotSpec, time_step: float = 0.1) -> None:
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
        self._timetable = Timetable(path, self._robot, velocity)
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
        t = math.inf if arrived else self._steps * self.time_step
        place = self._timetable.at(t)
        if place is not None:
            self._pose = _pose(*place)
        if arrived:
            self.halt()
            return DriveStatus.ARRIVED
        return DriveStatus.MOVING


def _pose(motion: Motion, share: float) -> BodyPose:
    a, b = motion.start, motion.end
    climb = motion.gear * math.asin((a.z - b.z) / motion.length) if motion.on_stairs else 0.0
    return BodyPose(
        a.x + share * (b.x - a.x),
        a.y + share * (b.y - a.y),
        a.z + share * (b.z - a.z),
        wrap(a.yaw + share * motion.turn),
        climb if share < 1.0 else 0.0,
    )
