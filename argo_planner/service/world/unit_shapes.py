"""Shapes of size 1 about (0, 0, 0) that the solids of a site are drawn with."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class UnitShape:
    """Corners, shape (n, 3), and triangles, counter-clockwise seen from outside."""

    corners: NDArray[np.float64]
    triangles: NDArray[np.int64]
    open: bool
    """whether it has no caps, so that its faces are seen from both sides"""


@lru_cache
def prism(sides: int, capped: bool = True) -> UnitShape:
    """A prism along z about a circle of diameter 1; with four sides a box."""
    turn = 2 * math.pi / sides
    angles = turn * (np.arange(sides) + 0.5) - (math.pi / 2 if sides == 3 else 0.0)
    ring = np.column_stack([np.cos(angles), np.sin(angles)]) / 2
    if sides <= 4:  # fills the box around it
        low, high = ring.min(axis=0), ring.max(axis=0)
        ring = (ring - low) / (high - low) - 0.5
    low_end = np.column_stack([ring, np.full(sides, -0.5)])
    corners = np.vstack([low_end, low_end + np.array([0.0, 0.0, 1.0])])
    triangles = []
    for k in range(sides):
        n = (k + 1) % sides
        triangles += [(k, n, sides + n), (k, sides + n, sides + k)]
    if capped:
        for k in range(1, sides - 1):
            triangles += [(0, k + 1, k), (sides, sides + k, sides + k + 1)]
    return UnitShape(corners, np.array(triangles), not capped)


@lru_cache
def ball(sides: int = 12) -> UnitShape:
    """A ball of diameter 1."""
    rings = sides // 2
    corners = [(0.0, 0.0, -0.5)]
    for r in range(1, rings):
        across, z = math.sin(math.pi * r / rings) / 2, -math.cos(math.pi * r / rings) / 2
        for k in range(sides):
            angle = 2 * math.pi * k / sides
            corners.append((across * math.cos(angle), across * math.sin(angle), z))
    corners.append((0.0, 0.0, 0.5))
    last, triangles = len(corners) - 1, []
    for k in range(sides):
        n = (k + 1) % sides
        triangles += [(0, 1 + n, 1 + k), (last, last - sides + k, last - sides + n)]
        for r in range(rings - 2):
            a, b = 1 + r * sides, 1 + (r + 1) * sides
            triangles += [(a + k, a + n, b + n), (a + k, b + n, b + k)]
    return UnitShape(np.array(corners), np.array(triangles), False)


@lru_cache
def step() -> UnitShape:
    """The upper face of a box and the riser below its front, -x: an open step of 4 triangles."""
    corners = np.array(
        [
            (-0.5, -0.5, 0.5), (0.5, -0.5, 0.5), (0.5, 0.5, 0.5), (-0.5, 0.5, 0.5),
            (-0.5, -0.5, -0.5), (-0.5, 0.5, -0.5),
        ]
    )  # fmt: skip
    triangles = np.array([(0, 1, 2), (0, 2, 3), (0, 3, 5), (0, 5, 4)])
    return UnitShape(corners, triangles, True)
