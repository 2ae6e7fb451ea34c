"""What a report says of each plan: its rates, and what they mean."""

from collections import Counter
from dataclasses import dataclass

from argo_env.evaluation.case import PlanName
from argo_env.evaluation.quantities import QUANTITIES
from argo_env.evaluation.rates import PlanRate, means_of, success
from argo_env.evaluation.report.words import meaning
from argo_env.evaluation.results import EvaluationResults, GroupRate
from argo_env.evaluation.row import RunOutcome


@dataclass(frozen=True)
class PlanSection:
    """A plan as a report shows it."""

    name: str
    rate: PlanRate
    worlds: int
    """that count"""
    meaning: str
    faults: tuple[GroupRate, ...]
    outcomes: Counter[RunOutcome]


def plan_sections(results: EvaluationResults) -> list[PlanSection]:
    """One of each plan, in their order."""
    plans = results.plan.plans
    return [
        PlanSection(
            plan.beside(plans),
            results.rate(plan),
            _worlds(results, plan),
            meaning(results, plan),
            results.by_faults(plan),
            Counter(row.outcome for row in results.of(plan)),
        )
        for plan in plans
    ]


def other_rates(results: EvaluationResults) -> list[tuple[str, str, PlanRate]]:
    """What else can be so in a run, of which plan, and how often it was. Without what can't be:
    nothing is found where nothing is wrong, or late where there is no limit."""
    plans = results.plan.plans
    ran = [row for row in results.rows if row.carried_out]
    left_out = {"success"}
    if not results.delays:
        left_out.add("detected")
    if all(row.limit is None for row in ran):
        left_out.add("late")
    if not ran:
        return []
    return [
        (_WORDS.get(name, name), plan.beside(plans), results.rate(plan, name))
        for name in QUANTITIES
        if name not in left_out
        for plan in plans
        if results.rate(plan, name).runs
    ]


_WORDS = {
    "contact": "the robot touched something",
    "mishap": "there was trouble on the way",
    "late": "it took longer than it may",
    "detected": "all that was wrong was found, where anything was",
    "false alarm": "something was found that was not so",
}


def _worlds(results: EvaluationResults, plan: PlanName) -> int:
    """In how many worlds the plan's runs were that count."""
    ran = [row for row in results.of(plan) if row.carried_out]
    weights = {case.faults: case.weight for case in results.plan.cases if case.plan == plan}
    if results.plan.strata or len(weights) == 1:
        return len({row.seed for row in ran})
    return len(means_of(ran, weights, success))
