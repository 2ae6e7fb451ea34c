"""Remote robot with the interface that a run needs: its actions, its reports, its battery.

A run setup also gets placeholders for the drive and the sensor, which are not simulated here.
"""

import logging
import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, Literal, NoReturn

from pydantic import ValidationError

from argo_compiler.base.errors import Unavailable
from argo_compiler.base.message import Message, as_message
from argo_compiler.base.wording import wording_of
from argo_compiler.hfsm import (
    ActionFailed,
    ActionStopped,
    ActionSucceeded,
    AwaitedCharge,
    StartAction,
)
from argo_compiler.il import EventKind, Task
from argo_env.drives.drive import DriveStatus, Incident
from argo_env.navigation import Blockage, Navigator, Path
from argo_env.remote.channel import Channel
from argo_env.remote.messages import (
    REPORTS,
    CancelOrder,
    EndReport,
    FoundReport,
    RobotState,
    StartOrder,
)
from argo_env.robot.pose import BodyPose
from argo_env.run.initial_state import InitialState
from argo_env.run.log import Entry
from argo_env.run.odometry import Odometry
from argo_env.run.perception import anomaly_at_checkpoint
from argo_env.run.record import DIGITS, Anomaly, Reading, TaskRun
from argo_env.run.robot import ActionEnd, RobotAction, Sensed
from argo_env.run.run_setup import RunSetup
from argo_env.sensing.sensor import Measurement, MeasurementError
from argo_env.site import Site
from argo_env.world.without_physics import WorldWithoutPhysics

_log = logging.getLogger(__name__)


class RemoteDrive:
    """Placeholder for the drive; holds the last reported pose. Only orders move the robot."""

    name = "remote"
    failure: str | None = None
    incidents: Sequence[Incident] = ()

    def __init__(self, time_step: float, pose: BodyPose) -> None:
        self.time_step = time_step
        self.pose = pose

    def place_robot(self, pose: BodyPose) -> None:
        """No-op: a remote robot stays where it is."""

    def follow(self, path: Path, velocity: float | None) -> NoReturn:
        raise NotImplementedError("a remote robot plans its own paths")

    def step(self) -> Literal[DriveStatus.ARRIVED]:
        return DriveStatus.ARRIVED

    def halt(self) -> None:
        """No-op: orders stop the robot."""


class RemoteSensor:
    """Placeholder for the sensor: the robot reports its readings itself."""

    name = "remote"

    def measure(self, checkpoint_id: int, pose: BodyPose) -> Measurement:  # noqa: ARG002
        raise MeasurementError("a remote robot reads checkpoints itself")


class RemotePower:
    """Battery; holds the charge that the robot reported last."""

    charge: float | None = None
    charging = False

    @property
    def empty(self) -> bool:
        return self.charge is not None and self.charge <= 0.0


def make_anomaly(report: FoundReport, site: Site, pose: BodyPose, now: float) -> Anomaly:
    """Return what a report says as an anomaly for the run's record.

    The report has arrived at the run's time `now` (s), when the robot was at `pose`. If the report
    has no position, the anomaly has the robot's as the one from which it was noticed.
    """
    here = (round(pose.x, DIGITS), round(pose.y, DIGITS), round(pose.z, DIGITS))
    place = report.place
    return Anomaly(
        t=now,
        kind=report.event,
        detail=report.detail,
        source="robot",
        place=place,
        noticed_from=None if place else here,
        floor=site.floor_at((place or here)[2]),
    )


def make_reading(
    task: Task, ended: EndReport, site: Site, pose: BodyPose, now: float
) -> Reading | None:
    """Return the reading that the robot has reported at the end of a task.

    Returns None unless the action is done and has a value. If the robot did not report the
    distance, the reading has the distance from the robot's origin to the checkpoint.

    Args:
        task: task that has ended.
        ended: report of its end.
        site: site with the checkpoint.
        pose: pose of the robot at that time.
        now: time of the run in s.
    """
    if ended.outcome != "done" or ended.value is None or task.object_id is None:
        return None
    checkpoint = site.checkpoint_for(task.object_id)
    from_origin = math.dist(checkpoint.position, (pose.x, pose.y, pose.z))
    return Reading(
        checkpoint=checkpoint.id,
        name=checkpoint.name,
        kind=checkpoint.kind,
        floor=checkpoint.floor,
        task=task.name,
        t=now,
        value=ended.value,
        unit=checkpoint.unit,
        nominal=checkpoint.nominal,
        normal=checkpoint.nominal.contains(ended.value),
        distance=round(from_origin if ended.distance is None else ended.distance, DIGITS),
        confidence=round(ended.confidence, DIGITS),
    )


class RemoteAction:
    """Action that the robot was ordered to execute; holds the reason if it is cancelled."""

    path: Path | None = None
    arrival_path: Path | None = None

    def __init__(
        self,
        id: str,
        command: StartAction,
        started: float,
        distances: tuple[float, float],
        cancel: Callable[[], None],
    ) -> None:
        """Initialize the action.

        Args:
            id: id of the action in the messages to the robot.
            command: command of the state machine.
            started: time of the run in s when the action was started.
            distances: distances in m, driven and climbed, from the run's start to the action's.
            cancel: function that orders the robot to stop the action.
        """
        self.id = id
        self._command = command
        self._started = started
        self._distances = distances
        self._order_to_cancel = cancel
        self.cancelled: str | None = None
        """reason of the cancellation; None if it was not requested"""
        self._interrupted = False

    @property
    def task(self) -> Task:
        return self._command.task

    def cancel(self, reason: str, is_interruption: bool) -> None:
        """Order the robot to stop the action, which ends only with the robot's report.

        Only the first call has an effect. `reason` is a text for people; `is_interruption` is True
        if the record is to name the action interrupted and not cancelled.
        """
        if self.cancelled is None:
            self.cancelled, self._interrupted = reason, is_interruption
            self._order_to_cancel()

    def detour_if_blocked(self, setup: RunSetup) -> None:
        """No-op: the robot plans its own paths."""

    def to_action_end(self, report: EndReport, abnormal: bool) -> ActionEnd:
        """Return the reported end of the action as an event for the state machine.

        `abnormal` is True if the value is outside the checkpoint's nominal range.
        """
        name, id = self.task.name, self._command.id or None
        if report.outcome == "done":
            return ActionSucceeded(name, report.value, abnormal, id)
        if report.outcome == "stopped" and self.cancelled is not None:
            return ActionStopped(name, id)
        reason = report.reason or Message(
            "the robot reported that the action has {outcome}", outcome=report.outcome
        )
        return ActionFailed(name, reason, report.unreadable, id, report.unreachable)

    def to_task_run(
        self, end: ActionEnd, now: float, total_distance: float, total_climbed: float
    ) -> TaskRun:
        """Return the action as the run's record has it.

        Args:
            end: event with which the action has ended.
            now: time of the run in s when it ended.
            total_distance: distance in m driven from the run's start until then.
            total_climbed: height in m climbed from the run's start until then.
        """
        reason = end.reason if isinstance(end, ActionFailed) else None
        outcome = "done"
        if not isinstance(end, ActionSucceeded):
            outcome = "interrupted" if self._interrupted else "cancelled"
            outcome = "failed" if self.cancelled is None else outcome
            if self.cancelled and reason:
                reason = Message(
                    "{cancelled}; {reason}",
                    cancelled=as_message(self.cancelled),
                    reason=as_message(reason),
                )
            reason = reason or self.cancelled or None
        return TaskRun(
            task=self.task.name,
            action=self.task.action,
            object_id=self.task.object_id,
            start=self._started,
            end=now,
            outcome=outcome,
            reason_wording=wording_of(reason),
            reason=reason,
            distance=round(total_distance - self._distances[0], DIGITS),
            climbed=round(total_climbed - self._distances[1], DIGITS),
        )


SILENCE = 2.0
"""s without a message after which the robot counts as silent"""


class RemoteRobot:
    """Robot that gets its orders over a channel, and whose reports are passed to the run.

    It holds the last reported state and the action that is under way. A step takes as long as on
    the clock. While nothing is received, nothing is assumed: the action continues, the pose is the
    last one that was reported, and `silent_since` is set.
    """

    def __init__(
        self,
        navigator: Navigator,
        channel: Channel,
        run: str,
        clock: Callable[[], float],
        sleep: Callable[[float], None],
        *,
        time_step: float = 0.1,
        patience: float = 10.0,
    ) -> None:
        """Wait until the robot has reported its pose.

        `run` is a word that identifies this run; it must be the same when the run is resumed from
        its journal. The clock returns UNIX time (s). Raises Unavailable if the robot does not
        report its pose within `patience` (s).
        """
        self._channel, self._run, self._clock, self._sleep = channel, run, clock, sleep
        site, robot = navigator.site, navigator.robot
        self._drive = RemoteDrive(time_step, BodyPose(0.0, 0.0, 0.0, 0.0))
        self.setup = RunSetup(
            WorldWithoutPhysics(site, robot), navigator, self._drive, RemoteSensor()
        )
        self.odometry = Odometry(site)
        self.supply = RemotePower()
        self._offset = 0.0  # s, the clock's time minus the run's time
        self._action: RemoteAction | None = None
        self._order: StartOrder | None = None
        """start order of the action, until it is sent"""
        self._restarts = 0  # restarts of the robot when the action was ordered
        self._cancelled_strays: set[str] = set()
        self._awaited_charges: tuple[AwaitedCharge, ...] = ()
        self._await_state(patience)

    @property
    def silent_since(self) -> float | None:
        """Time of the run in s when the last message came; None if it is at most SILENCE s old."""
        received = self._channel.last_received_at
        assert received is not None
        return received - self._offset if self._clock() - received > SILENCE else None

    def begin_at(self, pose: BodyPose, now: float) -> None:  # noqa: ARG002
        """Begin or continue a run: set its time to `now` (s).

        The robot does not move to `pose`, which is not used.
        """
        self._offset = self._clock() - now

    def wait_acknowledged(self, limit: float) -> bool:
        """Wait at most `limit` s until the robot has acknowledged all orders.

        Returns True if it has. To be called when a run has ended, because the robot may not have
        received the last orders yet. Reports that arrive meanwhile are dropped.
        """
        until = self._clock() + limit
        while self._channel.pending and self._clock() < until:
            self._sleep(self._drive.time_step)
            self._channel.flush()
            self._channel.receive()
        return not self._channel.pending

    def apply_initial_state_except_pose(self, initial: InitialState) -> None:
        """Set the driven distance and the climbed height; all else is the robot's own state."""
        self.odometry.distance, self.odometry.climbed = initial.distance, initial.climbed

    def restore(self, last: Entry) -> None:
        self.odometry.restore(last)

    def restore_anomalies(self, reported: Sequence[tuple[Anomaly, BodyPose]], now: float) -> None:
        """No-op: the robot remembers by itself what it has reported."""

    def set_mission_state(
        self,
        awaited: tuple[AwaitedCharge, ...],
        reaction: EventKind | None,  # noqa: ARG002
    ) -> None:
        self._awaited_charges = awaited

    @property
    def expects_awaited_charge(self) -> bool:
        return bool(self._awaited_charges)

    def _has_awaited_charge(self, now: float) -> bool:
        """Return True if the mission waits for charges that it names, and has them at `now` (s).

        The robot reports by itself that it is fully charged, but does not know of other levels.
        """
        charge = self.supply.charge
        return (
            charge is not None
            and bool(self._awaited_charges)
            and all(
                awaited.level is not None
                and charge >= awaited.level
                and now >= awaited.not_before
                and (self.supply.charging or not awaited.while_charging)
                for awaited in self._awaited_charges
            )
        )

    def update_faults(self, now: float) -> None:
        """No-op: faults are not simulated."""

    def add_blockages(self, blockages: Sequence[Blockage]) -> None:
        self.setup = replace(
            self.setup, navigator=self.setup.navigator.with_added_blockages(blockages)
        )

    def prepare_action(
        self,
        command: StartAction,
        now: float,
        arrived_by: Path | None,  # noqa: ARG002
    ) -> RobotAction:
        """Prepare the order of an action, which the next `advance` sends.

        If the robot already executes an action of the same run and id, it continues that action
        instead of starting it again.
        """
        # An action by hand has no id, but no two start at the same time.
        id = f"{self._run}/{command.id or f'by hand at {now:g} s'}"
        distances = (self.odometry.distance, self.odometry.climbed)
        not_before = command.not_before
        not_before = None if not_before is None else not_before + self._offset
        self._action = RemoteAction(id, command, now, distances, self._cancel)
        self._order = StartOrder(id=id, task=command.task, not_before=not_before)
        return self._action

    def advance(self, step: int, now: float, action: RobotAction | None) -> Sensed:  # noqa: ARG002
        """Wait until the clock reaches the run's time `now` (s), and process the robot's reports.

        Before that, it sends the order that `prepare_action` has prepared. `step` is not used.

        Returns:
            What the robot has reported: what it found, and if `action` has ended, its end and its
            reading.
        """
        own = self._action if action else None
        if own and self._order:
            # `prepare_action` does not send it, as actions replayed from a journal are not ordered
            # again.
            self._restarts = self._channel.restarts
            self._channel.post(self._order)
            self._order = None
            if own.cancelled is not None:
                self._cancel()
        self._sleep(max(0.0, now + self._offset - self._clock()))
        self._channel.flush()
        site, ended = self.setup.navigator.site, None
        found: list[Anomaly] = []
        last_pose = self._drive.pose
        for body in self._channel.receive():
            match self._read(body, own):
                case RobotState() as state:
                    self._update_state(state)
                    self._cancel_stray(state, own)
                    ended = ended or self._forgotten_end(state, own)
                case EndReport() as report if own and report.id == own.id:
                    ended = report
                case FoundReport() as report if report.event is not EventKind.TIME_UP:
                    found.append(make_anomaly(report, site, self._drive.pose, now))
        self.odometry.add_motion(last_pose, self._drive.pose, (), now)
        if self._has_awaited_charge(now):
            charged = FoundReport(
                event=EventKind.BATTERY_CHARGED,
                detail=Message("{charge:.0%} charged", charge=self.supply.charge),
            )
            found.append(make_anomaly(charged, site, self._drive.pose, now))
            self._awaited_charges = ()
        if own is None or ended is None:
            return Sensed(found=tuple(found))
        reading = make_reading(own.task, ended, site, self._drive.pose, now)
        if reading and not reading.normal:
            found.append(anomaly_at_checkpoint(reading, site))
        self._action = None
        end = own.to_action_end(ended, reading is not None and not reading.normal)
        return Sensed(end, reading, tuple(found))

    def state_for_entry(self) -> dict[str, Any]:
        pose, odometry = self._drive.pose, self.odometry
        return {
            "pose": (pose.x, pose.y, pose.z, pose.yaw, pose.pitch),
            "distance": odometry.distance,
            "climbed": odometry.climbed,
            "charge": self.supply.charge,
        }

    def clear_mishaps_and_ended_contacts(self) -> None:
        """No-op: a remote robot reports no contacts or mishaps."""

    def _await_state(self, patience: float) -> None:
        until = self._clock() + patience
        while self._clock() < until:
            self._channel.flush()
            for body in self._channel.receive():
                if isinstance(state := self._read(body, None), RobotState):
                    self._update_state(state)
                    return
            self._sleep(self._drive.time_step)
        raise Unavailable(
            Message(
                "the robot has not reported its pose within {patience:g} s: check that it "
                "is on and connected",
                patience=patience,
            )
        )

    def _read(
        self, body: dict[str, Any], own: RemoteAction | None
    ) -> RobotState | EndReport | FoundReport | None:
        """Return the report in a message's body.

        An invalid report of the end of the action `own` is replaced by a failure. Returns None for
        any other invalid report.
        """
        try:
            return REPORTS.validate_python(body)
        except ValidationError as error:
            why = error.errors()[0]["msg"]
            _log.warning("the robot sent an invalid report: %s", why)
        if own is None or body.get("type") != "ended" or body.get("id") != own.id:
            return None
        reason = Message("the robot sent an invalid report of the action's end: {why}", why=why)
        return EndReport(id=own.id, outcome="failed", reason=reason)

    def _update_state(self, state: RobotState) -> None:
        pose = state.pose
        self._drive.pose = BodyPose(pose.x, pose.y, pose.z, pose.yaw, state.pitch)
        self.supply.charge, self.supply.charging = state.charge, state.charging

    def _cancel_stray(self, state: RobotState, own: RemoteAction | None) -> None:
        """Cancel an action of this run that is under way but not awaited.

        An example is an action by hand that was started before Argo itself restarted.
        """
        id = state.action
        if id is None or not id.startswith(f"{self._run}/") or (own and own.id == id):
            return
        if id not in self._cancelled_strays:
            self._cancelled_strays.add(id)
            self._channel.post(CancelOrder(id=id))

    def _cancel(self) -> None:
        """Order the robot to stop the action, unless its start was not sent yet."""
        if self._action and self._order is None:
            self._channel.post(CancelOrder(id=self._action.id))
            self._channel.flush()  # in case the run ends now

    def _forgotten_end(self, state: RobotState, own: RemoteAction | None) -> EndReport | None:
        """Return a failure if the robot has restarted and does not know the action `own`."""
        if own is None or self._channel.restarts == self._restarts or own.id in state.known:
            return None
        if any(order.get("id") == own.id for order in self._channel.pending):
            return None  # the start order is sent again
        reason = Message("the robot has restarted and does not know the action any more")
        return EndReport(id=own.id, outcome="failed", reason=reason)
