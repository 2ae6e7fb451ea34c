"""The mission runner: the loop between the state machine and what carries its actions out."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from argo_compiler.diagnostics import Diagnostic
from argo_compiler.errors import ArgoError
from argo_compiler.hfsm import (
    ActionStopped,
    CancelAction,
    Event,
    Executor,
    Occurred,
    StartAction,
    Tick,
    lower,
)
from argo_compiler.il import Mission, Task
from argo_compiler.model import Pose
from argo_env.drives.powertrain import Powertrain
from argo_env.navigation import Path
from argo_env.navigation.retreat import driven, recent
from argo_env.planning.start import start_pose
from argo_env.robot.pose import BodyPose
from argo_env.run.action import RETREAT, ActionEnd, ActionUnderWay, Rig
from argo_env.run.interruptions import InterruptionWatch
from argo_env.run.journal import Journal
from argo_env.run.log import Entry, LoggedEvent, RunLog
from argo_env.run.odometry import Odometry
from argo_env.run.perception import Perception, abnormal_reading, blockage
from argo_env.run.record import Anomaly, Reading, RunRecord, TaskRun
from argo_env.run.recorder import Recorder
from argo_env.run.scheduled_events import GivenEvents
from argo_env.run.spec import RunSettings
from argo_env.run.summary import make_record
from argo_env.run.velocity import WayVelocity

SAMPLE_PERIOD = 0.5  # s between recorded places of the robot
TIME_LIMIT = 4 * 3600.0  # s of simulated time after which a run is stopped
SETTLING = 120.0  # s that a robot which stands still waits for what faults may lead to

Observer = Callable[[float, Task | None], None]
"""Told the simulated time (s) and the task under way after every step."""

Announcer = Callable[[Reading | Anomaly], None]
"""Told each reading and each finding when it is certain: with a journal, when it is on disk."""

LoggedEvents = Sequence[tuple[float, LoggedEvent]]
"""Events and their times (s)."""


class MissionRunner:
    """Runs one mission. Holds the executor, the action under way and the log; use it once.

    All that happens goes through an entry: into the journal, into the log, then to the executor. So
    the entries of a journal lead to where the run stood.
    """

    def __init__(
        self,
        mission: Mission,
        rig: Rig,
        settings: RunSettings,
        diagnostics: tuple[Diagnostic, ...] = (),
        journal: Journal | None = None,
    ) -> None:
        """With a `journal` the run is written to it, and goes on from what is there already."""
        self._mission = mission
        self._rig = rig
        self._settings = settings
        self._diagnostics = diagnostics
        self._given = GivenEvents(settings.events)
        self._journal = journal
        self._hfsm = lower(mission)
        self._executor = Executor(self._hfsm)
        self._log = RunLog(rig.navigator.site)
        site, robot = rig.navigator.site, rig.navigator.robot
        self._odometry = Odometry(robot, rig.battery, site)
        self._perception = Perception(rig.watches, site, rig.drive.time_step)
        self._interruptions = InterruptionWatch()
        self._velocity = WayVelocity(mission)
        self._action: ActionUnderWay | None = None
        self._came: Path | None = None
        self._steps = 0
        self._recorder: Recorder | None = None

    @property
    def _now(self) -> float:
        """s; counted in steps, so that nothing adds up."""
        return round(self._steps * self._rig.drive.time_step, 6)

    def run(
        self,
        observe: Observer | None = None,
        announce: Announcer | None = None,
        recorder: Recorder | None = None,
        events: LoggedEvents = (),
    ) -> RunRecord:
        """Runs the mission to its end; returns the record. A run that goes on from its journal may
        be given further `events` and their times (s).

        Raises ArgoError if the mission makes no sense, the robot can't stand where it starts, or
        the journal does not fit or can't be written.
        """
        self._obey(self._executor.start(self._now))
        for entry in self._journal.entries if self._journal else ():
            self._replay(entry)
        last = self._log.last
        self._rig.drive.place(last.body_pose if last else self._start_pose())
        if self._rig.schedule:
            self._rig.schedule.advance(self._now)
        if self._journal and last:
            self._odometry.restore(last)
            told = [(a, e.body_pose) for e in self._journal.entries for a in e.found]
            self._perception.remember(told, self._now)
            if path := self._log.path:
                seen = (Pose(x=s.x, y=s.y, z=s.z, yaw=s.yaw) for s in reversed(path))
                self._came = driven(recent(seen, 2 * RETREAT))
                if self._action:
                    self._action.came = self._came
        if last is None or not last.ended:
            resumed = last is not None and not self._executor.finished
            self._recorder = recorder
            if recorder:
                recorder.step(self._now, None)
            self._note(sample=self._unsampled, resumed=resumed, added=events)
            self._go_on(observe, announce)
        return make_record(
            self._mission, self._hfsm, self._rig, self._settings.seed, self._diagnostics, self._log,
            self._executor, self._interruptions.all(self._now),
            self._rig.schedule.faults if self._rig.schedule else (),
        )  # fmt: skip

    def _start_pose(self) -> BodyPose:
        site = self._rig.navigator.site
        for area in (self._mission.start_area, self._mission.end_area):
            if area is not None and area not in site.docks:
                known = ", ".join(map(str, sorted(site.docks)))
                raise ArgoError(f"site {site.name} has no starting area {area}; there are: {known}")
        pose = self._rig.navigator.snap(start_pose(self._mission, site.docks))
        return BodyPose(pose.x, pose.y, pose.z, pose.yaw)

    def _replay(self, entry: Entry) -> None:
        """Does again what led to an entry, but for what the robot did."""
        self._steps = round(entry.t / self._rig.drive.time_step)
        self._odometry.restore(entry)
        self._given.occurred = entry.given
        try:
            if entry.events and entry.running != self._running:
                raise ValueError(f"{entry.running} is said to run, and {self._running} does")
            self._take(entry)
        except ValueError as error:
            raise ArgoError(
                f"the journal does not fit its mission at {entry.t:g} s: {error}; "
                "begin anew with `argo run`"
            ) from error

    def _go_on(self, observe: Observer | None, announce: Announcer | None) -> None:
        stopped = None
        while not self._executor.finished and (stopped := self._reason_to_stop()) is None:
            self._advance(announce)
            if self._recorder:
                self._recorder.step(self._now, self._action)
            if observe:
                observe(self._now, self._action.task if self._action else None)
        action = self._action
        if action:
            action.cancel("the run was stopped", interrupted=False)
        run = self._run_of(action, ActionStopped(action.task.name)) if action else None
        self._odometry.close()
        self._note(task=run, sample=self._unsampled, ended=True, stopped=stopped)

    def _reason_to_stop(self) -> str | None:
        now, executor, schedule = self._now, self._executor, self._rig.schedule
        if now >= TIME_LIMIT:
            return f"it was stopped after {now:.0f} s"
        if self._odometry.empty:
            return f"the battery was empty after {now:.0f} s"
        waits = executor.running is None and executor.next_deadline is None
        held = isinstance(self._rig.drive, Powertrain) and self._rig.drive.pressed
        if not (waits or held) or self._given.pending or self._odometry.charging:
            return None
        since = self._log.last_event
        if schedule is not None and schedule.faults:
            # What has begun or ended may still be found.
            since = max(since, schedule.last_change)
            if schedule.pending or now < since + SETTLING:
                return None
        why = "held by its emergency stop" if held else "waiting for an event"
        why = "paused" if executor.paused else why
        return f"the robot stands still since {since:.0f} s, {why}, and nothing more occurs"

    def _advance(self, announce: Announcer | None) -> None:
        """One step of simulated time: the robot moves, and the executor hears what happened."""
        self._steps += 1
        now, drive, site = self._now, self._rig.drive, self._rig.navigator.site
        if self._rig.schedule:
            self._rig.schedule.advance(now)
        before, action = drive.pose, self._action
        end = action.step() if action else None
        if action:
            self._odometry.moved(before, drive.pose, self._rig.world.touches(), now)
            self._odometry.trouble(drive.incidents, now)
        self._odometry.spend(
            before, drive.pose, drive.time_step, action is not None and action.measuring
        )
        noticed = self._perception.look(self._steps, now, drive.pose)
        reading = action.reading(now) if action and end else None
        abnormal = [abnormal_reading(reading, site)] if reading and not reading.normal else []
        found = (*noticed, *abnormal)
        # Before the end, so that a reaction to it comes first and no next task is begun.
        events: list[Event] = [Occurred(anomaly.kind, anomaly.detail) for anomaly in found]
        run = self._run_of(action, end) if action and end else None
        events += (end,) if end else ()
        events += self._given.due(now)
        due = self._steps % max(1, round(SAMPLE_PERIOD / drive.time_step)) == 0
        if events or due:
            self._note(events, found=found, reading=reading, task=run, sample=due)
        if announce:
            for news in (*noticed, *((reading,) if reading else ())):
                announce(news)
        deadline = self._executor.next_deadline
        if not self._executor.finished and deadline is not None and deadline <= now:
            self._note([Tick()])

    def _note(
        self,
        events: Sequence[Event] = (),
        *,
        found: Sequence[Anomaly] = (),
        reading: Reading | None = None,
        task: TaskRun | None = None,
        sample: bool = False,
        resumed: bool = False,
        ended: bool = False,
        stopped: str | None = None,
        added: LoggedEvents = (),
    ) -> None:
        """Makes an entry of the present moment, writes it, and acts on it."""
        pose, odometry = self._rig.drive.pose, self._odometry
        entry = Entry(
            t=self._now,
            pose=(pose.x, pose.y, pose.z, pose.yaw, pose.pitch),
            distance=odometry.distance,
            climbed=odometry.climbed,
            charge=odometry.charge,
            given=self._given.occurred,
            added=tuple(added),
            running=self._running,
            events=tuple(LoggedEvent.of(event) for event in events),
            found=tuple(found),
            reading=reading,
            task=task,
            mishaps=tuple(odometry.mishaps),
            contacts=tuple(odometry.over),
            touching=odometry.touching,
            sample=sample,
            resumed=resumed,
            ended=ended,
            stopped=stopped,
        )
        if self._journal:
            self._journal.append(entry)
        odometry.over.clear()
        odometry.mishaps.clear()
        self._take(entry)
        if self._recorder:
            self._recorder.note(entry, self._executor)

    def _take(self, entry: Entry) -> None:
        """Adds an entry to the log and tells the executor its events."""
        self._log.add(entry)
        self._given.add(entry.added)
        if closed := [b for anomaly in entry.found if (b := blockage(anomaly))]:
            navigator = self._rig.navigator.avoiding(closed)
            self._rig = replace(self._rig, navigator=navigator)
        if entry.task:
            self._came = (self._action and self._action.path) or self._came
            self._action = None
            if entry.task.outcome == "done":
                self._velocity.arrived(entry.task.task)
        for event in entry.events:
            if not self._executor.finished:
                self._obey(self._executor.handle(event.original(), self._now))
                self._interruptions.look(self._executor, self._now)
        if closed and self._action:
            self._action.detour(self._rig)

    def _obey(self, commands: Sequence[StartAction | CancelAction]) -> None:
        for command in commands:
            match command:
                case StartAction(task):
                    self._action = ActionUnderWay(
                        task, self._velocity.to(task), self._rig,
                        self._now, self._odometry.distance, self._odometry.climbed, self._came,
                    )  # fmt: skip
                case CancelAction(_, reason):
                    if self._action:
                        goes_on = self._executor.paused or self._executor.reaction is not None
                        self._action.cancel(reason, interrupted=goes_on)

    def _run_of(self, action: ActionUnderWay, end: ActionEnd) -> TaskRun:
        return action.run(end, self._now, self._odometry.distance, self._odometry.climbed)

    @property
    def _running(self) -> str | None:
        return self._action.task.name if self._action else None

    @property
    def _unsampled(self) -> bool:
        return not self._log.path or self._log.path[-1].t < self._now
