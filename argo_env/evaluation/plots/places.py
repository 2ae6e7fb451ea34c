"""Where on the site runs fail, on the plan of a floor."""

from typing import TYPE_CHECKING

from argo_env.evaluation.plots.canvas import BAD, axes
from argo_env.evaluation.results import EvaluationResults
from argo_env.pictures.drawing.floors import plans_of
from argo_env.site import Site
from argo_env.site.shapes import Role

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_INK = {
    Role.GROUND: "#f1f3f5", Role.DECK: "#e3e8ed", Role.STAIR: "#c9d2da",
    Role.RAILING: "#9aa7b3", Role.STRUCTURE: "#b8c2cc",
}  # fmt: skip
_OTHER = "#aab6c1"


def failure_places(
    results: EvaluationResults, site: Site, floor: int, ax: "Axes | None" = None
) -> "Axes":
    """The plan of a floor of the site, with a mark where each run failed there; marks that lie on
    one another are the darker."""
    from matplotlib.collections import PolyCollection

    plan = next(one for one in plans_of(site) if one.number == floor)
    x0, y0, x1, y1 = plan.bounds
    ax = axes(ax, 6.0, max(2.0, 6.0 * (y1 - y0) / (x1 - x0)))
    for role, shapes in plan.shapes:
        ink = _INK.get(role, _OTHER)
        ax.add_collection(PolyCollection([*shapes], facecolors=ink, edgecolors="none"))
    for checkpoint in site.checkpoints:
        if checkpoint.floor == floor:
            x, y = checkpoint.position[:2]
            ax.plot([x], [y], "s", color="#92400e", ms=3.5)
            ax.annotate(
                str(checkpoint.id), (x, y), (3, 2), textcoords="offset points", fontsize=7,
                color="#92400e",
            )  # fmt: skip
    places = [row.place for row in results.failing if row.place and row.floor == floor]
    if places:
        ax.scatter(
            [place[0] for place in places], [place[1] for place in places],
            s=60, color=BAD, alpha=max(0.15, min(0.7, 6.0 / len(places))), linewidths=0, zorder=5,
        )  # fmt: skip
    ax.set_xlim(x0, x1)
    ax.set_ylim(y0, y1)
    ax.set_aspect("equal")
    ax.set_axis_off()
    return ax
