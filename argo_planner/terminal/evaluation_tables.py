"""Tables and lines on the terminal for the results of an evaluation."""

import math
import shlex
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from statistics import median

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from argo_compiler.base.quantity_text import counted_text
from argo_env.evaluation.case import PlanName
from argo_env.evaluation.comparison import PlanComparison
from argo_env.evaluation.control_variates import ControlledMean
from argo_env.evaluation.estimates.pairs import FirstMinusSecond
from argo_env.evaluation.rates import Decision, IntervalMethod
from argo_env.evaluation.report.texts import explain_sequence, in_percent
from argo_env.evaluation.results import EvaluationResults, GroupRate
from argo_env.evaluation.row import RunOutcome
from argo_env.evaluation.score import ScoringRules, mean_score
from argo_env.formatting import min_sec_text

_STYLES = {Decision.MET: "bold green", Decision.MISSED: "bold red", Decision.OPEN: "bold yellow"}
_MAX_LISTED = 10  # failed runs that are listed


def show_results(
    results: EvaluationResults,
    failed_spec_files: Mapping[str, Path],
    console: Console,
    scoring: ScoringRules,
) -> None:
    """Print rates, scores, failed runs with the commands that repeat them, and verdicts.

    Args:
        results: results of the evaluation
        failed_spec_files: files with the specs of failed runs, by the keys of their rows
        console: where to print
        scoring: rules by which the runs get points
    """
    console.print(_plans(results))
    for plan in results.plan.plans:
        if results.plan.strata:
            continue  # its runs have different weights
        score = mean_score(results.rows_for(plan), scoring)
        if math.isnan(score.value):
            continue
        several = len(results.plan.plans) > 1
        name = f"{plan.label(results.plan.plans)}: score" if several else "Score"
        # If all scores are equal, their interval has no width and would look too certain.
        varies = score.low < score.high
        between = f" ({score.low:.1f} to {score.high:.1f})" if varies else ""
        console.print(
            f"{escape(name)} {score.value:.1f} of {scoring.max_score:g} points{between}",
            soft_wrap=True,
        )
    for plan in results.plan.plans:
        groups = results.by_faults(plan)
        if len(groups) > 1:
            console.print(_groups(_titled("by faults", plan, results), "faults", groups))
        blocks = results.by_seeds(plan)
        if len(blocks) > 1 and results.unsuccessful_rows:
            console.print(_groups(_titled("by seeds", plan, results), "seeds", blocks))
    for line in _failing(results, failed_spec_files):
        console.print(escape(line), soft_wrap=True)
    worlds, planned = len({row.seed for row in results.rows}), len(results.plan.seeds)
    if worlds < planned and not results.plan.strata:
        console.print(f"Stopped after {worlds} of {planned} worlds, which were enough.")
    for verdict in results.verdicts:
        style = _STYLES[verdict.verdict]
        of = f" for {verdict.plan.label(results.plan.plans)}" if len(results.plan.plans) > 1 else ""
        console.print(
            f"[{style}]{verdict.requirement}{escape(of)}: {verdict.verdict}[/] "
            f"(between {in_percent(verdict.low)} and {in_percent(verdict.high)}, "
            f"{verdict.worlds} worlds)",
            soft_wrap=True,
        )
    if any(verdict.verdict is Decision.OPEN for verdict in results.verdicts):
        console.print("A requirement that is not decided needs more worlds: give more --seeds.")


def show_means(means: Sequence[ControlledMean], cheap_drive: str | None, console: Console) -> None:
    """Print means estimated with the help of runs with a cheap drive.

    `cheap_drive` is None if there are no such runs: then no means exist, and nothing is printed.
    """
    if cheap_drive is not None and not means:
        console.print(
            f"Too few worlds could be run to use the drive {cheap_drive} for the estimates."
        )
    for mean in means:
        control = mean.control
        console.print(
            f"{mean.quantity.capitalize()} with the help of the drive {cheap_drive}: correlation "
            f"{control.correlation:.2f}, its runs take {in_percent(control.cost)} of the time"
            + ("" if control.pays else "; using it does not pay off"),
            soft_wrap=True,
        )
        shown = in_percent if mean.quantity == "success" else _seconds
        if mean.controlled is None:
            if control.pays:
                console.print(
                    "  too few successes or failures to compute an interval with its help"
                )
            continue
        for estimate, basis in (
            (mean.uncontrolled, f"{mean.expensive} worlds alone"),
            (mean.controlled, f"these and {mean.cheap} worlds with the drive {cheap_drive}"),
        ):
            between = f"{shown(estimate.low)} to {shown(estimate.high)}"
            console.print(f"  from {basis}: {shown(estimate.value)} ({between})", soft_wrap=True)


def _seconds(s: float) -> str:
    return f"{s:.1f} s"


def _titled(what: str, plan: PlanName, results: EvaluationResults) -> str:
    several = len(results.plan.plans) > 1
    return f"{plan.label(results.plan.plans)}: {what}" if several else what.capitalize()


def _plans(results: EvaluationResults) -> Table:
    table = Table(title=escape(results.plan.name), title_justify="left")
    table.add_column("plan")
    for name in ("runs", "success", "95 % interval", "failures", "errors", "died", "median time"):
        table.add_column(name, justify="right")
    for plan in results.plan.plans:
        rows, rate = results.rows_for(plan), results.rate(plan)
        took = [row.duration for row in rows if row.duration is not None]
        counts = {o: sum(row.outcome is o for row in rows) for o in RunOutcome}
        star = "" if rate.method is IntervalMethod.EXACT else " *"
        table.add_row(
            escape(plan.label(results.plan.plans)),
            str(len(rows)),
            in_percent(rate.value),
            f"{in_percent(rate.low)} to {in_percent(rate.high)}{star}",
            str(counts[RunOutcome.FAILURE] or ""),
            str(counts[RunOutcome.ERROR] or ""),
            str(counts[RunOutcome.DIED] or ""),
            min_sec_text(median(took)) if took else "",
        )
    methods = {results.rate(plan).method for plan in results.plan.plans}
    notes = []
    several = len(results.plan.cases) > len(results.plan.plans) and not results.plan.strata
    if IntervalMethod.SEQUENCE in methods:
        notes += ["* " + " ".join(explain_sequence(results, several))]
    elif IntervalMethod.STRATA in methods:
        notes.append("* weighted by the probabilities of the faults")
    if results.lost:
        worlds = ", and their worlds are not in the rate of the plan" if several else ""
        notes.append(f"runs with errors and runs that died are in no rate{worlds}")
    table.caption = "\n".join(notes) or None
    return table


def _groups(title: str, what: str, groups: tuple[GroupRate, ...]) -> Table:
    table = Table(title=escape(title), title_justify="left")
    table.add_column(what)
    for name in ("runs", "success", "95 % interval", "failures", "lost"):
        table.add_column(name, justify="right")
    for group in groups:
        lost = group.outcomes[RunOutcome.ERROR] + group.outcomes[RunOutcome.DIED]
        table.add_row(
            escape(group.name),
            str(group.rate.runs + lost),
            in_percent(group.rate.value),
            f"{in_percent(group.rate.low)} to {in_percent(group.rate.high)}"
            if group.one_run_per_world
            else "",
            str(group.outcomes[RunOutcome.FAILURE] or ""),
            str(lost or ""),
        )
    return table


def _failing(results: EvaluationResults, files: Mapping[str, Path]) -> Iterator[str]:
    rows = results.unsuccessful_rows
    if not rows:
        return
    repeat = "; to repeat one alone:" if files else ":"
    runs = counted_text(len(results.rows), "run")
    yield f"{len(rows)} of {runs} did not succeed{repeat}"
    for row in rows[:_MAX_LISTED]:
        outcome = "" if row.is_completed else f"{row.outcome}: "
        plan = f"{row.plan.label(results.plan.plans)}, " if len(results.plan.plans) > 1 else ""
        yield f"  {plan}seed {row.seed}, {results.faults_for(row)}: {outcome}{row.reason}"
        if row.key in files:
            yield f"    argo run {shlex.quote(str(files[row.key]))} --report out/{row.key[:8]}"
    more = len(rows) - _MAX_LISTED
    if more <= 0:
        return
    stored = [file for row in rows[_MAX_LISTED:] if (file := files.get(row.key)) is not None]
    place = ""
    if stored:
        place = f", {'' if len(stored) == more else f'{len(stored)} of them '}in {stored[0].parent}"
    yield f"  and {more} more{place}"


def show_comparison(compared: PlanComparison, console: Console) -> None:
    """Print which of two evaluated missions is better, by its runs, and how certain that is."""
    pairs = compared.successes
    table = Table(title="A minus B, in the same worlds", title_justify="left")
    table.add_column("")
    for name in ("difference", "95 % interval", "by chance", "pairs"):
        table.add_column(name, justify="right")
    for what, found, scale, unit in (
        ("success", compared.success, 100.0, "%"),
        ("time", compared.duration, 1.0, "s"),
        ("distance", compared.distance, 1.0, "m"),
    ):
        chance = compared.p_value if what == "success" else found.p_value
        table.add_row(what, *_difference(found, scale, unit), _chance(chance), str(found.pairs))
    first, second = compared.first, compared.second
    console.print(f"A: {escape(first)}\nB: {escape(second)}", soft_wrap=True)
    console.print(table)
    console.print(
        f"Both succeed in {pairs.both} pairs, only A in {pairs.first_only}, only B in "
        f"{pairs.second_only}, neither in {pairs.neither}.",
        soft_wrap=True,
    )
    if len(compared.by_faults) > 1:
        for name, own in compared.by_faults.items():
            if own.first_only or own.second_only:
                console.print(
                    f"  {escape(name)}: only A {own.first_only}, only B {own.second_only}, "
                    f"by chance {_chance(own.p_value)}",
                    soft_wrap=True,
                )
    console.print(f"[bold]{escape(compared.conclusion)}[/]", soft_wrap=True)
    if compared.has_independent_pairs and not compared.any_time:
        console.print(
            f"With this number of pairs, a difference of 5 % is detected with a probability of "
            f"{100 * compared.power(0.05):.0f} %, one of 2 % with "
            f"{100 * compared.power(0.02):.0f} %.",
            soft_wrap=True,
        )
    if compared.lost:
        console.print(
            f"{compared.lost} pairs have a run that could not be carried out, and do not count."
        )
    if any(compared.unpaired):
        a, b = compared.unpaired
        console.print(
            f"{a} runs of A and {b} of B have no counterpart in the same world with the same "
            "faults, and do not count.",
            soft_wrap=True,
        )


def _difference(found: FirstMinusSecond, scale: float, unit: str) -> tuple[str, str]:
    if math.isnan(found.value):
        return "", ""
    value, low, high = (scale * v for v in (found.value, found.low, found.high))
    if low == high:
        return f"{value:+.1f} {unit}", "none: the same in all worlds"
    return f"{value:+.1f} {unit}", f"{low:+.1f} to {high:+.1f} {unit}"


def _chance(p_value: float) -> str:
    if math.isnan(p_value):
        return ""
    return f"{p_value:.3f}" if p_value >= 0.001 else "< 0.001"
