"""Machines that a simulation runs: their protocol, and one that takes its tasks one by one."""

from collections.abc import Mapping, Sequence
from typing import Protocol

from argo_compiler.base.errors import Conflict
from argo_compiler.base.message import Message
from argo_compiler.hfsm import (
    ActionStopped,
    AwaitedCharge,
    CancelAction,
    Command,
    Event,
    Executor,
    Hfsm,
    Outcome,
    Progress,
    StartAction,
    TraceEntry,
    lower,
)
from argo_compiler.il import EventKind, Mission, Task, Transition


class Machine(Protocol):
    """Protocol of a machine: it handles events at times (s) and returns commands.

    `Executor` is one.
    """

    @property
    def hfsm(self) -> Hfsm: ...
    @property
    def finished(self) -> bool: ...
    @property
    def outcome(self) -> Outcome | None: ...
    @property
    def running(self) -> Task | None: ...
    @property
    def paused(self) -> bool: ...
    @property
    def reaction(self) -> EventKind | None: ...
    @property
    def next_deadline(self) -> float | None: ...
    @property
    def awaited_charges(self) -> tuple[AwaitedCharge, ...]: ...
    @property
    def configuration(self) -> tuple[str, ...]: ...
    @property
    def rounds(self) -> Mapping[str, int]: ...
    @property
    def trace(self) -> Sequence[TraceEntry]: ...
    @property
    def remaining_tasks(self) -> tuple[str, ...] | None: ...

    def start(self, now: float) -> tuple[Command, ...]: ...
    def handle(self, event: Event, now: float) -> tuple[Command, ...]: ...
    def progress(self) -> Progress: ...


class OpenMachine:
    """Machine of a mission whose tasks are appended one by one; holds the events it has handled.

    With each task it becomes the machine of the longer mission and handles the same events again.
    So its state is as if the task had been in the mission from the beginning. The mission stays
    open, for further tasks, until `close` is called.
    """

    def __init__(self, mission: Mission) -> None:
        """Take the first tasks: a mission of which each task leads to the next (not checked)."""
        self.mission = mission
        self._executor = Executor(lower(mission))
        self._handled: list[tuple[Event, float]] = []
        self._start_time = 0.0
        self._closed = False

    def append_task(self, task: Task) -> tuple[Command, ...]:
        """Append a task to the mission; return the command that starts its action.

        The tuple is empty if the action does not start now, as in a pause. Raises Conflict if an
        action runs, DiagnosticError if the mission has errors with the task.
        """
        if (running := self.running) is not None:
            raise Conflict(Message("task '{running}' is still running", running=running.name))
        *earlier, last = self.mission.tasks
        linked = last.model_copy(update={"transitions": (Transition(target=task.name),)})
        mission = self.mission.model_copy(update={"tasks": (*earlier, linked, task)})
        executor = Executor(lower(mission))
        all_commands = [*executor.start(self._start_time)]
        handled: list[tuple[Event, float]] = []
        for event, at in self._handled:
            handled.append((event, at))
            commands = executor.handle(event, at)
            all_commands += commands
            if any(isinstance(c, CancelAction) for c in commands) and (
                executor.running is not None and executor.running.name == task.name
            ):
                # The action of the new task has not really started, so it ends at once.
                handled.append((ActionStopped(task.name), at))
                all_commands += executor.handle(*handled[-1])
        self.mission, self._executor, self._handled = mission, executor, handled
        starts = [command for command in all_commands if isinstance(command, StartAction)]
        return () if executor.running is None else (starts[-1],)

    def close(self) -> None:
        """Close the mission: no task follows. If its last task has ended, it ends at once."""
        self._closed = True

    def start(self, now: float) -> tuple[Command, ...]:
        """Start the mission at time `now` (s) and return its first commands."""
        self._start_time = now
        return self._executor.start(now)

    def handle(self, event: Event, now: float) -> tuple[Command, ...]:
        """Handle an event at time `now` (s), record it, and return the commands that follow."""
        self._handled.append((event, now))
        return self._executor.handle(event, now)

    def progress(self) -> Progress:
        return self._executor.progress()

    @property
    def hfsm(self) -> Hfsm:
        return self._executor.hfsm

    @property
    def awaited_charges(self) -> tuple[AwaitedCharge, ...]:
        return self._executor.awaited_charges

    @property
    def finished(self) -> bool:
        """True if no task can follow, as `close` was called, and the mission has ended."""
        return self._closed and self._executor.finished

    @property
    def outcome(self) -> Outcome | None:
        return self._executor.outcome if self._closed else None

    @property
    def running(self) -> Task | None:
        return self._executor.running

    @property
    def paused(self) -> bool:
        return self._executor.paused

    @property
    def reaction(self) -> EventKind | None:
        return self._executor.reaction

    @property
    def next_deadline(self) -> float | None:
        return self._executor.next_deadline

    @property
    def configuration(self) -> tuple[str, ...]:
        return self._executor.configuration

    @property
    def rounds(self) -> Mapping[str, int]:
        return self._executor.rounds

    @property
    def trace(self) -> Sequence[TraceEntry]:
        return self._executor.trace

    @property
    def remaining_tasks(self) -> tuple[str, ...] | None:
        return self._executor.remaining_tasks
