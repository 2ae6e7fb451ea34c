"""Follower of a path on tracks, which chooses speed and turning rate from the present pose."""

import math
from dataclasses import dataclass

from argo_env.navigation.path import Motion, Path, wrap
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import RobotSpec

_BRAKING = 0.3  # m/s², deceleration at the end of a straight motion
_SLOWING = 0.8  # rad/s², deceleration at the end of a turn
_NEAR = 0.01  # m from its end, at which a straight motion is done
_ALIGNED = math.radians(0.7)  # from its end, at which a turn is done
_CROOKED = math.radians(1.5)  # from the path's last heading, beyond which a turn is added
_TURNED = math.radians(3.0)  # rad/s, above which a turn is not done yet
_CREEP = 0.04  # m/s, the least speed towards an end
_HEADING_GAIN = 2.0  # 1/s
_LATERAL_GAIN = 2.5  # rad of heading for each m beside the line
_MOST_CROSSING = math.radians(15.0)  # greatest angle at which the robot returns to the line
_MOST_CROSSING_ON_STAIRS = math.radians(6.0)
_STRAIGHTENING = 0.5  # rad of that angle for each m to the end, so that the robot arrives straight
_MOST_TURNING_ON_STAIRS = 0.2  # rad/s
_WILD = math.radians(20.0)  # heading error, above which the robot turns before it drives


@dataclass(frozen=True)
class FollowerCommand:
    """Command of a follower: speed, turning rate and the motion they belong to."""

    speed: float
    """m/s forwards"""
    turn_rate: float
    """rad/s counter-clockwise"""
    motion: Motion | None
    """the motion under way; None at the end of the path"""


class Follower:
    """Follower of one path. It holds the motions and the number of the one under way."""

    def __init__(self, path: Path, robot: RobotSpec, velocity: float | None, pivot: float) -> None:
        """Start with the first motion of `path`.

        `velocity` (m/s) is the planned speed on the flat; None means the robot's own speed. `pivot`
        (m) is the point on the robot's x axis about which the robot turns in place.
        """
        self.motions: list[Motion] = list(path.motions)
        self._end = path.end
        self._corrections = [self._heading_correction, self._position_correction]
        self.index = 0
        self._robot = robot
        self._velocity = velocity
        self._pivot = pivot

    @property
    def motion(self) -> Motion | None:
        """Motion under way; None when all are done."""
        return self.motions[self.index] if self.index < len(self.motions) else None

    def step(self, pose: BodyPose, velocity: tuple[float, float]) -> FollowerCommand:
        """Return the next command for the robot's pose and velocity (m/s, rad/s)."""
        while (motion := self.motion) is not None:
            if motion.turn:
                error = wrap(motion.end.yaw - pose.yaw)
                if abs(error) > _ALIGNED or abs(velocity[1]) > _TURNED:
                    return FollowerCommand(0.0, self._turning(motion, error), motion)
            else:
                left = self.distance_to_stop(motion, pose)
                passing = self._continues()
                if left > (0.0 if passing else _NEAR):
                    return self._driving(motion, pose, left)
            self.index += 1
            while self.motion is None and self._corrections:
                self.motions += self._corrections.pop(0)(pose)
        return FollowerCommand(0.0, 0.0, None)

    def _heading_correction(self, pose: BodyPose) -> list[Motion]:
        """Return a turn to append if the heading at the path's end is wrong, else an empty list.

        That happens if the last straight motion came to its end from beside its line.
        """
        error = wrap(self._end.yaw - pose.yaw)
        if not self.motions or abs(error) <= _CROOKED:
            return []
        crooked = self._end.model_copy(update={"yaw": pose.yaw})
        return [Motion(crooked, self._end, turn=error)]

    def _position_correction(self, pose: BodyPose) -> list[Motion]:
        """Return a short straight motion to append if the robot is not at the path's end, else [].

        That happens if a turn moved the robot along its heading.
        """
        end = self._end
        ahead = math.cos(end.yaw), math.sin(end.yaw)
        left = (end.x - pose.x) * ahead[0] + (end.y - pose.y) * ahead[1]
        if not self.motions or abs(left) <= 2 * _NEAR:
            return []
        short = end.model_copy(update={"x": end.x - left * ahead[0], "y": end.y - left * ahead[1]})
        return [Motion(short, end, gear=1 if left > 0 else -1)]

    def distance_to_stop(self, motion: Motion, pose: BodyPose) -> float:
        """Return the distance (m) from the robot to the point where a straight motion should stop.

        The distance is horizontal, along the motion's line, and less than 0 beyond that point. The
        point is the motion's end; before a turn it is offset so that the pivot of the turn is at
        that end.
        """
        ahead = math.cos(motion.start.yaw), math.sin(motion.start.yaw)
        x, y = motion.end.x - pose.x, motion.end.y - pose.y
        stop_after = 0.0
        if self.index + 1 < len(self.motions) and self.motions[self.index + 1].turn:
            # A turn about a pivot behind the origin swings the origin aside, so the stop is that
            # much ahead.
            stop_after = -self._pivot
        return motion.gear * (x * ahead[0] + y * ahead[1] + stop_after)

    def left_offset_and_heading_error(self, motion: Motion, pose: BodyPose) -> tuple[float, float]:
        """Return the offset (m) of the robot to the left of a motion's line, and the heading error.

        The error (rad) is the robot's heading minus the motion's, positive counter-clockwise.
        """
        yaw = motion.start.yaw
        x, y = pose.x - motion.start.x, pose.y - motion.start.y
        return y * math.cos(yaw) - x * math.sin(yaw), wrap(pose.yaw - yaw)

    def _continues(self) -> bool:
        """Return True if the path's next motion continues the present one without stop or turn."""
        if self.index + 1 >= len(self.motions):
            return False
        now, then = self.motions[self.index], self.motions[self.index + 1]
        return (
            not then.turn
            and then.gear == now.gear
            and abs(wrap(then.start.yaw - now.start.yaw)) < math.radians(1.0)
        )

    def _turning(self, motion: Motion, error: float) -> float:
        # Turn in the direction of the motion, even if longer, until the rest is unambiguous.
        if abs(motion.turn) > math.pi / 2 and error * motion.turn < 0 and abs(error) > math.pi / 2:
            error += math.copysign(2 * math.pi, motion.turn)
        rate = min(self._robot.turn_rate_radians, math.sqrt(2 * _SLOWING * abs(error)))
        return math.copysign(max(rate, _TURNED), error)

    def _driving(self, motion: Motion, pose: BodyPose, left: float) -> FollowerCommand:
        speed = motion.drive_speed(self._robot, self._velocity)
        if not self._continues():
            speed = min(speed, max(_CREEP, math.sqrt(2 * _BRAKING * left)))
        side, heading = self.left_offset_and_heading_error(motion, pose)
        most = _MOST_CROSSING_ON_STAIRS if motion.on_stairs else _MOST_CROSSING
        if not self._continues():
            most = min(most, _STRAIGHTENING * max(0.0, left))
        wanted = -motion.gear * max(-most, min(most, _LATERAL_GAIN * side))
        rate = _HEADING_GAIN * wrap(wanted - heading)
        limit = _MOST_TURNING_ON_STAIRS if motion.on_stairs else self._robot.turn_rate_radians
        rate = max(-limit, min(limit, rate))
        if abs(heading) > _WILD:
            speed = 0.0
        return FollowerCommand(motion.gear * speed, rate, motion)
