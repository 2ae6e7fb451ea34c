"""How long it takes until what is wrong is found."""

from typing import TYPE_CHECKING

from argo_env.evaluation.plots.canvas import ACCENT, BAD, INK, LINE, SOFT, axes
from argo_env.evaluation.results import EvaluationResults
from argo_env.seeding import generator

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def detection_delays(results: EvaluationResults, ax: "Axes | None" = None) -> "Axes":
    """A point for each fault that was found, by its kind, with the median; beside it how many were
    not found. Points are spread a little across, so that none hides another."""
    delays = results.delays
    ax = axes(ax, 7.0, 0.9 + 0.36 * len(delays))
    rng = generator(0, "delays")
    for place, found in enumerate(delays.values()):
        times = [delay for delay in found if delay is not None]
        spread = place + 0.3 * (rng.random(len(times)) - 0.5)
        ax.plot(times, spread, "o", color=ACCENT, ms=3.5, alpha=0.5, mew=0)
        if times:
            median = sorted(times)[len(times) // 2]
            ax.plot([median, median], [place - 0.3, place + 0.3], color=INK, lw=2.0)
        if missed := len(found) - len(times):
            ax.annotate(
                f"{missed} not found", (1.0, place), xycoords=("axes fraction", "data"),
                ha="right", va="center", color=BAD, fontsize=9,
            )  # fmt: skip
    ax.set_yticks(range(len(delays)), [kind.replace("_", " ") for kind in delays], color=INK)
    ax.set_ylim(len(delays) - 0.5, -0.5)
    ax.set_xlim(left=0.0)
    ax.grid(axis="x", color=LINE)
    ax.spines["left"].set_visible(False)
    ax.tick_params(axis="y", length=0)
    ax.set_xlabel("s from its beginning until it is found; the line is the median", color=SOFT)
    ax.xaxis.label.set_fontsize(9)
    return ax
