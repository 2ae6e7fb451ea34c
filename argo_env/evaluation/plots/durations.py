"""How long missions take, beside how long they may."""

from typing import TYPE_CHECKING

import numpy as np

from argo_env.evaluation.plots.canvas import BAD, LINE, SERIES, SOFT, axes
from argo_env.evaluation.plots.forest import shortened
from argo_env.evaluation.results import EvaluationResults

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def durations(results: EvaluationResults, ax: "Axes | None" = None) -> "Axes":
    """The share of each plan's runs that had succeeded by a time (empirical distribution): a run
    that failed never does. Limits are dashed."""
    ax = axes(ax, 7.0, 3.2)
    plans = results.plan.plans
    for number, plan in enumerate(plans):
        ran = [row for row in results.of(plan) if row.carried_out]
        times = np.sort([row.duration for row in ran if row.success and row.duration is not None])
        if not len(times):
            continue
        shares = np.arange(1, len(times) + 1) / len(ran)
        ax.step(
            np.concatenate([[times[0]], times]),
            np.concatenate([[0.0], shares]),
            where="post",
            color=SERIES[number % len(SERIES)],
            lw=1.8,
            label=shortened(plan.beside(plans)),
        )
    limits = sorted({row.limit for row in results.rows if row.limit is not None})
    for limit in limits:
        ax.axvline(limit, color=BAD, lw=1.0, ls="--")
    ax.set_ylim(0.0, 1.03)
    ax.yaxis.set_major_formatter(lambda share, _: f"{share:.0%}")
    ax.xaxis.set_major_formatter(lambda s, _: f"{round(s) // 60:02d}:{round(s) % 60:02d}")
    ax.grid(color=LINE)
    ax.set_xlabel("time of the mission (min:s)", color=SOFT, fontsize=9)
    ax.set_ylabel("succeeded by then", color=SOFT, fontsize=9)
    if len(plans) > 1 and ax.get_legend_handles_labels()[0]:
        ax.legend(frameon=False, fontsize=9, loc="lower right")
    return ax
