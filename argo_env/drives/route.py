"""The route drive: travel times only. The robot is at its place along the path by time."""

import math

from argo_env.drives.timed_drive import TimedDrive
from argo_env.navigation.path import Motion, wrap
from argo_env.robot.pose import BodyPose, Place
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

    def places_ahead(self, count: int) -> list[Place]:
        assert self._timetable is not None
        places: list[Place] = []
        for motion, ends, duration, times in self._timetable.stretches(
            (self._steps + k) * self.time_step for k in range(1, count + 1)
        ):
            a, b, turn = motion.start, motion.end, motion.turn
            x, y, z, yaw = a.x, a.y, a.z, a.yaw
            dx, dy, dz = b.x - x, b.y - y, b.z - z
            pitch = self._pitch(motion)
            for t in times:
                share = 1.0 - (ends - t) / duration
                places.append(
                    (
                        x + share * dx,
                        y + share * dy,
                        z + share * dz,
                        wrap(yaw + share * turn),
                        pitch if share < 1.0 else 0.0,
                    )
                )
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
