"""The evaluation of a mission: it is run in many worlds, in processes of its own."""

import hashlib
import os
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

from pydantic import Field, field_validator, model_validator

from argo_compiler.base.errors import Invalid, NotFound
from argo_compiler.base.model import Model
from argo_compiler.il import Mission
from argo_env.evaluation.case import NO_FAULTS
from argo_env.evaluation.evaluation import Evaluation
from argo_env.evaluation.folder import digest_contents, read_plan, write_failing_specs, write_plan
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
from argo_env.run.drives_and_sensors import IDEAL, ROUTE
from argo_env.worker_processes import context_with
from argo_planner.service.jobs.standing import EvaluationStanding, RunCount
from argo_planner.service.processes.work import Tell
from argo_planner.service.world.obstacles import Obstacle, with_obstacles

MOST_WORLDS = 10_000
MOST_RUNS = 100_000
_PERIOD = 0.25  # s between two times that it is told how it stands
_NICE = 10  # the service, and the run of the robot, go first
_LONGEST_RUN = 600.0  # s of wall time, after which a run counts as died


class EvaluationAsked(Model):
    """In which worlds a mission is to be run, and how."""

    drive: str = Field(default=ROUTE, max_length=40)
    sensor: str = Field(default=IDEAL, max_length=40)
    worlds: int = Field(default=100, ge=1, le=MOST_WORLDS)
    """how many; in each one all is run"""
    first_seed: int = Field(default=0, ge=0, le=2**31)
    """the worlds are those of this seed and of the next ones"""
    without_faults: bool = True
    """whether it is run also where nothing goes wrong"""
    faults: tuple[AnyFault, ...] = Field(default=(), max_length=50)
    """each goes wrong by itself, in runs of its own"""
    variation: Variation = NO_VARIATION
    """what differs from world to world"""
    require: tuple[str, ...] = Field(default=(), max_length=5)
    """what must hold, such as `success >= 0.98`; it stops when that is decided"""
    width: float | None = Field(default=None, gt=0, lt=1)
    """it stops when the interval of the rate is no wider than this"""

    @field_validator("require")
    @classmethod
    def _understood(cls, require: tuple[str, ...]) -> tuple[str, ...]:
        for text in require:
            try:
                parse_requirement(text)
            except Invalid as error:
                raise ValueError(str(error)) from None
        return require

    @model_validator(mode="after")
    def _runs(self) -> "EvaluationAsked":
        cases = len(self.faults) + self.without_faults
        if cases == 0:
            raise ValueError("nothing is to be run: give faults, or let it run without faults")
        if cases * self.worlds > MOST_RUNS:
            raise ValueError(f"{cases * self.worlds} runs are too many: at most {MOST_RUNS}")
        return self


class EvaluationOrder(Model):
    """A mission that is to be evaluated, and where."""

    name: str
    """of the mission, for people"""
    mission: Mission
    site: str
    """what opens it"""
    obstacles: tuple[Obstacle, ...] = ()
    """that stand on the site"""
    asked: EvaluationAsked

    def opened(self) -> OpenedSite:
        """The site with its obstacles. Raises ArgoError."""
        return _opened(self.site, self.obstacles)

    def plan(self, site: OpenedSite) -> EvaluationPlan:
        """All that is to be run. Raises ArgoError for what can't be run on the site."""
        asked = self.asked
        sets: dict[str, Sequence[AnyFault]] = {NO_FAULTS: ()} if asked.without_faults else {}
        sets.update(_named(asked.faults))
        evaluation = Evaluation(
            {self.name: self.mission},
            site,
            faults=sets,
            seeds=range(asked.first_seed, asked.first_seed + asked.worlds),
            drive=asked.drive,
            sensor=asked.sensor,
            worlds=asked.variation,
            require=asked.require,
            width=asked.width,
            name=self.name,
        )
        if not self.obstacles:
            return evaluation.plan
        # Runs among other obstacles are other runs, and known by other keys.
        said = "".join(obstacle.model_dump_json() for obstacle in self.obstacles)
        among = hashlib.sha256(said.encode()).hexdigest()
        cases = tuple(
            case.model_copy(update={"digest": f"{case.digest} {among}"})
            for case in evaluation.plan.cases
        )
        added = ", ".join(obstacle.name or obstacle.id for obstacle in self.obstacles)
        return evaluation.plan.with_changes(cases=cases, added=f"obstacles: {added}")


def evaluate_mission(order: EvaluationOrder, folder: Path, tell: Tell) -> EvaluationStanding:
    """Makes all runs that are not in the folder yet and tells how it stands; at the end the folder
    has the rows, the report, and what each run that failed is made again from.

    Raises ArgoError if something can't be run at all, or the folder can't be written.
    """
    from argo_env.evaluation.report.page import write_evaluation_report  # matplotlib

    os.nice(_NICE)
    # Who ends this process leaves semaphores behind: loky's helper clears them away, and need not
    # say so.
    os.environ["PYTHONWARNINGS"] = "ignore:resource_tracker:UserWarning"
    plan = order.plan(order.opened())
    write_plan(folder, plan, digest_contents(order.model_dump_json().encode()))
    standing = RunCount(plan)
    call = partial(_carried_out, order.site, order.obstacles)
    # Forked from a process that has loaded less than the one of the service.
    workers = make_backend(context=context_with(__name__))
    with RowStore(folder) as store:
        try:
            evaluating = EvaluationRunner(plan, workers, store, limit=_LONGEST_RUN, call=call)
            told, before = -_PERIOD, len(store.rows)
            for row in evaluating.rows_as_completed():
                standing.add(row)
                # What was known before is counted before anything is told.
                known = evaluating.progress.completed_runs >= before
                if known and time.monotonic() - told >= _PERIOD:
                    tell(standing.under_way(evaluating.progress))
                    told = time.monotonic()
        finally:
            workers.close()
    results = evaluating.results
    final = standing.ended(results)
    tell(final)
    if not order.obstacles:
        write_failing_specs(folder, results)
    write_evaluation_report(folder, results)
    return final


def cut_short(folder: Path) -> tuple[EvaluationStanding, EvaluationResults] | None:
    """How the evaluation in a folder stands that was ended before its time, and what came of it; of
    one of which there are no rows, None. Raises ArgoError where they can't be read."""
    plan = read_plan(folder)
    try:
        rows = read_rows(folder)
    except NotFound:
        rows = ()
    if plan is None or not rows:
        return None
    count, results = RunCount(plan), EvaluationResults.from_partial_rows(plan, rows)
    places = {seed: k for k, seed in enumerate(plan.seeds)}
    for row in sorted(rows, key=lambda row: (places[row.seed], plan.case_index(row) or 0)):
        count.add(row)
    return count.ended(results), results


def report_so_far(folder: Path, tell: Tell) -> None:  # noqa: ARG001
    """Writes the report of an evaluation that was ended before its time. Raises NotFound if no run
    of it has ended."""
    from argo_env.evaluation.report.page import write_evaluation_report

    found = cut_short(folder)
    if found is None:
        raise NotFound("no run of the evaluation has ended yet: there is nothing to report")
    write_evaluation_report(folder, found[1])


def _carried_out(site: str, obstacles: tuple[Obstacle, ...], order: WorkOrder) -> RunRow:
    """One run, in a worker."""
    return execute_run(order, _opened(site, obstacles))


def _opened(site: str, obstacles: tuple[Obstacle, ...]) -> OpenedSite:
    return with_obstacles(open_site(site), obstacles)


def _named(faults: Sequence[AnyFault]) -> Iterator[tuple[str, Sequence[AnyFault]]]:
    """Sets of one fault each, which are called by their kinds, and numbered where one is there
    more than once."""
    kinds = Counter(fault.kind for fault in faults)
    seen: Counter[str] = Counter()
    for fault in faults:
        seen[fault.kind] += 1
        name = fault.kind if kinds[fault.kind] == 1 else f"{fault.kind} {seen[fault.kind]}"
        yield name, (fault,)
