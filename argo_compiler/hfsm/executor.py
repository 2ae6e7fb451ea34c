"""The executor: a machine under way, driven by events and a virtual clock."""

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

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
from argo_compiler.hfsm.restoring import (
    group_progress,
    place_of,
    reaction_progress,
    reading_progress,
    standing_of,
    tally_progress,
)
from argo_compiler.hfsm.tables import LeafNode, tables
from argo_compiler.hfsm.trace import TraceEntry, entry, new_tuple, raw_entry
from argo_compiler.hfsm.views import View
from argo_compiler.il import MAX_TIME_S, EventKind, Task

_ENDS = (ActionSucceeded, ActionFailed, ActionStopped)
_OTHER_ENDS = (ActionFailed, ActionStopped)
_EVENTS = frozenset(
    [*_ENDS, Tick, Occurred, ReadingGiven, Pause, Resume, TakeOver, GiveBack, Cancel]
)


@dataclass(frozen=True, slots=True)
class EndedVisit:
    """A visit of a task that has ended, and why it failed for good if it did."""

    task: str
    failure: str | None = None
    by_hand: bool = False


class Executor:
    """A machine under way: the one object of this package that has state.

    It owns no thread and no clock. Whoever drives it calls `start` once, carries out the command
    that comes back, if any, and calls `handle` when an action has ended, when something else has
    happened, and when `next_deadline` is reached. Times are seconds and never run backwards.

    At most one action runs. After a `CancelAction` the driver reports exactly one end of that
    action, whenever its clean-up is done, and gets the next `StartAction` then. Where the machine
    goes is decided at once; only the start waits.

    At equal times: time-outs that lie strictly before `now` come first, then the event, then the
    time-outs at `now`. A time-out is dated when the time was up, not when the executor heard of it,
    so a driver that comes late gets the same machine.

    Calls that can't be right raise ValueError and change nothing: what is no event, before `start`,
    at an earlier time than the call before, the end of an action that does not run or with another
    id than its command's, a value that is no finite number, and what a person did by hand while an
    action still runs.

    One thread at a time: nobody waits for a lock. A call of `start`, `handle` or `progress` while
    another one is under way, from whatever thread, is refused likewise, and what is read meanwhile
    may be half of a step. Drivers with several threads put events into a queue, from which one
    thread hands them on.
    """

    def __init__(self, hfsm: Hfsm) -> None:
        self.hfsm = hfsm
        self._control = Control(tables(hfsm))
        self._started = False
        self._fresh = True
        """whether the mission begins with `start`, rather than goes on"""
        self._running: Task | None = None
        self._running_leaf: LeafNode | None = None
        """None: the drive of a reaction"""
        self._running_visit = 0
        """the number of the visit in which the action was started"""
        self._running_turn = 0
        """its turn then: of another one the action has to be cancelled"""
        self._last_id = 0
        """of the last command that started an action"""
        self._cancelling = False
        # Whoever calls takes the turn and puts it back. `pop` is one step for other threads, too,
        # and unlike a lock a list can be copied.
        self._turn = [None]

    @classmethod
    def restore(cls, hfsm: Hfsm, progress: Progress, now: float, away: float = 0.0) -> "Executor":
        """An executor that goes on from `progress` at time `now`; call `start` next.

        `away` is the time (s) since the progress was taken. It counts for the mission's duration,
        for waits and holds and for groups that count interruptions, and makes readings older, and
        what was handed over before (`hand_over`, which is told of the time before that itself).

        Raises:
            ArgoError: the progress is not one of this machine.
        """
        executor = cls(hfsm)
        control = executor._control
        course = control.course
        course.now = _seconds(now)
        course.place = place_of(control.tables, progress, now, _seconds(away))
        control.standing = standing_of(control.tables, progress)
        control.drive_turn = course.place.new_number()
        if progress.reaction is not None:
            control.held_since = now - progress.reaction.held - away
        for done in progress.by_hand:
            course.give_by_hand((done,), now if done.age is None else now - away)
        for tally in progress.tallies:
            course.tallies[tally.task] = [tally.done, tally.failed, tally.by_hand]
        course.failed = progress.failed
        course.time_up = progress.time_up
        course.outcome = progress.outcome
        executor._last_id = progress.actions
        executor._fresh = False
        return executor

    def start(self, now: float) -> tuple[Command, ...]:
        """Starts the mission, or lets a restored one go on; returns what to do first."""
        with self._alone():
            if self._started:
                raise ValueError("the executor has been started already")
            self._require_order(now)
            self._started = True
            control = self._control
            course = control.course
            course.now = now
            if self._fresh:
                course.place.began = now
                course.place.enter(control.tables.initial, now)
            course.note(Cause.START if self._fresh else Cause.RESTORE, source=None)
            if control.outcome is None:
                limit = control.tables.max_duration
                if limit is not None and not course.time_up:
                    course.time_up_at = max(course.place.began + limit, now)
                supervised = self.hfsm.supervised and course.active is not None
                control.begin(self._fresh and supervised)
            return self._command()

    def handle(self, event: Event, now: float) -> tuple[Command, ...]:
        """Takes note of an event at time `now` (s); returns the one thing to do next, if any."""
        try:
            turn = self._turn.pop()
        except IndexError:
            raise ValueError(_BUSY) from None
        try:
            control = self._control
            course = control.course
            if not course.now <= now <= MAX_TIME_S:
                self._require_order(now)
            # Most events are of the first kind.
            if type(event) is ActionSucceeded and self._started:
                self._require_end(event)
            else:
                self._require_event(event)
            place = course.place
            if (
                now > place.due
                or now > place.own_due
                or now > course.time_up_at
                or now > control.hold_due
            ):
                # The next float below `now` stands for all times before it.
                control.let_pass(math.nextafter(now, -math.inf))
            course.now = now
            if type(event) is ActionSucceeded:
                self._succeed(event)
            elif isinstance(event, _OTHER_ENDS):
                self._end_action(event)
            elif type(event) is not Tick:
                self._hear(event, now)
            control.settle()
            return self._command()
        finally:
            self._turn.append(turn)

    def _hear(self, event: Event, now: float) -> None:
        """Takes note of what is neither the end of an action nor the passing of time."""
        control = self._control
        if isinstance(event, ReadingGiven):
            course = control.course
            course.tell(event.object_id, event.value, event.abnormal, now)
            course.note(Cause.READING, detail=f"#{event.object_id} = {event.value:g}")
        elif control.outcome is None:
            match event:
                case Occurred(kind, detail):
                    control.occur(kind, detail)
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
        """How far the mission has come at the time of the last call; see `restore`.

        An action that still runs is not part of it: pause first and await its end.
        """
        with self._alone():
            if not self._started:
                raise ValueError(_NOT_STARTED)
            return self._progress()

    def _progress(self) -> Progress:
        control = self._control
        course, place = control.course, control.course.place
        now, visit = course.now, place.visit
        reaction, waiting = reaction_progress(control.standing, now - control.held_since)
        return Progress(
            active=course.active,
            attempt=visit.attempt,
            since=0.0 if visit.leaf is None else now - visit.since,
            occurred=visit.occurred,
            round_of=None if place.round_of is None else place.round_of.group.name,
            groups=group_progress(place, now),
            readings=reading_progress(place, now),
            tallies=tally_progress(course.tallies),
            failed=course.failed,
            actions=self._last_id,
            elapsed=now - place.began,
            time_up=course.time_up,
            paused=control.paused,
            reaction=reaction,
            waiting=waiting,
            outcome=control.outcome,
            by_hand=course.by_hand_progress(),
        )

    @property
    def finished(self) -> bool:
        """Whether the mission has ended and no action runs any more."""
        return self._started and self._control.outcome is not None and self._running is None

    @property
    def outcome(self) -> Outcome | None:
        """How the mission has ended; None: it has not."""
        return self._control.outcome

    @property
    def active(self) -> str | None:
        """The name of the task that the mission stands at; None before its start and at its end."""
        return self._control.course.active

    @property
    def running(self) -> Task | None:
        """The task whose action has been started and has not ended."""
        return self._running

    @property
    def paused(self) -> bool:
        """Whether the mission waits for a person to resume it."""
        return self._control.paused

    @property
    def reaction(self) -> EventKind | None:
        """The event whose reaction is active."""
        return self._control.standing.active

    @property
    def holding(self) -> bool:
        """Whether the active reaction stands still and waits."""
        return self._control.holding

    @property
    def configuration(self) -> tuple[str, ...]:
        """The ids of the active states, from the mission to the leaf, then the reaction's.

        Empty before the start.
        """
        if not self._started:
            return ()
        place, active = self._control.course.place, self._control.active
        groups = (frame.group.id for frame in place.frames)
        reaction = () if active is None else (active.state.id,)
        return (MISSION, *groups, DONE if place.leaf is None else place.leaf.id, *reaction)

    @property
    def next_deadline(self) -> float | None:
        """When something comes about by time alone next (s)."""
        due = self._control.due
        return due if self._started and due < math.inf else None

    @property
    def readings(self) -> Mapping[str, CheckpointReading]:
        """What came of the last measurement, by object_id."""
        return dict(self._control.course.place.readings)

    @property
    def values(self) -> Mapping[str, Measured]:
        """The readings that have a value, by object_id."""
        return {
            id: Measured(reading.value, reading.time)
            for id, reading in self._control.course.place.readings.items()
            if reading.value is not None
        }

    @property
    def rounds(self) -> Mapping[str, int]:
        """The round, from 1, that each active group is in, by the group's name."""
        return {frame.group.name: frame.round for frame in self._control.course.place.frames}

    @property
    def trace(self) -> Sequence[TraceEntry]:
        """All that has happened since `start`, in order; an entry is made when it is looked at."""
        return View(self._control.course.trace, entry)

    @property
    def ended(self) -> Sequence[EndedVisit]:
        """The visits that have ended since `start`, in order. A cancelled action has ended none."""
        return View(self._control.course.ended, _ended_visit)

    @contextmanager
    def _alone(self) -> Iterator[None]:
        """No other call begins until this one has ended."""
        try:
            turn = self._turn.pop()
        except IndexError:
            raise ValueError(_BUSY) from None
        try:
            yield
        finally:
            self._turn.append(turn)

    def _command(self) -> tuple[Command, ...]:
        """Starts what is to run, once what is not has ended."""
        # What is to run and its turn; no task: nothing is. Each event comes by here.
        control = self._control
        course, standing = control.course, control.standing
        visit = course.place.visit
        leaf, task, turn = visit.leaf, None, 0
        if course.outcome is not None or standing.paused:
            pass
        elif standing.active is not None:
            active = control.active
            if control.driving and active is not None:
                leaf, task, turn = None, active.task, control.drive_turn
        elif leaf is not None and leaf.wait is None and course.place.round_of is None:
            task, turn = leaf.task, visit.turn
        running = self._running
        if running is not None:
            if self._cancelling or turn == self._running_turn:
                return ()
            self._cancelling = True
            return (CancelAction(running.name, self._reason(), self._last_id),)
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
                not_before = self._control.course.place.began + leaf.earliest
            if leaf.time_limit is not None:
                self._control.course.limit_action(leaf.time_limit, not_before)
        return (new_tuple(StartAction, (task, self._last_id, not_before)),)

    def _reason(self) -> str:
        if self._control.outcome is not None:
            return f"the mission was {self._control.outcome}"
        if self.reaction is not None:
            return f"reaction to {self.reaction.replace('_', ' ')}"
        if self.paused:
            return "the mission is paused"
        for one in map(raw_entry, reversed(self._control.course.trace)):
            if one.timed_out is not None:
                return f"the time of '{one.timed_out}' is up"
            if one.failure is not None:
                return one.failure
        return "its turn is over"

    def _succeed(self, event: ActionSucceeded) -> None:
        """The running action has ended well."""
        control, leaf = self._control, self._running_leaf
        self._running = None
        self._cancelling = False
        if leaf is None:
            if self._drives_on():
                control.arrive()
            return
        course = control.course
        if leaf.time_limit is not None:
            course.unlimit_action()
        if leaf.measures is not None:
            course.measure(leaf.measures, leaf, event.value, event.abnormal)
        if self._running_visit == course.place.visit.number:
            course.leave(leaf)
        else:
            course.leave_late(leaf)

    def _end_action(self, event: ActionFailed | ActionStopped) -> None:
        """The running action has failed or was stopped."""
        control, leaf = self._control, self._running_leaf
        course = control.course
        # A failure may be the work of the cancellation, so then it counts as a stop.
        failure = event if isinstance(event, ActionFailed) and not self._cancelling else None
        self._running = None
        self._cancelling = False
        if leaf is None:
            if failure is not None and self._drives_on():
                control.fail_drive(failure.reason)
            return
        if leaf.time_limit is not None:
            course.unlimit_action()
        if failure is not None and self._running_turn == course.place.visit.turn:
            course.fail(leaf, failure.reason, failure.unreadable)

    def _drives_on(self) -> bool:
        """Return whether the drive that has just ended belongs to the active reaction."""
        control = self._control
        return control.driving and control.drive_turn == self._running_turn

    def _require_order(self, now: float) -> None:
        if not self._control.course.now <= _seconds(now):
            before = self._control.course.now
            raise ValueError(f"time runs backwards: {now:g} s comes after {before:g} s")

    def _require_event(self, event: Event) -> None:
        if not self._started:
            raise ValueError(_NOT_STARTED)
        if type(event) not in _EVENTS:
            raise ValueError(f"{event!r} is no event: give an instance of one")
        if isinstance(event, _ENDS):
            self._require_end(event)
        elif isinstance(event, Occurred):
            if not isinstance(event.event, EventKind):
                raise ValueError(f"{event.event!r} is no kind of event: give an EventKind")
        elif isinstance(event, ReadingGiven):
            if not isinstance(event.object_id, str) or not _finite(event.value):
                raise ValueError(f"{event} is no reading: it needs a checkpoint and a finite value")
        elif isinstance(event, GiveBack):
            if not all(isinstance(done, ByHand) for done in event.by_hand):
                raise ValueError(f"{event} has something else than ByHand")
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


_BUSY = "another call of the executor is under way: one thread at a time, and none from inside"
_NOT_STARTED = "the executor has not been started: call start first"


def _ended_visit(kept: tuple[str, str | None, bool]) -> EndedVisit:
    return EndedVisit(*kept)


def _finite(value: object) -> bool:
    try:
        return math.isfinite(value)  # type: ignore[arg-type]
    except TypeError:
        return False


def _seconds(now: float) -> float:
    # Beyond, floats are too coarse for durations of milliseconds to pass.
    if not abs(now) <= MAX_TIME_S:
        raise ValueError(f"{now} is no time in seconds")
    return now
