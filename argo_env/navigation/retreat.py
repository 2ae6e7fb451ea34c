"""The path back along which the robot came, for where it can't turn any more."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from argo_compiler.base.model import Pose
from argo_env.navigation.path import Motion, Path, merge, wrap
from argo_env.navigation.smoothing import connecting_motions, turn_motions

_SPACING = 0.05  # m or rad between the poses of a path that are compared with the robot's
_RADIAN = 0.3  # m of distance that a radian counts as in this comparison
_STRIDE = 0.05  # m between poses, enough for the direction of the path between them
_STEEP = 0.2  # slope above which a path is on stairs


def recent_poses(poses: Iterable[Pose], length: float) -> list[Pose]:
    """Return the poses of the last `length` m of the robot's path, the latest one last.

    The earliest one is the first at which the length is reached. If the path is shorter, all poses
    are returned.

    Args:
        poses: Observed poses of the robot, the latest one first.
        length: Length of the path in m.
    """
    latest: list[Pose] = []
    for pose in poses:
        if latest:
            length -= math.dist((pose.x, pose.y), (latest[-1].x, latest[-1].y))
        latest.append(pose)
        if length <= 0:
            break
    return latest[::-1]


def path_through(poses: Sequence[Pose]) -> Path:
    """Return the path through observed poses in their order, at least one, as drives and turns.

    From a pose to one that is less than 5 cm away, there is only a turn.
    """
    motions: list[Motion] = []
    here = poses[0]
    for there in poses[1:]:
        away = math.dist((there.x, there.y), (here.x, here.y))
        if away < _STRIDE:
            motions += turn_motions(here, there.yaw)
            here = here.model_copy(update={"yaw": there.yaw})
            continue
        ahead = math.cos(math.atan2(there.y - here.y, there.x - here.x) - here.yaw) > 0
        if abs(there.z - here.z) > _STEEP * away:
            # A changed heading on stairs comes from vibration, as the robot does not turn there.
            there = there.model_copy(update={"yaw": here.yaw})
            motions.append(Motion(here, there, gear=1 if ahead else -1, on_stairs=True))
        elif ahead:
            motions += connecting_motions(here, there)
        else:
            motions += _drive_backwards(here, there)
        here = there
    return Path(poses[0], tuple(merge(motions)))


def _drive_backwards(here: Pose, there: Pose) -> list[Motion]:
    """Return the motions that drive backwards from `here` to `there`.

    They mirror those with which a robot that faces the other way would drive forwards.
    """
    return [
        replace(
            motion,
            start=_opposite_pose(motion.start),
            end=_opposite_pose(motion.end),
            gear=1 if motion.turn else -1,
        )
        for motion in connecting_motions(_opposite_pose(here), _opposite_pose(there))
    ]


def _opposite_pose(pose: Pose) -> Pose:
    return pose.model_copy(update={"yaw": wrap(pose.yaw + math.pi)})


def path_back(driven_path: Path, pose: Pose, length: float) -> Path:
    """Return the path back along `driven_path` from its pose nearest to `pose`.

    It is at most `length` m long. The motions are those of `driven_path` in reverse, so what was
    driven forwards is driven backwards. It is shorter if the start of `driven_path` is nearer, and
    without motions if it is there.
    """
    if not driven_path.motions:
        return Path(pose, ())
    index, share = _nearest_point_on(driven_path, pose)
    motions: list[Motion] = []
    left = length
    for k in range(index, -1, -1):
        motion = driven_path.motions[k]
        done = share if k == index else 1.0
        back = min(done, left / motion.length) if motion.length else done
        if back > 0.0:
            motions.append(_reversed(motion, done, done - back))
            left -= back * motion.length
        if left <= 1e-9:
            break
    start = motions[0].start if motions else pose
    return Path(start, tuple(motions))


def _reversed(motion: Motion, first: float, last: float) -> Motion:
    """Return the motion driven backwards from one share of it to a smaller one."""
    angle = -(first - last) * motion.turn
    gear = motion.gear if motion.turn else -motion.gear
    return replace(
        motion, start=motion.pose_at(first), end=motion.pose_at(last), turn=angle, gear=gear
    )


def _nearest_point_on(path: Path, pose: Pose) -> tuple[int, float]:
    """Return the index and the share of the motion where the path is nearest to the pose."""
    best, nearest = (0, 0.0), math.inf
    for k, motion in enumerate(path.motions):
        count = 2 + int(max(motion.length, abs(motion.turn)) / _SPACING)
        for share in np.linspace(0.0, 1.0, count).tolist():
            at = motion.pose_at(share)
            away = math.dist((at.x, at.y, at.z), (pose.x, pose.y, pose.z))
            away += _RADIAN * abs(wrap(at.yaw - pose.yaw))
            if away < nearest:
                best, nearest = (k, share), away
    return best
