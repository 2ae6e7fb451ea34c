"""What the numbers of an evaluation mean, in sentences."""

import math

from argo_env.evaluation.plan import PlanName
from argo_env.evaluation.rates import Decision, IntervalMethod
from argo_env.evaluation.results import EvaluationResults


def in_percent(share: float) -> str:
    """A share (0 to 1) in percent, with one decimal; nothing of NaN."""
    return "" if math.isnan(share) else f"{100 * share:.1f} %"


def headline(results: EvaluationResults) -> tuple[str, str]:
    """Whether what was required holds, or else the rate, and `good`, `bad` or `notice`."""
    decisions = {verdict.verdict for verdict in results.verdicts}
    if Decision.MISSED in decisions:
        return "a requirement is missed", "bad"
    if Decision.OPEN in decisions:
        return "a requirement is not decided", "notice"
    if decisions:
        return "all that was required is met", "good"
    rates = [results.rate(plan) for plan in results.plan.plans]
    if all(not rate.runs for rate in rates):
        return "no run could be carried out", "bad"
    if not results.failing:
        return "no run failed", "good"
    return f"{len(results.failing)} of {len(results.rows)} runs are no success", "notice"


def meaning(results: EvaluationResults, plan: PlanName) -> str:
    """What the rate of a plan says, and what not."""
    rate = results.rate(plan)
    if not rate.runs:
        return "Nothing is known: no run was carried out."
    between = f"between {in_percent(rate.low)} and {in_percent(rate.high)}"
    match rate.method:
        case IntervalMethod.EXACT:
            how = "The interval is exact (Clopper-Pearson)."
        case IntervalMethod.SEQUENCE:
            how = (
                "The runs of one world depend on each other, so that a world counts as one "
                "(confidence sequence over worlds)."
            )
        case _:
            how = "The rates with each set of faults are put together by their probabilities."
    return (
        f"In worlds that are drawn like these, the true share of successes lies {between}: of 100 "
        f"such statements at most 5 are wrong. {how}"
    )
