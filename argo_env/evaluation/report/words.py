"""What the numbers of an evaluation mean, in sentences."""

import math
from collections.abc import Sequence

from argo_env.evaluation.case import PlanName
from argo_env.evaluation.rates import Decision, IntervalMethod
from argo_env.evaluation.results import EvaluationResults
from argo_env.formatting import clock


def in_percent(share: float) -> str:
    """A share (0 to 1) in percent, with one decimal; nothing of NaN."""
    return "" if math.isnan(share) else f"{100 * share:.1f} %"


def between(low: float, high: float) -> str:
    """Two shares (0 to 1) as an interval in percent."""
    return f"{100 * low:.1f} to {100 * high:.1f} %"


def chance(p_value: float) -> str:
    """A probability that may be very small, or unknown."""
    if math.isnan(p_value):
        return ""
    return f"{p_value:.3f}" if p_value >= 0.001 else "below 0.001"


def ranges(numbers: Sequence[int]) -> str:
    """Whole numbers in words, such as `0 to 9, 12`."""
    parts: list[list[int]] = []
    for number in sorted(numbers):
        if parts and number == parts[-1][-1] + 1:
            parts[-1][1:] = [number]
        else:
            parts.append([number])
    said = [" to ".join(map(str, part)) for part in parts[:20]]
    return ", ".join(said) + (f" and {len(parts) - 20} more ranges" if len(parts) > 20 else "")


def time_or(seconds: float | None, otherwise: str) -> str:
    """A time (s) as minutes and seconds, or what is said where there is none."""
    return otherwise if seconds is None else clock(seconds)


def counted(number: int, what: str) -> str:
    """So many of something, such as `1 run` or `2 runs`."""
    return f"{number} {what}{'' if number == 1 else 's'}"


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


def why_sequence(results: EvaluationResults, several: bool) -> list[str]:
    """Why the interval of a rate is a confidence sequence, in sentences; `several`: there are
    several runs in each world."""
    said = []
    if several:
        said.append("The runs of one world depend on each other, so that a world counts as one.")
    if results.cut_short:
        said.append(
            "It was ended before its time, maybe by somebody who saw what came of the runs."
        )
    elif results.plan.stopping.require:
        said.append("Its end may depend on what came of the runs, as there is a requirement.")
    return [*said, "The interval is a confidence sequence, which allows for that."]


def meaning(results: EvaluationResults, plan: PlanName) -> str:
    """What the rate of a plan says, and what not."""
    rate = results.rate(plan)
    if not rate.runs:
        return "Nothing is known: no run was carried out."
    match rate.method:
        case IntervalMethod.EXACT:
            how = "The interval is exact (Clopper-Pearson)."
        case IntervalMethod.SEQUENCE:
            several = sum(case.plan == plan for case in results.plan.cases) > 1
            how = " ".join(why_sequence(results, several))
            if rate.lost and several:
                how += " Worlds in which a run could not be carried out are left out."
        case _:
            how = "The rates with each set of faults are put together by their probabilities."
    within = f"between {in_percent(rate.low)} and {in_percent(rate.high)}"
    return (
        f"In worlds that are drawn like these, the true share of successes lies {within}: of 100 "
        f"such statements at most 5 are wrong. {how}"
    )
