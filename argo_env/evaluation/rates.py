"""Rates of evaluated plans from rows, with the interval that suits the sampling."""

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
    weighted_means_of_complete_worlds,
    wilson,
)
from argo_env.evaluation.estimates.sequences import ConfidenceSequence
from argo_env.evaluation.plan import EvaluationPlan
from argo_env.evaluation.requirement import RateRequirement
from argo_env.evaluation.row import RunOutcome, RunRow


class IntervalMethod(StrEnum):
    """Method by which an interval was computed."""

    EXACT = "Clopper-Pearson"
    """exact, for one run in each world"""
    SEQUENCE = "confidence sequence"
    """valid at any stopping time, for evaluations whose end depends on outcomes; also for several
    runs in each world: these depend on each other, so that their mean counts as one value"""
    STRATA = "strata"
    """weighted sum over the cases, each of which is sampled separately"""
    QUICK = "Wilson"
    """approximate, for display while the evaluation runs; nothing is claimed by it"""


@dataclass(frozen=True)
class PlanRate:
    """Share of a plan's runs that have some property, 0 to 1, with its 95 % interval."""

    value: float
    low: float
    high: float
    runs: int
    """number of runs that count"""
    lost: int
    """number of runs that could not be carried out, and do not count"""
    method: IntervalMethod


def success(row: RunRow) -> bool:
    """Return True if the mission succeeded."""
    return row.success


def estimate_plan_rate(
    evaluation: EvaluationPlan,
    plan: PlanName,
    rows: Sequence[RunRow],
    quantity: Callable[[RunRow], bool | None] = success,
    any_time: bool = False,
) -> PlanRate:
    """Compute the rate of a plan over all its cases.

    Args:
        evaluation: Evaluation that the plan belongs to.
        plan: Plan to rate.
        rows: Rows of the evaluation, also of other plans. Runs that could not be carried out don't
            count; their number is returned.
        quantity: Property to count; a run for which it returns None does not count.
        any_time: Whether the interval must be valid whatever ended the evaluation, for example a
            person who saw the outcomes.
    """
    plan_rows = [row for row in rows if row.plan == plan]
    ran = [row for row in plan_rows if row.is_completed]
    lost = len(plan_rows) - len(ran)
    cases = [case for case in evaluation.cases if case.plan == plan]
    if len(cases) == 1:
        rate, method = estimate_run_rate(evaluation, _outcomes(ran, quantity), any_time)
        return PlanRate(rate.value, rate.low, rate.high, rate.runs, lost, method)
    weights = {case.faults: case.weight for case in cases}
    if evaluation.strata:
        by_case = {name: [row for row in ran if row.faults == name] for name in weights}
        outcomes = {name: _outcomes(rows, quantity) for name, rows in by_case.items()}
        # A case that was run, but has no run that counts, is not part of the rate.
        counting = [name for name in weights if outcomes[name] or not by_case[name]]
        if not counting:
            return PlanRate(math.nan, 0.0, 1.0, 0, lost, IntervalMethod.STRATA)
        total = math.fsum(weights[name] for name in counting)
        strata = [
            Stratum(weights[name] / total, sum(outcomes[name]), len(outcomes[name]))
            for name in counting
        ]
        estimate, runs = stratified_rate(strata), len(_outcomes(ran, quantity))
        return PlanRate(
            estimate.value, estimate.low, estimate.high, runs, lost, IntervalMethod.STRATA
        )
    means = shares_of_complete_worlds(ran, weights, quantity)
    sequence = ConfidenceSequence()
    sequence.add(means.values())
    low, high = sequence.interval
    value = math.fsum(means.values()) / len(means) if means else math.nan
    # A world with a lost run does not count at all.
    count = len(_outcomes([row for row in ran if row.seed in means], quantity))
    return PlanRate(value, low, high, count, lost, IntervalMethod.SEQUENCE)


def _outcomes(rows: Sequence[RunRow], quantity: Callable[[RunRow], bool | None]) -> list[bool]:
    """Return the value of the quantity for each run that counts: for which it is not None."""
    return [value for row in rows if (value := quantity(row)) is not None]


def estimate_run_rate(
    evaluation: EvaluationPlan, outcomes: Sequence[bool], any_time: bool = False
) -> tuple[Rate, IntervalMethod]:
    """Compute the rate of runs, taken as independent, and the method of its interval.

    `outcomes` states which runs have the property. The interval is a confidence sequence with
    `any_time`, or if the evaluation has a requirement, at whose decision it stops. Such a stop is
    more likely the farther the outcomes so far deviate from the true rate. Otherwise the interval
    is that of Clopper and Pearson, which is exact for a number of runs that was fixed before.
    """
    count, runs = sum(outcomes), len(outcomes)
    if not (evaluation.stopping.require or any_time):
        return clopper_pearson(count, runs), IntervalMethod.EXACT
    sequence = ConfidenceSequence()
    sequence.add(map(float, outcomes))
    return Rate(count, runs, *sequence.interval), IntervalMethod.SEQUENCE


def shares_of_complete_worlds(
    rows: Sequence[RunRow], weights: dict[str, float], quantity: Callable[[RunRow], bool | None]
) -> dict[int, float]:
    """Return, by seed, the share of a plan's runs that have a property, weighted by case.

    `rows` are those of one plan; `weights` are those of its cases by their faults; `quantity` is
    the property, None for a run that does not count.
    """
    return weighted_means_of_complete_worlds(
        ((row.seed, row.faults, quantity(row)) for row in rows), weights
    )


def approximate_success_rate(outcomes: Counter[RunOutcome]) -> PlanRate:
    """Compute the success rate with an approximate interval, for display during the evaluation."""
    ran = outcomes[RunOutcome.SUCCESS] + outcomes[RunOutcome.FAILURE]
    rate = wilson(outcomes[RunOutcome.SUCCESS], ran)
    lost = outcomes.total() - ran
    return PlanRate(rate.value, rate.low, rate.high, ran, lost, IntervalMethod.QUICK)


class Decision(StrEnum):
    """Decision on a requirement."""

    MET = "met"
    MISSED = "missed"
    OPEN = "not decided"


@dataclass(frozen=True)
class RequirementVerdict:
    """Verdict on a requirement for one plan, with the interval that it is based on."""

    plan: PlanName
    requirement: str
    verdict: Decision
    low: float
    high: float
    """bounds of the share, 0 to 1, valid at any stopping time"""
    worlds: int
    """number of worlds that count"""


def judge_requirements(
    evaluation: EvaluationPlan, rows: Sequence[RunRow]
) -> tuple[RequirementVerdict, ...]:
    """Return the present verdict on each requirement for each plan.

    It may be called after each run: for each plan, the probability that any of its verdicts is ever
    wrong is at most 5 %. Runs that could not be carried out count against the requirement.
    """
    return tuple(
        RequirementVerdict(plan, str(requirement), verdict, *sequence.interval, sequence.runs)
        for plan, requirement, sequence, verdict in _decisions(evaluation, rows)
    )


def _decisions(
    evaluation: EvaluationPlan, rows: Sequence[RunRow]
) -> Iterator[tuple[PlanName, RateRequirement, ConfidenceSequence, Decision]]:
    """Yield each plan and requirement with its confidence sequence and its decision so far."""
    required = evaluation.stopping.require
    for plan in evaluation.plans:
        plan_rows = [row for row in rows if row.plan == plan]
        weights = {case.faults: case.weight for case in evaluation.cases if case.plan == plan}
        for requirement in required:
            sequence = ConfidenceSequence(level=1.0 - 0.05 / len(required))
            sequence.add(
                shares_of_complete_worlds(
                    plan_rows, weights, requirement.value_or_violation_if_lost
                ).values()
            )
            above = sequence.runs > 0 and sequence.is_above(requirement.share)
            below = sequence.runs > 0 and sequence.is_below(requirement.share)
            verdict = Decision.OPEN
            if above or below:
                verdict = Decision.MET if above == requirement.at_least else Decision.MISSED
            yield plan, requirement, sequence, verdict


def should_stop(plan: EvaluationPlan, rows: Sequence[RunRow]) -> bool:
    """Return True if the evaluation's rule to stop is fulfilled; False if it has no rule."""
    stopping = plan.stopping
    # `judge_requirements` would also search for intervals and take far longer.
    if stopping.require and any(verdict is Decision.OPEN for *_, verdict in _decisions(plan, rows)):
        return False
    if stopping.width is not None:
        rates = [estimate_plan_rate(plan, name, rows) for name in plan.plans]
        if any(rate.high - rate.low > stopping.width for rate in rates):
            return False
    return bool(stopping.require) or stopping.width is not None
