"""The battery in use: what the robot draws from it, and what a dock gives back."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.il.docked import DOCKED_DISTANCE_M, at_dock
from argo_env.drives.battery import Battery, load
from argo_env.robot.pose import BodyPose, Places
from argo_env.robot.spec import RobotSpec
from argo_env.run.log import Entry
from argo_env.site import Site


@dataclass(frozen=True, eq=False)
class PredictedSupply:
    """How the supply stands after each of n steps, arrays of the shape (n,)."""

    charging: NDArray[np.bool_]
    """whether the battery is being charged"""
    left: NDArray[np.float64]
    """Wh in the battery"""
    watts: NDArray[np.float64]
    """the load"""

    def __len__(self) -> int:
        return len(self.left)


NO_STEPS = PredictedSupply(np.empty(0, dtype=bool), np.empty(0), np.empty(0))


class PowerSupply:
    """Draws from a battery and charges it. Holds the battery and whether it is being charged."""

    def __init__(self, battery: Battery | None, robot: RobotSpec, site: Site) -> None:
        """Without a battery the robot has power without end."""
        self.charging = False
        self._battery = battery
        self._power = robot.power
        self._docks = tuple(site.docks.values())

    @property
    def charge(self) -> float | None:
        """Of the battery, 0 to 1."""
        return self._battery.charge if self._battery else None

    @property
    def empty(self) -> bool:
        """Whether the battery is."""
        return self._battery is not None and self._battery.empty

    def restore(self, entry: Entry) -> None:
        """Goes on from an entry."""
        if entry.charge is not None:
            self.begin(entry.charge, entry.body_pose)

    def begin(self, charge: float, pose: BodyPose) -> None:
        """Goes on with such a charge (0 to 1), the robot at `pose`."""
        if self._battery:
            self._battery.charge = charge
            # If it does not stand there, the next step shows it.
            self.charging = charge < 1.0 and self._docked(pose)

    def spend(self, before: BodyPose, after: BodyPose, seconds: float, measuring: bool) -> None:
        """Draws what the way between two poses took, or charges while the robot stands docked."""
        if self._battery is None:
            return
        watts = load(self._power, before, after, seconds, measuring)
        stands = watts in (self._power.standing, self._power.measuring)
        docked = stands and self._docked(after)
        self.charging = docked and self._battery.charge < 1.0
        if docked:
            # The station powers the robot, and what it gives besides goes into the battery.
            watts = -self._power.charging if self.charging else 0.0
        self._battery.use(watts, seconds)

    def ahead(self, loads: NDArray[np.float64], places: Places, seconds: float) -> PredictedSupply:
        """How it stands after each of n steps (s) with such loads (W), shape (n,), after which the
        robot is at these places: up to where the battery is empty, before which nothing can
        happen."""
        charging = np.zeros(len(loads), dtype=bool)
        if self._battery is None:
            return PredictedSupply(charging, np.zeros(len(loads)), np.zeros(len(loads)))
        docked = self._docked_after(loads, places)
        if docked.any():
            charging, left, loads = self._ahead_docked(loads, docked, seconds)
        else:
            before, _ = self._battery.state
            left = np.cumsum(np.concatenate([[before], -(loads * seconds / 3600.0)]))[1:]
        empty = left <= 0.0
        last = int(empty.argmax()) if empty.any() else len(left)
        return PredictedSupply(charging[:last], left[:last], loads[:last])

    def _ahead_docked(
        self, loads: NDArray[np.float64], docked: NDArray[np.bool_], seconds: float
    ) -> tuple[NDArray[np.bool_], NDArray[np.float64], NDArray[np.float64]]:
        """Whether it charges, Wh that are left and the load (W) after steps in some of which the
        robot is docked."""
        assert self._battery is not None
        (left, _), capacity = self._battery.state, self._battery.capacity
        states = []
        for watts, at_station in zip(loads.tolist(), docked.tolist(), strict=True):
            charging = at_station and left / capacity < 1.0
            if at_station:
                watts = -self._power.charging if charging else 0.0
            left = min(max(left - watts * seconds / 3600.0, 0.0), capacity)
            states.append((charging, left, watts))
        charges, lefts, drawn = (np.array(column) for column in zip(*states, strict=True))
        return charges, lefts, drawn

    def _docked_after(self, loads: NDArray[np.float64], places: Places) -> NDArray[np.bool_]:
        """After which of the steps the robot stands in a dock."""
        x, y = places[:, 0], places[:, 1]
        near = np.zeros(len(loads), dtype=bool)
        for dock in self._docks:
            near |= np.hypot(x - dock.x, y - dock.y) < 2 * DOCKED_DISTANCE_M
        near &= (loads == self._power.standing) | (loads == self._power.measuring)
        docked = np.zeros(len(loads), dtype=bool)
        if near.any():
            kinds, which = np.unique(places[near], axis=0, return_inverse=True)
            docked[near] = np.array([self._docked(BodyPose(*kind)) for kind in kinds])[which]
        return docked

    def go_to(self, ahead: PredictedSupply, step: int) -> None:
        """It stands as after that step, from 0, from now on."""
        self.charging = bool(ahead.charging[step])
        if self._battery is not None:
            self._battery.state = float(ahead.left[step]), float(ahead.watts[step])

    def charge_after(self, ahead: PredictedSupply, step: int) -> float | None:
        """Of the battery, 0 to 1, after that step, from 0."""
        return None if self._battery is None else float(ahead.left[step]) / self._battery.capacity

    def charges(self, ahead: PredictedSupply) -> tuple[float, float]:
        """The least and the most charge, 0 to 1, after the steps; full without a battery."""
        if self._battery is None or not len(ahead):
            return 1.0, 1.0
        least, most = float(ahead.left.min()), float(ahead.left.max())
        return least / self._battery.capacity, most / self._battery.capacity

    def _docked(self, pose: BodyPose) -> bool:
        return any(at_dock(pose, dock) for dock in self._docks)
