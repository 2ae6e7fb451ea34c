"""Rates of plans, from rows: the right interval for the way in which the runs came."""

import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum

from argo_env.evaluation.case import PlanName
from argo_env.evaluation.estimates.rates import (
    Rate,
    Stratum,
    clopper_pearson,
    stratified_rate,
    weighted_world_means,
    wilson,
)
from argo_env.evaluation.estimates.sequences import ConfidenceSequence
from argo_env.evaluation.plan import EvaluationPlan
from argo_env.evaluation.requirement import RateRequirement
from argo_env.evaluation.row import RunOutcome, RunRow


class IntervalMethod(StrEnum):
    """How an interval was made."""

    EXACT = "Clopper-Pearson"
    """one run a world"""
    SEQUENCE = "confidence sequence"
    """several runs in each world, which depend on each other, so that their mean in each world
    counts; or an end that depends on what came of the runs: it holds whenever one stops"""
    STRATA = "strata"
    """runs of each case by themselves, put together by weight"""
    QUICK = "Wilson"
    """while it runs; nothing is claimed by it"""


@dataclass(frozen=True)
class PlanRate:
    """How often something is so in the runs of a plan. Shares are 0 to 1, intervals of 95 %."""

    value: float
    low: float
    high: float
    runs: int
    """that count"""
    lost: int
    """that could not be carried out, and do not count"""
    method: IntervalMethod


def success(row: RunRow) -> bool:
    """Whether the mission was one."""
    return row.success


def rate_of(
    evaluation: EvaluationPlan,
    plan: PlanName,
    rows: Sequence[RunRow],
    holds: Callable[[RunRow], bool | None] = success,
    any_time: bool = False,
) -> PlanRate:
    """The rate of a plan over all its cases, from the rows of the evaluation. Runs that could not
    be carried out are left out, and counted; those of which `holds` says None are left out, too.
    `any_time`: the interval has to hold whatever ended the evaluation, as where somebody did who
    saw what came of it."""
    own = [row for row in rows if row.plan == plan]
    ran = [row for row in own if row.carried_out]
    lost = len(own) - len(ran)
    cases = [case for case in evaluation.cases if case.plan == plan]
    if len(cases) == 1:
        rate, method = rate_of_runs(evaluation, _said(ran, holds), any_time)
        return PlanRate(rate.value, rate.low, rate.high, rate.runs, lost, method)
    weights = {case.faults: case.weight for case in cases}
    if evaluation.strata:
        of_case = {name: [row for row in ran if row.faults == name] for name in weights}
        said = {name: _said(rows, holds) for name, rows in of_case.items()}
        # A case of which no run counts is none of what the rate is over.
        counts = [name for name in weights if said[name] or not of_case[name]]
        if not counts:
            return PlanRate(math.nan, 0.0, 1.0, 0, lost, IntervalMethod.STRATA)
        whole = sum(weights[name] for name in counts)
        strata = [
            Stratum(weights[name] / whole, sum(said[name]), len(said[name])) for name in counts
        ]
        found, runs = stratified_rate(strata), len(_said(ran, holds))
        return PlanRate(found.value, found.low, found.high, runs, lost, IntervalMethod.STRATA)
    means = means_of(ran, weights, holds)
    sequence = ConfidenceSequence()
    sequence.add(means.values())
    low, high = sequence.interval
    value = sum(means.values()) / len(means) if means else math.nan
    # A world of which one run is lost is left out as a whole.
    count = len(_said([row for row in ran if row.seed in means], holds))
    return PlanRate(value, low, high, count, lost, IntervalMethod.SEQUENCE)


def _said(rows: Sequence[RunRow], holds: Callable[[RunRow], bool | None]) -> list[bool]:
    """What is said of the runs that count."""
    return [so for row in rows if (so := holds(row)) is not None]


def rate_of_runs(
    evaluation: EvaluationPlan, outcomes: Sequence[bool], any_time: bool = False
) -> tuple[Rate, IntervalMethod]:
    """How often something was so in runs of which each world has one, with an interval that holds
    however the evaluation came to its end: the exact one holds where the number of runs, or the
    width of the interval, was said before, and not where a requirement was decided, which is
    the more often so the farther the runs at hand are from the truth."""
    count, runs = sum(outcomes), len(outcomes)
    if not (evaluation.stopping.require or any_time):
        return clopper_pearson(count, runs), IntervalMethod.EXACT
    sequence = ConfidenceSequence()
    sequence.add(map(float, outcomes))
    return Rate(count, runs, *sequence.interval), IntervalMethod.SEQUENCE


def means_of(
    rows: Sequence[RunRow], weights: dict[str, float], holds: Callable[[RunRow], bool | None]
) -> dict[int, float]:
    """Return by seed the share of a plan's runs of which something holds."""
    return weighted_world_means(((row.seed, row.faults, holds(row)) for row in rows), weights)


def quick_rate(outcomes: Counter[RunOutcome]) -> PlanRate:
    """The rate of success of so many runs, to look at while more come."""
    ran = outcomes[RunOutcome.SUCCESS] + outcomes[RunOutcome.FAILURE]
    rate = wilson(outcomes[RunOutcome.SUCCESS], ran)
    lost = outcomes.total() - ran
    return PlanRate(rate.value, rate.low, rate.high, ran, lost, IntervalMethod.QUICK)


class Decision(StrEnum):
    """What is known of a requirement."""

    MET = "met"
    MISSED = "missed"
    OPEN = "not decided"


@dataclass(frozen=True)
class RequirementVerdict:
    """What the runs say of a requirement on a plan."""

    plan: PlanName
    requirement: str
    verdict: Decision
    low: float
    high: float
    """of the share, whenever one stops"""
    worlds: int


def judge_requirements(
    evaluation: EvaluationPlan, rows: Sequence[RunRow]
) -> tuple[RequirementVerdict, ...]:
    """What is shown by now, of each plan and requirement. It may be asked after each run: the
    chance that any of the verdicts on one plan is ever wrong is at most 5 %.

    Runs that could not be carried out count against the requirement.
    """
    return tuple(
        RequirementVerdict(plan, str(requirement), verdict, *sequence.interval, sequence.runs)
        for plan, requirement, sequence, verdict in _decisions(evaluation, rows)
    )


def _decisions(
    evaluation: EvaluationPlan, rows: Sequence[RunRow]
) -> Iterator[tuple[PlanName, RateRequirement, ConfidenceSequence, Decision]]:
    """Yield each plan and requirement with its confidence sequence and what that decides so far."""
    required = evaluation.stopping.require
    for plan in evaluation.plans:
        own = [row for row in rows if row.plan == plan]
        weights = {case.faults: case.weight for case in evaluation.cases if case.plan == plan}
        for requirement in required:
            sequence = ConfidenceSequence(level=1.0 - 0.05 / len(required))
            sequence.add(means_of(own, weights, requirement.holds).values())
            above = sequence.runs > 0 and sequence.is_above(requirement.share)
            below = sequence.runs > 0 and sequence.is_below(requirement.share)
            verdict = Decision.OPEN
            if above or below:
                verdict = Decision.MET if above == requirement.at_least else Decision.MISSED
            yield plan, requirement, sequence, verdict


def is_enough(plan: EvaluationPlan, rows: Sequence[RunRow]) -> bool:
    """Whether all that one stops for is reached."""
    stopping = plan.stopping
    # Not by `judge_requirements`, which also searches for intervals and takes far longer.
    if stopping.require and any(verdict is Decision.OPEN for *_, verdict in _decisions(plan, rows)):
        return False
    if stopping.width is not None:
        rates = [rate_of(plan, name, rows) for name in plan.plans]
        if any(rate.high - rate.low > stopping.width for rate in rates):
            return False
    return bool(stopping.require) or stopping.width is not None
