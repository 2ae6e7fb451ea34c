"""The verdict, whether the mission is a success and what is missing if it is not; and the record of
the run.

`verdict_line.py` makes the line of it that people see.
"""

from collections.abc import Iterator, Mapping, Sequence

from argo_compiler.base.model import Pose
from argo_compiler.hfsm import Cause, Outcome, Progress, TraceEntry
from argo_compiler.il import Action, Mission
from argo_compiler.il.docked import at_dock
from argo_compiler.il.reserved import RESERVED_NAMES
from argo_env.formatting import told_apart
from argo_env.run.log import RunLog
from argo_env.run.machine import Machine
from argo_env.run.record import (
    DIGITS,
    Result,
    RunRecord,
    TaskRun,
    TraceStep,
    WindowOutcome,
    WindowRun,
)
from argo_env.run.run_setup import RunSetup
from argo_env.run.spec import RunSpec
from argo_env.run.verdict_line import AS_PLANNED
from argo_env.run.visits_and_rounds import (
    InterruptionTracker,
    RoundTracker,
    Visit,
    visits_from_trace,
    wait_runs,
    window_runs,
)

_ENDINGS = {
    Outcome.RETURNED: "the mission was given up, and the robot returned to its dock",
    Outcome.SHELTERED: "the mission was given up, and the robot went to a safe area",
    Outcome.FAILED: "the mission was given up, and the robot did not get to where it should wait",
    Outcome.ABORTED: "the mission was aborted",
    Outcome.CANCELLED: "the mission was cancelled by a person",
}


def failed_tasks(
    runs: Sequence[TaskRun], trace: Sequence[TraceEntry], visits: Sequence[Visit]
) -> tuple[str, ...]:
    """The tasks that failed for good, by name and in order."""
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
    visits: Sequence[Visit],
    windows: Sequence[WindowRun],
    before: Progress,
) -> Result:
    """How the mission ended: the machine with `outcome`, by the steps of its `trace`, the visits of
    tasks and what came of their windows; and by what had come of it `before` this run.

    An `outcome` of None is that of a run that was stopped before, or is still under way.
    """
    last = log.last
    assert last is not None
    now, limit, area = last.t, mission.max_duration, mission.end_area
    docked = None if area is None else at_dock(last.body_pose, docks[area])
    missing = []
    if outcome is None and not last.ended:
        missing.append(f"the mission is not at its end after {now:.0f} s")
    elif outcome is None:
        missing.append(last.stopped or f"it was stopped after {now:.0f} s")
    elif outcome in _ENDINGS:
        missing.append(_ENDINGS[outcome])
    optional = {task.name for task in mission.tasks if task.optional}
    failed = tuple(
        dict.fromkeys((*_failed_before(before, mission), *failed_tasks(log.tasks, trace, visits)))
    )
    needed = [name for name in failed if name not in optional]
    missed = {run.task for run in windows if run.kept is WindowOutcome.MISSED}
    for what, names in (
        ("failed", [name for name in needed if name not in missed]),
        ("missed the time window", [name for name in needed if name in missed]),
    ):
        if names:
            missing.append(f"{what}: {', '.join(names)}")
    if limit is not None and now > limit:
        took, most = told_apart(now, limit)
        missing.append(f"it took {took} s of at most {most} s")
    if docked is False and last.ended:
        other = next((a for a, dock in docks.items() if at_dock(last.body_pose, dock)), None)
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
        verdict=_praise(mission, log.tasks, trace, visits, failed, before)
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


def _praise(
    mission: Mission,
    runs: Sequence[TaskRun],
    trace: Sequence[TraceEntry],
    visits: Sequence[Visit],
    failed: Sequence[str],
    before: Progress,
) -> str:
    """The verdict of a success: a plan with conditions may pass tasks over, a person may have done
    or skipped some, and optional ones may have failed."""
    by_hand, skipped = _by_hand(trace, skipped=False), _by_hand(trace, skipped=True)
    done = {
        run.task for run in runs if run.outcome != "interrupted" and not run.by_hand
    } | RESERVED_NAMES
    ended = done.union(by_hand, skipped, (visit.task for visit in visits if visit.end is not None))
    ended |= {tally.task for tally in before.tallies}
    # Of all tasks: a machine that was restored has only those that it could still come to.
    own_tasks = (task.name for task in mission.tasks if task.action is not Action.START)
    passed_over = [name for name in own_tasks if name not in ended]
    said = ["the plan was carried out"]
    if earlier := [tally.task for tally in before.tallies if tally.done]:
        said.append(f"done before this run: {', '.join(earlier)}")
    if earlier := [tally.task for tally in before.tallies if tally.by_hand]:
        said.append(f"done by hand or skipped before this run: {', '.join(earlier)}")
    if passed_over:
        said.append(f"it led past {', '.join(passed_over)}")
    if by_hand:
        said.append(f"done by hand: {', '.join(by_hand)}")
    if skipped:
        said.append(f"skipped by a person: {', '.join(skipped)}")
    if failed:
        said.append(f"failed, and optional: {', '.join(failed)}")
    return "; ".join(said) if len(said) > 1 else AS_PLANNED


def _failed_before(before: Progress, mission: Mission) -> Iterator[str]:
    """The tasks that had failed for good. One that the plan does not have any more counts if the
    mission does: nobody can say of it alone whether it was optional."""
    for tally in before.tallies:
        if tally.failed and (mission.task(tally.task) is not None or before.failed):
            yield tally.task


def _by_hand(trace: Sequence[TraceEntry], *, skipped: bool) -> tuple[str, ...]:
    """The tasks that a person did in place of the machine, or skipped, in this order."""
    found = (e.source for e in trace if e.by_hand and e.skipped is skipped and e.source)
    return tuple(dict.fromkeys(found))


def make_record(
    spec: RunSpec,
    setup: RunSetup,
    machine: Machine,
    log: RunLog,
    interruptions: InterruptionTracker,
    rounds: RoundTracker,
) -> RunRecord:
    """The record of a run with this log, whose machine stands like this."""
    site = setup.navigator.site
    assert log.last is not None
    trace = tuple(machine.trace)
    progress = spec.beginning.progress if spec.beginning else Progress(active=None)
    visits = tuple(visits_from_trace(trace, progress.since))
    windows = window_runs(spec.mission, visits, {tally.task for tally in progress.tallies})
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
        interruptions=interruptions.all(log.last.t),
        waits=wait_runs(spec.mission, visits, log.last.t),
        windows=windows,
        rounds=rounds.all(),
        given_values=tuple(log.given_values),
        mishaps=tuple(log.mishaps),
        anomalies=tuple(log.anomalies),
        faults=setup.schedule.faults if setup.schedule else (),
        began=spec.beginning.at if spec.beginning else 0.0,
        before=progress.tallies,
        resumed=tuple(log.resumed),
        reordering=spec.reordering,
    )
