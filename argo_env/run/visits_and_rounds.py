"""Visits of tasks, waits, time windows, rounds and interruptions, from a machine and its trace."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

from argo_compiler.hfsm import Cause, Hfsm, RepeatRule, TraceEntry
from argo_compiler.hfsm.conditions import wait_end_text
from argo_compiler.hfsm.progress import GroupProgress
from argo_compiler.il import Action, EventKind, Mission, Task
from argo_env.run.machine import Machine
from argo_env.run.record import Interruption, RoundRun, WaitRun, WindowOutcome, WindowVisit

VISIT_ENDS = frozenset(
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
"""causes of trace entries that end a visit"""
VISIT_STARTS = VISIT_ENDS | {Cause.START, Cause.RESTORE}
"""causes of trace entries that can start a visit"""


@dataclass(frozen=True)
class VisitRun:
    """Visit of a task by the machine."""

    task: str
    start: float
    """s"""
    end: float | None
    """s; None: the visit has not ended"""
    failure: str | None = None
    """why the task failed without a retry; None: it did not"""
    end_entry: TraceEntry | None = None
    """the trace's entry of its end"""

    @property
    def is_done(self) -> bool:
        """True if the visit has ended because its task was done, or skipped by a person.

        A failure, a group's time limit or the end of the mission can end a visit before that.
        """
        by_itself = self.end_entry is not None and self.end_entry.cause not in (
            Cause.TIMEOUT,
            Cause.CANCEL,
            Cause.END,
        )
        return by_itself and self.failure is None


def visits_from_trace(
    trace: Sequence[TraceEntry], seconds_before_restore: float = 0.0
) -> Iterator[VisitRun]:
    """Yield the visits of all tasks in a trace, in the order of time.

    The visit of a task that waits for its group's round to be due begins with the round. The first
    visit of a restored machine had begun `seconds_before_restore` earlier than it was restored.
    """
    task: str | None = None
    start = 0.0
    for entry in trace:
        if entry.cause in (Cause.START, Cause.RESTORE):
            task, start = entry.target, entry.time - seconds_before_restore
        elif entry.cause is Cause.ROUND:
            start = entry.time
        elif entry.cause in VISIT_ENDS:
            if task is not None:
                yield VisitRun(task, start, entry.time, entry.failure, entry)
            task, start = entry.target, entry.time
    if task is not None:
        yield VisitRun(task, start, None)


def wait_runs(mission: Mission, visits: Sequence[VisitRun], now: float) -> tuple[WaitRun, ...]:
    """Return the visits of WAIT tasks, without those that only join transitions.

    A visit that has not ended is returned up to time `now` (s).
    """
    tasks = {t.name: t for t in mission.tasks if t.action is Action.WAIT and not _is_junction(t)}
    return tuple(
        WaitRun(
            task=visit.task,
            what=_awaited_in_words(tasks[visit.task]),
            start=visit.start,
            end=now if visit.end is None else visit.end,
            ended=visit.end is not None,
            failure=visit.failure,
            why=_end_reason(visit),
        )
        for visit in visits
        if visit.task in tasks
    )


def visits_with_windows(
    mission: Mission, visits: Sequence[VisitRun], visited_earlier: Collection[str] = ()
) -> tuple[WindowVisit, ...]:
    """Return the visits of tasks with time windows, then an item for each unvisited one of them.

    An unvisited task in `visited_earlier` is left out, as it was visited before this run.
    """
    tasks = {t.name: t for t in mission.tasks if t.window is not None}
    runs = [_window_run(tasks[visit.task], visit) for visit in visits if visit.task in tasks]
    visited = {run.task for run in runs}
    runs += [
        _window_run(task, None)
        for name, task in tasks.items()
        if name not in {*visited, *visited_earlier}
    ]
    return tuple(runs)


def _awaited_in_words(task: Task) -> str:
    """Return what a WAIT task waits for, in words."""
    rule = task.wait
    assert rule is not None
    if rule.duration is not None:
        return f"{rule.duration:g} s"
    limit = f", {rule.limit:g} s at most" if rule.limit is not None else ""
    return wait_end_text(rule) + limit


def _is_junction(task: Task) -> bool:
    """Return True if a WAIT task never waits, and only joins transitions."""
    return task.wait is not None and task.wait.duration == 0 and task.window is None


def _end_reason(visit: VisitRun) -> str | None:
    """Return why a visit ended, in words; None if it has not ended."""
    if visit.end_entry is None:
        return None
    return visit.failure or visit.end_entry.detail or visit.end_entry.why


def _window_run(task: Task, visit: VisitRun | None) -> WindowVisit:
    window = task.window
    assert window is not None
    end = None if visit is None else visit.end
    is_over = end is not None and window.latest is not None and end >= window.latest
    is_late = end is not None and window.latest is not None and end > window.latest
    outcome = WindowOutcome.OPEN
    if visit is None:
        outcome = WindowOutcome.NOT_VISITED
    elif visit.failure is not None:
        outcome = WindowOutcome.MISSED if window.hard and is_over else WindowOutcome.FAILED
    elif visit.is_done:
        outcome = WindowOutcome.LATE if is_late else WindowOutcome.KEPT
    elif end is not None:
        outcome = WindowOutcome.LEFT
    return WindowVisit(
        task=task.name,
        earliest=window.earliest,
        latest=window.latest,
        hard=window.hard,
        visited=None if visit is None else visit.start,
        ended=end,
        kept=outcome,
    )


@dataclass(frozen=True)
class _KnownRound:
    """Round of a group at the last update."""

    round: int
    elapsed: float
    """s on the group's clock"""
    index: int
    """index of the round in the tracker's list"""


class RoundTracker:
    """Tracker of the rounds of all groups; holds the rounds seen so far."""

    def __init__(self) -> None:
        self._rounds: list[RoundRun] = []
        self._groups: dict[str, _KnownRound] = {}
        self._trace_length = 0  # entries of the trace that were handled
        self._hfsm: Hfsm | None = None
        self._rules: dict[str, RepeatRule] = {}

    def update(self, machine: Machine, now: float) -> None:
        """Record the machine's state at time `now` (s); to be called after each of its steps."""
        new = machine.trace[self._trace_length :]
        self._trace_length += len(new)
        if machine.hfsm is not self._hfsm:
            self._hfsm = machine.hfsm
            self._rules = {c.name: c.repeat for c in machine.hfsm.composites[1:] if c.repeat}
        moved = max((e.time for e in new if e.cause in VISIT_STARTS), default=None)
        begun = max((e.time for e in new if e.cause is Cause.ROUND), default=None)
        if not self._rules or (moved is None and begun is None):
            return
        progress = machine.progress()
        inside = {} if progress.outcome else {g.group: g for g in progress.groups}
        first = next(e for e in new if e.cause in VISIT_STARTS or e.cause is Cause.ROUND)
        # The awaited round may have ended at the same time at which it began.
        awaited_start = first.time if first.cause is Cause.ROUND else None
        for name in [name for name in self._groups if name not in inside]:
            self._end(self._groups.pop(name).index, now if moved is None else moved, awaited_start)
        for name, group in inside.items():
            known, waits = self._groups.get(name), progress.round_of == name
            if moved is not None and (
                known is None or group.round != known.round or group.elapsed < known.elapsed
            ):
                if known is not None:
                    self._end(known.index, moved, awaited_start)
                self._rounds.append(_new_round(group, self._rules[name], moved, now, waits))
                index = len(self._rounds) - 1
            elif known is None:
                continue
            else:
                index = known.index
                if self._rounds[index].began is None and not waits and begun is not None:
                    self._set_times(index, due=begun, began=begun)
            self._groups[name] = _KnownRound(group.round, group.elapsed, index)

    def rounds(self) -> tuple[RoundRun, ...]:
        """Return all rounds of groups, by their `since`; also those that still wait to begin."""
        return tuple(self._rounds)

    def _end(self, index: int, now: float, begun: float | None) -> None:
        if begun is not None and self._rounds[index].began is None:
            self._set_times(index, due=begun, began=begun)
        self._set_times(index, ended=now)

    def _set_times(self, index: int, **times: float) -> None:
        self._rounds[index] = self._rounds[index].model_copy(update=times)


def _new_round(
    group: GroupProgress, rule: RepeatRule, since: float, now: float, waits: bool
) -> RoundRun:
    """Return the present round of a group, as the record has it, at time `now` (s).

    The round could begin at `since` (s), when the previous one had ended. `waits` states that the
    machine still waits until the round is due.
    """
    # Seconds since the round was due, on the group's clock; negative before.
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
    """Tracker of pauses and reactions; holds the ended ones and the current one."""

    def __init__(self) -> None:
        self._ended: list[Interruption] = []
        self._event: EventKind | None = None
        self._since: float | None = None
        self._trace_length = 0  # entries of the trace that were handled

    def update(self, machine: Machine, now: float) -> None:
        """Record the machine's state at time `now` (s); to be called after each of its steps."""
        new = machine.trace[self._trace_length :]
        self._trace_length += len(new)
        interrupted = not machine.finished and (machine.paused or machine.reaction is not None)
        event = None if machine.paused else machine.reaction
        if self._since is not None and (not interrupted or event is not self._event):
            limit = any(e.cause is Cause.LIMIT and e.event is self._event for e in new)
            ended = Interruption(start=self._since, end=now, event=self._event, limit_over=limit)
            self._ended.append(ended)
            self._since = None
        if interrupted and self._since is None:
            self._event, self._since = event, now

    def interruptions(self, now: float) -> tuple[Interruption, ...]:
        """Return all interruptions so far, the current one up to time `now` (s)."""
        if self._since is None:
            return tuple(self._ended)
        return (*self._ended, Interruption(start=self._since, end=now, event=self._event))
