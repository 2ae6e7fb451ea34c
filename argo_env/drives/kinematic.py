"""The kinematic drive: the robot follows its path on the surface at the planned speeds."""

from collections.abc import Iterator
from itertools import takewhile

import numpy as np

from argo_env.closing import NonCopyable
from argo_env.drives.drive import DriveStatus
from argo_env.drives.flipper_motion import FLAT, RAISED, RATE
from argo_env.drives.support import ground_memory
from argo_env.drives.timed_drive import TimedDrive
from argo_env.navigation.path import Motion, wrap
from argo_env.robot.pose import BodyPose, Place, Places
from argo_env.robot.spec import RobotSpec
from argo_env.world.world import World

_AT_ONCE = 100  # steps ahead that are looked at: something is near before long


class KinematicDrive(NonCopyable, TimedDrive):
    """Follows paths by the timetable, without forces, and shows the robot in the world.

    Height and pitch come from how the tracks rest on the geometry; nothing stops the robot from
    overlapping with the site, so whoever runs it looks at `World.touches`.
    """

    name = "kinematic"

    def __init__(self, world: World, robot: RobotSpec, time_step: float = 0.1) -> None:
        super().__init__(robot, time_step)
        self._world = world
        self._ground = ground_memory(world.solids, robot.track_length, robot.track_gauge)
        self._flippers = RAISED
        self._motion: Motion | None = None
        self._poses: list[BodyPose] = []  # along the motion

    def place(self, pose: BodyPose) -> None:
        """Puts the robot there, at rest."""
        super().place(pose)
        self._show()

    def halt(self) -> None:
        """Stops where it is and forgets the path."""
        super().halt()
        self._motion = None

    def step(self) -> DriveStatus:
        """Moves along the path for one time step, over as many motions as that takes."""
        status = super().step()
        self._move_flippers()
        self._show()
        return status

    @property
    def glides(self) -> bool:
        return self._world.stays_clear(self._pose)

    def places_ahead(self, count: int) -> Places:
        clear = takewhile(self._world.stays_clear, self._poses_ahead(min(count, _AT_ONCE)))
        places = [(pose.x, pose.y, pose.z, pose.yaw, pose.pitch) for pose in clear]
        return np.array(places).reshape(-1, 5)

    def _poses_ahead(self, count: int) -> Iterator[BodyPose]:
        """How it stands after each of the next so many steps, until its flippers move."""
        assert self._timetable is not None
        for motion, shares in self._timetable.stretches(self._times_ahead(count)):
            if self._flippers != _flippers_on(motion):
                return
            for share in shares.tolist():
                yield self._pose_at(motion, share)

    def go_to(self, place: Place, count: int) -> None:
        super().go_to(place, count)
        self._show()

    def _pose_at(self, motion: Motion, share: float) -> BodyPose:
        if motion is not self._motion:
            self._motion = motion
            self._poses = self._ground.resting_poses(self._world, motion, self._robot)
        return _interpolated(self._poses, share)

    def _move_flippers(self) -> None:
        wanted = _flippers_on(self._motion) if self._motion else RAISED
        most = RATE * self.time_step
        self._flippers += min(most, max(-most, wanted - self._flippers))

    def _show(self) -> None:
        self._world.place_robot(self._pose)
        self._world.set_joints(
            {"left_flipper_joint": self._flippers, "right_flipper_joint": self._flippers}
        )


def _flippers_on(motion: Motion) -> float:
    """Where the flippers belong (rad) on a motion."""
    return FLAT if motion.on_stairs else RAISED


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
