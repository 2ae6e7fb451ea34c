"""Stencils: the cells that a robot covers, as steps from the cell below it.

A stencil is walked cell by cell along the surface's links, from the middle outwards. That works on
any layer and across steps, and a cell that can't be reached this way is a hole or an obstacle.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_env.navigation.raster import CELL
from argo_env.navigation.surface import DIRECTIONS, Surface
from argo_env.robot.spec import Footprint

HEADINGS = 8
"""number of headings of the lattice, 45 degrees apart"""
SWEEP_STEPS = 9
"""number of steps in which the swept area of a turn by 45 degrees is computed: every 5 degrees"""


@dataclass(frozen=True)
class Stencil:
    """Cells relative to the robot's, each with its parent nearer to the middle.

    `offsets[k]` is reached from `offsets[parent[k]]` by a step in `DIRECTIONS[step[k]]`; the first
    entry is the middle itself.
    """

    offsets: tuple[tuple[int, int], ...]
    parent: tuple[int, ...]
    step: tuple[int, ...]

    def surface_heights(
        self, surface: Surface, middle_cells: NDArray[np.int64]
    ) -> NDArray[np.float64]:
        """Return the heights (m) of the surface at all offsets from each of `middle_cells`.

        The shape is (len(offsets), len(middle_cells)); nan where the surface does not continue.
        """
        # An extra cell stands for "nowhere": its height is nan, and all its links lead to itself.
        nowhere = surface.size
        links = np.vstack([surface.links, np.full((1, len(DIRECTIONS)), nowhere)])
        links = np.ascontiguousarray(np.where(links < 0, nowhere, links).T)
        z = np.append(surface.z, np.nan)
        cells = np.empty((len(self.offsets), len(middle_cells)), dtype=np.int64)
        cells[0] = middle_cells
        for k in range(1, len(self.offsets)):
            np.take(links[self.step[k]], cells[self.parent[k]], out=cells[k])
        return z[cells]


def make_stencil(cells: set[tuple[int, int]]) -> Stencil:
    """Return the stencil of a set of offsets; the middle (0, 0) is added.

    From each offset, steps to neighbours in the set must lead ever nearer to the middle;
    otherwise a ValueError is raised.
    """
    ordered = sorted(cells | {(0, 0)}, key=lambda c: (c[0] ** 2 + c[1] ** 2, c))
    index = {offset: k for k, offset in enumerate(ordered)}
    parents, steps = [0], [0]
    for i, j in ordered[1:]:
        towards = _towards_middle(i, j, index)
        parents.append(index[towards])
        steps.append(DIRECTIONS.index((i - towards[0], j - towards[1])))
    return Stencil(tuple(ordered), tuple(parents), tuple(steps))


def _towards_middle(i: int, j: int, known: dict[tuple[int, int], int]) -> tuple[int, int]:
    """Return the known neighbour that is nearest to the straight line to the middle."""
    candidates = [
        (i + di, j + dj)
        for di, dj in DIRECTIONS
        if (i + di, j + dj) in known and (i + di) ** 2 + (j + dj) ** 2 < i * i + j * j
    ]
    return min(candidates, key=lambda c: (abs(i * c[1] - j * c[0]), c[0] ** 2 + c[1] ** 2, c))


def overlaps_cells(
    footprint: Footprint,
    margin: float,
    yaw: float | NDArray[np.float64],
    x: NDArray[np.float64],
    y: NDArray[np.float64],
) -> NDArray[np.bool_]:
    """Return a mask of the cells of the grid that a robot touches.

    A cell that is touched only at its edge is not counted. The arrays are broadcast.

    Args:
        footprint: Footprint of the robot.
        margin: Margin (m) added on all sides.
        yaw: Heading of the robot in rad.
        x: x of the cells' centres from the robot's point of rotation, in m.
        y: y of the same.
    """
    half_cell = CELL / 2 - 1e-6
    return touches_rectangles(footprint, margin, yaw, x, y, (half_cell, half_cell))


def touches_rectangles(
    footprint: Footprint,
    margin: float,
    yaw: float | NDArray[np.float64],
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    half: tuple[float, float],
) -> NDArray[np.bool_]:
    """Return a mask of the rectangles, all of one size, that a robot touches.

    They lie along the axes; one that is touched only at its edge is not counted. Two convex shapes
    are apart if a normal of one of their edges separates them. The arrays are broadcast.

    Args:
        footprint: Footprint of the robot.
        margin: Margin (m) added on all sides.
        yaw: Heading of the robot in rad.
        x: x of the rectangles' centres from the robot's point of rotation, in m.
        y: y of the same.
        half: Half of the rectangles' edges along x and y, in m.
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


def axis_offsets_in_reach(footprint: Footprint, margin: float) -> NDArray[np.int64]:
    """Return the offsets, from -k to k cells, that include all cells a robot at 0 may touch.

    They hold along both axes and for all headings. `margin` (m) is added on all sides.
    """
    reach = math.ceil((footprint.radius + margin) / CELL) + 1
    return np.arange(-reach, reach + 1)


def covered_cells(footprint: Footprint, yaw: float, margin: float) -> set[tuple[int, int]]:
    """Return the offsets (i, j) from the robot's cell of all cells that it touches.

    The robot is at the centre of its cell with heading `yaw` (rad). `margin` (m) is added on all
    sides.
    """
    around = axis_offsets_in_reach(footprint, margin)
    i, j = np.meshgrid(around, around, indexing="ij")
    x, y = i.astype(np.float64) * CELL, j.astype(np.float64) * CELL
    touched = overlaps_cells(footprint, margin, yaw, x, y)
    return set(zip(i[touched].tolist(), j[touched].tolist(), strict=True))


def footprint_stencil(footprint: Footprint, heading: int, margin: float) -> Stencil:
    """Return the stencil of a robot that stands or drives with lattice heading `heading`.

    `margin` (m) is added on all sides.
    """
    return make_stencil(covered_cells(footprint, heading_angle(heading), margin))


def stencil_of_turn_to_next(footprint: Footprint, heading: int, margin: float) -> Stencil:
    """Return the stencil of a turn in place from `heading` to the next one, counter-clockwise.

    It has all cells that the robot touches on the way. `margin` (m) is added on all sides.
    """
    cells: set[tuple[int, int]] = set()
    for k in range(SWEEP_STEPS + 1):
        yaw = heading_angle(heading) + k / SWEEP_STEPS * heading_angle(1)
        cells |= covered_cells(footprint, yaw, margin)
    return make_stencil(cells)


def heading_angle(heading: int) -> float:
    """Return the angle (rad), pi/4 times the number, of a lattice heading numbered 0 to 7."""
    return heading * 2 * math.pi / HEADINGS
