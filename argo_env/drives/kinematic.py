"""The kinematic drive: the robot follows its path on the surface at the planned speeds.

How it rests on the ground is quasi-static: a rigid track with the centre of mass above its middle
rests on that edge of the ground's upper hull that spans the middle. On a flight that edge joins two
nosings, so the pitch is the flight's slope; past the last nosing the robot tips onto the landing.
The flippers ease that in reality, so height and pitch are averaged over a short way.
"""

import math
import struct
from collections.abc import Iterator
from functools import lru_cache
from itertools import takewhile

import numpy as np
from numpy.typing import NDArray

from argo_env.closing import NonCopyable
from argo_env.drives.drive import FLAT, RAISED, RATE, DriveStatus
from argo_env.drives.timed_drive import TimedDrive
from argo_env.navigation.path import Motion, wrap
from argo_env.robot.pose import BodyPose, Place, Places
from argo_env.robot.spec import RobotSpec
from argo_env.site.shapes import Element
from argo_env.world.world import World

STEP = 0.05  # m between the places along a path where the support is found
_EASING = 0.3  # m over which height and pitch are averaged
_PROBE_SPACING = 0.03  # m along a track
_PROBE_HEIGHT = 0.5  # m above the path from where the ground is looked for
_DEPTH = 2.0  # m below that the probes end
_SITES = 4  # whose ground is remembered
_MOTIONS = 2000  # on each; one takes some 5 kB


def resting(
    offsets: NDArray[np.float64], heights: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Height at the middle (m) and slope (dz/ds) of the hull edges over the middle.

    `offsets`, shape (k,), are places along the track on both sides of 0, not 0; `heights`, shape
    (n, k), the ground there. Of all lines through a point behind and a point ahead of the middle
    the one that is highest at the middle lies above all other points.
    """
    behind, ahead = offsets < 0, offsets > 0
    s_b, s_a = offsets[behind][:, None], offsets[ahead][None, :]
    h_b, h_a = heights[:, behind][:, :, None], heights[:, ahead][:, None, :]
    slope = (h_a - h_b) / (s_a - s_b)
    middle = (h_b - slope * s_b).reshape(len(heights), -1)
    best = np.argmax(middle, axis=1)
    rows = np.arange(len(heights))
    return middle[rows, best], slope.reshape(len(heights), -1)[rows, best]


def resting_poses(world: World, motion: Motion, robot: RobotSpec) -> list[BodyPose]:
    """The body's poses along a motion, evenly spaced from start to end, at most STEP apart."""
    count = 2 + int(motion.length / STEP) if motion.length else 2
    share = np.linspace(0.0, 1.0, count)
    a, b = motion.start, motion.end
    x, y = a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)
    yaw = a.yaw + share * motion.turn
    guess = a.z + share * (b.z - a.z)
    half = robot.track_length / 2
    # An even number, so that there is none below the middle, where any slope would do.
    offsets = np.linspace(-half, half, 2 * round(half / _PROBE_SPACING))
    sides = np.array([-robot.track_gauge / 2, robot.track_gauge / 2])
    along, left = (g.ravel() for g in np.meshgrid(offsets, sides, indexing="ij"))
    cos, sin = np.cos(yaw)[:, None], np.sin(yaw)[:, None]
    points = np.stack(
        [x[:, None] + along * cos - left * sin, y[:, None] + along * sin + left * cos], axis=-1
    )
    above = np.repeat(guess + _PROBE_HEIGHT, len(along))
    heights = world.heights(points.reshape(-1, 2), above).reshape(count, len(offsets), 2)
    z, slope = resting(offsets, heights.max(axis=2))
    pitch = -np.arctan(slope)
    if motion.length:
        window = max(1, round(_EASING / STEP)) | 1
        # Over the last nosing the mean lies below the ground; there nothing is eased.
        z, pitch = np.maximum(z, _averaged(z, window)), _averaged(pitch, window)
    return [
        BodyPose(*values)
        for values in zip(
            x.tolist(), y.tolist(), z.tolist(), yaw.tolist(), pitch.tolist(), strict=True
        )
    ]


def _averaged(values: NDArray[np.float64], window: int) -> NDArray[np.float64]:
    """Moving average over an odd window, narrower towards the ends, which keep their values: so
    one motion goes on where the one before it ended."""
    k = np.arange(len(values))
    half = np.minimum(window // 2, np.minimum(k, k[::-1]))
    sums = np.concatenate([[0.0], np.cumsum(values)])
    return np.asarray((sums[k + half + 1] - sums[k - half]) / (2 * half + 1))


class GroundMemory:
    """How the robot rests along motions, remembered for the next run: runs go the same ways again
    and again, and the probes are much of what one takes. Only where nothing that moves is near."""

    def __init__(self) -> None:
        self._known: dict[bytes, list[BodyPose]] = {}

    def resting_poses(self, world: World, motion: Motion, robot: RobotSpec) -> list[BodyPose]:
        """As the function of this name. The list is shared: it must not be changed."""
        a, b = motion.start, motion.end
        around = math.hypot(robot.track_length, robot.track_gauge) / 2
        low = min(a.x, b.x) - around, min(a.y, b.y) - around, min(a.z, b.z) - _DEPTH
        high = max(a.x, b.x) + around, max(a.y, b.y) + around, max(a.z, b.z) + _PROBE_HEIGHT
        if not world.has_only_solids_between(low, high):
            return resting_poses(world, motion, robot)
        # To the bit: zeros have signs.
        key = struct.pack("9d", a.x, a.y, a.z, a.yaw, b.x, b.y, b.z, b.yaw, motion.turn)
        poses = self._known.get(key)
        if poses is None:
            poses = resting_poses(world, motion, robot)
            if len(self._known) >= _MOTIONS:
                self._known.clear()
            self._known[key] = poses
        return poses


@lru_cache(maxsize=_SITES)
def ground_memory(
    solids: tuple[Element, ...],  # noqa: ARG001
    track_length: float,  # noqa: ARG001
    track_gauge: float,  # noqa: ARG001
) -> GroundMemory:
    """The memory of the ground that these solids make, for robots with such tracks (m)."""
    return GroundMemory()


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
