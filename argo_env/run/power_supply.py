"""The battery in use: what the robot draws from it, and what a dock gives back."""

from collections.abc import Sequence
from itertools import repeat, takewhile

import numpy as np
from numpy.typing import NDArray

from argo_compiler.il.docked import DOCKED_DISTANCE_M, at_dock
from argo_env.drives.battery import Battery, load
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import RobotSpec
from argo_env.run.log import Entry
from argo_env.site import Site

PowerState = tuple[bool, float, float]
"""whether the battery is being charged, Wh that are left in it, and the load (W)"""


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

    def ahead(
        self, loads: NDArray[np.float64], places: NDArray[np.float64], seconds: float
    ) -> list[PowerState]:
        """How it stands after each of n steps (s) with such loads (W), shape (n,), after which the
        robot is at these places, shape (n, 5): up to where the battery is empty, before which
        nothing can happen."""
        if self._battery is None:
            return [(False, 0.0, 0.0)] * len(loads)
        before, _ = self._battery.state
        docked = self._docked_after(loads, places)
        if docked.any():
            return self._ahead_docked(loads.tolist(), docked.tolist(), seconds)
        left = np.cumsum(np.concatenate([[before], -(loads * seconds / 3600.0)]))[1:]
        states = zip(repeat(False), left.tolist(), loads.tolist())
        return [*takewhile(lambda state: state[1] > 0.0, states)]

    def _ahead_docked(
        self, loads: Sequence[float], docked: Sequence[bool], seconds: float
    ) -> list[PowerState]:
        """The same for steps in some of which the robot is docked."""
        assert self._battery is not None
        (left, _), capacity = self._battery.state, self._battery.capacity
        states: list[PowerState] = []
        for watts, at_station in zip(loads, docked, strict=True):
            charging = at_station and left / capacity < 1.0
            if at_station:
                watts = -self._power.charging if charging else 0.0
            left = min(max(left - watts * seconds / 3600.0, 0.0), capacity)
            if left <= 0.0:
                break
            states.append((charging, left, watts))
        return states

    def _docked_after(
        self, loads: NDArray[np.float64], places: NDArray[np.float64]
    ) -> NDArray[np.bool_]:
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

    def go_to(self, state: PowerState) -> None:
        """It stands like this from now on."""
        self.charging, *battery = state
        if self._battery is not None:
            self._battery.state = battery[0], battery[1]

    def charge_at(self, state: PowerState) -> float | None:
        """Of the battery, 0 to 1, when it stands like this."""
        return None if self._battery is None else state[1] / self._battery.capacity

    def charges(self, states: Sequence[PowerState]) -> tuple[float, float]:
        """The least and the most charge, 0 to 1, of some such states; full without a battery."""
        if self._battery is None or not states:
            return 1.0, 1.0
        left = [state[1] for state in states]
        return min(left) / self._battery.capacity, max(left) / self._battery.capacity

    def _docked(self, pose: BodyPose) -> bool:
        return any(at_dock(pose, dock) for dock in self._docks)
