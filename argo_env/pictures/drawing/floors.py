"""Floor plans behind routes, of a real site or of sites that do not exist."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache

from argo_env.report.outline import DRAWING_ORDER, Point, outline, solids_shown_on_floor
from argo_env.site import Site
from argo_env.site.shapes import Role

Rectangle = tuple[float, float, float, float]
"""bounds x0, y0, x1, y1 in m"""
Shapes = tuple[tuple[Role, tuple[tuple[Point, ...], ...]], ...]
"""outlines in m, the lower ones first"""

_GROUND = 1.2  # m of bare ground that is shown around what is on it
_EDGE = 0.4  # m


@dataclass(frozen=True)
class FloorPlan:
    """Outlines of what is on a floor, seen from above."""

    number: int
    bounds: Rectangle
    shapes: Shapes


def floor_plans(site: Site) -> tuple[FloorPlan, ...]:
    """Return the plans of the floors of a site.

    All upper floors have the same bounds, so that what is above one another is at the same position
    in each panel; the lowest one is larger where there is ground around.
    """
    shapes = {floor.number: _shapes(site, floor.number) for floor in site.spec.floors}
    edges = {number: _bounds(parts) for number, parts in shapes.items()}
    lowest = min(shapes)
    whole = _union(edges.values())
    upper = _union(edge for number, edge in edges.items() if number != lowest or len(edges) == 1)
    return tuple(
        FloorPlan(number, whole if number == lowest else upper, parts)
        for number, parts in shapes.items()
    )


@lru_cache(maxsize=8)
def rectangular_floor_plans(
    width: float, depth: float, floors: int, ends_with_stairs: int = 1
) -> tuple[FloorPlan, ...]:
    """Return the plans of floors numbered from 1, each with a deck from (0, 0) to (width, depth).

    Lengths are in m. Stairs are all along the side x = 0, and along x = width if
    `ends_with_stairs` is 2.
    """
    deck = _box((-0.6, -0.6, width + 0.6, depth + 0.6))
    edges = [-2.1 + 0.3 * k for k in range(5)]
    edges += [width + 0.6 + 0.3 * k for k in range(5) if ends_with_stairs > 1]
    treads = tuple(_box((x, -0.6, x + 0.3, depth + 0.6)) for x in edges)
    shapes = ((Role.DECK, (deck,)), (Role.STAIR, treads))
    bounds = (-2.5, -1.0, width + (2.5 if ends_with_stairs > 1 else 1.0), depth + 1.0)
    return tuple(FloorPlan(number, bounds, shapes) for number in range(1, floors + 1))


def empty_floor_plans(points: Sequence[Point], numbers: Iterable[int]) -> tuple[FloorPlan, ...]:
    """Return a plan without outlines for each floor number; all have bounds around the points."""
    low = [min(p[axis] for p in points) for axis in (0, 1)]
    high = [max(p[axis] for p in points) for axis in (0, 1)]
    margin = 0.08 * max(high[0] - low[0], high[1] - low[1], 1.0)
    bounds = (low[0] - margin, low[1] - margin, high[0] + margin, high[1] + margin)
    return tuple(FloorPlan(number, bounds, ()) for number in numbers)


def _shapes(site: Site, number: int) -> Shapes:
    z = next(f.z for f in site.spec.floors if f.number == number)
    outlines: dict[Role, list[tuple[Point, ...]]] = {role: [] for role in DRAWING_ORDER}
    for element in site.elements:
        solids = solids_shown_on_floor(element, z, site.spec.storey)
        outlines[element.role] += [tuple(outline(solid, (0, 1))) for solid in solids]
    return tuple((role, tuple(shapes)) for role, shapes in outlines.items() if shapes)


def _bounds(shapes: Shapes) -> Rectangle:
    """Return the bounds of what is on a floor, with some ground around it if there is any."""
    ground = [p for role, parts in shapes if role is Role.GROUND for part in parts for p in part]
    above = [p for role, parts in shapes if role is not Role.GROUND for part in parts for p in part]
    if ground:
        return _common(_around(above or ground, _GROUND), _around(ground, 0.0))
    return _around(above, _EDGE)


def _around(points: Sequence[Point], margin: float) -> Rectangle:
    xs, ys = [p[0] for p in points], [p[1] for p in points]
    return min(xs) - margin, min(ys) - margin, max(xs) + margin, max(ys) + margin


def _union(rectangles: Iterable[Rectangle]) -> Rectangle:
    x0, y0, x1, y1 = zip(*rectangles, strict=True)
    return min(x0), min(y0), max(x1), max(y1)


def _common(a: Rectangle, b: Rectangle) -> Rectangle:
    return max(a[0], b[0]), max(a[1], b[1]), min(a[2], b[2]), min(a[3], b[3])


def _box(rect: Rectangle) -> tuple[Point, ...]:
    x0, y0, x1, y1 = rect
    return (x0, y0), (x1, y0), (x1, y1), (x0, y1)
