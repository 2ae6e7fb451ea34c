"""The simulation: the one loop between a machine and what carries its actions out."""

import logging
import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager

import numpy as np

from argo_compiler.base.errors import Conflict, Invalid, NotFound
from argo_compiler.base.model import Pose
from argo_compiler.hfsm import ByHand, Event, GiveBack, Occurred, Resume, Tick
from argo_compiler.hfsm.events import ReadingGiven
from argo_compiler.il import Mission, Task
from argo_env.closing import Closing
from argo_env.planning.opening import OpenedSite
from argo_env.planning.start import start_pose
from argo_env.robot.pose import BodyPose, Places
from argo_env.run import termination
from argo_env.run.initial_state import match_progress, progress_now
from argo_env.run.log import Entry, LoggedEvent
from argo_env.run.machine import Machine, OpenMachine
from argo_env.run.observer import Observer, overrides
from argo_env.run.record import RunRecord
from argo_env.run.robot import AnyRobot, Sensed
from argo_env.run.run_commands import (
    DoByHand,
    InjectFault,
    RunCommand,
    StopByHand,
    StopRun,
    check_by_hand,
    check_event,
    check_scheduled_events,
    mark_abnormal,
    require_no_action,
    require_no_action_by_hand,
    require_supervised,
    require_taken_over,
    resolve_new_fault,
)
from argo_env.run.run_setup import RunSetup, check_spec, make_run_setup
from argo_env.run.run_state import RunState
from argo_env.run.spec import RunSpec, validate_spec
from argo_env.run.termination import exhaustion_reason, standstill_reason
from argo_env.run.validation import (
    CheckedRun,
    require_initial_state,
    require_machine,
    require_site,
)
from argo_env.run.vehicle import Vehicle

_log = logging.getLogger(__name__)

SAMPLE_PERIOD = 0.5  # s between recorded places of the robot

LoggedEvents = Sequence[tuple[float, LoggedEvent]]
"""Events and their times (s)."""


_LONGEST = 5_000
"""steps that are made at once at most"""
_NOWHERE: Places = np.empty((0, 5))


def never() -> bool:
    """A run is not interrupted."""
    return False


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
        spec: RunSpec | CheckedRun,
        *,
        past: Sequence[Entry] = (),
        events: LoggedEvents = (),
        observers: Sequence[Observer] = (),
        setup: RunSetup | None = None,
        robot: AnyRobot | None = None,
        gui: bool = False,
    ) -> None:
        """Set up the run on the site, with the robot where the mission begins.

        Args:
            machine: a machine of the spec's mission that has not been started.
            site: the site that the spec names.
            spec: the spec of the run. A `CheckedRun` on this site is not checked again.
            past: entries of an earlier part of the same run: the robot stands where they have led.
            events: further events at their times (s); those whose time has passed occur at once.
            observers: objects that are called with each entry.
            setup: a run setup of the caller, who closes it; None: the simulation makes its own.
            robot: a robot that carries out the actions instead of a simulated robot with a setup.
            gui: whether the world is shown in a window.

        Raises:
            ArgoError: no such run can be on the site, the robot can't stand where it starts, or the
                past is not this run's. Conflict for a site or a machine that is not the spec's, or
                a machine that was used before.
        """
        known = isinstance(spec, CheckedRun) and spec.site is site
        self._spec = spec = spec.spec if isinstance(spec, CheckedRun) else validate_spec(spec)
        self._observers = tuple(observers)
        self._hearing = any(
            observer.wants_samples and overrides(observer, name)
            for observer in observers
            for name in ("on_entry", "on_change")
        )
        self._more = tuple(events)
        self._opened = False
        self._closed = False
        self._changing = False
        self._broken = False
        self._ended = False
        self._record: RunRecord | None = None
        """that of the ended run, once it was asked for"""
        if not known:
            require_site(site, spec)
        require_machine(machine, spec)
        if events or not known:
            check_scheduled_events(
                [*(() if known else spec.events), *events], spec.mission, site.site
            )
        if not known and setup is None and robot is None:
            check_spec(spec, site.site)
        with ExitStack() as stack:
            self._vehicle: AnyRobot = robot or Vehicle(
                setup or make_run_setup(spec, site.navigator, gui, stack)
            )
            self._state = RunState(machine, self._vehicle, spec)
            time_step = self.setup.drive.time_step
            self._sampled_every = max(1, round(SAMPLE_PERIOD / time_step))
            for observer in self._observers:
                observer.on_begin(self.setup, spec)
            self._set_up(past)
            self._stack = stack.pop_all()

    @property
    def now(self) -> float:
        """s of simulated time."""
        return self._state.now

    @property
    def ended(self) -> bool:
        """Whether the run has ended."""
        return self._ended

    @property
    def spec(self) -> RunSpec:
        return self._spec

    @property
    def machine(self) -> Machine:
        return self._state.machine

    @property
    def setup(self) -> RunSetup:
        """The world, the drive and the rest, with what the robot knows of the site by now."""
        return self._vehicle.setup

    @property
    def pose(self) -> BodyPose:
        """Where the robot is."""
        return self.setup.drive.pose

    @property
    def silent_since(self) -> float | None:
        """s, since when nothing was heard of a robot that is somewhere else; None: it is heard."""
        return self._vehicle.silent_since

    @property
    def task(self) -> Task | None:
        """The task whose action is under way, by hand or not."""
        return self._state.action.task if self._state.action else None

    @property
    def taken_over(self) -> bool:
        """Whether a person has taken the robot over, and not given it back."""
        return self._state.supervision.taken_over

    @property
    def by_hand(self) -> Task | None:
        """The task that a person lets the robot carry out."""
        return self.task if self._state.supervision.acting else None

    @property
    def done_by_hand(self) -> tuple[ByHand, ...]:
        """The mission's tasks that a person let the robot do since they took it over, and how long
        ago: what `GiveBack` tells the machine if it is given this, now."""
        return self._state.supervision.results_at(self.now)

    def record(self) -> RunRecord:
        """The record of the run: of the whole of it, or as it stands now."""
        if self._ended:
            if self._record is None:
                self._record = self._state.record(self._spec)
            return self._record
        present = self._state.entry(sample=self._state.is_unsampled)
        contacts = (*present.contacts, *present.touching)
        present = present.model_copy(update={"contacts": contacts})
        return self._state.record(self._spec, present)

    def step(self) -> None:
        """Lets one time step of the drive pass: the robot moves, and the machine hears what
        happened. The run ends with its mission, with the battery, or after four hours.

        Raises Conflict if it has ended, is closed, or was broken off by an error before.
        """
        self._require_going_on()
        if not self._opened and self._open():
            return
        with self._change():
            self._advance()
            for observer in self._observers:
                observer.on_step(self._state.now, self._state.action)
        self.end_if_finished()

    def fast_forward(self, until: float = math.inf) -> Places:
        """Lets time pass up to the next moment at which something may happen, and not beyond
        `until` (s): many time steps where the robot only drives, measures or stands and surely
        touches nothing, else one. Observers are told all but the single steps; records are the
        same as by `step`. Returns where the robot was after each of the steps but the last.

        Raises Conflict as `step` does.
        """
        self._require_going_on()
        if not self._opened and self._open():
            return _NOWHERE
        with self._change():
            passed = self._glide(self._quiet_steps(until))
            if passed is None:
                self._advance()
        self.end_if_finished()
        return _NOWHERE if passed is None else passed

    def handle(self, event: RunCommand) -> None:
        """Tells the run something from outside, now.

        Raises Conflict if the run has ended, the robot is given back while an action still runs,
        it can do nothing by hand now, or a fault can't begin now; Invalid, or NotFound, for what
        makes no sense.
        """
        self._require_going_on()
        if self._open():
            raise Conflict("the mission has ended before the run was told anything")
        match event:
            case StopRun(reason):
                if not isinstance(reason, str):
                    raise Invalid(f"{reason!r} is no reason: give one in words")
                self._end(reason)
            case InjectFault(fault):
                settled = resolve_new_fault(fault, self.setup, self._spec.seed, self.now)
                self._tell(self._state.entry().model_copy(update={"faults": (settled,)}))
                self._vehicle.update_faults(self.now)
            case DoByHand(task):
                check_by_hand(task, self._spec.mission, self.setup.navigator.site)
                require_supervised(self._state.supervision, self.machine.running or self.task)
                self._tell(self._state.entry().model_copy(update={"by_hand": task}))
            case StopByHand():
                if self.by_hand is None:
                    raise Conflict("the robot does nothing by hand that could be stopped")
                self._tell(self._state.entry().model_copy(update={"stop_by_hand": True}))
            case _:
                checked = check_event(event, self._spec.mission, self.setup.navigator.site)
                require_no_action_by_hand(checked, self.by_hand)
                if isinstance(checked, GiveBack):
                    require_no_action(self.machine)
                self._tell(self._state.entry([checked]))
        self.end_if_finished()

    def continuation_spec(self, mission: Mission, by_hand: Sequence[ByHand] = ()) -> RunSpec:
        """The spec of a run that goes on from here with the mission as a person has edited it while
        they had the robot, and with what they did or skipped `by_hand` until now. In it the robot
        is given back. What does not fit any more is among its diagnostics.

        Raises Conflict unless the mission is paused and no action runs, DiagnosticError if the
        edited mission can't go on from here, Invalid for what nobody can have done.
        """
        site = self.setup.navigator.site
        require_no_action_by_hand(GiveBack(), self.by_hand)
        check_event(GiveBack(tuple(by_hand)), self._spec.mission, site)
        seen = mark_abnormal(site, self._spec.mission, GiveBack(tuple(by_hand)))
        assert isinstance(seen, GiveBack)
        progress = progress_now(self.machine, self.now, seen.by_hand)
        progress, diagnostics = match_progress(progress, mission)
        spec = self._spec.model_copy(
            update={
                "mission": mission,
                "beginning": self._state.initial_state(progress),
                "events": (
                    (self.now, LoggedEvent.from_event(Resume())),
                    *self._state.scheduled.upcoming,
                ),
                "faults": self.setup.schedule.faults if self.setup.schedule else (),
                "diagnostics": (*self._spec.diagnostics, *diagnostics),
                "reordering": None,
                "source": None,
            }
        )
        return validate_spec(spec)

    def append_task(self, task: Task) -> None:
        """Gives the next task to a machine that takes them one by one, an `OpenMachine`. A journal
        does not hold such tasks, and can't be gone on from.

        Raises Conflict if the run has ended, the machine is another, or an action runs.
        """
        self._require_going_on()
        machine = self.machine
        if not isinstance(machine, OpenMachine):
            raise Conflict("the tasks of this run are those of its mission")
        commands = machine.append_task(task)
        self._spec = self._spec.model_copy(update={"mission": machine.mission})
        self._state.execute(commands)

    def run(self, interrupted: Callable[[], bool] = never) -> RunRecord:
        """Goes on to the end of the run; returns its record. A robot that stands still and waits
        for what will not occur ends the run as well, as nobody can tell it anything meanwhile.

        Where `interrupted` says so between two steps, the record is that of the run as it stands.
        """
        if not self.ended:
            self._require_usable()
        step_by_step = interrupted is not never or any(
            overrides(observer, "on_step") for observer in self._observers
        )
        go_on = self.step if step_by_step else self.fast_forward
        while not self.ended and not interrupted() and not self._open():
            if why := self._standstill():
                self._end(why)
            else:
                go_on()
        record = self.record()
        if not self.ended:
            _log.info("the run was interrupted at %g s", self.now)
            for observer in self._observers:
                observer.on_interrupted(record)
        return record

    def end_if_finished(self) -> None:
        """Ends the run if its machine has come to its end, or nothing can go on."""
        if self.ended:
            return
        if self._state.machine.finished:
            self._end(None)
        elif why := exhaustion_reason(self._state.now, self._vehicle.supply):
            self._end(why)

    def close(self) -> None:
        """Gives back what the run was carried out with. The record can still be asked for."""
        self._closed = True
        self._stack.close()

    def _set_up(self, past: Sequence[Entry]) -> None:
        """Puts everything to where the run begins, or goes on."""
        state = self._state
        vehicle, beginning = self._vehicle, self._spec.beginning
        start = self._start_pose()
        if beginning:
            vehicle.apply_initial_state(beginning)
        state.start()
        require_initial_state(state.machine, self._spec)
        for entry in past:
            state.replay(entry)
        last = state.log.last
        vehicle.place(last.body_pose if last else start, self.now)
        told = [(k.anomaly, BodyPose(*k.pose)) for k in (beginning.known if beginning else ())]
        told += [(anomaly, e.body_pose) for e in past for anomaly in e.found]
        if beginning or last:
            vehicle.restore_anomalies(told, self.now)
        if last is None:
            return
        vehicle.restore(last)
        state.finish_replay()
        if last.ended:
            self._conclude()

    def _start_pose(self) -> BodyPose:
        navigator, mission = self.setup.navigator, self._spec.mission
        docks = navigator.site.docks
        for area in (mission.start_area, mission.end_area):
            if area is not None and area not in docks:
                known = ", ".join(map(str, sorted(docks)))
                raise NotFound(
                    f"site {navigator.site.name} has no starting area {area}; there are: {known}"
                )
        if beginning := self._spec.beginning:
            place = beginning.body_pose
            navigator.snap(Pose(x=place.x, y=place.y, z=place.z, yaw=place.yaw))
            return place
        pose = navigator.snap(self._spec.conditions.actual_start_pose(start_pose(mission, docks)))
        return BodyPose(pose.x, pose.y, pose.z, pose.yaw)

    def _open(self) -> bool:
        """Makes the first entry, if there is none yet of this process; whether the run is over."""
        if not self._opened:
            self._opened = True
            state = self._state
            events = []
            if self._spec.beginning and state.log.last is None:
                # What was told while nothing ran, as that the robot was given back.
                events = state.scheduled.take_due(self.now, at_rest=state.machine.running is None)
            resumed = state.log.last is not None and not state.machine.finished
            first = {"resumed": resumed, "added": self._more}
            entry = state.entry(events, sample=state.is_unsampled, task=state.lost_task_run)
            self._tell(entry.model_copy(update=first))
            self.end_if_finished()
        return self.ended

    def _advance(self) -> None:
        """One step of simulated time."""
        state = self._state
        state.set_steps(state.steps + 1)
        self._react(self._vehicle.advance(state.steps, state.now, state.action))

    def _quiet_steps(self, until: float) -> int:
        """In how many time steps, up to `until` (s), nothing is told, begins or ends; what the
        robot notices by itself, and the end of its action, may come before."""
        state, machine, vehicle = self._state, self._state.machine, self._vehicle
        if not isinstance(vehicle, Vehicle) or not vehicle.glides:
            return 0
        supervision, deadline = state.supervision, machine.next_deadline
        if supervision.taken_over or supervision.acting:
            return 0
        if (state.action is None) != (machine.running is None):
            return 0
        if machine.running is None and deadline is None and until == math.inf:
            return 0  # it waits for what is told
        schedule = self.setup.schedule
        next_time = min(
            state.scheduled.next_time,
            schedule.next_change if schedule else math.inf,
            math.inf if deadline is None else deadline,
            termination.TIME_LIMIT,
            until,
        )
        if termination.is_emergency_stopped(self.setup):
            settled = termination.final_standstill_time(self.setup, state.log)
            next_time = min(next_time, settled if settled > state.now else math.inf)
        steps = int((next_time - state.now) / self.setup.drive.time_step) - 1
        return min(steps, _LONGEST)

    def _glide(self, most: int) -> Places | None:
        """Makes at most so many steps at once, up to where the robot notices something. Where it
        was after each of them but the last; None if there are none."""
        state, vehicle = self._state, self._vehicle
        if most < 1 or not isinstance(vehicle, Vehicle):
            return None
        glide, first = vehicle.glide(state.action, most), state.steps
        last, every = first + glide.steps, self._sampled_every
        looks = vehicle.update_steps(glide, first + 1)
        samples = range(first + every - first % every, last + 1, every)
        for step in sorted({*looks, *samples, last} if glide.steps else ()):
            state.set_steps(step)
            if step in looks or step == last or self._hearing:
                glide.go_to(step - first, state.now)
            sensed = vehicle.look(step, state.now) if step in looks else None
            if sensed and sensed.found:
                self._react(sensed)
                return glide.places(step - first - 1)
            if step in samples and self._hearing:
                self._tell(state.entry(sample=True))
            elif step in samples:  # nobody is to hear of it
                state.log.sample(state.now, *glide.sample(step - first))
        return glide.places(glide.steps - 1) if glide.steps else None

    def _react(self, sensed: Sensed) -> None:
        """The machine hears what has happened by now."""
        state, machine = self._state, self._state.machine
        now = state.now
        # Before the end, so that a reaction to it comes first and no next task is begun.
        events: list[Event] = [Occurred(a.kind, a.detail) for a in sensed.found]
        acting, reading = state.supervision.acting, sensed.reading
        run = state.task_run(sensed.end) if sensed.end else None
        if sensed.end and not acting:
            events.append(sensed.end)
        elif reading:
            events.append(ReadingGiven(str(reading.checkpoint), reading.value))
        given = state.scheduled
        at_rest = machine.running is None and not acting and not events
        events += given.take_due(now, at_rest, acting)
        if not events and given.is_give_back_waiting(now):
            require_taken_over(machine, now)
        due = state.steps % self._sampled_every == 0
        if events or due or run:
            entry = state.entry(events, sample=due, task=run)
            if sensed.found or reading:
                came = {"found": sensed.found, "reading": reading}
                entry = entry.model_copy(update=came)
            self._tell(entry)
        deadline = machine.next_deadline
        if deadline is not None and deadline <= now and not machine.finished:
            self._tell(state.entry([Tick()]))

    def _tell(self, entry: Entry) -> None:
        """Tells an entry of the present moment, and acts on it."""
        with self._change():
            for observer in self._observers:
                observer.on_entry(entry)
            self._vehicle.clear_reported()
            self._state.apply(entry)
            for observer in self._observers:
                observer.on_change(entry, self.machine)

    @contextmanager
    def _change(self) -> Iterator[None]:
        """While the run changes nobody can tell it anything; once that has failed, never again."""
        outer, self._changing = self._changing, True
        try:
            yield
        except BaseException:
            self._broken = True
            raise
        finally:
            self._changing = outer

    def _require_going_on(self) -> None:
        if self.ended:
            raise Conflict(f"the run has ended, at {self.now:g} s: make another simulation")
        self._require_usable()

    def _require_usable(self) -> None:
        if self._closed:
            raise Conflict("the simulation is closed: make another one")
        if self._broken:
            raise Conflict(
                f"the simulation broke off by an error, at {self.now:g} s: make another one, or "
                "resume the run if it has a journal"
            )
        if self._changing:
            raise Conflict("an observer can't steer the run that it is told of: between two steps")

    def _standstill(self) -> str | None:
        if self._state.scheduled.pending or self._vehicle.supply.charging:
            return None
        acting = self._state.supervision.acting
        return standstill_reason(self.now, self.machine, self.setup, self._state.log, acting)

    def _end(self, stopped: str | None) -> None:
        state = self._state
        run = state.stop_action()
        self._vehicle.odometry.close_contacts()
        last = state.entry(sample=state.is_unsampled, task=run)
        self._tell(last.model_copy(update={"ended": True, "stopped": stopped}))
        self._conclude()

    def _conclude(self) -> None:
        self._ended = True
        _log.info("the run has ended at %g s", self.now)
        for observer in self._observers:
            if overrides(observer, "on_end"):
                observer.on_end(self.record())
