"""By how much two plans differ, world by world."""

from typing import TYPE_CHECKING

import numpy as np

from argo_env.evaluation.comparison import PlanComparison
from argo_env.evaluation.plots.canvas import ACCENT, INK, LINE, SOFT, axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes


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
    ax = axes(ax, 7.0, 2.6)
    ax.axvline(0.0, color=SOFT, lw=1.0)
    if len(gaps):
        spread = float(np.ptp(gaps))
        ax.hist(gaps, bins=24 if spread > 0 else 1, color=ACCENT, alpha=0.55)
        mean = compared.duration
        ax.axvspan(mean.low, mean.high, color=INK, alpha=0.15, lw=0)
        ax.axvline(mean.value, color=INK, lw=2.0)
    ax.grid(axis="y", color=LINE)
    ax.set_axisbelow(True)
    ax.set_xlabel("s that A takes longer than B in the same world", color=SOFT, fontsize=9)
    ax.set_ylabel("pairs", color=SOFT, fontsize=9)
    return ax
