"""Plots of evaluations; each function draws on the given axes, or on new ones, and returns them."""

import math
from collections import Counter
from dataclasses import dataclass
from statistics import median
from typing import TYPE_CHECKING

import numpy as np

from argo_env.evaluation.case import PlanName
from argo_env.evaluation.comparison import PlanComparison
from argo_env.evaluation.estimates.rates import Rate
from argo_env.evaluation.rates import PlanRate
from argo_env.evaluation.results import (
    DurationCurve,
    EvaluationResults,
    cluster_failures_by_location,
    duration_curve,
)
from argo_env.evaluation.row import RunOutcome
from argo_env.formatting import min_sec_text
from argo_env.pictures.drawing.floors import floor_plans
from argo_env.report.svg import replace_non_xml_characters, shorten
from argo_env.seeding import generator
from argo_env.site import Site
from argo_env.site.shapes import Role

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

INK, SOFT, LINE, PAPER = "#1c2733", "#5b6b7c", "#dde3ea", "#fffffe"
GOOD, BAD, WARN = "#15803d", "#c81e1e", "#b45309"
SERIES = (
    "#1d4ed8", "#c2410c", "#0f766e", "#7c3aed", "#a16207", "#be185d", "#334155", "#4d7c0f",
)  # fmt: skip
"""colours of plans, in the order of plans"""
MARKS = ("o", "s", "^", "D", "v", "P", "X")
"""markers of plans, which distinguish them without colours. There are fewer markers than colours,
so that plans with the same colour have different markers"""
GROUND, DECK, STAIR, STRUCTURE, EDGE = "#f1f3f5", "#e3e8ed", "#c9d2da", "#aab6c1", "#9aa7b3"
"""colours of the parts of a site"""

WIDTH = 4.6  # inches; a figure of this width can be read on a phone
FONT = 9.0  # points; smaller text repeats what can be read elsewhere as well


def prepare_axes(ax: "Axes | None", height: float = 3.0, width: float = WIDTH) -> "Axes":
    """Style the given axes, or those of a new figure of this size (inches), and return them.

    pyplot does not manage the new figure; in a notebook `ax.figure` shows it.
    """
    if ax is None:
        from matplotlib.figure import Figure

        ax = Figure(figsize=(width, height), layout="constrained").subplots()
    ax.patch.set_visible(False)
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        ax.spines[side].set_color(SOFT)
    ax.tick_params(colors=SOFT, labelsize=FONT)
    return ax


def label_rows(ax: "Axes", names: list[str]) -> None:
    """Divide the axes into rows from top to bottom, one with a label for each name."""
    ax.set_yticks(range(len(names)), [shorten_label(name) for name in names], color=INK)
    ax.set_ylim(max(len(names), 1) - 0.5, -0.5)
    ax.spines["left"].set_visible(False)
    ax.tick_params(axis="y", length=0, pad=7)


def annotate_row(ax: "Axes", y: float, text: str, colour: str = SOFT) -> None:
    """Write a text to the right of the axes, at the height of row `y`, from 0 at the top."""
    ax.annotate(
        text, (1.02, y), xycoords=("axes fraction", "data"), ha="left", va="center",
        color=colour, fontsize=FONT - 1, annotation_clip=False,
    )  # fmt: skip


def show_empty(ax: "Axes", why: str) -> "Axes":
    """Write into empty axes why they are empty, and return them."""
    ax.set_axis_off()
    ax.text(0.5, 0.5, why, transform=ax.transAxes, ha="center", color=SOFT, fontsize=FONT)
    return ax


def plan_colour_and_marker(number: int) -> tuple[str, str]:
    """Return the colour and the marker of the plan with this index in its evaluation."""
    return SERIES[number % len(SERIES)], MARKS[number % len(MARKS)]


def _legend(ax: "Axes", handles: list["Line2D"], words: list[str]) -> None:
    """Draw a legend above the axes, at the left: a sample of each line with its words."""
    ax.legend(
        handles, words, frameon=False, fontsize=FONT, labelcolor=INK, loc="lower left",
        bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2,
    )  # fmt: skip


def shorten_label(name: str, max_inches: float = 1.65) -> str:
    """Return a name, shortened if needed, as one line of at most this width (inches).

    The name is escaped and padded, so that matplotlib takes no part of it for a formula and legends
    do not leave it out.
    """
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import TextToPath

    font = FontProperties(size=FONT)
    name = shorten(" ".join(replace_non_xml_characters(name).split()), 80)
    while len(name) > 1 and (
        TextToPath().get_text_width_height_descent(name, font, False)[0] > 72.0 * max_inches
    ):
        name = shorten(name, len(name) - 1)
    name = name.replace("$", r"\$")
    return f" {name}" if name.startswith("_") else name


_LANE, _GAP = 0.16, 0.1  # inches
_ALL_FAULTS = "all faults"


@dataclass(frozen=True)
class _Line:
    """Interval in a forest plot, with its position and its text."""

    row: int
    lane: float
    """-0.5 to 0.5, position within the row"""
    plan: int
    """index of the plan"""
    rate: PlanRate | Rate
    text: str
    """text at the right of the row"""


def forest_of_rates(results: EvaluationResults, ax: "Axes | None" = None) -> "Axes":
    """Draw each plan's success rate with its 95 % interval, and below it the rates by faults.

    Each row has one line for each plan, with a text at its right: the rate over all faults, or how
    many runs with the row's faults succeeded.
    """
    names, lines = _lines(results)
    plans = results.plan.plans
    lanes = len(plans) if len(names) > 1 and names[0] == _ALL_FAULTS else 1
    ax = prepare_axes(
        ax, 0.75 + (_LANE * lanes + _GAP) * len(names) + 0.22 * (lanes > 1) * len(plans)
    )
    for line in lines:
        ink, marker = plan_colour_and_marker(line.plan) if lanes > 1 else (SERIES[0], "o")
        is_total, y = isinstance(line.rate, PlanRate), line.row + line.lane
        width = 2.6 if is_total else 1.5
        ax.plot([line.rate.low, line.rate.high], [y, y], color=ink, lw=width, zorder=2)
        if line.rate.runs:
            size = 6.5 if is_total else 4.5
            ax.plot([line.rate.value], [y], marker, color=ink, ms=size, zorder=3, clip_on=False)
        annotate_row(ax, y, line.text, INK if is_total else SOFT)
    for requirement in results.plan.stopping.require:
        if requirement.quantity == "success":
            ax.axvline(requirement.share, color=WARN, lw=1.0, ls="--", zorder=1)
    label_rows(ax, names)
    if names[0] == _ALL_FAULTS:
        ax.axhline(0.5, color=SOFT, lw=0.8)
    ax.set_xlim(0.0, 1.0)
    ax.xaxis.set_major_formatter(lambda share, _: f"{share:.0%}")
    ax.grid(axis="x", color=LINE, zorder=0)
    ax.set_xlabel("success, with the interval of 95 %", color=SOFT, fontsize=FONT)
    if lanes > 1:
        _legend_of_plans(ax, plans)
    return ax


def _lines(results: EvaluationResults) -> tuple[list[str], list[_Line]]:
    """Return the names of a forest plot's rows, and the lines (intervals) in them."""
    plans = results.plan.plans
    groups = [results.by_faults(plan) for plan in plans]
    rates = [results.rate(plan) for plan in plans]
    if all(len(plan_groups) < 2 for plan_groups in groups):
        return [plan.label(plans) for plan in plans], [
            _Line(row, 0.0, row, rate, _percent(rate)) for row, rate in enumerate(rates)
        ]
    names = [
        _ALL_FAULTS,
        *dict.fromkeys(group.name for plan_groups in groups for group in plan_groups),
    ]
    lines = []
    for number, (rate, plan_groups) in enumerate(zip(rates, groups, strict=True)):
        lane = 0.72 * ((number + 0.5) / len(plans) - 0.5)
        lines.append(_Line(0, lane, number, rate, _percent(rate)))
        for group in plan_groups:
            text = f"{group.rate.count} of {group.rate.runs}"
            lines.append(_Line(names.index(group.name, 1), lane, number, group.rate, text))
    return names, lines


def _percent(rate: PlanRate) -> str:
    return f"{100 * rate.value:.1f} %" if rate.runs else "no run"


def _legend_of_plans(ax: "Axes", plans: tuple[PlanName, ...]) -> None:
    from matplotlib.lines import Line2D

    handles = []
    for number in range(len(plans)):
        ink, marker = plan_colour_and_marker(number)
        handles.append(Line2D([], [], color=ink, marker=marker, lw=1.8, ms=5))
    names = [shorten_label(plan.label(plans), 2.3) for plan in plans]
    _legend(ax, handles, names)


_OUTCOME_COLOURS = {
    RunOutcome.SUCCESS: GOOD, RunOutcome.FAILURE: BAD,
    RunOutcome.ERROR: WARN, RunOutcome.DIED: WARN,
}  # fmt: skip
_DARKEST = 0.5
"""opacity of a cell with all runs of its row; its number can be read in light and in dark mode"""


def heat_map_of_outcomes_by_faults(
    results: EvaluationResults, ax: "Axes | None" = None, plan: PlanName | None = None
) -> "Axes":
    """Draw a heat map of the runs by set of faults (rows) and outcome.

    Larger shares of a row are darker. `plan` None stands for the runs of all plans.
    """
    from matplotlib.patches import Rectangle

    rows = results.rows if plan is None else results.rows_for(plan)
    counts: dict[str, Counter[RunOutcome]] = {}
    for row in rows:
        counts.setdefault(results.faults_for(row), Counter())[row.outcome] += 1
    always = (RunOutcome.SUCCESS, RunOutcome.FAILURE)
    shown = [o for o in RunOutcome if o in always or any(row[o] for row in counts.values())]
    ax = prepare_axes(ax, 0.5 + 0.26 * max(len(counts), 1))
    for y, row_counts in enumerate(counts.values()):
        for x, outcome in enumerate(shown):
            share = row_counts[outcome] / row_counts.total()
            # The cells are shapes, not an image, as a page may forbid images.
            box = (x - 0.48, y - 0.46), 0.96, 0.92
            ax.add_patch(Rectangle(*box, facecolor="none", edgecolor=LINE, linewidth=0.8))
            if share:
                ink = _OUTCOME_COLOURS[outcome]
                ax.add_patch(Rectangle(*box, color=ink, alpha=0.12 + (_DARKEST - 0.12) * share))
            colour = INK if share else SOFT
            ax.text(
                x, y, str(row_counts[outcome]), ha="center", va="center", color=colour,
                fontsize=FONT,
            )  # fmt: skip
    label_rows(ax, [*counts])
    ax.set_xlim(-0.5, len(shown) - 0.5)
    ax.set_xticks(range(len(shown)), [outcome.value for outcome in shown], color=INK)
    ax.xaxis.tick_top()
    ax.tick_params(length=0)
    for spine in ax.spines.values():
        spine.set_visible(False)
    return ax


_STEPS = (1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 14400)  # s
_TICKS = 6
_STYLES = ("-", "--", "-.", ":")
_FAR = 1.35
"""largest ratio of a limit to the longest run at which the limit is shown; a longer limit would
squeeze all runs to one side"""


def success_share_over_time(results: EvaluationResults, ax: "Axes | None" = None) -> "Axes":
    """Draw the share of each plan's runs that have succeeded by a time (empirical distribution).

    Failed runs never succeed, so that a line may end below 100 %. The longest durations that the
    missions allow are thin vertical lines.
    """
    plans = results.plan.plans
    curves = [duration_curve(results, plan) for plan in plans]
    ax = prepare_axes(ax, 2.6 + 0.2 * len(plans))
    times = [time for curve in curves for time in curve.times]
    if not times:
        return show_empty(ax, "no run succeeded")
    low, high = _view(times, [limit for curve in curves for limit in curve.limits])
    same_limits = len({curve.limits for curve in curves}) == 1
    for number, curve in enumerate(curves):
        ink, _ = plan_colour_and_marker(number)
        if curve.times:
            ax.step(
                [low, *curve.times, high], [0.0, *curve.shares, curve.final_success_share],
                where="post",
                color=ink, lw=1.8, ls=_STYLES[number % len(_STYLES)],
            )  # fmt: skip
        for limit in curve.limits:
            if limit <= high:
                ax.axvline(limit, color=SOFT if same_limits else ink, lw=1.2, alpha=0.8)
    ax.set_xlim(low, high)
    ax.set_ylim(0.0, 1.0)
    ax.yaxis.set_major_formatter(lambda share, _: f"{share:.0%}")
    ax.xaxis.set_major_formatter(lambda s, _: min_sec_text(s))
    ax.set_xticks(_round_times(low, high))
    ax.grid(color=LINE)
    ax.set_axisbelow(True)
    ax.set_xlabel("time of the mission (min:s)", color=SOFT, fontsize=FONT)
    ax.set_ylabel("succeeded by then", color=SOFT, fontsize=FONT)
    _legend_of_curves(ax, curves, high)
    return ax


def _view(times: list[float], limits: list[float]) -> tuple[float, float]:
    """Return the shown range of times in s: from the earliest to the latest end of a run or limit.

    Limits far beyond the longest run are not shown.
    """
    ends = [*times, *(limit for limit in limits if limit <= _FAR * max(times))]
    low, high = min(ends), max(ends)
    margin = 0.08 * max(high - low, 0.05 * high, 1.0)
    return max(0.0, low - margin), high + margin


def _round_times(low: float, high: float) -> list[float]:
    """Return some round times between `low` and `high` in s, for ticks."""
    step = next((step for step in _STEPS if (high - low) / step <= _TICKS), (high - low) / _TICKS)
    first = math.ceil(low / step)
    return [step * k for k in range(first, math.floor(high / step) + 1)]


def _legend_of_curves(ax: "Axes", curves: list[DurationCurve], high: float) -> None:
    """Draw the legend: each curve's plan, its share of successful runs, and its time limits.

    An arrow marks a limit to the right of the shown range, which ends at `high` (s).
    """
    from matplotlib.lines import Line2D

    handles, labels = [], []
    plans = [curve.plan for curve in curves]
    for number, curve in enumerate(curves):
        ink, _ = plan_colour_and_marker(number)
        handles.append(Line2D([], [], color=ink, lw=1.8, ls=_STYLES[number % len(_STYLES)]))
        name = shorten_label(curve.plan.label(plans), 1.4) + ": " if len(curves) > 1 else ""
        limits = ", ".join(
            f"limit {min_sec_text(limit)}" + (" →" if limit > high else "")
            for limit in curve.limits
        )
        labels.append(
            f"{name}{100 * curve.final_success_share:.1f} % succeed, {limits or 'no limit'}"
        )
    _legend(ax, handles, labels)


_MAX_POINTS = 200  # of a row; more points can't be distinguished, and make a page large


def detection_delays(results: EvaluationResults, ax: "Axes | None" = None) -> "Axes":
    """Draw the delay of each fault that was found as a point, by kind of fault, with the median.

    The text beside a row gives how many faults were found of those that occurred. Points are spread
    a little vertically; of very many points only some are shown.
    """
    delays = results.delays
    ax = prepare_axes(ax, 0.75 + 0.26 * max(len(delays), 1))
    if not delays:
        return show_empty(ax, "no fault occurred that can be found")
    rng = generator(0, "delays")
    longest = 1.0
    for row, row_delays in enumerate(delays.values()):
        times = sorted(delay for delay in row_delays if delay is not None)
        # Backwards, so that the longest one is always shown.
        shown = times[:: -max(1, len(times) // _MAX_POINTS)]
        spread = row + 0.5 * (rng.random(len(shown)) - 0.5)
        ax.plot(shown, spread, "o", color=SERIES[0], ms=3.6, alpha=0.45, mew=0, clip_on=False)
        if times:
            longest = max(longest, times[-1])
            middle = median(times)
            ax.plot([middle, middle], [row - 0.36, row + 0.36], color=INK, lw=1.8)
        if not times:
            ax.text(
                0.5, row, "not found", transform=ax.get_yaxis_transform(), ha="center",
                va="center", color=BAD, fontsize=FONT,
            )  # fmt: skip
        missed = len(times) < len(row_delays)
        annotate_row(ax, row, f"{len(times)} of {len(row_delays)}", BAD if missed else SOFT)
    label_rows(ax, [kind.replace("_", " ") for kind in delays])
    ax.set_xlim(0.0, 1.03 * longest)
    ax.grid(axis="x", color=LINE)
    ax.set_axisbelow(True)
    ax.set_xlabel("s until it is found; the line is the median", color=SOFT, fontsize=FONT)
    return ax


_ROLE_COLOURS = {Role.GROUND: GROUND, Role.DECK: DECK, Role.STAIR: STAIR, Role.RAILING: EDGE}
_SINGLE, _SMALLEST, _LARGEST = 5.0, 9.0, 26.0  # diameters of discs in points
_MAX_HEIGHT = 6.5  # inches


def failure_places(
    results: EvaluationResults, site: Site, floor: int, ax: "Axes | None" = None
) -> "Axes":
    """Draw a floor of the site, with a disc at each location where runs failed.

    A larger disc stands for more failed runs, and has their number if there are several.
    Checkpoints are small squares with their numbers.
    """
    from matplotlib.collections import PolyCollection

    floor_plan = next(plan for plan in floor_plans(site) if plan.number == floor)
    x0, y0, x1, y1 = floor_plan.bounds
    ax = prepare_axes(ax, min(_MAX_HEIGHT, WIDTH * (y1 - y0) / (x1 - x0) + 0.3))
    for role, shapes in floor_plan.shapes:
        ink, edge = _ROLE_COLOURS.get(role, STRUCTURE), "none" if role is Role.GROUND else EDGE
        ax.add_collection(
            PolyCollection([*shapes], facecolors=ink, edgecolors=edge, linewidths=0.3)
        )
    for checkpoint in site.checkpoints:
        if checkpoint.floor == floor:
            x, y = checkpoint.position[:2]
            ax.plot([x], [y], "s", color=SOFT, ms=3.0)
            ax.annotate(
                str(checkpoint.id), (x, y), (3, 3), textcoords="offset points",
                fontsize=FONT - 2, color=INK,
            )  # fmt: skip
    clusters = [
        cluster
        for cluster in cluster_failures_by_location(results.unsuccessful_rows)
        if cluster.floor == floor
    ]
    most = max((cluster.runs for cluster in clusters), default=1)
    for cluster in reversed(clusters):  # those with most failures are drawn last, on top
        is_single = cluster.runs == 1
        size = _SINGLE if is_single else max(_SMALLEST, _LARGEST * math.sqrt(cluster.runs / most))
        ax.plot(
            [cluster.at[0]], [cluster.at[1]], "o", ms=size, color=BAD, alpha=0.85, mec=PAPER,
            mew=0.8, zorder=5, clip_on=False,
        )  # fmt: skip
        if not is_single:
            ax.annotate(
                str(cluster.runs), cluster.at[:2], ha="center", va="center", color=PAPER,
                fontsize=FONT - 2 if size < 13 else FONT, zorder=5,
            )  # fmt: skip
    ax.set_xlim(x0, x1)
    ax.set_ylim(y0, y1)
    ax.set_aspect("equal")
    _draw_scale(ax, x0, y0)
    ax.set_axis_off()
    return ax


def _draw_scale(ax: "Axes", x0: float, y0: float) -> None:
    """Draw a scale bar of 2 m at the point (x0, y0), the lower left of a floor."""
    ax.plot([x0, x0 + 2.0], [y0, y0], color=INK, lw=1.5, clip_on=False, zorder=7)
    ax.annotate(
        "2 m", (x0 + 2.0, y0), (4, 0), textcoords="offset points", va="center", color=INK,
        fontsize=FONT - 1, annotation_clip=False,
    )  # fmt: skip


def pairs_that_differ(compared: PlanComparison, ax: "Axes | None" = None) -> "Axes":
    """Draw bars for the pairs of runs in which only one plan succeeds.

    Bars to the right count pairs in which only the first plan (A) succeeds, bars to the left those
    in which only the second plan (B) does. There is a row for all pairs, and one for each set of
    faults.
    """
    rows = {"all faults": compared.successes}
    if len(compared.by_faults) > 1:
        rows |= compared.by_faults
    ax = prepare_axes(ax, 0.9 + 0.26 * len(rows))
    widest = max((max(pairs.first_only, pairs.second_only) for pairs in rows.values()), default=0)
    for y, pairs in enumerate(rows.values()):
        for number, (count, side) in enumerate(((pairs.first_only, 1), (pairs.second_only, -1))):
            ax.barh(
                [y], [side * count], height=0.62, color=plan_colour_and_marker(number)[0], alpha=0.7
            )
            if count:
                ax.annotate(
                    str(count), (side * count, y), (3 * side, 0), textcoords="offset points",
                    ha="left" if side > 0 else "right", va="center", color=INK, fontsize=FONT - 1,
                )  # fmt: skip
    label_rows(ax, [*rows])
    ax.axvline(0.0, color=SOFT, lw=1.0)
    reach = 1.15 * max(widest, 1)
    ax.set_xlim(-reach, reach)
    ax.locator_params(axis="x", integer=True)
    ax.xaxis.set_major_formatter(lambda n, _: f"{abs(n):g}")
    ax.grid(axis="x", color=LINE)
    ax.set_axisbelow(True)
    ax.set_xlabel("← pairs with only B · pairs with only A →", color=SOFT, fontsize=FONT)
    return ax


def histogram_of_duration_differences(compared: PlanComparison, ax: "Axes | None" = None) -> "Axes":
    """Draw a histogram of the differences in duration of pairs in which both plans succeed.

    A positive difference means that the first plan (A) takes longer. The line is the mean, the band
    its 95 % interval.
    """
    differences = np.array(
        [
            (a.duration or 0.0) - (b.duration or 0.0)
            for a, b in compared.pairs
            if a.success and b.success
        ]
    )
    ax = prepare_axes(ax, 2.6)
    if not len(differences):
        return show_empty(ax, "there is no pair in which both succeed")
    spread = float(np.ptp(differences))
    low, high = float(differences.min()), float(differences.max())
    edges = [*np.linspace(low, high, 25)] if spread > 1e-6 else [low - 0.5, low + 0.5]
    mean = compared.duration
    ax.axvspan(mean.low, mean.high, color=INK, alpha=0.12, lw=0)
    ax.hist(differences, bins=edges, color=SERIES[0], alpha=0.6)
    ax.axvline(0.0, color=SOFT, lw=1.0, ls="--")
    ax.axvline(mean.value, color=INK, lw=2.0)
    ax.grid(axis="y", color=LINE)
    ax.set_axisbelow(True)
    ax.locator_params(axis="y", integer=True)
    ax.set_xlabel("s that A takes longer than B in the same world", color=SOFT, fontsize=FONT)
    ax.set_ylabel("pairs", color=SOFT, fontsize=FONT)
    return ax
