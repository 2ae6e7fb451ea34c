"""A path: straight drives and turns in place, in sequence.

NumPy is imported only where arrays are made: commands that find their paths in the cache start
without it.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, overload

from argo_compiler.base.model import Pose
from argo_env.robot.spec import MotionKind, RobotSpec, motion_kind

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Motion:
    """A turn in place, or a straight drive with a constant heading, from one pose to the next."""

    start: Pose
    end: Pose
    turn: float = 0.0
    """angle in rad, counter-clockwise; 0 for a drive"""
    gear: int = 1
    """1 forwards, -1 backwards; 1 for a turn"""
    on_stairs: bool = False
    """True if the robot is tilted: down forwards, or up backwards"""

    @property
    def kind(self) -> MotionKind:
        return MotionKind.TURN if self.turn else motion_kind(self.gear, self.on_stairs)

    @property
    def length(self) -> float:
        """Length in m along the surface; 0 for a turn."""
        return math.dist(
            (self.start.x, self.start.y, self.start.z), (self.end.x, self.end.y, self.end.z)
        )

    def pose_at(self, share: float) -> Pose:
        """Return the pose after a share, 0 (start) to 1 (end), of the motion's length and angle."""
        a, b = self.start, self.end
        return Pose(
            x=a.x + share * (b.x - a.x),
            y=a.y + share * (b.y - a.y),
            z=a.z + share * (b.z - a.z),
            yaw=wrap(a.yaw + share * self.turn),
        )

    def coordinates_at(self, shares: "NDArray[np.float64]") -> tuple["NDArray[np.float64]", ...]:
        """Return x, y, z (m) and yaw (rad) after each share of the motion, as four arrays.

        The shares are those of `pose_at`.
        """
        a, b = self.start, self.end
        return (
            a.x + shares * (b.x - a.x),
            a.y + shares * (b.y - a.y),
            a.z + shares * (b.z - a.z),
            wrap(a.yaw + shares * self.turn),
        )

    def drive_speed(self, robot: RobotSpec, velocity: float | None = None) -> float:
        """Return the target speed (m/s) of a motion that is a drive.

        `velocity` (m/s) replaces the robot's own speed forwards on the flat; on stairs and
        backwards it applies if it is below the robot's own speed there. None: the robot's own
        speed.
        """
        planned = robot.target_speed(self.kind)
        if velocity is None:
            return planned
        flat_ahead = self.gear > 0 and not self.on_stairs
        return velocity if flat_ahead else min(velocity, planned)

    def duration(self, robot: RobotSpec, velocity: float | None = None) -> float:
        """Return the seconds that the motion takes, by the robot's calibration.

        `velocity` (m/s) applies as in `drive_speed`, and has no effect on turns.
        """
        if self.turn:
            return robot.motion_time(self.kind, abs(self.turn))
        return robot.motion_time(self.kind, self.length, self.drive_speed(robot, velocity))


@dataclass(frozen=True)
class Path:
    """Motions from `start`; without motions the robot is at its goal already."""

    start: Pose
    motions: tuple[Motion, ...]

    @property
    def end(self) -> Pose:
        return self.motions[-1].end if self.motions else self.start

    @property
    def length(self) -> float:
        """Length in m along the surface."""
        return math.fsum(m.length for m in self.motions)

    @property
    def total_ascent(self) -> float:
        """Sum of all ascents in m."""
        return math.fsum(max(0.0, m.end.z - m.start.z) for m in self.motions)

    def duration(self, robot: RobotSpec, velocity: float | None = None) -> float:
        """Return the seconds that the path takes; `velocity` (m/s) is that of `Motion.duration`."""
        return math.fsum(m.duration(robot, velocity) for m in self.motions)

    def timed_poses(self, robot: RobotSpec, velocity: float | None = None) -> "NDArray[np.float64]":
        """Return the time and pose at the start and after each motion, shape (n + 1, 5).

        The columns are t (s), x, y, z (m) and yaw (rad).
        """
        import numpy as np

        rows = [(0.0, *_row(self.start))]
        for motion in self.motions:
            rows.append((rows[-1][0] + motion.duration(robot, velocity), *_row(motion.end)))
        return np.array(rows)


def merge(motions: Iterable[Motion]) -> list[Motion]:
    """Return the motions with consecutive ones of the same kind joined into one.

    Turns are joined, and their angles added. Drives are joined if heading, gear (forwards or
    backwards) and `on_stairs` are the same.
    """
    merged: list[Motion] = []
    for motion in motions:
        last = merged[-1] if merged else None
        if last is None or bool(last.turn) != bool(motion.turn):
            merged.append(motion)
        elif last.turn:
            merged[-1] = Motion(last.start, motion.end, turn=last.turn + motion.turn)
        elif (
            last.gear == motion.gear
            and last.on_stairs == motion.on_stairs
            and abs(wrap(motion.start.yaw - last.start.yaw)) < 1e-9
        ):
            merged[-1] = replace(last, end=motion.end)
        else:
            merged.append(motion)
    return merged


@overload
def wrap(angle: float) -> float: ...


@overload
def wrap(angle: "NDArray[np.float64]") -> "NDArray[np.float64]": ...


def wrap(angle: "float | NDArray[np.float64]") -> "float | NDArray[np.float64]":
    """Return the equivalent angle above -pi and up to pi, in rad."""
    return math.pi - (math.pi - angle) % (2 * math.pi)


def _row(pose: Pose) -> tuple[float, float, float, float]:
    return pose.x, pose.y, pose.z, pose.yaw
