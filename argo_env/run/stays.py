"""From the trace of a machine: how long it stood at tasks, what it waited for, what was on time."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

from argo_compiler.hfsm import Cause, TraceEntry
from argo_compiler.hfsm.conditions import awaited
from argo_compiler.il import Action, Mission, Task
from argo_env.run.record import WaitRun, WindowKept, WindowRun

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
class Stay:
    """The machine's stay at a task."""

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


def stays_of(trace: Sequence[TraceEntry], since: float = 0.0) -> Iterator[Stay]:
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
                yield Stay(task, start, entry.time, entry.failure, entry)
            task, start = entry.target, entry.time
    if task is not None:
        yield Stay(task, start, None)


def waits_of(mission: Mission, stays: Sequence[Stay], now: float) -> tuple[WaitRun, ...]:
    """The visits of WAITs that are no mere places, up to time `now` (s)."""
    tasks = {t.name: t for t in mission.tasks if t.action is Action.WAIT and not _is_place(t)}
    return tuple(
        WaitRun(
            task=stay.task,
            what=_what_is_awaited(tasks[stay.task]),
            start=stay.start,
            end=now if stay.end is None else stay.end,
            ended=stay.end is not None,
            failure=stay.failure,
            why=_why(stay),
        )
        for stay in stays
        if stay.task in tasks
    )


def windows_of(
    mission: Mission, stays: Sequence[Stay], before: Collection[str] = ()
) -> tuple[WindowRun, ...]:
    """The visits of tasks with time windows, then those that the mission has not come to, nor had
    come to `before` these stays."""
    tasks = {t.name: t for t in mission.tasks if t.window is not None}
    found = [_window(tasks[stay.task], stay) for stay in stays if stay.task in tasks]
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


def _why(stay: Stay) -> str | None:
    """What ended it, in words."""
    if stay.left is None:
        return None
    return stay.failure or stay.left.detail or stay.left.why


def _window(task: Task, stay: Stay | None) -> WindowRun:
    window = task.window
    assert window is not None
    end = None if stay is None else stay.end
    over = end is not None and window.latest is not None and end >= window.latest
    late = end is not None and window.latest is not None and end > window.latest
    kept = WindowKept.OPEN
    if stay is None:
        kept = WindowKept.NOT_VISITED
    elif stay.failure is not None:
        kept = WindowKept.MISSED if window.hard and over else WindowKept.FAILED
    elif stay.done:
        kept = WindowKept.LATE if late else WindowKept.KEPT
    elif end is not None:
        kept = WindowKept.LEFT
    return WindowRun(
        task=task.name,
        earliest=window.earliest,
        latest=window.latest,
        hard=window.hard,
        visited=None if stay is None else stay.start,
        ended=end,
        kept=kept,
    )
