"""Verdict of a run, success or what is missing, and the record of the run.

`verdict_line.py` makes the headline that people see.
"""

from collections.abc import Iterator, Mapping, Sequence

from argo_compiler.base.model import Pose
from argo_compiler.hfsm import Cause, Outcome, Progress, TraceEntry
from argo_compiler.il import Action, Mission
from argo_compiler.il.docked import is_at_dock
from argo_compiler.il.reserved import RESERVED_NAMES
from argo_env.formatting import distinct_time_texts, rounded_time_text
from argo_env.run.log import RunLog
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
from argo_env.run.verdict_line import AS_PLANNED
from argo_env.run.visits_and_rounds import (
    InterruptionTracker,
    VisitRun,
    rounds_from_trace,
    visits_from_trace,
    visits_with_windows,
    wait_runs,
)

_ENDINGS = {
    Outcome.RETURNED: "the mission was aborted, and the robot returned to its dock",
    Outcome.SHELTERED: "the mission was aborted, and the robot went to a safe area",
    Outcome.FAILED: (
        "the mission was aborted, and the robot did not reach the place where it should wait"
    ),
    Outcome.ABORTED: "the mission was aborted",
    Outcome.CANCELLED: "the mission was cancelled by a person",
}


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
    outcome: Outcome | None,
    trace: Sequence[TraceEntry],
    visits: Sequence[VisitRun],
    windows: Sequence[WindowVisit],
    earlier: Progress,
) -> Result:
    """Determine the result of a mission.

    Args:
        mission: the mission.
        docks: poses of the docks by number of their starting area.
        log: the run's log.
        outcome: outcome of the machine; None: the run was stopped before, or still goes on.
        trace: the machine's trace.
        visits: the visits of tasks.
        windows: the outcomes of the tasks' time windows.
        earlier: progress of the mission before this run.
    """
    last = log.last
    assert last is not None
    now, limit, area = last.t, mission.max_duration, mission.end_area
    docked = None if area is None else is_at_dock(last.body_pose, docks[area])
    missing = []
    if outcome is None and not last.ended:
        missing.append(f"the mission has not ended after {rounded_time_text(now)}")
    elif outcome is None:
        missing.append(last.stopped or f"it was stopped after {rounded_time_text(now)}")
    elif outcome in _ENDINGS:
        missing.append(_ENDINGS[outcome])
    optional = {task.name for task in mission.tasks if task.optional}
    failed = tuple(
        dict.fromkeys(
            (
                *_failed_earlier(earlier, mission),
                *tasks_with_unretried_failure(log.tasks, trace, visits),
            )
        )
    )
    needed = [name for name in failed if name not in optional]
    missed = {run.task for run in windows if run.kept is WindowOutcome.MISSED}
    for failure, names in (
        ("failed", [name for name in needed if name not in missed]),
        ("missed the time window", [name for name in needed if name in missed]),
    ):
        if names:
            missing.append(f"{failure}: {', '.join(names)}")
    if limit is not None and now > limit:
        took, most = distinct_time_texts(now, limit)
        missing.append(f"it took {took} of at most {most}")
    if docked is False and last.ended:
        other = next((a for a, dock in docks.items() if is_at_dock(last.body_pose, dock)), None)
        missing.append(
            f"the robot is not docked in starting area {area}"
            if other is None
            else f"the robot is docked in starting area {other}, not in {area}"
        )
    success = not missing
    skipped = _by_hand(trace, skipped=True)
    if skipped and not success:
        missing.append(f"skipped by a person: {', '.join(skipped)}")
    return Result(
        success=success,
        ended=last.ended,
        verdict=_success_verdict(mission, log.tasks, trace, visits, failed, earlier)
        if success
        else "; ".join(missing),
        outcome=outcome,
        duration=now,
        max_duration=limit,
        within_max_duration=limit is None or now <= limit,
        docked=docked,
        distance=round(last.distance, DIGITS),
        climbed=round(last.climbed, DIGITS),
    )


def _success_verdict(
    mission: Mission,
    runs: Sequence[TaskRun],
    trace: Sequence[TraceEntry],
    visits: Sequence[VisitRun],
    failed: Sequence[str],
    earlier: Progress,
) -> str:
    """Return the verdict of a successful mission, as text.

    The text names tasks that a condition passed over, that a person did or skipped, that were done
    before this run, and optional ones that failed.
    """
    by_hand, skipped = _by_hand(trace, skipped=False), _by_hand(trace, skipped=True)
    done = {
        run.task for run in runs if run.outcome != "interrupted" and not run.by_hand
    } | RESERVED_NAMES
    ended = done.union(by_hand, skipped, (visit.task for visit in visits if visit.end is not None))
    ended |= {tally.task for tally in earlier.tallies}
    # From the mission: a restored machine has only the tasks that it can still reach.
    own_tasks = (task.name for task in mission.tasks if task.action is not Action.START)
    passed_over = [name for name in own_tasks if name not in ended]
    parts = ["the mission was completed"]
    if names := [tally.task for tally in earlier.tallies if tally.done]:
        parts.append(f"done before this run: {', '.join(names)}")
    if names := [tally.task for tally in earlier.tallies if tally.by_hand]:
        parts.append(f"done by hand or skipped before this run: {', '.join(names)}")
    if passed_over:
        parts.append(f"passed over: {', '.join(passed_over)}")
    if by_hand:
        parts.append(f"done by hand: {', '.join(by_hand)}")
    if skipped:
        parts.append(f"skipped by a person: {', '.join(skipped)}")
    if failed:
        parts.append(f"optional tasks that failed: {', '.join(failed)}")
    return "; ".join(parts) if len(parts) > 1 else AS_PLANNED


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
        machine.outcome if machine.finished else None,
        trace,
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
