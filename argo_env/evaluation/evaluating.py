"""An evaluation under way: runs are handed out and carried out in whatever process, rows come back
and are kept."""

import logging
import os
import threading
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from argo_compiler.base.errors import ArgoError
from argo_env.evaluation.case import EvaluationCase, PlanName
from argo_env.evaluation.estimates.rates import Stratum, allocation
from argo_env.evaluation.plan import EvaluationPlan, PlannedRun
from argo_env.evaluation.pool.backend import WorkerBackend
from argo_env.evaluation.pool.pool import Finished, Pool
from argo_env.evaluation.rates import is_enough
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.row import RunOutcome, RunRow, row_of, row_without_end
from argo_env.evaluation.store import RowStore
from argo_env.planning.opening import OpenedSite, open_site
from argo_env.robot.spec import load_robot
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec

TOOK_TOO_LONG = 70
"""exit code of a worker whose run took longer than it may"""


@dataclass(frozen=True)
class WorkOrder:
    """What a worker is told: a run, and the key that its row has."""

    key: str
    case: EvaluationCase
    spec: RunSpec
    world: dict[str, float]
    """what was drawn for its world"""
    drawn: str = ""
    """what the faults are called that were"""
    limit: float | None = None
    """s of wall time that it may take; then its process ends, and that is its reason"""


def carry_out(order: WorkOrder, site: OpenedSite | None = None) -> RunRow:
    """Makes the run, on the site that it names unless one is given, and its row. What goes wrong in
    the simulator is an outcome as well: one of many thousand runs must not end them all."""
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
        return row_of(order.key, order.case, order.spec, record, opened.site)
    except ArgoError as error:
        return row_without_end(order.key, order.case, order.spec, RunOutcome.ERROR, str(error))
    except Exception as error:  # told in the row, with its place
        frame = traceback.extract_tb(error.__traceback__)[-1]
        place = f"{os.path.basename(frame.filename)}, line {frame.lineno}"
        reason = f"{type(error).__name__}: {error} ({place})"
        return row_without_end(order.key, order.case, order.spec, RunOutcome.ERROR, reason)
    finally:
        if watchdog is not None:
            watchdog.cancel()


_log = logging.getLogger(__name__)
_COMPACTED = 5_000
"""rows in the log from which on they are moved to a Parquet file"""


@dataclass(frozen=True)
class EvaluationProgress:
    """How far an evaluation is."""

    outcomes: Mapping[PlanName, Counter[RunOutcome]]
    """how the runs ended that have, of each plan"""
    most: int
    """runs that there are at most"""
    known: int
    """of the runs that have ended, those that had before"""
    seconds: float
    """that it has taken"""

    @property
    def done(self) -> int:
        """Runs that have ended."""
        return sum(counts.total() for counts in self.outcomes.values())

    @property
    def remaining(self) -> float | None:
        """s that it takes at most, if it goes on as fast; None: not known yet."""
        made = self.done - self.known
        return (self.most - self.done) * self.seconds / made if made else None

    @property
    def all_outcomes(self) -> Counter[RunOutcome]:
        """How the runs of all plans ended."""
        return sum(self.outcomes.values(), start=Counter())


class Evaluating:
    """Makes the runs of a plan that are not in the store yet. Holds the rows that count."""

    def __init__(
        self,
        plan: EvaluationPlan,
        backend: WorkerBackend,
        store: RowStore | None = None,
        *,
        limit: float | None = None,
        call: Callable[[WorkOrder], RunRow] = carry_out,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """`limit` (s of wall time) is what a run may take; `call` is what carries it out, in a
        worker. Closes neither back end nor store.

        Raises ArgoError for a plan that makes no sense.
        """
        plan.check()
        self._plan = plan
        self._pool = Pool(backend, call)
        self._store = store
        self._limit = limit
        self._clock = clock
        self._begun = clock()
        self._known = 0
        self._order: dict[str, int] = {}
        self._rows: list[RunRow] = []
        self._outcomes: dict[PlanName, Counter[RunOutcome]] = {p: Counter() for p in plan.plans}

    @property
    def progress(self) -> EvaluationProgress:
        """How far it is."""
        per_seed = 1 if self._plan.strata else len(self._plan.cases)
        return EvaluationProgress(
            {plan: counts.copy() for plan, counts in self._outcomes.items()},
            len(self._plan.seeds) * per_seed,
            self._known,
            self._clock() - self._begun,
        )

    @property
    def results(self) -> EvaluationResults:
        """What has come of it, in the order of the plan, whichever run came first."""
        rows = sorted(self._rows, key=lambda row: self._order[row.key])
        return EvaluationResults(self._plan, tuple(rows))

    def rows_as_they_come(self) -> Iterator[RunRow]:
        """Makes all runs, and gives their rows; those that were there before come first."""
        for batch in batches(self._plan, self._rows):
            yield from self._carried_out(batch)
        if self._store is not None:
            self._store.compact()

    def _carried_out(self, runs: Iterator[PlannedRun]) -> Iterator[RunRow]:
        missing: list[tuple[PlannedRun, str]] = []
        for run in runs:
            key = self._plan.key(run)
            self._order[key] = len(self._order)
            row = self._store.rows.get(key) if self._store is not None else None
            if row is None:
                missing.append((run, key))
                continue
            self._known += 1
            yield self._counted(row)
        ahead = iter(missing)
        for finished in self._handed_out(ahead):
            row = self._row(finished)
            if self._store is not None:
                self._store.add(row)
                if self._store.loose >= _COMPACTED:
                    self._store.compact()
            yield self._counted(row)

    def _counted(self, row: RunRow) -> RunRow:
        self._rows.append(row)
        self._outcomes[row.plan][row.outcome] += 1
        return row

    def _handed_out(self, runs: Iterator[tuple[PlannedRun, str]]) -> Iterator[Finished]:
        self._fill(runs)
        for finished in self._pool.as_completed():
            self._fill(runs)
            yield finished

    def _fill(self, runs: Iterator[tuple[PlannedRun, str]]) -> None:
        while self._pool.wants_more:
            following = next(runs, None)
            if following is None:
                return
            run, key = following
            self._pool.submit(
                (run, key),
                WorkOrder(
                    key,
                    self._plan.cases[run.case],
                    run.spec,
                    self._plan.variation.drawn(run.seed),
                    self._plan.drawn_in(run.seed),
                    self._limit,
                ),
            )

    def _row(self, finished: Finished) -> RunRow:
        run, key = finished.ticket
        if isinstance(finished.value, RunRow):
            return finished.value
        outcome, reason = RunOutcome.DIED, finished.died
        if reason is not None and reason.endswith(f"code {TOOK_TOO_LONG}"):
            reason = "the run took longer than it may"
        if reason is None:
            # What can't be sent to a worker or back: whatever goes wrong in a run is a row.
            outcome, reason = RunOutcome.ERROR, f"{type(finished.error).__name__}: {finished.error}"
        _log.warning("run %s, seed %d: %s", key, run.seed, reason)
        row = row_without_end(key, self._plan.cases[run.case], run.spec, outcome, reason)
        return row.model_copy(
            update={
                "world": self._plan.variation.drawn(run.seed),
                "drawn": self._plan.drawn_in(run.seed),
            }
        )


def batches(plan: EvaluationPlan, rows: Sequence[RunRow]) -> Iterator[Iterator[PlannedRun]]:
    """The runs of an evaluation, in batches. `rows` has those of all batches before when the next
    one is asked for, so that what is decided does not depend on which run was the quickest."""
    if plan.strata:
        yield from _by_strata(plan, rows)
        return
    stopping = plan.stopping
    if stopping.width is None and not stopping.require:
        yield plan.runs()
        return
    for first in range(0, len(plan.seeds), stopping.every):
        if first and is_enough(plan, rows):
            return
        yield plan.runs(plan.seeds[first : first + stopping.every])


def _by_strata(plan: EvaluationPlan, rows: Sequence[RunRow]) -> Iterator[Iterator[PlannedRun]]:
    """First as many runs of each case, then where they tell most. No seed is used twice, so that
    the strata know nothing of each other."""
    seeds = iter(plan.seeds)
    left = len(plan.seeds)
    cases = len(plan.cases)
    shares = (plan.stopping.every,) * cases
    while left:
        runs: list[PlannedRun] = []
        for case, share in enumerate(shares):
            for _ in range(min(share, left)):
                runs.append(plan.run(case, next(seeds)))
                left -= 1
        yield iter(runs)
        if plan.stopping.width is not None and is_enough(plan, rows):
            return
        shares = allocation(_strata(plan, rows), min(left, plan.stopping.every * cases))


def _strata(plan: EvaluationPlan, rows: Sequence[RunRow]) -> list[Stratum]:
    whole = sum(case.weight for case in plan.cases)
    found = []
    for case in plan.cases:
        ran = [row for row in rows if row.faults == case.faults and row.carried_out]
        done = sum(row.success for row in ran)
        found.append(Stratum(case.weight / whole, done, len(ran)))
    return found
