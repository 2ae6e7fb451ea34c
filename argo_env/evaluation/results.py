"""Results of an evaluation: rows, rates, durations of missions, and locations of failures."""

import html
import math
from bisect import bisect_left
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import accumulate
from typing import TYPE_CHECKING

from argo_env.evaluation.case import PlanName
from argo_env.evaluation.estimates.rates import Rate
from argo_env.evaluation.plan import EvaluationPlan
from argo_env.evaluation.quantities import QUANTITIES
from argo_env.evaluation.rates import (
    IntervalMethod,
    PlanRate,
    RequirementVerdict,
    estimate_plan_rate,
    estimate_run_rate,
    judge_requirements,
)
from argo_env.evaluation.row import RunOutcome, RunRow
from argo_env.site.shapes import Vector

if TYPE_CHECKING:
    import pandas

_MIN_BLOCK = 10  # seeds


@dataclass(frozen=True)
class GroupRate:
    """Success rate of a group of a plan's runs, with its interval."""

    plan: PlanName
    name: str
    rate: Rate
    outcomes: Counter[RunOutcome]
    method: IntervalMethod
    one_run_per_world: bool = True
    """whether the group has one run in each world; only then the interval is valid"""


@dataclass(frozen=True)
class EvaluationResults:
    """Rows of an evaluation, in the order of its plan, with the rates computed from them."""

    plan: EvaluationPlan
    rows: tuple[RunRow, ...]
    cut_short: bool = False
    """whether the evaluation ended before its plan did; the intervals are then valid whatever ended
    it"""

    def __repr__(self) -> str:
        """Return the name and the size, without the rows, of which there may be a million."""
        return (
            f"EvaluationResults({self.plan.name!r}: {len(self.rows)} rows of "
            f"{len(self.plan.cases)} cases in {len(self.plan.seeds)} worlds, "
            f"cut_short={self.cut_short})"
        )

    @staticmethod
    def from_worlds_before_first_gap(
        plan: EvaluationPlan, rows: Iterable[RunRow]
    ) -> "EvaluationResults":
        """Return the results of an evaluation that was cut short, from its rows so far.

        They have all worlds before the first world with a missing run. Later worlds are left out,
        as their outcomes depend on how long runs take.
        """
        by_world: dict[int, list[RunRow]] = defaultdict(list)
        for row in rows:
            by_world[row.seed].append(row)
        complete: list[RunRow] = []
        for seed in plan.seeds:
            world = by_world[seed]
            if len(world) < len(plan.cases):
                break
            complete += sorted(world, key=lambda row: plan.case_index(row) or 0)
        return EvaluationResults(plan, tuple(complete), cut_short=True)

    @cached_property
    def outcomes(self) -> Counter[RunOutcome]:
        """Number of runs by outcome, over all plans."""
        return Counter(row.outcome for row in self.rows)

    @property
    def lost(self) -> int:
        """Number of runs that could not be carried out, over all plans."""
        return self.outcomes[RunOutcome.ERROR] + self.outcomes[RunOutcome.DIED]

    @cached_property
    def unsuccessful_rows(self) -> tuple[RunRow, ...]:
        """Rows of all runs without success: failed, or not carried out."""
        return tuple(row for row in self.rows if not row.success)

    def rows_for(self, plan: PlanName) -> tuple[RunRow, ...]:
        """Return the rows of one evaluated plan."""
        return tuple(row for row in self.rows if row.plan == plan)

    def rate(self, plan: PlanName, quantity: str = "success") -> PlanRate:
        """Compute the rate of a quantity, by name, over a plan's runs, whatever their faults."""
        return estimate_plan_rate(self.plan, plan, self.rows, QUANTITIES[quantity], self.cut_short)

    @cached_property
    def verdicts(self) -> tuple[RequirementVerdict, ...]:
        """Verdict on each requirement for each plan, at the end of these rows."""
        return judge_requirements(self.plan, self.rows)

    def by_faults(self, plan: PlanName) -> tuple[GroupRate, ...]:
        """Compute a plan's success rates by set of faults."""
        plan_rows = self.rows_for(plan)
        names = dict.fromkeys(self.faults_for(row) for row in plan_rows)
        return tuple(
            self._group(plan, name, [row for row in plan_rows if self.faults_for(row) == name])
            for name in names
        )

    def faults_for(self, row: RunRow) -> str:
        """Return the name of a run's faults; see `EvaluationPlan.faults_for`."""
        return self.plan.faults_for(row.faults, row.seed)

    @cached_property
    def delays(self) -> dict[str, list[float | None]]:
        """Delays in s until the robot found each fault that occurred, by kind of fault.

        They are those of all runs; the delay is None for a fault that was not found.
        """
        delays: dict[str, list[float | None]] = {}
        for row in self.rows:
            for detection in row.detections:
                delays.setdefault(detection.fault, []).append(detection.delay)
        return dict(sorted(delays.items()))

    def by_seeds(self, plan: PlanName, max_blocks: int = 10) -> tuple[GroupRate, ...]:
        """Compute a plan's success rates in blocks of seeds; they should differ by chance only.

        There are at most `max_blocks` blocks, and each but the last has at least 10 seeds.
        """
        plan_rows = self.rows_for(plan)
        seeds = sorted({row.seed for row in plan_rows})
        size = max(_MIN_BLOCK, -(-len(seeds) // max_blocks))
        groups = []
        for first in range(0, len(seeds), size):
            block = seeds[first : first + size]
            rows = [row for row in plan_rows if block[0] <= row.seed <= block[-1]]
            name = str(block[0]) if len(block) == 1 else f"{block[0]} to {block[-1]}"
            groups.append(self._group(plan, name, rows))
        return tuple(groups)

    def _group(self, plan: PlanName, name: str, rows: Sequence[RunRow]) -> GroupRate:
        ran = [row.success for row in rows if row.is_completed]
        rate, method = estimate_run_rate(self.plan, ran, self.cut_short)
        one_run_per_world = len({row.seed for row in rows}) == len(rows)
        return GroupRate(
            plan, name, rate, Counter(row.outcome for row in rows), method, one_run_per_world
        )

    @cached_property
    def frame(self) -> "pandas.DataFrame":
        """Rows as a pandas table, one line each; values drawn for the world are `world.…`.

        `delay` is the time (s) from the beginning of a fault until it was found, the longest of the
        run's faults. It is missing if there were none, or if one of them was never found.
        """
        import pandas

        records = []
        for row in self.rows:
            record = row.model_dump(mode="json", exclude={"world", "detections", "place"})
            record["detected"] = QUANTITIES["detected"](row)
            record["delay"] = _longest_delay(row)
            record["x"], record["y"], record["z"] = row.place or (None, None, None)
            record.update({f"world.{name}": value for name, value in row.world.items()})
            records.append(record)
        return pandas.DataFrame(records)

    def _repr_html_(self) -> str:
        """Return the HTML table that notebooks show, with a line for each plan."""
        head = "".join(
            f"<th>{name}</th>" for name in ("plan", "runs", "success", "95 %", "failures", "lost")
        )
        lines = []
        for plan in self.plan.plans:
            rate = self.rate(plan)
            failures = sum(row.outcome is RunOutcome.FAILURE for row in self.rows_for(plan))
            cells = (
                html.escape(plan.label(self.plan.plans)),
                str(rate.runs),
                f"{rate.value:.1%}",
                f"{rate.low:.1%} to {rate.high:.1%}",
                str(failures),
                str(rate.lost),
            )
            lines.append("<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>")
        return f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(lines)}</tbody></table>"


@dataclass(frozen=True)
class DurationCurve:
    """Share of a plan's runs that have succeeded by each time (empirical distribution).

    A failed run never succeeds, so that the share may stay below 1.
    """

    plan: PlanName
    times: tuple[float, ...]
    """durations of the successful runs in s, ascending"""
    shares: tuple[float, ...]
    """share of all runs carried out that have succeeded by each of the times, 0 to 1"""
    limits: tuple[float, ...]
    """longest durations in s that the mission allows: one, or none"""

    @property
    def final_success_share(self) -> float:
        """Share of the runs that succeeded at any time, 0 to 1."""
        return self.shares[-1] if self.shares else 0.0

    def time_of_success_share(self, share: float) -> float | None:
        """Return the time in s by which this share (0 to 1) of the runs has succeeded.

        It is None if fewer runs succeed.
        """
        k = bisect_left(self.shares, share - 1e-9)
        return self.times[k] if k < len(self.times) else None


def duration_curve(results: EvaluationResults, plan: PlanName) -> DurationCurve:
    """Compute the share of a plan's runs that have succeeded by each time, weighted by case.

    All runs of a case together count by the weight of the case, however many they are. Runs that
    failed count as runs that never succeed. Cases without a completed run are left out.
    """
    ran = [row for row in results.rows_for(plan) if row.is_completed]
    weights = {case.faults: case.weight for case in results.plan.cases if case.plan == plan}
    runs_by_faults = {name: sum(row.faults == name for row in ran) for name in weights}
    total = math.fsum(weight for name, weight in weights.items() if runs_by_faults[name])
    weighted = sorted(
        (row.duration, weights[row.faults] / runs_by_faults[row.faults] / total)
        for row in ran
        if row.success and row.duration is not None
    )
    return DurationCurve(
        plan,
        tuple(time for time, _ in weighted),
        tuple(min(share, 1.0) for share in accumulate(share for _, share in weighted)),
        tuple(sorted({row.limit for row in ran if row.limit is not None})),
    )


_RADIUS = 0.5  # m, largest distance of a failure from the first one of its cluster


@dataclass
class FailureCluster:
    """Location where runs failed; it counts the failed runs by task."""

    floor: int
    at: Vector
    """position of the first failure in m; the others are at most half a metre away"""
    tasks: Counter[str] = field(default_factory=Counter)
    """number of failed runs by task"""

    @property
    def runs(self) -> int:
        """Number of runs that failed here."""
        return self.tasks.total()


def cluster_failures_by_location(rows: Iterable[RunRow]) -> tuple[FailureCluster, ...]:
    """Group unsuccessful runs by the location where they failed, sorted by floor.

    Each is at most half a metre from the first run of its cluster. Rows without a location are left
    out. On a floor, the cluster with the most failures comes first.
    """
    clusters: list[FailureCluster] = []
    for row in rows:
        if row.success or row.place is None or row.floor is None:
            continue
        for cluster in clusters:
            if cluster.floor == row.floor and math.dist(cluster.at, row.place) <= _RADIUS:
                break
        else:
            cluster = FailureCluster(row.floor, row.place)
            clusters.append(cluster)
        cluster.tasks[row.task or "no task"] += 1
    return tuple(sorted(clusters, key=lambda cluster: (cluster.floor, -cluster.runs, cluster.at)))


def _longest_delay(row: RunRow) -> float | None:
    """Return the longest time (s) from the beginning of one of a run's faults until it was found.

    Returns None if there were none, or if one of them was never found.
    """
    delays = [detection.delay for detection in row.detections]
    found = [delay for delay in delays if delay is not None]
    return max(found) if found and len(found) == len(delays) else None
