"""The action of a task: drive there, measure, and clean up when it is cancelled."""

from collections.abc import Callable
from dataclasses import dataclass

from argo_compiler.errors import ArgoError
from argo_compiler.hfsm import ActionFailed, ActionStopped, ActionSucceeded
from argo_compiler.il import Action, Task
from argo_compiler.model import Pose
from argo_env.navigation import Navigator, Path, UnreachableError
from argo_env.record import DIGITS, Reading, TaskRun
from argo_env.robot.drive import Drive, DriveStatus
from argo_env.sensing.sensor import Measurement, MeasurementError, Sensor
from argo_env.world import World

ActionEnd = ActionSucceeded | ActionFailed | ActionStopped


@dataclass(frozen=True)
class Rig:
    """What a mission is carried out with."""

    world: World
    navigator: Navigator
    drive: Drive
    sensor: Sensor


class ActionUnderWay:
    """The action of one task. Changes with every step, from the first one to its end.

    A measurement takes the robot's measuring time: a third each to raise the arm, to look and to
    stow the arm. An action that is cancelled cleans up before it ends: the robot comes to rest, and
    an arm that has been raised is stowed. Once it has looked, it ends as if it had not been
    cancelled.
    """

    def __init__(
        self,
        task: Task,
        velocity: float | None,
        rig: Rig,
        started: float,
        distance_before: float,
        climbed_before: float,
    ) -> None:
        """`velocity` (m/s) is that of the way there, None the robot's own; the rest is when (s) and
        after what way (m) it was started."""
        self.task = task
        self._started = started
        self._distance_before = distance_before
        self._climbed_before = climbed_before
        self.cancelled: str | None = None
        """why it was cancelled, if it was"""
        self.interrupted = False
        """whether it was cancelled by what only interrupts the mission"""
        self.measurement: Measurement | None = None
        self._velocity = velocity
        self._rig = rig
        self._left = 0.0  # s of the measurement, or until the arm is stowed
        self._phase: Callable[[], ActionEnd | None] = self._set_off

    def step(self) -> ActionEnd | None:
        """Goes on for one time step of the drive; returns how the action has ended, if it has."""
        end = self._phase()
        if end is not None:
            self._rig.world.move_arm(self._rig.navigator.robot.arm_stowed)
            if isinstance(end, ActionFailed):
                self._rig.drive.halt()
        return end

    def cancel(self, reason: str, interrupted: bool) -> None:
        """Ends the action as soon as it has cleaned up; the following steps do that."""
        if self.cancelled is not None:
            return
        self.cancelled, self.interrupted = reason, interrupted
        if self._phase == self._set_off:
            self._phase = self._stop
        elif self._phase == self._drive:
            self._rig.drive.halt()
            self._phase = self._brake
        else:
            third = self._rig.navigator.robot.sensor.stowing_time
            raised_for = self._measuring_time - self._left
            if raised_for < 2 * third:
                self._left = min(raised_for, third)
                self._phase = self._stow

    def reading(self, now: float) -> Reading | None:
        """What was measured, at time `now` (s), if anything was."""
        if self.measurement is None:
            return None
        checkpoint = self._rig.navigator.site.checkpoint(self._checkpoint_id())
        value = self.measurement.value
        return Reading(
            checkpoint=checkpoint.id,
            name=checkpoint.name,
            kind=checkpoint.kind,
            floor=checkpoint.floor,
            task=self.task.name,
            t=now,
            value=value,
            unit=checkpoint.unit,
            nominal=checkpoint.nominal,
            normal=checkpoint.nominal.contains(value),
            distance=round(self.measurement.distance, DIGITS),
        )

    def run(self, end: ActionEnd, now: float, distance: float, climbed: float) -> TaskRun:
        """The action as it goes into the record: it ended at `now` (s), after the robot's whole way
        of `distance` and `climbed` (m)."""
        reason = end.reason if isinstance(end, ActionFailed) else None
        if isinstance(end, ActionSucceeded):
            outcome = "done"
        elif self.cancelled is None:
            outcome = "failed"
        else:
            outcome = "interrupted" if self.interrupted else "cancelled"
            reason = "; ".join(filter(None, (self.cancelled, reason)))
        return TaskRun(
            task=self.task.name,
            action=self.task.action,
            object_id=self.task.object_id,
            start=self._started,
            end=now,
            outcome=outcome,
            reason=reason,
            distance=round(distance - self._distance_before, DIGITS),
            climbed=round(climbed - self._climbed_before, DIGITS),
        )

    @property
    def _measuring_time(self) -> float:
        return self._rig.navigator.robot.sensor.measuring_time

    def _set_off(self) -> ActionEnd | None:
        try:
            self._rig.drive.begin(self._path(), self._velocity)
        except ArgoError as error:
            return ActionFailed(self.task.name, str(error))
        self._phase = self._drive
        return self._drive()

    def _drive(self) -> ActionEnd | None:
        match self._rig.drive.step():
            case DriveStatus.MOVING:
                return None
            case DriveStatus.FAILED:
                return self._drive_failed()
            case DriveStatus.ARRIVED if self.task.action is Action.MEASURE:
                self._left = self._measuring_time
                self._rig.world.move_arm(self._rig.navigator.robot.arm_raised)
                self._phase = self._measure
                return None
            case DriveStatus.ARRIVED:
                return ActionSucceeded(self.task.name)

    def _measure(self) -> ActionEnd | None:
        if not self._time_over():
            return None
        try:
            self.measurement = self._rig.sensor.measure(self._checkpoint_id(), self._rig.drive.pose)
        except MeasurementError as error:
            return ActionFailed(self.task.name, str(error))
        return ActionSucceeded(self.task.name, self.measurement.value)

    def _brake(self) -> ActionEnd | None:
        match self._rig.drive.step():
            case DriveStatus.MOVING:
                return None
            case DriveStatus.FAILED:
                return self._drive_failed()
            case DriveStatus.ARRIVED:
                return self._stop()

    def _stow(self) -> ActionEnd | None:
        return self._stop() if self._time_over() else None

    def _stop(self) -> ActionEnd:
        return ActionStopped(self.task.name)

    def _drive_failed(self) -> ActionFailed:
        return ActionFailed(self.task.name, self._rig.drive.failure or "the drive failed")

    def _time_over(self) -> bool:
        self._left -= self._rig.drive.time_step
        return self._left <= 1e-9

    def _path(self) -> Path:
        here = self._rig.drive.pose
        start = Pose(x=here.x, y=here.y, z=here.z, yaw=here.yaw)
        if self.task.action is Action.MEASURE:
            return self._rig.navigator.plan_to_view(start, self._checkpoint_id())
        if self.task.pose is None:
            raise UnreachableError(f"task {self.task.name} has no pose")
        return self._rig.navigator.plan(start, self.task.pose)

    def _checkpoint_id(self) -> int:
        """The number of the task's checkpoint; UnreachableError if the site does not have it."""
        site = self._rig.navigator.site
        known = {str(c.id): c.id for c in site.checkpoints}
        if self.task.object_id not in known:
            raise UnreachableError(f"site {site.name} has no checkpoint {self.task.object_id}")
        return known[self.task.object_id]
