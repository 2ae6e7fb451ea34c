"""A site's solids as columns of a grid, cell by cell.

Only this module looks at the geometry; the rest of navigation works on the columns.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_env.site.shapes import WALKING_ROLES, Box, Element, Solid, crossing, half_extents

CELL = 0.1  # m
_SAMPLES = 5
"""number of samples along each edge of a cell, 24.5 mm apart, so that a rail of 40 mm is hit"""
_INSET = 0.001  # m from the cell's edge to the outer samples: a solid may touch the edge


@dataclass(frozen=True)
class Grid:
    """Grid of square cells.

    Cell (i, j) has its centre at x0 + (i + 1/2) CELL, and likewise in y.
    """

    x0: float
    y0: float
    nx: int
    ny: int

    @staticmethod
    def covering(rect: tuple[float, float, float, float]) -> "Grid":
        """Return the smallest grid over [x0, y0, x1, y1] (m) with lines at multiples of CELL."""
        i0, j0 = np.floor(rect[0] / CELL + 1e-6), np.floor(rect[1] / CELL + 1e-6)
        i1, j1 = np.ceil(rect[2] / CELL - 1e-6), np.ceil(rect[3] / CELL - 1e-6)
        return Grid(float(i0 * CELL), float(j0 * CELL), int(i1 - i0), int(j1 - j0))

    def centers(
        self, i: NDArray[np.int64], j: NDArray[np.int64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return x and y (m) of the centres of the cells (i, j), as two arrays."""
        return self.x0 + (i.astype(float) + 0.5) * CELL, self.y0 + (j.astype(float) + 0.5) * CELL


@dataclass(frozen=True)
class Columns:
    """Entries for each solid in each cell that it reaches, as arrays of the same length."""

    cell: NDArray[np.int64]
    """number of the cell, i * ny + j"""
    bottom: NDArray[np.float64]
    """height (m) of the solid's lowest point in the cell"""
    top: NDArray[np.float64]
    """height (m) of its highest point in the cell"""
    top_at_center: NDArray[np.float64]
    """height (m) of its upper side at the cell's centre; -inf if it is not there"""
    walking: NDArray[np.bool_]
    """True if the solid is one to walk on"""


def rasterise(elements: tuple[Element, ...], grid: Grid) -> Columns:
    """Return a row for each solid of the elements and each cell that it reaches, sorted by cell."""
    parts = [
        (*_columns_of(solid, grid), element.role in WALKING_ROLES)
        for element in elements
        for solid in element.solids
    ]
    cell = np.concatenate([p[0] for p in parts])
    order = np.argsort(cell, kind="stable")
    return Columns(
        cell[order],
        np.concatenate([p[1] for p in parts])[order],
        np.concatenate([p[2] for p in parts])[order],
        np.concatenate([p[3] for p in parts])[order],
        np.concatenate([np.full(len(p[0]), p[4]) for p in parts])[order],
    )


def _columns_of(
    solid: Solid, grid: Grid
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return cells, a solid's lowest and highest point in each, and its top at each centre.

    The top is -inf where the solid misses the centre.
    """
    half = half_extents(solid)
    i0, i1 = _cells(solid.center[0], half[0], grid.x0, grid.nx)
    j0, j1 = _cells(solid.center[1], half[1], grid.y0, grid.ny)
    i, j = (a.ravel() for a in np.meshgrid(np.arange(i0, i1), np.arange(j0, j1), indexing="ij"))
    x, y = grid.centers(i, j)
    if isinstance(solid, Box) and solid.rpy == (0.0, 0.0, 0.0):
        # This is a shortcut for plates, of which there are many large ones; samples give the same.
        reach_x, reach_y = np.abs(x - solid.center[0]), np.abs(y - solid.center[1])
        reach = CELL / 2 - _INSET
        inside = (reach_x < half[0] + reach) & (reach_y < half[1] + reach)
        bottom = np.where(inside, solid.center[2] - half[2], np.inf)
        top = np.where(inside, solid.center[2] + half[2], -np.inf)
        center = np.where((reach_x <= half[0]) & (reach_y <= half[1]), top, -np.inf)
    else:
        offsets = np.linspace(-CELL / 2 + _INSET, CELL / 2 - _INSET, _SAMPLES)
        dx, dy = (a.ravel() for a in np.meshgrid(offsets, offsets, indexing="ij"))
        foot = np.stack([x[:, None] + dx, y[:, None] + dy, np.zeros((len(x), len(dx)))], axis=-1)
        bottom, top = crossing(solid, foot, np.array([0.0, 0.0, 1.0]))
        center = top[:, len(dx) // 2]
        bottom, top = bottom.min(axis=1), top.max(axis=1)
    hit = bottom <= top
    return (i * grid.ny + j)[hit], bottom[hit], top[hit], center[hit]


def _cells(center: float, half: float, start: float, count: int) -> tuple[int, int]:
    first = int(np.floor((center - half - start) / CELL + 1e-6))
    last = int(np.ceil((center + half - start) / CELL - 1e-6))
    return max(0, first), max(0, min(count, last))
