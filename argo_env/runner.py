"""The mission runner: the loop between the state machine and what carries its actions out."""

import math
from collections.abc import Callable, Sequence

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
from argo_compiler.il import EventKind, Mission, Task
from argo_env.action import ActionEnd, ActionUnderWay, Rig
from argo_env.contacts import ContactWatch
from argo_env.interruptions import InterruptionWatch
from argo_env.journal import Journal
from argo_env.log import Entry, LoggedEvent, RunLog
from argo_env.record import Contact, Reading, Result, RunRecord, TaskRun, TraceStep
from argo_env.robot.pose import BodyPose
from argo_env.settings import RunSettings
from argo_env.starting import start_pose
from argo_env.velocity import WayVelocity
from argo_env.verdict import failed_tasks, judge

SAMPLE_PERIOD = 0.5  # s between recorded places of the robot
TIME_LIMIT = 4 * 3600.0  # s of simulated time after which a run is stopped

Observer = Callable[[float, Task | None], None]
"""Told the simulated time (s) and the task under way after every step."""

Announcer = Callable[[Reading], None]
"""Told each reading when it is certain: with a journal, when it is on disk."""


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
        self._seed = settings.seed
        self._diagnostics = diagnostics
        events = [(t, event.original()) for t, event in settings.events]
        self._events = sorted(events, key=lambda given: given[0])
        self._journal = journal
        self._hfsm = lower(mission)
        self._executor = Executor(self._hfsm)
        self._log = RunLog(rig.navigator.site)
        self._contacts = ContactWatch()
        self._closed: list[Contact] = []
        self._interruptions = InterruptionWatch()
        self._velocity = WayVelocity(mission)
        self._action: ActionUnderWay | None = None
        self._steps = 0
        self._distance = 0.0
        self._climbed = 0.0
        self._given = 0

    @property
    def _now(self) -> float:
        """s; counted in steps, so that nothing adds up."""
        return round(self._steps * self._rig.drive.time_step, 6)

    def run(self, observe: Observer | None = None, announce: Announcer | None = None) -> RunRecord:
        """Runs the mission to its end; returns the record.

        Raises ArgoError if the mission makes no sense, the robot can't stand where it starts, or
        the journal does not fit or can't be written.
        """
        self._obey(self._executor.start(self._now))
        for entry in self._journal.entries if self._journal else ():
            self._replay(entry)
        last = self._log.last
        self._rig.drive.place(last.body_pose if last else self._start_pose())
        if last is None or not last.ended:
            resumed = last is not None and not self._executor.finished
            self._note(sample=self._unsampled, resumed=resumed)
            self._go_on(observe, announce)
        return self._record()

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
        self._distance, self._climbed = entry.distance, entry.climbed
        self._given = entry.given
        self._contacts.restore(entry.touching)
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
            if observe:
                observe(self._now, self._action.task if self._action else None)
        action = self._action
        if action:
            action.cancel("the run was stopped", interrupted=False)
        run = self._run_of(action, ActionStopped(action.task.name)) if action else None
        self._closed += self._contacts.open
        self._contacts.restore(())
        self._note(task=run, sample=self._unsampled, ended=True, stopped=stopped)

    def _reason_to_stop(self) -> str | None:
        if self._now >= TIME_LIMIT:
            return f"it was stopped after {self._now:.0f} s"
        waits = self._executor.running is None and self._executor.next_deadline is None
        if waits and self._given == len(self._events):
            why = "paused" if self._executor.paused else "waiting for an event"
            return f"the robot stands still since {self._now:.0f} s, {why}, and nothing more occurs"
        return None

    def _advance(self, announce: Announcer | None) -> None:
        """One step of simulated time: the robot moves, and the executor hears what happened."""
        self._steps += 1
        action, end = self._action, self._move()
        reading = action.reading(self._now) if action and end else None
        events: list[Event] = []
        if reading and not reading.normal:
            # Before the end, so that a reaction to it comes first and no next task is begun.
            shows = f"{reading.name} shows {reading.value:g} {reading.unit}"
            events.append(Occurred(EventKind.ABNORMAL_READING, shows))
        run = self._run_of(action, end) if action and end else None
        events += (end,) if end else ()
        while self._given < len(self._events) and self._events[self._given][0] <= self._now:
            events.append(self._events[self._given][1])
            self._given += 1
        due = self._steps % max(1, round(SAMPLE_PERIOD / self._rig.drive.time_step)) == 0
        if events or due:
            self._note(events, reading=reading, task=run, sample=due)
        if reading and announce:
            announce(reading)
        deadline = self._executor.next_deadline
        if not self._executor.finished and deadline is not None and deadline <= self._now:
            self._note([Tick()])

    def _move(self) -> ActionEnd | None:
        """The step of the action under way; returns its end, if that is it."""
        if self._action is None:
            return None
        before = self._rig.drive.pose
        end = self._action.step()
        after = self._rig.drive.pose
        self._distance += math.dist((before.x, before.y, before.z), (after.x, after.y, after.z))
        self._climbed += max(0.0, after.z - before.z)
        self._closed += self._contacts.note(self._rig.world.touches(), self._now)
        return end

    def _note(
        self,
        events: Sequence[Event] = (),
        *,
        reading: Reading | None = None,
        task: TaskRun | None = None,
        sample: bool = False,
        resumed: bool = False,
        ended: bool = False,
        stopped: str | None = None,
    ) -> None:
        """Makes an entry of the present moment, writes it, and acts on it."""
        pose = self._rig.drive.pose
        entry = Entry(
            t=self._now,
            pose=(pose.x, pose.y, pose.z, pose.yaw, pose.pitch),
            distance=self._distance,
            climbed=self._climbed,
            given=self._given,
            running=self._running,
            events=tuple(LoggedEvent.of(event) for event in events),
            reading=reading,
            task=task,
            contacts=tuple(self._closed),
            touching=self._contacts.open,
            sample=sample,
            resumed=resumed,
            ended=ended,
            stopped=stopped,
        )
        if self._journal:
            self._journal.append(entry)
        self._closed.clear()
        self._take(entry)

    def _take(self, entry: Entry) -> None:
        """Adds an entry to the log and tells the executor its events."""
        self._log.add(entry)
        if entry.task:
            self._action = None
            if entry.task.outcome == "done":
                self._velocity.arrived(entry.task.task)
        for event in entry.events:
            if not self._executor.finished:
                self._obey(self._executor.handle(event.original(), self._now))
                self._interruptions.look(self._executor, self._now)

    def _obey(self, commands: Sequence[StartAction | CancelAction]) -> None:
        for command in commands:
            match command:
                case StartAction(task):
                    self._action = ActionUnderWay(
                        task, self._velocity.to(task), self._rig,
                        self._now, self._distance, self._climbed,
                    )  # fmt: skip
                case CancelAction(_, reason):
                    if self._action:
                        goes_on = self._executor.paused or self._executor.reaction is not None
                        self._action.cancel(reason, interrupted=goes_on)

    def _run_of(self, action: ActionUnderWay, end: ActionEnd) -> TaskRun:
        return action.run(end, self._now, self._distance, self._climbed)

    @property
    def _running(self) -> str | None:
        return self._action.task.name if self._action else None

    @property
    def _unsampled(self) -> bool:
        return not self._log.path or self._log.path[-1].t < self._now

    def _record(self) -> RunRecord:
        log, site = self._log, self._rig.navigator.site
        return RunRecord(
            mission=self._mission,
            hfsm=self._hfsm,
            site=site.name,
            robot=self._rig.navigator.robot.name,
            drive=self._rig.drive.name,
            sensor=self._rig.sensor.name,
            seed=self._seed,
            diagnostics=self._diagnostics,
            result=self._result(),
            tasks=tuple(log.tasks),
            readings=tuple(log.readings),
            contacts=tuple(sorted(log.contacts, key=lambda c: (c.start, c.link, c.element))),
            trace=tuple(
                TraceStep(t=e.time, source=e.source, target=e.target, cause=e.why)
                for e in self._executor.trace
            ),
            path=tuple(log.path),
            interruptions=self._interruptions.all(self._now),
            resumed=tuple(log.resumed),
        )

    def _result(self) -> Result:
        return judge(
            self._mission,
            self._hfsm,
            self._rig.navigator.site.docks,
            self._log,
            self._executor.outcome if self._executor.finished else None,
            failed_tasks(self._log.tasks, self._executor.trace),
        )
