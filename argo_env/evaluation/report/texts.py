"""Texts of reports: numbers as text, and sentences that explain the numbers of an evaluation."""

import math
from collections.abc import Sequence

from argo_compiler.base.quantity_text import counted_text
from argo_env.evaluation.case import PlanName
from argo_env.evaluation.rates import Decision, IntervalMethod
from argo_env.evaluation.results import EvaluationResults
from argo_env.formatting import min_sec_text


def in_percent(share: float) -> str:
    """Return a share (0 to 1) as text in percent, such as `98.0 %`; empty for NaN."""
    return "" if math.isnan(share) else f"{100 * share:.1f} %"


def share_interval(low: float, high: float) -> str:
    """Return two shares (0 to 1) as an interval in percent."""
    return f"{100 * low:.1f} to {100 * high:.1f} %"


def format_p_value(p_value: float) -> str:
    """Return a p-value as text with three decimals; empty for NaN: no valid p-value."""
    if math.isnan(p_value):
        return ""
    return f"{p_value:.3f}" if p_value >= 0.001 else "below 0.001"


def number_ranges_text(numbers: Sequence[int]) -> str:
    """Return whole numbers as ranges, such as `0 to 9, 12`.

    At most 20 ranges are listed; the number of those left out follows.
    """
    parts: list[list[int]] = []
    for number in sorted(numbers):
        if parts and number == parts[-1][-1] + 1:
            parts[-1][1:] = [number]
        else:
            parts.append([number])
    texts = [" to ".join(map(str, part)) for part in parts[:20]]
    return ", ".join(texts) + (f" and {len(parts) - 20} more ranges" if len(parts) > 20 else "")


def time_or(seconds: float | None, otherwise: str) -> str:
    """Return a time (s) as minutes and seconds, or the text `otherwise` for None."""
    return otherwise if seconds is None else min_sec_text(seconds)


def number_with_noun(number: int, what: str) -> str:
    """Return a number with its noun, such as `1 run` or `2 runs`; `what` is the singular."""
    return f"{number} {what}{'' if number == 1 else 's'}"


def headline_and_rating(results: EvaluationResults) -> tuple[str, str]:
    """Return the headline of an evaluation's report and its rating: `good`, `bad` or `notice`.

    The headline states whether the requirements are met or, without any, how many runs failed.
    """
    decisions = {verdict.verdict for verdict in results.verdicts}
    if Decision.MISSED in decisions:
        return "a requirement is missed", "bad"
    if Decision.OPEN in decisions:
        return "a requirement is not decided", "notice"
    if decisions:
        return "all requirements are met", "good"
    rates = [results.rate(plan) for plan in results.plan.plans]
    if all(not rate.runs for rate in rates):
        return "no run could be carried out", "bad"
    if not results.unsuccessful_rows:
        return "no run failed", "good"
    runs = counted_text(len(results.rows), "run")
    return f"{len(results.unsuccessful_rows)} of {runs} without success", "notice"


def explain_sequence(results: EvaluationResults, several_runs_per_world: bool) -> list[str]:
    """Return sentences that explain the interval of a rate; it must be a confidence sequence."""
    sentences = []
    if several_runs_per_world:
        sentences.append(
            "The runs of one world depend on each other, so that a world counts as one."
        )
    if results.cut_short:
        sentences.append(
            "The evaluation was ended early, maybe by a person who saw the outcomes of the runs."
        )
    elif results.plan.stopping.require:
        sentences.append(
            "The end of the evaluation may depend on the outcomes, as there is a requirement."
        )
    return [*sentences, "The interval is a confidence sequence, which allows for that."]


def explain_success_rate(results: EvaluationResults, plan: PlanName) -> str:
    """Return sentences that explain what a plan's success rate and its interval mean."""
    rate = results.rate(plan)
    if not rate.runs:
        return "Nothing is known: no run was carried out."
    match rate.method:
        case IntervalMethod.EXACT:
            how = "The interval is exact (Clopper-Pearson)."
        case IntervalMethod.SEQUENCE:
            several = sum(case.plan == plan for case in results.plan.cases) > 1
            how = " ".join(explain_sequence(results, several))
            if rate.lost and several:
                how += " Worlds in which a run could not be carried out are left out."
        case _:
            how = "The rates with each set of faults are weighted by their probabilities."
    within = f"between {in_percent(rate.low)} and {in_percent(rate.high)}"
    return (
        f"In worlds that are drawn like these, the true share of successes lies {within}: of 100 "
        f"such statements at most 5 are wrong. {how}"
    )
