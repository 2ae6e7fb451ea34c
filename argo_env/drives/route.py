"""The route drive: travel times only. The robot is at its place along the path by time."""

import math

import numpy as np

from argo_env.drives.timed_drive import TimedDrive
from argo_env.navigation.path import Motion, wrap
from argo_env.robot.pose import BodyPose, Places
from argo_env.robot.spec import RobotSpec


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
