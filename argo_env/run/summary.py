"""From how a run stands to its record."""

from argo_compiler.hfsm import Progress
from argo_env.run.log import RunLog
from argo_env.run.machine import Machine
from argo_env.run.record import RunRecord, TraceStep
from argo_env.run.rig import Rig
from argo_env.run.spec import RunSpec
from argo_env.run.stays import InterruptionWatch, RoundWatch, stays_of, waits_of, windows_of
from argo_env.run.verdict import judge


def make_record(
    spec: RunSpec,
    rig: Rig,
    machine: Machine,
    log: RunLog,
    interruptions: InterruptionWatch,
    rounds: RoundWatch,
) -> RunRecord:
    """The record of a run with this log, whose machine stands like this."""
    site = rig.navigator.site
    assert log.last is not None
    trace = tuple(machine.trace)
    progress = spec.beginning.progress if spec.beginning else Progress(active=None)
    stays = tuple(stays_of(trace, progress.since))
    windows = windows_of(spec.mission, stays, {tally.task for tally in progress.tallies})
    result = judge(
        spec.mission,
        site.docks,
        log,
        machine.outcome if machine.finished else None,
        trace,
        stays,
        windows,
        progress,
    )
    return RunRecord(
        mission=spec.mission,
        hfsm=machine.hfsm,
        site=site.name,
        robot=rig.navigator.robot.name,
        drive=rig.drive.name,
        sensor=rig.sensor.name,
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
        waits=waits_of(spec.mission, stays, log.last.t),
        windows=windows,
        rounds=rounds.all(),
        given_values=tuple(log.given_values),
        mishaps=tuple(log.mishaps),
        anomalies=tuple(log.anomalies),
        faults=rig.schedule.faults if rig.schedule else (),
        began=spec.beginning.at if spec.beginning else 0.0,
        before=progress.tallies,
        resumed=tuple(log.resumed),
        reordering=spec.reordering,
    )
