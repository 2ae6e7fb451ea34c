"""Plots as inline SVG elements in the colours of the page, which differ in dark mode."""

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
from argo_env.report.svg import markup, replace_non_xml_characters

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PALETTE = {
    "ink": plots.INK, "soft": plots.SOFT, "line": plots.LINE, "paper": plots.PAPER,
    "good": plots.GOOD, "bad": plots.BAD, "notice": plots.WARN, "site-ground": plots.GROUND,
    "site-deck": plots.DECK, "site-stair": plots.STAIR, "site-structure": plots.STRUCTURE,
    "site-edge": plots.EDGE,
    **{f"series-{k}": ink for k, ink in enumerate(plots.SERIES)},
}  # fmt: skip
"""colours of the plots, by the names of the page's CSS variables"""

_MAX_SCALE = 1.5  # px of a page for 1 point of a figure
_NAMES = {ink: name for name, ink in PALETTE.items()}
_COLOUR = re.compile("|".join(_NAMES))
_LONG_DECIMAL = re.compile(r"(\d+\.\d\d)\d+")
_REFERENCE = re.compile(r"#([\w-]+)")


def render_plot(alt: str, draw: Callable[[], "Axes"]) -> Markup:
    """Return the plot that `draw` draws on a new figure, as an SVG element.

    `alt` describes the plot in words. Equal plots with equal descriptions give equal text.
    """
    with warnings.catch_warnings():
        # The browser draws the text with its own font, so that missing glyphs here don't matter.
        warnings.filterwarnings("ignore", "Glyph .* missing from")
        # Text stays text, and ids of shapes are hashes of their content and of `alt`.
        with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": alt}):
            content = io.BytesIO()
            figure = draw().figure
            assert isinstance(figure, Figure)
            figure.savefig(content, format="svg", transparent=True, metadata={"Date": None})
    return _inline(ElementTree.fromstring(content.getvalue()), alt)


def _inline(svg: ElementTree.Element, alt: str) -> Markup:
    """Return the SVG as an element of a page, without the parts that would affect the whole page.

    These are metadata, styles, namespaces and unused ids.
    """
    for parent in svg.iter():
        for child in list(parent):
            if child.tag.rpartition("}")[2] in ("metadata", "style"):
                parent.remove(child)
    used = {
        name for element in svg.iter() for value in element.attrib.values()
        for name in _REFERENCE.findall(value)
    }  # fmt: skip
    for element in svg.iter():
        element.tag = element.tag.rpartition("}")[2]
        attributes = {name.rpartition("}")[2]: value for name, value in element.attrib.items()}
        if attributes.get("id") not in used:
            attributes.pop("id", None)
        element.attrib = {name: _simplify(name, value) for name, value in attributes.items()}
        element.tail = None
        element.text = element.text if element.tag == "text" else None
    width = float(svg.attrib["viewBox"].split()[2])
    svg.attrib = {
        "viewBox": svg.attrib["viewBox"],
        "style": f"max-width: {_MAX_SCALE * width:.0f}px",
        "role": "img",
        "aria-label": replace_non_xml_characters(alt),
    }
    return markup(svg)


def _simplify(name: str, value: str) -> str:
    """Return the attribute's value with the page's fonts and colours, and with two decimals."""
    if name == "style":
        value = re.sub(r"font-family: [^;]*; ?", "", value)
        return _COLOUR.sub(lambda match: f"var(--{_NAMES[match[0]]})", value)
    if name == "d":
        value = " ".join(value.split())
    return value if name == "id" else _LONG_DECIMAL.sub(r"\1", value)
