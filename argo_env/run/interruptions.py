"""When the mission was interrupted, and by what: seen from the machine as it goes on."""

from argo_compiler.hfsm import Cause
from argo_compiler.il import EventKind
from argo_env.run.machine import Machine
from argo_env.run.record import Interruption


class InterruptionWatch:
    """Notes each pause and each reaction. Holds the one that goes on."""

    def __init__(self) -> None:
        self._over: list[Interruption] = []
        self._by: EventKind | None = None
        self._since: float | None = None
        self._steps = 0  # of the trace

    def look(self, machine: Machine, now: float) -> None:
        """Takes note of how the machine stands at time `now` (s), after each of its steps."""
        new = machine.trace[self._steps :]
        self._steps += len(new)
        interrupted = not machine.finished and (machine.paused or machine.reaction is not None)
        by = None if machine.paused else machine.reaction
        if self._since is not None and (not interrupted or by is not self._by):
            limit = any(e.cause is Cause.LIMIT and e.event is self._by for e in new)
            over = Interruption(start=self._since, end=now, event=self._by, limit_over=limit)
            self._over.append(over)
            self._since = None
        if interrupted and self._since is None:
            self._by, self._since = by, now

    def all(self, now: float) -> tuple[Interruption, ...]:
        """All of them, the one that goes on up to `now` (s)."""
        if self._since is None:
            return tuple(self._over)
        return (*self._over, Interruption(start=self._since, end=now, event=self._by))
