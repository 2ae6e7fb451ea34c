"""Where the robot can stand on a floor, heading by heading, so that a page need not ask."""

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
from argo_env.navigation import Navigator
from argo_env.navigation.graphs import shortest_path_costs
from argo_env.navigation.lattice import LEVEL, MARGIN, footprint_rise
from argo_env.navigation.navigator import SNAP_DISTANCE, nearest_state
from argo_env.navigation.raster import CELL
from argo_env.navigation.stencil import HEADINGS, footprint_stencil, heading_angle
from argo_env.planning.opening import OpenedSite
from argo_planner.service.world.obstacles import Obstacle, with_obstacles

_FORM = "1"  # of what is kept on disk
_STEP = 1e-3  # m, of heights
_AT_ONCE = 1 << 17  # cells that are looked at together: of large sites all would take GB


class Ground(IntEnum):
    """Whether the robot can stand over the middle of a cell with a heading, and why not."""

    NONE = 0
    """nothing to stand on, or something that stands there"""
    TOO_NEAR = 1
    """a part of the robot would be over a rim or touch something"""
    TOO_STEEP = 2
    """one end of the robot, or one side, would be too high"""
    CUT_OFF = 3
    """it can stand there, but not get there from the docks, or not back"""
    CLOSED = 4
    """it would touch an obstacle"""
    REACHED = 5
    """it can stand there, and gets there"""


@dataclass(frozen=True)
class StandingMap:
    """A floor's cells with one heading. The arrays have the shape (layers, rows, columns): where
    cells lie above each other, as under a flight of stairs, the lower one comes first."""

    floor: int
    heading: int
    """number of it, counter-clockwise from the x axis in equal steps"""
    yaw: float
    """rad"""
    origin: tuple[float, float]
    """m, the corner of least x and y of the first cell"""
    cell: float
    """m, edge of a cell"""
    z: float
    """m, the height of the floor"""
    codes: NDArray[np.uint8]
    """a `Ground` for each cell"""
    heights: NDArray[np.int16]
    """mm above `z`; 0 where there is no ground"""

    def at(self, x: float, y: float, z: float) -> Ground:
        """What holds for the cell that the place (m) lies in, of several the nearest in height."""
        column = int(np.floor((x - self.origin[0]) / self.cell))
        row = int(np.floor((y - self.origin[1]) / self.cell))
        _, rows, columns = self.codes.shape
        if not (0 <= row < rows and 0 <= column < columns):
            return Ground.NONE
        codes = self.codes[:, row, column]
        away = np.abs(self.z + self.heights[:, row, column] * _STEP - z)
        return Ground(int(codes[np.argmin(np.where(codes == Ground.NONE, np.inf, away))]))

    def to_bytes(self) -> bytes:
        """A line of JSON, then the codes and the heights (16 bits, low byte first), row by row and
        layer by layer, compressed by zlib."""
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
    """What `to_bytes` wrote; Invalid if it is none."""
    try:
        line, _, packed = content.partition(b"\n")
        said: dict[str, Any] = json.loads(line)
        body = zlib.decompress(packed)
        shape = said["layers"], said["rows"], said["columns"]
        count = int(np.prod(shape))
        return StandingMap(
            said["floor"],
            said["heading"],
            said["yaw"],
            (said["origin"][0], said["origin"][1]),
            said["cell"],
            said["z"],
            np.frombuffer(body, np.uint8, count).reshape(shape),
            np.frombuffer(body, "<i2", count, count).reshape(shape),
        )
    except (ValueError, KeyError, TypeError, IndexError, zlib.error) as error:
        raise Invalid(f"this is no map of where a robot can stand: {error}") from error


def standing_map(
    site: OpenedSite, floor: int, heading: int, obstacles: Sequence[Obstacle] = ()
) -> StandingMap:
    """The map of a floor for one of the headings. NotFound for a floor that is not there, Invalid
    for a heading that is not."""
    found = site.site.floor(floor)
    if not 0 <= heading < HEADINGS:
        raise Invalid(f"there is no heading {heading}: there are 0 to {HEADINGS - 1}")
    codes = _codes(site, tuple(obstacles))
    surface = site.navigator.surface
    bases = np.array([f.z for f in site.site.spec.floors]) - 0.1  # as `Site.floor_at`
    numbers = np.maximum(np.searchsorted(bases, surface.z, side="right"), 1)
    cells = np.flatnonzero(numbers == floor)
    if not len(cells):
        empty = np.zeros((1, 0, 0))
        return StandingMap(
            floor, heading, heading_angle(heading), (0.0, 0.0), CELL, found.z,
            empty.astype(np.uint8), empty.astype(np.int16),
        )  # fmt: skip
    i, j = surface.i[cells], surface.j[cells]
    i0, j0 = int(i.min()), int(j.min())
    # Cells are sorted by column and height, so that those above each other follow each other.
    above = np.concatenate([[False], (np.diff(i) == 0) & (np.diff(j) == 0)])
    number = np.arange(len(cells))
    layer = number - np.maximum.accumulate(np.where(above, 0, number))
    shape = int(layer.max()) + 1, int(j.max()) - j0 + 1, int(i.max()) - i0 + 1
    grounds, heights = np.zeros(shape, np.uint8), np.zeros(shape, np.int16)
    place = layer, j - j0, i - i0
    grounds[place] = codes[cells, heading]
    heights[place] = np.round((surface.z[cells] - found.z) / _STEP)
    origin = surface.grid.x0 + i0 * CELL, surface.grid.y0 + j0 * CELL
    return StandingMap(
        floor, heading, heading_angle(heading), origin, CELL, found.z, grounds, heights
    )


@lru_cache(maxsize=4)
def _codes(site: OpenedSite, obstacles: tuple[Obstacle, ...]) -> NDArray[np.uint8]:
    """For each cell of the surface and each heading a `Ground`."""

    def make() -> dict[str, NDArray[np.uint8]]:
        return {"codes": _codes_without_obstacles(site.navigator)}

    codes = site.parts.load_or_make(f"standing-{_FORM}", make)["codes"]
    navigator = with_obstacles(site, obstacles).navigator
    lattice = navigator.lattice
    found = codes.copy()
    closed = lattice.state_of[lattice.cell, lattice.heading] < 0
    found[lattice.cell, lattice.heading] = np.where(closed, Ground.CLOSED, Ground.CUT_OFF)
    docks = [nearest_state(lattice, dock) for dock in site.site.docks.values()]
    sources = [dock for dock in docks if dock is not None]
    if sources:
        reached = np.isfinite(shortest_path_costs(lattice.costs, sources)).any(axis=0) & ~closed
        found[lattice.cell[reached], lattice.heading[reached]] = Ground.REACHED
    return found


def _codes_without_obstacles(navigator: Navigator) -> NDArray[np.uint8]:
    surface, robot = navigator.surface, navigator.robot
    codes = np.empty((surface.size, HEADINGS), np.uint8)
    for heading in range(HEADINGS):
        stencil = footprint_stencil(robot.footprint, heading, MARGIN)
        for first in range(0, surface.size, _AT_ONCE):
            cells = np.arange(first, min(first + _AT_ONCE, surface.size))
            z = stencil.heights(surface, cells)
            stands = footprint_rise(z, stencil, heading) <= LEVEL
            steep = np.where(stands, Ground.CUT_OFF, Ground.TOO_STEEP)
            fits = np.isfinite(z.sum(axis=0))
            codes[cells, heading] = np.where(fits, steep, Ground.TOO_NEAR)
    return codes
