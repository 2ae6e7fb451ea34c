"""Simulated robot: in each time step it moves, uses power, and notices anomalies.

For many time steps a robot that touches nothing only continues what it does: it drives along its
path, measures or stands, and no event occurs and no fault begins or ends. Such steps are made in
one batch, with the same results as step by step, to the last bit.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.model import Pose
from argo_compiler.hfsm import AwaitedCharge, StartAction
from argo_compiler.il import EventKind
from argo_env.drives.battery import power_draw_per_step
from argo_env.drives.powertrain import Powertrain, StepsAhead
from argo_env.navigation import Blockage, Path
from argo_env.navigation.retreat import path_through, recent_poses
from argo_env.robot.pose import BodyPose, PoseArray, PoseTuple, pose_tuple_at
from argo_env.run.action import RETREAT, SimulatedAction
from argo_env.run.initial_state import InitialState
from argo_env.run.log import Entry, RunLog
from argo_env.run.odometry import Odometry
from argo_env.run.perception import Perception, anomaly_at_checkpoint, blockage_from_anomaly
from argo_env.run.power_supply import NO_STEPS, PowerSupply
from argo_env.run.record import Anomaly
from argo_env.run.robot import RobotAction, Sensed
from argo_env.run.run_setup import RunSetup
from argo_env.sensing.battery_watch import BatteryWatch
from argo_env.sensing.signals.alarm_watch import AlarmWatch


class StepBatch:
    """Batch of the next time steps; holds how many of them have passed."""

    def __init__(
        self,
        setup: RunSetup,
        odometry: Odometry,
        supply: PowerSupply,
        action: SimulatedAction | None,
        limit: int,
    ) -> None:
        """Predict the next steps, at most `limit` and perhaps none, with `action` running."""
        self._drive = setup.drive
        self._odometry = odometry
        self._supply = supply
        self._action = action
        self._passed_steps = 0
        self._ahead: StepsAhead | None = None
        self._power = NO_STEPS
        self.steps = 0
        """number of steps in the batch"""
        if (
            not isinstance(setup.drive, Powertrain)
            or odometry.touching
            or setup.drive.pose.roll
            or not setup.drive.can_batch_steps
        ):
            return
        pose = setup.drive.pose
        here = np.array([(pose.x, pose.y, pose.z, pose.yaw, pose.pitch)])
        if action and action.is_driving_without_reading_limit:
            self._ahead = setup.drive.steps_ahead(limit)
            self._poses = np.concatenate([here, self._ahead.poses])
            # By math.dist, as in the odometry: NumPy's square root may differ in the last bit.
            points = [*zip(*(self._poses[:, k].tolist() for k in range(3)), strict=True)]
            distances = np.array([*map(math.dist, points[:-1], points[1:])])
            rises = np.maximum(0.0, np.diff(self._poses[:, 2]))
        else:
            count = action.count_measuring_steps(limit) if action else limit
            self._poses = here.repeat(count + 1, axis=0)
            distances = rises = np.zeros(count)
        self._distance = _running_sums(odometry.distance, distances)
        self._climbed = _running_sums(odometry.climbed, rises)
        measuring = action is not None and action.is_measuring
        power, time_step = setup.navigator.robot.power, setup.drive.time_step
        loads = power_draw_per_step(power, distances, self._poses, time_step, measuring)
        self._power = supply.predict_until_empty(loads, self._poses[1:], time_step)
        self.steps = len(self._power)

    def poses_until(self, count: int) -> PoseArray:
        """Return the robot's pose after each of the first `count` steps; no row if it stands."""
        return self._poses[1 : 1 if self._ahead is None else count + 1]

    def pose_and_charge(self, step: int) -> tuple[PoseTuple, float | None]:
        """Return the robot's pose after `step` steps, and the battery's charge then, 0 to 1.

        The charge is None without a battery.
        """
        charge = self._supply.charge_after(self._power, step - 1)
        return pose_tuple_at(self._poses, step), charge

    @property
    def charge_range(self) -> tuple[float, float]:
        """Lowest and highest charge of the battery in the batch, 0 to 1; 1 without a battery."""
        return self._supply.charge_range(self._power)

    def advance_to(self, step: int, now: float) -> None:
        """Set the robot to its state after `step` steps of the batch, at time `now` (s)."""
        count = step - self._passed_steps
        if self._ahead is not None:
            assert isinstance(self._drive, Powertrain)
            self._drive.make_predicted_steps(self._ahead, self._passed_steps, count)
        if self._action is not None:
            self._action.skip_steps(count, now)
        self._odometry.distance = float(self._distance[step])
        self._odometry.climbed = float(self._climbed[step])
        self._supply.apply(self._power, step - 1)
        self._passed_steps = step


def _running_sums(first: float, added: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return `first` and, after each step, its sum with the values added so far.

    The sums are rounded as if the values were added one by one.
    """
    return np.cumsum(np.concatenate([[first], added]))


_NOTHING_SENSED = Sensed()


class Vehicle:
    """Simulated robot, which carries out a run.

    It holds the run setup and all that changes with each step: odometry, power supply, perception
    and the running action.
    """

    silent_since: float | None = None

    def __init__(self, setup: RunSetup) -> None:
        site, robot = setup.navigator.site, setup.navigator.robot
        self.setup = setup
        """the run setup; its navigator knows the blockages found so far"""
        self.odometry = Odometry(site)
        self.supply = PowerSupply(setup.battery, robot, site)
        self._action: SimulatedAction | None = None
        """the action that was started last"""
        self._perception = Perception(setup.watches, site, setup.drive.time_step)
        self._battery_watch = next((w for w in setup.watches if isinstance(w, BatteryWatch)), None)
        self._alarm_watch = next((w for w in setup.watches if isinstance(w, AlarmWatch)), None)

    def begin_at(self, pose: BodyPose, now: float) -> None:
        """Begin or continue a run at time `now` (s): set the robot's pose and update the faults."""
        self.setup.drive.place_robot(pose)
        self.update_faults(now)

    def apply_initial_state_except_pose(self, initial: InitialState) -> None:
        """Set odometry, charge and known blockages for a run that continues another run."""
        self.odometry.distance, self.odometry.climbed = initial.distance, initial.climbed
        if initial.charge is not None:
            self.supply.set_charge(initial.charge, initial.body_pose)
        anomalies = [known.anomaly for known in initial.known]
        if closed := [b for anomaly in anomalies if (b := blockage_from_anomaly(anomaly))]:
            self.add_blockages(closed)

    def restore_anomalies(self, reported: Sequence[tuple[Anomaly, BodyPose]], now: float) -> None:
        """Restore anomalies found before time `now` (s), each with the robot's pose then.

        The watches do not report them again.
        """
        self._perception.restore_anomalies(reported, now)

    def restore(self, last: Entry) -> None:
        """Restore the odometry and the power supply from the last entry."""
        self.odometry.restore(last)
        self.supply.restore(last)
        if self._battery_watch is not None:
            self._battery_watch.alarm_level = last.battery_alarm
        if self._alarm_watch is not None:
            self._alarm_watch.loudest = last.alarm_power

    def set_mission_state(
        self, awaited: tuple[AwaitedCharge, ...], reaction: EventKind | None
    ) -> None:
        """Set the charges for which the mission waits now, and the event to which it reacts."""
        self._perception.reaction = reaction
        if self._battery_watch is not None:
            self._battery_watch.awaited = awaited
            self._battery_watch.is_answered = reaction is EventKind.LOW_BATTERY

    @property
    def expects_awaited_charge(self) -> bool:
        watch = self._battery_watch
        if watch is None or not watch.awaited:
            return False
        return watch.has_awaited_charge or self.supply.can_charge_at(self.setup.drive.pose)

    def update_faults(self, now: float) -> None:
        """Begin and end the faults that are due at time `now` (s)."""
        if self.setup.schedule:
            self.setup.schedule.advance(now)

    def add_blockages(self, blockages: Sequence[Blockage]) -> None:
        """Make paths planned from now on keep clear of these blockages, besides the known ones."""
        navigator = self.setup.navigator.with_added_blockages(blockages)
        self.setup = replace(self.setup, navigator=navigator)

    def prepare_action(
        self, command: StartAction, now: float, arrived_by: Path | None
    ) -> RobotAction:
        """Return an action that begins at `now` (s); the robot came here by `arrived_by`."""
        odometry = self.odometry
        self._action = SimulatedAction(
            command, self.setup, now, odometry.distance, odometry.climbed, arrived_by
        )
        return self._action

    def advance(self, step: int, now: float, action: RobotAction | None) -> Sensed:
        """Let time step number `step` pass, up to time `now` (s), and return what it has led to.

        `action` is the running action, if there is one.
        """
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
            odometry.add_new_incidents(drive.incidents, now)
        self.supply.consume(before, after, drive.time_step, measuring)
        found = self._perception.update(step, now, after)
        reading = own.make_reading_if_measured(now) if own and end else None
        if reading and not reading.normal:
            found = (*found, anomaly_at_checkpoint(reading, setup.navigator.site))
        return Sensed(end, reading, found) if end or found else _NOTHING_SENSED

    @property
    def can_batch_steps(self) -> bool:
        """True if the robot can touch nothing where it is now: steps can be made in batches."""
        drive = self.setup.drive
        return isinstance(drive, Powertrain) and drive.can_batch_steps

    def batch_steps(self, action: RobotAction | None, limit: int) -> StepBatch:
        """Predict the next steps, at most `limit`, in which the robot only continues what it does.

        That is `action`; None: it stands. None of the steps has passed yet.
        """
        own = self._action if action else None
        return StepBatch(self.setup, self.odometry, self.supply, own, limit)

    def steps_with_updates(self, batch: StepBatch, first: int) -> set[int]:
        """Return the numbers of the batch's steps in which a watch has to be updated.

        The first step of the batch has the number `first`.
        """
        last = first + batch.steps - 1
        return self._perception.steps_with_updates(first, last, batch.charge_range)

    def update_watches(self, step: int, now: float) -> Sensed:
        """Return what the watches notice in step number `step` of a batch, at time `now` (s)."""
        found = self._perception.update(step, now, self.setup.drive.pose)
        return Sensed(found=found) if found else _NOTHING_SENSED

    def state_for_entry(self) -> dict[str, Any]:
        """Return the robot's present state as fields of an `Entry` of the log, by name.

        These are pose, distance, climb, charge, the level of the next report of a low battery, the
        loudest alarm and open contacts, and the mishaps and ended contacts that no entry has yet.
        """
        pose, odometry = self.setup.drive.pose, self.odometry
        return {
            "pose": (pose.x, pose.y, pose.z, pose.yaw, pose.pitch),
            "distance": odometry.distance,
            "climbed": odometry.climbed,
            "charge": self.supply.charge,
            "battery_alarm": self._battery_watch.alarm_level if self._battery_watch else None,
            "alarm_power": self._alarm_watch.loudest if self._alarm_watch else None,
            "mishaps": tuple(odometry.mishaps),
            "contacts": tuple(odometry.ended_contacts),
            "touching": odometry.touching,
        }

    def clear_mishaps_and_ended_contacts(self) -> None:
        """Forget the mishaps and ended contacts so far, as an entry now has them."""
        self.odometry.ended_contacts.clear()
        self.odometry.mishaps.clear()


def find_last_path_part(log: RunLog) -> Path | None:
    """Return the last part of the path by which the robot reached its pose, from the log.

    It is long enough to retreat along it. None if the log has no path.
    """
    if not log.path:
        return None
    poses = (Pose(x=s.x, y=s.y, z=s.z, yaw=s.yaw) for s in reversed(log.path))
    return path_through(recent_poses(poses, 2 * RETREAT))
