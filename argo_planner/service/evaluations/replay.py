"""Replays of an evaluation's runs: a run with the same spec gives the same result."""

from datetime import datetime
from pathlib import Path

from argo_compiler.base.errors import NotFound
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_env.evaluation.folder import find_stored_plan
from argo_env.evaluation.store import read_rows
from argo_env.run.log import Entry
from argo_env.run.machine import Machine
from argo_env.run.observer import Observer
from argo_env.run.session import simulate
from argo_planner.service.jobs.evaluation import EvaluationSpec
from argo_planner.service.processes.job_process import ReportProgress
from argo_planner.service.runs.state import RunState, RunStatus


class ReplayedRun(Model):
    """Run of an evaluation with all its entries."""

    state: RunState
    """state at the end of the run; its `id` is the key of the run"""
    entries: tuple[Entry, ...]


class ReplayRequest(Model):
    """Request to replay a run, with the evaluation that it belongs to."""

    key: str
    plan: str
    """id of the mission plan"""
    revision: int
    by: str
    begun: datetime
    evaluation: EvaluationSpec


class _EntryCollector(Observer):
    """Observer that collects all entries of a run."""

    def __init__(self) -> None:
        self.entries: list[Entry] = []

    def on_entry_applied(self, entry: Entry, machine: Machine) -> None:  # noqa: ARG002
        self.entries.append(entry)


def replay_run(request: ReplayRequest, folder: Path, report: ReportProgress) -> ReplayedRun:  # noqa: ARG001
    """Execute again the run with the request's key, of the evaluation in `folder`.

    Raises NotFound if the evaluation has no such run, or the errors of the run.
    """
    plan = find_stored_plan(folder)
    row = next((row for row in read_rows(folder) if row.key == request.key), None)
    if plan is None or row is None:
        raise NotFound(Message("the evaluation has no run {key}", key=repr(request.key[:40])))
    case = next(k for k, case in enumerate(plan.cases) if case.faults == row.faults)
    spec = plan.planned_run(case, row.seed).spec
    collector = _EntryCollector()
    record = simulate(spec, request.evaluation.open_site(), observers=(collector,))
    last = record.path[-1] if record.path else None
    readings = {reading.checkpoint: reading for reading in record.readings}
    state = RunState(
        id=request.key,
        plan=request.plan,
        revision=request.revision,
        name=request.evaluation.name,
        by=request.by,
        begun=request.begun,
        status=RunStatus.ENDED,
        drive=spec.drive,
        sensor=spec.sensor,
        seed=spec.seed,
        speed=None,
        t=record.result.duration,
        max_duration=record.result.max_duration,
        readings=tuple(readings.values()),
        charge=None if last is None else last.charge,
        entries=len(collector.entries),
        headline=record.headline,
    )
    return ReplayedRun(state=state, entries=tuple(collector.entries))
