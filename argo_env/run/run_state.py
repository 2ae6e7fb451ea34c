"""The state of a run: what its entries add up to, the machine that they are told to, and the
events that are given beforehand."""

import math
from collections.abc import Iterable, Sequence

from argo_compiler.base.errors import Invalid, Remedy
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
from argo_env.run.perception import blockage
from argo_env.run.record import RunRecord, TaskRun
from argo_env.run.result import make_record
from argo_env.run.robot import ActionEnd, AnyRobot, RobotAction
from argo_env.run.run_commands import Supervision, mark_abnormal
from argo_env.run.spec import RunSpec
from argo_env.run.vehicle import way_come
from argo_env.run.visits_and_rounds import InterruptionTracker, RoundTracker


class ScheduledEvents:
    """Gives out events when they are due. Holds how many have occurred."""

    def __init__(self, events: Iterable[tuple[float, LoggedEvent]]) -> None:
        self._events: list[tuple[float, Event]] = []
        self.occurred = 0
        self.add(events)

    @property
    def pending(self) -> bool:
        """Whether any are still to occur."""
        return self.occurred < len(self._events)

    @property
    def next_time(self) -> float:
        """When the next one occurs (s); infinite if none does."""
        return self._events[self.occurred][0] if self.pending else math.inf

    @property
    def ahead(self) -> tuple[tuple[float, LoggedEvent], ...]:
        """Those that are still to occur."""
        return tuple((t, LoggedEvent.of(event)) for t, event in self._events[self.occurred :])

    def add(self, events: Iterable[tuple[float, LoggedEvent]]) -> None:
        """More of them; of equal times, those that were there before come first."""
        ahead = [*self._events[self.occurred :], *((t, event.original()) for t, event in events)]
        self._events[self.occurred :] = sorted(ahead, key=lambda given: given[0])

    def due(self, now: float, at_rest: bool, acting: bool = False) -> list[Event]:
        """Those that occur now, at time `now` (s). A robot is given back only `at_rest`, without
        an action, and in a step of its own; and where it is `acting` by hand the mission is not
        resumed. What comes after waits as well."""
        first = self.occurred
        while self.pending and self._events[self.occurred][0] <= now:
            if self._gives_back and (not at_rest or self.occurred > first):
                break
            if acting and isinstance(self._events[self.occurred][1], Resume):
                break
            self.occurred += 1
        return [event for _, event in self._events[first : self.occurred]]

    def waits_to_give_back(self, now: float) -> bool:
        """Whether something should have been given back by `now` (s), and waits."""
        return self.pending and self._events[self.occurred][0] <= now and self._gives_back

    @property
    def _gives_back(self) -> bool:
        return isinstance(self._events[self.occurred][1], GiveBack)


class RunState:
    """Where a run stands. Holds the machine, the log and the action under way, which change with
    the entries that it takes: equal entries lead to the same place, made now or read again."""

    def __init__(self, machine: Machine, vehicle: AnyRobot, spec: RunSpec) -> None:
        self.machine = machine
        self.action: RobotAction | None = None
        """the one under way"""
        self.log = RunLog(vehicle.setup.navigator.site)
        self.supervision = Supervision(spec.mission)
        self.lost: TaskRun | None = None
        """the action by hand that was under way when the process before this one died"""
        self.given = ScheduledEvents(spec.events)
        self.steps = 0
        """time steps of the drive since the run began"""
        self._beginning = spec.beginning
        self._begun = spec.beginning.at if spec.beginning else 0.0
        self.now = self._begun
        """s of simulated time"""
        self._mission = spec.mission
        self._time_step = vehicle.setup.drive.time_step
        self._vehicle = vehicle
        self._interruptions = InterruptionTracker()
        self._rounds = RoundTracker()
        self._came: Path | None = None

    @property
    def unsampled(self) -> bool:
        """Whether the present place is no point of the recorded path yet."""
        last = self.log.sampled_at
        return last is None or last < self.now

    def step_to(self, steps: int) -> None:
        """So many time steps of the drive have passed since the run began."""
        self.steps = steps
        # Counted in steps, so that nothing adds up.
        self.now = round(self._begun + steps * self._time_step, 6)

    def entry(
        self, events: Sequence[Event] = (), *, sample: bool = False, task: TaskRun | None = None
    ) -> Entry:
        """An entry of the present moment."""
        return Entry(
            t=self.now,
            given=self.given.occurred,
            running=self._running,
            events=tuple(LoggedEvent.of(self._seen(event)) for event in events),
            task=task,
            sample=sample,
            **self._vehicle.state(),
        )

    def take(self, entry: Entry) -> None:
        """Adds an entry to the log and tells the machine its events."""
        self.log.add(entry)
        self.given.add(entry.added)
        if schedule := self._vehicle.setup.schedule:
            for fault in entry.faults:
                schedule.add(fault)
        if closed := [b for anomaly in entry.found if (b := blockage(anomaly))]:
            self._vehicle.avoid(closed)
        if entry.task:
            self._came = (self.action and self.action.path) or self._came
            self.action = None
            if entry.task.by_hand:
                self.supervision.ended(entry.task, entry)
        for event in entry.events:
            if not self.machine.finished:
                self.obey(self.machine.handle(event.original(), self.now))
                self._look()
                self.supervision.heard(event.kind, self.machine)
        if entry.by_hand:
            self.supervision.acting = True
            self._begin(StartAction(entry.by_hand))
        if entry.stop_by_hand and self.action:
            self.action.cancel("a person stopped it", interrupted=False)
        if closed and self.action:
            self.action.detour(self._vehicle.setup)

    def start(self) -> None:
        """Starts the machine."""
        self.obey(self.machine.start(self.now))
        self._look()

    def obey(self, commands: Sequence[Command]) -> None:
        """Does what the machine asks for."""
        for command in commands:
            match command:
                case StartAction():
                    self._begin(command)
                case CancelAction(_, reason):
                    if self.action:
                        goes_on = self.machine.paused or self.machine.reaction is not None
                        self.action.cancel(reason, interrupted=goes_on)

    def replay(self, entry: Entry) -> None:
        """Does again what led to an entry, but for what the robot did.

        Raises Invalid if it is one of another run.
        """
        self.step_to(round((entry.t - self._begun) / self._time_step))
        self._vehicle.odometry.restore(entry)
        self.given.occurred = entry.given
        try:
            if entry.events and entry.running != self._running:
                raise ValueError(f"{entry.running} is said to run, and {self._running} does")
            self.take(entry)
        except ValueError as error:
            raise Invalid(
                f"the journal does not fit its mission at {entry.t:g} s: {error}; begin a new run",
                remedies=(Remedy.RUN_ANEW,),
            ) from error

    def look_back(self) -> None:
        """After a replay: by what path the robot came is what the log has seen of it, and what it
        did by hand is over."""
        if self.supervision.acting and self.action:
            self.action.cancel("the process that carried it out died", interrupted=True)
            self.lost = self.run_of(ActionStopped(self.action.task.name))
            self.action, self.supervision.acting = None, False
        if came := way_come(self.log):
            self._came = came
            if self.action:
                self.action.came = came

    def run_of(self, end: ActionEnd) -> TaskRun:
        """The action under way as it goes into the record, now that it ends."""
        assert self.action is not None
        odometry = self._vehicle.odometry
        run = self.action.run(end, self.now, odometry.distance, odometry.climbed)
        return run.model_copy(update={"by_hand": True}) if self.supervision.acting else run

    def break_off(self) -> TaskRun | None:
        """Ends the action under way, if there is one, as the run ends."""
        if self.action is None:
            return None
        self.action.cancel("the run was stopped", interrupted=False)
        return self.run_of(ActionStopped(self.action.task.name))

    def beginning(self, progress: Progress) -> InitialState:
        """Where a run begins that goes on from here, with such a progress."""
        drive, odometry = self._vehicle.setup.drive, self._vehicle.odometry
        before = self._beginning.known if self._beginning else ()
        found = (KnownAnomaly(anomaly=a, pose=pose) for a, pose in self.log.found)
        pose = drive.pose
        return InitialState(
            progress=progress,
            pose=(pose.x, pose.y, pose.z, pose.yaw, pose.pitch),
            charge=self._vehicle.supply.charge,
            distance=odometry.distance,
            climbed=odometry.climbed,
            known=(*before, *found),
        )

    def record(self, spec: RunSpec, present: Entry | None = None) -> RunRecord:
        """The record of the run as far as its log goes, or up to the `present` entry."""
        log = self.log if present is None else self.log.with_entry(present)
        return make_record(
            spec, self._vehicle.setup, self.machine, log, self._interruptions, self._rounds
        )

    def _begin(self, command: StartAction) -> None:
        self.action = self._vehicle.start(command, self.now, self._came)

    def _seen(self, event: Event) -> Event:
        return mark_abnormal(self.log.site, self._mission, event)

    def _look(self) -> None:
        for watch in (self._interruptions, self._rounds):
            watch.look(self.machine, self.now)

    @property
    def _running(self) -> str | None:
        return self.action.task.name if self.action else None
