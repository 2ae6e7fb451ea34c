"""Short forms to write missions and events, and to run machines."""

from collections.abc import Callable, Iterable, Mapping
from itertools import pairwise

from argo_compiler.hfsm import (
    ActionFailed,
    ActionStopped,
    ActionSucceeded,
    CancelAction,
    Event,
    Executor,
    StartAction,
    Tick,
    lower,
)
from argo_compiler.il import Group, Mission, Transition
from tests.mission_writing import measure

Transitions = Mapping[str, Iterable[str | Transition]]


class Play:
    """Executor of a mission, with its commands in short: `+A` starts A, `-A` cancels it."""

    def __init__(self, mission, now=0):
        self.executor = Executor(lower(mission))
        self.first_commands = self.short(self.executor.start(now))

    def short(self, commands):
        return [
            f"-{c.task}" if isinstance(c, CancelAction) else f"+{c.task.name}" for c in commands
        ]

    def at(self, now, event):
        return self.short(self.executor.handle(event, now))

    def __getattr__(self, name):
        return getattr(self.executor, name)


def stopped(name):
    return ActionStopped(name)


def success(name, value=None):
    return ActionSucceeded(name, value)


def failure(name, why="stuck"):
    return ActionFailed(name, why)


def started(mission: Mission) -> Executor:
    """Return the executor of the mission, started at 0 s."""
    executor = Executor(lower(mission))
    executor.start(0)
    return executor


def build(names: str, *groups: Group, transitions: Transitions | None = None) -> Mission:
    """Return a mission of MEASURE tasks at the checkpoints of their names, one after the other.

    `transitions` replaces the transitions of a task; a bare name is an unconditional one.
    """
    order = names.split()
    leads_to = {a: [b] for a, b in pairwise(order)} | dict(transitions or {})
    return Mission(
        tasks=tuple(measure(name, *leads_to.get(name, ())) for name in order), groups=groups
    )


ActionEnd = tuple[float, Callable[[], Event]]
"""time at which an action ends, and a function that makes the event of its end"""


def run_mission(
    mission: Mission, end_of: Callable[[StartAction, float], ActionEnd], max_actions: int
) -> tuple[Executor, list[tuple[float, str]], float]:
    """Run a mission from 0 s on, to its end or until it would start more than `max_actions`.

    `end_of` returns the end of an action, given its command and the time of its start; an action
    that is cancelled stops at once. Returns the executor, the actions with the times of their
    starts, and the time.
    """
    executor = Executor(lower(mission))
    now, started_actions, running, end = 0.0, [], None, None
    commands = executor.start(now)
    while True:
        for command in commands:
            if isinstance(command, CancelAction):
                running = None
                commands = executor.handle(ActionStopped(command.task, id=command.id), now)
                break
            if len(started_actions) == max_actions:
                return executor, started_actions, now
            started_actions.append((now, command.task.name))
            running, end = command, None
        else:
            if executor.finished:
                return executor, started_actions, now
            due = executor.next_deadline
            if running is not None and end is None:
                end = end_of(running, now)
            if running is None or (due is not None and due < end[0]):
                assert due is not None
                now, commands = due, executor.handle(Tick(), due)
            else:
                (now, event), running = end, None
                commands = executor.handle(event(), now)


def drive(
    mission: Mission,
    takes: Mapping[str, float] | None = None,
    reads: Mapping[str, Iterable[float | None]] | None = None,
    max_actions: int = 100,
) -> Executor:
    """Run a mission from 0 s on; each action takes 1 s unless `takes` has another duration.

    `reads` gives, by task, the values of its executions in turn; None is a failure.
    """
    readings = {name: iter(values) for name, values in (reads or {}).items()}

    def end_of(command: StartAction, now: float) -> ActionEnd:
        name = command.task.name

        def event() -> Event:
            value = next(readings[name], 0.0) if name in readings else 0.0
            return failure(name, "no view") if value is None else success(name, value)

        return now + (takes or {}).get(name, 1.0), event

    return run_mission(mission, end_of, max_actions)[0]


def path(executor: Executor) -> str:
    """Return the tasks that a machine visited, with the time at which each one was entered."""
    return " ".join(f"{entry.target or 'end'}@{entry.time:g}" for entry in executor.trace)
