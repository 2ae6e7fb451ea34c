"""The robot under way: step by step it moves, spends power, and notices things.

A robot that touches nothing only goes on with what it does for many time steps: it drives along its
path, measures or stands; nobody tells it anything, and no fault begins or ends. These are made at
once, and all that adds up is the same as step by step, to the last bit.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.model import Pose
from argo_compiler.hfsm import StartAction
from argo_env.drives.battery import loads_of_steps
from argo_env.drives.powertrain import Powertrain, StepsAhead
from argo_env.navigation import Blockage, Path
from argo_env.navigation.retreat import driven, recent
from argo_env.robot.pose import BodyPose, Place, Places, place_of
from argo_env.run.action import RETREAT, SimulatedAction
from argo_env.run.initial_state import InitialState
from argo_env.run.log import Entry, RunLog
from argo_env.run.odometry import Odometry
from argo_env.run.perception import Perception, blockage_from_anomaly, located_anomaly
from argo_env.run.power_supply import NO_STEPS, PowerSupply
from argo_env.run.record import Anomaly
from argo_env.run.robot import RobotAction, Sensed
from argo_env.run.run_setup import RunSetup


class Glide:
    """The steps ahead. Holds how many of them have passed."""

    def __init__(
        self,
        setup: RunSetup,
        odometry: Odometry,
        supply: PowerSupply,
        action: SimulatedAction | None,
        most: int,
    ) -> None:
        """At most so many steps; `steps` says how many there are, which may be none."""
        self._drive = setup.drive
        self._odometry = odometry
        self._supply = supply
        self._action = action
        self._passed = 0
        self._ahead: StepsAhead | None = None
        self._power = NO_STEPS
        self.steps = 0
        """how many there are"""
        if (
            not isinstance(setup.drive, Powertrain)
            or odometry.touching
            or setup.drive.pose.roll
            or not setup.drive.glides
        ):
            return
        pose = setup.drive.pose
        here = np.array([(pose.x, pose.y, pose.z, pose.yaw, pose.pitch)])
        if action and action.is_driving:
            self._ahead = setup.drive.steps_ahead(most)
            self._places = np.concatenate([here, self._ahead.places])
            # As the odometry adds them up: a root by NumPy may differ in its last bit.
            points = [*zip(*(self._places[:, k].tolist() for k in range(3)), strict=True)]
            ways = np.array([*map(math.dist, points[:-1], points[1:])])
            rises = np.maximum(0.0, np.diff(self._places[:, 2]))
        else:
            count = action.count_measuring_steps(most) if action else most
            self._places = here.repeat(count + 1, axis=0)
            ways = rises = np.zeros(count)
        self._distance = _sums(odometry.distance, ways)
        self._climbed = _sums(odometry.climbed, rises)
        measuring = action is not None and action.is_measuring
        power, time_step = setup.navigator.robot.power, setup.drive.time_step
        loads = loads_of_steps(power, ways, self._places, time_step, measuring)
        self._power = supply.predict(loads, self._places[1:], time_step)
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
        return self._supply.charge_range(self._power)

    def go_to(self, step: int, now: float) -> None:
        """So many of the steps have passed by time `now` (s)."""
        count = step - self._passed
        if self._ahead is not None:
            assert isinstance(self._drive, Powertrain)
            self._drive.go_on(self._ahead, self._passed, count)
        if self._action is not None:
            self._action.skip_steps(count, now)
        self._odometry.distance = float(self._distance[step])
        self._odometry.climbed = float(self._climbed[step])
        self._supply.apply(self._power, step - 1)
        self._passed = step


def _sums(first: float, added: NDArray[np.float64]) -> NDArray[np.float64]:
    """What adds up, before the first step and after each: one by one, to the last bit."""
    return np.cumsum(np.concatenate([[first], added]))


_NOTHING = Sensed()


class Vehicle:
    """The simulated robot: what a run is carried out with. Holds the setup and all that adds up on
    the way."""

    silent_since: float | None = None

    def __init__(self, setup: RunSetup) -> None:
        site, robot = setup.navigator.site, setup.navigator.robot
        self.setup = setup
        """its navigator knows of what was found in the way"""
        self.odometry = Odometry(site)
        self.supply = PowerSupply(setup.battery, robot, site)
        self._action: SimulatedAction | None = None
        """the one started last"""
        self._perception = Perception(setup.watches, site, setup.drive.time_step)

    def place(self, pose: BodyPose, now: float) -> None:
        """Puts the robot there, at time `now` (s)."""
        self.setup.drive.place(pose)
        self.update_faults(now)

    def apply_initial_state(self, initial: InitialState) -> None:
        """Goes on from where another run stood."""
        self.odometry.distance, self.odometry.climbed = initial.distance, initial.climbed
        if initial.charge is not None:
            self.supply.reset(initial.charge, initial.body_pose)
        known = [one.anomaly for one in initial.known]
        if closed := [b for anomaly in known if (b := blockage_from_anomaly(anomaly))]:
            self.avoid(closed)

    def restore_anomalies(self, reported: Sequence[tuple[Anomaly, BodyPose]], now: float) -> None:
        """Goes on at time `now` (s) after these have been found, with the robot at these poses."""
        self._perception.restore_anomalies(reported, now)

    def restore(self, last: Entry) -> None:
        """Goes on after the entry."""
        self.odometry.restore(last)
        self.supply.restore(last)

    def update_faults(self, now: float) -> None:
        """Lets all begin and end that is due at time `now` (s)."""
        if self.setup.schedule:
            self.setup.schedule.advance(now)

    def avoid(self, blockages: Sequence[Blockage]) -> None:
        """From now on paths keep clear of these as well."""
        navigator = self.setup.navigator.avoiding(blockages)
        self.setup = replace(self.setup, navigator=navigator)

    def start(self, command: StartAction, now: float, arrival_path: Path | None) -> RobotAction:
        """Starts an action at time `now` (s), after the robot `came` by that path."""
        way = self.odometry
        self._action = SimulatedAction(
            command, self.setup, now, way.distance, way.climbed, arrival_path
        )
        return self._action

    def advance(self, step: int, now: float, action: RobotAction | None) -> Sensed:
        """Lets the time step of that number pass, up to time `now` (s), with `action` under way."""
        setup, odometry, drive = self.setup, self.odometry, self.setup.drive
        if setup.schedule:
            setup.schedule.advance(now)
        before = after = drive.pose
        end, measuring = None, False
        own = self._action if action else None
        if own:
            end = own.step(now)
            after, measuring = drive.pose, own.is_measuring
            odometry.add_motion(before, after, setup.world.touches(), now)
            odometry.add_incidents(drive.incidents, now)
        self.supply.consume(before, after, drive.time_step, measuring)
        found = self._perception.update(step, now, after)
        reading = own.reading(now) if own and end else None
        if reading and not reading.normal:
            found = (*found, located_anomaly(reading, setup.navigator.site))
        return Sensed(end, reading, found) if end or found else _NOTHING

    @property
    def glides(self) -> bool:
        """Whether many steps can be made at once, as nothing can happen to the robot."""
        drive = self.setup.drive
        return isinstance(drive, Powertrain) and drive.glides

    def glide(self, action: RobotAction | None, most: int) -> Glide:
        """The steps ahead, at most so many, in which it only goes on with `action`."""
        own = self._action if action else None
        return Glide(self.setup, self.odometry, self.supply, own, most)

    def update_steps(self, glide: Glide, first: int) -> set[int]:
        """The numbers of the steps of a glide, which begin with the `first`, in which it looks
        whether there is anything."""
        last = first + glide.steps - 1
        return self._perception.update_steps(first, last, glide.charges)

    def look(self, step: int, now: float) -> Sensed:
        """What it notices in that step of a glide, which ends at `now` (s)."""
        found = self._perception.update(step, now, self.setup.drive.pose)
        return Sensed(found=found) if found else _NOTHING

    def state(self) -> dict[str, Any]:
        """What an entry tells of it."""
        pose, odometry = self.setup.drive.pose, self.odometry
        return {
            "pose": (pose.x, pose.y, pose.z, pose.yaw, pose.pitch),
            "distance": odometry.distance,
            "climbed": odometry.climbed,
            "charge": self.supply.charge,
            "mishaps": tuple(odometry.mishaps),
            "contacts": tuple(odometry.ended_contacts),
            "touching": odometry.touching,
        }

    def clear_reported(self) -> None:
        """What the last `state` told is not told again."""
        self.odometry.ended_contacts.clear()
        self.odometry.mishaps.clear()


def find_arrival_path(log: RunLog) -> Path | None:
    """The last piece of the path that the robot came by, from where the log has seen it."""
    if not log.path:
        return None
    seen = (Pose(x=s.x, y=s.y, z=s.z, yaw=s.yaw) for s in reversed(log.path))
    return driven(recent(seen, 2 * RETREAT))
