"""A tiny builder of SVG: elements with short numbers, and the polylines they are made of.

The elements carry no name space, as they stand inside of an HTML page.
"""

import re
from collections.abc import Iterable, Sequence
from xml.etree import ElementTree

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

Node = ElementTree.Element

_CONTROL = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ufffe\uffff]")
"""What XML can't hold, not even escaped."""


def node(
    tag: str, *children: Node, text: str = "", title: str = "", **attributes: str | float
) -> Node:
    """An element, with a title last in it if it has one. In names of attributes `_` stands for `-`,
    and one at the end is dropped."""
    element = ElementTree.Element(tag)
    for name, value in attributes.items():
        key = "viewBox" if name == "viewBox" else name.rstrip("_").replace("_", "-")
        element.set(key, clean(value) if isinstance(value, str) else number(value))
    element.text = clean(text) or None
    element.extend(children)
    if title:
        element.append(node("title", text=title))
    return element


def drawing(width: float, height: float, name: str, *children: Node, class_: str = "") -> Node:
    """An `svg` of that size in px; `name` says in words what it shows."""
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
    """The element as text that is safe to stand in a page."""
    return Markup(ElementTree.tostring(element, encoding="unicode"))


def clean(text: str) -> str:
    """The text without the characters that XML can't hold."""
    return _CONTROL.sub("\ufffd", text)


def number(value: float) -> str:
    """The number with one decimal at most: a tenth of a pixel can't be seen."""
    text = f"{value:.1f}".removesuffix(".0")
    return "0" if text == "-0" else text


def shorten(text: str, length: int) -> str:
    """The text, cut to `length` characters."""
    return text if len(text) <= length else text[: length - 1].rstrip() + "…"


def polyline(points: Iterable[Sequence[float]], closed: bool = False) -> str:
    """The data of a `path` through the points."""
    steps = " ".join(f"{number(p[0])},{number(p[1])}" for p in points)
    return f"M{steps}{'z' if closed else ''}"


def simplify(points: NDArray[np.float64], tolerance: float) -> NDArray[np.intp]:
    """Which points of a line to keep so that all others are within `tolerance` of the line.

    `points` has the shape (n, 2); returns ascending indices with both ends (Douglas and Peucker).
    """
    if len(points) < 3:
        return np.arange(len(points))
    keep = np.zeros(len(points), dtype=bool)
    keep[[0, -1]] = True
    pending = [(0, len(points) - 1)]
    while pending:
        first, last = pending.pop()
        if last - first < 2:
            continue
        away = _distances(points[first + 1 : last], points[first], points[last])
        worst = int(np.argmax(away))
        if away[worst] > tolerance:
            middle = first + 1 + worst
            keep[middle] = True
            pending += [(first, middle), (middle, last)]
    return np.flatnonzero(keep)


def _distances(
    points: NDArray[np.float64], start: NDArray[np.float64], end: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The distance of each point from the stretch between start and end."""
    along = end - start
    length = float(along @ along)
    share = np.clip((points - start) @ along / length, 0.0, 1.0) if length else 0.0
    nearest = start + np.multiply.outer(share, along) if length else start
    return np.asarray(np.hypot(*(points - nearest).T))
