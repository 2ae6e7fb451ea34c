"""Battery of the robot: the power drawn, the charge left, and the charge estimated from voltage.

The power that the robot draws on the level, on stairs and for its sensors is in the robot's own
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
"""greatest error of the estimated charge, as volts are measured to 10 mV"""
_MOVING = 0.02  # m/s or rad/s, above which the robot moves and does not only settle
_ON_STAIRS = math.radians(8.0)  # pitch, above which the robot is on stairs


class Battery:
    """Battery of the robot.

    It holds its capacity, the remaining energy and the load; faults change capacity and charge.
    """

    def __init__(self, robot: RobotSpec) -> None:
        self.capacity = robot.battery
        """energy of the full battery in Wh"""
        self._remaining = self.capacity
        self._load = 0.0

    @property
    def charge(self) -> float:
        """Remaining share of the capacity, 0 to 1."""
        return self._remaining / self.capacity

    @charge.setter
    def charge(self, share: float) -> None:
        self._remaining = share * self.capacity

    @property
    def is_empty(self) -> bool:
        return self._remaining <= 0.0

    def scale_capacity_and_energy(self, factor: float) -> None:
        """Multiply capacity and remaining energy by `factor`; the charge, their ratio, stays."""
        charge = self.charge
        self.capacity *= factor
        self.charge = charge

    def use(self, watts: float, seconds: float) -> None:
        """Draw power for some seconds, or charge the battery if `watts` is less than 0.

        The remaining energy stays between 0 and the capacity.
        """
        self._load = watts
        self._remaining = min(max(self._remaining - watts * seconds / 3600.0, 0.0), self.capacity)

    def steps_until_charged(self, estimate: float, watts: float, seconds: float, limit: int) -> int:
        """Return the number of steps after which the estimated charge first is `estimate` or more.

        The battery is charged: each step takes `seconds` with a load of `watts`, less than 0;
        `estimate` is 0 to 1. Returns `limit` if the estimate is not reached in fewer steps. The
        battery itself does not change.
        """
        simulated = copy(self)
        for count in range(limit):
            if estimated_charge(simulated.voltage, simulated.current) >= estimate:
                return count
            simulated.use(watts, seconds)
        return limit

    @property
    def energy_and_load(self) -> tuple[float, float]:
        """Remaining energy (Wh) and present load (W), less than 0 while the battery is charged."""
        return self._remaining, self._load

    @energy_and_load.setter
    def energy_and_load(self, energy_and_load: tuple[float, float]) -> None:
        self._remaining, self._load = energy_and_load

    @property
    def current(self) -> float:
        """Measured current in A; less than 0 while the battery is charged."""
        return self._load / _open_circuit(self.charge)

    @property
    def voltage(self) -> float:
        """Voltage in V, as measured to 10 mV under the present load."""
        return round(_open_circuit(self.charge) - RESISTANCE * self.current, 2)


def estimated_charge(voltage: float, current: float) -> float:
    """Return the charge, 0 to 1, that the measured voltage (V) and current (A) indicate."""
    rest = voltage + RESISTANCE * current
    k = min(max(bisect_left(_VOLTAGES, rest), 1), len(_CURVE) - 1)
    (s0, v0), (s1, v1) = _CURVE[k - 1], _CURVE[k]
    return min(max(s0 + (rest - v0) / (v1 - v0) * (s1 - s0), 0.0), 1.0)


def power_draw(
    power: PowerSpec, before: BodyPose, after: BodyPose, seconds: float, measuring: bool
) -> float:
    """Return the power (W) that the robot draws to move from one pose to another in `seconds`.

    `measuring` states whether it measures, which counts only while it stands.
    """
    distance = math.dist((before.x, before.y, before.z), (after.x, after.y, after.z))
    least = _MOVING * seconds
    if distance > least:
        if abs(after.pitch) > _ON_STAIRS:
            return power.climbing if after.z > before.z else power.descending
        return power.driving
    if abs(math.remainder(after.yaw - before.yaw, math.tau)) > least:
        return power.turning
    return power.measuring if measuring else power.standing


def power_draw_per_step(
    power: PowerSpec,
    distances: NDArray[np.float64],
    poses: NDArray[np.float64],
    seconds: float,
    measuring: bool,
) -> NDArray[np.float64]:
    """Return the power (W) that the robot draws in each of n steps of `seconds`, shape (n,).

    `distances` (m) of the steps have the shape (n,); `poses` before the first step and after each,
    which have no roll, the shape (n + 1, 5). The values equal those of `power_draw` to the last
    bit.
    """
    before, after = poses[:-1], poses[1:]
    least = _MOVING * seconds
    climbs = after[:, 2] > before[:, 2]
    steep = np.abs(after[:, 4]) > _ON_STAIRS
    moves = np.where(steep, np.where(climbs, power.climbing, power.descending), power.driving)
    turned = np.abs(np.fmod(after[:, 3] - before[:, 3], math.tau))
    turns = np.minimum(turned, math.tau - turned) > least
    stands = power.measuring if measuring else power.standing
    return np.where(distances > least, moves, np.where(turns, power.turning, stands))


def _open_circuit(charge: float) -> float:
    """Return the open-circuit voltage (V) at a charge, 0 to 1."""
    k = min(max(bisect_left(_CHARGES, charge), 1), len(_CURVE) - 1)
    (s0, v0), (s1, v1) = _CURVE[k - 1], _CURVE[k]
    return v0 + (charge - s0) / (s1 - s0) * (v1 - v0)
