"""From a run that has ended to its record."""

from argo_compiler.diagnostics import Diagnostic
from argo_compiler.hfsm import Executor, Hfsm
from argo_compiler.il import Mission
from argo_env.faults.kinds import AnyFault
from argo_env.run.action import Rig
from argo_env.run.log import RunLog
from argo_env.run.record import Interruption, RunRecord, TraceStep
from argo_env.run.verdict import failed_tasks, judge


def make_record(
    mission: Mission,
    hfsm: Hfsm,
    rig: Rig,
    seed: int,
    diagnostics: tuple[Diagnostic, ...],
    log: RunLog,
    executor: Executor,
    interruptions: tuple[Interruption, ...],
    faults: tuple[AnyFault, ...],
) -> RunRecord:
    """The record of a run with this log, whose machine stands like this."""
    site = rig.navigator.site
    result = judge(
        mission,
        hfsm,
        site.docks,
        log,
        executor.outcome if executor.finished else None,
        failed_tasks(log.tasks, executor.trace),
    )
    return RunRecord(
        mission=mission,
        hfsm=hfsm,
        site=site.name,
        robot=rig.navigator.robot.name,
        drive=rig.drive.name,
        sensor=rig.sensor.name,
        seed=seed,
        diagnostics=diagnostics,
        result=result,
        tasks=tuple(log.tasks),
        readings=tuple(log.readings),
        contacts=tuple(sorted(log.contacts, key=lambda c: (c.start, c.link, c.element))),
        trace=tuple(
            TraceStep(t=e.time, source=e.source, target=e.target, cause=e.why)
            for e in executor.trace
        ),
        path=tuple(log.path),
        interruptions=interruptions,
        mishaps=tuple(log.mishaps),
        anomalies=tuple(log.anomalies),
        faults=faults,
        resumed=tuple(log.resumed),
    )
