"""Many time steps at once, in which a robot that touches nothing only goes on with what it does.

It drives along its path, measures or stands; nobody tells it anything, and no fault begins or ends.
All that adds up is the same as step by step, to the last bit.
"""

import math

import numpy as np
from numpy.typing import NDArray

from argo_env.drives.battery import loads_of_steps
from argo_env.drives.powertrain import Powertrain, StepsAhead
from argo_env.robot.pose import Place, Places, place_of
from argo_env.run.action import ActionUnderWay
from argo_env.run.odometry import Odometry
from argo_env.run.power_supply import NO_STEPS, PowerSupply
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
        self._ahead: StepsAhead | None = None
        self._power = NO_STEPS
        self.steps = 0
        """how many there are"""
        if (
            not isinstance(rig.drive, Powertrain)
            or odometry.touching
            or rig.drive.pose.roll
            or not rig.drive.glides
        ):
            return
        pose = rig.drive.pose
        here = np.array([(pose.x, pose.y, pose.z, pose.yaw, pose.pitch)])
        if action and action.driving:
            self._ahead = rig.drive.steps_ahead(most)
            self._places = np.concatenate([here, self._ahead.places])
            # As the odometry adds them up: a root by NumPy may differ in its last bit.
            points = [*zip(*(self._places[:, k].tolist() for k in range(3)), strict=True)]
            ways = np.array([*map(math.dist, points[:-1], points[1:])])
            rises = np.maximum(0.0, np.diff(self._places[:, 2]))
        else:
            count = action.steps_measuring(most) if action else most
            self._places = here.repeat(count + 1, axis=0)
            ways = rises = np.zeros(count)
        self._distance = _sums(odometry.distance, ways)
        self._climbed = _sums(odometry.climbed, rises)
        measuring = action is not None and action.measuring
        power, time_step = rig.navigator.robot.power, rig.drive.time_step
        loads = loads_of_steps(power, ways, self._places, time_step, measuring)
        self._power = supply.ahead(loads, self._places[1:], time_step)
        self.steps = len(self._power)

    def places(self, count: int) -> Places:
        """Where the robot is after each of the first so many steps; none while it stands."""
        return self._places[1 : 1 if self._ahead is None else count + 1]

    def sample(self, step: int) -> tuple[Place, float | None]:
        """Where the robot is after so many of the steps, and the charge of its battery, 0 to 1."""
        charge = self._supply.charge_after(self._power, step - 1)
        return place_of(self._places, step), charge

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
        self._odometry.distance = float(self._distance[step])
        self._odometry.climbed = float(self._climbed[step])
        self._supply.go_to(self._power, step - 1)
        self._passed = step


def _sums(first: float, added: NDArray[np.float64]) -> NDArray[np.float64]:
    """What adds up, before the first step and after each: one by one, to the last bit."""
    return np.cumsum(np.concatenate([[first], added]))
