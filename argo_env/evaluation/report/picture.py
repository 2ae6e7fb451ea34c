"""A plot as an inline SVG in the colours of the page, which are others in the dark."""

import io
import re
import warnings
from collections.abc import Callable
from typing import TYPE_CHECKING
from xml.etree import ElementTree

import matplotlib
from markupsafe import Markup
from matplotlib.figure import Figure

from argo_env.evaluation import plots
from argo_env.report.svg import clean, markup

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PALETTE = {
    "ink": plots.INK, "soft": plots.SOFT, "line": plots.LINE, "paper": plots.PAPER,
    "good": plots.GOOD, "bad": plots.BAD, "notice": plots.WARN, "site-ground": plots.GROUND,
    "site-deck": plots.DECK, "site-stair": plots.STAIR, "site-structure": plots.STRUCTURE,
    "site-edge": plots.EDGE,
    **{f"series-{k}": ink for k, ink in enumerate(plots.SERIES)},
}  # fmt: skip
"""what the page calls the colours that plots are drawn in"""

_LARGEST = 1.5  # px of a page for 1 point of a figure
_NAMES = {ink: name for name, ink in PALETTE.items()}
_COLOUR = re.compile("|".join(_NAMES))
_LONG = re.compile(r"(\d+\.\d\d)\d+")
_REFERENCE = re.compile(r"#([\w-]+)")


def picture(alt: str, draw: Callable[[], "Axes"]) -> Markup:
    """What `draw` draws on a figure of its own; `alt` says in words what there is to be seen. Equal
    plots with equal words give equal text."""
    with warnings.catch_warnings():
        # The browser's font draws it, whether or not that of the machine that made it can.
        warnings.filterwarnings("ignore", "Glyph .* missing from")
        # Text stays text, and names of shapes come from what they are and from the picture's.
        with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": alt}):
            content = io.BytesIO()
            figure = draw().figure
            assert isinstance(figure, Figure)
            figure.savefig(content, format="svg", transparent=True, metadata={"Date": None})
    return _inline(ElementTree.fromstring(content.getvalue()), alt)


def _inline(svg: ElementTree.Element, alt: str) -> Markup:
    """The drawing as an element of a page: without what would count for the whole of the page."""
    for parent in svg.iter():
        for child in list(parent):
            if child.tag.rpartition("}")[2] in ("metadata", "style"):
                parent.remove(child)
    used = {
        name for one in svg.iter() for value in one.attrib.values()
        for name in _REFERENCE.findall(value)
    }  # fmt: skip
    for one in svg.iter():
        one.tag = one.tag.rpartition("}")[2]
        own = {name.rpartition("}")[2]: value for name, value in one.attrib.items()}
        if own.get("id") not in used:
            own.pop("id", None)
        one.attrib = {name: _shorter(name, value) for name, value in own.items()}
        one.tail = None
        one.text = one.text if one.tag == "text" else None
    width = float(svg.attrib["viewBox"].split()[2])
    svg.attrib = {
        "viewBox": svg.attrib["viewBox"],
        "style": f"max-width: {_LARGEST * width:.0f}px",
        "role": "img",
        "aria-label": clean(alt),
    }
    return markup(svg)


def _shorter(name: str, value: str) -> str:
    if name == "style":
        value = re.sub(r"font-family: [^;]*; ?", "", value)
        return _COLOUR.sub(lambda found: f"var(--{_NAMES[found[0]]})", value)
    if name == "d":
        value = " ".join(value.split())
    return value if name == "id" else _LONG.sub(r"\1", value)
