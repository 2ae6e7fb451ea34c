"""The action of a task: drive there, measure, and clean up when it is cancelled."""

import math
from collections.abc import Callable

from argo_compiler.errors import ArgoError, Unreachable
from argo_compiler.hfsm import ActionFailed, ActionStopped, ActionSucceeded
from argo_compiler.il import Action, Task
from argo_compiler.model import Pose
from argo_env.drives.drive import DriveStatus
from argo_env.navigation import Navigator, Path
from argo_env.navigation.blockage import leads_through
from argo_env.navigation.retreat import way_back
from argo_env.robot.pose import BodyPose
from argo_env.run.record import DIGITS, Reading, TaskRun
from argo_env.run.rig import Rig
from argo_env.sensing.sensor import Measurement, MeasurementError, PoorViewError

ActionEnd = ActionSucceeded | ActionFailed | ActionStopped

RETREAT = 1.0
"""m that the robot goes back where it is cornered"""
_NEAR = 0.15  # m: a cell's diagonal

TURNS = (0.0, math.radians(55.0), math.radians(-55.0))
"""rad that the face of a checkpoint is taken to be turned against the plan, one view after the
other: it may be turned by up to 90 degrees, and is read at up to 60 degrees"""


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
        came: Path | None = None,
    ) -> None:
        """`velocity` (m/s) is that of the way there, None the robot's own; then when (s) and after
        what way (m) it was started, and the path that the robot `came` by."""
        self.task = task
        self._started = started
        self._distance_before = distance_before
        self._climbed_before = climbed_before
        self.cancelled: str | None = None
        """why it was cancelled, if it was"""
        self.interrupted = False
        """whether it was cancelled by what only interrupts the mission"""
        self.measurement: Measurement | None = None
        self.path: Path | None = None
        """the way there, once it is planned"""
        self.came = came
        """the path that the robot came by, back along which it goes where it is cornered"""
        self._velocity = velocity
        self._rig = rig
        self._retreated = False
        self._views = 0  # that have been gone to
        self._left = 0.0  # s of the measurement, or until the arm is stowed
        self._measured: list[tuple[float, float]] = []  # s, from when to when
        self._since: float | None = None  # s, when the measurement began
        self._phase: Callable[[], ActionEnd | None] = self._set_off

    def step(self, now: float) -> ActionEnd | None:
        """Goes on for one time step of the drive, up to time `now` (s); returns how the action has
        ended, if it has."""
        end = self._phase()
        if self._since is None and self.measuring:
            self._since = now
        elif self._since is not None and (end is not None or not self.measuring):
            self._measured.append((self._since, now))
            self._since = None
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
        elif self._phase in (self._drive, self._turn_off, self._retreat):
            self._rig.drive.halt()
            self._phase = self._brake
        else:
            third = self._rig.navigator.robot.sensor.stowing_time
            raised_for = self._measuring_time - self._left
            if raised_for < 2 * third:
                self._left = min(raised_for, third)
                self._phase = self._stow

    def detour(self, rig: Rig) -> None:
        """Goes on with a rig whose navigator knows of something new in the way. If the present way
        leads there, the robot halts and takes another."""
        self._rig = rig
        navigator = rig.navigator
        blocked = self.path is not None and leads_through(
            self.path, navigator.blockages, navigator.robot
        )
        if blocked and self._phase == self._drive:
            self._retreated = False
            rig.drive.halt()
            self._phase = self._turn_off

    @property
    def measuring(self) -> bool:
        """Whether the arm is in motion or raised."""
        return self._phase in (self._measure, self._stow)

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
            views=self._views,
            confidence=round(self.measurement.confidence, DIGITS),
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
        under_way = () if self._since is None else ((self._since, now),)
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
            measuring=(*self._measured, *under_way),
        )

    @property
    def _measuring_time(self) -> float:
        return self._rig.navigator.robot.sensor.measuring_time

    def _set_off(self) -> ActionEnd | None:
        navigator, drive = self._rig.navigator, self._rig.drive
        may_retreat = self.came is not None and bool(navigator.blockages) and not self._retreated
        try:
            if may_retreat and not _is_free(navigator, drive.pose):
                return self._go_back()
            path = self._path()
        except Unreachable as error:
            if may_retreat:
                # From where there is room to turn there may be a way.
                return self._go_back()
            if self._views > 1:
                return self._look_again(str(error))
            return ActionFailed(self.task.name, str(error))
        except ArgoError as error:
            return ActionFailed(self.task.name, str(error))
        self.path = self.came = path
        drive.begin(path, self._velocity)
        self._phase = self._drive
        return self._drive()

    def _go_back(self) -> ActionEnd | None:
        """Sets off back the way that the robot came, to plan from there."""
        assert self.came is not None
        self._retreated = True
        back = way_back(self.came, _standing(self._rig.drive.pose), RETREAT)
        self._rig.drive.begin(back, self._velocity)
        self._phase = self._retreat
        return None

    def _retreat(self) -> ActionEnd | None:
        return self._then(self._set_off)

    def _turn_off(self) -> ActionEnd | None:
        return self._then(self._set_off)

    def _then(self, following: Callable[[], ActionEnd | None]) -> ActionEnd | None:
        """What follows when the drive has arrived, or come to rest."""
        match self._rig.drive.step():
            case DriveStatus.MOVING:
                return None
            case DriveStatus.FAILED:
                return self._drive_failed()
            case DriveStatus.ARRIVED:
                return following()

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
        except PoorViewError as error:
            return self._look_again(str(error))
        except MeasurementError as error:
            return ActionFailed(self.task.name, str(error))
        return ActionSucceeded(self.task.name, self.measurement.value)

    def _look_again(self, failure: str) -> ActionEnd | None:
        """Goes to the next view, as of a face that is turned; with none left, `failure` stands."""
        navigator, pose = self._rig.navigator, self._rig.drive.pose
        while self.cancelled is None and self._views < len(TURNS):
            turned = TURNS[self._views]
            self._views += 1
            try:
                path = navigator.plan_to_view(_standing(pose), self._checkpoint_id(), turned)
            except Unreachable:
                continue
            self._rig.world.move_arm(navigator.robot.arm_stowed)
            self.path = self.came = path
            self._rig.drive.begin(path, self._velocity)
            self._phase = self._drive
            return None
        return ActionFailed(self.task.name, failure)

    def _brake(self) -> ActionEnd | None:
        return self._then(self._stop)

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
        start = _standing(self._rig.drive.pose)
        if self.task.action is Action.MEASURE:
            self._views = max(1, self._views)
            turned = TURNS[self._views - 1]
            return self._rig.navigator.plan_to_view(start, self._checkpoint_id(), turned)
        if self.task.pose is None:
            raise Unreachable(f"task {self.task.name} has no pose")
        return self._rig.navigator.plan(start, self.task.pose)

    def _checkpoint_id(self) -> int:
        """The number of the task's checkpoint; ArgoError if the site does not have it."""
        return self._rig.navigator.site.measured_by(self.task.object_id).id


def _is_free(navigator: Navigator, pose: BodyPose) -> bool:
    """Whether a robot at `pose` has a place to set off from right there."""
    try:
        place = navigator.snap(_standing(pose))
    except Unreachable:
        return False
    return math.dist((place.x, place.y, place.z), (pose.x, pose.y, pose.z)) <= _NEAR


def _standing(pose: BodyPose) -> Pose:
    return Pose(x=pose.x, y=pose.y, z=pose.z, yaw=pose.yaw)
