"""What ends how: faults beside outcomes."""

from typing import TYPE_CHECKING

import numpy as np

from argo_env.evaluation.plots.canvas import INK, axes
from argo_env.evaluation.plots.forest import shortened
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.row import RunOutcome

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def outcomes_by_faults(results: EvaluationResults, ax: "Axes | None" = None) -> "Axes":
    """A heat map: of the runs with each set of faults, the share that ended in each way, and how
    many these are."""
    names = [*dict.fromkeys(results.faults_of(row) for row in results.rows)]
    counts = np.zeros((len(names), len(RunOutcome)), dtype=int)
    for row in results.rows:
        counts[names.index(results.faults_of(row)), [*RunOutcome].index(row.outcome)] += 1
    ax = axes(ax, 6.0, 0.9 + 0.32 * len(names))
    shares = counts / np.maximum(counts.sum(axis=1, keepdims=True), 1)
    # Drawn as shapes: a page may forbid pictures.
    edges_x, edges_y = np.arange(counts.shape[1] + 1) - 0.5, np.arange(len(names) + 1) - 0.5
    ax.pcolormesh(edges_x, edges_y, shares, cmap="Blues", vmin=0.0, vmax=1.0, ec="white", lw=1.5)
    ax.set_ylim(len(names) - 0.5, -0.5)
    for (y, x), count in np.ndenumerate(counts):
        if count:
            ink = "white" if shares[y, x] > 0.55 else INK
            ax.text(x, y, str(count), ha="center", va="center", color=ink, fontsize=9)
    ax.set_yticks(range(len(names)), [shortened(name) for name in names], color=INK)
    ax.set_xticks(range(len(RunOutcome)), [*RunOutcome], color=INK)
    ax.xaxis.tick_top()
    ax.tick_params(length=0)
    for spine in ax.spines.values():
        spine.set_visible(False)
    return ax
