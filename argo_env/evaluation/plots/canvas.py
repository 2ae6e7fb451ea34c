"""Axes to draw on, colours, and figures as SVG."""

import io
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

INK, SOFT, LINE = "#1c2733", "#5b6b7c", "#dde3ea"
GOOD, BAD, WARN, ACCENT = "#15803d", "#c81e1e", "#b45309", "#1d4ed8"
SERIES = (ACCENT, "#c2410c", "#0f766e", "#7c3aed", "#a16207", "#be185d", "#334155", "#65a30d")
"""the colours of plans, one after the other"""


def axes(ax: "Axes | None", width: float = 7.0, height: float = 3.0) -> "Axes":
    """The axes that are given, or those of a new figure of that size (inches)."""
    if ax is None:
        from matplotlib.figure import Figure

        ax = Figure(figsize=(width, height), layout="constrained").subplots()
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        ax.spines[side].set_color(SOFT)
    ax.tick_params(colors=SOFT, labelsize=9)
    return ax


def as_svg(ax: "Axes") -> str:
    """The figure of the axes as an `svg` element; equal figures give equal text."""
    import matplotlib

    figure = ax.figure
    content = io.StringIO()
    # Text stays text, and names that would be drawn at random are derived from what is drawn.
    with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": "argo"}):
        _root(figure).savefig(content, format="svg", transparent=True, metadata={"Date": None})
    text = content.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.S)
    opening = re.compile(r'<svg [^>]*?viewBox="([^"]+)"[^>]*>')
    return opening.sub(r'<svg viewBox="\1" role="img">', text, count=1)


def _root(figure: object) -> "Figure":
    from matplotlib.figure import Figure

    assert isinstance(figure, Figure)
    return figure
