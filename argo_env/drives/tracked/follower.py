"""Following a path with tracks: what speed and turning rate take the robot along it from here."""

import math
from dataclasses import dataclass

from argo_env.navigation.path import Motion, Path, wrap
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import RobotSpec

_BRAKING = 0.3  # m/s², with which it stops at the end of a drive
_SLOWING = 0.8  # rad/s², the same for turns
_NEAR = 0.01  # m from its end at which a drive is done
_ALIGNED = math.radians(0.7)  # from its end at which a turn is done
_CROOKED = math.radians(1.5)  # from the path's last heading at which a turn is added
_TURNED = math.radians(3.0)  # rad/s under which it is
_CREEP = 0.04  # m/s, the least speed towards an end
_HEADING_GAIN = 2.0  # 1/s
_LATERAL_GAIN = 2.5  # rad of heading for each m beside the line
_MOST_CROSSING = math.radians(15.0)  # at which it goes back to the line
_MOST_CROSSING_ON_STAIRS = math.radians(6.0)
_STRAIGHTENING = 0.5  # rad of crossing for each m to the end, so that it arrives straight
_MOST_TURNING_ON_STAIRS = 0.2  # rad/s
_WILD = math.radians(20.0)  # of heading error, at which a drive waits for the heading


@dataclass(frozen=True)
class FollowerCommand:
    """What to do now."""

    speed: float
    """m/s forwards"""
    turn_rate: float
    """rad/s counter-clockwise"""
    motion: Motion | None
    """the motion under way; None at the end of the path"""


class Follower:
    """Goes along one path. Holds which motion is under way."""

    def __init__(self, path: Path, robot: RobotSpec, velocity: float | None, pivot: float) -> None:
        """`velocity` (m/s) is the plan's on the flat; `pivot` (m) is where on its x axis the robot
        turns about when it turns in place."""
        self.motions: list[Motion] = list(path.motions)
        self._end = path.end
        self._corrections = [self._heading_correction, self._way_correction]
        self.at = 0
        self._robot = robot
        self._velocity = velocity
        self._pivot = pivot

    @property
    def motion(self) -> Motion | None:
        """The motion under way; None when all are done."""
        return self.motions[self.at] if self.at < len(self.motions) else None

    def step(self, pose: BodyPose, velocity: tuple[float, float]) -> FollowerCommand:
        """The next command from where the robot is and how it moves (m/s, rad/s)."""
        while (motion := self.motion) is not None:
            if motion.turn:
                error = wrap(motion.end.yaw - pose.yaw)
                if abs(error) > _ALIGNED or abs(velocity[1]) > _TURNED:
                    return FollowerCommand(0.0, self._turning(motion, error), motion)
            else:
                left = self.left(motion, pose)
                passing = self._goes_on()
                if left > (0.0 if passing else _NEAR):
                    return self._driving(motion, pose, left)
            self.at += 1
            while self.motion is None and self._corrections:
                self.motions += self._corrections.pop(0)(pose)
        return FollowerCommand(0.0, 0.0, None)

    def _heading_correction(self, pose: BodyPose) -> list[Motion]:
        """A turn at the end, since the last drive may have come in from beside its line."""
        error = wrap(self._end.yaw - pose.yaw)
        if not self.motions or abs(error) <= _CROOKED:
            return []
        crooked = self._end.model_copy(update={"yaw": pose.yaw})
        return [Motion(crooked, self._end, turn=error)]

    def _way_correction(self, pose: BodyPose) -> list[Motion]:
        """A short drive at the end, since the last turn may have swung the robot along its
        heading."""
        end = self._end
        ahead = math.cos(end.yaw), math.sin(end.yaw)
        left = (end.x - pose.x) * ahead[0] + (end.y - pose.y) * ahead[1]
        if not self.motions or abs(left) <= 2 * _NEAR:
            return []
        short = end.model_copy(update={"x": end.x - left * ahead[0], "y": end.y - left * ahead[1]})
        return [Motion(short, end, gear=1 if left > 0 else -1)]

    def left(self, motion: Motion, pose: BodyPose) -> float:
        """m on the ground plan to the end of a drive."""
        ahead = math.cos(motion.start.yaw), math.sin(motion.start.yaw)
        x, y = motion.end.x - pose.x, motion.end.y - pose.y
        stop_after = 0.0
        if self.at + 1 < len(self.motions) and self.motions[self.at + 1].turn:
            # A turn about a pivot behind the origin swings the origin aside; so begin it ahead.
            stop_after = -self._pivot
        return motion.gear * (x * ahead[0] + y * ahead[1] + stop_after)

    def beside(self, motion: Motion, pose: BodyPose) -> tuple[float, float]:
        """m to the left of the line of a drive, and the heading error in rad."""
        yaw = motion.start.yaw
        x, y = pose.x - motion.start.x, pose.y - motion.start.y
        return y * math.cos(yaw) - x * math.sin(yaw), wrap(pose.yaw - yaw)

    def _goes_on(self) -> bool:
        """Whether the next motion goes on the same way, so that there is no need to stop."""
        if self.at + 1 >= len(self.motions):
            return False
        now, then = self.motions[self.at], self.motions[self.at + 1]
        return (
            not then.turn
            and then.gear == now.gear
            and abs(wrap(then.start.yaw - now.start.yaw)) < math.radians(1.0)
        )

    def _turning(self, motion: Motion, error: float) -> float:
        # The long way round, if the motion asks for it, until what is left is unambiguous.
        if abs(motion.turn) > math.pi / 2 and error * motion.turn < 0 and abs(error) > math.pi / 2:
            error += math.copysign(2 * math.pi, motion.turn)
        rate = min(self._robot.turn_rate_radians, math.sqrt(2 * _SLOWING * abs(error)))
        return math.copysign(max(rate, _TURNED), error)

    def _driving(self, motion: Motion, pose: BodyPose, left: float) -> FollowerCommand:
        speed = motion.speed(self._robot, self._velocity)
        if not self._goes_on():
            speed = min(speed, max(_CREEP, math.sqrt(2 * _BRAKING * left)))
        side, heading = self.beside(motion, pose)
        most = _MOST_CROSSING_ON_STAIRS if motion.on_stairs else _MOST_CROSSING
        if not self._goes_on():
            most = min(most, _STRAIGHTENING * max(0.0, left))
        wanted = -motion.gear * max(-most, min(most, _LATERAL_GAIN * side))
        rate = _HEADING_GAIN * wrap(wanted - heading)
        limit = _MOST_TURNING_ON_STAIRS if motion.on_stairs else self._robot.turn_rate_radians
        rate = max(-limit, min(limit, rate))
        if abs(heading) > _WILD:
            speed = 0.0
        return FollowerCommand(motion.gear * speed, rate, motion)
