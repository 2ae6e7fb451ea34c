"""The plan of a floor with the path over it, drawn from the solids of the site."""

import math
from itertools import pairwise

from argo_compiler.il import EventKind
from argo_env.report.canvas import Canvas
from argo_env.report.outline import on_floor, outline
from argo_env.report.svg import Node, drawing, node
from argo_env.report.timeline import found_mark
from argo_env.report.track import arrows, flag, stretches, track
from argo_env.run.record import PathSample, RunRecord
from argo_env.site import Site, SiteCheckpoint

SCALE = 46.0  # px for 1 m
_ASIDE = 2.0 / SCALE  # m to the right of the way, so that the way back is seen beside it
_ARROWS_UP_TO = 120.0
"""m of path on a floor; on longer ones heads would hide the lines"""


def visited_floors(record: RunRecord) -> list[int]:
    """The floors that the path touches, from below."""
    return sorted({sample.floor for sample in record.path})


def floor_plan(site: Site, record: RunRecord, number: int) -> Node:
    """The plan of one floor: site, checkpoints, path, start, end and contacts."""
    floor_z = next(f.z for f in site.spec.floors if f.number == number)
    shown = [(e.role, on_floor(e, floor_z, site.spec.storey)) for e in site.elements]
    parts = stretches(record.path, number)
    corners = [p for _, solids in shown for s in solids for p in outline(s, (0, 1))]
    corners += [(s.x, s.y) for part in parts for s in part]
    xs, ys = [c[0] for c in corners], [c[1] for c in corners]
    canvas = Canvas(min(xs) - 0.5, min(ys) - 0.5, max(xs) + 0.5, max(ys) + 0.5, SCALE)
    measured = {r.checkpoint: r.normal for r in record.readings}
    marks = [_checkpoint(canvas, c, measured) for c in site.checkpoints if c.floor == number]
    contacts = [_cross(canvas, c.x, c.y) for c in record.contacts if site.floor_at(c.z) == number]
    found = [
        found_mark(*canvas.at(at[0], at[1]), k, "found" if a.place else "noticed")
        for k, a in enumerate(record.anomalies, start=1)
        if (at := a.place or a.noticed_from) is not None
        and a.floor == number
        and a.kind is not EventKind.ABNORMAL_READING
    ]
    return drawing(
        canvas.width,
        canvas.height,
        f"Plan of floor {number} with the driven path",
        *canvas.frame(("x", "y")),
        *canvas.elements(shown, (0, 1)),
        *_path(canvas, parts, record),
        *marks,
        *contacts,
        *found,
        _north(canvas),
        canvas.scale_bar(),
        class_="drawing plan",
    )


def _path(canvas: Canvas, parts: list[list[PathSample]], record: RunRecord) -> list[Node]:
    end = record.path[-1].t if record.path else 0.0
    drawn = track(parts, lambda s: (s.x, s.y), canvas.at, end, _ASIDE)
    length = sum(math.dist((a.x, a.y), (b.x, b.y)) for part in parts for a, b in pairwise(part))
    if length <= _ARROWS_UP_TO:
        for part in parts:
            drawn += arrows(part, canvas.at, 1.6, _ASIDE)
    return drawn + _flags(canvas, parts, record)


def _flags(canvas: Canvas, parts: list[list[PathSample]], record: RunRecord) -> list[Node]:
    """Start and end, side by side for a mission that ends in its station."""
    first, last = record.path[0], record.path[-1]
    flags = []
    if parts and parts[0][0] is first:
        flags.append(flag(canvas.at(first.x, first.y), "S", "start"))
    if parts and parts[-1][-1] is last:
        x, y = canvas.at(last.x, last.y)
        near = flags and math.dist((first.x, first.y), (last.x, last.y)) < 0.4
        flags.append(flag((x + (20 if near else 0), y), "E", "end"))
    return flags


def _checkpoint(canvas: Canvas, checkpoint: SiteCheckpoint, measured: dict[int, bool]) -> Node:
    """The face as a dot with a tick where it looks, and its id beside it, off the tick."""
    x, y = canvas.at(checkpoint.position[0], checkpoint.position[1])
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
    px, py = canvas.at(x, y)
    return node("path", d=f"M{px - 6:.1f},{py - 6:.1f}l12,12m0,-12l-12,12", class_="contact")


def _north(canvas: Canvas) -> Node:
    """The site's y axis points north."""
    right, top = canvas.at(canvas.x1, canvas.y1)
    x, y = right - 20, top + 16
    return node(
        "g",
        node("path", d=f"M{x:.1f},{y:.1f}l7,22l-7,-5l-7,5z"),
        node("text", x=x, y=y - 3, text="N", class_="middle"),
        class_="north",
    )
