"""Short ways to write a mission and what its machine is told, and ways to drive one."""

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


def badly(name, why="stuck"):
    return ActionFailed(name, why)


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


Ending = tuple[float, Callable[[], Event]]
"""when an action ends, and what is then told of it"""


def carry_out(
    mission: Mission, doing: Callable[[StartAction, float], Ending], most: int
) -> tuple[Executor, list[tuple[float, str]], float]:
    """Run a mission from 0 s on, to its end or until it begins more than `most` actions.

    `doing` says of an action that is begun, and when, how it ends; one that is cancelled stops at
    once. Returns the machine, the actions with the times of their starts, and the time.
    """
    executor = Executor(lower(mission))
    now, begun, running, ending = 0.0, [], None, None
    commands = executor.start(now)
    while True:
        for command in commands:
            if isinstance(command, CancelAction):
                running = None
                commands = executor.handle(ActionStopped(command.task, id=command.id), now)
                break
            if len(begun) == most:
                return executor, begun, now
            begun.append((now, command.task.name))
            running, ending = command, None
        else:
            if executor.finished:
                return executor, begun, now
            due = executor.next_deadline
            if running is not None and ending is None:
                ending = doing(running, now)
            if running is None or (due is not None and due < ending[0]):
                assert due is not None
                now, commands = due, executor.handle(Tick(), due)
            else:
                (now, told), running = ending, None
                commands = executor.handle(told(), now)


def drive(
    mission: Mission,
    takes: Mapping[str, float] | None = None,
    reads: Mapping[str, Iterable[float | None]] | None = None,
    most: int = 100,
) -> Executor:
    """Run a mission from 0 s on; each action takes 1 s unless `takes` says otherwise.

    `reads` gives, by task, the values of its executions in turn; None is a failure.
    """
    readings = {name: iter(values) for name, values in (reads or {}).items()}

    def doing(command: StartAction, now: float) -> Ending:
        name = command.task.name

        def told() -> Event:
            value = next(readings[name], 0.0) if name in readings else 0.0
            return badly(name, "no view") if value is None else well(name, value)

        return now + (takes or {}).get(name, 1.0), told

    return carry_out(mission, doing, most)[0]


def path(executor: Executor) -> str:
    """Return the tasks that a machine went through, with the time at which each one was entered."""
    return " ".join(f"{entry.target or 'end'}@{entry.time:g}" for entry in executor.trace)
