"""A scaled drawing of a site: from m in the plane of two axes to px, with frame and scale bar."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

from argo_env.report.outline import DRAWING_ORDER, Point, outline
from argo_env.report.svg import Node, node, polyline
from argo_env.site.shapes import Role, Solid

MARGIN = 34.0  # px, for the axes


@dataclass(frozen=True)
class Canvas:
    """The rectangle from (x0, y0) to (x1, y1) in m, drawn with `scale` px for 1 m."""

    x0: float
    y0: float
    x1: float
    y1: float
    scale: float

    @property
    def width(self) -> float:
        """px."""
        return (self.x1 - self.x0) * self.scale + 2 * MARGIN

    @property
    def height(self) -> float:
        """px."""
        return (self.y1 - self.y0) * self.scale + 2 * MARGIN

    def at(self, x: float, y: float) -> Point:
        """The place in px of a point in m; the second axis points up."""
        return MARGIN + (x - self.x0) * self.scale, MARGIN + (self.y1 - y) * self.scale

    def solids(self, role: Role, solids: Iterable[Solid], axes: tuple[int, int]) -> Node:
        """The solids of one role as a single path."""
        shapes = (
            polyline((self.at(*p) for p in outline(solid, axes)), closed=True) for solid in solids
        )
        return node("path", d="".join(shapes), class_=f"site-{role}")

    def elements(
        self, shown: Iterable[tuple[Role, tuple[Solid, ...]]], axes: tuple[int, int]
    ) -> list[Node]:
        """All solids, what lies below first."""
        parts = list(shown)
        drawn = []
        for role in DRAWING_ORDER:
            solids = [solid for r, group in parts if r is role for solid in group]
            if solids:
                drawn.append(self.solids(role, solids, axes))
        return drawn

    def frame(self, names: tuple[str, str]) -> list[Node]:
        """The frame with coordinates every 2 m along both axes."""
        left, top = self.at(self.x0, self.y1)
        right, bottom = self.at(self.x1, self.y0)
        marks = [
            node("rect", x=left, y=top, width=right - left, height=bottom - top, class_="frame")
        ]
        for x in _every(2, self.x0, self.x1):
            px = self.at(x, self.y0)[0]
            marks.append(node("path", d=f"M{px:.1f},{bottom:.1f}v5", class_="tick"))
            marks.append(_text(px, bottom + 16, f"{x}", "axis middle"))
        for y in _every(2, self.y0, self.y1):
            py = self.at(self.x0, y)[1]
            marks.append(node("path", d=f"M{left:.1f},{py:.1f}h-5", class_="tick"))
            marks.append(_text(left - 8, py + 4, f"{y}", "axis end"))
        marks.append(_text(right, bottom + 30, f"{names[0]} in m", "axis end"))
        marks.append(_text(left, top - 8, f"{names[1]} in m", "axis"))
        return marks

    def scale_bar(self) -> Node:
        """A bar of 1 m above the frame's right end."""
        right, top = self.at(self.x1, self.y1)
        return node(
            "g",
            node("path", d=f"M{right - self.scale:.1f},{top - 9:.1f}v-4v4h{self.scale:g}v-4"),
            _text(right - self.scale - 6, top - 8, "1 m", "axis end"),
            class_="scale-bar",
        )


def _text(x: float, y: float, text: str, class_: str) -> Node:
    return node("text", x=x, y=y, text=text, class_=class_)


def _every(step: int, low: float, high: float) -> range:
    """The multiples of `step` between the bounds."""
    return range(math.ceil(low / step) * step, math.floor(high) + 1, step)
