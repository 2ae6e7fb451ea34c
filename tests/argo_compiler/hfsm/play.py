"""Short ways to write a mission and what its machine is told, and two ways to drive one."""

from collections.abc import Iterable, Mapping
from itertools import pairwise

from argo_compiler.hfsm import (
    ActionFailed,
    ActionStopped,
    ActionSucceeded,
    CancelAction,
    Command,
    Executor,
    StartAction,
    Tick,
    lower,
)
from argo_compiler.il import Group, Mission, Transition
from tests.mission_writing import measure

Ways = Mapping[str, Iterable[str | Transition]]


class Play:
    """A machine, and what it asks for in short: `+A` is a start, `-A` a cancellation."""

    def __init__(self, mission, now=0):
        self.executor = Executor(lower(mission))
        self.asked = self.short(self.executor.start(now))

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


def well(name, value=None):
    return ActionSucceeded(name, value)


def badly(name):
    return ActionFailed(name, "stuck")


def started(mission: Mission) -> Executor:
    """Return the machine of the mission, started at 0 s."""
    executor = Executor(lower(mission))
    executor.start(0)
    return executor


def build(names: str, *groups: Group, ways: Ways | None = None) -> Mission:
    """Return a mission of MEASURE tasks at the checkpoints of their names, one after the other.

    `ways` replaces the transitions of a task; a bare name is an unconditional one.
    """
    order = names.split()
    leads_to = {a: [b] for a, b in pairwise(order)} | dict(ways or {})
    return Mission(
        tasks=tuple(measure(name, *leads_to.get(name, ())) for name in order), groups=groups
    )


def drive(
    mission: Mission,
    takes: Mapping[str, float] | None = None,
    reads: Mapping[str, Iterable[float | None]] | None = None,
    steps: int = 100,
) -> Executor:
    """Run a mission from 0 s on; each action takes 1 s unless `takes` says otherwise.

    `reads` gives, by task, the values of its executions in turn; None is a failure.
    """
    executor = Executor(lower(mission))
    readings = {name: iter(values) for name, values in (reads or {}).items()}
    ends_at = 0.0

    def note(commands: tuple[Command, ...], now: float) -> None:
        nonlocal ends_at
        for command in commands:
            if isinstance(command, CancelAction):
                note(executor.handle(ActionStopped(command.task), now), now)
            elif isinstance(command, StartAction):
                ends_at = now + (takes or {}).get(command.task.name, 1.0)

    note(executor.start(0.0), 0.0)
    while not executor.finished and len(executor.trace) < steps:
        deadline = executor.next_deadline
        if deadline is not None and deadline < ends_at:
            note(executor.handle(Tick(), deadline), deadline)
            continue
        assert executor.running is not None
        name = executor.running.name
        value = next(readings[name], 0.0) if name in readings else 0.0
        event = ActionFailed(name, "no view") if value is None else ActionSucceeded(name, value)
        note(executor.handle(event, ends_at), ends_at)
    return executor


def path(executor: Executor) -> str:
    """Return the tasks that a machine went through, with the time at which each one was entered."""
    return " ".join(f"{entry.target or 'end'}@{entry.time:g}" for entry in executor.trace)
