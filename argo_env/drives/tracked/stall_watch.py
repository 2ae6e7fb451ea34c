"""Noticing that the robot slips, is stuck or tips over, from what it commands and how it moves."""

import math
from collections import deque
from dataclasses import dataclass

from argo_env.drives.drive import Incident, Trouble
from argo_env.navigation.path import wrap
from argo_env.robot.pose import BodyPose

WINDOW = 5.0  # s that are looked back; as it tips over an edge, a robot loses half its way for 3 s
_LEAST_WAY = 0.12  # m commanded within the window, from which a way is judged
_LEAST_TURN = math.radians(15.0)
_STUCK = 0.2  # share of what was commanded, under which the robot is stuck
_SLIPPING = 0.5  # the same, under which it slips
_MOST_ROLL = math.radians(35.0)
_MOST_PITCH = math.radians(60.0)  # front down; flights are up to 45°
_LEAST_PITCH = math.radians(-40.0)


@dataclass(frozen=True)
class _Sample:
    pose: BodyPose
    way: float
    """m commanded since the one before"""
    turn: float
    """rad, the same"""


class StallWatch:
    """Looks back over the last seconds. Holds where the robot was and what was commanded."""

    def __init__(self, period: float) -> None:
        """`period` (s) is that between calls of `look`."""
        self._period = period
        self._samples: deque[_Sample] = deque(maxlen=round(WINDOW / period))

    def forget(self) -> None:
        """Begins anew, as after a change of mind."""
        self._samples.clear()

    def look(self, pose: BodyPose, roll: float, speed: float, turn_rate: float) -> Incident | None:
        """What is wrong now, if anything is; `speed` (m/s) and `turn_rate` (rad/s) are what was
        commanded since the last call."""
        if abs(roll) > _MOST_ROLL or not _LEAST_PITCH < pose.pitch < _MOST_PITCH:
            detail = f"pitch {math.degrees(pose.pitch):.0f}°, roll {math.degrees(roll):.0f}°"
            return Incident(Trouble.TIPPED, detail, pose)
        self._samples.append(
            _Sample(pose, abs(speed) * self._period, abs(turn_rate) * self._period)
        )
        if len(self._samples) < (self._samples.maxlen or 0):
            return None
        before = self._samples[0].pose
        way = sum(s.way for s in self._samples)
        turn = sum(s.turn for s in self._samples)
        went = math.dist((pose.x, pose.y, pose.z), (before.x, before.y, before.z))
        turned = abs(wrap(pose.yaw - before.yaw))
        share = max(
            went / way if way > _LEAST_WAY else 0.0, turned / turn if turn > _LEAST_TURN else 0.0
        )
        if (way <= _LEAST_WAY and turn <= _LEAST_TURN) or share >= _SLIPPING:
            return None
        detail = (
            f"made {went:.2f} m of {way:.2f} m commanded"
            if way > _LEAST_WAY
            else f"turned {math.degrees(turned):.0f}° of {math.degrees(turn):.0f}° commanded"
        )
        return Incident(Trouble.STUCK if share < _STUCK else Trouble.SLIPPING, detail, pose)
