"""Power supply of the robot: the battery, what the robot draws from it, and charging in a dock."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.il.docked import DOCKED_DISTANCE_M, is_at_dock
from argo_env.drives.battery import Battery, power_draw
from argo_env.robot.pose import BodyPose, PoseArray
from argo_env.robot.spec import RobotSpec
from argo_env.run.log import Entry
from argo_env.site import Site


@dataclass(frozen=True, eq=False)
class PredictedSupply:
    """Predicted state of the supply after each of n steps, as arrays of the shape (n,)."""

    charging: NDArray[np.bool_]
    """whether the battery is being charged"""
    remaining: NDArray[np.float64]
    """energy in the battery in Wh"""
    watts: NDArray[np.float64]
    """load in W; negative while charging"""

    def __len__(self) -> int:
        return len(self.remaining)


NO_STEPS = PredictedSupply(np.empty(0, dtype=bool), np.empty(0), np.empty(0))


class PowerSupply:
    """Power supply of one run, which changes the battery's charge with each step.

    It holds the battery and whether it is being charged.
    """

    def __init__(self, battery: Battery | None, robot: RobotSpec, site: Site) -> None:
        """Take the battery; without one the robot's power never ends."""
        self.charging = False
        self._battery = battery
        self._power = robot.power
        self._docks = tuple(site.docks.values())

    @property
    def charge(self) -> float | None:
        """Charge of the battery, 0 to 1; None without a battery."""
        return self._battery.charge if self._battery else None

    @property
    def empty(self) -> bool:
        """True if the battery is empty."""
        return self._battery is not None and self._battery.is_empty

    def restore(self, entry: Entry) -> None:
        """Restore the battery's charge from an entry of the log."""
        if entry.charge is not None:
            self.set_charge(entry.charge, entry.body_pose)

    def set_charge(self, charge: float, pose: BodyPose) -> None:
        """Set the charge (0 to 1) of the battery, if any; it is charging if `pose` is in a dock."""
        if self._battery:
            self._battery.charge = charge
            # If the robot does not stand still there, the next step corrects this.
            self.charging = charge < 1.0 and self._docked(pose)

    def consume(self, before: BodyPose, after: BodyPose, seconds: float, measuring: bool) -> None:
        """Draw the energy of a step of `seconds`, or charge the battery if the robot is docked.

        The step has led from the pose `before` to `after`; `measuring` states that the robot
        measures.
        """
        if self._battery is None:
            return
        watts = power_draw(self._power, before, after, seconds, measuring)
        stands = watts in (self._power.standing, self._power.measuring)
        docked = stands and self._docked(after)
        self.charging = docked and self._battery.charge < 1.0
        if docked:
            # The station powers the robot and charges the battery.
            watts = -self._power.charging if self.charging else 0.0
        self._battery.use(watts, seconds)

    def predict_until_empty(
        self, loads: NDArray[np.float64], places: PoseArray, step_seconds: float
    ) -> PredictedSupply:
        """Predict the supply after each of n steps, but no further than the battery lasts.

        Args:
            loads: power in W that the robot draws in each step, shape (n,).
            places: poses of the robot after the steps, shape (n, 5).
            step_seconds: duration of a step in s.

        Returns:
            The prediction for the steps before the one that empties the battery; that step is to
            be made alone, because the run may end in it.
        """
        charging = np.zeros(len(loads), dtype=bool)
        if self._battery is None:
            return PredictedSupply(charging, np.zeros(len(loads)), np.zeros(len(loads)))
        docked = self._docked_after(loads, places)
        if docked.any():
            charging, remaining, loads = self._predict_docked(loads, docked, step_seconds)
        else:
            current, _ = self._battery.energy_and_load
            remaining = np.cumsum(np.concatenate([[current], -(loads * step_seconds / 3600.0)]))[1:]
        empty = remaining <= 0.0
        last = int(empty.argmax()) if empty.any() else len(remaining)
        return PredictedSupply(charging[:last], remaining[:last], loads[:last])

    def _predict_docked(
        self, loads: NDArray[np.float64], docked: NDArray[np.bool_], step_seconds: float
    ) -> tuple[NDArray[np.bool_], NDArray[np.float64], NDArray[np.float64]]:
        """Return, after each step, whether it charges, the remaining energy (Wh) and the load (W).

        `docked` states for each step whether the robot stands in a dock.
        """
        assert self._battery is not None
        (remaining, _), capacity = self._battery.energy_and_load, self._battery.capacity
        states = []
        for watts, at_station in zip(loads.tolist(), docked.tolist(), strict=True):
            charging = at_station and remaining / capacity < 1.0
            if at_station:
                watts = -self._power.charging if charging else 0.0
            remaining = min(max(remaining - watts * step_seconds / 3600.0, 0.0), capacity)
            states.append((charging, remaining, watts))
        charges, remainders, drawn = (np.array(column) for column in zip(*states, strict=True))
        return charges, remainders, drawn

    def _docked_after(self, loads: NDArray[np.float64], places: PoseArray) -> NDArray[np.bool_]:
        """Return, for each step, whether the robot stands in a dock after it, shape (n,)."""
        x, y = places[:, 0], places[:, 1]
        near = np.zeros(len(loads), dtype=bool)
        for dock in self._docks:
            near |= np.hypot(x - dock.x, y - dock.y) < 2 * DOCKED_DISTANCE_M
        near &= (loads == self._power.standing) | (loads == self._power.measuring)
        docked = np.zeros(len(loads), dtype=bool)
        if near.any():
            distinct, indices = np.unique(places[near], axis=0, return_inverse=True)
            docked[near] = np.array([self._docked(BodyPose(*pose)) for pose in distinct])[indices]
        return docked

    def apply(self, predicted: PredictedSupply, step_index: int) -> None:
        """Set the supply to the predicted state after the step of this index, from 0."""
        self.charging = bool(predicted.charging[step_index])
        if self._battery is not None:
            self._battery.energy_and_load = (
                float(predicted.remaining[step_index]),
                float(predicted.watts[step_index]),
            )

    def charge_after(self, predicted: PredictedSupply, step_index: int) -> float | None:
        """Return the predicted charge (0 to 1) after the step of this index, from 0.

        It is None without a battery.
        """
        return (
            None
            if self._battery is None
            else float(predicted.remaining[step_index]) / self._battery.capacity
        )

    def charge_range(self, predicted: PredictedSupply) -> tuple[float, float]:
        """Return the lowest and highest predicted charge, 0 to 1; 1 without a battery or steps."""
        if self._battery is None or not len(predicted):
            return 1.0, 1.0
        least, most = float(predicted.remaining.min()), float(predicted.remaining.max())
        return least / self._battery.capacity, most / self._battery.capacity

    def can_charge_at(self, pose: BodyPose) -> bool:
        """Return True if the battery is charged while the robot stands at this pose."""
        return self._battery is not None and self._battery.charge < 1.0 and self._docked(pose)

    def _docked(self, pose: BodyPose) -> bool:
        return any(is_at_dock(pose, dock) for dock in self._docks)
