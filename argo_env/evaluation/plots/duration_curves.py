"""How long missions take, beside how long they may."""

import math
from typing import TYPE_CHECKING

from argo_env.evaluation.durations import DurationCurve, duration_curve
from argo_env.evaluation.plots.canvas import FONT, INK, LINE, SOFT, axes, mark, nothing, plain
from argo_env.evaluation.results import EvaluationResults
from argo_env.formatting import clock

if TYPE_CHECKING:
    from matplotlib.axes import Axes

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
    _legend(ax, curves, high)
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


def _legend(ax: "Axes", curves: list[DurationCurve], high: float) -> None:
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
    ax.legend(
        handles, words, frameon=False, fontsize=FONT, labelcolor=INK, loc="lower left",
        bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2,
    )  # fmt: skip
