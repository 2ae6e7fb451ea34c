"""A row of results: what is kept of a run."""

import math
from enum import StrEnum

from pydantic import Field

from argo_compiler.base.model import Model
from argo_compiler.il import Action
from argo_env.evaluation.case import EvaluationCase, PlanName
from argo_env.evaluation.detection import FaultDetection, detections, false_alarms
from argo_env.run.record import RunRecord
from argo_env.run.spec import RunSpec
from argo_env.site import Site
from argo_env.site.shapes import Vector

_CARRIED_OUT = (Action.MEASURE, Action.WAYPOINT)


class RunOutcome(StrEnum):
    """How a run ended. Only the first two tell anything of the plan."""

    SUCCESS = "success"
    FAILURE = "failure"
    """the mission failed"""
    ERROR = "error"
    """the simulator failed"""
    DIED = "died"
    """the process that carried it out died, each time that it was tried"""


class RunRow(Model):
    """What is kept of a run. Equal runs have equal rows, wherever they are carried out."""

    key: str
    mission: str
    policy: str
    site: str
    robot: str
    drive: str
    sensor: str
    faults: str
    """of the case, by their name"""
    seed: int
    outcome: RunOutcome
    reason: str
    """what is missing, or went wrong; of a success the verdict"""
    duration: float | None = None
    """s of simulated time, as are all times"""
    limit: float | None = None
    """s, the mission's maximum duration"""
    distance: float | None = None
    """m"""
    climbed: float | None = None
    """m"""
    charge: float | None = None
    """of the battery, at the end, 0 to 1"""
    docked: bool | None = None
    tasks: int = 0
    """of the mission that the robot carries out"""
    done: int = 0
    """tasks that were done"""
    failed: tuple[str, ...] = ()
    """tasks that failed for good"""
    readings: int = 0
    abnormal: int = 0
    """readings outside their nominal range"""
    findings: int = 0
    false_alarms: int = 0
    """findings that were not so: neither a fault nor the values, charge or speed of this world
    account for them"""
    contacts: int = 0
    mishaps: int = 0
    late: int = 0
    """tasks that ended after their time windows"""
    detections: tuple[FaultDetection, ...] = ()
    task: str | None = None
    """of a failure: the task at which it failed, or was when it ended"""
    place: Vector | None = None
    """m, of a failure: where the robot was then"""
    floor: int | None = None
    drawn: str = ""
    """what the faults are called that were drawn for the world of this seed; empty: none are drawn
    in this evaluation"""
    world: dict[str, float] = Field(default_factory=dict)
    """what was drawn for the world of this seed"""

    @property
    def plan(self) -> PlanName:
        return PlanName(self.mission, self.policy, self.site, self.robot, self.drive, self.sensor)

    @property
    def success(self) -> bool:
        return self.outcome is RunOutcome.SUCCESS

    @property
    def carried_out(self) -> bool:
        """Whether the run came to an end that tells something of the plan."""
        return self.outcome in (RunOutcome.SUCCESS, RunOutcome.FAILURE)


def row_of(key: str, case: EvaluationCase, spec: RunSpec, record: RunRecord, site: Site) -> RunRow:
    """The row of a run that was carried out on the site."""
    result = record.result
    asked = {task.name for task in record.mission.tasks if task.action in _CARRIED_OUT}
    done = {run.task for run in record.tasks if run.outcome == "done"}
    last = record.path[-1] if record.path else None
    failed = tuple(dict.fromkeys(r.task for r in record.tasks if r.outcome == "failed"))
    row = row_without_end(key, case, spec, RunOutcome.FAILURE, result.verdict)
    return row.model_copy(
        update={
            "outcome": RunOutcome.SUCCESS if result.success else RunOutcome.FAILURE,
            "duration": result.duration,
            "limit": result.max_duration,
            "distance": round(result.distance, 3),
            "climbed": round(result.climbed, 3),
            "charge": None if last is None else last.charge,
            "docked": result.docked,
            "tasks": len(asked),
            "done": len(done & asked),
            "failed": failed,
            "readings": len(record.readings),
            "abnormal": sum(not reading.normal for reading in record.readings),
            "findings": len(record.findings),
            "false_alarms": false_alarms(record, spec, site),
            "contacts": len(record.contacts),
            "mishaps": len(record.mishaps),
            "late": len(record.late),
            "detections": detections(record, site),
            **({} if result.success else _where_it_failed(record)),
        }
    )


def row_without_end(
    key: str, case: EvaluationCase, spec: RunSpec, outcome: RunOutcome, reason: str
) -> RunRow:
    """The row of a run that could not be carried out, or of which no more is known yet."""
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


def _where_it_failed(record: RunRecord) -> dict[str, object]:
    """The first task that failed and where the robot was at its end; else where it all ended."""
    first = next((run for run in record.tasks if run.outcome == "failed"), None)
    last = record.tasks[-1].task if record.tasks else None
    task, t = (first.task, first.end) if first else (last, math.inf)
    seen = next((s for s in record.path if s.t >= t), record.path[-1] if record.path else None)
    if seen is None:
        return {"task": task}
    return {"task": task, "place": (seen.x, seen.y, seen.z), "floor": seen.floor}
