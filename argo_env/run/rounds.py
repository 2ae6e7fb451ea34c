"""When rounds were due and when they began: seen from the machine as it goes on."""

from dataclasses import dataclass

from argo_compiler.hfsm import Cause, Hfsm, RepeatRule
from argo_compiler.hfsm.progress import GroupProgress
from argo_env.run.machine import Machine
from argo_env.run.record import RoundRun
from argo_env.run.stays import BEGINNINGS


@dataclass(frozen=True)
class _Seen:
    """How a group stood at the last look."""

    round: int
    elapsed: float
    """s on its clock"""
    at: int
    """of its present round in the list"""


class RoundWatch:
    """Notes the rounds of all groups. Holds those that it has seen."""

    def __init__(self) -> None:
        self._rounds: list[RoundRun] = []
        self._groups: dict[str, _Seen] = {}
        self._steps = 0  # of the trace
        self._hfsm: Hfsm | None = None
        self._rules: dict[str, RepeatRule] = {}

    def look(self, machine: Machine, now: float) -> None:
        """Takes note of how the machine stands at time `now` (s), after each of its steps."""
        new = machine.trace[self._steps :]
        self._steps += len(new)
        if machine.hfsm is not self._hfsm:
            self._hfsm = machine.hfsm
            self._rules = {c.name: c.repeat for c in machine.hfsm.composites[1:] if c.repeat}
        moved = max((e.time for e in new if e.cause in BEGINNINGS), default=None)
        begun = max((e.time for e in new if e.cause is Cause.ROUND), default=None)
        if not self._rules or (moved is None and begun is None):
            return
        progress = machine.progress()
        inside = {} if progress.outcome else {g.group: g for g in progress.groups}
        first = next(e for e in new if e.cause in BEGINNINGS or e.cause is Cause.ROUND)
        # The round that was waited for may have ended in the moment in which it began.
        due = first.time if first.cause is Cause.ROUND else None
        for name in [name for name in self._groups if name not in inside]:
            self._end(self._groups.pop(name).at, now if moved is None else moved, due)
        for name, group in inside.items():
            seen, waits = self._groups.get(name), progress.round_of == name
            if moved is not None and (
                seen is None or group.round != seen.round or group.elapsed < seen.elapsed
            ):
                if seen is not None:
                    self._end(seen.at, moved, due)
                self._rounds.append(_entered(group, self._rules[name], moved, now, waits))
                at = len(self._rounds) - 1
            elif seen is None:
                continue
            else:
                at = seen.at
                if self._rounds[at].began is None and not waits and begun is not None:
                    self._update(at, due=begun, began=begun)
            self._groups[name] = _Seen(group.round, group.elapsed, at)

    def all(self) -> tuple[RoundRun, ...]:
        """All of them, in the order in which they could begin."""
        return tuple(self._rounds)

    def _end(self, at: int, now: float, begun: float | None) -> None:
        if begun is not None and self._rounds[at].began is None:
            self._update(at, due=begun, began=begun)
        self._update(at, ended=now)

    def _update(self, at: int, **times: float) -> None:
        self._rounds[at] = self._rounds[at].model_copy(update=times)


def _entered(
    group: GroupProgress, rule: RepeatRule, since: float, now: float, waits: bool
) -> RoundRun:
    """A round that could begin at `since`, and `waits` until it is due, as seen at `now` (s)."""
    # How long it has been due by now, on the group's clock.
    overdue = group.elapsed - (group.round - 1) * rule.every
    due = now - overdue if waits else min(now - overdue, since)
    return RoundRun(
        group=group.group,
        number=group.round,
        since=since,
        due=round(due, 6) if rule.every else None,
        began=None if waits else since,
    )
