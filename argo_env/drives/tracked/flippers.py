"""Flippers on a path: raised on the flat, flat on a flight, down at the ends of a flight.

They push the robot up the first step, and touch the deck at the top edge of the flight, so that the
robot tips over slowly.

The tips reach 5 cm beyond the rear of the tracks, so they carry the end that leads up.
"""

import math
from dataclasses import dataclass

import numpy as np

from argo_env.drives.drive import FLAT, FLIPPER_RATE, RAISED
from argo_env.navigation.path import Motion
from argo_env.robot.pose import BodyPose
from argo_env.world.world import World

_LOWEST = math.radians(-30.0)
_TOUCHING = math.radians(-7.0)  # just above the ground that the tracks stand on
_PUSH = math.radians(-10.0)  # onto the first tread
_LENGTH = 0.87  # m, from the axle to the middle of the tip
_TIP = -0.49  # m, where the tip is along the robot when the flippers lie flat
_CLEARANCE = 0.115  # m, of the flat tip above the ground
_LOWERING = math.radians(12.0)  # rad/s, at which the flippers let the robot down
_LIFTING = math.radians(15.0)  # rad/s, at which the flippers lift the rear
_AT_RISER = -0.52  # m, where the first riser is along the robot when its rear is about to touch it
_GAP = math.radians(10.0)  # above the deck, where the flippers must not lift the robot
_MARGIN = math.radians(5.0)  # above the angle that would lift the robot to the flight's pitch
_TIPPED = math.radians(2.0)  # below the flight's pitch, at which the robot has begun to tip
_LEVEL = math.radians(3.0)
CAREFUL_SPEED = 0.08  # m/s over an edge
_SPACING = 0.005  # m between the points whose heights are used
_STEP = 0.03  # m of height that ends a deck


@dataclass(frozen=True)
class Flight:
    """Flight as the robot sees it: its top edge and its foot, in m along the line downhill."""

    x: float
    y: float
    """x and y of a point on the line, in m"""
    ahead: tuple[float, float]
    """unit vector downhill, which is the robot's heading"""
    top: float
    foot: float
    slope: float
    """slope of the line through the nosings in rad"""

    def distances_to_top_and_foot(self, pose: BodyPose) -> tuple[float, float]:
        """Return the distances (m) along the tracks from the robot's middle to top edge and foot.

        Each is positive while that edge lies downhill of the middle, whichever way the robot
        drives, and less than 0 while it lies uphill.
        """
        at = (pose.x - self.x) * self.ahead[0] + (pose.y - self.y) * self.ahead[1]
        return (self.top - at) / math.cos(pose.pitch), (self.foot - at) / math.cos(pose.pitch)


def measure_flight(world: World, motion: Motion, gauge: float) -> Flight:
    """Return the flight that the ground below the left track shows along a motion on stairs.

    `gauge` (m) is the distance between the middles of the tracks.
    """
    high, low = (motion.start, motion.end) if motion.gear > 0 else (motion.end, motion.start)
    ahead = math.cos(motion.start.yaw), math.sin(motion.start.yaw)
    length = math.dist((high.x, high.y), (low.x, low.y))
    along = np.arange(-0.5, length + 0.5, _SPACING)
    share = np.clip(along / max(length, 1e-9), 0.0, 1.0)
    above = high.z + share * (low.z - high.z) + 0.5
    left = gauge / 2 * np.array([-ahead[1], ahead[0]])
    points = np.array([high.x, high.y]) + along[:, None] * np.array(ahead) + left
    z = world.surface_or_ray_end_heights(points, above)
    on_top = np.flatnonzero(z > high.z - _STEP)
    at_foot = np.flatnonzero(z > low.z + _STEP)
    top = float(along[on_top[-1]]) if len(on_top) else 0.0
    foot = float(along[at_foot[-1]]) if len(at_foot) else length
    steps = (along > top) & (along < foot) & (z > low.z + _STEP)
    slope = -math.atan(np.polyfit(along[steps], z[steps], 1)[0]) if steps.sum() > 2 else 0.0
    return Flight(high.x, high.y, ahead, top, foot, max(0.0, slope))


class Flippers:
    """Control of the flippers. It holds the angle commanded last."""

    def __init__(self) -> None:
        self.angle = RAISED

    def step_and_should_go_slowly(
        self, flight: Flight | None, motion: Motion | None, pose: BodyPose, dt: float
    ) -> bool:
        """Update `angle` for the next `dt` (s); return True if the robot should go slowly.

        `flight` is the one that the motion is on, None if that is not on stairs.
        """
        if flight is None or motion is None:
            self._towards(RAISED, FLIPPER_RATE, dt)
            return False
        top, foot = flight.distances_to_top_and_foot(pose)
        on_flight = pose.pitch > flight.slope - _TIPPED
        if motion.gear < 0:
            if top > -0.35:
                if on_flight:
                    self._towards(
                        _touching_angle(min(pose.pitch, flight.slope), top) + _GAP, FLIPPER_RATE, dt
                    )
                else:
                    self._towards(FLAT, _LOWERING if pose.pitch > _LEVEL else FLIPPER_RATE, dt)
                return top > 0.0 and pose.pitch > _LEVEL
            if foot < _AT_RISER:
                self._towards(RAISED, FLIPPER_RATE, dt)
                return False
            if foot < -0.3 and pose.pitch < math.radians(8.0):
                self._towards(_PUSH, _LIFTING, dt)
                return True
        elif -0.35 < top < 0.22:
            wanted = _touching_angle(flight.slope, top) + (_MARGIN if top > 0.0 else _GAP)
            self._towards(wanted, _LIFTING if wanted < self.angle else FLIPPER_RATE, dt)
            return top > -0.1
        elif top >= 0.22:
            self._towards(_TOUCHING, FLIPPER_RATE, dt)
            return False
        self._towards(FLAT, FLIPPER_RATE, dt)
        return False

    def _towards(self, angle: float, rate: float, dt: float) -> None:
        most = rate * dt
        self.angle += max(-most, min(most, angle - self.angle))


def _touching_angle(pitch: float, top: float) -> float:
    """Return the angle (rad) at which the tips touch the deck behind an edge.

    The edge is `top` (m) ahead of the middle of the robot, which is pitched down over it.
    """
    drop = _CLEARANCE + max(0.0, top - _TIP) * math.tan(pitch)
    return max(_LOWEST, -math.asin(min(1.0, drop / _LENGTH)))
