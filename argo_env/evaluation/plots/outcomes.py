"""What ends how: faults beside outcomes."""

from collections import Counter
from typing import TYPE_CHECKING

from argo_env.evaluation.case import PlanName
from argo_env.evaluation.plots.canvas import (
    BAD,
    FONT,
    GOOD,
    INK,
    LINE,
    SOFT,
    WARN,
    axes,
    rows_of,
)
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.row import RunOutcome

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_INK = {
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
                ink = _INK[outcome]
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
