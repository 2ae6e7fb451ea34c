"""A robot that is somewhere else, as the run's own: its actions, what it reports, and what stands
in a setup for its parts."""

import logging
import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, NoReturn

from pydantic import ValidationError

from argo_compiler.base.errors import Unavailable
from argo_compiler.hfsm import ActionFailed, ActionStopped, ActionSucceeded, StartAction
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
from argo_env.run.perception import located_anomaly
from argo_env.run.record import DIGITS, Anomaly, Reading, TaskRun
from argo_env.run.robot import ActionEnd, RobotAction, Sensed
from argo_env.run.run_setup import RunSetup
from argo_env.sensing.sensor import Measurement, MeasurementError
from argo_env.site import Site
from argo_env.world.without_physics import WorldWithoutPhysics

_log = logging.getLogger(__name__)


class ToldDrive:
    """Is where the robot told that it is. Nobody here can move it but by an order."""

    name = "remote"
    failure: str | None = None
    incidents: Sequence[Incident] = ()

    def __init__(self, time_step: float, pose: BodyPose) -> None:
        self.time_step = time_step
        self.pose = pose

    def place(self, pose: BodyPose) -> None:
        """A robot that is somewhere else stays where it is."""

    def begin(self, path: Path, velocity: float | None) -> NoReturn:
        raise NotImplementedError("a remote robot plans its own paths")

    def step(self) -> DriveStatus:
        return DriveStatus.ARRIVED

    def halt(self) -> None:
        """Orders do that."""


class ToldSensor:
    """Reads nothing here: the robot tells what it reads."""

    name = "remote"

    def measure(self, checkpoint_id: int, pose: BodyPose) -> Measurement:  # noqa: ARG002
        raise MeasurementError("a remote robot reads checkpoints itself")


class ToldPower:
    """The battery, as the robot told."""

    charge: float | None = None
    charging = False

    @property
    def empty(self) -> bool:
        return self.charge is not None and self.charge <= 0.0


def anomaly_of(report: FoundReport, site: Site, pose: BodyPose, now: float) -> Anomaly:
    """What the robot has noticed, at time `now` (s) and `pose`."""
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


def reading_of(
    task: Task, ended: EndReport, site: Site, pose: BodyPose, now: float
) -> Reading | None:
    """What was measured, at time `now` (s) and `pose`; None: nothing was. A distance that the robot
    did not tell is that from its origin."""
    if ended.outcome != "done" or ended.value is None or task.object_id is None:
        return None
    checkpoint = site.measured_by(task.object_id)
    away = math.dist(checkpoint.position, (pose.x, pose.y, pose.z))
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
        distance=round(away if ended.distance is None else ended.distance, DIGITS),
        confidence=round(ended.confidence, DIGITS),
    )


class RemoteAction:
    """Holds what was ordered, and whether it is to be cancelled."""

    path: Path | None = None
    arrival_path: Path | None = None

    def __init__(
        self,
        id: str,
        command: StartAction,
        started: float,
        way: tuple[float, float],
        cancel: Callable[[], None],
    ) -> None:
        """Its id for the robot; then when (s) and after what way (m driven, m upwards) it was
        ordered, and what orders the robot to stop it."""
        self.id = id
        self._command = command
        self._started = started
        self._way = way
        self._order_to_cancel = cancel
        self.cancelled: str | None = None
        """why it is to be cancelled, if it is"""
        self._interrupted = False

    @property
    def task(self) -> Task:
        return self._command.task

    def cancel(self, reason: str, interrupted: bool) -> None:
        """Orders the robot to stop; its report is awaited."""
        if self.cancelled is None:
            self.cancelled, self._interrupted = reason, interrupted
            self._order_to_cancel()

    def detour(self, setup: RunSetup) -> None:
        """The robot finds its way itself."""

    def end(self, report: EndReport, abnormal: bool) -> ActionEnd:
        """What the machine is told of the end that the robot reported."""
        name, id = self.task.name, self._command.id or None
        if report.outcome == "done":
            return ActionSucceeded(name, report.value, abnormal, id)
        if report.outcome == "stopped" and self.cancelled is not None:
            return ActionStopped(name, id)
        reason = report.reason or f"the robot reported that it has {report.outcome}"
        return ActionFailed(name, reason, report.unreadable, id)

    def to_task_run(self, end: ActionEnd, now: float, distance: float, climbed: float) -> TaskRun:
        """The action as it goes into the record."""
        reason = end.reason if isinstance(end, ActionFailed) else None
        outcome = "done"
        if not isinstance(end, ActionSucceeded):
            outcome = "interrupted" if self._interrupted else "cancelled"
            outcome = "failed" if self.cancelled is None else outcome
            reason = "; ".join(filter(None, (self.cancelled, reason))) or None
        return TaskRun(
            task=self.task.name,
            action=self.task.action,
            object_id=self.task.object_id,
            start=self._started,
            end=now,
            outcome=outcome,
            reason=reason,
            distance=round(distance - self._way[0], DIGITS),
            climbed=round(climbed - self._way[1], DIGITS),
        )


SILENCE = 2.0
"""s after which a robot of which nothing was heard counts as silent"""


class RemoteRobot:
    """Orders actions over a channel, and tells the run what the robot reports. A step lasts as long
    as it does on the clock.

    While nothing is heard nothing is claimed: the action goes on, the pose is the last that was
    told, and `silent_since` says since when.
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
        """`run` is a word for this run that no other one has, and the same when it goes on from its
        journal; the clock gives UNIX time (s).

        Raises Unavailable if the robot does not tell within its `patience` (s) where it is.
        """
        self._channel, self._run, self._clock, self._sleep = channel, run, clock, sleep
        site, robot = navigator.site, navigator.robot
        self._drive = ToldDrive(time_step, BodyPose(0.0, 0.0, 0.0, 0.0))
        self.setup = RunSetup(
            WorldWithoutPhysics(site, robot), navigator, self._drive, ToldSensor()
        )
        self.odometry = Odometry(site)
        self.supply = ToldPower()
        self._offset = 0.0  # of the clock from the run's time
        self._action: RemoteAction | None = None
        self._order: StartOrder | None = None
        """that of the action, until it is given"""
        self._restarts = 0  # of the robot, before the action was ordered
        self._strays: set[str] = set()
        self._await_state(patience)

    @property
    def silent_since(self) -> float | None:
        """s of the run, since when nothing was heard; None: it is heard."""
        heard = self._channel.heard_at
        assert heard is not None
        return heard - self._offset if self._clock() - heard > SILENCE else None

    def place(self, pose: BodyPose, now: float) -> None:  # noqa: ARG002
        """The run begins or goes on at `now` (s); the robot stands where it does."""
        self._offset = self._clock() - now

    def settle(self, limit: float) -> bool:
        """Waits until the robot has acknowledged all orders, `limit` s at most; whether it has. To
        be called when a run has ended: until then the robot may not know it."""
        until = self._clock() + limit
        while self._channel.pending and self._clock() < until:
            self._sleep(self._drive.time_step)
            self._channel.flush()
            self._channel.take()
        return not self._channel.pending

    def apply_initial_state(self, initial: InitialState) -> None:
        self.odometry.distance, self.odometry.climbed = initial.distance, initial.climbed

    def restore(self, last: Entry) -> None:
        self.odometry.restore(last)

    def restore_anomalies(self, reported: Sequence[tuple[Anomaly, BodyPose]], now: float) -> None:
        """The robot remembers itself."""

    def update_faults(self, now: float) -> None:
        """What goes wrong is real."""

    def avoid(self, blockages: Sequence[Blockage]) -> None:
        self.setup = replace(self.setup, navigator=self.setup.navigator.avoiding(blockages))

    def start(self, command: StartAction, now: float, arrival_path: Path | None) -> RobotAction:  # noqa: ARG002
        """Orders an action. One of the same run and id that the robot knows already goes on."""
        # What a person asks for has no number, and a time of its own.
        id = f"{self._run}/{command.id}" if command.id else f"{self._run}/by hand at {now:g} s"
        way = (self.odometry.distance, self.odometry.climbed)
        begins = command.not_before
        begins = None if begins is None else begins + self._offset
        self._action = RemoteAction(id, command, now, way, self._cancel)
        self._order = StartOrder(id=id, task=command.task, not_before=begins)
        return self._action

    def advance(self, step: int, now: float, action: RobotAction | None) -> Sensed:  # noqa: ARG002
        """Waits until `now` on the clock, and takes what the robot has reported."""
        own = self._action if action else None
        if own and self._order:
            # Not before: what a journal leads through is not ordered again.
            self._restarts = self._channel.restarts
            self._channel.post(self._order)
            self._order = None
            if own.cancelled is not None:
                self._cancel()
        self._sleep(max(0.0, now + self._offset - self._clock()))
        self._channel.flush()
        site, ended = self.setup.navigator.site, None
        found: list[Anomaly] = []
        before = self._drive.pose
        for body in self._channel.take():
            match self._read(body, own):
                case RobotState() as state:
                    self._stands(state)
                    self._stop_strays(state, own)
                    ended = ended or self._lost(state, own)
                case EndReport() as report if own and report.id == own.id:
                    ended = report
                case FoundReport() as report if report.event is not EventKind.TIME_UP:
                    found.append(anomaly_of(report, site, self._drive.pose, now))
        self.odometry.add_motion(before, self._drive.pose, (), now)
        if own is None or ended is None:
            return Sensed(found=tuple(found))
        reading = reading_of(own.task, ended, site, self._drive.pose, now)
        if reading and not reading.normal:
            found.append(located_anomaly(reading, site))
        self._action = None
        end = own.end(ended, reading is not None and not reading.normal)
        return Sensed(end, reading, tuple(found))

    def state(self) -> dict[str, Any]:
        pose, way = self._drive.pose, self.odometry
        return {
            "pose": (pose.x, pose.y, pose.z, pose.yaw, pose.pitch),
            "distance": way.distance,
            "climbed": way.climbed,
            "charge": self.supply.charge,
        }

    def clear_reported(self) -> None:
        """Contacts and mishaps are not reported."""

    def _await_state(self, patience: float) -> None:
        until = self._clock() + patience
        while self._clock() < until:
            self._channel.flush()
            for body in self._channel.take():
                if isinstance(state := self._read(body, None), RobotState):
                    self._stands(state)
                    return
            self._sleep(self._drive.time_step)
        raise Unavailable(
            f"the robot has not told within {patience:g} s where it is: look whether it is on and "
            "connected"
        )

    def _read(
        self, body: dict[str, Any], own: RemoteAction | None
    ) -> RobotState | EndReport | FoundReport | None:
        """The report; an end that makes no sense is a failure, anything else is passed over."""
        try:
            return REPORTS.validate_python(body)
        except ValidationError as error:
            why = error.errors()[0]["msg"]
            _log.warning("the robot reports what makes no sense: %s", why)
        if own is None or body.get("type") != "ended" or body.get("id") != own.id:
            return None
        reason = f"the robot reported an end that makes no sense: {why}"
        return EndReport(id=own.id, outcome="failed", reason=reason)

    def _stands(self, state: RobotState) -> None:
        at = state.pose
        self._drive.pose = BodyPose(at.x, at.y, at.z, at.yaw, state.pitch)
        self.supply.charge, self.supply.charging = state.charge, state.charging

    def _stop_strays(self, state: RobotState, own: RemoteAction | None) -> None:
        """Stops an action of this run that nobody awaits any more, as one by hand from before Argo
        itself began anew."""
        id = state.action
        if id is None or not id.startswith(f"{self._run}/") or (own and own.id == id):
            return
        if id not in self._strays:
            self._strays.add(id)
            self._channel.post(CancelOrder(id=id))

    def _cancel(self) -> None:
        """Orders the action to be stopped, once it has been ordered."""
        if self._action and self._order is None:
            self._channel.post(CancelOrder(id=self._action.id))
            self._channel.flush()  # as it may be the last that the run does

    def _lost(self, state: RobotState, own: RemoteAction | None) -> EndReport | None:
        """The end of an action that a robot which began anew has forgotten."""
        if own is None or self._channel.restarts == self._restarts or own.id in state.known:
            return None
        if any(order.get("id") == own.id for order in self._channel.pending):
            return None  # it is told anew
        reason = "the robot began anew, and knows nothing of the action any more"
        return EndReport(id=own.id, outcome="failed", reason=reason)
