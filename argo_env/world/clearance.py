"""Whether a level robot is clear of all that it must not touch, told by boxes alone.

To look for contacts takes PyBullet a tenth of a millisecond. Most of the time nothing is anywhere
near, and boxes around the solids and around the robot tell that in a tenth of it.
"""

import math
from dataclasses import dataclass

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
    sideways: float
    """m that all of it may move in the plane"""
    upwards: float
    """m up or down"""


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
        if abs(pose.pitch) > TILT or abs(pose.roll) > TILT:
            return False
        if self._found and _is_near(self._found, pose, whole, upper):
            return True
        self._gather(pose, whole)
        self._found = None
        margin, gaps = distance + _SPARE, []
        for solids, box in ((self._others, whole), (self._floors, upper)):
            gaps.append(_gaps(solids, pose, box))
            if min(gaps[-1]) <= margin:
                return False
        sideways, upwards = (min(pair) - margin for pair in zip(*gaps, strict=True))
        self._found = _Found(pose, whole, upper, sideways, upwards)
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


def _is_near(found: _Found, pose: BodyPose, whole: SolidBounds, upper: SolidBounds) -> bool:
    """Whether the robot can't have met anything since it was found clear."""
    if found.whole is not whole or found.upper is not upper:
        return False
    before = found.pose
    turned = abs(wrap(pose.yaw - before.yaw)) * _radius(whole)
    gone = math.hypot(pose.x - before.x, pose.y - before.y) + turned
    return gone < found.sideways and abs(pose.z - before.z) < found.upwards


def _radius(box: SolidBounds) -> float:
    """m from the robot's origin to the farthest corner of its box, in the plane."""
    return math.hypot(*np.maximum(np.abs(box.low), np.abs(box.high))[:2].tolist())


def _gaps(solids: SolidBounds, pose: BodyPose, box: SolidBounds) -> tuple[float, float]:
    """The least gaps (m) that part the robot's box, turned by its yaw, from upright boxes: in the
    plane, less than 0 if one is met; and up or down, where there is one that is large enough."""
    low, high = solids.low, solids.high
    up = np.maximum(low[:, 2] - (pose.z + box.high[2]), (pose.z + box.low[2]) - high[:, 2])
    beside = up < _PARTED
    upwards = float(up[~beside].min(initial=_AROUND))
    low, high = low[beside, :2], high[beside, :2]
    cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
    (mx, my), (hx, hy) = ((box.low + box.high) / 2)[:2], ((box.high - box.low) / 2)[:2]
    half = (high - low) / 2
    away = (high + low) / 2 - (pose.x + cos * mx - sin * my, pose.y + sin * mx + cos * my)
    turn = np.array([[cos, -sin], [sin, cos]])
    # The axes of the boxes, then those of the robot: the widest of four gaps is no more than the
    # distance.
    upright = np.abs(away) - half - (abs(cos) * hx + abs(sin) * hy, abs(sin) * hx + abs(cos) * hy)
    own = np.abs(away @ turn) - half @ np.abs(turn) - (hx, hy)
    sideways = np.maximum(upright, own).max(axis=1)
    return float(sideways.min(initial=_AROUND)), upwards
