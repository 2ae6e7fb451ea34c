"""Visits of tasks, waits, time windows, rounds and interruptions, from a machine and its trace."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

from argo_compiler.hfsm import Cause, TraceEntry
from argo_compiler.hfsm.conditions import wait_end_text
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
        entry = self.end_entry
        by_itself = (
            entry is not None
            and entry.event is None
            and entry.cause not in (Cause.TIMEOUT, Cause.CANCEL, Cause.END)
        )
        return by_itself and self.failure is None


def visits_from_trace(
    trace: Sequence[TraceEntry], seconds_before_restore: float = 0.0
) -> Iterator[VisitRun]:
    """Yield the visits of all tasks in a trace, in the order of time.

    The visit of a task that waits for its group's round to be due begins with the round. Without
    the round there is no visit. The first visit of a restored machine had begun
    `seconds_before_restore` earlier than it was restored.
    """
    task: str | None = None
    start: float | None = None  # None: the visit has not begun, as its group's round is awaited
    for entry in trace:
        if entry.cause is Cause.ROUND:
            start = entry.time
            continue
        if entry.cause in VISIT_ENDS:
            if task is not None and start is not None:
                # An entry with an event has the failure of the reaction to it.
                failure = None if entry.event else entry.failure
                yield VisitRun(task, start, entry.time, failure, entry)
            start = entry.time
        elif entry.cause in (Cause.START, Cause.RESTORE):
            start = entry.time - seconds_before_restore
        else:
            continue
        task = entry.target
        if any(begun.awaited for begun in entry.rounds):
            start = None
    if task is not None and start is not None:
        yield VisitRun(task, start, None)


def wait_runs(mission: Mission, visits: Sequence[VisitRun], now: float) -> tuple[WaitRun, ...]:
    """Return the visits of WAIT tasks, without those that only join transitions.

    A visit that has not ended is returned up to time `now` (s).
    """
    tasks = {t.name: t for t in mission.tasks if t.action is Action.WAIT and not is_junction(t)}
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


def is_junction(task: Task) -> bool:
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


def rounds_from_trace(trace: Sequence[TraceEntry]) -> tuple[RoundRun, ...]:
    """Return the rounds of all groups in a trace, in the order in which they could begin.

    A round that waits to begin is one of them. The rounds of the groups inside it follow when it
    begins.
    """
    rounds: list[RoundRun] = []
    present: dict[str, int] = {}  # index of the round of each active group
    for entry in trace:
        for group in (*entry.left, *([] if entry.repeated is None else [entry.repeated])):
            # A group inside an awaited round has no round yet.
            if (index := present.pop(group, None)) is not None:
                rounds[index] = rounds[index].model_copy(update={"ended": entry.time})
        for begun in entry.rounds:
            times = {
                "due": None if begun.due is None else round(begun.due, 6),
                "began": None if begun.awaited else entry.time,
            }
            if begun.group in present:
                index = present[begun.group]
                rounds[index] = rounds[index].model_copy(update=times)
            else:
                present[begun.group] = len(rounds)
                rounds.append(
                    RoundRun(group=begun.group, number=begun.number, since=entry.time, **times)
                )
    return tuple(rounds)


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
