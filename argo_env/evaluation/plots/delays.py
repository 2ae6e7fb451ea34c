"""How long it takes until what is wrong is found."""

from statistics import median
from typing import TYPE_CHECKING

from argo_env.evaluation.plots.canvas import (
    BAD,
    FONT,
    INK,
    LINE,
    SERIES,
    SOFT,
    axes,
    beside,
    nothing,
    rows_of,
)
from argo_env.evaluation.results import EvaluationResults
from argo_env.seeding import generator

if TYPE_CHECKING:
    from matplotlib.axes import Axes

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
