"""The simulation: the one loop between a machine and what carries its actions out."""

from collections.abc import Sequence
from contextlib import ExitStack

from argo_compiler.errors import Conflict, Invalid, NotFound
from argo_compiler.hfsm import (
    ActionStopped,
    CancelAction,
    Command,
    Event,
    GiveBack,
    Occurred,
    StartAction,
    Tick,
)
from argo_compiler.il import Task
from argo_env.closing import Closing
from argo_env.navigation import Path
from argo_env.planning.opening import OpenedSite
from argo_env.planning.start import start_pose
from argo_env.robot.pose import BodyPose
from argo_env.run.action import ActionEnd, ActionUnderWay
from argo_env.run.ending import exhausted, standstill
from argo_env.run.interruptions import InterruptionWatch
from argo_env.run.log import Entry, LoggedEvent, RunLog
from argo_env.run.machine import Machine, OpenMachine
from argo_env.run.observer import Observer
from argo_env.run.perception import blockage
from argo_env.run.record import RunRecord, TaskRun
from argo_env.run.rig import Rig, fit_out
from argo_env.run.scheduled_events import GivenEvents
from argo_env.run.spec import RunSpec
from argo_env.run.steering import ReachIn, Steering, StopRun, check_by_hand, check_event, from_now
from argo_env.run.summary import make_record
from argo_env.run.vehicle import Vehicle, way_come
from argo_env.run.velocity import WayVelocity

SAMPLE_PERIOD = 0.5  # s between recorded places of the robot

LoggedEvents = Sequence[tuple[float, LoggedEvent]]
"""Events and their times (s)."""


class Simulation(Closing):
    """A run under way. Holds the machine, the world and all that has happened; close it.

    `step` lets time pass, `handle` tells the run something between two steps, and `record` says at
    any moment how it stands. All that happens goes through an entry: to the observers, into the
    log, then to the machine. So the entries of an earlier run lead to where it stood. One thread at
    a time may use it.
    """

    def __init__(
        self,
        machine: Machine,
        site: OpenedSite,
        spec: RunSpec,
        *,
        past: Sequence[Entry] = (),
        events: LoggedEvents = (),
        observers: Sequence[Observer] = (),
        rig: Rig | None = None,
        gui: bool = False,
    ) -> None:
        """The robot stands where the mission begins, or where the `past` entries of the same run
        have led it. Further `events` occur at their times (s), at once if these are over. A `rig`
        that is given stays its owner's; else one is fitted out.

        Raises ArgoError if no such run can be on the site, the robot can't stand where it starts,
        or the past is not this run's.
        """
        self._spec = spec
        self._machine = machine
        self._observers = tuple(observers)
        self._more = tuple(events)
        self._given = GivenEvents(spec.events)
        self._log = RunLog(site.site)
        self._interruptions = InterruptionWatch()
        self._velocity = WayVelocity(spec.mission)
        self._action: ActionUnderWay | None = None
        self._came: Path | None = None
        self._steps = 0
        self._opened = False
        self._record: RunRecord | None = None
        with ExitStack() as stack:
            self._vehicle = Vehicle(rig or fit_out(spec, site.navigator, gui, stack))
            for observer in self._observers:
                observer.on_begin(self.rig, spec)
            self._set_up(past)
            self._stack = stack.pop_all()

    @property
    def now(self) -> float:
        """s of simulated time; counted in steps, so that nothing adds up."""
        return round(self._steps * self.rig.drive.time_step, 6)

    @property
    def over(self) -> bool:
        """Whether the run has ended."""
        return self._record is not None

    @property
    def spec(self) -> RunSpec:
        return self._spec

    @property
    def machine(self) -> Machine:
        return self._machine

    @property
    def rig(self) -> Rig:
        """The world, the drive and the rest, with what the robot knows of the site by now."""
        return self._vehicle.rig

    @property
    def pose(self) -> BodyPose:
        """Where the robot is."""
        return self.rig.drive.pose

    @property
    def task(self) -> Task | None:
        """The task whose action is under way."""
        return self._action.task if self._action else None

    def record(self) -> RunRecord:
        """The record of the run: of the whole of it, or as it stands now."""
        if self._record is not None:
            return self._record
        present = self._entry(sample=self._unsampled)
        contacts = (*present.contacts, *present.touching)
        return self._record_of(
            self._log.with_entry(present.model_copy(update={"contacts": contacts}))
        )

    def step(self) -> None:
        """Lets one time step of the drive pass: the robot moves, and the machine hears what
        happened. The run ends with its mission, with the battery, or after four hours.

        Raises Conflict if it has ended.
        """
        self._require_going_on()
        if self._open():
            return
        self._advance()
        for observer in self._observers:
            observer.on_step(self.now, self._action)
        self.settle()

    def handle(self, event: Steering) -> None:
        """Tells the run something from outside, now.

        Raises Conflict if the run has ended, an action still runs of which it is told what was done
        by hand, or a fault can't begin now; Invalid, or NotFound, for what makes no sense.
        """
        self._require_going_on()
        if self._open():
            raise Conflict("the mission has ended before the run was told anything")
        match event:
            case StopRun(reason):
                self._end(reason)
            case ReachIn(fault):
                settled = from_now(fault, self.rig, self._spec.seed, self.now)
                self._tell(self._entry().model_copy(update={"faults": (settled,)}))
                self._vehicle.let_faults_happen(self.now)
            case GiveBack(by_hand):
                if by_hand:
                    check_by_hand(by_hand, self._machine, self._spec.mission)
                self._tell(self._entry([event]))
            case _:
                self._tell(self._entry([check_event(event)]))
        self.settle()

    def give(self, task: Task) -> None:
        """Gives the next task to a machine that takes them one by one, an `OpenMachine`.

        Raises Conflict if the run has ended, the machine is another, or an action runs.
        """
        self._require_going_on()
        if not isinstance(self._machine, OpenMachine):
            raise Conflict("the tasks of this run are those of its mission")
        commands = self._machine.give(task)
        self._spec = self._spec.model_copy(update={"mission": self._machine.mission})
        self._obey(commands)

    def run(self) -> RunRecord:
        """Goes on to the end of the run; returns its record. A robot that stands still and waits
        for what will not occur ends the run as well, as nobody can tell it anything meanwhile."""
        while not self.over and not self._open():
            if why := self._standstill():
                self._end(why)
            else:
                self.step()
        return self.record()

    def settle(self) -> None:
        """Ends the run if its machine has come to its end, or nothing can go on."""
        if self.over:
            return
        why = None if self._machine.finished else exhausted(self.now, self._vehicle.supply)
        if why or self._machine.finished:
            self._end(why)

    def close(self) -> None:
        """Gives back what the run was carried out with. The record can still be asked for."""
        self._stack.close()

    # -- how it begins

    def _set_up(self, past: Sequence[Entry]) -> None:
        """Puts everything to where the run begins, or goes on."""
        self._obey(self._machine.start(self.now))
        for entry in past:
            self._replay(entry)
        last = self._log.last
        self._vehicle.place(last.body_pose if last else self._start_pose(), self.now)
        if last is None:
            return
        self._vehicle.restore(last, past, self.now)
        if came := way_come(self._log):
            self._came = came
            if self._action:
                self._action.came = came
        if last.ended:
            self._conclude()

    def _start_pose(self) -> BodyPose:
        navigator, mission = self.rig.navigator, self._spec.mission
        docks = navigator.site.docks
        for area in (mission.start_area, mission.end_area):
            if area is not None and area not in docks:
                known = ", ".join(map(str, sorted(docks)))
                raise NotFound(
                    f"site {navigator.site.name} has no starting area {area}; there are: {known}"
                )
        pose = navigator.snap(start_pose(mission, docks))
        return BodyPose(pose.x, pose.y, pose.z, pose.yaw)

    def _replay(self, entry: Entry) -> None:
        """Does again what led to an entry, but for what the robot did."""
        self._steps = round(entry.t / self.rig.drive.time_step)
        self._vehicle.odometry.restore(entry)
        self._given.occurred = entry.given
        try:
            if entry.events and entry.running != self._running:
                raise ValueError(f"{entry.running} is said to run, and {self._running} does")
            self._take(entry)
        except ValueError as error:
            raise Invalid(
                f"the journal does not fit its mission at {entry.t:g} s: {error}; "
                "begin anew with `argo run`"
            ) from error

    def _open(self) -> bool:
        """Makes the first entry, if there is none yet of this process; whether the run is over."""
        if not self._opened:
            self._opened = True
            resumed = self._log.last is not None and not self._machine.finished
            first = {"resumed": resumed, "added": self._more}
            self._tell(self._entry(sample=self._unsampled).model_copy(update=first))
            self.settle()
        return self.over

    # -- how it goes on

    def _advance(self) -> None:
        """One step of simulated time."""
        self._steps += 1
        now, action = self.now, self._action
        sensed = self._vehicle.advance(self._steps, now, action)
        # Before the end, so that a reaction to it comes first and no next task is begun.
        events: list[Event] = [Occurred(a.kind, a.detail) for a in sensed.found]
        run = None
        if action and sensed.end:
            events.append(sensed.end)
            run = self._run_of(action, sensed.end)
        events += self._given.due(now)
        due = self._steps % max(1, round(SAMPLE_PERIOD / self.rig.drive.time_step)) == 0
        if events or due:
            entry = self._entry(events, sample=due, task=run)
            self._tell(entry.model_copy(update={"found": sensed.found, "reading": sensed.reading}))
        deadline = self._machine.next_deadline
        if not self._machine.finished and deadline is not None and deadline <= now:
            self._tell(self._entry([Tick()]))

    def _entry(
        self, events: Sequence[Event] = (), *, sample: bool = False, task: TaskRun | None = None
    ) -> Entry:
        """An entry of the present moment."""
        return Entry(
            t=self.now,
            given=self._given.occurred,
            running=self._running,
            events=tuple(LoggedEvent.of(event) for event in events),
            task=task,
            sample=sample,
            **self._vehicle.state(),
        )

    def _tell(self, entry: Entry) -> None:
        """Tells an entry of the present moment, and acts on it."""
        for observer in self._observers:
            observer.on_entry(entry)
        self._vehicle.told()
        self._take(entry)
        for observer in self._observers:
            observer.on_change(entry, self._machine)

    def _take(self, entry: Entry) -> None:
        """Adds an entry to the log and tells the machine its events."""
        self._log.add(entry)
        self._given.add(entry.added)
        if self.rig.schedule:
            for fault in entry.faults:
                self.rig.schedule.add(fault)
        if closed := [b for anomaly in entry.found if (b := blockage(anomaly))]:
            self._vehicle.avoid(closed)
        if entry.task:
            self._came = (self._action and self._action.path) or self._came
            self._action = None
            if entry.task.outcome == "done":
                self._velocity.arrived(entry.task.task)
        for event in entry.events:
            if not self._machine.finished:
                self._obey(self._machine.handle(event.original(), self.now))
                self._interruptions.look(self._machine, self.now)
        if closed and self._action:
            self._action.detour(self.rig)

    def _obey(self, commands: Sequence[Command]) -> None:
        odometry = self._vehicle.odometry
        for command in commands:
            match command:
                case StartAction(task):
                    self._action = ActionUnderWay(
                        task, self._velocity.to(task), self.rig,
                        self.now, odometry.distance, odometry.climbed, self._came,
                    )  # fmt: skip
                case CancelAction(_, reason):
                    if self._action:
                        goes_on = self._machine.paused or self._machine.reaction is not None
                        self._action.cancel(reason, interrupted=goes_on)

    def _run_of(self, action: ActionUnderWay, end: ActionEnd) -> TaskRun:
        odometry = self._vehicle.odometry
        return action.run(end, self.now, odometry.distance, odometry.climbed)

    @property
    def _running(self) -> str | None:
        return self._action.task.name if self._action else None

    @property
    def _unsampled(self) -> bool:
        return not self._log.path or self._log.path[-1].t < self.now

    # -- how it ends

    def _require_going_on(self) -> None:
        if self.over:
            raise Conflict(f"the run has ended, at {self.now:g} s: make another simulation")

    def _standstill(self) -> str | None:
        if self._given.pending or self._vehicle.supply.charging:
            return None
        return standstill(self.now, self._machine, self.rig, self._log)

    def _end(self, stopped: str | None) -> None:
        action, run = self._action, None
        if action:
            action.cancel("the run was stopped", interrupted=False)
            run = self._run_of(action, ActionStopped(action.task.name))
        self._vehicle.odometry.close()
        last = self._entry(sample=self._unsampled, task=run)
        self._tell(last.model_copy(update={"ended": True, "stopped": stopped}))
        self._conclude()

    def _conclude(self) -> None:
        self._record = self._record_of(self._log)
        for observer in self._observers:
            observer.on_end(self._record)

    def _record_of(self, log: RunLog) -> RunRecord:
        return make_record(self._spec, self.rig, self._machine, log, self._interruptions)
