"""The machines that a simulation drives: what it asks of them, and one without a fixed mission."""

from collections.abc import Mapping, Sequence
from typing import Protocol

from argo_compiler.base.errors import Conflict
from argo_compiler.hfsm import (
    ActionStopped,
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
    """A machine under way, as an `Executor` is. Takes events and times (s), gives commands."""

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
    def configuration(self) -> tuple[str, ...]: ...
    @property
    def rounds(self) -> Mapping[str, int]: ...
    @property
    def trace(self) -> Sequence[TraceEntry]: ...

    def start(self, now: float) -> tuple[Command, ...]: ...
    def handle(self, event: Event, now: float) -> tuple[Command, ...]: ...
    def progress(self) -> Progress: ...


class OpenMachine:
    """The machine of a mission whose tasks are given one by one. Holds all that it was told.

    With each task it becomes the machine of the longer mission, told the same: so it stands as if
    the task had been in the mission from the beginning.
    """

    def __init__(self, mission: Mission) -> None:
        """The mission to begin with; its tasks follow one another."""
        self.mission = mission
        self._executor = Executor(lower(mission))
        self._told: list[tuple[Event, float]] = []
        self._began = 0.0
        self._closed = False

    def give(self, task: Task) -> tuple[Command, ...]:
        """The next task, to be done when those before it have been.

        Raises Conflict if an action runs, DiagnosticError if the mission makes no sense with it.
        """
        if (running := self.running) is not None:
            raise Conflict(f"task '{running.name}' is still under way")
        *before, last = self.mission.tasks
        joined = last.model_copy(update={"transitions": (Transition(target=task.name),)})
        mission = self.mission.model_copy(update={"tasks": (*before, joined, task)})
        executor = Executor(lower(mission))
        begun = [*executor.start(self._began)]
        told: list[tuple[Event, float]] = []
        for event, at in self._told:
            told.append((event, at))
            commands = executor.handle(event, at)
            begun += commands
            if any(isinstance(c, CancelAction) for c in commands) and (
                executor.running is not None and executor.running.name == task.name
            ):
                # In truth it has not begun yet.
                told.append((ActionStopped(task.name), at))
                begun += executor.handle(*told[-1])
        self.mission, self._executor, self._told = mission, executor, told
        starts = [command for command in begun if isinstance(command, StartAction)]
        return () if executor.running is None else (starts[-1],)

    def close(self) -> None:
        """No task will follow: the mission ends with those that were given."""
        self._closed = True

    def start(self, now: float) -> tuple[Command, ...]:
        """Starts the mission."""
        self._began = now
        return self._executor.start(now)

    def handle(self, event: Event, now: float) -> tuple[Command, ...]:
        """Takes note of an event at time `now` (s)."""
        self._told.append((event, now))
        return self._executor.handle(event, now)

    def progress(self) -> Progress:
        return self._executor.progress()

    @property
    def hfsm(self) -> Hfsm:
        return self._executor.hfsm

    @property
    def finished(self) -> bool:
        """Whether it was closed, and all is done."""
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
