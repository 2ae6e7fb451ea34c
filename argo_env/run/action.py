"""The action of a task: drive there, measure, and clean up when it is cancelled."""

import math
from collections.abc import Callable

from argo_compiler.base.errors import ArgoError, Unreachable
from argo_compiler.base.model import Pose
from argo_compiler.hfsm import ActionFailed, ActionStopped, ActionSucceeded, StartAction
from argo_compiler.il import Action, Task
from argo_env.drives.drive import DriveStatus
from argo_env.navigation import Navigator, Path
from argo_env.navigation.closed_areas import leads_through
from argo_env.navigation.retreat import way_back
from argo_env.robot.pose import BodyPose
from argo_env.run.record import DIGITS, Reading, TaskRun
from argo_env.run.robot import ActionEnd
from argo_env.run.run_setup import RunSetup
from argo_env.sensing.sensor import Measurement, MeasurementError, PoorViewError
from argo_env.site import SiteCheckpoint

RETREAT = 1.0
"""m that the robot goes back where it is cornered"""
_NEAR = 0.15  # m: a cell's diagonal
_INSTANT = 1e-9  # s

TURNS = (0.0, math.radians(55.0), math.radians(-55.0))
"""rad that the face of a checkpoint is taken to be turned against the plan, one view after the
other: it may be turned by up to 90 degrees, and is read at up to 60 degrees"""


class SimulatedAction:
    """The action of one task. Changes with every step, from the first one to its end.

    The robot drives to the place, and stands there until the time at which it may begin. A
    measurement takes the robot's measuring time: a third each to raise the arm, to look and to
    stow the arm. An action that is cancelled, or has tried to read as long as it may, cleans up
    before it ends: the robot comes to rest, and an arm that has been raised is stowed. Once it has
    looked, it ends as if it had not been cancelled.
    """

    def __init__(
        self,
        start: StartAction,
        setup: RunSetup,
        started: float,
        distance_before: float,
        climbed_before: float,
        came: Path | None = None,
    ) -> None:
        """What the machine asks for; then when (s) and after what way (m) it was started, and the
        path that the robot `came` by."""
        self.task = task = start.task
        self._id = start.id
        self._not_before = -math.inf if start.not_before is None else start.not_before
        self._started = self._now = started
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
        self._velocity = task.velocity
        self._setup = setup
        self._retreated = False
        self._views = 0  # that have been gone to
        self._looked = False
        self._give_up_at = math.inf  # s, when it has tried to read as long as it may
        self._left = 0.0  # s of the measurement, or until the arm is stowed
        self._measured: list[tuple[float, float]] = []  # s, from when to when
        self._since: float | None = None  # s, when the measurement began
        self._early: float | None = None  # s, when it came to the place too early to begin
        self._phase: Callable[[], ActionEnd | None] = self._set_off

    def step(self, now: float) -> ActionEnd | None:
        """Goes on for one time step of the drive, up to time `now` (s); returns how the action has
        ended, if it has."""
        self._now = now
        end = self._phase()
        if self._since is None and self.measuring:
            self._since = now
        elif self._since is not None and (end is not None or not self.measuring):
            self._measured.append((self._since, now))
            self._since = None
        if end is not None:
            self._setup.world.move_arm(self._setup.navigator.robot.arm_stowed)
            if isinstance(end, ActionFailed):
                self._setup.drive.halt()
        return end

    def cancel(self, reason: str, interrupted: bool) -> None:
        """Ends the action as soon as it has cleaned up; the following steps do that."""
        if self.cancelled is not None:
            return
        self.cancelled, self.interrupted = reason, interrupted
        if self._phase in (self._set_off, self._stand):
            self._phase = self._stop
        elif self._phase in (self._brake_unread, self._stow_unread):
            pass  # it cleans up already
        elif self._phase in (self._drive, self._turn_off, self._retreat):
            self._setup.drive.halt()
            self._phase = self._brake
        elif not self._has_looked:
            self._begin_to_stow(self._stow)

    def detour(self, setup: RunSetup) -> None:
        """Continue with a setup whose navigator knows of a new blockage.

        If the current path leads through the blockage, the robot halts and takes another path.
        """
        self._setup = setup
        navigator = setup.navigator
        blocked = self.path is not None and leads_through(
            self.path, navigator.blockages, navigator.robot
        )
        if blocked and self._phase == self._drive:
            self._retreated = False
            setup.drive.halt()
            self._phase = self._turn_off

    @property
    def measuring(self) -> bool:
        """Whether the arm is in motion or raised."""
        return self._phase in (self._measure, self._stow, self._stow_unread)

    @property
    def driving(self) -> bool:
        """Whether it only goes along its path."""
        return self._phase == self._drive and self._give_up_at == math.inf

    def steps_measuring(self, most: int) -> int:
        """How many time steps, at most so many, it measures on without looking or ending."""
        if self._phase != self._measure or self._give_up_at < math.inf:
            return 0
        left, step = self._left, self._setup.drive.time_step
        for count in range(most):
            left -= step
            if left <= 1e-9:
                return count
        return most

    def go_on(self, count: int, now: float) -> None:
        """So many steps have passed of those in which it only drives or measures, up to time `now`
        (s)."""
        self._now = now
        if self._phase == self._measure:
            for _ in range(count):
                self._left -= self._setup.drive.time_step

    def reading(self, now: float) -> Reading | None:
        """What was measured, at time `now` (s), if anything was."""
        if self.measurement is None:
            return None
        checkpoint, value = self._checkpoint(), self.measurement.value
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
            views=max(1, self._views),
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
            early=None if self._early is None else (self._early, min(now, self._not_before)),
            unmoved=self._unmoved(),
        )

    @property
    def _measuring_time(self) -> float:
        return self._setup.navigator.robot.sensor.measuring_time

    def _set_off(self) -> ActionEnd | None:
        navigator, drive = self._setup.navigator, self._setup.drive
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
            return self._failed(str(error))
        except ArgoError as error:
            return self._failed(str(error))
        self.path = self.came = path
        drive.begin(path, self._velocity)
        self._phase = self._drive
        return self._drive()

    def _go_back(self) -> ActionEnd | None:
        """Sets off back the way that the robot came, to plan from there."""
        assert self.came is not None
        self._retreated = True
        back = way_back(self.came, _standing(self._setup.drive.pose), RETREAT)
        self._setup.drive.begin(back, self._velocity)
        self._phase = self._retreat
        return None

    def _retreat(self) -> ActionEnd | None:
        return self._then(self._set_off)

    def _turn_off(self) -> ActionEnd | None:
        return self._then(self._set_off)

    def _then(self, following: Callable[[], ActionEnd | None]) -> ActionEnd | None:
        """What follows when the drive has arrived, or come to rest."""
        match self._setup.drive.step():
            case DriveStatus.MOVING:
                return None
            case DriveStatus.FAILED:
                return self._failed(self._setup.drive.failure or "the drive failed")
            case DriveStatus.ARRIVED:
                return following()

    def _drive(self) -> ActionEnd | None:
        if self._tried_enough:
            self._setup.drive.halt()
            self._phase = self._brake_unread
            return self._brake_unread()
        return self._then(self._arrived)

    def _arrived(self) -> ActionEnd | None:
        """Begins at the place, unless it is too early."""
        if self._now < self._not_before - _INSTANT:
            self._early = self._now if self._early is None else self._early
            self._phase = self._stand
            return None
        if self.task.action is not Action.MEASURE:
            return ActionSucceeded(self.task.name, id=self._id)
        limit = self.task.reading_limit
        if limit is not None and not self._looked:
            self._give_up_at = min(self._give_up_at, self._now + limit)
        self._left = self._measuring_time
        self._setup.world.move_arm(self._raised())
        self._phase = self._measure
        return None

    def _stand(self) -> ActionEnd | None:
        return self._arrived()

    def _measure(self) -> ActionEnd | None:
        over = self._time_over()
        if not self._has_looked and self._tried_enough:
            self._begin_to_stow(self._stow_unread)
            return None
        if not over:
            return None
        self._looked = True
        try:
            self.measurement = self._setup.read(self._checkpoint_id(), self._now)
        except PoorViewError as error:
            return self._look_again(str(error))
        except MeasurementError as error:
            return self._failed(str(error))
        value = self.measurement.value
        abnormal = not self._checkpoint().nominal.contains(value)
        return ActionSucceeded(self.task.name, value, abnormal, self._id)

    def _look_again(self, failure: str) -> ActionEnd | None:
        """Goes to the next view, as of a face that is turned; with none left, or where the mission
        says from where to look, `failure` stands."""
        navigator, pose = self._setup.navigator, self._setup.drive.pose
        last = self.task.pose is not None or self.cancelled is not None
        while not last and self._views < len(TURNS):
            turned = TURNS[self._views]
            self._views += 1
            try:
                path = navigator.plan_to_view(_standing(pose), self._checkpoint_id(), turned)
            except Unreachable:
                continue
            self._setup.world.move_arm(navigator.robot.arm_stowed)
            self.path = self.came = path
            self._setup.drive.begin(path, self._velocity)
            self._phase = self._drive
            return None
        return self._failed(failure)

    def _brake_unread(self) -> ActionEnd | None:
        return self._then(self._not_read)

    def _stow_unread(self) -> ActionEnd | None:
        return self._not_read() if self._time_over() else None

    def _not_read(self) -> ActionEnd:
        assert self.task.reading_limit is not None
        self._looked = True
        return self._failed(f"not read within {self.task.reading_limit:g} s")

    @property
    def _tried_enough(self) -> bool:
        return self._now >= self._give_up_at - _INSTANT

    def _begin_to_stow(self, phase: Callable[[], ActionEnd | None]) -> None:
        """Stows the arm, as far as it has been raised."""
        third = self._setup.navigator.robot.sensor.stowing_time
        self._left = min(self._measuring_time - self._left, third)
        self._phase = phase

    @property
    def _has_looked(self) -> bool:
        """Of a measurement under way: whether only the arm is left to be stowed."""
        return self._left <= self._setup.navigator.robot.sensor.stowing_time + _INSTANT

    def _brake(self) -> ActionEnd | None:
        return self._then(self._stop)

    def _stow(self) -> ActionEnd | None:
        return self._stop() if self._time_over() else None

    def _stop(self) -> ActionEnd:
        return ActionStopped(self.task.name, self._id)

    def _failed(self, reason: str) -> ActionFailed:
        return ActionFailed(self.task.name, reason, self._looked, self._id)

    def _time_over(self) -> bool:
        self._left -= self._setup.drive.time_step
        return self._left <= 1e-9

    def _path(self) -> Path:
        start = _standing(self._setup.drive.pose)
        if self.task.action is Action.MEASURE and self.task.pose is None:
            self._views = max(1, self._views)
            turned = TURNS[self._views - 1]
            return self._setup.navigator.plan_to_view(start, self._checkpoint_id(), turned)
        if self.task.pose is None:
            raise Unreachable(f"task {self.task.name} has no pose")
        return self._setup.navigator.plan(start, self.task.pose)

    def _checkpoint(self) -> SiteCheckpoint:
        """The task's checkpoint; ArgoError if the site does not have it."""
        return self._setup.navigator.site.measured_by(self.task.object_id)

    def _checkpoint_id(self) -> int:
        return self._checkpoint().id

    def _unmoved(self) -> tuple[str, ...]:
        """The joints that the task asks for, and nothing in the world moves."""
        joints = self.task.joint_states
        moves = self._setup.watches_world and self.task.action is Action.MEASURE
        moved = _asked(self.task).keys() & self._setup.navigator.robot.arm_raised if moves else ()
        return () if joints is None else tuple(n for n in joints.names if n not in moved)

    def _raised(self) -> dict[str, float]:
        """The arm's joints (deg) when it measures: where the mission wants them, or the robot."""
        raised = self._setup.navigator.robot.arm_raised
        return raised | {name: at for name, at in _asked(self.task).items() if name in raised}


def _asked(task: Task) -> dict[str, float]:
    """Where the task wants joints to be (deg)."""
    joints = task.joint_states
    if joints is None or not joints.positions:
        return {}
    asked = zip(joints.names, joints.positions, strict=False)
    return {name: math.degrees(at) for name, at in asked}


def _is_free(navigator: Navigator, pose: BodyPose) -> bool:
    """Whether a robot at `pose` has a place to set off from right there."""
    try:
        place = navigator.snap(_standing(pose))
    except Unreachable:
        return False
    return math.dist((place.x, place.y, place.z), (pose.x, pose.y, pose.z)) <= _NEAR


def _standing(pose: BodyPose) -> Pose:
    return Pose(x=pose.x, y=pose.y, z=pose.z, yaw=pose.yaw)
