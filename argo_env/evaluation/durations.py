"""How long missions take: by when which share of a plan's runs had succeeded."""

from bisect import bisect_left
from dataclasses import dataclass
from itertools import accumulate

from argo_env.evaluation.case import PlanName
from argo_env.evaluation.results import EvaluationResults


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
