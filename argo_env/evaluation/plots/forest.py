"""The rates of all plans and their cases, each with its interval."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from argo_env.evaluation.plots.canvas import ACCENT, INK, LINE, SOFT, axes
from argo_env.evaluation.results import EvaluationResults

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_ROW = 0.27  # inches


def forest_of_rates(results: EvaluationResults, ax: "Axes | None" = None) -> "Axes":
    """Each plan's rate of success with its interval of 95 %, and below it those by faults."""
    rows = [*_rows(results)]
    ax = axes(ax, 7.0, 0.8 + _ROW * len(rows))
    for place, (_, value, low, high, whole) in enumerate(rows):
        ink = INK if whole else ACCENT
        ax.plot([low, high], [place, place], color=ink, lw=2.4 if whole else 1.6, zorder=2)
        if value == value:  # not NaN: there were runs
            ax.plot([value], [place], "D" if whole else "o", color=ink, ms=6 if whole else 4.5)
    for requirement in results.plan.stopping.require:
        if requirement.quantity == "success":
            ax.axvline(requirement.share, color="#b45309", lw=1.0, ls="--", zorder=1)
    ax.set_yticks(range(len(rows)), [row[0] for row in rows], color=INK)
    ax.set_ylim(len(rows) - 0.5, -0.5)
    ax.set_xlim(-0.02, 1.02)
    ax.xaxis.set_major_formatter(lambda share, _: f"{share:.0%}")
    ax.grid(axis="x", color=LINE, zorder=0)
    ax.spines["left"].set_visible(False)
    ax.tick_params(axis="y", length=0)
    ax.set_xlabel("success, with the interval of 95 %", color=SOFT, fontsize=9)
    return ax


def _rows(results: EvaluationResults) -> Iterator[tuple[str, float, float, float, bool]]:
    for plan in results.plan.plans:
        rate = results.rate(plan)
        name = plan.beside(results.plan.plans)
        yield shortened(f"{name} ({rate.runs})"), rate.value, rate.low, rate.high, True
        groups = results.by_faults(plan)
        for group in groups if len(groups) > 1 else ():
            one = group.rate
            label = shortened(f"{group.name} ({one.runs})")
            yield label, one.value, one.low, one.high, False


def shortened(name: str, most: int = 38) -> str:
    """A name that fits beside axes, in which nothing is taken for a formula."""
    name = name.replace("$", r"\$")
    return name if len(name) <= most else f"{name[: most - 1]}…"
