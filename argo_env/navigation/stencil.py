"""The cells that a robot covers, as steps from the cell below it.

A stencil is walked cell by cell along the surface's links, from the middle outwards. That works on
any layer and across steps, and a cell that can't be reached so is a hole or an obstacle.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_env.navigation.raster import CELL
from argo_env.navigation.surface import DIRECTIONS, Surface
from argo_env.robot.spec import Footprint

HEADINGS = 8
"""Headings of the lattice, one in 45 degrees."""
SWEEP_STEPS = 9
"""Steps in which the area of a turn of 45 degrees is looked at: one in 5 degrees."""


@dataclass(frozen=True)
class Stencil:
    """Cells relative to the robot's, each with its parent nearer to the middle.

    `offsets[k]` is reached from `offsets[parent[k]]` by a step in `DIRECTIONS[step[k]]`; the first
    entry is the middle itself.
    """

    offsets: tuple[tuple[int, int], ...]
    parent: tuple[int, ...]
    step: tuple[int, ...]

    def heights(self, surface: Surface, middle: NDArray[np.int64]) -> NDArray[np.float64]:
        """Heights of the surface (m) at each offset about the cells `middle`, shape
        (len(offsets), len(middle)); nan where the surface does not go on."""
        # One more cell stands for "nowhere": it has no height, and all its links lead to itself.
        nowhere = surface.size
        links = np.vstack([surface.links, np.full((1, len(DIRECTIONS)), nowhere)])
        links = np.ascontiguousarray(np.where(links < 0, nowhere, links).T)
        z = np.append(surface.z, np.nan)
        cells = np.empty((len(self.offsets), len(middle)), dtype=np.int64)
        cells[0] = middle
        for k in range(1, len(self.offsets)):
            np.take(links[self.step[k]], cells[self.parent[k]], out=cells[k])
        return z[cells]


def make_stencil(cells: set[tuple[int, int]]) -> Stencil:
    """The stencil over a set of offsets that is convex enough to be walked towards the middle."""
    ordered = sorted(cells | {(0, 0)}, key=lambda c: (c[0] ** 2 + c[1] ** 2, c))
    index = {offset: k for k, offset in enumerate(ordered)}
    parents, steps = [0], [0]
    for i, j in ordered[1:]:
        towards = _towards_middle(i, j, index)
        parents.append(index[towards])
        steps.append(DIRECTIONS.index((i - towards[0], j - towards[1])))
    return Stencil(tuple(ordered), tuple(parents), tuple(steps))


def _towards_middle(i: int, j: int, known: dict[tuple[int, int], int]) -> tuple[int, int]:
    """The known neighbour that lies nearest to the straight line to the middle."""
    candidates = [
        (i + di, j + dj)
        for di, dj in DIRECTIONS
        if (i + di, j + dj) in known and (i + di) ** 2 + (j + dj) ** 2 < i * i + j * j
    ]
    return min(candidates, key=lambda c: (abs(i * c[1] - j * c[0]), c[0] ** 2 + c[1] ** 2, c))


def overlaps(
    footprint: Footprint,
    margin: float,
    yaw: float | NDArray[np.float64],
    x: NDArray[np.float64],
    y: NDArray[np.float64],
) -> NDArray[np.bool_]:
    """Whether a robot with heading `yaw` (rad), `margin` (m) added on all sides, touches the cells
    whose centres lie at (x, y) from its point of rotation, in m. The arrays are broadcast.

    A cell that is only touched at its edge is apart.
    """
    half_cell = CELL / 2 - 1e-6
    return touches(footprint, margin, yaw, x, y, (half_cell, half_cell))


def touches(
    footprint: Footprint,
    margin: float,
    yaw: float | NDArray[np.float64],
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    half: tuple[float, float],
) -> NDArray[np.bool_]:
    """Whether a robot with heading `yaw` (rad), `margin` (m) added on all sides, touches the
    rectangles of half edges `half` (m) about (x, y) from its point of rotation, in m.

    Two convex shapes are apart if a normal of one of their edges parts them.
    """
    cos, sin = np.cos(yaw), np.sin(yaw)
    front, rear = footprint.front + margin, footprint.rear + margin
    middle, half_length = (front - rear) / 2, (front + rear) / 2
    half_width = footprint.half_width + margin
    abs_cos, abs_sin = np.abs(cos), np.abs(sin)
    extent_x = abs_cos * half_length + abs_sin * half_width
    extent_y = abs_sin * half_length + abs_cos * half_width
    along, left = x * cos + y * sin, y * cos - x * sin
    return np.asarray(
        (np.abs(along - middle) < half_length + half[0] * abs_cos + half[1] * abs_sin)
        & (np.abs(left) < half_width + half[0] * abs_sin + half[1] * abs_cos)
        & (np.abs(x - middle * cos) < extent_x + half[0])
        & (np.abs(y - middle * sin) < extent_y + half[1])
    )


def cells_around(footprint: Footprint, margin: float) -> NDArray[np.int64]:
    """Numbers of all columns or rows of cells that the robot can reach from the one it is in."""
    reach = math.ceil((footprint.radius + margin) / CELL) + 1
    return np.arange(-reach, reach + 1)


def covered(footprint: Footprint, yaw: float, margin: float) -> set[tuple[int, int]]:
    """Cells that a robot at the middle of a cell with heading `yaw` (rad) touches, `margin` (m)
    added on all sides."""
    around = cells_around(footprint, margin)
    i, j = np.meshgrid(around, around, indexing="ij")
    x, y = i.astype(np.float64) * CELL, j.astype(np.float64) * CELL
    touched = overlaps(footprint, margin, yaw, x, y)
    return set(zip(i[touched].tolist(), j[touched].tolist(), strict=True))


def standing(footprint: Footprint, heading: int, margin: float) -> Stencil:
    """The stencil of a robot that stands or drives with lattice heading `heading`."""
    return make_stencil(covered(footprint, heading_angle(heading), margin))


def turning(footprint: Footprint, heading: int, margin: float) -> Stencil:
    """The stencil of a turn in place from `heading` to the next one, counter-clockwise."""
    cells: set[tuple[int, int]] = set()
    for k in range(SWEEP_STEPS + 1):
        yaw = heading_angle(heading) + k / SWEEP_STEPS * heading_angle(1)
        cells |= covered(footprint, yaw, margin)
    return make_stencil(cells)


def heading_angle(heading: int) -> float:
    """rad, of a lattice heading."""
    return heading * 2 * math.pi / HEADINGS
