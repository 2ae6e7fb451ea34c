"""Maps of where the robot can stand on a floor, one for each heading.

A page that has loaded them can check poses without a request.
"""

import json
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Invalid
from argo_compiler.base.message import Message
from argo_env.navigation import Navigator
from argo_env.navigation.graphs import shortest_path_costs
from argo_env.navigation.lattice import LEVEL, MARGIN, rise_front_over_rear
from argo_env.navigation.navigator import SNAP_DISTANCE, nearest_state
from argo_env.navigation.raster import CELL
from argo_env.navigation.stencil import HEADINGS, footprint_stencil, heading_angle
from argo_env.planning.opening import OpenedSite
from argo_planner.service.world.obstacles import Obstacle, with_obstacles

_FORMAT = "1"  # version of the cached codes
_STEP = 1e-3  # m, unit of heights
_CHUNK = 1 << 17  # cells that are computed together: all cells of a large site would take GB


class Ground(IntEnum):
    """Verdict on a cell and a heading: the robot can stand over the cell's centre, or why not."""

    NONE = 0
    """there is nothing to stand on, or something stands there"""
    TOO_NEAR = 1
    """a part of the robot would be over an edge, or touch something"""
    TOO_STEEP = 2
    """one end or side of the robot would be too high"""
    CUT_OFF = 3
    """the robot can stand there, but can't reach it from the docks, or can't return"""
    CLOSED = 4
    """the robot would touch an obstacle"""
    REACHED = 5
    """the robot can stand there and reach it"""


@dataclass(frozen=True)
class StandingMap:
    """Map that states for each cell of a floor whether the robot can stand there with one heading.

    The arrays have the shape (layers, rows, columns). Where cells lie above each other, as below a
    flight of stairs, the lower one is in the first layer.
    """

    floor: int
    """number of the floor"""
    heading: int
    """number of the heading, counter-clockwise from the x axis in equal steps"""
    yaw: float
    """heading in rad"""
    origin: tuple[float, float]
    """smallest x and y of the first cell, in m"""
    cell: float
    """edge of a cell, in m"""
    z: float
    """height of the floor, in m"""
    codes: NDArray[np.uint8]
    """a `Ground` for each cell"""
    heights: NDArray[np.int16]
    """height of each cell above `z`, in mm; 0 where there is no ground"""

    def ground_at(self, x: float, y: float, z: float) -> Ground:
        """Return whether the robot can stand over the cell at a position in m, or why it can't.

        Of several cells above each other, the nearest in height counts. The result is NONE if there
        is no cell.
        """
        column = int(np.floor((x - self.origin[0]) / self.cell))
        row = int(np.floor((y - self.origin[1]) / self.cell))
        _, rows, columns = self.codes.shape
        if not (0 <= row < rows and 0 <= column < columns):
            return Ground.NONE
        codes = self.codes[:, row, column]
        away = np.abs(self.z + self.heights[:, row, column] * _STEP - z)
        return Ground(int(codes[np.argmin(np.where(codes == Ground.NONE, np.inf, away))]))

    def to_bytes(self) -> bytes:
        """Return the map as bytes: a line of JSON, then the arrays, compressed by zlib.

        The codes come first, then the heights: signed 16-bit numbers, low byte first, in units of
        `step` (m) above `z`. Both are stored layer by layer, and each layer row by row.
        """
        layers, rows, columns = self.codes.shape
        header = {
            "form": 1,
            "floor": self.floor,
            "heading": self.heading,
            "yaw": self.yaw,
            "origin": self.origin,
            "cell": self.cell,
            "z": self.z,
            "step": _STEP,
            "layers": layers,
            "rows": rows,
            "columns": columns,
            "snap": SNAP_DISTANCE,
            "codes": {ground.name.lower(): ground.value for ground in Ground},
        }
        body = self.codes.tobytes() + self.heights.astype("<i2").tobytes()
        return json.dumps(header).encode() + b"\n" + zlib.compress(body, 9)


def read_standing_map(content: bytes) -> StandingMap:
    """Return the map that `StandingMap.to_bytes` made; raises Invalid for other content."""
    try:
        line, _, compressed = content.partition(b"\n")
        header: dict[str, Any] = json.loads(line)
        body = zlib.decompress(compressed)
        shape = header["layers"], header["rows"], header["columns"]
        count = int(np.prod(shape))
        return StandingMap(
            header["floor"],
            header["heading"],
            header["yaw"],
            (header["origin"][0], header["origin"][1]),
            header["cell"],
            header["z"],
            np.frombuffer(body, np.uint8, count).reshape(shape),
            np.frombuffer(body, "<i2", count, count).reshape(shape),
        )
    except (ValueError, KeyError, TypeError, IndexError, zlib.error) as error:
        raise Invalid(
            Message("the content is not a map of where a robot can stand: {error}", error=error)
        ) from error


def standing_map(
    site: OpenedSite, floor: int, heading_index: int, obstacles: Sequence[Obstacle] = ()
) -> StandingMap:
    """Return a map of where on a floor the robot can stand with a heading.

    It also states where the robot can get from the docks and back. `heading_index` is a number
    of equal steps counter-clockwise from the x axis. A floor without any surface gives a map
    without cells. Raises NotFound if there is no such floor, Invalid if there is no such heading.
    """
    z = site.site.floor(floor).z
    if not 0 <= heading_index < HEADINGS:
        raise Invalid(
            Message(
                "there is no heading {heading_index}: give a number from 0 (along the x "
                "axis) to {headings}, counter-clockwise",
                heading_index=heading_index,
                headings=HEADINGS - 1,
            )
        )
    codes = _ground_codes(site, tuple(obstacles))
    surface = site.navigator.surface
    bases = np.array([f.z for f in site.site.spec.floors]) - 0.1  # as `Site.floor_at`
    numbers = np.maximum(np.searchsorted(bases, surface.z, side="right"), 1)
    cells = np.flatnonzero(numbers == floor)
    if not len(cells):
        empty = np.zeros((1, 0, 0))
        return StandingMap(
            floor, heading_index, heading_angle(heading_index), (0.0, 0.0), CELL, z,
            empty.astype(np.uint8), empty.astype(np.int16),
        )  # fmt: skip
    i, j = surface.i[cells], surface.j[cells]
    i0, j0 = int(i.min()), int(j.min())
    # Cells are sorted by column and height, so cells above each other are adjacent.
    above = np.concatenate([[False], (np.diff(i) == 0) & (np.diff(j) == 0)])
    index = np.arange(len(cells))
    layer = index - np.maximum.accumulate(np.where(above, 0, index))
    shape = int(layer.max()) + 1, int(j.max()) - j0 + 1, int(i.max()) - i0 + 1
    map_codes, heights = np.zeros(shape, np.uint8), np.zeros(shape, np.int16)
    indices = layer, j - j0, i - i0
    map_codes[indices] = codes[cells, heading_index]
    heights[indices] = np.round((surface.z[cells] - z) / _STEP)
    origin = surface.grid.x0 + i0 * CELL, surface.grid.y0 + j0 * CELL
    return StandingMap(
        floor, heading_index, heading_angle(heading_index), origin, CELL, z, map_codes, heights
    )


@lru_cache(maxsize=4)
def _ground_codes(site: OpenedSite, obstacles: tuple[Obstacle, ...]) -> NDArray[np.uint8]:
    """Return a `Ground` for each cell of the surface and each heading, shape (cells, headings)."""

    def make_codes() -> dict[str, NDArray[np.uint8]]:
        return {"codes": _codes_without_obstacles(site.navigator)}

    codes = site.parts.load_or_make(f"standing-{_FORMAT}", make_codes)["codes"].copy()
    navigator = with_obstacles(site, obstacles).navigator
    lattice = navigator.lattice
    closed = lattice.state_of[lattice.cell, lattice.heading] < 0
    codes[lattice.cell, lattice.heading] = np.where(closed, Ground.CLOSED, Ground.CUT_OFF)
    docks = [nearest_state(lattice, dock) for dock in site.site.docks.values()]
    sources = [dock for dock in docks if dock is not None]
    if sources:
        reached = np.isfinite(shortest_path_costs(lattice.costs, sources)).any(axis=0) & ~closed
        codes[lattice.cell[reached], lattice.heading[reached]] = Ground.REACHED
    return codes


def _codes_without_obstacles(navigator: Navigator) -> NDArray[np.uint8]:
    """Return the codes for the surface alone, with CUT_OFF wherever the robot can stand."""
    surface, robot = navigator.surface, navigator.robot
    codes = np.empty((surface.size, HEADINGS), np.uint8)
    for heading in range(HEADINGS):
        stencil = footprint_stencil(robot.footprint, heading, MARGIN)
        for first in range(0, surface.size, _CHUNK):
            cells = np.arange(first, min(first + _CHUNK, surface.size))
            z = stencil.surface_heights(surface, cells)
            can_stand = rise_front_over_rear(z, stencil, heading) <= LEVEL
            slope_codes = np.where(can_stand, Ground.CUT_OFF, Ground.TOO_STEEP)
            fits = np.isfinite(z.sum(axis=0))
            codes[cells, heading] = np.where(fits, slope_codes, Ground.TOO_NEAR)
    return codes
