"""From a machine as it goes on, and its trace: how long it stood at tasks, what it waited for, what
was on time, its rounds and its interruptions."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

from argo_compiler.hfsm import Cause, Hfsm, RepeatRule, TraceEntry
from argo_compiler.hfsm.conditions import awaited
from argo_compiler.hfsm.progress import GroupProgress
from argo_compiler.il import Action, EventKind, Mission, Task
from argo_env.run.machine import Machine
from argo_env.run.record import Interruption, RoundRun, WaitRun, WindowOutcome, WindowRun

MOVES = frozenset(
    {
        Cause.CONDITION,
        Cause.REPEAT,
        Cause.DEFAULT,
        Cause.TIMEOUT,
        Cause.FAILURE,
        Cause.MISSED,
        Cause.CANCEL,
        Cause.END,
    }
)
"""what ends a visit"""
BEGINNINGS = MOVES | {Cause.START, Cause.RESTORE}
"""what may begin one"""


@dataclass(frozen=True)
class Visit:
    """The machine's visit at a task."""

    task: str
    start: float
    """s"""
    end: float | None
    """s; None: it goes on"""
    failure: str | None = None
    """why the task failed for good, if it did"""
    left: TraceEntry | None = None
    """what the trace says of its end"""

    @property
    def done(self) -> bool:
        """Whether the task has ended, and has not failed; a group's time or a person may end a
        visit before that."""
        by_itself = self.left is not None and self.left.cause not in (
            Cause.TIMEOUT,
            Cause.CANCEL,
            Cause.END,
        )
        return by_itself and self.failure is None


def visits_from_trace(trace: Sequence[TraceEntry], since: float = 0.0) -> Iterator[Visit]:
    """All of them, in the order of time. A round that is not due yet is not begun.

    A machine that was restored had stood at its task for `since` (s).
    """
    task: str | None = None
    start = 0.0
    for entry in trace:
        if entry.cause in (Cause.START, Cause.RESTORE):
            task, start = entry.target, entry.time - since
        elif entry.cause is Cause.ROUND:
            start = entry.time
        elif entry.cause in MOVES:
            if task is not None:
                yield Visit(task, start, entry.time, entry.failure, entry)
            task, start = entry.target, entry.time
    if task is not None:
        yield Visit(task, start, None)


def wait_runs(mission: Mission, visits: Sequence[Visit], now: float) -> tuple[WaitRun, ...]:
    """The visits of WAITs that are no mere places, up to time `now` (s)."""
    tasks = {t.name: t for t in mission.tasks if t.action is Action.WAIT and not _is_place(t)}
    return tuple(
        WaitRun(
            task=visit.task,
            what=_what_is_awaited(tasks[visit.task]),
            start=visit.start,
            end=now if visit.end is None else visit.end,
            ended=visit.end is not None,
            failure=visit.failure,
            why=_why(visit),
        )
        for visit in visits
        if visit.task in tasks
    )


def window_runs(
    mission: Mission, visits: Sequence[Visit], before: Collection[str] = ()
) -> tuple[WindowRun, ...]:
    """The visits of tasks with time windows, then those that the mission has not come to, nor had
    come to `before` these visits."""
    tasks = {t.name: t for t in mission.tasks if t.window is not None}
    found = [_window(tasks[visit.task], visit) for visit in visits if visit.task in tasks]
    seen = {run.task for run in found}
    found += [_window(task, None) for name, task in tasks.items() if name not in {*seen, *before}]
    return tuple(found)


def _what_is_awaited(task: Task) -> str:
    """What a WAIT waits for, in words."""
    rule = task.wait
    assert rule is not None
    if rule.duration is not None:
        return f"{rule.duration:g} s"
    limit = f", {rule.limit:g} s at most" if rule.limit is not None else ""
    return awaited(rule) + limit


def _is_place(task: Task) -> bool:
    """Whether nothing is ever waited for: ways meet there."""
    return task.wait is not None and task.wait.duration == 0 and task.window is None


def _why(visit: Visit) -> str | None:
    """What ended it, in words."""
    if visit.left is None:
        return None
    return visit.failure or visit.left.detail or visit.left.why


def _window(task: Task, visit: Visit | None) -> WindowRun:
    window = task.window
    assert window is not None
    end = None if visit is None else visit.end
    over = end is not None and window.latest is not None and end >= window.latest
    late = end is not None and window.latest is not None and end > window.latest
    kept = WindowOutcome.OPEN
    if visit is None:
        kept = WindowOutcome.NOT_VISITED
    elif visit.failure is not None:
        kept = WindowOutcome.MISSED if window.hard and over else WindowOutcome.FAILED
    elif visit.done:
        kept = WindowOutcome.LATE if late else WindowOutcome.KEPT
    elif end is not None:
        kept = WindowOutcome.LEFT
    return WindowRun(
        task=task.name,
        earliest=window.earliest,
        latest=window.latest,
        hard=window.hard,
        visited=None if visit is None else visit.start,
        ended=end,
        kept=kept,
    )


@dataclass(frozen=True)
class _Seen:
    """How a group stood at the last look."""

    round: int
    elapsed: float
    """s on its clock"""
    at: int
    """of its present round in the list"""


class RoundTracker:
    """Notes the rounds of all groups. Holds those that it has seen."""

    def __init__(self) -> None:
        self._rounds: list[RoundRun] = []
        self._groups: dict[str, _Seen] = {}
        self._steps = 0  # of the trace
        self._hfsm: Hfsm | None = None
        self._rules: dict[str, RepeatRule] = {}

    def update(self, machine: Machine, now: float) -> None:
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


class InterruptionTracker:
    """Notes each pause and each reaction. Holds the one that goes on."""

    def __init__(self) -> None:
        self._over: list[Interruption] = []
        self._by: EventKind | None = None
        self._since: float | None = None
        self._steps = 0  # of the trace

    def update(self, machine: Machine, now: float) -> None:
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
