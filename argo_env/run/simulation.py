"""Simulation: the loop between a machine and the robot that carries out its actions."""

import logging
import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager

import numpy as np

from argo_compiler.base.errors import Conflict, Invalid, NotFound
from argo_compiler.base.message import Listing, Message
from argo_compiler.base.model import Pose
from argo_compiler.hfsm import ByHand, Event, GiveBack, Occurred, Resume, Tick
from argo_compiler.hfsm.events import ReadingGiven
from argo_compiler.il import Mission, Task
from argo_env.closing import Closing
from argo_env.planning.opening import OpenedSite
from argo_env.planning.start import start_pose_or_area_dock
from argo_env.robot.pose import BodyPose, PoseArray
from argo_env.run import termination
from argo_env.run.initial_state import match_progress_to_edited_mission, progress_now
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
    check_event,
    check_scheduled_events,
    check_task_by_hand,
    mark_abnormal,
    require_give_back_can_occur,
    require_no_action,
    require_no_resume_while_acting,
    require_supervised,
    resolve_new_fault,
)
from argo_env.run.run_setup import RunSetup, check_spec, make_run_setup
from argo_env.run.run_state import SimulationState
from argo_env.run.spec import RunSpec, validate_spec
from argo_env.run.termination import reason_run_cannot_continue, standstill_reason
from argo_env.run.validation import (
    CheckedRun,
    require_initial_state,
    require_site,
    require_unstarted_machine,
)
from argo_env.run.vehicle import Vehicle
from argo_env.run.verdict import VerdictCode, VerdictPart

_log = logging.getLogger(__name__)

SAMPLE_PERIOD = 0.5  # s between points of the recorded path

LoggedEvents = Sequence[tuple[float, LoggedEvent]]
"""Events with their times in s."""


_MAX_BATCH = 5_000
"""maximum number of steps in a batch"""
_NO_POSES: PoseArray = np.empty((0, 5))


def never_interrupted() -> bool:
    """Return False: the default of `Simulation.run(interrupted)`, with which nobody interrupts."""
    return False


class Simulation(Closing):
    """Simulation of a run, which holds the machine, the robot with its world, and the log.

    `step` lets time pass, `handle` gives the run a command between two steps, and `record` returns
    the record so far at any time. All that happens is an entry, which goes to the observers, into
    the log, and then to the machine. So the entries of an earlier process restore the run's state.
    Close the simulation when it is no longer needed. One thread at a time may use it.
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
        is_checked = isinstance(spec, CheckedRun) and spec.site is site
        self._spec = spec = spec.spec if isinstance(spec, CheckedRun) else validate_spec(spec)
        self._observers = tuple(observers)
        self._observes_samples = any(
            observer.wants_samples and overrides(observer, name)
            for observer in observers
            for name in ("on_entry", "on_entry_applied")
        )
        self._added_events = tuple(events)
        self._begun = False
        self._closed = False
        self._changing = False
        self._broken = False
        self._ended = False
        self._record: RunRecord | None = None
        """record of the ended run, once it was requested"""
        if not is_checked:
            require_site(site, spec)
        require_unstarted_machine(machine, spec)
        if events or not is_checked:
            check_scheduled_events(
                [*(() if is_checked else spec.events), *events], spec.mission, site.site
            )
        if not is_checked and setup is None and robot is None:
            check_spec(spec, site.site)
        with ExitStack() as stack:
            self._vehicle: AnyRobot = robot or Vehicle(
                setup or make_run_setup(spec, site.navigator, gui, stack)
            )
            self._state = SimulationState(machine, self._vehicle, spec)
            time_step = self.setup.drive.time_step
            self._steps_per_sample = max(1, round(SAMPLE_PERIOD / time_step))
            for observer in self._observers:
                observer.on_begin(self.setup, spec)
            self._set_up(past)
            self._stack = stack.pop_all()

    @property
    def now(self) -> float:
        """Simulated time in s since the mission's start, also if this run continues another."""
        return self._state.now

    @property
    def ended(self) -> bool:
        """True if the run has ended."""
        return self._ended

    @property
    def spec(self) -> RunSpec:
        return self._spec

    @property
    def machine(self) -> Machine:
        return self._state.machine

    @property
    def setup(self) -> RunSetup:
        """Run setup: world, drive and the rest, with a navigator that knows the found blockages."""
        return self._vehicle.setup

    @property
    def pose(self) -> BodyPose:
        """Pose of the robot."""
        return self.setup.drive.pose

    @property
    def silent_since(self) -> float | None:
        """Time in s since when a remote robot sends nothing; None if the robot is connected."""
        return self._vehicle.silent_since

    @property
    def task(self) -> Task | None:
        """Task whose action is running, by hand or not; None if none is."""
        return self._state.action.task if self._state.action else None

    @property
    def taken_over(self) -> bool:
        """True if a person has taken the robot over, and not given it back."""
        return self._state.supervision.taken_over

    @property
    def by_hand(self) -> Task | None:
        """Task that the robot carries out by hand, for a person; None if there is none."""
        return self.task if self._state.supervision.acting else None

    @property
    def done_by_hand(self) -> tuple[ByHand, ...]:
        """Tasks of the mission done by hand since the take-over, with their ages now.

        It is what a `GiveBack` needs for the machine to count them.
        """
        return self._state.supervision.done_by_hand(self.now)

    def record(self) -> RunRecord:
        """Return the record of the run: complete if the run has ended, else up to now."""
        if self._ended:
            if self._record is None:
                self._record = self._state.record(self._spec)
            return self._record
        present = self._state.entry(sample=self._state.needs_path_sample)
        contacts = (*present.contacts, *present.touching)
        present = present.model_copy(update={"contacts": contacts})
        return self._state.record(self._spec, present)

    def step(self) -> None:
        """Let one time step of the drive pass: the robot moves, and the machine handles events.

        The run ends with its mission, with an empty battery, or after four simulated hours. Raises
        Conflict if the run has ended, the simulation is closed, or an earlier error has ended it.
        """
        self._require_not_ended()
        if not self._begun and self._ensure_begun():
            return
        with self._lock_out_commands():
            self._advance()
            for observer in self._observers:
                observer.on_step(self._state.now, self._state.action)
        self.end_if_finished()

    def fast_forward(self, until: float = math.inf) -> PoseArray:
        """Let time pass until something may happen: many time steps at once if possible, else one.

        Many are possible while the robot only drives, measures or stands and surely touches
        nothing; they end by `until`, and a single step may end after it. Records are the same as
        with `step`, and observers receive the same calls except `on_step`.

        Args:
            until: time in s.

        Returns:
            The robot's poses after each of the steps but the last, shape (n, 5); no row after a
            single step, or if the robot did not drive.

        Raises:
            Conflict: as for `step`.
        """
        self._require_not_ended()
        if not self._begun and self._ensure_begun():
            return _NO_POSES
        with self._lock_out_commands():
            passed = self._batch_steps(self._count_uneventful_steps(until))
            if passed is None:
                self._advance()
        self.end_if_finished()
        return _NO_POSES if passed is None else passed

    def handle(self, event: RunCommand) -> None:
        """Execute a command of a person or a program at the present time.

        Raises:
            Conflict: the run has ended, the robot is given back while an action still runs, the
                robot can't act by hand now, or a fault can't begin now.
            Invalid: the command makes no sense for this run.
            NotFound: the command names something that the site does not have.
        """
        self._require_not_ended()
        if self._ensure_begun():
            raise Conflict("the mission had ended before the command")
        match event:
            case StopRun(reason):
                if not isinstance(reason, str | None):
                    raise Invalid(
                        Message(
                            "{reason} is not a text: give the reason for the stop in words",
                            reason=repr(reason),
                        )
                    )
                by_person = VerdictPart(code=VerdictCode.STOPPED_BY_PERSON)
                self._end_run(
                    VerdictPart(code=VerdictCode.OTHER, text=reason) if reason else by_person
                )
            case InjectFault(fault):
                resolved = resolve_new_fault(fault, self.setup, self._spec.seed, self.now)
                self._commit(self._state.entry().model_copy(update={"faults": (resolved,)}))
                self._vehicle.update_faults(self.now)
            case DoByHand(task):
                check_task_by_hand(task, self._spec.mission, self.setup.navigator.site)
                require_supervised(self._state.supervision, self.machine.running or self.task)
                self._commit(self._state.entry().model_copy(update={"by_hand": task}))
            case StopByHand():
                if self.by_hand is None:
                    raise Conflict("the robot does nothing by hand that could be stopped")
                self._commit(self._state.entry().model_copy(update={"stop_by_hand": True}))
            case _:
                checked = check_event(event, self._spec.mission, self.setup.navigator.site)
                require_no_resume_while_acting(checked, self.by_hand)
                if isinstance(checked, GiveBack):
                    require_no_action(self.machine)
                self._commit(self._state.entry([checked]))
        self.end_if_finished()

    def continuation_spec(self, mission: Mission, by_hand: Sequence[ByHand] = ()) -> RunSpec:
        """Return the spec of a run that continues from here with an edited mission.

        In that run the robot has been given back. The diagnostics of the spec name what no longer
        fits the edited mission.

        Args:
            mission: the mission as a person has edited it while they had the robot.
            by_hand: the tasks that they did or skipped until now.

        Raises:
            Conflict: the mission is not paused, or an action runs.
            DiagnosticError: the edited mission can't continue from here.
            Invalid: a task in `by_hand` can't have been done.
        """
        site = self.setup.navigator.site
        require_no_resume_while_acting(GiveBack(), self.by_hand)
        check_event(GiveBack(tuple(by_hand)), self._spec.mission, site)
        marked = mark_abnormal(site, self._spec.mission, GiveBack(tuple(by_hand)))
        assert isinstance(marked, GiveBack)
        progress = progress_now(self.machine, self.now, marked.by_hand)
        progress, diagnostics = match_progress_to_edited_mission(progress, mission)
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
        """Append a task to the mission of an `OpenMachine`, which takes its tasks one by one.

        A journal does not hold such tasks, so a run with them can't be resumed. Raises Conflict if
        the run has ended, the machine is no `OpenMachine`, or an action runs; DiagnosticError if
        the mission has errors with the task.
        """
        self._require_not_ended()
        machine = self.machine
        if not isinstance(machine, OpenMachine):
            raise Conflict("no task can be appended: the mission of this run is fixed")
        commands = machine.append_task(task)
        self._spec = self._spec.model_copy(update={"mission": machine.mission})
        self._state.execute(commands)

    def run(self, interrupted: Callable[[], bool] = never_interrupted) -> RunRecord:
        """Continue to the end of the run and return its record.

        A robot that stands still and waits for an event that is not scheduled ends the run as well,
        because no command can arrive. If the function `interrupted` returns True between two steps,
        the record is that of the run so far.
        """
        if not self.ended:
            self._require_usable()
        step_by_step = interrupted is not never_interrupted or any(
            overrides(observer, "on_step") for observer in self._observers
        )
        advance = self.step if step_by_step else self.fast_forward
        while not self.ended and not interrupted() and not self._ensure_begun():
            if why := self._standstill_reason():
                self._end_run(why)
            else:
                advance()
        record = self.record()
        if not self.ended:
            _log.info("the run was interrupted at %g s", self.now)
            for observer in self._observers:
                observer.on_interrupted(record)
        return record

    def end_if_finished(self) -> None:
        """End the run if its machine has finished, its battery is empty or its time is over."""
        if self.ended:
            return
        if self._state.machine.finished:
            self._end_run(None)
        elif why := reason_run_cannot_continue(self._state.now, self._vehicle.supply):
            self._end_run(why)

    def close(self) -> None:
        """Release the run setup unless it is the caller's; the record stays available."""
        self._closed = True
        self._stack.close()

    def _set_up(self, past: Sequence[Entry]) -> None:
        """Set machine, log and robot to the state in which the run begins or continues.

        `past` are the entries of the run so far; empty for a run that begins.
        """
        state = self._state
        vehicle, beginning = self._vehicle, self._spec.beginning
        start = self._start_pose()
        if beginning:
            vehicle.apply_initial_state_except_pose(beginning)
        state.start()
        require_initial_state(state.machine, self._spec)
        for entry in past:
            state.replay_entry(entry)
        last = state.log.last
        vehicle.begin_at(last.body_pose if last else start, self.now)
        known = [(k.anomaly, BodyPose(*k.pose)) for k in (beginning.known if beginning else ())]
        known += [(anomaly, e.body_pose) for e in past for anomaly in e.found]
        if beginning or last:
            vehicle.restore_anomalies(known, self.now)
        if last is None:
            return
        vehicle.restore(last)
        state.restore_path_and_end_action_by_hand()
        if last.ended:
            self._announce_end()

    def _start_pose(self) -> BodyPose:
        navigator, mission = self.setup.navigator, self._spec.mission
        docks = navigator.site.docks
        for area in (mission.start_area, mission.end_area):
            if area is not None and area not in docks:
                known = Listing(map(str, sorted(docks)))
                raise NotFound(
                    Message(
                        "site {site} has no starting area {area}; there are: {known}",
                        site=navigator.site.name,
                        area=area,
                        known=known,
                    )
                )
        if beginning := self._spec.beginning:
            start = beginning.body_pose
            navigator.snap_keeping_heading(Pose(x=start.x, y=start.y, z=start.z, yaw=start.yaw))
            return start
        pose = navigator.snap_keeping_heading(
            self._spec.conditions.actual_start_pose(start_pose_or_area_dock(mission, docks))
        )
        return BodyPose(pose.x, pose.y, pose.z, pose.yaw)

    def _ensure_begun(self) -> bool:
        """Commit the entry with which this process begins or resumes the run, unless it has.

        Returns True if the run has ended.
        """
        if not self._begun:
            self._begun = True
            state = self._state
            events = []
            if self._spec.beginning and state.log.last is None:
                # Events between the two runs, such as that the robot was given back.
                events = state.scheduled.take_due(self.now, at_rest=state.machine.running is None)
            resumed = state.log.last is not None and not state.machine.finished
            first = {"resumed": resumed, "added": self._added_events}
            entry = state.entry(events, sample=state.needs_path_sample, task=state.lost_task_run)
            self._commit(entry.model_copy(update=first))
            self.end_if_finished()
        return self.ended

    def _advance(self) -> None:
        """Make one step of simulated time."""
        state = self._state
        state.set_steps(state.steps + 1)
        self._react(self._vehicle.advance(state.steps, state.now, state.action))

    def _count_uneventful_steps(self, until: float) -> int:
        """Return for how many time steps, up to `until` (s), no scheduled event or fault is due.

        The robot may notice something, or end its action, before that. With 0 or less, the next
        step has to be made alone.
        """
        state, machine, vehicle = self._state, self._state.machine, self._vehicle
        if not isinstance(vehicle, Vehicle) or not vehicle.can_batch_steps:
            return 0
        supervision, deadline = state.supervision, machine.next_deadline
        if supervision.taken_over or supervision.acting:
            return 0
        if (state.action is None) != (machine.running is None):
            return 0
        if machine.running is None and deadline is None and until == math.inf:
            return 0  # it waits for an event
        schedule = self.setup.schedule
        next_time = min(
            state.scheduled.next_time,
            schedule.next_change_time if schedule else math.inf,
            math.inf if deadline is None else deadline,
            termination.TIME_LIMIT,
            until,
        )
        if termination.is_emergency_stopped(self.setup):
            final = termination.time_standstill_becomes_final(self.setup, state.log)
            next_time = min(next_time, final if final > state.now else math.inf)
        steps = int((next_time - state.now) / self.setup.drive.time_step) - 1
        return min(steps, _MAX_BATCH)

    def _batch_steps(self, limit: int) -> PoseArray | None:
        """Make at most `limit` steps at once; the first in which something is noticed is the last.

        Returns the robot's poses after each of them but the last, no row if it stood still; None if
        no step was made.
        """
        state, vehicle = self._state, self._vehicle
        if limit < 1 or not isinstance(vehicle, Vehicle):
            return None
        batch, first = vehicle.batch_steps(state.action, limit), state.steps
        last, every = first + batch.steps, self._steps_per_sample
        updates = vehicle.steps_with_updates(batch, first + 1)
        samples = range(first + every - first % every, last + 1, every)
        for step in sorted({*updates, *samples, last} if batch.steps else ()):
            state.set_steps(step)
            if step in updates or step == last or self._observes_samples:
                batch.advance_to(step - first, state.now)
            sensed = vehicle.update_watches(step, state.now) if step in updates else None
            if sensed and sensed.found:
                self._react(sensed)
                return batch.poses_until(step - first - 1)
            if step in samples and self._observes_samples:
                self._commit(state.entry(sample=True))
            elif step in samples:  # no observer needs an entry
                state.log.add_sample(state.now, *batch.pose_and_charge(step - first))
        return batch.poses_until(batch.steps - 1) if batch.steps else None

    def _react(self, sensed: Sensed) -> None:
        """Commit entries of what a step has led to (`sensed`), and of the events that are due."""
        state, machine = self._state, self._state.machine
        now = state.now
        # Anomalies before the action's end: their reactions come first, and no next task starts.
        events: list[Event] = [Occurred(a.kind, a.detail) for a in sensed.found]
        acting, reading = state.supervision.acting, sensed.reading
        run = state.task_run(sensed.end) if sensed.end else None
        if sensed.end and not acting:
            events.append(sensed.end)
        elif reading:
            events.append(ReadingGiven(str(reading.checkpoint), reading.value))
        scheduled = state.scheduled
        at_rest = machine.running is None and not acting and not events
        events += scheduled.take_due(now, at_rest, acting)
        if not events and scheduled.is_give_back_waiting(now):
            require_give_back_can_occur(machine, now)
        is_sample = state.steps % self._steps_per_sample == 0
        if events or is_sample or run:
            entry = state.entry(events, sample=is_sample, task=run)
            if sensed.found or reading:
                results = {"found": sensed.found, "reading": reading}
                entry = entry.model_copy(update=results)
            self._commit(entry)
        deadline = machine.next_deadline
        if deadline is not None and deadline <= now and not machine.finished:
            self._commit(state.entry([Tick()]))

    def _commit(self, entry: Entry) -> None:
        """Send an entry of the current time to the observers, and apply it."""
        with self._lock_out_commands():
            for observer in self._observers:
                observer.on_entry(entry)
            self._vehicle.clear_mishaps_and_ended_contacts()
            self._state.apply_without_observers(entry)
            for observer in self._observers:
                observer.on_entry_applied(entry, self.machine)

    @contextmanager
    def _lock_out_commands(self) -> Iterator[None]:
        """Refuse commands within the `with` block, and for good after an error in it."""
        outer, self._changing = self._changing, True
        try:
            yield
        except BaseException:
            self._broken = True
            raise
        finally:
            self._changing = outer

    def _require_not_ended(self) -> None:
        if self.ended:
            raise Conflict(
                Message("the run has ended, at {now:g} s: make another simulation", now=self.now)
            )
        self._require_usable()

    def _require_usable(self) -> None:
        if self._closed:
            raise Conflict("the simulation is closed: make another one")
        if self._broken:
            raise Conflict(
                Message(
                    "an error has ended the simulation, at {now:g} s: make another one, or "
                    "resume the run if it has a journal",
                    now=self.now,
                )
            )
        if self._changing:
            raise Conflict("an observer can't command its run: give commands between two steps")

    def _standstill_reason(self) -> VerdictPart | None:
        vehicle = self._vehicle
        if vehicle.supply.charging or vehicle.expects_awaited_charge:
            return None
        if self._state.scheduled.pending:
            return None
        acting = self._state.supervision.acting
        return standstill_reason(self.now, self.machine, self.setup, self._state.log, acting)

    def _end_run(self, stopped: VerdictPart | None) -> None:
        state = self._state
        run = state.stop_action()
        self._vehicle.odometry.close_contacts()
        last = state.entry(sample=state.needs_path_sample, task=run)
        self._commit(last.model_copy(update={"ended": True, "stopped": stopped}))
        self._announce_end()

    def _announce_end(self) -> None:
        self._ended = True
        _log.info("the run has ended at %g s", self.now)
        for observer in self._observers:
            if overrides(observer, "on_end"):
                observer.on_end(self.record())
