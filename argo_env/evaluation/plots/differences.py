"""By how much two plans differ, world by world."""

from typing import TYPE_CHECKING

import numpy as np

from argo_env.evaluation.comparison import PlanComparison
from argo_env.evaluation.plots.canvas import FONT, INK, LINE, SERIES, SOFT, axes, nothing

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
