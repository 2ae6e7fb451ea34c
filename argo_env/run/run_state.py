"""State of a run: the sum of its entries, the machine that handles them, and scheduled events."""

import math
from collections.abc import Iterable, Sequence

from argo_compiler.base.errors import Invalid, Remedy
from argo_compiler.base.message import Message
from argo_compiler.hfsm import (
    ActionStopped,
    CancelAction,
    Command,
    Event,
    GiveBack,
    Progress,
    Resume,
    StartAction,
)
from argo_env.navigation import Path
from argo_env.run.initial_state import InitialState, KnownAnomaly
from argo_env.run.log import Entry, LoggedEvent, RunLog
from argo_env.run.machine import Machine
from argo_env.run.perception import blockage_from_anomaly
from argo_env.run.record import RunRecord, TaskRun
from argo_env.run.result import make_record
from argo_env.run.robot import ActionEnd, AnyRobot, RobotAction
from argo_env.run.run_commands import Supervision, mark_abnormal
from argo_env.run.spec import RunSpec
from argo_env.run.vehicle import find_last_path_part
from argo_env.run.visits_and_rounds import InterruptionTracker


class ScheduledEvents:
    """Events of a run in the order of their times; holds how many of them have occurred."""

    def __init__(self, events: Iterable[tuple[float, LoggedEvent]]) -> None:
        self._events: list[tuple[float, Event]] = []
        self.occurred = 0
        self.add(events)

    @property
    def pending(self) -> bool:
        """True if any event is still to occur."""
        return self.occurred < len(self._events)

    @property
    def next_time(self) -> float:
        """Time of the next event in s; infinite if there is none."""
        return self._events[self.occurred][0] if self.pending else math.inf

    @property
    def upcoming(self) -> tuple[tuple[float, LoggedEvent], ...]:
        """Events that are still to occur, with their times in s."""
        return tuple(
            (t, LoggedEvent.from_event(event)) for t, event in self._events[self.occurred :]
        )

    def add(self, events: Iterable[tuple[float, LoggedEvent]]) -> None:
        """Add events with their times (s); at equal times, earlier added events come first."""
        upcoming = [*self._events[self.occurred :], *((t, event.to_event()) for t, event in events)]
        self._events[self.occurred :] = sorted(upcoming, key=lambda timed: timed[0])

    def take_due(self, now: float, at_rest: bool, acting: bool = False) -> list[Event]:
        """Return the events that are due by time `now` (s) and can occur; count them as occurred.

        Two kinds of events wait, and so do all events after them: the robot is given back only
        `at_rest`, with no action running, and as the only event of its step; the mission is not
        resumed while the robot is `acting` by hand.
        """
        first = self.occurred
        while self.pending and self._events[self.occurred][0] <= now:
            if self._is_give_back_next and (not at_rest or self.occurred > first):
                break
            if acting and isinstance(self._events[self.occurred][1], Resume):
                break
            self.occurred += 1
        return [event for _, event in self._events[first : self.occurred]]

    def is_give_back_waiting(self, now: float) -> bool:
        """Return True if the next event is a give-back that was due by `now` (s) and waits."""
        return self.pending and self._events[self.occurred][0] <= now and self._is_give_back_next

    @property
    def _is_give_back_next(self) -> bool:
        return isinstance(self._events[self.occurred][1], GiveBack)


class SimulationState:
    """State of a run: the machine, the log and the running action.

    It changes with the entries that it applies. Equal entries lead to equal states, whether they
    are made now or read from a journal.
    """

    def __init__(self, machine: Machine, vehicle: AnyRobot, spec: RunSpec) -> None:
        self.machine = machine
        self.action: RobotAction | None = None
        """the running action, if there is one"""
        self.log = RunLog(vehicle.setup.navigator.site)
        self.supervision = Supervision(spec.mission)
        self.lost_task_run: TaskRun | None = None
        """the action by hand that was running when the previous process died, if there was one"""
        self.scheduled = ScheduledEvents(spec.events)
        self.steps = 0
        """time steps of the drive since the run began"""
        self._beginning = spec.beginning
        self._start_time = spec.beginning.mission_seconds_at_start if spec.beginning else 0.0
        self.now = self._start_time
        """s of simulated time"""
        self._mission = spec.mission
        self._time_step = vehicle.setup.drive.time_step
        self._vehicle = vehicle
        self._interruptions = InterruptionTracker()
        self._arrival_path: Path | None = None

    @property
    def needs_path_sample(self) -> bool:
        """True if the current pose is not yet a point of the recorded path."""
        last = self.log.last_sample_time
        return last is None or last < self.now

    def set_steps(self, steps: int) -> None:
        """Set the number of time steps since the run began, and with it the simulated time."""
        self.steps = steps
        # From the number of steps, so that rounding errors do not add up.
        self.now = round(self._start_time + steps * self._time_step, 6)

    def entry(
        self, events: Sequence[Event] = (), *, sample: bool = False, task: TaskRun | None = None
    ) -> Entry:
        """Return an entry of the current time with these events; nothing changes yet.

        With `sample`, the entry's pose becomes a point of the recorded path. `task` is the task run
        that has ended.
        """
        return Entry(
            t=self.now,
            given=self.scheduled.occurred,
            running=self._running_task,
            events=tuple(LoggedEvent.from_event(self._with_abnormality(event)) for event in events),
            task=task,
            sample=sample,
            **self._vehicle.state_for_entry(),
        )

    def apply_without_observers(self, entry: Entry) -> None:
        """Add an entry to the log, let the machine handle its events, and execute its commands."""
        self.log.add(entry)
        self.scheduled.add(entry.added)
        if schedule := self._vehicle.setup.schedule:
            for fault in entry.faults:
                schedule.add(fault)
        if closed := [b for anomaly in entry.found if (b := blockage_from_anomaly(anomaly))]:
            self._vehicle.add_blockages(closed)
        if entry.task:
            self._arrival_path = (self.action and self.action.path) or self._arrival_path
            self.action = None
            if entry.task.by_hand:
                self.supervision.on_action_end(entry.task, entry)
        for event in entry.events:
            if not self.machine.finished:
                self.execute(self.machine.handle(event.to_event(), self.now))
                self._interruptions.update(self.machine, self.now)
                self.supervision.update(event.kind, self.machine)
        self._vehicle.set_mission_state(self.machine.awaited_charges, self.machine.reaction)
        if entry.by_hand:
            self.supervision.acting = True
            self._start_action(StartAction(entry.by_hand))
        if entry.stop_by_hand and self.action:
            self.action.cancel(Message("a person stopped it"), is_interruption=False)
        if closed and self.action:
            self.action.detour_if_blocked(self._vehicle.setup)

    def start(self) -> None:
        """Start the machine and execute its first commands."""
        self.execute(self.machine.start(self.now))
        self._interruptions.update(self.machine, self.now)
        self._vehicle.set_mission_state(self.machine.awaited_charges, self.machine.reaction)

    def execute(self, commands: Sequence[Command]) -> None:
        """Execute the machine's commands: start actions and cancel them."""
        for command in commands:
            match command:
                case StartAction():
                    self._start_action(command)
                case CancelAction(_, reason):
                    if self.action:
                        interrupted = self.machine.paused or self.machine.reaction is not None
                        self.action.cancel(reason, is_interruption=interrupted)

    def replay_entry(self, entry: Entry) -> None:
        """Apply an entry of a journal, with the time and the robot's odometry of that entry.

        Raises Invalid if the entry belongs to another run.
        """
        self.set_steps(round((entry.t - self._start_time) / self._time_step))
        self._vehicle.odometry.restore(entry)
        self.scheduled.occurred = entry.given
        try:
            if entry.events and entry.running != self._running_task:
                raise ValueError(
                    f"the entry names '{entry.running}' as the running task, and the machine runs "
                    f"'{self._running_task}'"
                )
            self.apply_without_observers(entry)
        except ValueError as error:
            raise Invalid(
                Message(
                    "the journal does not fit its mission at {t:g} s: {error}; begin a new run",
                    t=entry.t,
                    error=error,
                ),
                remedies=(Remedy.RUN_ANEW,),
            ) from error

    def restore_path_and_end_action_by_hand(self) -> None:
        """Complete the state after a journal's entries were replayed.

        The path by which the robot reached its pose is restored from the log, and an action by hand
        that was running ends as interrupted, so its task does not count as done.
        """
        if self.supervision.acting and self.action:
            self.action.cancel(
                Message("the process that carried it out died"), is_interruption=True
            )
            self.lost_task_run = self.task_run(ActionStopped(self.action.task.name))
            self.action, self.supervision.acting = None, False
        if arrival_path := find_last_path_part(self.log):
            self._arrival_path = arrival_path
            if self.action:
                self.action.arrival_path = arrival_path

    def task_run(self, end: ActionEnd) -> TaskRun:
        """Return the running action, which ends now by `end`, as a TaskRun for the run's record."""
        assert self.action is not None
        odometry = self._vehicle.odometry
        run = self.action.to_task_run(end, self.now, odometry.distance, odometry.climbed)
        return run.model_copy(update={"by_hand": True}) if self.supervision.acting else run

    def stop_action(self) -> TaskRun | None:
        """Cancel the running action as the run ends, and return its TaskRun for the record.

        Returns None if no action is running.
        """
        if self.action is None:
            return None
        self.action.cancel(Message("the run was stopped"), is_interruption=False)
        return self.task_run(ActionStopped(self.action.task.name))

    def initial_state(self, progress: Progress) -> InitialState:
        """Return the initial state of a run that continues from here with the given progress."""
        drive, odometry = self._vehicle.setup.drive, self._vehicle.odometry
        known = self._beginning.known if self._beginning else ()
        found = (KnownAnomaly(anomaly=a, pose=pose) for a, pose in self.log.found)
        pose = drive.pose
        return InitialState(
            progress=progress,
            pose=(pose.x, pose.y, pose.z, pose.yaw, pose.pitch),
            charge=self._vehicle.supply.charge,
            distance=odometry.distance,
            climbed=odometry.climbed,
            known=(*known, *found),
        )

    def record(self, spec: RunSpec, present: Entry | None = None) -> RunRecord:
        """Return the record of the run from its log, and from the `present` entry, if given.

        That entry is of the present moment and not in the log.
        """
        log = self.log if present is None else self.log.with_entry(present)
        return make_record(spec, self._vehicle.setup, self.machine, log, self._interruptions)

    def _start_action(self, command: StartAction) -> None:
        self.action = self._vehicle.prepare_action(command, self.now, self._arrival_path)

    def _with_abnormality(self, event: Event) -> Event:
        return mark_abnormal(self.log.site, self._mission, event)

    @property
    def _running_task(self) -> str | None:
        return self.action.task.name if self.action else None
