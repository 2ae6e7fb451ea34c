"""Short ways to write a mission, and a driver for its machine."""

from collections.abc import Callable, Iterable, Mapping
from itertools import pairwise

import pytest

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


@pytest.fixture
def build() -> Callable[..., Mission]:
    """A mission of MEASURE tasks, each at the checkpoint of its name, each leading to the next.

    `ways` replaces the transitions of a task; a bare name is an unconditional one.
    """

    def build(names: str, *groups: Group, ways: Ways | None = None) -> Mission:
        order = names.split()
        leads_to = {a: [b] for a, b in pairwise(order)} | dict(ways or {})
        return Mission(
            tasks=tuple(measure(name, *leads_to.get(name, ())) for name in order), groups=groups
        )

    return build


@pytest.fixture
def drive() -> Callable[..., Executor]:
    """Runs a mission from 0 s on; each action takes 1 s unless `takes` says otherwise.

    `reads` gives, by task, the values of its executions in turn; None is a failure.
    """

    def drive(
        mission: Mission,
        takes: Mapping[str, float] | None = None,
        reads: Mapping[str, Iterable[float | None]] | None = None,
        steps: int = 100,
    ) -> Executor:
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

    return drive


@pytest.fixture
def path() -> Callable[[Executor], str]:
    """The tasks that a machine went through, with the time at which each one was entered."""

    def path(executor: Executor) -> str:
        return " ".join(f"{entry.target or 'end'}@{entry.time:g}" for entry in executor.trace)

    return path
