"""The rates of all plans, over all faults and with each of them, with their intervals."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from argo_env.evaluation.case import PlanName
from argo_env.evaluation.plots.canvas import (
    FONT,
    INK,
    LINE,
    SERIES,
    SOFT,
    WARN,
    axes,
    beside,
    mark,
    plain,
    rows_of,
)
from argo_env.evaluation.rates import PlanRate
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.statistics.rates import Rate

if TYPE_CHECKING:
    from matplotlib.axes import Axes

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
        _legend(ax, plans)
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


def _legend(ax: "Axes", plans: tuple[PlanName, ...]) -> None:
    from matplotlib.lines import Line2D

    handles = []
    for number in range(len(plans)):
        ink, sign = mark(number)
        handles.append(Line2D([], [], color=ink, marker=sign, lw=1.8, ms=5))
    names = [plain(plan.beside(plans), 2.3) for plan in plans]
    ax.legend(
        handles, names, frameon=False, fontsize=FONT, labelcolor=INK, loc="lower left",
        bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2,
    )  # fmt: skip
