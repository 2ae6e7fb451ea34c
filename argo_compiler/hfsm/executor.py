"""The executor: a machine under way, driven by events and a virtual clock."""

import math
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

from argo_compiler.hfsm.conditions import Measured
from argo_compiler.hfsm.events import (
    ActionFailed,
    ActionSucceeded,
    CancelAction,
    Cause,
    Command,
    Event,
    StartAction,
    Tick,
    TraceEntry,
)
from argo_compiler.hfsm.model import DONE, MISSION, Hfsm
from argo_compiler.hfsm.progress import EndedTask, Progress, resume, snapshot
from argo_compiler.hfsm.step import Machine, State, next_timeout
from argo_compiler.il import Action

MAX_TIME_S = 1e12
"""The range of the mission's clock: some 30,000 years."""


class Executor:
    """A machine under way: the one object of this package that has state.

    It owns no thread and no clock. Whoever drives it calls `start` once, carries out the commands
    that come back, and calls `handle` when an action has ended and when `next_deadline` is reached.
    Times are seconds on the mission's clock and never run backwards.

    At equal times: time-outs that lie strictly before `now` come first, then the event, then the
    time-outs at `now`. So an action that ends exactly when the time of its group is up has ended,
    and one that is reported later was cancelled before: its event is dropped, whatever it measured.
    A time-out is dated when the time was up, not when the executor heard of it, so a driver that
    comes late gets the same machine. If the time of several groups is up at once, the outermost one
    is left.

    An action that failed has ended without a value, and the machine goes on as after any other;
    the trace says why it failed. A value measured earlier at the same checkpoint stays.

    Calls that can't be right raise ValueError: before `start`, after the end of the mission, at an
    earlier time than the call before, and events of a task that is not active.
    """

    def __init__(self, hfsm: Hfsm) -> None:
        self._machine = Machine(hfsm)
        self._resumed: State | None = None
        self._ended_before: tuple[EndedTask, ...] = ()
        self._state: State | None = None
        # What has been decides nothing, so it is kept beside the state, and only ever added to.
        self._trace: list[TraceEntry] = []

    @classmethod
    def restore(cls, hfsm: Hfsm, progress: Progress, now: float) -> "Executor":
        """An executor that goes on from `progress` at time `now`; call `start` next.

        Groups have the time left that they had, values the age. `start` starts the action of the
        active task anew.

        Raises:
            ArgoError: the progress is not one of this machine.
        """
        executor = cls(hfsm)
        executor._resumed = resume(executor._machine, progress, _seconds(now))
        executor._ended_before = progress.ended
        return executor

    def start(self, now: float) -> tuple[Command, ...]:
        """Starts the mission; returns what to do first."""
        if self._state is not None:
            raise ValueError("the executor has been started already")
        if self._resumed is None:
            self._state, entry = self._machine.initial(_seconds(now))
            self._trace.append(entry)
        else:
            _require_order(self._resumed.time, now)
            self._state = replace(self._resumed, time=now)
            self._trace.append(TraceEntry(now, None, self.active, Cause.RESUME))
            self._time_out(until=now)
        return self._start_active()

    def handle(self, event: Event, now: float) -> tuple[Command, ...]:
        """Takes note of an event at time `now`; returns at most one cancellation and one start.

        Where several steps fall into one call, the actions in between are neither started nor
        cancelled, but the trace has them.
        """
        before = self._started()
        if before.leaf is None:
            raise ValueError(f"the mission has ended; {event} comes too late")
        _require_order(before.time, now)
        ending = None if isinstance(event, Tick) else event
        if ending is not None:
            self._require_active(ending)
        # The next float below `now` stands for all times before it.
        self._time_out(until=math.nextafter(now, -math.inf))
        state = self._state = replace(self._started(), time=now)
        ended = ending is not None and state.visit == before.visit
        if ending is not None and ended:
            self._end_action(state, ending)
        self._time_out(until=now)
        if self._started().visit == before.visit:
            return ()
        cancel = () if ended else (CancelAction(before.leaf.task.name),)
        return (*cancel, *self._start_active())

    def progress(self) -> Progress:
        """How far the mission has come at the time of the last call; see `restore`."""
        ended = (
            EndedTask(task=entry.source, failure=entry.failure)
            for entry in self._trace
            if entry.source is not None and entry.cause is not Cause.TIMEOUT
        )
        return snapshot(self._started(), (*self._ended_before, *ended))

    @property
    def finished(self) -> bool:
        """Whether the mission has ended."""
        return self._state is not None and self._state.leaf is None

    @property
    def active(self) -> str | None:
        """The name of the task under way; None before the start and after the end."""
        return self._state.leaf.task.name if self._state and self._state.leaf else None

    @property
    def configuration(self) -> tuple[str, ...]:
        """The ids of the active states, from the mission to the leaf; none before the start."""
        if self._state is None:
            return ()
        groups = (frame.group.id for frame in self._state.frames)
        return (MISSION, *groups, self._state.leaf.id if self._state.leaf else DONE)

    @property
    def next_deadline(self) -> float | None:
        """When the time of an active group with a hard stop is up next (s), if there is one."""
        due = next_timeout(self._state) if self._state else None
        return None if due is None else due[0]

    @property
    def values(self) -> Mapping[str, Measured]:
        """What was measured last, by object_id."""
        return MappingProxyType(self._state.values if self._state else {})

    @property
    def rounds(self) -> Mapping[str, int]:
        """The round, from 1, that each active group is in, by the group's name."""
        frames = self._state.frames if self._state else ()
        return {frame.group.name: frame.round for frame in frames}

    @property
    def trace(self) -> tuple[TraceEntry, ...]:
        """All steps since `start`, in order."""
        return tuple(self._trace)

    def _started(self) -> State:
        if self._state is None:
            raise ValueError("the executor has not been started: call start first")
        return self._state

    def _require_active(self, event: ActionSucceeded | ActionFailed) -> None:
        leaf = self._started().leaf
        if leaf is None or event.task != leaf.task.name:
            raise ValueError(f"{event} is about a task that is not active; '{self.active}' is")
        if isinstance(event, ActionSucceeded) and event.value is not None:
            if leaf.task.action is not Action.MEASURE:
                raise ValueError(f"{event} has a value, but the task measures nothing")
            if not math.isfinite(event.value):
                raise ValueError(f"{event} has no usable value: report that the action failed")

    def _end_action(self, state: State, event: ActionSucceeded | ActionFailed) -> None:
        failure = None
        if isinstance(event, ActionFailed):
            failure = event.reason
        elif event.value is not None and state.leaf and state.leaf.task.object_id is not None:
            measured = Measured(event.value, state.time)
            state = replace(state, values={**state.values, state.leaf.task.object_id: measured})
        self._state, entry = self._machine.action_ended(state, failure)
        self._trace.append(entry)

    def _time_out(self, until: float) -> None:
        """Leaves the groups whose time is up by then, in the order of time."""
        state = self._started()
        while (due := next_timeout(state)) is not None and due[0] <= until:
            # A resumed group's time may have been up before the mission went on.
            at = replace(state, time=max(due[0], state.time))
            state, entry = self._machine.timed_out(at, due[1])
            self._trace.append(entry)
        self._state = state

    def _start_active(self) -> tuple[Command, ...]:
        leaf = self._started().leaf
        return () if leaf is None else (StartAction(leaf.task),)


def _seconds(now: float) -> float:
    # Beyond, floats are too coarse for durations of milliseconds to pass.
    if not abs(now) <= MAX_TIME_S:
        raise ValueError(f"{now} is no time in seconds")
    return now


def _require_order(before: float, now: float) -> None:
    if _seconds(now) < before:
        raise ValueError(f"time runs backwards: {now:g} s comes after {before:g} s")
