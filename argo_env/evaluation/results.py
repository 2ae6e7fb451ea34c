"""Results of an evaluation: its rows, how long missions took, and where runs failed."""

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
from argo_env.evaluation.rates import (
    IntervalMethod,
    PlanRate,
    RequirementVerdict,
    judge_requirements,
    rate_of,
    rate_of_runs,
)
from argo_env.evaluation.row import RunOutcome, RunRow
from argo_env.evaluation.statistics import QUANTITIES
from argo_env.site.shapes import Vector

if TYPE_CHECKING:
    import pandas

_LEAST_BLOCK = 10  # seeds


@dataclass(frozen=True)
class GroupRate:
    """The rate of success of some of a plan's runs, with its interval."""

    plan: PlanName
    name: str
    rate: Rate
    outcomes: Counter[RunOutcome]
    method: IntervalMethod
    one_each: bool = True
    """whether each world has one run in it: only then the interval is one"""


@dataclass(frozen=True)
class EvaluationResults:
    """The rows of an evaluation, in the order of its plan, and what they say."""

    plan: EvaluationPlan
    rows: tuple[RunRow, ...]
    cut_short: bool = False
    """whether something else has ended it than the plan: intervals hold whatever that was"""

    @staticmethod
    def so_far(plan: EvaluationPlan, rows: Iterable[RunRow]) -> "EvaluationResults":
        """Those of an evaluation that was cut short, of which there are these rows: of all worlds
        before the first one in which a run is missing, as what has come of later ones depends on
        how long runs take."""
        by_world: dict[int, list[RunRow]] = defaultdict(list)
        for row in rows:
            by_world[row.seed].append(row)
        found: list[RunRow] = []
        for seed in plan.seeds:
            world = by_world[seed]
            if len(world) < len(plan.cases):
                break
            found += sorted(world, key=lambda row: plan.case_of(row) or 0)
        return EvaluationResults(plan, tuple(found), cut_short=True)

    @cached_property
    def outcomes(self) -> Counter[RunOutcome]:
        """How many runs ended how."""
        return Counter(row.outcome for row in self.rows)

    @property
    def missing(self) -> int:
        """Runs that could not be carried out."""
        return self.outcomes[RunOutcome.ERROR] + self.outcomes[RunOutcome.DIED]

    @cached_property
    def failing(self) -> tuple[RunRow, ...]:
        """The runs that were no success."""
        return tuple(row for row in self.rows if not row.success)

    def of(self, plan: PlanName) -> tuple[RunRow, ...]:
        """The rows of one of the plans."""
        return tuple(row for row in self.rows if row.plan == plan)

    def rate(self, plan: PlanName, quantity: str = "success") -> PlanRate:
        """How often something is so in a plan's runs, over all their faults."""
        return rate_of(self.plan, plan, self.rows, QUANTITIES[quantity], self.cut_short)

    @cached_property
    def verdicts(self) -> tuple[RequirementVerdict, ...]:
        """What is shown of what was required."""
        return judge_requirements(self.plan, self.rows)

    def by_faults(self, plan: PlanName) -> tuple[GroupRate, ...]:
        """A plan's rates by what went wrong."""
        own = self.of(plan)
        names = dict.fromkeys(self.faults_of(row) for row in own)
        return tuple(
            self._group(plan, name, [row for row in own if self.faults_of(row) == name])
            for name in names
        )

    def faults_of(self, row: RunRow) -> str:
        """What went wrong in a run: the faults of its case, or those that were drawn."""
        return self.plan.faults_in(row.faults, row.seed)

    @cached_property
    def delays(self) -> dict[str, list[float | None]]:
        """By kind of fault, how long (s) it took until each was found; None: it was not."""
        found: dict[str, list[float | None]] = {}
        for row in self.rows:
            for one in row.detections:
                found.setdefault(one.fault, []).append(one.delay)
        return dict(sorted(found.items()))

    def by_seeds(self, plan: PlanName, blocks: int = 10) -> tuple[GroupRate, ...]:
        """A plan's rates by some blocks of seeds, none too small to tell anything: they should
        differ by chance only."""
        own = self.of(plan)
        seeds = sorted({row.seed for row in own})
        size = max(_LEAST_BLOCK, -(-len(seeds) // blocks))
        found = []
        for first in range(0, len(seeds), size):
            block = seeds[first : first + size]
            rows = [row for row in own if block[0] <= row.seed <= block[-1]]
            name = str(block[0]) if len(block) == 1 else f"{block[0]} to {block[-1]}"
            found.append(self._group(plan, name, rows))
        return tuple(found)

    def _group(self, plan: PlanName, name: str, rows: Sequence[RunRow]) -> GroupRate:
        ran = [row.success for row in rows if row.carried_out]
        rate, method = rate_of_runs(self.plan, ran, self.cut_short)
        one_each = len({row.seed for row in rows}) == len(rows)
        return GroupRate(plan, name, rate, Counter(row.outcome for row in rows), method, one_each)

    @cached_property
    def frame(self) -> "pandas.DataFrame":
        """The rows as a table, one line each; what was drawn for the world as `world.…`."""
        import pandas

        lines = []
        for row in self.rows:
            line = row.model_dump(mode="json", exclude={"world", "detections", "place"})
            line["detected"] = QUANTITIES["detected"](row)
            line["delay"] = max((one.delay or 0.0 for one in row.detections), default=None)
            line["x"], line["y"], line["z"] = row.place or (None, None, None)
            line.update({f"world.{name}": value for name, value in row.world.items()})
            lines.append(line)
        return pandas.DataFrame(lines)

    def _repr_html_(self) -> str:
        """As notebooks show it: a line for each plan."""
        head = "".join(
            f"<th>{name}</th>" for name in ("plan", "runs", "success", "95 %", "failures", "lost")
        )
        lines = []
        for plan in self.plan.plans:
            rate = self.rate(plan)
            failures = sum(row.outcome is RunOutcome.FAILURE for row in self.of(plan))
            cells = (
                html.escape(plan.beside(self.plan.plans)),
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
    """The share of a plan's runs that had succeeded by a time. A run that failed never does."""

    plan: PlanName
    times: tuple[float, ...]
    """s, of the runs that succeeded, ascending"""
    shares: tuple[float, ...]
    """of all runs that were carried out, 0 to 1: those that had succeeded by each of the times"""
    limits: tuple[float, ...]
    """s, the mission's longest durations; one, or none"""

    @property
    def last(self) -> float:
        """The share that succeeded at all."""
        return self.shares[-1] if self.shares else 0.0

    def by(self, share: float) -> float | None:
        """The time (s) by which that share (0 to 1) of the runs had succeeded; None: never."""
        k = bisect_left(self.shares, share - 1e-9)
        return self.times[k] if k < len(self.times) else None


def duration_curve(results: EvaluationResults, plan: PlanName) -> DurationCurve:
    """That of a plan. Each of its cases counts by its weight, however often it was run."""
    ran = [row for row in results.of(plan) if row.carried_out]
    weights = {case.faults: case.weight for case in results.plan.cases if case.plan == plan}
    often = {name: sum(row.faults == name for row in ran) for name in weights}
    whole = sum(weight for name, weight in weights.items() if often[name])
    done = sorted(
        (row.duration, weights[row.faults] / often[row.faults] / whole)
        for row in ran
        if row.success and row.duration is not None
    )
    return DurationCurve(
        plan,
        tuple(time for time, _ in done),
        tuple(min(share, 1.0) for share in accumulate(share for _, share in done)),
        tuple(sorted({row.limit for row in ran if row.limit is not None})),
    )


_NEAR = 0.5  # m


@dataclass
class FailurePlace:
    """A place where runs failed."""

    floor: int
    at: Vector
    """m, of the first of them; the others are at most half a metre away"""
    tasks: Counter[str] = field(default_factory=Counter)
    """how many failed there at each task"""

    @property
    def runs(self) -> int:
        """How many failed there."""
        return self.tasks.total()


def failure_places_of(rows: Iterable[RunRow]) -> tuple[FailurePlace, ...]:
    """The places where these runs failed, by floor, and where most did first."""
    found: list[FailurePlace] = []
    for row in rows:
        if row.success or row.place is None or row.floor is None:
            continue
        for place in found:
            if place.floor == row.floor and math.dist(place.at, row.place) <= _NEAR:
                break
        else:
            place = FailurePlace(row.floor, row.place)
            found.append(place)
        place.tasks[row.task or "no task"] += 1
    return tuple(sorted(found, key=lambda one: (one.floor, -one.runs, one.at)))
