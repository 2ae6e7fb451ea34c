"""Execution of an evaluation: runs are distributed to workers, and their rows are stored."""

import logging
import math
import os
import threading
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from argo_compiler.base.errors import ArgoError
from argo_compiler.base.message import Message
from argo_env.evaluation.case import EvaluationCase, PlanName
from argo_env.evaluation.estimates.rates import Stratum, allocate_runs
from argo_env.evaluation.plan import EvaluationPlan, PlannedRun
from argo_env.evaluation.pool.backend import WorkerBackend
from argo_env.evaluation.pool.pool import CompletedCall, Pool
from argo_env.evaluation.rates import should_stop
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.row import RunOutcome, RunRow, make_empty_row, make_row
from argo_env.evaluation.store import RowStore
from argo_env.planning.opening import OpenedSite, open_site
from argo_env.robot.spec import load_robot
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec

TOOK_TOO_LONG = 70
"""exit code of a worker whose run exceeded its limit of wall time"""


@dataclass(frozen=True)
class WorkOrder:
    """Run that a worker is to execute, with all that goes into its row."""

    key: str
    """key of the row"""
    case: EvaluationCase
    spec: RunSpec
    world: dict[str, float]
    """values that were drawn for the run's world, by name"""
    drawn: str = ""
    """name of the faults that were drawn for the run's world; empty if none are drawn"""
    limit: float | None = None
    """s of wall time after which the worker process ends itself, which becomes the run's reason;
    None: no limit"""


def execute_run(order: WorkOrder, site: OpenedSite | None = None) -> RunRow:
    """Execute the run of a work order and return its row.

    The site is the one that the spec names, unless one is given. An error of the simulator is an
    outcome too: one of many thousand runs must not end the evaluation.
    """
    row = _row(order, site)
    return row.model_copy(update={"world": order.world, "drawn": order.drawn})


def _row(order: WorkOrder, site: OpenedSite | None) -> RunRow:
    watchdog = None
    if order.limit is not None:
        watchdog = threading.Timer(order.limit, os._exit, (TOOK_TOO_LONG,))
        watchdog.daemon = True
        watchdog.start()
    try:
        opened = site or open_site(order.spec.site, load_robot(order.spec.robot))
        record = simulate(order.spec, opened)
        return make_row(order.key, order.case, order.spec, record, opened.site)
    except ArgoError as error:
        return make_empty_row(order.key, order.case, order.spec, RunOutcome.ERROR, str(error))
    except Exception as error:  # the row reports it, with its location in the code
        frame = traceback.extract_tb(error.__traceback__)[-1]
        place = Message(
            "{basename}, line {lineno}",
            basename=os.path.basename(frame.filename),
            lineno=frame.lineno,
        )
        reason = f"{type(error).__name__}: {error} ({place})"
        return make_empty_row(order.key, order.case, order.spec, RunOutcome.ERROR, reason)
    finally:
        if watchdog is not None:
            watchdog.cancel()


_log = logging.getLogger(__name__)
_COMPACT_AT = 5_000
"""number of rows in the log at which they are moved to a Parquet file"""


@dataclass(frozen=True)
class EvaluationProgress:
    """Progress of an evaluation at one moment."""

    outcomes: Mapping[PlanName, Counter[RunOutcome]]
    """number of ended runs by outcome, for each plan"""
    max_runs: int
    """largest number of runs that the evaluation can have"""
    stored_runs: int
    """number of ended runs whose rows were in the store before"""
    seconds: float
    """s since the start of the execution"""

    @property
    def completed_runs(self) -> int:
        """Number of runs that have ended, also those whose rows were stored before."""
        return sum(counts.total() for counts in self.outcomes.values())

    @property
    def longest_remaining_seconds(self) -> float | None:
        """Remaining time in s at the present pace if no rule stops the runs; None at first."""
        executed = self.completed_runs - self.stored_runs
        return (self.max_runs - self.completed_runs) * self.seconds / executed if executed else None

    @property
    def all_outcomes(self) -> Counter[RunOutcome]:
        """Number of ended runs by outcome, over all plans."""
        return sum(self.outcomes.values(), start=Counter())


class EvaluationRunner:
    """Executor of an evaluation's runs that are not in the store yet.

    It holds the rows of all ended runs of the evaluation, and adds new ones to the store.
    """

    def __init__(
        self,
        plan: EvaluationPlan,
        backend: WorkerBackend,
        store: RowStore | None = None,
        *,
        limit: float | None = None,
        call: Callable[[WorkOrder], RunRow] = execute_run,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Prepare the execution of the evaluation plan.

        `limit` is the longest wall time of a run in s (None: no limit); a longer run is ended and
        counts as not carried out. `call` is the function that executes a run in a worker. The
        caller closes back end and store. Raises ArgoError for an invalid plan.
        """
        plan.check()
        self._plan = plan
        self._pool = Pool(backend, call)
        self._store = store
        self._limit = limit
        self._clock = clock
        self._start_time = clock()
        self._from_store = 0
        self._positions: dict[str, int] = {}
        self._rows: list[RunRow] = []
        self._outcomes: dict[PlanName, Counter[RunOutcome]] = {p: Counter() for p in plan.plans}

    @property
    def progress(self) -> EvaluationProgress:
        """Progress of the evaluation at this moment."""
        per_seed = 1 if self._plan.strata else len(self._plan.cases)
        return EvaluationProgress(
            {plan: counts.copy() for plan, counts in self._outcomes.items()},
            len(self._plan.seeds) * per_seed,
            self._from_store,
            self._clock() - self._start_time,
        )

    @property
    def results(self) -> EvaluationResults:
        """Results so far, in the order of the evaluation plan, whatever order the runs ended in."""
        rows = sorted(self._rows, key=lambda row: self._positions[row.key])
        return EvaluationResults(self._plan, tuple(rows))

    def rows_as_completed(self) -> Iterator[RunRow]:
        """Execute the runs until the rule to stop ends them; yield their rows as they end.

        Stored runs are not repeated; in each batch, their rows come first.
        Moves the rows of the store to a Parquet file at the end.
        """
        for batch in batches_until_stop(self._plan, self._rows):
            yield from self._run_batch(batch)
        if self._store is not None:
            self._store.compact()

    def _run_batch(self, runs: Iterator[PlannedRun]) -> Iterator[RunRow]:
        missing: list[tuple[PlannedRun, str]] = []
        for run in runs:
            key = self._plan.key(run)
            self._positions[key] = len(self._positions)
            row = self._store.rows.get(key) if self._store is not None else None
            if row is None:
                missing.append((run, key))
                continue
            self._from_store += 1
            yield self._count(row)
        pending = iter(missing)
        for finished in self._as_completed(pending):
            row = self._row_for(finished)
            if self._store is not None:
                self._store.add_if_new(row)
                if self._store.uncompacted >= _COMPACT_AT:
                    self._store.compact()
            yield self._count(row)

    def _count(self, row: RunRow) -> RunRow:
        self._rows.append(row)
        self._outcomes[row.plan][row.outcome] += 1
        return row

    def _as_completed(self, runs: Iterator[tuple[PlannedRun, str]]) -> Iterator[CompletedCall]:
        self._fill_pool(runs)
        for finished in self._pool.as_completed():
            self._fill_pool(runs)
            yield finished

    def _fill_pool(self, runs: Iterator[tuple[PlannedRun, str]]) -> None:
        while self._pool.needs_calls:
            next_run = next(runs, None)
            if next_run is None:
                return
            run, key = next_run
            self._pool.submit(
                (run, key),
                WorkOrder(
                    key,
                    self._plan.cases[run.case],
                    run.spec,
                    self._plan.variation.values_for(run.seed),
                    self._plan.drawn_faults(run.seed),
                    self._limit,
                ),
            )

    def _row_for(self, finished: CompletedCall) -> RunRow:
        run, key = finished.ticket
        if isinstance(finished.value, RunRow):
            return finished.value
        outcome, reason = RunOutcome.DIED, finished.died
        if reason is not None and reason.endswith(f"code {TOOK_TOO_LONG}"):
            reason = Message("the run took longer than its time limit")
        if reason is None:
            # It couldn't be sent to a worker or back; each run gets a row, whatever went wrong.
            outcome, reason = RunOutcome.ERROR, f"{type(finished.error).__name__}: {finished.error}"
        _log.warning("run %s, seed %d: %s", key, run.seed, reason)
        row = make_empty_row(key, self._plan.cases[run.case], run.spec, outcome, reason)
        return row.model_copy(
            update={
                "world": self._plan.variation.values_for(run.seed),
                "drawn": self._plan.drawn_faults(run.seed),
            }
        )


def batches_until_stop(
    plan: EvaluationPlan, rows_so_far: Sequence[RunRow]
) -> Iterator[Iterator[PlannedRun]]:
    """Yield the runs of an evaluation in batches.

    The caller must have added the rows of all previous batches to `rows_so_far` when it takes the
    next batch: they decide whether the evaluation stops. So that does not depend on which run was
    the quickest.
    """
    if plan.strata:
        yield from _by_strata(plan, rows_so_far)
        return
    stopping = plan.stopping
    if stopping.width is None and not stopping.require:
        yield plan.runs()
        return
    for first in range(0, len(plan.seeds), stopping.every):
        if first and should_stop(plan, rows_so_far):
            return
        yield plan.runs(plan.seeds[first : first + stopping.every])


def _by_strata(plan: EvaluationPlan, rows: Sequence[RunRow]) -> Iterator[Iterator[PlannedRun]]:
    """Yield a first batch with equally many runs of each case, then batches by Neyman allocation.

    No seed is used twice, so that the strata are independent of each other.
    """
    seeds = iter(plan.seeds)
    remaining = len(plan.seeds)
    cases = len(plan.cases)
    counts = (plan.stopping.every,) * cases
    while remaining:
        runs: list[PlannedRun] = []
        for case, count in enumerate(counts):
            for _ in range(min(count, remaining)):
                runs.append(plan.planned_run(case, next(seeds)))
                remaining -= 1
        yield iter(runs)
        if plan.stopping.width is not None and should_stop(plan, rows):
            return
        counts = allocate_runs(_strata(plan, rows), min(remaining, plan.stopping.every * cases))


def _strata(plan: EvaluationPlan, rows: Sequence[RunRow]) -> list[Stratum]:
    total_weight = math.fsum(case.weight for case in plan.cases)
    strata = []
    for case in plan.cases:
        ran = [row for row in rows if row.faults == case.faults and row.is_completed]
        successes = sum(row.success for row in ran)
        strata.append(Stratum(case.weight / total_weight, successes, len(ran)))
    return strata
