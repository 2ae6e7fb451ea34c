"""The side view of the site along its y axis, with the path: where the robot climbed."""

from argo_env.report.canvas import Canvas
from argo_env.report.outline import heights, outline
from argo_env.report.svg import Node, drawing, node
from argo_env.report.track import flag, stretches, track
from argo_env.run.record import RunRecord
from argo_env.site import Site
from argo_env.site.shapes import Element, Role

SCALE = 34.0  # px for 1 m
_SHOWN = frozenset({Role.GROUND, Role.DECK, Role.STAIR, Role.VESSEL, Role.STRUCTURE})


def elevation(site: Site, record: RunRecord) -> Node:
    """The site from the south, x to the right and z up."""
    shown = [
        (e.role, e.solids)
        for e in site.elements
        # Of the structure, the columns are shown, and not what carries the checkpoints.
        if e.role in _SHOWN and (e.role is not Role.STRUCTURE or _height(e) > site.spec.storey)
    ]
    corners = [p for _, solids in shown for s in solids for p in outline(s, (0, 2))]
    xs, zs = [c[0] for c in corners], [c[1] for c in corners]
    canvas = Canvas(min(xs) - 0.3, min(zs), max(xs) + 0.3, max(zs) + 0.3, SCALE)
    parts = stretches(record.path, None)
    end = record.path[-1].t if record.path else 0.0
    drawn = track(parts, lambda s: (s.x, s.z), canvas.at, end)
    labels = [
        node(
            "text",
            x=canvas.at(canvas.x1, 0.0)[0] - 6,
            y=canvas.at(0.0, floor.z)[1] - 5,
            text=f"floor {floor.number}",
            class_="axis end",
        )
        for floor in site.spec.floors
    ]
    if record.path:
        first, last = record.path[0], record.path[-1]
        place = canvas.at(last.x, last.z)
        near = abs(first.x - last.x) < 0.5 and abs(first.z - last.z) < 0.5
        drawn.append(flag(canvas.at(first.x, first.z), "S", "start"))
        drawn.append(flag((place[0] + (20 if near else 0), place[1]), "E", "end"))
    return drawing(
        canvas.width,
        canvas.height,
        "Side view from the south with the driven path",
        *canvas.frame(("x", "z")),
        *canvas.elements(shown, (0, 2)),
        *labels,
        *drawn,
        canvas.scale_bar(),
        class_="drawing side",
    )


def _height(element: Element) -> float:
    """m from the lowest to the highest point."""
    ends = [end for solid in element.solids for end in heights(solid)]
    return max(ends) - min(ends)
