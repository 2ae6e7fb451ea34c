"""Evaluation of a mission: its runs in many worlds, in separate processes."""

import hashlib
import logging
import os
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

from pydantic import Field, field_validator, model_validator

from argo_compiler.base.errors import Invalid, NotFound
from argo_compiler.base.message import Listing, Message
from argo_compiler.base.model import Model
from argo_compiler.base.operating_system import niceness, set_niceness
from argo_compiler.il import Mission
from argo_env.evaluation.case import NO_FAULTS
from argo_env.evaluation.evaluation import Evaluation
from argo_env.evaluation.folder import (
    digest_contents,
    find_stored_plan,
    replace_failing_specs,
    write_plan,
)
from argo_env.evaluation.plan import EvaluationPlan
from argo_env.evaluation.pool.backends import make_backend
from argo_env.evaluation.requirement import parse_requirement
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.row import RunRow
from argo_env.evaluation.runner import EvaluationRunner, WorkOrder, execute_run
from argo_env.evaluation.store import RowStore, read_rows
from argo_env.evaluation.worlds import NO_VARIATION, Variation
from argo_env.faults.kinds import AnyFault
from argo_env.planning.opening import OpenedSite, open_site
from argo_env.run.drives_and_sensors import IDEAL, KINEMATIC, ROUTE
from argo_env.worker_processes import context_with
from argo_planner.service.jobs.evaluation_status import EvaluationStanding, RunCount
from argo_planner.service.processes.job_process import ReportProgress
from argo_planner.service.world.obstacles import Obstacle, with_obstacles

_log = logging.getLogger(__name__)
MOST_WORLDS = 10_000
MOST_RUNS = 100_000
_PERIOD = 0.25  # s between two reports of the progress
_MORE_NICENESS = 10  # the service and the robot's run have priority
_LONGEST_RUN = 600.0  # s of wall time; a longer run counts as one whose process has died


class EvaluationAsked(Model):
    """Request for an evaluation: the worlds in which a mission is to be run, and the run setup."""

    drive: str | None = Field(default=None, max_length=40)
    """drive of the runs; None: `kinematic` if a fault or the sensor needs a world, else `route`"""
    sensor: str = Field(default=IDEAL, max_length=40)
    worlds: int = Field(default=100, ge=1, le=MOST_WORLDS)
    """number of worlds; each case is run in each world"""
    first_seed: int = Field(default=0, ge=0, le=2**31)
    """seed of the first world; the others have the seeds that follow"""
    without_faults: bool = True
    """whether the mission is also run without faults"""
    faults: tuple[AnyFault, ...] = Field(default=(), max_length=50)
    """faults, each one alone in its own runs"""
    variation: Variation = NO_VARIATION
    """quantities that differ from world to world"""
    require: tuple[str, ...] = Field(default=(), max_length=5)
    """requirements such as `success >= 0.98`; the evaluation stops when they are decided"""
    width: float | None = Field(default=None, gt=0, lt=1)
    """width of the rate's interval, 0 to 1, at which the evaluation stops; None: no such limit"""

    @property
    def used_drive(self) -> str:
        """The drive of the runs: the given one, or the one that the faults and the sensor need."""
        if self.drive is not None:
            return self.drive
        needs_world = self.sensor != IDEAL or any(fault.needs_world for fault in self.faults)
        return KINEMATIC if needs_world else ROUTE

    @field_validator("require")
    @classmethod
    def _check_requirements(cls, require: tuple[str, ...]) -> tuple[str, ...]:
        for text in require:
            try:
                parse_requirement(text)
            except Invalid as error:
                raise ValueError(str(error)) from None
        return require

    @model_validator(mode="after")
    def _check_runs(self) -> "EvaluationAsked":
        cases = len(self.faults) + self.without_faults
        if cases == 0:
            raise ValueError("nothing is to be run: add faults, or allow runs without faults")
        if cases * self.worlds > MOST_RUNS:
            raise ValueError(f"{cases * self.worlds} runs are too many: at most {MOST_RUNS}")
        return self


class EvaluationSpec(Model):
    """All data that an evaluation depends on: the mission, the site, and the request."""

    name: str
    """name of the mission, for people"""
    mission: Mission
    site: str
    """reference that opens the site"""
    obstacles: tuple[Obstacle, ...] = ()
    """obstacles on the site"""
    asked: EvaluationAsked

    def open_site(self) -> OpenedSite:
        """Open the site with its obstacles; raises ArgoError if that fails."""
        return _open_with_obstacles(self.site, self.obstacles)

    def make_plan(self, site: OpenedSite) -> EvaluationPlan:
        """Return the plan of all runs; raises ArgoError if something can't be run on the site."""
        asked = self.asked
        sets: dict[str, Sequence[AnyFault]] = {NO_FAULTS: ()} if asked.without_faults else {}
        sets.update(_fault_sets(asked.faults))
        evaluation = Evaluation(
            {self.name: self.mission},
            site,
            faults=sets,
            seeds=range(asked.first_seed, asked.first_seed + asked.worlds),
            drive=asked.used_drive,
            sensor=asked.sensor,
            worlds=asked.variation,
            require=asked.require,
            width=asked.width,
            name=self.name,
        )
        if not self.obstacles:
            return evaluation.plan
        # Runs with other obstacles are different runs and need different keys.
        content = "".join(obstacle.model_dump_json() for obstacle in self.obstacles)
        obstacles_digest = hashlib.sha256(content.encode()).hexdigest()
        cases = tuple(
            case.model_copy(update={"digest": f"{case.digest} {obstacles_digest}"})
            for case in evaluation.plan.cases
        )
        added = Listing(obstacle.name or obstacle.id for obstacle in self.obstacles)
        return evaluation.plan.with_changes(
            cases=cases, added=Message("obstacles: {added}", added=added)
        )


def evaluate_mission(
    spec: EvaluationSpec, folder: Path, report: ReportProgress
) -> EvaluationStanding:
    """Execute the runs that have no row in the folder yet, and return the final results.

    It ends before all runs are executed if the requirements of `spec` are decided, or the rates
    are known to the width that `spec` asks for. `report` is called with the progress. At the end,
    early or not, the folder has the rows, the report and, if `spec` has no obstacles, the specs of
    the failed runs. Raises ArgoError if something can't be run at all, or the folder can't be
    written.
    """
    from argo_env.evaluation.report.page import write_evaluation_report  # matplotlib

    set_niceness(niceness() + _MORE_NICENESS)
    # If this process is killed, its semaphores remain: loky's helper removes them. Its warning
    # about them is not needed.
    os.environ["PYTHONWARNINGS"] = "ignore:resource_tracker:UserWarning"
    plan = spec.make_plan(spec.open_site())
    write_plan(folder, plan, digest_contents(spec.model_dump_json().encode()))
    count = RunCount(plan)
    call = partial(_execute_run, spec.site, spec.obstacles)
    # Workers are forked from a process that has loaded fewer modules than the service.
    workers = make_backend(context=context_with(__name__))
    with RowStore(folder) as store:
        if store.loss:
            _log.warning("%s: the lost runs are repeated", store.loss)
        try:
            runner = EvaluationRunner(plan, workers, store, limit=_LONGEST_RUN, call=call)
            last_report, stored = -_PERIOD, len(store.rows)
            for row in runner.rows_as_completed():
                count.add(row)
                # Stored rows are counted before the first report.
                stored_counted = runner.progress.completed_runs >= stored
                if stored_counted and time.monotonic() - last_report >= _PERIOD:
                    report(count.interim_standing(runner.progress))
                    last_report = time.monotonic()
        finally:
            workers.close()
    results = runner.results
    final = count.final_standing(results)
    report(final)
    if not spec.obstacles:
        replace_failing_specs(folder, results)
    write_evaluation_report(folder, results)
    return final


def read_partial_results(folder: Path) -> tuple[EvaluationStanding, EvaluationResults] | None:
    """Return the results of an evaluation that was ended early, from the rows in its folder.

    The first item is for the job: the progress, and the results so far. The second one is for the
    report. Returns None if no run has been stored. Raises ArgoError if the rows can't be read.
    """
    plan = find_stored_plan(folder)
    try:
        rows = read_rows(folder)
    except NotFound:
        rows = ()
    if plan is None or not rows:
        return None
    count, results = RunCount(plan), EvaluationResults.from_worlds_before_first_gap(plan, rows)
    positions = {seed: k for k, seed in enumerate(plan.seeds)}
    for row in sorted(rows, key=lambda row: (positions[row.seed], plan.case_index(row) or 0)):
        count.add(row)
    return count.final_standing(results), results


def write_partial_report(folder: Path, report: ReportProgress) -> None:  # noqa: ARG001
    """Write the report of an evaluation that was ended early into its folder, from the rows there.

    Raises NotFound if there are no rows, as none of its runs has ended.
    """
    from argo_env.evaluation.report.page import write_evaluation_report

    partial_results = read_partial_results(folder)
    if partial_results is None:
        raise NotFound("no run of the evaluation has ended yet: there is nothing to report")
    write_evaluation_report(folder, partial_results[1])


def _execute_run(site: str, obstacles: tuple[Obstacle, ...], order: WorkOrder) -> RunRow:
    """Execute one run in a worker."""
    return execute_run(order, _open_with_obstacles(site, obstacles))


def _open_with_obstacles(site: str, obstacles: tuple[Obstacle, ...]) -> OpenedSite:
    return with_obstacles(open_site(site), obstacles)


def _fault_sets(faults: Sequence[AnyFault]) -> Iterator[tuple[str, Sequence[AnyFault]]]:
    """Yield a named set of one fault for each fault.

    The name is the fault's kind, with a number if the kind occurs more than once.
    """
    kinds = Counter(fault.kind for fault in faults)
    seen: Counter[str] = Counter()
    for fault in faults:
        seen[fault.kind] += 1
        name = fault.kind if kinds[fault.kind] == 1 else f"{fault.kind} {seen[fault.kind]}"
        yield name, (fault,)
