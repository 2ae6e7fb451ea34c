"""In which pairs only one of two plans succeeds, by faults."""

from typing import TYPE_CHECKING

from argo_env.evaluation.comparison import PlanComparison
from argo_env.evaluation.plots.canvas import FONT, INK, LINE, SOFT, axes, mark, rows_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def pairs_that_differ(compared: PlanComparison, ax: "Axes | None" = None) -> "Axes":
    """Bars to both sides: pairs in which only the first plan (A) succeeds to the right, those in
    which only the second one (B) does to the left; a row for all, and one for each set of faults.
    """
    rows = {"all faults": compared.successes}
    if len(compared.by_faults) > 1:
        rows |= compared.by_faults
    ax = axes(ax, 0.9 + 0.26 * len(rows))
    widest = max((max(own.first_only, own.second_only) for own in rows.values()), default=0)
    for y, own in enumerate(rows.values()):
        for number, (count, side) in enumerate(((own.first_only, 1), (own.second_only, -1))):
            ax.barh([y], [side * count], height=0.62, color=mark(number)[0], alpha=0.7)
            if count:
                ax.annotate(
                    str(count), (side * count, y), (3 * side, 0), textcoords="offset points",
                    ha="left" if side > 0 else "right", va="center", color=INK, fontsize=FONT - 1,
                )  # fmt: skip
    rows_of(ax, [*rows])
    ax.axvline(0.0, color=SOFT, lw=1.0)
    reach = 1.15 * max(widest, 1)
    ax.set_xlim(-reach, reach)
    ax.locator_params(axis="x", integer=True)
    ax.xaxis.set_major_formatter(lambda n, _: f"{abs(n):g}")
    ax.grid(axis="x", color=LINE)
    ax.set_axisbelow(True)
    ax.set_xlabel("← pairs with only B · pairs with only A →", color=SOFT, fontsize=FONT)
    return ax
