"""The traversable surface, computed from the geometry: layered cells with links between them.

Links lead where a robot can continue. Several cells may be above each other: decks over decks,
flights over flights. Stairs need no special case: treads are cells whose neighbour is one rise
higher.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.stages import stage
from argo_env.files.parts import Arrays
from argo_env.navigation.raster import CELL, Columns, Grid, rasterise
from argo_env.site.shapes import Element

DIRECTIONS: tuple[tuple[int, int], ...] = (
    (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1),
)  # fmt: skip
"""steps to the eight neighbours; direction k points k * 45 degrees from the x axis"""
_TOUCHING = 0.01  # m above the surface up to which a solid is no obstacle
_MAX_CELLS = 2.0**40  # cells


@dataclass(frozen=True)
class Surface:
    """Traversable cells.

    Arrays have one entry per cell; `links[n, k]` is the neighbour in direction k, or -1 if there is
    none within one step's height.
    """

    grid: Grid
    i: NDArray[np.int64]
    j: NDArray[np.int64]
    z: NDArray[np.float64]
    links: NDArray[np.int64]

    @property
    def size(self) -> int:
        return len(self.z)

    def cell_positions(self) -> NDArray[np.float64]:
        """Return the centres of the cells on the surface, in m, shape (size, 3)."""
        x, y = self.grid.centers(self.i, self.j)
        return np.stack([x, y, self.z], axis=1)

    @cached_property
    def _columns(self) -> NDArray[np.int64]:
        return self.i * self.grid.ny + self.j

    def cells_in_square(self, x: float, y: float, half_side: float) -> NDArray[np.int64]:
        """Return the numbers of the surface's cells in a square about (x, y), ascending.

        The sides of the square are `half_side` (m) away from (x, y); cells at all heights count.
        """
        # Poses may be anywhere, even at coordinates that exceed the size of any array.
        i0, i1 = (
            _floor_within_limits((x + d - self.grid.x0) / CELL) for d in (-half_side, half_side)
        )
        j0, j1 = (
            _floor_within_limits((y + d - self.grid.y0) / CELL) for d in (-half_side, half_side)
        )
        low, high = (min(max(i, 0), self.grid.nx) for i in (i0, i1 + 1))
        rows = np.arange(low, high) * self.grid.ny
        first = np.searchsorted(self._columns, rows + min(max(j0, 0), self.grid.ny))
        last = np.searchsorted(self._columns, rows + min(max(j1 + 1, 0), self.grid.ny))
        return np.concatenate([np.arange(a, b) for a, b in zip(first, last, strict=True)] or [rows])


def _floor_within_limits(number: float) -> int:
    """Return the number rounded down, and limited to `_MAX_CELLS` on either side of 0."""
    return math.floor(min(max(number, -_MAX_CELLS), _MAX_CELLS))


def surface_arrays(surface: Surface) -> Arrays:
    """Return a surface as named arrays, for the disk cache; its grid is left out."""
    return {"i": surface.i, "j": surface.j, "z": surface.z, "links": surface.links}


@stage("finding the walkable surface")
def find_surface(
    elements: tuple[Element, ...], grid: Grid, headroom: float, max_step: float
) -> Surface:
    """Return all cells where a robot of height `headroom` (m) could stand, with their links.

    A cell is traversable at the height of the top of a solid that is there to walk on, measured at
    the cell's centre, if nothing in the cell obstructs the space from there to `headroom` above it.
    Solids that rise at most 1 cm into this space don't obstruct it, nor do solids to walk on that
    rise at most `max_step` (m) into it, as the robot climbs them. Of several tops, each at most
    `max_step` above the one below, only the highest counts. Links lead to neighbouring cells at
    most `max_step` higher or lower.
    """
    columns = rasterise(elements, grid)
    cell, z = _candidates(columns, max_step)
    free = ~_obstructed(cell, z, columns, headroom, max_step)
    cell, z = cell[free], z[free]
    i, j = cell // grid.ny, cell % grid.ny
    links = np.stack([_link(cell, i, j, z, d, grid, max_step) for d in DIRECTIONS], axis=1)
    return Surface(grid, i, j, z, links)


def _candidates(columns: Columns, max_step: float) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return cells and heights of the tops of walking solids, sorted by cell and height.

    Of tops within one step of each other, only the highest is returned.
    """
    walking = columns.walking & np.isfinite(columns.top_at_center)
    cell, z = columns.cell[walking], columns.top_at_center[walking]
    order = np.lexsort((z, cell))
    cell, z = cell[order], z[order]
    covered = np.zeros(len(z), dtype=bool)
    covered[:-1] = (cell[1:] == cell[:-1]) & (z[1:] - z[:-1] <= max_step)
    return cell[~covered], z[~covered]


def _obstructed(
    cell: NDArray[np.int64],
    z: NDArray[np.float64],
    columns: Columns,
    headroom: float,
    max_step: float,
) -> NDArray[np.bool_]:
    """Return a mask of the candidates whose space up to `headroom` (m) above them is obstructed.

    Solids to walk on that rise at most `max_step` (m) above the candidate don't obstruct it.
    """
    first = np.searchsorted(columns.cell, cell, side="left")
    count = np.searchsorted(columns.cell, cell, side="right") - first
    # These are all pairs (candidate, column entry of the same cell).
    candidate = np.repeat(np.arange(len(cell)), count)
    entry = np.arange(len(candidate)) - np.repeat(np.cumsum(count) - count - first, count)
    over = z[candidate]
    tolerated = np.where(columns.walking[entry], max_step, _TOUCHING)
    in_way = (columns.top[entry] > over + tolerated) & (columns.bottom[entry] < over + headroom)
    return np.bincount(candidate, weights=in_way, minlength=len(cell)) > 0


def _link(
    cell: NDArray[np.int64],
    i: NDArray[np.int64],
    j: NDArray[np.int64],
    z: NDArray[np.float64],
    direction: tuple[int, int],
    grid: Grid,
    max_step: float,
) -> NDArray[np.int64]:
    """Return for each cell the neighbour in `direction` whose height is nearest to its own.

    It is -1 if there is none at most `max_step` (m) higher or lower.
    """
    ni, nj = i + direction[0], j + direction[1]
    inside = (ni >= 0) & (ni < grid.nx) & (nj >= 0) & (nj < grid.ny)
    wanted = np.where(inside, ni * grid.ny + nj, -1)
    first = np.searchsorted(cell, wanted, side="left")
    last = np.searchsorted(cell, wanted, side="right")
    best = np.full(len(cell), -1)
    best_step = np.full(len(cell), max_step + 1e-9)
    for layer in range(int((last - first).max(initial=0))):
        index = np.minimum(first + layer, len(cell) - 1)
        step = np.where(first + layer < last, np.abs(z[index] - z), np.inf)
        closer = step < best_step
        best, best_step = np.where(closer, index, best), np.where(closer, step, best_step)
    return best
