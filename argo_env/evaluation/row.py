"""Rows of an evaluation: the stored result of each run."""

import math
from enum import StrEnum

from pydantic import Field

from argo_compiler.base.model import Model
from argo_compiler.il import Action
from argo_env.evaluation.case import EvaluationCase, PlanName
from argo_env.evaluation.detection import FaultDetection, detections, false_alarms
from argo_env.run.record import RunRecord
from argo_env.run.spec import RunSpec
from argo_env.run.verdict import VerdictPart
from argo_env.site import Site
from argo_env.site.shapes import Vector

_COUNTED_ACTIONS = (Action.MEASURE, Action.WAYPOINT)


class RunOutcome(StrEnum):
    """Outcome of a run; only success and failure say something about the evaluated plan."""

    SUCCESS = "success"
    FAILURE = "failure"
    """the mission failed"""
    ERROR = "error"
    """the simulator failed"""
    DIED = "died"
    """the worker process died at each attempt"""


class RunRow(Model):
    """Stored result of a run; equal runs have equal rows, on any worker or machine."""

    key: str
    mission: str
    policy: str
    site: str
    robot: str
    drive: str
    sensor: str
    faults: str
    """name of the case's set of faults"""
    seed: int
    outcome: RunOutcome
    reason: str
    """what is missing or went wrong; the verdict of a successful run"""
    verdict: tuple[VerdictPart, ...] = ()
    """the same as data; empty if the run could not be carried out, and in old rows"""
    duration: float | None = None
    """s of simulated time, like all times"""
    limit: float | None = None
    """maximum duration of the mission in s"""
    distance: float | None = None
    """driven distance in m"""
    climbed: float | None = None
    """m"""
    charge: float | None = None
    """charge of the battery at the end, 0 to 1"""
    docked: bool | None = None
    tasks: int = 0
    """number of the mission's measurements and waypoints"""
    done: int = 0
    """number of these tasks that were done"""
    failed: tuple[str, ...] = ()
    """names of the tasks that failed for good"""
    readings: int = 0
    abnormal: int = 0
    """number of readings outside their nominal range"""
    findings: int = 0
    false_alarms: int = 0
    """number of false findings, which neither a fault nor the values, battery, drive or camera of
    this world explain, and of all-clears while what was found went on"""
    contacts: int = 0
    mishaps: int = 0
    late: int = 0
    """number of tasks that ended after their time windows"""
    detections: tuple[FaultDetection, ...] = ()
    task: str | None = None
    """first task that failed, or the last task if none did; None for a success"""
    place: Vector | None = None
    """position of the robot in m when that task failed or the run ended; None for a success"""
    floor: int | None = None
    drawn: str = ""
    """name of the faults drawn for the world of this seed; empty if the evaluation draws none"""
    world: dict[str, float] = Field(default_factory=dict)
    """values drawn for the world of this seed, by name"""

    @property
    def plan(self) -> PlanName:
        return PlanName(self.mission, self.policy, self.site, self.robot, self.drive, self.sensor)

    @property
    def success(self) -> bool:
        return self.outcome is RunOutcome.SUCCESS

    @property
    def is_completed(self) -> bool:
        """True if the run was carried out to its end, with success or failure of the mission."""
        return self.outcome in (RunOutcome.SUCCESS, RunOutcome.FAILURE)

    @property
    def is_stranded(self) -> bool:
        """True if the robot stands with an empty battery at the end."""
        return self.charge is not None and self.charge <= 0.0


def make_row(
    key: str, case: EvaluationCase, spec: RunSpec, record: RunRecord, site: Site
) -> RunRow:
    """Return the row of a run that was carried out on the site."""
    result = record.result
    counted = {task.name for task in record.mission.tasks if task.action in _COUNTED_ACTIONS}
    done = {run.task for run in record.tasks if run.outcome == "done"}
    done.update(result.reached_all_the_same)
    last = record.path[-1] if record.path else None
    failed = tuple(dict.fromkeys(r.task for r in record.tasks if r.outcome == "failed"))
    row = make_empty_row(key, case, spec, RunOutcome.FAILURE, result.verdict)
    return row.model_copy(
        update={
            "verdict": result.parts,
            "outcome": RunOutcome.SUCCESS if result.success else RunOutcome.FAILURE,
            "duration": result.duration,
            "limit": result.max_duration,
            "distance": round(result.distance, 3),
            "climbed": round(result.climbed, 3),
            "charge": None if last is None else last.charge,
            "docked": result.docked,
            "tasks": len(counted),
            "done": len(done & counted),
            "failed": failed,
            "readings": len(record.readings),
            "abnormal": sum(not reading.normal for reading in record.readings),
            "findings": len(record.findings),
            "false_alarms": false_alarms(record, spec, site),
            "contacts": len(record.contacts),
            "mishaps": len(record.mishaps),
            "late": len(record.visits_ended_late),
            "detections": detections(record, site),
            **({} if result.success else _failure_fields(record)),
        }
    )


def make_empty_row(
    key: str, case: EvaluationCase, spec: RunSpec, outcome: RunOutcome, reason: str
) -> RunRow:
    """Return a row without measured values, for a run that has none or for `make_row` to complete.

    `reason` states what is missing for success, or what went wrong.
    """
    return RunRow(
        key=key,
        mission=case.mission,
        policy=case.policy,
        site=spec.site,
        robot=spec.robot,
        drive=spec.drive,
        sensor=spec.sensor,
        faults=case.faults,
        seed=spec.seed,
        outcome=outcome,
        reason=reason,
    )


def _failure_fields(record: RunRecord) -> dict[str, object]:
    """Return the fields of a failed run's row that say where it failed.

    These are the first failed task and the robot's position when it failed, or else the last task
    and the position at the end of the run.
    """
    first = next((run for run in record.tasks if run.outcome == "failed"), None)
    last = record.tasks[-1].task if record.tasks else None
    task, t = (first.task, first.end) if first else (last, math.inf)
    sample = next((s for s in record.path if s.t >= t), record.path[-1] if record.path else None)
    if sample is None:
        return {"task": task}
    return {"task": task, "place": (sample.x, sample.y, sample.z), "floor": sample.floor}
