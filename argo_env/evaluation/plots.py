"""Pictures of evaluations: functions that draw on the axes that they are given, and return them."""

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
    cluster_failures,
    duration_curve,
)
from argo_env.evaluation.row import RunOutcome
from argo_env.formatting import clock
from argo_env.pictures.drawing.floors import plans_of
from argo_env.report.svg import clean, shorten
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
"""the colours of plans, one after the other"""
MARKS = ("o", "s", "^", "D", "v", "P", "X")
"""the marks of plans: they differ without colours too, and less often are the same as these"""
GROUND, DECK, STAIR, STRUCTURE, EDGE = "#f1f3f5", "#e3e8ed", "#c9d2da", "#aab6c1", "#9aa7b3"
"""what a site is made of"""

WIDTH = 4.6  # inches, of a figure that can be read on a phone
FONT = 9.0  # points; smaller ones are for what can be read elsewhere as well


def axes(ax: "Axes | None", height: float = 3.0, width: float = WIDTH) -> "Axes":
    """The axes that are given, or those of a new figure of that size (inches), which pyplot knows
    nothing of: `axes.figure` shows it in a notebook."""
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


def rows_of(ax: "Axes", names: list[str]) -> None:
    """Gives the axes a row for each name, from above."""
    ax.set_yticks(range(len(names)), [plain(name) for name in names], color=INK)
    ax.set_ylim(max(len(names), 1) - 0.5, -0.5)
    ax.spines["left"].set_visible(False)
    ax.tick_params(axis="y", length=0, pad=7)


def beside(ax: "Axes", y: float, text: str, colour: str = SOFT) -> None:
    """A word at the right of the axes, at the height of a row."""
    ax.annotate(
        text, (1.02, y), xycoords=("axes fraction", "data"), ha="left", va="center",
        color=colour, fontsize=FONT - 1, annotation_clip=False,
    )  # fmt: skip


def nothing(ax: "Axes", why: str) -> "Axes":
    """Axes that say why there is nothing in them."""
    ax.set_axis_off()
    ax.text(0.5, 0.5, why, transform=ax.transAxes, ha="center", color=SOFT, fontsize=FONT)
    return ax


def mark(number: int) -> tuple[str, str]:
    """The colour and the mark of a plan, by its number."""
    return SERIES[number % len(SERIES)], MARKS[number % len(MARKS)]


def _legend(ax: "Axes", handles: list["Line2D"], words: list[str]) -> None:
    """Says above the axes, from the left, what lines stand for."""
    ax.legend(
        handles, words, frameon=False, fontsize=FONT, labelcolor=INK, loc="lower left",
        bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2,
    )  # fmt: skip


def plain(name: str, room: float = 1.65) -> str:
    """A name that fits into so much room (inches) beside axes: one line, in which nothing is taken
    for a formula, or for a name that legends leave out."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import TextToPath

    font = FontProperties(size=FONT)
    name = shorten(" ".join(clean(name).split()), 80)
    while len(name) > 1 and (
        TextToPath().get_text_width_height_descent(name, font, False)[0] > 72.0 * room
    ):
        name = shorten(name, len(name) - 1)
    name = name.replace("$", r"\$")
    return f" {name}" if name.startswith("_") else name


_LANE, _GAP = 0.16, 0.1  # inches
_ALL = "all faults"


@dataclass(frozen=True)
class _Line:
    """An interval, and where it goes."""

    row: int
    lane: float
    """-0.5 to 0.5, within the row"""
    plan: int
    rate: PlanRate | Rate
    said: str


def forest_of_rates(results: EvaluationResults, ax: "Axes | None" = None) -> "Axes":
    """Each plan's rate of success with its interval of 95 %, and below it the rates by faults.
    Plans stand below one another in each row; at the right of it is how many runs succeeded."""
    names, lines = _lines(results)
    plans = results.plan.plans
    lanes = len(plans) if len(names) > 1 and names[0] == _ALL else 1
    ax = axes(ax, 0.75 + (_LANE * lanes + _GAP) * len(names) + 0.22 * (lanes > 1) * len(plans))
    for line in lines:
        ink, sign = mark(line.plan) if lanes > 1 else (SERIES[0], "o")
        whole, y = isinstance(line.rate, PlanRate), line.row + line.lane
        width = 2.6 if whole else 1.5
        ax.plot([line.rate.low, line.rate.high], [y, y], color=ink, lw=width, zorder=2)
        if line.rate.runs:
            size = 6.5 if whole else 4.5
            ax.plot([line.rate.value], [y], sign, color=ink, ms=size, zorder=3, clip_on=False)
        beside(ax, y, line.said, INK if whole else SOFT)
    for requirement in results.plan.stopping.require:
        if requirement.quantity == "success":
            ax.axvline(requirement.share, color=WARN, lw=1.0, ls="--", zorder=1)
    rows_of(ax, names)
    if names[0] == _ALL:
        ax.axhline(0.5, color=SOFT, lw=0.8)
    ax.set_xlim(0.0, 1.0)
    ax.xaxis.set_major_formatter(lambda share, _: f"{share:.0%}")
    ax.grid(axis="x", color=LINE, zorder=0)
    ax.set_xlabel("success, with the interval of 95 %", color=SOFT, fontsize=FONT)
    if lanes > 1:
        _legend_of_plans(ax, plans)
    return ax


def _lines(results: EvaluationResults) -> tuple[list[str], list[_Line]]:
    """The names of the rows, and what stands in them."""
    plans = results.plan.plans
    groups = [results.by_faults(plan) for plan in plans]
    rates = [results.rate(plan) for plan in plans]
    if all(len(own) < 2 for own in groups):
        return [plan.beside(plans) for plan in plans], [
            _Line(row, 0.0, row, rate, _percent(rate)) for row, rate in enumerate(rates)
        ]
    names = [_ALL, *dict.fromkeys(group.name for own in groups for group in own)]
    lines = []
    for number, (rate, own) in enumerate(zip(rates, groups, strict=True)):
        lane = 0.72 * ((number + 0.5) / len(plans) - 0.5)
        lines.append(_Line(0, lane, number, rate, _percent(rate)))
        for group in own:
            said = f"{group.rate.count} of {group.rate.runs}"
            lines.append(_Line(names.index(group.name, 1), lane, number, group.rate, said))
    return names, lines


def _percent(rate: PlanRate) -> str:
    return f"{100 * rate.value:.1f} %" if rate.runs else "no run"


def _legend_of_plans(ax: "Axes", plans: tuple[PlanName, ...]) -> None:
    from matplotlib.lines import Line2D

    handles = []
    for number in range(len(plans)):
        ink, sign = mark(number)
        handles.append(Line2D([], [], color=ink, marker=sign, lw=1.8, ms=5))
    names = [plain(plan.beside(plans), 2.3) for plan in plans]
    _legend(ax, handles, names)


_INK_OF_OUTCOMES = {
    RunOutcome.SUCCESS: GOOD, RunOutcome.FAILURE: BAD,
    RunOutcome.ERROR: WARN, RunOutcome.DIED: WARN,
}  # fmt: skip
_DARKEST = 0.5
"""of what all runs ended in; the number in it can be read in light and in dark"""


def outcomes_by_faults(
    results: EvaluationResults, ax: "Axes | None" = None, plan: PlanName | None = None
) -> "Axes":
    """A heat map: of the runs with each set of faults, how many ended in each way; the more of
    them, the darker. Of one of the plans, or of all."""
    from matplotlib.patches import Rectangle

    rows = results.rows if plan is None else results.of(plan)
    counts: dict[str, Counter[RunOutcome]] = {}
    for row in rows:
        counts.setdefault(results.faults_of(row), Counter())[row.outcome] += 1
    always = (RunOutcome.SUCCESS, RunOutcome.FAILURE)
    ended = [o for o in RunOutcome if o in always or any(own[o] for own in counts.values())]
    ax = axes(ax, 0.5 + 0.26 * max(len(counts), 1))
    for y, own in enumerate(counts.values()):
        for x, outcome in enumerate(ended):
            share = own[outcome] / own.total()
            # Drawn as shapes: a page may forbid pictures.
            box = (x - 0.48, y - 0.46), 0.96, 0.92
            ax.add_patch(Rectangle(*box, facecolor="none", edgecolor=LINE, linewidth=0.8))
            if share:
                ink = _INK_OF_OUTCOMES[outcome]
                ax.add_patch(Rectangle(*box, color=ink, alpha=0.12 + (_DARKEST - 0.12) * share))
            colour = INK if share else SOFT
            ax.text(x, y, str(own[outcome]), ha="center", va="center", color=colour, fontsize=FONT)
    rows_of(ax, [*counts])
    ax.set_xlim(-0.5, len(ended) - 0.5)
    ax.set_xticks(range(len(ended)), [outcome.value for outcome in ended], color=INK)
    ax.xaxis.tick_top()
    ax.tick_params(length=0)
    for spine in ax.spines.values():
        spine.set_visible(False)
    return ax


_STEPS = (1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 14400)  # s
_TICKS = 6
_STYLES = ("-", "--", "-.", ":")
_FAR = 1.35
"""a limit that is so many times as long as the longest run would press all runs to one side"""


def durations(results: EvaluationResults, ax: "Axes | None" = None) -> "Axes":
    """The share of each plan's runs that had succeeded by a time (empirical distribution): a run
    that failed never does, so that the line ends below 100 %. Limits are thin lines."""
    plans = results.plan.plans
    curves = [duration_curve(results, plan) for plan in plans]
    ax = axes(ax, 2.6 + 0.2 * len(plans))
    times = [time for curve in curves for time in curve.times]
    if not times:
        return nothing(ax, "no run succeeded")
    low, high = _view(times, [limit for curve in curves for limit in curve.limits])
    same = len({curve.limits for curve in curves}) == 1
    for number, curve in enumerate(curves):
        ink, _ = mark(number)
        if curve.times:
            ax.step(
                [low, *curve.times, high], [0.0, *curve.shares, curve.last], where="post",
                color=ink, lw=1.8, ls=_STYLES[number % len(_STYLES)],
            )  # fmt: skip
        for limit in curve.limits:
            if limit <= high:
                ax.axvline(limit, color=SOFT if same else ink, lw=1.2, alpha=0.8)
    ax.set_xlim(low, high)
    ax.set_ylim(0.0, 1.0)
    ax.yaxis.set_major_formatter(lambda share, _: f"{share:.0%}")
    ax.xaxis.set_major_formatter(lambda s, _: clock(s))
    ax.set_xticks(_whole_times(low, high))
    ax.grid(color=LINE)
    ax.set_axisbelow(True)
    ax.set_xlabel("time of the mission (min:s)", color=SOFT, fontsize=FONT)
    ax.set_ylabel("succeeded by then", color=SOFT, fontsize=FONT)
    _legend_of_curves(ax, curves, high)
    return ax


def _view(times: list[float], limits: list[float]) -> tuple[float, float]:
    """From when to when (s) is shown: where runs end, and limits that are not far from there."""
    ends = [*times, *(limit for limit in limits if limit <= _FAR * max(times))]
    low, high = min(ends), max(ends)
    margin = 0.08 * max(high - low, 0.05 * high, 1.0)
    return max(0.0, low - margin), high + margin


def _whole_times(low: float, high: float) -> list[float]:
    """Some times (s) between these that people find round."""
    step = next((one for one in _STEPS if (high - low) / one <= _TICKS), (high - low) / _TICKS)
    first = math.ceil(low / step)
    return [step * k for k in range(first, math.floor(high / step) + 1)]


def _legend_of_curves(ax: "Axes", curves: list[DurationCurve], high: float) -> None:
    """Names each line, what share never comes to an end, and the limit."""
    from matplotlib.lines import Line2D

    handles, words = [], []
    plans = [curve.plan for curve in curves]
    for number, curve in enumerate(curves):
        ink, _ = mark(number)
        handles.append(Line2D([], [], color=ink, lw=1.8, ls=_STYLES[number % len(_STYLES)]))
        name = plain(curve.plan.beside(plans), 1.4) + ": " if len(curves) > 1 else ""
        limits = ", ".join(
            f"limit {clock(limit)}" + (" →" if limit > high else "") for limit in curve.limits
        )
        words.append(f"{name}{100 * curve.last:.1f} % succeed, {limits or 'no limit'}")
    _legend(ax, handles, words)


_MOST = 200  # points of a row; more are one grey mass, and make a page long


def detection_delays(results: EvaluationResults, ax: "Axes | None" = None) -> "Axes":
    """A point for each fault that was found, by its kind, with the median; beside it how many were
    found of how many. Points are spread a little across; of very many some are shown."""
    delays = results.delays
    ax = axes(ax, 0.75 + 0.26 * max(len(delays), 1))
    if not delays:
        return nothing(ax, "no fault happened that can be found")
    rng = generator(0, "delays")
    longest = 1.0
    for place, found in enumerate(delays.values()):
        times = sorted(delay for delay in found if delay is not None)
        shown = times[
            :: -max(1, len(times) // _MOST)
        ]  # from the longest on, which is never left out
        spread = place + 0.5 * (rng.random(len(shown)) - 0.5)
        ax.plot(shown, spread, "o", color=SERIES[0], ms=3.6, alpha=0.45, mew=0, clip_on=False)
        if times:
            longest = max(longest, times[-1])
            middle = median(times)
            ax.plot([middle, middle], [place - 0.36, place + 0.36], color=INK, lw=1.8)
        if not times:
            ax.text(
                0.5, place, "not found", transform=ax.get_yaxis_transform(), ha="center",
                va="center", color=BAD, fontsize=FONT,
            )  # fmt: skip
        missed = len(times) < len(found)
        beside(ax, place, f"{len(times)} of {len(found)}", BAD if missed else SOFT)
    rows_of(ax, [kind.replace("_", " ") for kind in delays])
    ax.set_xlim(0.0, 1.03 * longest)
    ax.grid(axis="x", color=LINE)
    ax.set_axisbelow(True)
    ax.set_xlabel("s until it is found; the line is the median", color=SOFT, fontsize=FONT)
    return ax


_INK_OF_ROLES = {Role.GROUND: GROUND, Role.DECK: DECK, Role.STAIR: STAIR, Role.RAILING: EDGE}
_ONE, _SMALLEST, _LARGEST = 5.0, 9.0, 26.0  # points across
_TALLEST = 6.5  # inches


def failure_places(
    results: EvaluationResults, site: Site, floor: int, ax: "Axes | None" = None
) -> "Axes":
    """The plan of a floor of the site, with a disc where runs failed there and how many did, if it
    was not just one: the more, the larger. Checkpoints are small squares with their numbers."""
    from matplotlib.collections import PolyCollection

    plan = next(one for one in plans_of(site) if one.number == floor)
    x0, y0, x1, y1 = plan.bounds
    ax = axes(ax, min(_TALLEST, WIDTH * (y1 - y0) / (x1 - x0) + 0.3))
    for role, shapes in plan.shapes:
        ink, edge = _INK_OF_ROLES.get(role, STRUCTURE), "none" if role is Role.GROUND else EDGE
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
    places = [place for place in cluster_failures(results.failing) if place.floor == floor]
    most = max((place.runs for place in places), default=1)
    for place in reversed(places):  # where most failed lies on top
        one = place.runs == 1
        size = _ONE if one else max(_SMALLEST, _LARGEST * math.sqrt(place.runs / most))
        ax.plot(
            [place.at[0]], [place.at[1]], "o", ms=size, color=BAD, alpha=0.85, mec=PAPER, mew=0.8,
            zorder=5, clip_on=False,
        )  # fmt: skip
        if not one:
            ax.annotate(
                str(place.runs), place.at[:2], ha="center", va="center", color=PAPER,
                fontsize=FONT - 2 if size < 13 else FONT, zorder=5,
            )  # fmt: skip
    ax.set_xlim(x0, x1)
    ax.set_ylim(y0, y1)
    ax.set_aspect("equal")
    _scale(ax, x0, y0)
    ax.set_axis_off()
    return ax


def _scale(ax: "Axes", x0: float, y0: float) -> None:
    """A bar of 2 m at the lower left."""
    ax.plot([x0, x0 + 2.0], [y0, y0], color=INK, lw=1.5, clip_on=False, zorder=7)
    ax.annotate(
        "2 m", (x0 + 2.0, y0), (4, 0), textcoords="offset points", va="center", color=INK,
        fontsize=FONT - 1, annotation_clip=False,
    )  # fmt: skip


def pairs_that_differ(compared: PlanComparison, ax: "Axes | None" = None) -> "Axes":
    """Bars to both sides: pairs in which only the first plan (A) succeeds to the right, those in
    which only the second one (B) does to the left; a row for all, and one for each set of faults.
    """
    rows = {"all faults": compared.successes}
    if len(compared.by_faults) > 1:
        rows |= compared.by_faults
    ax = axes(ax, 0.9 + 0.26 * len(rows))
    widest = max((max(own.first_only, own.second_only) for own in rows.values()), default=0)
    for y, own in enumerate(rows.values()):
        for number, (count, side) in enumerate(((own.first_only, 1), (own.second_only, -1))):
            ax.barh([y], [side * count], height=0.62, color=mark(number)[0], alpha=0.7)
            if count:
                ax.annotate(
                    str(count), (side * count, y), (3 * side, 0), textcoords="offset points",
                    ha="left" if side > 0 else "right", va="center", color=INK, fontsize=FONT - 1,
                )  # fmt: skip
    rows_of(ax, [*rows])
    ax.axvline(0.0, color=SOFT, lw=1.0)
    reach = 1.15 * max(widest, 1)
    ax.set_xlim(-reach, reach)
    ax.locator_params(axis="x", integer=True)
    ax.xaxis.set_major_formatter(lambda n, _: f"{abs(n):g}")
    ax.grid(axis="x", color=LINE)
    ax.set_axisbelow(True)
    ax.set_xlabel("← pairs with only B · pairs with only A →", color=SOFT, fontsize=FONT)
    return ax


def paired_differences(compared: PlanComparison, ax: "Axes | None" = None) -> "Axes":
    """A histogram of how much longer the first plan takes than the second in the same world, where
    both succeed, with the mean and its interval of 95 %."""
    gaps = np.array(
        [
            (a.duration or 0.0) - (b.duration or 0.0)
            for a, b in compared.pairs
            if a.success and b.success
        ]
    )
    ax = axes(ax, 2.6)
    if not len(gaps):
        return nothing(ax, "there is no pair of which both succeed")
    spread = float(np.ptp(gaps))
    low, high = float(gaps.min()), float(gaps.max())
    edges = [*np.linspace(low, high, 25)] if spread > 1e-6 else [low - 0.5, low + 0.5]
    mean = compared.duration
    ax.axvspan(mean.low, mean.high, color=INK, alpha=0.12, lw=0)
    ax.hist(gaps, bins=edges, color=SERIES[0], alpha=0.6)
    ax.axvline(0.0, color=SOFT, lw=1.0, ls="--")
    ax.axvline(mean.value, color=INK, lw=2.0)
    ax.grid(axis="y", color=LINE)
    ax.set_axisbelow(True)
    ax.locator_params(axis="y", integer=True)
    ax.set_xlabel("s that A takes longer than B in the same world", color=SOFT, fontsize=FONT)
    ax.set_ylabel("pairs", color=SOFT, fontsize=FONT)
    return ax
