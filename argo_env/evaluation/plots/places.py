"""Where on the site runs fail, on the plan of a floor."""

import math
from typing import TYPE_CHECKING

from argo_env.evaluation.places import failure_places_of
from argo_env.evaluation.plots.canvas import (
    BAD,
    DECK,
    EDGE,
    FONT,
    GROUND,
    INK,
    PAPER,
    SOFT,
    STAIR,
    STRUCTURE,
    WIDTH,
    axes,
)
from argo_env.evaluation.results import EvaluationResults
from argo_env.pictures.drawing.floors import plans_of
from argo_env.site import Site
from argo_env.site.shapes import Role

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_INK = {Role.GROUND: GROUND, Role.DECK: DECK, Role.STAIR: STAIR, Role.RAILING: EDGE}
_ONE, _SMALLEST, _LARGEST = 5.0, 9.0, 26.0  # points across
_TALLEST = 6.5  # inches


def failure_places(
    results: EvaluationResults, site: Site, floor: int, ax: "Axes | None" = None
) -> "Axes":
    """The plan of a floor of the site, with a disc where runs failed there and how many did, if it
    was not just one: the more, the larger. Checkpoints are small squares with their numbers."""
    from matplotlib.collections import PolyCollection

    plan = next(one for one in plans_of(site) if one.number == floor)
    x0, y0, x1, y1 = plan.bounds
    ax = axes(ax, min(_TALLEST, WIDTH * (y1 - y0) / (x1 - x0) + 0.3))
    for role, shapes in plan.shapes:
        ink, edge = _INK.get(role, STRUCTURE), "none" if role is Role.GROUND else EDGE
        ax.add_collection(
            PolyCollection([*shapes], facecolors=ink, edgecolors=edge, linewidths=0.3)
        )
    for checkpoint in site.checkpoints:
        if checkpoint.floor == floor:
            x, y = checkpoint.position[:2]
            ax.plot([x], [y], "s", color=SOFT, ms=3.0)
            ax.annotate(
                str(checkpoint.id), (x, y), (3, 3), textcoords="offset points",
                fontsize=FONT - 2, color=INK,
            )  # fmt: skip
    places = [place for place in failure_places_of(results.failing) if place.floor == floor]
    most = max((place.runs for place in places), default=1)
    for place in reversed(places):  # where most failed lies on top
        one = place.runs == 1
        size = _ONE if one else max(_SMALLEST, _LARGEST * math.sqrt(place.runs / most))
        ax.plot(
            [place.at[0]], [place.at[1]], "o", ms=size, color=BAD, alpha=0.85, mec=PAPER, mew=0.8,
            zorder=5, clip_on=False,
        )  # fmt: skip
        if not one:
            ax.annotate(
                str(place.runs), place.at[:2], ha="center", va="center", color=PAPER,
                fontsize=FONT - 2 if size < 13 else FONT, zorder=5,
            )  # fmt: skip
    ax.set_xlim(x0, x1)
    ax.set_ylim(y0, y1)
    ax.set_aspect("equal")
    _scale(ax, x0, y0)
    ax.set_axis_off()
    return ax


def _scale(ax: "Axes", x0: float, y0: float) -> None:
    """A bar of 2 m at the lower left."""
    ax.plot([x0, x0 + 2.0], [y0, y0], color=INK, lw=1.5, clip_on=False, zorder=7)
    ax.annotate(
        "2 m", (x0 + 2.0, y0), (4, 0), textcoords="offset points", va="center", color=INK,
        fontsize=FONT - 1, annotation_clip=False,
    )  # fmt: skip
