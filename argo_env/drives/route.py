"""The route drive: travel times only. The robot is at its place along the path by time."""

import math

from argo_env.drives.timed_drive import TimedDrive
from argo_env.navigation.path import Motion, wrap
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import RobotSpec


class RouteDrive(TimedDrive):
    """Follows paths by the timetable, without a world below.

    It takes as long as the kinematic drive, and as the analysis of missions says. Height and pitch
    are those of the straight motions; whether the robot touches anything, nobody asks.
    """

    name = "route"

    def __init__(self, robot: RobotSpec, time_step: float = 0.1) -> None:
        super().__init__(robot, time_step)

    def _pose_at(self, motion: Motion, share: float) -> BodyPose:
        a, b = motion.start, motion.end
        climb = motion.gear * math.asin((a.z - b.z) / motion.length) if motion.on_stairs else 0.0
        return BodyPose(
            a.x + share * (b.x - a.x),
            a.y + share * (b.y - a.y),
            a.z + share * (b.z - a.z),
            wrap(a.yaw + share * motion.turn),
            climb if share < 1.0 else 0.0,
        )
