"""Executor of a state machine, driven by events and a virtual clock."""

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from argo_compiler.base.message import Message
from argo_compiler.hfsm.charging import AwaitedCharge
from argo_compiler.hfsm.conditions import CheckpointReading, Measured
from argo_compiler.hfsm.control import Control
from argo_compiler.hfsm.events import (
    ActionEnded,
    ActionFailed,
    ActionStopped,
    ActionSucceeded,
    Cancel,
    CancelAction,
    Command,
    Event,
    GiveBack,
    Occurred,
    Pause,
    ReadingGiven,
    Resume,
    StartAction,
    TakeOver,
    Tick,
)
from argo_compiler.hfsm.kinds import Cause, Outcome
from argo_compiler.hfsm.model import DONE, MISSION, Hfsm
from argo_compiler.hfsm.progress import ByHand, Progress
from argo_compiler.hfsm.remaining import remaining_tasks
from argo_compiler.hfsm.restoring import (
    group_progress,
    reaction_progress,
    reading_progress,
    restore_configuration,
    restore_interrupt_state,
    tally_progress,
)
from argo_compiler.hfsm.tables import LeafNode, build_tables
from argo_compiler.hfsm.trace import TraceEntry, new_tuple, raw_entry, trace_entry
from argo_compiler.hfsm.views import View
from argo_compiler.il import MAX_TIME_S, EventKind, Task
from argo_compiler.il.events import event_text

_ENDS = (ActionSucceeded, ActionFailed, ActionStopped)
_OTHER_ENDS = (ActionFailed, ActionStopped)
_EVENTS = frozenset(
    [*_ENDS, Tick, Occurred, ReadingGiven, Pause, Resume, TakeOver, GiveBack, Cancel]
)


@dataclass(frozen=True, slots=True)
class EndedVisit:
    """Visit of a task that has ended, and why it failed for good if it did."""

    task: str
    failure: str | None = None
    by_hand: bool = False


class Executor:
    """State machine under way: the only object of this package that holds state.

    It owns no thread and no clock. Its driver calls `start` once, executes the command that is
    returned, if any, and calls `handle` when an action has ended, when something else has happened,
    and when `next_deadline` is reached. Times are seconds and never run backwards.

    At most one action runs. After a `CancelAction` the driver reports exactly one end of that
    action, when its clean-up is done, and then gets the next `StartAction`. The machine decides at
    once which task comes next; only the start of its action waits.

    At equal times: time-outs that lie strictly before `now` come first, then the event, then the
    time-outs at `now`. A time-out is dated when the time was up, not when the executor was called,
    so a driver that calls late gets the same result.

    Invalid calls raise ValueError and change nothing: something that is not an event, a call before
    `start`, an earlier time than that of the previous call, the end of an action that does not run
    or whose id is not that of its command, a value that is not a finite number, and tasks done by
    hand while an action still runs.

    The executor is not thread-safe, and no call waits for a lock. A call of `start`, `handle` or
    `progress` during another one, from any thread, raises ValueError too, and properties read
    during a call may show a step half done. A driver with several threads puts events into a queue,
    from which one thread passes them on.
    """

    def __init__(self, hfsm: Hfsm) -> None:
        self.hfsm = hfsm
        self._control = Control(build_tables(hfsm))
        self._started = False
        self._fresh = True
        """whether `start` starts the mission, rather than continuing a restored one"""
        self._running: Task | None = None
        self._running_leaf: LeafNode | None = None
        """its leaf; None if it is the drive of a reaction"""
        self._running_visit = 0
        """number of the visit in which the action was started"""
        self._running_turn = 0
        """turn of the running action; if the present turn differs, the action has to be
        cancelled"""
        self._last_id = 0
        """id of the last command that started an action"""
        self._cancelling = False
        # Each call pops the token and appends it again. `pop` is atomic for other threads, and
        # unlike a lock a list can be copied.
        self._call_token = [None]

    @classmethod
    def restore(cls, hfsm: Hfsm, progress: Progress, now: float, away: float = 0.0) -> "Executor":
        """Return an executor that continues from `progress` at time `now`; call `start` next.

        `away` is the time (s) since the progress was taken. It counts for the mission's duration,
        for waits and holds, for groups that count interruptions, and for the ages of readings. It
        also counts for the ages of tasks done by hand that the progress already had. For a progress
        that `hand_over` returned, `away` is only the time since then.

        Raises:
            ArgoError: the progress does not belong to this machine.
        """
        executor = cls(hfsm)
        control = executor._control
        mission = control.mission
        mission.now = _seconds(now)
        mission.configuration = restore_configuration(control.tables, progress, now, _seconds(away))
        control.interrupt_state = restore_interrupt_state(control.tables, progress)
        control.drive_turn = mission.configuration.new_visit_or_turn_number()
        if progress.reaction is not None:
            control.held_since = now - progress.reaction.held - away
        for done in progress.by_hand:
            mission.queue_tasks_done_by_hand((done,), now if done.age is None else now - away)
        for tally in progress.tallies:
            mission.tallies[tally.task] = [tally.done, tally.failed, tally.by_hand]
        mission.failed = progress.failed
        mission.time_up = progress.time_up
        mission.outcome = progress.outcome
        executor._last_id = progress.actions
        executor._fresh = False
        return executor

    def start(self, now: float) -> tuple[Command, ...]:
        """Start the mission, or continue a restored one, at time `now` (s).

        Returns the first command, if any.
        """
        with self._exclusive():
            if self._started:
                raise ValueError("the executor has been started already")
            self._require_time_order(now)
            self._started = True
            control = self._control
            mission = control.mission
            mission.now = now
            if self._fresh:
                mission.configuration.started_at = now
                mission.configuration.enter_first_task_or_end(control.tables.initial, now)
            mission.add_entry(
                Cause.START if self._fresh else Cause.RESTORE,
                source=None,
                rounds=mission.configuration.rounds_from(0, now),
            )
            if control.outcome is None:
                limit = control.tables.max_duration
                if limit is not None and not mission.time_up:
                    mission.time_up_at = max(mission.configuration.started_at + limit, now)
                supervised = self.hfsm.supervised and mission.active_task is not None
                control.start(self._fresh and supervised)
            return self._next_command()

    def handle(self, event: Event, now: float) -> tuple[Command, ...]:
        """Handle an event at time `now` (s), and return the next command, if any."""
        try:
            token = self._call_token.pop()
        except IndexError:
            raise ValueError(_BUSY) from None
        try:
            control = self._control
            mission = control.mission
            if not mission.now <= now <= MAX_TIME_S:
                self._require_time_order(now)
            # Most events are an ActionSucceeded: it is checked first.
            if type(event) is ActionSucceeded and self._started:
                self._require_end(event)
            else:
                self._require_event(event)
            configuration = mission.configuration
            if (
                now > configuration.group_due
                or now > configuration.visit_due
                or now > mission.time_up_at
                or now > control.hold_due
            ):
                # The next float below `now` represents all times before it.
                control.process_changes_until(math.nextafter(now, -math.inf))
            mission.now = now
            if type(event) is ActionSucceeded:
                self._succeed(event)
            elif isinstance(event, _OTHER_ENDS):
                self._end_action(event)
            elif type(event) is not Tick:
                self._handle_other(event, now)
            control.process_due_changes()
            return self._next_command()
        finally:
            self._call_token.append(token)

    def _handle_other(self, event: Event, now: float) -> None:
        """Handle a given reading, an event that the mission may react to, or a person's command."""
        control = self._control
        if isinstance(event, ReadingGiven):
            mission = control.mission
            mission.set_reading(event.object_id, event.value, event.abnormal, now)
            mission.add_entry(Cause.READING, detail=f"#{event.object_id} = {event.value:g}")
        elif control.outcome is None:
            match event:
                case Occurred(kind, detail):
                    control.handle_event(kind, detail)
                case Pause():
                    control.pause()
                case TakeOver():
                    control.pause(detail="a person takes over")
                case Resume():
                    control.resume()
                case GiveBack(by_hand):
                    control.give_back(by_hand)
                case Cancel():
                    control.cancel()

    def progress(self) -> Progress:
        """Return the mission's progress at the time of the last `start` or `handle`.

        `restore` continues from it. An action that still runs is not part of it: pause first and
        wait for the end of the action.
        """
        with self._exclusive():
            if not self._started:
                raise ValueError(_NOT_STARTED)
            return self._progress()

    def _progress(self) -> Progress:
        control = self._control
        mission, configuration = control.mission, control.mission.configuration
        now, visit = mission.now, configuration.visit
        reaction, waiting = reaction_progress(control.interrupt_state, now - control.held_since)
        return Progress(
            active=mission.active_task,
            attempt=visit.attempt,
            since=0.0 if visit.leaf is None else now - visit.since,
            occurred=visit.occurred,
            round_of=None
            if configuration.awaited_round is None
            else configuration.awaited_round.group.name,
            groups=group_progress(configuration, now),
            readings=reading_progress(configuration, now),
            tallies=tally_progress(mission.tallies),
            failed=mission.failed,
            actions=self._last_id,
            elapsed=now - configuration.started_at,
            time_up=mission.time_up,
            paused=control.paused,
            reaction=reaction,
            waiting=waiting,
            outcome=control.outcome,
            by_hand=mission.pending_tasks_done_by_hand(),
        )

    @property
    def finished(self) -> bool:
        """True if the mission has ended and no action runs any more."""
        return self._started and self._control.outcome is not None and self._running is None

    @property
    def outcome(self) -> Outcome | None:
        """Outcome of the mission; None if the mission has not ended."""
        return self._control.outcome

    @property
    def remaining_tasks(self) -> tuple[str, ...] | None:
        """Names of the tasks that can still follow if none fails, with the active one.

        Any conditions may hold. If the mission was given up, they are the tasks that could follow
        in that moment. None: a restored mission was given up before, and it is not known where.
        """
        mission = self._control.mission
        left_at = mission.left_at or Progress(
            active=mission.active_task, groups=group_progress(mission.configuration, mission.now)
        )
        return remaining_tasks(self.hfsm, left_at)

    @property
    def active_task(self) -> str | None:
        """Name of the active task; None before the mission's start and at its end."""
        return self._control.mission.active_task

    @property
    def running(self) -> Task | None:
        """The task whose action has been started and has not ended; None if no action runs."""
        return self._running

    @property
    def paused(self) -> bool:
        """True if the mission is paused until a person resumes it; see `holding` for reactions."""
        return self._control.paused

    @property
    def reaction(self) -> EventKind | None:
        """The event whose reaction is active; None if no reaction is active."""
        return self._control.interrupt_state.active

    @property
    def holding(self) -> bool:
        """True if the active reaction holds: the robot stands still and waits."""
        return self._control.reaction_is_holding

    @property
    def awaited_charges(self) -> tuple[AwaitedCharge, ...]:
        """Charges of the battery for which the mission waits, with BATTERY_CHARGED (R12).

        The robot raises the event when it has all of them. Empty if the mission waits for none.
        """
        return self._control.awaited_charges if self._started else ()

    @property
    def configuration(self) -> tuple[str, ...]:
        """Ids of the active states: the mission, groups from the outermost, the leaf, the reaction.

        Empty before the start.
        """
        if not self._started:
            return ()
        configuration, active = self._control.mission.configuration, self._control.active_reaction
        groups = (frame.group.id for frame in configuration.frames)
        reaction = () if active is None else (active.state.id,)
        return (
            MISSION,
            *groups,
            DONE if configuration.leaf is None else configuration.leaf.id,
            *reaction,
        )

    @property
    def next_deadline(self) -> float | None:
        """Earliest time (s) of a change without an event, such as a time-out; None without one."""
        due = self._control.next_due
        return due if self._started and due < math.inf else None

    @property
    def readings(self) -> Mapping[str, CheckpointReading]:
        """Last reading of each checkpoint by object_id, even if unreadable or given by a person."""
        return dict(self._control.mission.configuration.readings)

    @property
    def values(self) -> Mapping[str, Measured]:
        """Value and time of each checkpoint's last reading by object_id, if that has a value."""
        return {
            id: Measured(reading.value, reading.time)
            for id, reading in self._control.mission.configuration.readings.items()
            if reading.value is not None
        }

    @property
    def rounds(self) -> Mapping[str, int]:
        """Current round, from 1, of each active group, by the group's name."""
        return {
            frame.group.name: frame.round for frame in self._control.mission.configuration.frames
        }

    @property
    def trace(self) -> Sequence[TraceEntry]:
        """Trace since `start`, in the order of time; each entry is created on access."""
        return View(self._control.mission.trace, trace_entry)

    @property
    def ended(self) -> Sequence[EndedVisit]:
        """Visits that have ended since `start`, in order. A cancelled action ends no visit."""
        return View(self._control.mission.ended, _ended_visit)

    @contextmanager
    def _exclusive(self) -> Iterator[None]:
        """Refuse other calls during the `with` block; raise ValueError if one is under way."""
        try:
            token = self._call_token.pop()
        except IndexError:
            raise ValueError(_BUSY) from None
        try:
            yield
        finally:
            self._call_token.append(token)

    def _next_command(self) -> tuple[Command, ...]:
        """Return the command that starts or cancels an action, if one is needed.

        An action is started only when the previous one has ended.
        """
        # The task that is to run, or None, and its turn. Each event calls this, so it is kept fast.
        control = self._control
        mission, interrupt_state = control.mission, control.interrupt_state
        visit = mission.configuration.visit
        leaf, task, turn = visit.leaf, None, 0
        if mission.outcome is not None or interrupt_state.paused:
            pass
        elif interrupt_state.active is not None:
            active = control.active_reaction
            if control.reaction_is_driving and active is not None:
                leaf, task, turn = None, active.task, control.drive_turn
        elif leaf is not None and leaf.wait is None and mission.configuration.awaited_round is None:
            task, turn = leaf.task, visit.turn
        running = self._running
        if running is not None:
            if self._cancelling or turn == self._running_turn:
                return ()
            self._cancelling = True
            return (CancelAction(running.name, self._cancel_reason(), self._last_id),)
        if task is None:
            return ()
        self._running = task
        self._running_leaf = leaf
        self._running_turn = turn
        self._running_visit = visit.number
        self._last_id += 1
        not_before = None
        if leaf is not None:
            if leaf.earliest:
                not_before = self._control.mission.configuration.started_at + leaf.earliest
            if leaf.time_limit is not None:
                self._control.mission.start_time_limit(leaf.time_limit, not_before)
        return (new_tuple(StartAction, (task, self._last_id, not_before)),)

    def _cancel_reason(self) -> str:
        if self._control.outcome is not None:
            return Message("the mission was {outcome}", outcome=self._control.outcome)
        if self.reaction is not None:
            return Message("reaction to {event}", event=event_text(self.reaction))
        if self.paused:
            return Message("the mission is paused")
        for entry in map(raw_entry, reversed(self._control.mission.trace)):
            if entry.timed_out is not None:
                return Message("the time of '{group}' is up", group=entry.timed_out)
            if entry.failure is not None:
                return entry.failure
        return Message("the mission was interrupted in the meantime")

    def _succeed(self, event: ActionSucceeded) -> None:
        """Handle the success of the running action: of a task, or of a reaction's drive."""
        control, leaf = self._control, self._running_leaf
        self._running = None
        self._cancelling = False
        if leaf is None:
            if self._is_active_drive():
                control.finish_drive()
            return
        mission = control.mission
        if leaf.time_limit is not None:
            mission.clear_time_limit()
        if leaf.measures is not None:
            mission.record_measurement(leaf.measures, leaf, event.value, event.abnormal)
        if self._running_visit == mission.configuration.visit.number:
            mission.complete(leaf)
        else:
            mission.record_success_after_leaving(leaf)

    def _end_action(self, event: ActionFailed | ActionStopped) -> None:
        """Handle the failure of the running action, or its end after a cancellation."""
        control, leaf = self._control, self._running_leaf
        mission = control.mission
        # The cancellation may have caused the failure, so during one it counts as a stop.
        failure = event if isinstance(event, ActionFailed) and not self._cancelling else None
        self._running = None
        self._cancelling = False
        if leaf is None:
            if failure is not None and self._is_active_drive():
                control.fail_drive(failure.reason)
            return
        if leaf.time_limit is not None:
            mission.clear_time_limit()
        if failure is not None and self._running_turn == mission.configuration.visit.turn:
            mission.retry_or_fail(leaf, failure.reason, failure.reading_kind)

    def _is_active_drive(self) -> bool:
        """Return whether the drive that has just ended belongs to the active reaction."""
        control = self._control
        return control.reaction_is_driving and control.drive_turn == self._running_turn

    def _require_time_order(self, now: float) -> None:
        if not self._control.mission.now <= _seconds(now):
            previous = self._control.mission.now
            raise ValueError(f"time runs backwards: {now:g} s comes after {previous:g} s")

    def _require_event(self, event: Event) -> None:
        if not self._started:
            raise ValueError(_NOT_STARTED)
        if type(event) not in _EVENTS:
            raise ValueError(f"{event!r} is not an event: pass an instance of an event class")
        if isinstance(event, _ENDS):
            self._require_end(event)
        elif isinstance(event, Occurred):
            if not isinstance(event.event, EventKind):
                raise ValueError(f"{event.event!r} is not a kind of event: pass an EventKind")
        elif isinstance(event, ReadingGiven):
            if not isinstance(event.object_id, str) or not _finite(event.value):
                raise ValueError(
                    f"{event} is not a reading: it needs a checkpoint and a finite value"
                )
        elif isinstance(event, GiveBack):
            if not all(isinstance(done, ByHand) for done in event.by_hand):
                raise ValueError(f"{event} has an item that is not a ByHand")
            if event.by_hand and self._running is not None:
                running = self._running.name
                raise ValueError(f"{event} comes while the action of '{running}' still runs")

    def _require_end(self, event: ActionEnded) -> None:
        running = self._running
        if running is None:
            raise ValueError(f"{event} comes while no action runs")
        if event.task != running.name:
            raise ValueError(f"{event} is about a task that does not run; '{running.name}' does")
        if event.id is not None and event.id != self._last_id:
            raise ValueError(f"{event} is about another action: number {self._last_id} runs")
        if type(event) is ActionSucceeded:
            value = event.value
            if value is None:
                return
            if self._running_leaf is None or self._running_leaf.measures is None:
                raise ValueError(f"{event} has a value, but the task measures nothing")
            if not _finite(value):
                raise ValueError(f"{event} has no usable value: report that the action failed")
        elif isinstance(event, ActionStopped) and not self._cancelling:
            raise ValueError(f"{event} comes for an action that was not cancelled")


_BUSY = "another call of the executor is in progress: use one thread, and no call within a call"
_NOT_STARTED = "the executor has not been started: call start first"


def _ended_visit(stored: tuple[str, str | None, bool]) -> EndedVisit:
    return EndedVisit(*stored)


def _finite(value: object) -> bool:
    try:
        return math.isfinite(value)  # type: ignore[arg-type]
    except TypeError:
        return False


def _seconds(now: float) -> float:
    # Floats beyond this limit are too coarse to represent durations of milliseconds.
    if not abs(now) <= MAX_TIME_S:
        raise ValueError(f"{now} is not a time in seconds")
    return now
