"""The executor: a machine under way, driven by events and a virtual clock."""

import math
from collections.abc import Mapping

from argo_compiler.hfsm.conditions import Measured
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
    Outcome,
    Pause,
    Resume,
    StartAction,
    TakeOver,
)
from argo_compiler.hfsm.model import DONE, MISSION, Hfsm
from argo_compiler.hfsm.progress import EndedTask, Progress
from argo_compiler.hfsm.restoring import (
    group_progress,
    place_of,
    queues,
    reaction_progress,
    remaining_by_hand,
    standing_of,
    value_progress,
)
from argo_compiler.hfsm.tables import LeafNode, tables
from argo_compiler.hfsm.trace import Cause, TraceEntry, entry
from argo_compiler.il import EventKind, Task

_ENDS = (ActionSucceeded, ActionFailed, ActionStopped)
_ABOUT_ACTIONS = (*_ENDS, GiveBack)

MAX_TIME_S = 1e12
"""The range of the mission's clock: some 30,000 years."""


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

    Calls that can't be right raise ValueError and change nothing: before `start`, at an earlier
    time than the call before, the end of an action that does not run, and what a person did by hand
    while an action still runs.
    """

    def __init__(self, hfsm: Hfsm) -> None:
        self.hfsm = hfsm
        self._control = Control(tables(hfsm))
        self._started = False
        self._fresh = True
        """whether the mission begins with `start`, rather than goes on"""
        self._began = 0.0
        """s, when the mission began"""
        self._ended_before: tuple[EndedTask, ...] = ()
        self._running: Task | None = None
        self._running_leaf: LeafNode | None = None
        """None: the drive of a reaction"""
        self._running_visit = 0
        self._cancelling = False

    @classmethod
    def restore(cls, hfsm: Hfsm, progress: Progress, now: float, away: float = 0.0) -> "Executor":
        """An executor that goes on from `progress` at time `now`; call `start` next.

        `away` is the time (s) since the progress was taken. It makes values older, and counts for
        the mission's duration and for groups that count interruptions. The durations of what was
        done by hand are part of it: their clocks run when the machine comes to the task.

        Raises:
            ArgoError: the progress is not one of this machine.
        """
        executor = cls(hfsm)
        control = executor._control
        control.course.now = _seconds(now)
        control.course.place = place_of(control.tables, progress, now, _seconds(away))
        control.standing = standing_of(control.tables, progress)
        control.drive_visit = control.course.place.new_visit()
        control.course.by_hand = queues(progress.by_hand)
        control.course.time_up = progress.time_up
        control.course.outcome = progress.outcome
        executor._fresh = False
        executor._began = now - (progress.elapsed + away)
        executor._ended_before = progress.ended
        return executor

    def start(self, now: float) -> tuple[Command, ...]:
        """Starts the mission, or lets a restored one go on; returns what to do first."""
        if self._started:
            raise ValueError("the executor has been started already")
        self._require_order(now)
        self._started = True
        control = self._control
        control.course.now = now
        if self._fresh:
            self._began = now
            control.course.place.enter(control.tables.initial, now)
        control.course.note(Cause.START if self._fresh else Cause.RESTORE, source=None)
        if control.outcome is None:
            limit = control.tables.max_duration
            if limit is not None and not control.course.time_up:
                control.course.time_up_at = max(self._began + limit, now)
            control.begin(self._fresh and self.hfsm.supervised)
        return self._command()

    def handle(self, event: Event, now: float) -> tuple[Command, ...]:
        """Takes note of an event at time `now` (s); returns the one thing to do next, if any."""
        self._require_order(now)
        if not self._started or isinstance(event, _ABOUT_ACTIONS):
            self._require_running(event)
        control = self._control
        if now > control.due:
            # The next float below `now` stands for all times before it.
            control.let_pass(math.nextafter(now, -math.inf))
        control.course.now = now
        if isinstance(event, _ENDS):
            self._end_action(event)
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
        control.settle()
        return self._command()

    def progress(self) -> Progress:
        """How far the mission has come at the time of the last call; see `restore`.

        An action that still runs is not part of it: pause first and await its end.
        """
        if not self._started:
            raise ValueError("the executor has not been started: call start first")
        control = self._control
        now, place = control.course.now, control.course.place
        reaction, waiting = reaction_progress(control.standing)
        ended = (EndedTask(task=t, failure=f, by_hand=h) for t, f, h in control.course.ended)
        return Progress(
            active=control.course.active,
            attempt=place.attempt,
            groups=group_progress(place, now),
            values=value_progress(place, now),
            ended=(*self._ended_before, *ended),
            elapsed=now - self._began,
            time_up=control.course.time_up,
            paused=control.paused,
            reaction=reaction,
            waiting=waiting,
            outcome=control.outcome,
            by_hand=remaining_by_hand(control.course.by_hand),
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
        """When the time of a group with a hard stop, or the mission's, is up next (s)."""
        due = self._control.due
        return due if self._started and due < math.inf else None

    @property
    def values(self) -> Mapping[str, Measured]:
        """What was measured last, by object_id."""
        place = self._control.course.place
        return {id: Measured(v, at - place.shift) for id, (v, at) in place.values.items()}

    @property
    def rounds(self) -> Mapping[str, int]:
        """The round, from 1, that each active group is in, by the group's name."""
        return {frame.group.name: frame.round for frame in self._control.course.place.frames}

    @property
    def trace(self) -> tuple[TraceEntry, ...]:
        """All that has happened since `start`, in order."""
        return tuple(map(entry, self._control.course.trace))

    def _command(self) -> tuple[Command, ...]:
        """Starts what is to run, once what is not has ended."""
        leaf, visit, start = self._wanted()
        if self._running is not None:
            if self._cancelling or visit == self._running_visit:
                return ()
            self._cancelling = True
            return (CancelAction(self._running.name, self._reason()),)
        if start:
            self._running = start[0].task
            self._running_leaf = leaf
            self._running_visit = visit
        return start

    def _wanted(self) -> tuple[LeafNode | None, int, tuple[StartAction, ...]]:
        """The leaf, the visit and the command of the action that is to run; visit 0: none."""
        control = self._control
        active, leaf = control.active, control.course.place.leaf
        if control.outcome is not None or control.paused:
            return None, 0, ()
        if active is None:
            return (None, 0, ()) if leaf is None else (leaf, control.course.place.visit, leaf.start)
        if control.driving:
            return None, control.drive_visit, active.start
        return None, 0, ()

    def _reason(self) -> str:
        if self._control.outcome is not None:
            return f"the mission was {self._control.outcome}"
        if self.reaction is not None:
            return f"reaction to {self.reaction.replace('_', ' ')}"
        if self.paused:
            return "the mission is paused"
        trace = reversed(self._control.course.trace)
        timed_out = next((one.timed_out for one in trace if one.timed_out is not None), "")
        return f"the time of '{timed_out}' is up"

    def _end_action(self, event: ActionEnded) -> None:
        control, leaf = self._control, self._running_leaf
        reason = None
        if isinstance(event, ActionFailed) and not self._cancelling:
            # A failure may be the work of the cancellation, so then it counts as a stop.
            reason = event.reason if self._wanted()[1] == self._running_visit else None
        self._running = None
        self._cancelling = False
        if leaf is None:
            if not control.driving or control.drive_visit != self._running_visit:
                return
            if isinstance(event, ActionSucceeded):
                control.arrive()
            elif reason is not None:
                control.fail_drive(reason)
        elif isinstance(event, ActionSucceeded):
            if event.value is not None and leaf.measures is not None:
                clock = control.course.now + control.course.place.shift
                control.course.place.values[leaf.measures] = event.value, clock
            if self._running_visit == control.course.place.visit:
                control.course.leave(leaf, None)
            else:
                control.course.leave_late(leaf)
        elif reason is not None:
            control.course.fail(leaf, reason)

    def _require_order(self, now: float) -> None:
        if not self._control.course.now <= _seconds(now):
            before = self._control.course.now
            raise ValueError(f"time runs backwards: {now:g} s comes after {before:g} s")

    def _require_running(self, event: Event) -> None:
        running = self._running
        if not self._started:
            raise ValueError("the executor has not been started: call start first")
        if isinstance(event, GiveBack) and event.by_hand and running is not None:
            raise ValueError(f"{event} comes while the action of '{running.name}' still runs")
        if not isinstance(event, _ENDS):
            return
        if running is None:
            raise ValueError(f"{event} comes while no action runs")
        if event.task != running.name:
            raise ValueError(f"{event} is about a task that does not run; '{running.name}' does")
        if isinstance(event, ActionSucceeded) and event.value is not None:
            if self._running_leaf is None or self._running_leaf.measures is None:
                raise ValueError(f"{event} has a value, but the task measures nothing")
            if not math.isfinite(event.value):
                raise ValueError(f"{event} has no usable value: report that the action failed")
        if isinstance(event, ActionStopped) and not self._cancelling:
            raise ValueError(f"{event} comes for an action that was not cancelled")


def _seconds(now: float) -> float:
    # Beyond, floats are too coarse for durations of milliseconds to pass.
    if not abs(now) <= MAX_TIME_S:
        raise ValueError(f"{now} is no time in seconds")
    return now
