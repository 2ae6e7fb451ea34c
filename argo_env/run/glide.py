"""Many time steps at once, in which a robot that touches nothing only goes on with what it does.

It drives along its path, measures or stands; nobody tells it anything, and no fault begins or ends.
All that adds up is the same as step by step, to the last bit.
"""

import math
from collections.abc import Sequence
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from argo_env.drives.battery import loads_of_steps
from argo_env.drives.powertrain import Powertrain
from argo_env.robot.pose import Place
from argo_env.run.action import ActionUnderWay
from argo_env.run.odometry import Odometry
from argo_env.run.power_supply import PowerState, PowerSupply
from argo_env.run.rig import Rig


class Glide:
    """The steps ahead. Holds how many of them have passed."""

    def __init__(
        self,
        rig: Rig,
        odometry: Odometry,
        supply: PowerSupply,
        action: ActionUnderWay | None,
        most: int,
    ) -> None:
        """At most so many steps; `steps` says how many there are, which may be none."""
        self._drive = rig.drive
        self._odometry = odometry
        self._supply = supply
        self._action = action
        self._passed = 0
        pose = rig.drive.pose
        self._here = here = (pose.x, pose.y, pose.z, pose.yaw, pose.pitch)
        self._ahead: list[tuple[Place, int]] | None = None
        self._power: Sequence[PowerState] = ()
        self.steps = 0
        """how many there are"""
        if (
            not isinstance(rig.drive, Powertrain)
            or odometry.touching
            or pose.roll
            or not rig.drive.glides
        ):
            return
        if action and action.driving:
            self._ahead = rig.drive.steps_ahead(most)
            places = [place for place, _ in self._ahead]
            points = [place[:3] for place in (here, *places)]
            # As the odometry adds them up: a root by NumPy may differ in its last bit.
            ways = np.array([*map(math.dist, points[:-1], points[1:])])
            rises = np.maximum(0.0, np.diff([z for _, _, z in points]))
        else:
            count = action.steps_measuring(most) if action else most
            places = [here] * count
            ways = rises = np.zeros(count)
        self._distance = _sums(odometry.distance, ways)
        self._climbed = _sums(odometry.climbed, rises)
        measuring = action is not None and action.measuring
        power, time_step = rig.navigator.robot.power, rig.drive.time_step
        table = np.array([here, *places])
        loads = loads_of_steps(power, ways, table, time_step, measuring)
        self._power = supply.ahead(loads, table[1:], time_step)
        self.steps = len(self._power)

    def places(self, count: int) -> Sequence[Place]:
        """Where the robot is after each of the first so many steps; nothing while it stands."""
        return () if self._ahead is None else [place for place, _ in self._ahead[:count]]

    def sample(self, step: int) -> tuple[Place, float | None]:
        """Where the robot is after so many of the steps, and the charge of its battery, 0 to 1."""
        place = self._here if self._ahead is None else self._ahead[step - 1][0]
        return place, self._supply.charge_at(self._power[step - 1])

    @property
    def charges(self) -> tuple[float, float]:
        """The least and the most charge of the battery after the steps, 0 to 1."""
        return self._supply.charges(self._power)

    def go_to(self, step: int, now: float) -> None:
        """So many of the steps have passed by time `now` (s)."""
        count = step - self._passed
        if self._ahead is not None:
            assert isinstance(self._drive, Powertrain)
            self._drive.go_on(self._ahead, self._passed, count)
        if self._action is not None:
            self._action.go_on(count, now)
        self._odometry.distance = self._distance[step]
        self._odometry.climbed = self._climbed[step]
        self._supply.go_to(self._power[step - 1])
        self._passed = step


def _sums(first: float, added: NDArray[np.float64]) -> list[float]:
    """What adds up, before the first step and after each: one by one, to the last bit."""
    return [*accumulate(added.tolist(), initial=first)]
