"""Small builder of SVG: elements with short numbers, and polylines.

The elements have no namespace, as they are part of an HTML page.
"""

import re
from collections.abc import Iterable, Sequence
from xml.etree import ElementTree

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

Node = ElementTree.Element

_CONTROL = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ufffe\uffff]")
"""Characters that XML can't contain, not even escaped."""


def node(
    tag: str, *children: Node, text: str = "", title: str = "", **attributes: str | float
) -> Node:
    """Return an SVG element with children and attributes; a `title` becomes its last child.

    In the keywords of attributes `_` stands for `-`, and `_` at the end is removed: `class_`.
    """
    element = ElementTree.Element(tag)
    for name, value in attributes.items():
        key = "viewBox" if name == "viewBox" else name.rstrip("_").replace("_", "-")
        element.set(
            key, replace_non_xml_characters(value) if isinstance(value, str) else number(value)
        )
    element.text = replace_non_xml_characters(text) or None
    element.extend(children)
    if title:
        element.append(node("title", text=title))
    return element


def drawing(width: float, height: float, name: str, *children: Node, class_: str = "") -> Node:
    """Return an `svg` element of this size in px; `name` is its description in words.

    `class_` is its CSS class; `drawing` if it is empty.
    """
    return node(
        "svg",
        *children,
        viewBox=f"0 0 {number(width)} {number(height)}",
        width=width,
        height=height,
        role="img",
        aria_label=name,
        class_=class_ or "drawing",
    )


def markup(element: Node) -> Markup:
    """Return the element as markup that a template inserts without escaping."""
    return Markup(ElementTree.tostring(element, encoding="unicode"))


def replace_non_xml_characters(text: str) -> str:
    """Return the text with a replacement character for each one that XML can't contain."""
    return _CONTROL.sub("\ufffd", text)


def number(value: float) -> str:
    """Return the number as text with at most one decimal; less than 0.1 px is invisible."""
    text = f"{value:.1f}".removesuffix(".0")
    return "0" if text == "-0" else text


def shorten(text: str, length: int) -> str:
    """Return the text, cut to `length` characters with `…` as the last if it is longer."""
    return text if len(text) <= length else text[: length - 1].rstrip() + "…"


def polyline(points: Iterable[Sequence[float]], closed: bool = False) -> str:
    """Return the `d` attribute of a `path` element that joins the points (px) by straight lines."""
    steps = " ".join(f"{number(p[0])},{number(p[1])}" for p in points)
    return f"M{steps}{'z' if closed else ''}"


def simplify(points: NDArray[np.float64], tolerance: float) -> NDArray[np.intp]:
    """Return indices of points that suffice to draw a line (Douglas and Peucker).

    All other points are within `tolerance` of the line through those. `points` has the shape
    (n, 2); the indices ascend, and both ends are among them.
    """
    if len(points) < 3:
        return np.arange(len(points))
    needed = np.zeros(len(points), dtype=bool)
    needed[[0, -1]] = True
    pending = [(0, len(points) - 1)]
    while pending:
        first, last = pending.pop()
        if last - first < 2:
            continue
        away = _distances(points[first + 1 : last], points[first], points[last])
        worst = int(np.argmax(away))
        if away[worst] > tolerance:
            middle = first + 1 + worst
            needed[middle] = True
            pending += [(first, middle), (middle, last)]
    return np.flatnonzero(needed)


def _distances(
    points: NDArray[np.float64], start: NDArray[np.float64], end: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the distance of each point from the line segment between start and end."""
    along = end - start
    length = float(along @ along)
    share = np.clip((points - start) @ along / length, 0.0, 1.0) if length else 0.0
    nearest = start + np.multiply.outer(share, along) if length else start
    return np.asarray(np.hypot(*(points - nearest).T))
