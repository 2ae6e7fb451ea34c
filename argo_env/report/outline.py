"""Outlines of solids, seen along an axis of the site."""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from argo_env.site.shapes import Box, Element, Role, Solid, half_extents

Point = tuple[float, float]

DRAWING_ORDER = (
    Role.GROUND,
    Role.DECK,
    Role.STAIR,
    Role.PUMP,
    Role.VESSEL,
    Role.PIPE,
    Role.STRUCTURE,
    Role.DOCK,
    Role.RAILING,
)
"""Roles in the order in which they are drawn: lower ones first."""

_ROUND = 16
"""number of corners of a disc's outline"""
_CORNERS = np.array([[a, b, c] for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)])
_SOLIDS = 1 << 13
"""size of the cache of heights; each floor needs those of all solids of a site"""


def outline(solid: Solid, axes: tuple[int, int]) -> list[Point]:
    """Return the corners (m) of the solid's outline, seen along the third axis, counter-clockwise.

    `axes` are the indices of the two axes of the drawing: 0 for x, 1 for y, 2 for z.
    """
    if isinstance(solid, Box):
        local = _CORNERS * np.array(solid.size) / 2
    else:
        turn = np.arange(_ROUND) * 2 * math.pi / _ROUND
        disc = solid.radius * np.column_stack([np.cos(turn), np.sin(turn), np.zeros(_ROUND)])
        half = np.array([0.0, 0.0, solid.length / 2])
        local = np.vstack([disc - half, disc + half])
    corners = local @ solid.rotation().T + np.array(solid.center)
    return _hull(corners[:, list(axes)])


@lru_cache(maxsize=_SOLIDS)
def height_range(solid: Solid) -> tuple[float, float]:
    """Return the lowest and the highest z (m) of the solid."""
    half = float(half_extents(solid)[2])
    return solid.center[2] - half, solid.center[2] + half


def solids_shown_on_floor(element: Element, z: float, storey: float) -> tuple[Solid, ...]:
    """Return the solids of the element that a plan of the floor at height `z` (m) shows.

    Decks and the ground are shown on the floor whose height range contains their top: from 0.2 m
    below the floor to 0.3 m below the next one. A flight of stairs, a handrail or a railing is
    shown where the range contains the middle of its own. Equipment and columns are shown on every
    floor that they reach into. `storey` is the height from floor to floor in m.
    """
    low, high = z - 0.2, z + storey - 0.3
    if element.role in {Role.STAIR, Role.RAILING}:
        ends = [end for solid in element.solids for end in height_range(solid)]
        return element.solids if low <= (min(ends) + max(ends)) / 2 < high else ()
    if element.role in {Role.GROUND, Role.DECK}:
        return tuple(s for s in element.solids if low <= height_range(s)[1] < high)
    return tuple(
        s for s in element.solids if height_range(s)[0] < high and height_range(s)[1] > low + 0.2
    )


def _hull(points: NDArray[np.float64]) -> list[Point]:
    """Return the corners of the convex hull of points, shape (n, 2), counter-clockwise.

    The method is Andrew's monotone chain. Fewer than three different points are returned, sorted.
    """
    ordered = sorted({(round(x, 4), round(y, 4)) for x, y in points.tolist()})
    if len(ordered) < 3:
        return ordered
    return _half_hull(ordered)[:-1] + _half_hull(ordered[::-1])[:-1]


def _half_hull(points: list[Point]) -> list[Point]:
    chain: list[Point] = []
    for p in points:
        while len(chain) > 1 and _turn(chain[-2], chain[-1], p) <= 0:
            chain.pop()
        chain.append(p)
    return chain


def _turn(a: Point, b: Point, c: Point) -> float:
    """Return a positive number if the line from `a` through `b` to `c` turns left."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
