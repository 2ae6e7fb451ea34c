"""The battery: what the robot draws, what is left, and the voltage that tells.

How many watts the robot draws on the level, on stairs and for its sensors is in the robot's own
file (`power` in `urdf/robot/tracker.yaml`).
"""

import math
from bisect import bisect_left
from copy import copy

import numpy as np
from numpy.typing import NDArray

from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import PowerSpec, RobotSpec

_CURVE = (
    (0.0, 23.0), (0.05, 23.9), (0.1, 24.3), (0.2, 24.7), (0.4, 25.3), (0.6, 25.9), (0.8, 26.8),
    (1.0, 28.0),
)  # fmt: skip
"""Charge and open-circuit voltage (V): the shape of a lithium-ion battery between the 23 V and 28 V
of the robot that Argo's is modelled after."""
_CHARGES, _VOLTAGES = ([point[k] for point in _CURVE] for k in (0, 1))
RESISTANCE = 0.05  # ohm, assumed
ESTIMATE_ERROR = 0.005
"""by how much the estimated charge is off at most, as volts are measured to 10 mV"""
_MOVING = 0.02  # m/s or rad/s from where on the robot moves, and does not only settle
_ON_STAIRS = math.radians(8.0)  # of pitch


class Battery:
    """The robot's battery. Holds what is left; faults change its capacity and charge."""

    def __init__(self, robot: RobotSpec) -> None:
        self.capacity = robot.battery
        """Wh"""
        self._left = self.capacity
        self._load = 0.0

    @property
    def charge(self) -> float:
        """The share of its capacity that is left, 0 to 1."""
        return self._left / self.capacity

    @charge.setter
    def charge(self, share: float) -> None:
        self._left = share * self.capacity

    @property
    def empty(self) -> bool:
        return self._left <= 0.0

    def wear(self, share: float) -> None:
        """Reduces the capacity to that share of what it is; the charge stays the same share."""
        charge = self.charge
        self.capacity *= share
        self.charge = charge

    def use(self, watts: float, seconds: float) -> None:
        """Draws power from it, or with less than 0 W charges it."""
        self._load = watts
        self._left = min(max(self._left - watts * seconds / 3600.0, 0.0), self.capacity)

    def steps_until(self, estimate: float, watts: float, seconds: float, most: int) -> int:
        """After how many steps (s) with such a load (W) the charge that is estimated is that much,
        0 to 1, for the first time; `most` if that is not before. None of them is made."""
        other = copy(self)
        for count in range(most):
            if estimated_charge(other.voltage, other.current) >= estimate:
                return count
            other.use(watts, seconds)
        return most

    @property
    def state(self) -> tuple[float, float]:
        """Wh that are left, and the load (W)."""
        return self._left, self._load

    @state.setter
    def state(self, state: tuple[float, float]) -> None:
        self._left, self._load = state

    @property
    def current(self) -> float:
        """A, as measured; less than 0 while it is charged."""
        return self._load / _open_circuit(self.charge)

    @property
    def voltage(self) -> float:
        """V, as measured to 10 mV under the present load."""
        return round(_open_circuit(self.charge) - RESISTANCE * self.current, 2)


def estimated_charge(voltage: float, current: float) -> float:
    """The charge, 0 to 1, that the measured voltage (V) and current (A) speak for."""
    rest = voltage + RESISTANCE * current
    k = min(max(bisect_left(_VOLTAGES, rest), 1), len(_CURVE) - 1)
    (s0, v0), (s1, v1) = _CURVE[k - 1], _CURVE[k]
    return min(max(s0 + (rest - v0) / (v1 - v0) * (s1 - s0), 0.0), 1.0)


def load(
    power: PowerSpec, before: BodyPose, after: BodyPose, seconds: float, measuring: bool
) -> float:
    """What the robot draws (W) on its way between two poses within some seconds."""
    way = math.dist((before.x, before.y, before.z), (after.x, after.y, after.z))
    least = _MOVING * seconds
    if way > least:
        if abs(after.pitch) > _ON_STAIRS:
            return power.climbing if after.z > before.z else power.descending
        return power.driving
    if abs(math.remainder(after.yaw - before.yaw, math.tau)) > least:
        return power.turning
    return power.measuring if measuring else power.standing


def loads_of_steps(
    power: PowerSpec,
    ways: NDArray[np.float64],
    places: NDArray[np.float64],
    seconds: float,
    measuring: bool,
) -> NDArray[np.float64]:
    """The same, to the last bit, for each of n steps: ways (m) have the shape (n,), places, as of
    poses without roll, (n + 1, 5)."""
    before, after = places[:-1], places[1:]
    least = _MOVING * seconds
    climbs = after[:, 2] > before[:, 2]
    steep = np.abs(after[:, 4]) > _ON_STAIRS
    moves = np.where(steep, np.where(climbs, power.climbing, power.descending), power.driving)
    turned = np.abs(np.fmod(after[:, 3] - before[:, 3], math.tau))
    turns = np.minimum(turned, math.tau - turned) > least
    stands = power.measuring if measuring else power.standing
    return np.where(ways > least, moves, np.where(turns, power.turning, stands))


def _open_circuit(charge: float) -> float:
    k = min(max(bisect_left(_CHARGES, charge), 1), len(_CURVE) - 1)
    (s0, v0), (s1, v1) = _CURVE[k - 1], _CURVE[k]
    return v0 + (charge - s0) / (s1 - s0) * (v1 - v0)
