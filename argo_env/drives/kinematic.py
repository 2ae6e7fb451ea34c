"""The kinematic drive: the robot follows its path on the surface at the planned speeds.

The resting pose is quasi-static: a rigid track with the centre of mass above its middle rests on
the edge of the ground's upper hull that spans the middle. On a flight that edge joins two nosings,
so the pitch is the flight's slope; past the last nosing the robot tips onto the landing. In
reality the flippers ease this, so height and pitch are averaged over a short distance.
"""

import math
import struct
from collections.abc import Iterator
from functools import lru_cache
from itertools import takewhile

import numpy as np
from numpy.typing import NDArray

from argo_env.closing import NonCopyable
from argo_env.drives.drive import FLAT, FLIPPER_RATE, RAISED, DriveStatus
from argo_env.drives.timed_drive import TimedDrive
from argo_env.navigation.path import Motion, wrap
from argo_env.robot.pose import BodyPose, PoseArray, PoseTuple
from argo_env.robot.spec import RobotSpec
from argo_env.site.shapes import Element
from argo_env.world.world import World

STEP = 0.05  # m between the poses along a path for which the support is computed
_EASING = 0.3  # m over which height and pitch are averaged
_PROBE_SPACING = 0.03  # m along a track
_PROBE_HEIGHT = 0.5  # m above the path, where the probes for the ground start
_DEPTH = 2.0  # m below the path, deeper than the probes reach
_SITES = 4  # with a cache of resting poses
_MOTIONS = 2000  # in the cache of a site; each takes some 5 kB


def rest_height_and_slope(
    offsets: NDArray[np.float64], heights: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the height and the slope at which a rigid track rests on each of n ground profiles.

    The height (m) is that of the track's middle, the slope is dz/ds; both have the shape (n,).
    `offsets` (m), shape (k,), are positions along the track on both sides of its middle at 0, but
    not 0; `heights` (m), shape (n, k), are those of the ground there. The track lies on an edge of
    the ground's upper hull: of all lines through a point behind and a point ahead of the middle,
    the line that is highest at the middle lies above all other points.
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
    """Return the body's poses along a motion, evenly spaced and at most STEP apart.

    They include the start and the end of the motion.
    """
    count = 2 + int(motion.length / STEP) if motion.length else 2
    share = np.linspace(0.0, 1.0, count)
    a, b = motion.start, motion.end
    x, y = a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)
    yaw = a.yaw + share * motion.turn
    guess = a.z + share * (b.z - a.z)
    half = robot.track_length / 2
    # The number is even: below the middle, where any slope would do, there is no probe.
    offsets = np.linspace(-half, half, 2 * round(half / _PROBE_SPACING))
    sides = np.array([-robot.track_gauge / 2, robot.track_gauge / 2])
    along, left = (g.ravel() for g in np.meshgrid(offsets, sides, indexing="ij"))
    cos, sin = np.cos(yaw)[:, None], np.sin(yaw)[:, None]
    points = np.stack(
        [x[:, None] + along * cos - left * sin, y[:, None] + along * sin + left * cos], axis=-1
    )
    above = np.repeat(guess + _PROBE_HEIGHT, len(along))
    heights = world.surface_or_ray_end_heights(points.reshape(-1, 2), above).reshape(
        count, len(offsets), 2
    )
    z, slope = rest_height_and_slope(offsets, heights.max(axis=2))
    pitch = -np.arctan(slope)
    if motion.length:
        window = max(1, round(_EASING / STEP)) | 1
        # Over the last nosing the mean height lies below the ground, so it is not used there.
        z, pitch = np.maximum(z, _averaged(z, window)), _averaged(pitch, window)
    return [
        BodyPose(*values)
        for values in zip(
            x.tolist(), y.tolist(), z.tolist(), yaw.tolist(), pitch.tolist(), strict=True
        )
    ]


def _averaged(values: NDArray[np.float64], window: int) -> NDArray[np.float64]:
    """Return the moving average of the values over `window` of them, an odd number.

    Towards the ends the average is over fewer values. The first and the last value stay as they
    are, so that a motion continues where the previous one ended.
    """
    k = np.arange(len(values))
    half = np.minimum(window // 2, np.minimum(k, k[::-1]))
    sums = np.concatenate([[0.0], np.cumsum(values)])
    return np.asarray((sums[k + half + 1] - sums[k - half]) / (2 * half + 1))


class RestingPoseCache:
    """Cache of the robot's resting poses along motions, for further runs.

    Runs repeat the same motions, and the probes take much of a run's time. Motions near anything
    that can move are not cached.
    """

    def __init__(self) -> None:
        self._cached: dict[bytes, list[BodyPose]] = {}

    def resting_poses(self, world: World, motion: Motion, robot: RobotSpec) -> list[BodyPose]:
        """Return the same as the function `resting_poses`; do not change the list, it is shared."""
        a, b = motion.start, motion.end
        around = math.hypot(robot.track_length, robot.track_gauge) / 2
        low = min(a.x, b.x) - around, min(a.y, b.y) - around, min(a.z, b.z) - _DEPTH
        high = max(a.x, b.x) + around, max(a.y, b.y) + around, max(a.z, b.z) + _PROBE_HEIGHT
        if not world.has_only_fixed_solids_near(low, high):
            return resting_poses(world, motion, robot)
        # The key holds the bits of the numbers, since zeros have signs.
        key = struct.pack("9d", a.x, a.y, a.z, a.yaw, b.x, b.y, b.z, b.yaw, motion.turn)
        poses = self._cached.get(key)
        if poses is None:
            poses = resting_poses(world, motion, robot)
            if len(self._cached) >= _MOTIONS:
                self._cached.clear()
            self._cached[key] = poses
        return poses


@lru_cache(maxsize=_SITES)
def resting_pose_cache(
    solids: tuple[Element, ...],  # noqa: ARG001
    track_length: float,  # noqa: ARG001
    track_gauge: float,  # noqa: ARG001
) -> RestingPoseCache:
    """Return the cache for a site with these solids and for robots with such tracks (m)."""
    return RestingPoseCache()


_LOOKAHEAD = 100  # steps ahead that are predicted at most: something is usually near sooner


class KinematicDrive(NonCopyable, TimedDrive):
    """Drive that follows paths by the timetable, without forces, and moves the robot in the world.

    Height and pitch follow from the tracks' rest on the geometry. Nothing stops the robot from
    overlapping with the site, so the caller must check `World.touches`.
    """

    name = "kinematic"

    def __init__(self, world: World, robot: RobotSpec, time_step: float = 0.1) -> None:
        super().__init__(robot, time_step)
        self._world = world
        self._cache = resting_pose_cache(world.solids, robot.track_length, robot.track_gauge)
        self._flippers = RAISED
        self._motion: Motion | None = None
        self._poses: list[BodyPose] = []  # along the motion

    def place_robot(self, pose: BodyPose) -> None:
        """Put the robot at the pose, at rest, without driving there; discard the path."""
        super().place_robot(pose)
        self._show()

    def halt(self) -> None:
        """Stop at the present pose, and discard the path."""
        super().halt()
        self._motion = None

    def step(self) -> DriveStatus:
        """Move along the path for one time step, which may span several motions."""
        status = super().step()
        self._move_flippers()
        self._show()
        return status

    @property
    def can_batch_steps(self) -> bool:
        return self._world.has_surely_no_touches_at(self._pose)

    def poses_ahead(self, limit: int) -> PoseArray:
        clear = takewhile(
            self._world.has_surely_no_touches_at, self._upcoming_poses(min(limit, _LOOKAHEAD))
        )
        poses = [(pose.x, pose.y, pose.z, pose.yaw, pose.pitch) for pose in clear]
        return np.array(poses).reshape(-1, 5)

    def _upcoming_poses(self, count: int) -> Iterator[BodyPose]:
        """Yield the pose after each of the next `count` steps, until the flippers have to move."""
        assert self._timetable is not None
        for motion, shares in self._timetable.iter_motions_and_shares_at(self._times_ahead(count)):
            if self._flippers != _flippers_on(motion):
                return
            for share in shares.tolist():
                yield self._pose_at(motion, share)

    def skip_to(self, pose: PoseTuple, count: int) -> None:
        super().skip_to(pose, count)
        self._show()

    def _pose_at(self, motion: Motion, share: float) -> BodyPose:
        if motion is not self._motion:
            self._motion = motion
            self._poses = self._cache.resting_poses(self._world, motion, self._robot)
        return _interpolated(self._poses, share)

    def _move_flippers(self) -> None:
        wanted = _flippers_on(self._motion) if self._motion else RAISED
        most = FLIPPER_RATE * self.time_step
        self._flippers += min(most, max(-most, wanted - self._flippers))

    def _show(self) -> None:
        self._world.place_robot(self._pose)
        self._world.set_joints(
            {"left_flipper_joint": self._flippers, "right_flipper_joint": self._flippers}
        )


def _flippers_on(motion: Motion) -> float:
    """Return the angle of the flippers (rad, tips up) for a motion: flat on stairs, else raised."""
    return FLAT if motion.on_stairs else RAISED


def _interpolated(poses: list[BodyPose], share: float) -> BodyPose:
    """Return the pose at a share, 0 to 1, of a sequence of evenly spaced poses."""
    position = share * (len(poses) - 1)
    k = min(int(position), len(poses) - 2)
    a, b, w = poses[k], poses[k + 1], position - k
    return BodyPose(
        a.x + w * (b.x - a.x),
        a.y + w * (b.y - a.y),
        a.z + w * (b.z - a.z),
        wrap(a.yaw + w * (b.yaw - a.yaw)),
        a.pitch + w * (b.pitch - a.pitch),
    )
