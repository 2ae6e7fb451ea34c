"""Fast check that the robot is clear of all that it must not touch, by bounding boxes alone.

A search for contacts takes PyBullet a tenth of a millisecond. Most of the time nothing is near, and
boxes around the solids and around the robot show that in a fraction of this time.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from argo_env.navigation.path import wrap
from argo_env.robot.pose import BodyPose

TILT = 0.002  # rad of pitch and roll up to which the robot counts as level
_MARGIN = 0.01  # m added to distances: more than the error from treating a tilt up to TILT as level
_GATHER_RANGE = 1.0  # m that the robot may move until the solids near it are gathered anew
_MIN_VERTICAL_GAP = 0.05  # m: boxes with a larger vertical gap need no horizontal gap


@dataclass(frozen=True, eq=False)
class SolidBounds:
    """Bounding box parallel to its frame's axes, or many: arrays of shape (3,) or (n, 3)."""

    low: NDArray[np.float64]
    """m, lowest corner"""
    high: NDArray[np.float64]
    """m, highest corner"""

    @cached_property
    def middle(self) -> NDArray[np.float64]:
        return np.asarray((self.low + self.high) / 2)

    @cached_property
    def half(self) -> NDArray[np.float64]:
        """Half the lengths of the edges (m)."""
        return np.asarray((self.high - self.low) / 2)

    @staticmethod
    def one_box_around_all(boxes: "list[SolidBounds]") -> "SolidBounds":
        """Return the smallest box that contains all the boxes."""
        low, high = [box.low for box in boxes], [box.high for box in boxes]
        return SolidBounds(np.min(low, axis=0), np.max(high, axis=0))

    def overlapping(self, box: "SolidBounds") -> NDArray[np.bool_]:
        """Return a mask of these boxes, True for those that overlap with or touch `box`."""
        return np.asarray(((self.low <= box.high) & (self.high >= box.low)).all(axis=-1))

    def select_boxes(self, mask: NDArray[np.bool_]) -> "SolidBounds":
        """Return the boxes that the mask selects."""
        return SolidBounds(self.low[mask], self.high[mask])


@dataclass(frozen=True)
class _ClearPose:
    """Pose at which the robot was clear, and how far it may move from there and stay clear."""

    pose: BodyPose
    full: SolidBounds
    """box around the whole robot in its own frame"""
    upper: SolidBounds
    """box around the robot without the parts that it stands on, in its own frame"""
    level: bool
    """True if it was level; then it must stay level, and horizontal and vertical motion are limited
    separately"""
    sideways: float
    """m that any point of the robot may move horizontally; unless level, in any direction"""
    upwards: float
    """m that any point of the robot may move up or down"""

    def covers(self, pose: BodyPose, full: SolidBounds, upper: SolidBounds) -> bool:
        """Return True if a robot with the same boxes is surely clear at `pose` too."""
        if self.full is not full or self.upper is not upper:
            return False
        clear_pose = self.pose
        turned = abs(wrap(pose.yaw - clear_pose.yaw))
        moved, risen = (
            math.hypot(pose.x - clear_pose.x, pose.y - clear_pose.y),
            abs(pose.z - clear_pose.z),
        )
        if self.level:
            near = moved + turned * self._radius < self.sideways and risen < self.upwards
            return near and _is_level(pose)
        tilted = abs(pose.pitch - clear_pose.pitch) + abs(pose.roll - clear_pose.roll)
        return moved + risen + (turned + tilted) * self._reach < self.sideways

    @cached_property
    def _radius(self) -> float:
        return _radius(self.full)

    @cached_property
    def _reach(self) -> float:
        """Distance in m from the robot's origin to the farthest corner of its box."""
        corner = np.maximum(np.abs(self.full.low), np.abs(self.full.high))
        return math.hypot(*corner.tolist())


class Clearance:
    """Check by bounding boxes; it caches the solids near the robot and the last clear pose."""

    def __init__(self, solids: SolidBounds, are_walkable: NDArray[np.bool_]) -> None:
        """`are_walkable`: which of the solids wheels and tracks may stand on."""
        self._solids = solids
        self._are_walkable = are_walkable
        self._gathered_around: SolidBounds | None = None  # positions for which the cache is valid
        self._last_clear: _ClearPose | None = None

    def is_surely_clear(
        self,
        pose: BodyPose,
        whole_robot: SolidBounds,
        without_standing_links: SolidBounds,
        distance: float,
    ) -> bool:
        """Return True if the robot is surely farther than `distance` (m) from any contact.

        The check is conservative: False does not mean that there is a contact.

        Args:
            pose: pose of the robot.
            whole_robot: box around the whole robot in its own frame; it must not touch solids that
                are not walkable.
            without_standing_links: box around the robot without the parts that it stands on; it
                must not touch walkable solids.
            distance: m.
        """
        if self._last_clear and self._last_clear.covers(pose, whole_robot, without_standing_links):
            return True
        self._gather_solids(pose, whole_robot)
        self._last_clear = None
        margin, gaps, level = distance + _MARGIN, [], _is_level(pose)
        for solids, box in (
            (self._other_solids, whole_robot),
            (self._walkable_solids, without_standing_links),
        ):
            gaps.append(_gaps(solids, pose, box) if level else _gaps_tilted(solids, pose, box))
            if min(gaps[-1]) <= margin:
                return False
        sideways, upwards = (min(pair) - margin for pair in zip(*gaps, strict=True))
        self._last_clear = _ClearPose(
            pose, whole_robot, without_standing_links, level, sideways, upwards
        )
        return True

    def _gather_solids(self, pose: BodyPose, full: SolidBounds) -> None:
        """Gather the solids near the robot, unless it is still near where this was done last."""
        here = np.array([pose.x, pose.y, pose.z])
        point = SolidBounds(here, here)
        if self._gathered_around is not None and bool(self._gathered_around.overlapping(point)):
            return
        self._gathered_around = SolidBounds(here - _GATHER_RANGE, here + _GATHER_RANGE)
        reach = _radius(full) + full.high[2] + 2 * _GATHER_RANGE
        near = self._solids.overlapping(SolidBounds(here - reach, here + reach))
        self._walkable_solids = self._solids.select_boxes(near & self._are_walkable)
        self._other_solids = self._solids.select_boxes(near & ~self._are_walkable)


def _is_level(pose: BodyPose) -> bool:
    return abs(pose.pitch) <= TILT and abs(pose.roll) <= TILT


def _radius(box: SolidBounds) -> float:
    """Return the horizontal distance (m) from the robot's origin to its box's farthest corner."""
    return math.hypot(*np.maximum(np.abs(box.low), np.abs(box.high))[:2].tolist())


def _gaps(solids: SolidBounds, pose: BodyPose, box: SolidBounds) -> tuple[float, float]:
    """Return the least horizontal and vertical gaps (m) of a level robot's box to solids' boxes.

    The solids' boxes are parallel to the site's axes. Those with a vertical gap of at least
    _MIN_VERTICAL_GAP count for the vertical one, all others for the horizontal one, which is less
    than 0 if boxes overlap. A gap for which no box counts is _GATHER_RANGE.
    """
    low, high = solids.low[:, 2], solids.high[:, 2]
    up = np.maximum(low - (pose.z + box.high[2]), (pose.z + box.low[2]) - high)
    beside = up < _MIN_VERTICAL_GAP
    upwards = float(up[~beside].min(initial=_GATHER_RANGE))
    cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
    (mx, my), (hx, hy) = box.middle[:2].tolist(), box.half[:2].tolist()
    half = solids.half[beside, :2]
    offset = solids.middle[beside, :2] - (
        pose.x + cos * mx - sin * my,
        pose.y + sin * mx + cos * my,
    )
    turn = np.array([[cos, -sin], [sin, cos]])
    # Gaps along the axes of the boxes, then along those of the robot: the largest of the four is a
    # lower bound of the distance.
    upright = np.abs(offset) - half - (abs(cos) * hx + abs(sin) * hy, abs(sin) * hx + abs(cos) * hy)
    own = np.abs(offset @ turn) - half @ np.abs(turn) - (hx, hy)
    sideways = np.maximum(upright, own).max(axis=1)
    return float(sideways.min(initial=_GATHER_RANGE)), upwards


def _gaps_tilted(solids: SolidBounds, pose: BodyPose, box: SolidBounds) -> tuple[float, float]:
    """Return the least gap (m) between a tilted robot's box and the solids' boxes, twice.

    It is less than 0 if boxes overlap. The gap is one in any direction, so it stands for the
    horizontal and the vertical one of `_gaps`.
    """
    turn = _rotation(pose)
    offset = solids.middle - (np.array([pose.x, pose.y, pose.z]) + turn @ box.middle)
    # Gaps along the axes of the boxes, then along those of the robot: the largest of the six is a
    # lower bound of the distance.
    upright = np.abs(offset) - solids.half - np.abs(turn) @ box.half
    own = np.abs(offset @ turn) - solids.half @ np.abs(turn) - box.half
    gap = float(np.maximum(upright, own).max(axis=1).min(initial=_GATHER_RANGE))
    return gap, gap


def _rotation(pose: BodyPose) -> NDArray[np.float64]:
    """Return the robot's rotation, shape (3, 3): columns are the axes of its frame on the site."""
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
