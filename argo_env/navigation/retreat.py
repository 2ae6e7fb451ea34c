"""The way back along which the robot came, where it can't turn any more."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from argo_compiler.base.model import Pose
from argo_env.navigation.path import Motion, Path, merge, wrap
from argo_env.navigation.smoothing import connect, turn

_SPACING = 0.05  # m or rad between the places of a way that are compared with the robot's
_RADIAN = 0.3  # m that a radian counts as in this
_STRIDE = 0.05  # m between places that are enough to tell where a way led
_STEEP = 0.2  # m of height in a metre, from which on it is a stair


def recent(places: Iterable[Pose], length: float) -> list[Pose]:
    """Of places where the robot was seen, the last one first, those of the last `length` m (a
    little more, or all that there are), the last one last."""
    found: list[Pose] = []
    for place in places:
        if found:
            length -= math.dist((place.x, place.y), (found[-1].x, found[-1].y))
        found.append(place)
        if length <= 0:
            break
    return found[::-1]


def driven(places: Sequence[Pose]) -> Path:
    """The way through places where the robot was seen one after the other (at least one), driven
    straight from each to the next; of those closer together than a stride, only the turn counts."""
    motions: list[Motion] = []
    here = places[0]
    for there in places[1:]:
        away = math.dist((there.x, there.y), (here.x, here.y))
        if away < _STRIDE:
            motions += turn(here, there.yaw)
            here = here.model_copy(update={"yaw": there.yaw})
            continue
        ahead = math.cos(math.atan2(there.y - here.y, there.x - here.x) - here.yaw) > 0
        if abs(there.z - here.z) > _STEEP * away:
            # A robot on stairs is not turned but shaken.
            there = there.model_copy(update={"yaw": here.yaw})
            motions.append(Motion(here, there, gear=1 if ahead else -1, on_stairs=True))
        elif ahead:
            motions += connect(here, there)
        else:
            motions += _backwards(here, there)
        here = there
    return Path(places[0], tuple(merge(motions)))


def _backwards(here: Pose, there: Pose) -> list[Motion]:
    """As a robot that faces the other way would drive it forwards."""
    return [
        replace(
            motion,
            start=_faced_about(motion.start),
            end=_faced_about(motion.end),
            gear=1 if motion.turn else -1,
        )
        for motion in connect(_faced_about(here), _faced_about(there))
    ]


def _faced_about(pose: Pose) -> Pose:
    return pose.model_copy(update={"yaw": wrap(pose.yaw + math.pi)})


def way_back(path: Path, pose: Pose, length: float) -> Path:
    """From where a robot at `pose` is on the path it is on, `length` m back along it, in reverse.

    It has no motions where the path begins there.
    """
    if not path.motions:
        return Path(pose, ())
    index, share = _place_on(path, pose)
    motions: list[Motion] = []
    left = length
    for k in range(index, -1, -1):
        motion = path.motions[k]
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
    """The motion backwards from one share of it to a lesser one."""
    angle = -(first - last) * motion.turn
    gear = motion.gear if motion.turn else -motion.gear
    return replace(motion, start=motion.at(first), end=motion.at(last), turn=angle, gear=gear)


def _place_on(path: Path, pose: Pose) -> tuple[int, float]:
    """The motion and the share of it at which the pose is nearest to the path."""
    best, nearest = (0, 0.0), math.inf
    for k, motion in enumerate(path.motions):
        count = 2 + int(max(motion.length, abs(motion.turn)) / _SPACING)
        for share in np.linspace(0.0, 1.0, count).tolist():
            at = motion.at(share)
            away = math.dist((at.x, at.y, at.z), (pose.x, pose.y, pose.z))
            away += _RADIAN * abs(wrap(at.yaw - pose.yaw))
            if away < nearest:
                best, nearest = (k, share), away
    return best
