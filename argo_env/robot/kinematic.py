"""The kinematic drive: the robot follows its path on the surface at the planned speeds."""

import math

from argo_env.navigation.path import Motion, Path, wrap
from argo_env.robot.drive import DriveStatus, Incident
from argo_env.robot.flipper_motion import FLAT, RAISED, RATE
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import RobotSpec
from argo_env.robot.support import resting_poses
from argo_env.robot.timetable import Timetable, steps
from argo_env.world import World


class KinematicDrive:
    """Follows paths without forces. Holds the robot's pose, its path and the time on it.

    Height and pitch come from how the tracks rest on the geometry; nothing stops the robot from
    overlapping with the site, so whoever runs it looks at `World.touches`.
    """

    name = "kinematic"

    def __init__(self, world: World, robot: RobotSpec, time_step: float = 0.1) -> None:
        self.time_step = time_step
        self._world = world
        self._robot = robot
        self._pose = BodyPose(0.0, 0.0, 0.0, 0.0)
        self._flippers = RAISED
        self._timetable: Timetable | None = None
        self._steps = 0
        self._motion: Motion | None = None
        self._poses: list[BodyPose] = []  # along the motion

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
        self._show()

    def begin(self, path: Path, velocity: float | None) -> None:
        """Sets off along `path` at `velocity` (m/s) on the flat, or at the robot's own speeds."""
        self._timetable = Timetable(path, self._robot, velocity)
        self._steps = 0

    def halt(self) -> None:
        """Stops where it is and forgets the path."""
        self._timetable, self._motion = None, None

    def step(self) -> DriveStatus:
        """Moves along the path for one time step, over as many motions as that takes."""
        if self._timetable is not None:
            self._steps += 1
            arrived = self._steps >= steps(self._timetable.duration, self.time_step)
            t = math.inf if arrived else self._steps * self.time_step
            place = self._timetable.at(t)
            if place is not None:
                self._follow(*place)
            if arrived:
                self.halt()
        self._move_flippers()
        self._show()
        return DriveStatus.ARRIVED if self._timetable is None else DriveStatus.MOVING

    def _follow(self, motion: Motion, share: float) -> None:
        if motion is not self._motion:
            self._motion = motion
            self._poses = resting_poses(self._world, motion, self._robot)
        self._pose = _interpolated(self._poses, share)

    def _move_flippers(self) -> None:
        on_stairs = self._motion is not None and self._motion.on_stairs
        wanted = FLAT if on_stairs else RAISED
        most = RATE * self.time_step
        self._flippers += min(most, max(-most, wanted - self._flippers))

    def _show(self) -> None:
        self._world.place_robot(self._pose)
        self._world.set_joints(
            {"left_flipper_joint": self._flippers, "right_flipper_joint": self._flippers}
        )


def _interpolated(poses: list[BodyPose], share: float) -> BodyPose:
    """The pose at `share` (0 to 1) of evenly spaced poses."""
    place = share * (len(poses) - 1)
    k = min(int(place), len(poses) - 2)
    a, b, w = poses[k], poses[k + 1], place - k
    return BodyPose(
        a.x + w * (b.x - a.x),
        a.y + w * (b.y - a.y),
        a.z + w * (b.z - a.z),
        wrap(a.yaw + w * (b.yaw - a.yaw)),
        a.pitch + w * (b.pitch - a.pitch),
    )
