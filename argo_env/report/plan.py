"""Drawings of the site in the report: floors from above, and the whole site from the side."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

from argo_compiler.il import EventKind
from argo_env.report.outline import (
    DRAWING_ORDER,
    Point,
    height_range,
    outline,
    solids_shown_on_floor,
)
from argo_env.report.svg import Node, drawing, node, polyline
from argo_env.report.timeline import draw_finding
from argo_env.report.track import draw_arrow_heads, draw_letter_mark, draw_track, stretches
from argo_env.run.record import PathSample, RunRecord
from argo_env.site import Site, SiteCheckpoint
from argo_env.site.shapes import Element, Role, Solid

MARGIN = 34.0  # px, for the axes


@dataclass(frozen=True)
class Canvas:
    """Rectangle from (x0, y0) to (x1, y1) in m, drawn with `scale` px for 1 m."""

    x0: float
    y0: float
    x1: float
    y1: float
    scale: float

    @property
    def width(self) -> float:
        """Width in px, with margins."""
        return (self.x1 - self.x0) * self.scale + 2 * MARGIN

    @property
    def height(self) -> float:
        """Height in px, with margins."""
        return (self.y1 - self.y0) * self.scale + 2 * MARGIN

    def to_pixels(self, x: float, y: float) -> Point:
        """Return the position in px of a point in m, whose second coordinate points up."""
        return MARGIN + (x - self.x0) * self.scale, MARGIN + (self.y1 - y) * self.scale

    def draw_solids(self, role: Role, solids: Iterable[Solid], axes: tuple[int, int]) -> Node:
        """Draw the outlines of the solids of one role as a single path.

        `axes` are the indices of the site's axes that the drawing has.
        """
        shapes = (
            polyline((self.to_pixels(*p) for p in outline(solid, axes)), closed=True)
            for solid in solids
        )
        return node("path", d="".join(shapes), class_=f"site-{role}")

    def draw_in_drawing_order(
        self, shown: Iterable[tuple[Role, tuple[Solid, ...]]], axes: tuple[int, int]
    ) -> list[Node]:
        """Draw all solids, given with their roles: one path for each role, by `DRAWING_ORDER`."""
        parts = list(shown)
        drawn = []
        for role in DRAWING_ORDER:
            solids = [solid for r, group in parts if r is role for solid in group]
            if solids:
                drawn.append(self.draw_solids(role, solids, axes))
        return drawn

    def draw_axes(self, names: tuple[str, str]) -> list[Node]:
        """Draw the frame with coordinates every 2 m along both axes, which have these names."""
        left, top = self.to_pixels(self.x0, self.y1)
        right, bottom = self.to_pixels(self.x1, self.y0)
        marks = [
            node("rect", x=left, y=top, width=right - left, height=bottom - top, class_="frame")
        ]
        for x in _every(2, self.x0, self.x1):
            px = self.to_pixels(x, self.y0)[0]
            marks.append(node("path", d=f"M{px:.1f},{bottom:.1f}v5", class_="tick"))
            marks.append(_text(px, bottom + 16, f"{x}", "axis middle"))
        for y in _every(2, self.y0, self.y1):
            py = self.to_pixels(self.x0, y)[1]
            marks.append(node("path", d=f"M{left:.1f},{py:.1f}h-5", class_="tick"))
            marks.append(_text(left - 8, py + 4, f"{y}", "axis end"))
        marks.append(_text(right, bottom + 30, f"{names[0]} in m", "axis end"))
        marks.append(_text(left, top - 8, f"{names[1]} in m", "axis"))
        return marks

    def draw_scale_bar(self) -> Node:
        """Draw a bar of 1 m above the frame's right end."""
        right, top = self.to_pixels(self.x1, self.y1)
        return node(
            "g",
            node("path", d=f"M{right - self.scale:.1f},{top - 9:.1f}v-4v4h{self.scale:g}v-4"),
            _text(right - self.scale - 6, top - 8, "1 m", "axis end"),
            class_="scale-bar",
        )


def _text(x: float, y: float, text: str, class_: str) -> Node:
    return node("text", x=x, y=y, text=text, class_=class_)


def _every(step: int, low: float, high: float) -> range:
    """Return the multiples of `step` from `low` to `high`, both included if they are multiples."""
    return range(math.ceil(low / step) * step, math.floor(high) + 1, step)


_PLAN_SCALE = 46.0  # px for 1 m
_ASIDE = (
    2.0 / _PLAN_SCALE
)  # m to the right of the path, so that the opposite direction is visible beside it
_ARROWS_UP_TO = 120.0
"""m, longest path on a floor that has arrows; on longer ones they would hide the lines"""


def visited_floors(record: RunRecord) -> list[int]:
    """Return the numbers of the floors that the driven path touches, in ascending order."""
    return sorted({sample.floor for sample in record.path})


def draw_floor(site: Site, record: RunRecord, number: int) -> Node:
    """Draw the floor with this number from above: site, driven path, checkpoints and what happened.

    Start and end of the path, contacts and findings are marked.
    """
    floor_z = next(f.z for f in site.spec.floors if f.number == number)
    shown = [(e.role, solids_shown_on_floor(e, floor_z, site.spec.storey)) for e in site.elements]
    parts = stretches(record.path, number)
    corners = [p for _, solids in shown for s in solids for p in outline(s, (0, 1))]
    corners += [(s.x, s.y) for part in parts for s in part]
    xs, ys = [c[0] for c in corners], [c[1] for c in corners]
    canvas = Canvas(min(xs) - 0.5, min(ys) - 0.5, max(xs) + 0.5, max(ys) + 0.5, _PLAN_SCALE)
    measured = {r.checkpoint: r.normal for r in record.readings}
    marks = [_checkpoint(canvas, c, measured) for c in site.checkpoints if c.floor == number]
    contacts = [_cross(canvas, c.x, c.y) for c in record.contacts if site.floor_at(c.z) == number]
    findings = [
        draw_finding(*canvas.to_pixels(at[0], at[1]), k, "found" if a.place else "noticed")
        for k, a in enumerate(record.anomalies, start=1)
        if (at := a.place or a.noticed_from) is not None
        and a.floor == number
        and a.kind is not EventKind.ABNORMAL_READING
    ]
    return drawing(
        canvas.width,
        canvas.height,
        f"Plan of floor {number} with the driven path",
        *canvas.draw_axes(("x", "y")),
        *canvas.draw_in_drawing_order(shown, (0, 1)),
        *_path(canvas, parts, record),
        *marks,
        *contacts,
        *findings,
        _north(canvas),
        canvas.draw_scale_bar(),
        class_="drawing plan",
    )


def _path(canvas: Canvas, parts: list[list[PathSample]], record: RunRecord) -> list[Node]:
    end = record.path[-1].t if record.path else 0.0
    drawn = draw_track(parts, lambda s: (s.x, s.y), canvas.to_pixels, end, _ASIDE)
    length = sum(math.dist((a.x, a.y), (b.x, b.y)) for part in parts for a, b in pairwise(part))
    if length <= _ARROWS_UP_TO:
        for part in parts:
            drawn += draw_arrow_heads(part, canvas.to_pixels, 1.6, _ASIDE)
    return drawn + _flags(canvas, parts, record)


def _flags(canvas: Canvas, parts: list[list[PathSample]], record: RunRecord) -> list[Node]:
    """Draw the marks of start and end, side by side if the mission ends where it started."""
    first, last = record.path[0], record.path[-1]
    flags = []
    if parts and parts[0][0] is first:
        flags.append(draw_letter_mark(canvas.to_pixels(first.x, first.y), "S", "start"))
    if parts and parts[-1][-1] is last:
        x, y = canvas.to_pixels(last.x, last.y)
        near = flags and math.dist((first.x, first.y), (last.x, last.y)) < 0.4
        flags.append(draw_letter_mark((x + (20 if near else 0), y), "E", "end"))
    return flags


def _checkpoint(canvas: Canvas, checkpoint: SiteCheckpoint, measured: dict[int, bool]) -> Node:
    """Draw the face as a dot, a line in its direction, and its id on the opposite side.

    `measured` has the ids of measured checkpoints: True if the last value is normal.
    """
    x, y = canvas.to_pixels(checkpoint.position[0], checkpoint.position[1])
    cos, sin = math.cos(checkpoint.yaw), math.sin(checkpoint.yaw)
    state = {None: "unread", True: "read", False: "read abnormal"}[measured.get(checkpoint.id)]
    back = (x - 17 * cos, y + 17 * sin)
    return node(
        "g",
        node("title", text=f"{checkpoint.id} {checkpoint.name}"),
        node("path", d=f"M{x:.1f},{y:.1f}l{11 * cos:.1f},{-11 * sin:.1f}", class_="look"),
        node("circle", cx=x, cy=y, r=4.5, class_="face"),
        node("circle", cx=back[0], cy=back[1], r=10.0, class_="tag"),
        node("text", x=back[0], y=back[1] + 4, text=f"{checkpoint.id}", class_="middle"),
        class_=f"checkpoint {state}",
    )


def _cross(canvas: Canvas, x: float, y: float) -> Node:
    px, py = canvas.to_pixels(x, y)
    return node("path", d=f"M{px - 6:.1f},{py - 6:.1f}l12,12m0,-12l-12,12", class_="contact")


def _north(canvas: Canvas) -> Node:
    """Draw an arrow to the north, the direction of the site's y axis."""
    right, top = canvas.to_pixels(canvas.x1, canvas.y1)
    x, y = right - 20, top + 16
    return node(
        "g",
        node("path", d=f"M{x:.1f},{y:.1f}l7,22l-7,-5l-7,5z"),
        node("text", x=x, y=y - 3, text="N", class_="middle"),
        class_="north",
    )


_ELEVATION_SCALE = 34.0  # px for 1 m
_SHOWN = frozenset({Role.GROUND, Role.DECK, Role.STAIR, Role.VESSEL, Role.STRUCTURE})


def draw_side_view(site: Site, record: RunRecord) -> Node:
    """Draw the main parts of the site and the driven path from the south: x to the right, z up."""
    shown = [
        (e.role, e.solids)
        for e in site.elements
        # Of the structure, only the columns are shown, not the mounts of checkpoints.
        if e.role in _SHOWN and (e.role is not Role.STRUCTURE or _height(e) > site.spec.storey)
    ]
    corners = [p for _, solids in shown for s in solids for p in outline(s, (0, 2))]
    xs, zs = [c[0] for c in corners], [c[1] for c in corners]
    canvas = Canvas(min(xs) - 0.3, min(zs), max(xs) + 0.3, max(zs) + 0.3, _ELEVATION_SCALE)
    parts = stretches(record.path, None)
    end = record.path[-1].t if record.path else 0.0
    drawn = draw_track(parts, lambda s: (s.x, s.z), canvas.to_pixels, end)
    labels = [
        node(
            "text",
            x=canvas.to_pixels(canvas.x1, 0.0)[0] - 6,
            y=canvas.to_pixels(0.0, floor.z)[1] - 5,
            text=f"floor {floor.number}",
            class_="axis end",
        )
        for floor in site.spec.floors
    ]
    if record.path:
        first, last = record.path[0], record.path[-1]
        end_at = canvas.to_pixels(last.x, last.z)
        near = abs(first.x - last.x) < 0.5 and abs(first.z - last.z) < 0.5
        drawn.append(draw_letter_mark(canvas.to_pixels(first.x, first.z), "S", "start"))
        drawn.append(draw_letter_mark((end_at[0] + (20 if near else 0), end_at[1]), "E", "end"))
    return drawing(
        canvas.width,
        canvas.height,
        "Side view from the south with the driven path",
        *canvas.draw_axes(("x", "z")),
        *canvas.draw_in_drawing_order(shown, (0, 2)),
        *labels,
        *drawn,
        canvas.draw_scale_bar(),
        class_="drawing side",
    )


def _height(element: Element) -> float:
    """Return the distance (m) from the lowest to the highest point of the element."""
    ends = [end for solid in element.solids for end in height_range(solid)]
    return max(ends) - min(ends)
