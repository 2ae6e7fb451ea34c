"""The mission runner: drives a machine through a world and keeps the record."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from argo_compiler.diagnostics import Diagnostic
from argo_compiler.errors import ArgoError
from argo_compiler.hfsm import (
    ActionFailed,
    ActionSucceeded,
    CancelAction,
    Command,
    Event,
    Executor,
    StartAction,
    Tick,
    lower,
)
from argo_compiler.il import Action, Mission, Task
from argo_compiler.model import Pose
from argo_env.navigation import Navigator, Path, UnreachableError
from argo_env.navigation.path import wrap
from argo_env.record import (
    Contact,
    PathSample,
    Reading,
    Result,
    RunRecord,
    TaskRun,
    TraceStep,
)
from argo_env.robot.drive import Drive, DriveStatus
from argo_env.robot.pose import BodyPose
from argo_env.sensing.sensor import MeasurementError, Sensor
from argo_env.world import Touch, World

SAMPLE_PERIOD = 0.5  # s between recorded places of the robot
TIME_LIMIT = 4 * 3600.0  # s of simulated time after which a run is stopped
CONTACT_GAP = 0.5  # s without a touch that end a contact; shorter, it is the same scrape
DOCKED_DISTANCE = 0.1  # m
DOCKED_ANGLE = math.radians(5.0)
_DIGITS = 4  # of recorded lengths and angles: below what the geometry means

Observer = Callable[[float, Task | None], None]
"""Told the simulated time (s) and the task under way after every step."""


@dataclass
class _Activity:
    """The action under way. Changes as it goes on."""

    task: Task
    started: float
    distance_before: float
    climbed_before: float
    reading_left: float | None = None
    """s until the measurement; None: still driving"""
    failure: str | None = None


@dataclass
class _Log:
    """What the record is made from. Grows as the run goes on."""

    tasks: list[TaskRun] = field(default_factory=list)
    readings: list[Reading] = field(default_factory=list)
    contacts: list[Contact] = field(default_factory=list)
    path: list[PathSample] = field(default_factory=list)
    distance: float = 0.0
    climbed: float = 0.0


class MissionRunner:
    """Runs one mission. Holds the executor, the drive and the log; use it once."""

    def __init__(
        self,
        mission: Mission,
        world: World,
        navigator: Navigator,
        drive: Drive,
        sensor: Sensor,
        seed: int,
        diagnostics: tuple[Diagnostic, ...] = (),
    ) -> None:
        self._mission = mission
        self._world = world
        self._navigator = navigator
        self._drive = drive
        self._sensor = sensor
        self._seed = seed
        self._diagnostics = diagnostics
        self._hfsm = lower(mission)
        self._executor = Executor(self._hfsm)
        self._log = _Log()
        self._activity: _Activity | None = None
        self._velocity: float | None = None
        self._open: dict[tuple[str, str], Contact] = {}
        self._step = 0

    @property
    def _now(self) -> float:
        """s; counted in steps, so that nothing adds up."""
        return round(self._step * self._drive.time_step, 6)

    def run(self, observe: Observer | None = None) -> RunRecord:
        """Runs the mission to its end; returns the record.

        Raises ArgoError if the mission makes no sense or the robot can't stand where it starts.
        """
        docks = self._navigator.site.docks
        for area in (self._mission.start_area, self._mission.end_area):
            if area is not None and area not in docks:
                known = ", ".join(map(str, sorted(docks)))
                raise ArgoError(
                    f"site {self._navigator.site.name} has no starting area {area}; there are: "
                    f"{known}"
                )
        start = self._navigator.snap(self._start_pose())
        self._drive.place(BodyPose(start.x, start.y, start.z, start.yaw))
        self._sample()
        self._carry_out(self._executor.start(self._now))
        samples_apart = max(1, round(SAMPLE_PERIOD / self._drive.time_step))
        while not self._executor.finished and self._now < TIME_LIMIT:
            event = self._advance()
            if event is not None:
                self._end_activity(event)
                self._carry_out(self._executor.handle(event, self._now))
            elif (due := self._executor.next_deadline) is not None and due <= self._now:
                self._carry_out(self._executor.handle(Tick(), self._now))
            if self._step % samples_apart == 0 or self._executor.finished:
                self._sample()
            if observe:
                observe(self._now, self._activity.task if self._activity else None)
        if self._activity:
            self._close_activity("cancelled", "the run was stopped")
        self._log.contacts += self._open.values()
        return self._record()

    def _start_pose(self) -> Pose:
        for task in self._mission.tasks:
            if task.action is Action.START:
                self._velocity = task.velocity
                if task.pose:
                    return task.pose
        area = self._mission.start_area or min(self._navigator.site.docks)
        return self._navigator.site.docks[area]

    def _carry_out(self, commands: tuple[Command, ...]) -> None:
        for command in commands:
            match command:
                case CancelAction():
                    self._drive.halt()
                    self._close_activity("cancelled", "its group's time was up")
                case StartAction(task):
                    self._begin(task)

    def _begin(self, task: Task) -> None:
        self._activity = _Activity(task, self._now, self._log.distance, self._log.climbed)
        try:
            self._drive.begin(self._path_to(task), self._velocity)
        except UnreachableError as error:
            self._activity.failure = str(error)
        # A task's velocity is that of the way to the next task (thesis 3.2).
        self._velocity = task.velocity

    def _path_to(self, task: Task) -> Path:
        here = self._drive.pose
        start = Pose(x=here.x, y=here.y, z=here.z, yaw=here.yaw)
        if task.action is Action.MEASURE:
            return self._navigator.plan_to_view(start, self._checkpoint_id(task))
        if task.pose is None:
            raise UnreachableError(f"task {task.name} has no pose")
        return self._navigator.plan(start, task.pose)

    def _checkpoint_id(self, task: Task) -> int:
        known = {str(c.id): c.id for c in self._navigator.site.checkpoints}
        if task.object_id not in known:
            raise UnreachableError(
                f"site {self._navigator.site.name} has no checkpoint {task.object_id}"
            )
        return known[task.object_id]

    def _advance(self) -> Event | None:
        """One step of simulated time; returns how the action has ended, if it has."""
        self._step += 1
        activity = self._activity
        if activity is None:
            return None
        if activity.failure:
            return ActionFailed(activity.task.name, activity.failure)
        if activity.reading_left is not None:
            activity.reading_left -= self._drive.time_step
            self._note_contacts(self._world.touches())
            if activity.reading_left > 1e-9:
                return None
            return self._measure(activity.task)
        before = self._drive.pose
        status = self._drive.step()
        after = self._drive.pose
        self._log.distance += math.dist((before.x, before.y, before.z), (after.x, after.y, after.z))
        self._log.climbed += max(0.0, after.z - before.z)
        self._note_contacts(self._world.touches())
        match status:
            case DriveStatus.MOVING:
                return None
            case DriveStatus.FAILED:
                return ActionFailed(activity.task.name, self._drive.failure or "the drive failed")
            case DriveStatus.ARRIVED if activity.task.action is Action.MEASURE:
                activity.reading_left = self._navigator.robot.sensor.measuring_time
                self._world.move_arm(self._navigator.robot.arm_raised)
                return None
            case DriveStatus.ARRIVED:
                return ActionSucceeded(activity.task.name)

    def _measure(self, task: Task) -> Event:
        checkpoint = self._navigator.site.checkpoint(self._checkpoint_id(task))
        try:
            measurement = self._sensor.measure(checkpoint.id, self._drive.pose)
        except MeasurementError as error:
            return ActionFailed(task.name, str(error))
        self._log.readings.append(
            Reading(
                checkpoint=checkpoint.id,
                name=checkpoint.name,
                kind=checkpoint.kind,
                floor=checkpoint.floor,
                task=task.name,
                t=self._now,
                value=measurement.value,
                unit=checkpoint.unit,
                nominal=checkpoint.nominal,
                normal=checkpoint.nominal.contains(measurement.value),
                distance=round(measurement.distance, _DIGITS),
            )
        )
        return ActionSucceeded(task.name, measurement.value)

    def _end_activity(self, event: Event) -> None:
        if isinstance(event, ActionFailed):
            self._drive.halt()
            self._close_activity("failed", event.reason)
        else:
            self._close_activity("done", None)

    def _close_activity(self, outcome: str, reason: str | None) -> None:
        activity, self._activity = self._activity, None
        if activity is None:
            return
        self._world.move_arm(self._navigator.robot.arm_stowed)
        self._log.tasks.append(
            TaskRun(
                task=activity.task.name,
                action=activity.task.action,
                object_id=activity.task.object_id,
                start=activity.started,
                end=self._now,
                outcome=outcome,
                reason=reason,
                distance=round(self._log.distance - activity.distance_before, _DIGITS),
                climbed=round(self._log.climbed - activity.climbed_before, _DIGITS),
            )
        )

    def _note_contacts(self, touches: tuple[Touch, ...]) -> None:
        """One contact a pair of parts, for as long as they touch."""
        deepest: dict[tuple[str, str], Touch] = {}
        for touch in touches:
            key = (touch.link, touch.element)
            if key not in deepest or touch.depth > deepest[key].depth:
                deepest[key] = touch
        over = [k for k, c in self._open.items() if self._now - c.end > CONTACT_GAP]
        for key in over:
            self._log.contacts.append(self._open.pop(key))
        for key, touch in deepest.items():
            known = self._open.get(key)
            x, y, z = (round(v, _DIGITS) for v in touch.point)
            depth = round(touch.depth, _DIGITS)
            if known is None:
                self._open[key] = Contact(
                    start=self._now, end=self._now, link=touch.link, element=touch.element,
                    x=x, y=y, z=z, depth=depth,
                )  # fmt: skip
            else:
                update = {"end": self._now, "depth": max(depth, known.depth)}
                self._open[key] = known.model_copy(update=update)

    def _sample(self) -> None:
        pose = self._drive.pose
        self._log.path.append(
            PathSample(
                t=self._now,
                x=round(pose.x, _DIGITS),
                y=round(pose.y, _DIGITS),
                z=round(pose.z, _DIGITS),
                yaw=round(pose.yaw, _DIGITS),
                pitch=round(pose.pitch, _DIGITS),
                floor=self._navigator.site.floor_at(pose.z),
            )
        )

    def _record(self) -> RunRecord:
        return RunRecord(
            mission=self._mission,
            hfsm=self._hfsm,
            site=self._navigator.site.name,
            robot=self._navigator.robot.name,
            drive=self._drive.name,
            sensor=self._sensor.name,
            seed=self._seed,
            diagnostics=self._diagnostics,
            result=self._result(),
            tasks=tuple(self._log.tasks),
            readings=tuple(self._log.readings),
            contacts=tuple(sorted(self._log.contacts, key=lambda c: (c.start, c.link, c.element))),
            trace=tuple(
                TraceStep(t=e.time, source=e.source, target=e.target, cause=e.why)
                for e in self._executor.trace
            ),
            path=tuple(self._log.path),
        )

    def _praise(self) -> str:
        """The verdict of a success: a plan with conditions may pass tasks over."""
        done = {t.task for t in self._log.tasks}
        passed_over = [leaf.task.name for leaf in self._hfsm.leaves if leaf.task.name not in done]
        if passed_over:
            return f"the plan was carried out; its conditions passed over {', '.join(passed_over)}"
        return "everything was done as planned"

    def _result(self) -> Result:
        limit = self._mission.max_duration
        within = limit is None or self._now <= limit
        docked = None
        if self._mission.end_area is not None:
            docked = is_docked(self._drive.pose, self._navigator.site.docks, self._mission.end_area)
        failed = [t.task for t in self._log.tasks if t.outcome == "failed"]
        missing = []
        if not self._executor.finished:
            missing.append(f"it was stopped after {self._now:.0f} s")
        if failed:
            missing.append(f"failed: {', '.join(dict.fromkeys(failed))}")
        if not within:
            missing.append(f"it took {self._now:.0f} s of at most {limit:.0f} s")
        if docked is False:
            missing.append(f"the robot is not docked in starting area {self._mission.end_area}")
        return Result(
            success=not missing,
            verdict="; ".join(missing) if missing else self._praise(),
            duration=self._now,
            max_duration=limit,
            within_max_duration=within,
            docked=docked,
            distance=round(self._log.distance, _DIGITS),
            climbed=round(self._log.climbed, _DIGITS),
        )


def is_docked(pose: BodyPose, docks: Mapping[int, Pose], area: int) -> bool:
    """Whether a robot at `pose` is in the station of that area: within 10 cm and 5 degrees."""
    dock = docks[area]
    away = math.dist((pose.x, pose.y, pose.z), (dock.x, dock.y, dock.z))
    return away <= DOCKED_DISTANCE and abs(wrap(pose.yaw - dock.yaw)) <= DOCKED_ANGLE
