"""Runs of an evaluation, made once more to be looked at: equal specs give equal runs."""

from datetime import datetime
from pathlib import Path

from argo_compiler.base.errors import NotFound
from argo_compiler.base.model import Model
from argo_env.evaluation.folder import read_plan
from argo_env.evaluation.store import read_rows
from argo_env.run.log import Entry
from argo_env.run.machine import Machine
from argo_env.run.observer import Observer
from argo_env.run.session import simulate
from argo_planner.service.jobs.evaluation import EvaluationOrder
from argo_planner.service.processes.work import Tell
from argo_planner.service.runs.state import RunState, RunStatus


class ReplayedRun(Model):
    """A run of an evaluation as it went."""

    state: RunState
    """how it stood at its end; its `id` is the key of the run"""
    entries: tuple[Entry, ...]


class ReplayOrder(Model):
    """Which run is to be made again, and of what it was one."""

    key: str
    plan: str
    """id of the mission"""
    revision: int
    by: str
    begun: datetime
    evaluation: EvaluationOrder


class _Entries(Observer):
    """Keeps all that happens."""

    def __init__(self) -> None:
        self.entries: list[Entry] = []

    def on_change(self, entry: Entry, machine: Machine) -> None:  # noqa: ARG002
        self.entries.append(entry)


def replay_run(order: ReplayOrder, folder: Path, tell: Tell) -> ReplayedRun:  # noqa: ARG001
    """Makes a run of the evaluation in the folder once more.

    Raises NotFound if it has no such run, ArgoError as the run does.
    """
    plan = read_plan(folder)
    row = next((row for row in read_rows(folder) if row.key == order.key), None)
    if plan is None or row is None:
        raise NotFound(f"the evaluation has no run {order.key[:40]!r}")
    case = next(k for k, case in enumerate(plan.cases) if case.faults == row.faults)
    spec = plan.run(case, row.seed).spec
    seen = _Entries()
    record = simulate(spec, order.evaluation.opened(), observers=(seen,))
    last = record.path[-1] if record.path else None
    readings = {reading.checkpoint: reading for reading in record.readings}
    state = RunState(
        id=order.key,
        plan=order.plan,
        revision=order.revision,
        name=order.evaluation.name,
        by=order.by,
        begun=order.begun,
        status=RunStatus.ENDED,
        drive=spec.drive,
        sensor=spec.sensor,
        seed=spec.seed,
        speed=None,
        t=record.result.duration,
        max_duration=record.result.max_duration,
        readings=tuple(readings.values()),
        charge=None if last is None else last.charge,
        entries=len(seen.entries),
        headline=record.headline,
    )
    return ReplayedRun(state=state, entries=tuple(seen.entries))
