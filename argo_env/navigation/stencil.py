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
_SWEEP_STEPS = 9  # footprints looked at for a turn of 45 degrees: one in 5 degrees


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


def covered(footprint: Footprint, yaw: float, margin: float) -> set[tuple[int, int]]:
    """Cells that a robot at the middle of a cell with heading `yaw` (rad) touches, `margin` (m)
    added on all sides. Two convex shapes are apart if one of their edges' normals parts them."""
    reach = math.ceil((footprint.radius + margin) / CELL) + 1
    cos, sin = math.cos(yaw), math.sin(yaw)
    front, rear = footprint.front + margin, footprint.rear + margin
    half_width = footprint.half_width + margin
    cell_half = CELL / 2 - 1e-6
    spread = cell_half * (abs(cos) + abs(sin))
    x_middle, x_half = (front - rear) / 2 * cos, (front + rear) / 2
    y_middle = (front - rear) / 2 * sin
    extent_x = abs(cos) * x_half + abs(sin) * half_width
    extent_y = abs(sin) * x_half + abs(cos) * half_width
    cells = set()
    for i in range(-reach, reach + 1):
        for j in range(-reach, reach + 1):
            x, y = i * CELL, j * CELL
            along, left = x * cos + y * sin, y * cos - x * sin
            if (
                -rear - spread < along < front + spread
                and abs(left) < half_width + spread
                and abs(x - x_middle) < extent_x + cell_half
                and abs(y - y_middle) < extent_y + cell_half
            ):
                cells.add((i, j))
    return cells


def standing(footprint: Footprint, heading: int, margin: float) -> Stencil:
    """The stencil of a robot that stands or drives with lattice heading `heading`."""
    return make_stencil(covered(footprint, heading_angle(heading), margin))


def turning(footprint: Footprint, heading: int, margin: float) -> Stencil:
    """The stencil of a turn in place from `heading` to the next one, counter-clockwise."""
    cells: set[tuple[int, int]] = set()
    for k in range(_SWEEP_STEPS + 1):
        yaw = heading_angle(heading) + k / _SWEEP_STEPS * heading_angle(1)
        cells |= covered(footprint, yaw, margin)
    return make_stencil(cells)


def heading_angle(heading: int) -> float:
    """rad, of a lattice heading."""
    return heading * 2 * math.pi / HEADINGS
