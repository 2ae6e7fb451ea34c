"""Action of a task on the simulated robot: drive to the pose, measure, clean up if cancelled."""

import math
from collections.abc import Callable

from argo_compiler.base.errors import ArgoError, Unreachable
from argo_compiler.base.message import Message, as_message
from argo_compiler.base.model import Pose
from argo_compiler.base.wording import wording_of
from argo_compiler.hfsm import ActionFailed, ActionStopped, ActionSucceeded, StartAction
from argo_compiler.il import Action, Task
from argo_env.drives.drive import DriveStatus
from argo_env.navigation import Navigator, Path
from argo_env.navigation.closed_areas import may_touch_blockage
from argo_env.navigation.retreat import path_back
from argo_env.robot.pose import BodyPose
from argo_env.run.record import DIGITS, Reading, TaskRun
from argo_env.run.robot import ActionEnd
from argo_env.run.run_setup import RunSetup
from argo_env.sensing.sensor import Measurement, MeasurementError, PoorViewError
from argo_env.site import SiteCheckpoint

RETREAT = 1.0
"""m that the robot drives back where it has no room to turn"""
_NEAR = 0.15  # m: a cell's diagonal
_INSTANT = 1e-9  # s

TURNS = (0.0, math.radians(55.0), math.radians(-55.0))
"""rad, assumed turns of a checkpoint's face against the plan, one for each view in this order: the
face may be turned by up to 90 degrees, and can be read at up to 60 degrees"""


class SimulatedAction:
    """Action of one task, which changes with every step from the first one to its end.

    The robot drives to the pose of the task and waits there until the task may begin. A measurement
    takes the robot's measuring time: a third each to raise the arm, to look and to stow the arm. An
    action that is cancelled, or whose time for reading is over, cleans up before it ends: the robot
    comes to rest, and a raised arm is stowed. An action that is cancelled after the robot has
    looked ends as if it had not been cancelled.
    """

    def __init__(
        self,
        start: StartAction,
        setup: RunSetup,
        started: float,
        distance_before: float,
        climbed_before: float,
        arrival_path: Path | None = None,
    ) -> None:
        """Prepare the action that the machine has started with the command `start`.

        Args:
            start: the machine's command.
            setup: the run setup that carries out the action.
            started: time of the start in s.
            distance_before: m driven until then.
            climbed_before: m climbed until then.
            arrival_path: the path by which the robot reached its pose, if known.
        """
        self.task = task = start.task
        self._id = start.id
        self._not_before = -math.inf if start.not_before is None else start.not_before
        self._start_time = self._now = started
        self._distance_before = distance_before
        self._climbed_before = climbed_before
        self.cancelled: str | None = None
        """reason for which the action was cancelled; None: it was not"""
        self.interrupted = False
        """whether the action was cancelled by an interruption, after which the mission goes on"""
        self.measurement: Measurement | None = None
        self.path: Path | None = None
        """the path to the pose of the task, once it is planned"""
        self.arrival_path = arrival_path
        """the path by which the robot reached its pose; it retreats along it if it has no room"""
        self._velocity = task.velocity
        self._setup = setup
        self._retreated = False
        self._views = 0  # that the robot has driven to
        self._tried_to_read = False
        self._give_up_at = math.inf  # s, when the task's time for reading is over
        self._remaining = 0.0  # s of the measurement, or until the arm is stowed
        self._measuring_times: list[tuple[float, float]] = []  # s, starts and ends
        self._measuring_since: float | None = None  # s
        self._early_since: float | None = None  # s, arrival at the pose before the task may begin
        self._phase: Callable[[], ActionEnd | None] = self._start_driving

    def step(self, now: float) -> ActionEnd | None:
        """Continue for one time step of the drive, up to time `now` (s).

        Returns the end of the action, or None if it has not ended.
        """
        self._now = now
        end = self._phase()
        if self._measuring_since is None and self.is_measuring:
            self._measuring_since = now
        elif self._measuring_since is not None and (end is not None or not self.is_measuring):
            self._measuring_times.append((self._measuring_since, now))
            self._measuring_since = None
        if end is not None:
            self._setup.world.set_arm_degrees(self._setup.navigator.robot.arm_stowed)
            if isinstance(end, ActionFailed):
                self._setup.drive.halt()
        return end

    def cancel(self, reason: str, is_interruption: bool) -> None:
        """Cancel the action: the following steps clean up, then the action ends.

        `is_interruption` states that the mission goes on afterwards. A second call does nothing.
        """
        if self.cancelled is not None:
            return
        self.cancelled, self.interrupted = reason, is_interruption
        if self._phase in (self._start_driving, self._wait_to_begin):
            self._phase = self._stop
        elif self._phase in (self._brake_unread, self._stow_unread):
            pass  # already cleaning up
        elif self._phase in (self._drive, self._halt_for_detour, self._retreat):
            self._setup.drive.halt()
            self._phase = self._brake
        elif not self._only_stows:
            self._start_stowing(self._stow)

    def detour_if_blocked(self, setup: RunSetup) -> None:
        """Continue with `setup`, whose navigator knows of a new blockage.

        If the robot is driving, and its path leads through any blockage that the navigator knows,
        it halts and takes another path.
        """
        self._setup = setup
        navigator = setup.navigator
        blocked = self.path is not None and may_touch_blockage(
            self.path, navigator.blockages, navigator.robot
        )
        if blocked and self._phase == self._drive:
            self._retreated = False
            setup.drive.halt()
            self._phase = self._halt_for_detour

    @property
    def is_measuring(self) -> bool:
        """True if the robot measures: its arm is raised, or on its way up or down."""
        return self._phase in (self._measure, self._stow, self._stow_unread)

    @property
    def is_driving_without_reading_limit(self) -> bool:
        """True if the robot drives along its path, and no `reading_limit` is running."""
        return self._phase == self._drive and self._give_up_at == math.inf

    def count_measuring_steps(self, limit: int) -> int:
        """Return how many of the next steps, at most `limit`, the robot only measures in.

        They are the steps before the one in which the measurement ends and its value is read; 0 if
        the robot does not measure now, or if the task's time for reading, its `reading_limit`,
        has begun to run.
        """
        if self._phase != self._measure or self._give_up_at < math.inf:
            return 0
        remaining, step = self._remaining, self._setup.drive.time_step
        for count in range(limit):
            remaining -= step
            if remaining <= 1e-9:
                return count
        return limit

    def skip_steps(self, count: int, end_time: float) -> None:
        """Let `count` steps pass at once, up to `end_time` (s).

        In all of them the robot only drives or measures; the caller ensures this.
        """
        self._now = end_time
        if self._phase == self._measure:
            for _ in range(count):
                self._remaining -= self._setup.drive.time_step

    def make_reading_if_measured(self, now: float) -> Reading | None:
        """Return the reading that the action has taken, if any, with `now` (s) as its time."""
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

    def to_task_run(
        self, end: ActionEnd, now: float, total_distance: float, total_climbed: float
    ) -> TaskRun:
        """Return the action, which ended at `now` (s), in the form of the run's record.

        Args:
            end: the end of the action.
            now: time of the end in s.
            total_distance: m that the robot has driven since the mission's start.
            total_climbed: m that it has climbed since then.
        """
        reason = end.reason if isinstance(end, ActionFailed) else None
        if isinstance(end, ActionSucceeded):
            outcome = "done"
        elif self.cancelled is None:
            outcome = "failed"
        else:
            outcome = "interrupted" if self.interrupted else "cancelled"
            reason = (
                self.cancelled
                if reason is None
                else Message(
                    "{cancelled}; {reason}",
                    cancelled=as_message(self.cancelled),
                    reason=as_message(reason),
                )
            )
        under_way = () if self._measuring_since is None else ((self._measuring_since, now),)
        return TaskRun(
            task=self.task.name,
            action=self.task.action,
            object_id=self.task.object_id,
            start=self._start_time,
            end=now,
            outcome=outcome,
            reason=reason,
            reason_wording=wording_of(reason),
            distance=round(total_distance - self._distance_before, DIGITS),
            climbed=round(total_climbed - self._climbed_before, DIGITS),
            measuring=(*self._measuring_times, *under_way),
            early=None
            if self._early_since is None
            else (self._early_since, min(now, self._not_before)),
            unmoved=self._unmoved_joints(),
        )

    @property
    def _measuring_time(self) -> float:
        return self._setup.navigator.robot.sensor.measuring_time

    def _start_driving(self) -> ActionEnd | None:
        navigator, drive = self._setup.navigator, self._setup.drive
        may_retreat = (
            self.arrival_path is not None and bool(navigator.blockages) and not self._retreated
        )
        try:
            if may_retreat and not _can_start_at(navigator, drive.pose):
                return self._start_retreat()
            path = self._plan_path()
        except Unreachable as error:
            if may_retreat:
                # There may be a path from a pose with room to turn.
                return self._start_retreat()
            if self._views > 1:
                return self._try_next_view(str(error))
            return self._failed(str(error), unreachable=True)
        except ArgoError as error:
            return self._failed(str(error))
        self.path = self.arrival_path = path
        drive.follow(path, self._velocity)
        self._phase = self._drive
        return self._drive()

    def _start_retreat(self) -> ActionEnd | None:
        """Start to drive back along the arrival path; at its end, a path is planned anew.

        Returns None: the action has not ended.
        """
        assert self.arrival_path is not None
        self._retreated = True
        back_path = path_back(self.arrival_path, _to_pose(self._setup.drive.pose), RETREAT)
        self._setup.drive.follow(back_path, self._velocity)
        self._phase = self._retreat
        return None

    def _retreat(self) -> ActionEnd | None:
        return self._after_drive(self._start_driving)

    def _halt_for_detour(self) -> ActionEnd | None:
        return self._after_drive(self._start_driving)

    def _after_drive(self, following: Callable[[], ActionEnd | None]) -> ActionEnd | None:
        """Step the drive; call `following` once the robot has arrived, or halted as it was told to.

        Returns the end of the action, such as a failure of the drive; None if it has not ended.
        """
        match self._setup.drive.step():
            case DriveStatus.MOVING:
                return None
            case DriveStatus.FAILED:
                failure = self._setup.drive.failure or Message("the drive failed")
                return self._failed(failure, unreachable=True)
            case DriveStatus.ARRIVED:
                return following()

    def _drive(self) -> ActionEnd | None:
        if self._is_reading_time_over:
            self._setup.drive.halt()
            self._phase = self._brake_unread
            return self._brake_unread()
        return self._after_drive(self._arrived)

    def _arrived(self) -> ActionEnd | None:
        """Begin the task at its pose, or wait if its time window has not begun yet."""
        if self._now < self._not_before - _INSTANT:
            self._early_since = self._now if self._early_since is None else self._early_since
            self._phase = self._wait_to_begin
            return None
        if self.task.action is not Action.MEASURE:
            return ActionSucceeded(self.task.name, id=self._id)
        limit = self.task.reading_limit
        if limit is not None and not self._tried_to_read:
            self._give_up_at = min(self._give_up_at, self._now + limit)
        self._remaining = self._measuring_time
        self._setup.world.set_arm_degrees(self._raised_arm())
        self._phase = self._measure
        return None

    def _wait_to_begin(self) -> ActionEnd | None:
        return self._arrived()

    def _measure(self) -> ActionEnd | None:
        is_over = self._count_down()
        if not self._only_stows and self._is_reading_time_over:
            self._start_stowing(self._stow_unread)
            return None
        if not is_over:
            return None
        self._tried_to_read = True
        try:
            self.measurement = self._setup.read_checkpoint(self._checkpoint_id(), self._now)
        except PoorViewError as error:
            return self._try_next_view(str(error))
        except MeasurementError as error:
            return self._failed(str(error))
        value = self.measurement.value
        abnormal = not self._checkpoint().nominal.contains(value)
        return ActionSucceeded(self.task.name, value, abnormal, self._id)

    def _try_next_view(self, failure: str) -> ActionEnd | None:
        """Drive to the next pose to look from: the checkpoint may be turned otherwise than planned.

        The action fails with `failure` if there is no further view, the task states a pose from
        which to measure, or the action is cancelled.
        """
        navigator, pose = self._setup.navigator, self._setup.drive.pose
        is_last = self.task.pose is not None or self.cancelled is not None
        while not is_last and self._views < len(TURNS):
            turned = TURNS[self._views]
            self._views += 1
            try:
                path = navigator.plan_to_view(_to_pose(pose), self._checkpoint_id(), turned)
            except Unreachable:
                continue
            self._setup.world.set_arm_degrees(navigator.robot.arm_stowed)
            self.path = self.arrival_path = path
            self._setup.drive.follow(path, self._velocity)
            self._phase = self._drive
            return None
        return self._failed(failure)

    def _brake_unread(self) -> ActionEnd | None:
        return self._after_drive(self._fail_unread)

    def _stow_unread(self) -> ActionEnd | None:
        return self._fail_unread() if self._count_down() else None

    def _fail_unread(self) -> ActionEnd:
        assert self.task.reading_limit is not None
        self._tried_to_read = True
        return self._failed(
            Message("not read within {reading_limit:g} s", reading_limit=self.task.reading_limit)
        )

    @property
    def _is_reading_time_over(self) -> bool:
        return self._now >= self._give_up_at - _INSTANT

    def _start_stowing(self, phase: Callable[[], ActionEnd | None]) -> None:
        """Enter `phase`, which lasts as long as stowing the arm from its present position takes."""
        third = self._setup.navigator.robot.sensor.stowing_time
        self._remaining = min(self._measuring_time - self._remaining, third)
        self._phase = phase

    @property
    def _only_stows(self) -> bool:
        """True if all that remains of the measuring time is that for stowing the arm."""
        return self._remaining <= self._setup.navigator.robot.sensor.stowing_time + _INSTANT

    def _brake(self) -> ActionEnd | None:
        return self._after_drive(self._stop)

    def _stow(self) -> ActionEnd | None:
        return self._stop() if self._count_down() else None

    def _stop(self) -> ActionEnd:
        return ActionStopped(self.task.name, self._id)

    def _failed(self, reason: str, unreachable: bool = False) -> ActionFailed:
        """Return the failure; a checkpoint that was looked at is not unreachable."""
        read = self._tried_to_read
        return ActionFailed(self.task.name, reason, read, self._id, unreachable and not read)

    def _count_down(self) -> bool:
        """Subtract a time step from the phase's remaining time; return True if none remains."""
        self._remaining -= self._setup.drive.time_step
        return self._remaining <= 1e-9

    def _plan_path(self) -> Path:
        start = _to_pose(self._setup.drive.pose)
        if self.task.action is Action.MEASURE and self.task.pose is None:
            self._views = max(1, self._views)
            turned = TURNS[self._views - 1]
            return self._setup.navigator.plan_to_view(start, self._checkpoint_id(), turned)
        if self.task.pose is None:
            raise Unreachable(Message("task {task} has no pose", task=self.task.name))
        return self._setup.navigator.plan(start, self.task.pose)

    def _checkpoint(self) -> SiteCheckpoint:
        """Return the task's checkpoint. Raises ArgoError if the site does not have it."""
        return self._setup.navigator.site.checkpoint_for(self.task.object_id)

    def _checkpoint_id(self) -> int:
        return self._checkpoint().id

    def _unmoved_joints(self) -> tuple[str, ...]:
        """Return the names of the joints that the task states but nothing in the world moves."""
        joints = self.task.joint_states
        moves = self._setup.has_simulated_world and self.task.action is Action.MEASURE
        moved = (
            _requested_joints(self.task).keys() & self._setup.navigator.robot.arm_raised
            if moves
            else ()
        )
        return () if joints is None else tuple(n for n in joints.names if n not in moved)

    def _raised_arm(self) -> dict[str, float]:
        """Return the raised arm's joint angles (deg): the task's where stated, else the robot's."""
        raised = self._setup.navigator.robot.arm_raised
        return raised | {
            name: angle for name, angle in _requested_joints(self.task).items() if name in raised
        }


def _requested_joints(task: Task) -> dict[str, float]:
    """Return the joint angles (deg) that the task states."""
    joints = task.joint_states
    if joints is None or not joints.positions:
        return {}
    pairs = zip(joints.names, joints.positions, strict=False)
    return {name: math.degrees(angle) for name, angle in pairs}


def _can_start_at(navigator: Navigator, pose: BodyPose) -> bool:
    """Return True if a path can start so near to `pose` that the robot need not shift first."""
    try:
        start = navigator.snap_keeping_heading(_to_pose(pose))
    except Unreachable:
        return False
    return math.dist((start.x, start.y, start.z), (pose.x, pose.y, pose.z)) <= _NEAR


def _to_pose(pose: BodyPose) -> Pose:
    return Pose(x=pose.x, y=pose.y, z=pose.z, yaw=pose.yaw)
