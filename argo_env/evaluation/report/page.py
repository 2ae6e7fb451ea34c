"""Pages of the reports; equal results give equal bytes."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from statistics import median
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined, Template
from markupsafe import Markup

from argo_compiler.base.version import __version__
from argo_compiler.files.yaml_text import dump_yaml
from argo_env.evaluation.case import PlanName
from argo_env.evaluation.comparison import PlanComparison
from argo_env.evaluation.folder import COMPARISON, REPORT, write_file
from argo_env.evaluation.plots import (
    detection_delays,
    forest_of_rates,
    heat_map_of_outcomes_by_faults,
    histogram_of_duration_differences,
    pairs_that_differ,
    success_share_over_time,
)
from argo_env.evaluation.report.picture import render_plot
from argo_env.evaluation.report.sections import (
    describe_evaluation,
    floors_with_failures,
    other_rates_by_quantity_and_plan,
    plan_sections,
    reasons_by_plan_with_faults,
    unsuccessful_rows_plans_specs,
)
from argo_env.evaluation.report.texts import (
    format_p_value,
    headline_and_rating,
    in_percent,
    number_with_noun,
    share_interval,
    time_or,
)
from argo_env.evaluation.results import EvaluationResults, duration_curve
from argo_env.evaluation.row import RunOutcome
from argo_env.evaluation.worlds import Variation
from argo_env.files.checked_files import checked_page
from argo_env.files.folders import make_folder
from argo_env.formatting import min_sec_text
from argo_env.report.svg import replace_non_xml_characters

_MAX_RUNS, _SHOWN_RUNS, _MAX_REASONS, _MAX_CLUSTERS = 100, 12, 15, 12
"""largest numbers of lines in tables; the runs after the first `_SHOWN_RUNS` are in a section that
is closed at first, and the stored rows have all runs"""
_GAINS = (0.01, 0.02, 0.05, 0.1, 0.2)


def write_evaluation_report(folder: Path, results: EvaluationResults) -> Path:
    """Write `report.html` into the folder of an evaluation and return its path.

    Raises Unavailable if it can't be written.
    """
    return write_file(folder / REPORT, checked_page(evaluation_page(results, folder)))


def write_comparison_report(
    folder: Path, first: Path, second: Path, compared: PlanComparison
) -> Path:
    """Write `comparison.html` into a folder and return its path.

    `first` and `second` are the folders of the two evaluations. Raises Unavailable if the file
    can't be written.
    """
    make_folder(folder)
    return write_file(folder / COMPARISON, checked_page(comparison_page(compared, first, second)))


def evaluation_page(results: EvaluationResults, folder: Path) -> str:
    """Return the report of an evaluation whose files are in the folder, as HTML."""
    plans = results.plan.plans
    sections = plan_sections(results)
    names = {plan: section.name for plan, section in zip(plans, sections, strict=True)}
    rates = "; ".join(f"{s.name} {in_percent(s.rate.value) or 'no run'}" for s in sections)
    delays = results.delays
    all_reasons = reasons_by_plan_with_faults(results)
    blocks = [(names[plan], results.by_seeds(plan)) for plan in plans]
    failing = unsuccessful_rows_plans_specs(results, folder)[:_MAX_RUNS]
    repeatable = 0 if results.plan.added else sum(bool(spec) for *_, spec in failing)
    return _template("evaluation.html.j2").render(
        name=results.plan.name,
        headline=headline_and_rating(results),
        plans=sections,
        verdicts=[(verdict, names[verdict.plan]) for verdict in results.verdicts],
        outcomes=results.outcomes,
        lost=results.lost,
        forest=render_plot(
            f"Success rates with intervals: {rates}", lambda: forest_of_rates(results)
        )
        if results.rows
        else None,
        required=any(r.quantity == "success" for r in results.plan.stopping.require),
        others=other_rates_by_quantity_and_plan(results),
        heat_maps=[
            (names[plan], _heat_map(results, plan, names[plan])) for plan in _with_faults(results)
        ],
        durations=render_plot(
            "Share of runs that have succeeded by a time", lambda: success_share_over_time(results)
        )
        if any(row.success for row in results.rows)
        else None,
        curves=[(names[plan], duration_curve(results, plan)) for plan in plans],
        delays=render_plot(
            f"Delays until {number_with_noun(len(delays), 'kind')} of faults were found",
            lambda: detection_delays(results),
        )
        if delays
        else None,
        found=[(kind, *_delay_summary(of_kind)) for kind, of_kind in delays.items()],
        reasons=all_reasons[:_MAX_REASONS],
        more_reasons=max(0, len(all_reasons) - _MAX_REASONS),
        floors=floors_with_failures(results),
        most_clusters=_MAX_CLUSTERS,
        failing=failing,
        repeatable=repeatable,
        shown=_SHOWN_RUNS,
        more=max(0, len(results.unsuccessful_rows) - _MAX_RUNS),
        faults_for=results.faults_for,
        added=results.plan.added,
        blocks=[(name, groups) for name, groups in blocks if len(groups) > 1],
        one_run_per_world=all(group.one_run_per_world for _, groups in blocks for group in groups),
        made=describe_evaluation(results),
        variation=_in_yaml(results.plan.variation),
    )


def comparison_page(
    compared: PlanComparison, first: Path | None = None, second: Path | None = None
) -> str:
    """Return the report of a comparison as HTML; it names the evaluations' folders if given."""
    worlds = len({a.seed for a, _ in compared.pairs})
    both = any(a.success and b.success for a, b in compared.pairs)
    pairs = compared.successes
    made = [("Argo", __version__)]
    made += [(name, str(path)) for name, path in (("A is in", first), ("B is in", second)) if path]
    success = compared.success
    in_percents = replace(
        success, value=100 * success.value, low=100 * success.low, high=100 * success.high
    )
    return _template("comparison.html.j2").render(
        compared=compared,
        pairs=pairs,
        worlds=worlds,
        differences=[
            ("success", "%+.1f %%", in_percents, compared.p_value),
            ("time (s)", "%+.1f s", compared.duration, compared.duration.p_value),
            ("distance (m)", "%+.1f m", compared.distance, compared.distance.p_value),
        ],
        test="McNemar's exact test"
        if worlds == pairs.pairs
        else "A test over worlds, which swaps the plans at random",
        sides=render_plot(
            f"Pairs in which one plan succeeds alone: A in {pairs.first_only}, B in "
            f"{pairs.second_only}",
            lambda: pairs_that_differ(compared),
        ),
        histogram=render_plot(
            f"Differences in time, world by world; {compared.duration.value:+.1f} s on average",
            lambda: histogram_of_duration_differences(compared),
        )
        if both
        else None,
        powers=[(gain, compared.power(gain)) for gain in _GAINS],
        made=made,
    )


def _in_yaml(variation: Variation) -> str:
    """Return the variation as a line of YAML; empty if nothing varies."""
    data = variation.model_dump(mode="json", exclude_none=True, exclude_defaults=True)
    return dump_yaml(data, flow=True, width=math.inf).strip() if data else ""


def _with_faults(results: EvaluationResults) -> list[PlanName]:
    """Return the names of the plans that were run with several sets of faults."""
    return [plan for plan in results.plan.plans if len(results.by_faults(plan)) > 1]


def _heat_map(results: EvaluationResults, plan: PlanName, name: str) -> Markup:
    alt = f"Outcomes of the runs of {name}, by faults"
    return render_plot(alt, lambda: heat_map_of_outcomes_by_faults(results, plan=plan))


def _delay_summary(delays: list[float | None]) -> tuple[int, int, float | None, float | None]:
    """Return the number of faults, the number of those found, and their median and longest delay.

    Delays are in s; both are None if no fault was found.
    """
    times = [delay for delay in delays if delay is not None]
    if not times:
        return len(delays), 0, None, None
    return len(delays), len(times), median(times), max(times)


@cache
def _template(name: str) -> Template:
    here = Path(__file__).parent
    environment = Environment(
        loader=FileSystemLoader(here, encoding="utf-8"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        finalize=lambda value: replace_non_xml_characters(value) if type(value) is str else value,
    )
    filters: dict[str, Callable[..., Any]] = {
        "clock": min_sec_text, "percent": in_percent, "chance": format_p_value,
        "counted": number_with_noun, "time": time_or,
    }  # fmt: skip
    environment.filters.update(filters)
    style = (here / "style.css").read_text(encoding="utf-8")
    environment.globals.update(outcome=RunOutcome, share_interval=share_interval, style=style)
    return environment.get_template(name)
