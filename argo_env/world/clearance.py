"""Whether the robot is clear of all that it must not touch, told by boxes alone.

To look for contacts takes PyBullet a tenth of a millisecond. Most of the time nothing is anywhere
near, and boxes around the solids and around the robot tell that in a fraction of it.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from argo_env.navigation.path import wrap
from argo_env.robot.pose import BodyPose

TILT = 0.002  # rad of pitch and roll up to which the robot counts as level
_SPARE = 0.01  # m around all that is compared: more than the tilt makes of the robot's length
_AROUND = 1.0  # m that the robot may go until the solids near it are gathered anew
_PARTED = 0.05  # m up or down from which that is what parts two boxes


@dataclass(frozen=True, eq=False)
class SolidBounds:
    """A box, or many: lowest and highest corner (m), shape (3,) or (n, 3)."""

    low: NDArray[np.float64]
    high: NDArray[np.float64]

    @cached_property
    def middle(self) -> NDArray[np.float64]:
        return np.asarray((self.low + self.high) / 2)

    @cached_property
    def half(self) -> NDArray[np.float64]:
        """Half of the edges (m)."""
        return np.asarray((self.high - self.low) / 2)

    @staticmethod
    def around(boxes: "list[SolidBounds]") -> "SolidBounds":
        """The box around boxes."""
        low, high = [box.low for box in boxes], [box.high for box in boxes]
        return SolidBounds(np.min(low, axis=0), np.max(high, axis=0))

    def overlapping(self, box: "SolidBounds") -> NDArray[np.bool_]:
        """Which of many boxes overlap with one."""
        return np.asarray(((self.low <= box.high) & (self.high >= box.low)).all(axis=-1))

    def chosen(self, which: NDArray[np.bool_]) -> "SolidBounds":
        """Some of many boxes."""
        return SolidBounds(self.low[which], self.high[which])


@dataclass(frozen=True)
class _Found:
    """How far the robot may go from where it was found clear, and with which boxes that was."""

    pose: BodyPose
    whole: SolidBounds
    upper: SolidBounds
    level: bool
    """whether it was level, and has to be: then what it may move in the plane and upwards are told
    apart"""
    sideways: float
    """m that all of it may move in the plane; unless level, in all"""
    upwards: float
    """m up or down"""

    def holds(self, pose: BodyPose, whole: SolidBounds, upper: SolidBounds) -> bool:
        """Whether the robot can't have met anything since."""
        if self.whole is not whole or self.upper is not upper:
            return False
        before = self.pose
        turned = abs(wrap(pose.yaw - before.yaw))
        gone, risen = math.hypot(pose.x - before.x, pose.y - before.y), abs(pose.z - before.z)
        if self.level:
            near = gone + turned * self._radius < self.sideways and risen < self.upwards
            return near and _is_level(pose)
        tipped = abs(pose.pitch - before.pitch) + abs(pose.roll - before.roll)
        return gone + risen + (turned + tipped) * self._reach < self.sideways

    @cached_property
    def _radius(self) -> float:
        return _radius(self.whole)

    @cached_property
    def _reach(self) -> float:
        """m from the robot's origin to the farthest corner of its box."""
        corner = np.maximum(np.abs(self.whole.low), np.abs(self.whole.high))
        return math.hypot(*corner.tolist())


class Clearance:
    """Knows the boxes around all solids. Holds those near the robot, and how far it may go on."""

    def __init__(self, solids: SolidBounds, walking: NDArray[np.bool_]) -> None:
        """`walking`: which of the solids wheels and tracks may stand on."""
        self._solids = solids
        self._walking = walking
        self._gathered: SolidBounds | None = None  # where the robot may be until that is done anew
        self._found: _Found | None = None

    def is_clear(
        self, pose: BodyPose, whole: SolidBounds, upper: SolidBounds, distance: float
    ) -> bool:
        """Whether the robot is surely farther than `distance` (m) from all that it must not touch.

        `whole` is the box around all of it in its own frame, `upper` that without what it stands
        on, which must not touch what is walked on either. False may be wrong.
        """
        if self._found and self._found.holds(pose, whole, upper):
            return True
        self._gather(pose, whole)
        self._found = None
        margin, gaps, level = distance + _SPARE, [], _is_level(pose)
        for solids, box in ((self._others, whole), (self._floors, upper)):
            gaps.append(_gaps(solids, pose, box) if level else _gaps_tilted(solids, pose, box))
            if min(gaps[-1]) <= margin:
                return False
        sideways, upwards = (min(pair) - margin for pair in zip(*gaps, strict=True))
        self._found = _Found(pose, whole, upper, level, sideways, upwards)
        return True

    def _gather(self, pose: BodyPose, whole: SolidBounds) -> None:
        """Gathers the solids near the robot, unless it is still where that was done before."""
        here = np.array([pose.x, pose.y, pose.z])
        place = SolidBounds(here, here)
        if self._gathered is not None and bool(self._gathered.overlapping(place)):
            return
        self._gathered = SolidBounds(here - _AROUND, here + _AROUND)
        reach = _radius(whole) + whole.high[2] + 2 * _AROUND
        near = self._solids.overlapping(SolidBounds(here - reach, here + reach))
        self._floors = self._solids.chosen(near & self._walking)
        self._others = self._solids.chosen(near & ~self._walking)


def _is_level(pose: BodyPose) -> bool:
    return abs(pose.pitch) <= TILT and abs(pose.roll) <= TILT


def _radius(box: SolidBounds) -> float:
    """m from the robot's origin to the farthest corner of its box, in the plane."""
    return math.hypot(*np.maximum(np.abs(box.low), np.abs(box.high))[:2].tolist())


def _gaps(solids: SolidBounds, pose: BodyPose, box: SolidBounds) -> tuple[float, float]:
    """The least gaps (m) that part a level robot's box, turned by its yaw, from upright boxes: in
    the plane, less than 0 if one is met; and up or down, where there is one that is large
    enough."""
    low, high = solids.low[:, 2], solids.high[:, 2]
    up = np.maximum(low - (pose.z + box.high[2]), (pose.z + box.low[2]) - high)
    beside = up < _PARTED
    upwards = float(up[~beside].min(initial=_AROUND))
    cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
    (mx, my), (hx, hy) = box.middle[:2].tolist(), box.half[:2].tolist()
    half = solids.half[beside, :2]
    away = solids.middle[beside, :2] - (pose.x + cos * mx - sin * my, pose.y + sin * mx + cos * my)
    turn = np.array([[cos, -sin], [sin, cos]])
    # The axes of the boxes, then those of the robot: the widest of four gaps is no more than the
    # distance.
    upright = np.abs(away) - half - (abs(cos) * hx + abs(sin) * hy, abs(sin) * hx + abs(cos) * hy)
    own = np.abs(away @ turn) - half @ np.abs(turn) - (hx, hy)
    sideways = np.maximum(upright, own).max(axis=1)
    return float(sideways.min(initial=_AROUND)), upwards


def _gaps_tilted(solids: SolidBounds, pose: BodyPose, box: SolidBounds) -> tuple[float, float]:
    """The least gap (m) that parts the robot's box, turned as it is, from upright boxes, less than
    0 if one is met; twice, as it is one in all directions."""
    turn = _rotation(pose)
    away = solids.middle - (np.array([pose.x, pose.y, pose.z]) + turn @ box.middle)
    # Along the axes of the boxes, then along those of the robot: the widest of six gaps is no more
    # than the distance.
    upright = np.abs(away) - solids.half - np.abs(turn) @ box.half
    own = np.abs(away @ turn) - solids.half @ np.abs(turn) - box.half
    gap = float(np.maximum(upright, own).max(axis=1).min(initial=_AROUND))
    return gap, gap


def _rotation(pose: BodyPose) -> NDArray[np.float64]:
    """Columns are the axes of the robot's frame on the site, shape (3, 3)."""
    c, s = math.cos(pose.yaw), math.sin(pose.yaw)
    down, level = math.sin(pose.pitch), math.cos(pose.pitch)
    right, upright = math.sin(pose.roll), math.cos(pose.roll)
    return np.array(
        [
            [c * level, c * down * right - s * upright, c * down * upright + s * right],
            [s * level, s * down * right + c * upright, s * down * upright - c * right],
            [-down, level * right, level * upright],
        ]
    )
