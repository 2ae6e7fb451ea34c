"""Verdict of a run, success or what is missing, and the record of the run.

`verdict_line.py` makes the headline that people see.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from argo_compiler.base.model import Pose
from argo_compiler.hfsm import Cause, Outcome, Progress, TraceEntry
from argo_compiler.il import Action, Mission, Task
from argo_compiler.il.docked import is_at_dock
from argo_compiler.il.reserved import RESERVED_NAMES
from argo_env.run.log import Entry, RunLog
from argo_env.run.machine import Machine
from argo_env.run.record import (
    DIGITS,
    Result,
    RunRecord,
    TaskRun,
    TraceStep,
    WindowOutcome,
    WindowVisit,
)
from argo_env.run.run_setup import RunSetup
from argo_env.run.spec import RunSpec
from argo_env.run.verdict import VerdictCode, VerdictPart, verdict_text
from argo_env.run.visits_and_rounds import (
    InterruptionTracker,
    VisitRun,
    is_junction,
    rounds_from_trace,
    visits_from_trace,
    visits_with_windows,
    wait_runs,
)

_ENDINGS = {
    Outcome.RETURNED: VerdictCode.RETURNED,
    Outcome.SHELTERED: VerdictCode.SHELTERED,
    Outcome.FAILED: VerdictCode.NOT_REACHED,
    Outcome.ABORTED: VerdictCode.ABORTED,
    Outcome.CANCELLED: VerdictCode.CANCELLED,
}
"""outcomes of a mission that was ended before its end"""
_END_CAUSES = (Cause.END, Cause.FAILURE, Cause.CANCEL)


@dataclass(frozen=True)
class _Rest:
    """Tasks that were left to a mission when it was ended or its run was stopped."""

    needed: tuple[str, ...] = ()
    """tasks that are not optional"""
    optional: tuple[str, ...] = ()
    reached: tuple[str, ...] = ()
    """tasks that are not optional, and were done by the end itself: the robot is where they lead"""
    known: bool = True


def tasks_with_unretried_failure(
    runs: Sequence[TaskRun], trace: Sequence[TraceEntry], visits: Sequence[VisitRun]
) -> tuple[str, ...]:
    """Return the names of tasks with a failure that no retry followed, by the first such failure.

    Each is named once. A later visit that succeeds does not clear the failure. Failures of actions
    that a person ordered don't count.
    """
    retried = {(e.time, e.source) for e in trace if e.cause is Cause.RETRY}
    failed = [
        (r.end, r.task)
        for r in runs
        if r.outcome == "failed" and not r.by_hand and (r.end, r.task) not in retried
    ]
    failed += [(s.end, s.task) for s in visits if s.failure is not None and s.end is not None]
    return tuple(dict.fromkeys(task for _, task in sorted(failed, key=lambda f: f[0])))


def judge(
    mission: Mission,
    docks: Mapping[int, Pose],
    log: RunLog,
    machine: Machine,
    visits: Sequence[VisitRun],
    windows: Sequence[WindowVisit],
    earlier: Progress,
) -> Result:
    """Determine the result of a mission: the only place that decides on success.

    A mission is a success if it, or what ended it, did all that it requires: no task that is not
    optional has failed or was left undone, it was in time, and the robot is docked where it should
    be. So a reaction that asks for what was under way anyway, as the drive home, gives nothing up.

    Args:
        mission: the mission.
        docks: poses of the docks by number of their starting area.
        log: the run's log.
        machine: the machine at the end of the run, or as it is now.
        visits: the visits of tasks.
        windows: the outcomes of the tasks' time windows.
        earlier: progress of the mission before this run.
    """
    last, trace = log.last, machine.trace
    assert last is not None
    outcome = machine.outcome if machine.finished else None
    now, limit, area = last.t, mission.max_duration, mission.end_area
    docked = None if area is None else is_at_dock(last.body_pose, docks[area])
    early = _early_end(outcome, last, trace)
    rest = _rest_of(mission, machine, last) if early is not None and last.ended else _Rest()
    failed = tuple(
        dict.fromkeys(
            (
                *_failed_earlier(earlier, mission),
                *tasks_with_unretried_failure(log.tasks, trace, visits),
            )
        )
    )
    again = {visit.task for visit in visits if visit.is_done}
    again |= {tally.task for tally in earlier.tallies if tally.done or tally.by_hand}
    undone = [name for name in rest.needed if name not in failed]
    missing = [
        *_failures(mission, failed, windows),
        *_named(VerdictCode.NOT_DONE, [name for name in undone if name not in again]),
        *_named(VerdictCode.NOT_DONE_AGAIN, [name for name in undone if name in again]),
    ]
    if limit is not None and now > limit:
        missing.append(VerdictPart(code=VerdictCode.TOO_LATE, times=(now, limit)))
    if docked is False and last.ended:
        assert area is not None
        missing.append(_not_docked(last, docks, area))
    by_itself = outcome is not None and outcome is not Outcome.FAILED
    success = by_itself and rest.known and not missing
    if success:
        parts = _success_parts(mission, log.tasks, trace, visits, failed, earlier, early, rest)
    else:
        gave_up, is_returned = early is not None and last.ended, outcome is Outcome.RETURNED
        parts = (
            *([early] if early else []),
            *(_read_parts(mission, log, trace, earlier) if gave_up else []),
            *missing,
            *(_docked_parts(area) if gave_up and docked and not is_returned else []),
            *_named(VerdictCode.REACHED_ALL_THE_SAME, rest.reached),
            *_named(VerdictCode.OPTIONAL_NOT_DONE, rest.optional),
            *_named(VerdictCode.SKIPPED, _by_hand(trace, skipped=True)),
        )
    return Result(
        success=success,
        ended=last.ended,
        verdict=verdict_text(parts),
        parts=parts,
        outcome=outcome,
        duration=now,
        max_duration=limit,
        within_max_duration=limit is None or now <= limit,
        docked=docked,
        distance=round(last.distance, DIGITS),
        climbed=round(last.climbed, DIGITS),
    )


def _early_end(
    outcome: Outcome | None, last: Entry, trace: Sequence[TraceEntry]
) -> VerdictPart | None:
    """Return why the mission did not come to its end; None if it did."""
    if outcome is None:
        if not last.ended:
            return VerdictPart(code=VerdictCode.NOT_ENDED, times=(last.t,))
        return last.stopped or VerdictPart(code=VerdictCode.STOPPED, times=(last.t,))
    if outcome not in _ENDINGS:
        return None
    ends = (e for e in reversed(trace) if e.cause in _END_CAUSES and e.target is None)
    entry = next(ends, None)
    return VerdictPart(code=_ENDINGS[outcome], event=entry and entry.event)


def _rest_of(mission: Mission, machine: Machine, last: Entry) -> _Rest:
    """Return what the mission had still to do when it was ended, or its run was stopped.

    WAITs that only join transitions do not count, nor do tasks that a person has done in advance.
    If only drives remained, to where the robot is now, they count as done.
    """
    names = machine.remaining_tasks
    if names is None:
        return _Rest(known=False)
    given = {done.task for done in machine.progress().by_hand}
    tasks = [t for name in names if name not in given and (t := mission.task(name)) is not None]
    optional = tuple(task.name for task in tasks if task.optional)
    needed = [task for task in tasks if not (task.optional or is_junction(task))]
    if all(_is_reached(task, last) for task in needed):
        return _Rest(optional=optional, reached=tuple(task.name for task in needed))
    left = tuple(task.name for task in needed if not _is_reached(task, last))
    return _Rest(needed=left, optional=optional)


def _is_reached(task: Task, last: Entry) -> bool:
    """Return True if the task only drives to where the robot is, and may end now."""
    window = task.window
    in_window = window is None or (
        window.earliest <= last.t
        and (not window.hard or window.latest is None or last.t <= window.latest)
    )
    is_there = task.pose is not None and is_at_dock(last.body_pose, task.pose)
    return task.action is Action.WAYPOINT and is_there and in_window


def _failures(
    mission: Mission, failed: Sequence[str], windows: Sequence[WindowVisit]
) -> Iterator[VerdictPart]:
    """Yield parts that name the failed tasks that are not optional."""
    optional = {task.name for task in mission.tasks if task.optional}
    missed = {run.task for run in windows if run.kept is WindowOutcome.MISSED}
    needed = [name for name in failed if name not in optional]
    yield from _named(VerdictCode.FAILED, [name for name in needed if name not in missed])
    yield from _named(VerdictCode.WINDOW_MISSED, [name for name in needed if name in missed])


def _not_docked(last: Entry, docks: Mapping[int, Pose], area: int) -> VerdictPart:
    other = next((a for a, dock in docks.items() if is_at_dock(last.body_pose, dock)), None)
    if other is None:
        return VerdictPart(code=VerdictCode.NOT_DOCKED, numbers=(area,))
    return VerdictPart(code=VerdictCode.DOCKED_ELSEWHERE, numbers=(other, area))


def _docked_parts(area: int | None) -> Iterator[VerdictPart]:
    if area is not None:
        yield VerdictPart(code=VerdictCode.DOCKED, numbers=(area,))


def _read_parts(
    mission: Mission, log: RunLog, trace: Sequence[TraceEntry], earlier: Progress
) -> Iterator[VerdictPart]:
    """Yield a part that says which of the mission's checkpoints were read, if it has any."""
    done = {*_by_hand(trace, skipped=False), *(t.task for t in earlier.tallies if t.done)}
    read = {str(reading.checkpoint) for reading in log.readings}
    measured = [task for task in mission.tasks if task.action is Action.MEASURE]
    read |= {task.object_id for task in measured if task.object_id and task.name in done}
    asked = dict.fromkeys(task.object_id for task in measured if task.object_id)
    missing = tuple(id for id in asked if id not in read)
    if asked:
        numbers = (len(asked) - len(missing), len(asked))
        yield VerdictPart(code=VerdictCode.READ, names=missing, numbers=numbers)


def _success_parts(
    mission: Mission,
    runs: Sequence[TaskRun],
    trace: Sequence[TraceEntry],
    visits: Sequence[VisitRun],
    failed: Sequence[str],
    earlier: Progress,
    early: VerdictPart | None,
    rest: _Rest,
) -> tuple[VerdictPart, ...]:
    """Return the parts of the verdict of a successful mission.

    They name tasks that a condition passed over, that a person did or skipped, that were done
    before this run, and optional ones that failed; and what ended the mission before its end.
    """
    by_hand, skipped = _by_hand(trace, skipped=False), _by_hand(trace, skipped=True)
    done = {
        run.task for run in runs if run.outcome != "interrupted" and not run.by_hand
    } | RESERVED_NAMES
    ended = done.union(by_hand, skipped, (visit.task for visit in visits if visit.end is not None))
    ended |= {tally.task for tally in earlier.tallies}
    ended = ended.union(rest.reached, rest.optional)
    # From the mission: a restored machine has only the tasks that it can still reach.
    own_tasks = (task.name for task in mission.tasks if task.action is not Action.START)
    tallies = earlier.tallies
    parts = [
        *([VerdictPart(code=VerdictCode.NOTHING_GIVEN_UP), early] if early else []),
        *_named(VerdictCode.DONE_BEFORE, [t.task for t in tallies if t.done]),
        *_named(VerdictCode.BY_HAND_BEFORE, [t.task for t in tallies if t.by_hand]),
        *_named(VerdictCode.PASSED_OVER, [name for name in own_tasks if name not in ended]),
        *_named(VerdictCode.REACHED_ALL_THE_SAME, rest.reached),
        *_named(VerdictCode.BY_HAND, by_hand),
        *_named(VerdictCode.SKIPPED, skipped),
        *_named(VerdictCode.OPTIONAL_FAILED, failed),
        *_named(VerdictCode.OPTIONAL_NOT_DONE, rest.optional),
    ]
    if not parts:
        return (VerdictPart(code=VerdictCode.AS_PLANNED),)
    return tuple(parts) if early else (VerdictPart(code=VerdictCode.COMPLETED), *parts)


def _named(code: VerdictCode, names: Sequence[str]) -> Iterator[VerdictPart]:
    """Yield a part that names tasks, if there are any."""
    if names:
        yield VerdictPart(code=code, names=tuple(names))


def _failed_earlier(earlier: Progress, mission: Mission) -> Iterator[str]:
    """Yield the names of the tasks that failed before this run, which continues another one.

    A failed task that the mission no longer has is named only if `earlier.failed` says that a task
    that was not optional had failed: it may be that one.
    """
    for tally in earlier.tallies:
        if tally.failed and (mission.task(tally.task) is not None or earlier.failed):
            yield tally.task


def _by_hand(trace: Sequence[TraceEntry], *, skipped: bool) -> tuple[str, ...]:
    """Return the names of the tasks that a person did or, with `skipped`, skipped, in order."""
    tasks = (e.source for e in trace if e.by_hand and e.skipped is skipped and e.source)
    return tuple(dict.fromkeys(tasks))


def make_record(
    spec: RunSpec,
    setup: RunSetup,
    machine: Machine,
    log: RunLog,
    interruptions: InterruptionTracker,
) -> RunRecord:
    """Make the record of a run from its log, the state of its machine and the interruptions."""
    site = setup.navigator.site
    assert log.last is not None
    trace = tuple(machine.trace)
    progress = spec.beginning.progress if spec.beginning else Progress(active=None)
    visits = tuple(visits_from_trace(trace, progress.since))
    windows = visits_with_windows(spec.mission, visits, {tally.task for tally in progress.tallies})
    result = judge(
        spec.mission,
        site.docks,
        log,
        machine,
        visits,
        windows,
        progress,
    )
    return RunRecord(
        mission=spec.mission,
        hfsm=machine.hfsm,
        site=site.name,
        robot=setup.navigator.robot.name,
        drive=setup.drive.name,
        sensor=setup.sensor.name,
        seed=spec.seed,
        diagnostics=spec.diagnostics,
        result=result,
        tasks=tuple(log.tasks),
        readings=tuple(log.readings),
        contacts=tuple(sorted(log.contacts, key=lambda c: (c.start, c.link, c.element))),
        trace=tuple(
            TraceStep(t=e.time, source=e.source, target=e.target, cause=e.why) for e in trace
        ),
        path=tuple(log.path),
        interruptions=interruptions.interruptions(log.last.t),
        waits=wait_runs(spec.mission, visits, log.last.t),
        windows=windows,
        rounds=rounds_from_trace(trace),
        given_values=tuple(log.given_values),
        mishaps=tuple(log.mishaps),
        anomalies=tuple(log.anomalies),
        faults=setup.schedule.faults if setup.schedule else (),
        began=spec.beginning.mission_seconds_at_start if spec.beginning else 0.0,
        before=progress.tallies,
        resumed=tuple(log.resumed),
        reordering=spec.reordering,
    )
