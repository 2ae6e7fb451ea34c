"""Shorter paths: cut corners of a lattice path where the whole robot has room to."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.model import Pose
from argo_env.navigation.lattice import DRIVING_LEVEL, MARGIN, TURNING_LEVEL
from argo_env.navigation.path import Motion, Path, merge, wrap
from argo_env.navigation.raster import CELL, Grid
from argo_env.navigation.stencil import overlaps
from argo_env.navigation.surface import DIRECTIONS, Surface
from argo_env.robot.spec import Footprint, MotionKind, RobotSpec

_SAME_PLACE, _SAME_YAW = 1e-9, 1e-9  # m, rad
_TURN_STEP = math.radians(5.0)
_VERTEX_SPACING = 1.0  # m between places where a short cut may begin or end
_VERTEX_TURN = math.radians(90.0)  # less than half a turn, so that its direction stays clear
_ASIDE = CELL * math.sqrt(0.5)  # m of a place from the centre of its cell, at most


Centers = tuple[NDArray[np.float64], NDArray[np.float64]]
"""x, ascending, and y of the centres of cells, in m."""


@dataclass(frozen=True)
class FlatMap:
    """The cells at one height: `free[i, j]` says whether the surface goes on there.

    The checks are for a robot that stands on free cells: what it sweeps from there hangs together,
    so it leaves the free cells over one of those that border on them, and only these are looked at.
    """

    grid: Grid
    free: NDArray[np.bool_]
    rims: NDArray[np.bool_]
    """free cells beside a rim over which the robot must not turn"""

    @staticmethod
    def at(surface: Surface, z: float) -> "FlatMap":
        """The map of all cells within the height that counts as flat about z (m)."""
        free = np.zeros((surface.grid.nx, surface.grid.ny), dtype=bool)
        level = np.abs(surface.z - z) <= DRIVING_LEVEL
        free[surface.i[level], surface.j[level]] = True
        height = np.full((surface.grid.nx + 2, surface.grid.ny + 2), np.nan)
        height[1 + surface.i[level], 1 + surface.j[level]] = surface.z[level]
        rims = np.zeros_like(height, dtype=bool)
        for di, dj in DIRECTIONS:
            rims |= np.abs(np.roll(height, (di, dj), axis=(0, 1)) - height) > TURNING_LEVEL
        return FlatMap(surface.grid, free, rims[1:-1, 1:-1])

    @cached_property
    def _border(self) -> Centers:
        """The cells that are not free and touch free ones."""
        return self._places(self._beside_free)

    @cached_property
    def _turning_border(self) -> Centers:
        """The border and the rims, alike."""
        return self._places(self._beside_free | np.pad(self.rims, 2))

    @cached_property
    def _beside_free(self) -> NDArray[np.bool_]:
        """Of the grid with two more cells on each side."""
        free = np.pad(self.free, 2)
        nearby = np.zeros_like(free)
        for di in (-1, 0, 1):
            for dj in (-1, 0, 1):
                nearby |= np.roll(free, (di, dj), axis=(0, 1))
        return nearby & ~free

    def _places(self, cells: NDArray[np.bool_]) -> Centers:
        i, j = np.nonzero(cells)
        return self.grid.centers(i - 2, j - 2)

    @cached_property
    def _room(self) -> NDArray[np.float64]:
        """How far the centre of each cell is from that of the nearest cell of the border (m), of
        the grid with two more cells on each side; 0 where it is not free."""
        return np.where(np.pad(self.free, 2), _distances(self._beside_free), 0.0)

    @cached_property
    def _turning_room(self) -> NDArray[np.float64]:
        """The same for the border and the rims."""
        near = self._beside_free | np.pad(self.rims, 2)
        return np.where(np.pad(self.free, 2), _distances(near), 0.0)

    def obvious_drives(
        self, a: NDArray[np.float64], ends: NDArray[np.float64], footprint: Footprint
    ) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Of the drives from the place `a` (x, y) to each of `ends`, shape (n, 2): which ones are
        clear for sure, and which ones surely are not, by the room around places along them."""
        away = ends - a
        longest = float(np.hypot(away[:, 0], away[:, 1]).max(initial=0.0))
        shares = np.arange(2 + int(longest / CELL)) / (1 + int(longest / CELL))
        i = ((a[0] - self.grid.x0 + away[:, :1] * shares) / CELL).astype(np.int64) + 2
        j = ((a[1] - self.grid.y0 + away[:, 1:] * shares) / CELL).astype(np.int64) + 2
        least = self._room[i, j].min(axis=1)
        outer = footprint.radius + MARGIN
        return least > outer + 2 * _ASIDE + CELL / 2, least < _inner(footprint) - _ASIDE

    def clear_drive(self, a: Pose, b: Pose, footprint: Footprint) -> bool:
        """Whether the robot touches free cells only, all the way straight ahead from a to b."""
        reach = footprint.radius + MARGIN + CELL
        low, high = (min(a.x, b.x), min(a.y, b.y)), (max(a.x, b.x), max(a.y, b.y))
        x, y = _near(self._border, low, high, reach)
        ahead, yaw = math.dist((a.x, a.y), (b.x, b.y)), math.atan2(b.y - a.y, b.x - a.x)
        swept = footprint.model_copy(update={"front": footprint.front + ahead})
        return not overlaps(swept, MARGIN, yaw, x - a.x, y - a.y).any()

    def clear_turn(self, at: Pose, turn: float, footprint: Footprint) -> bool:
        """Whether the robot touches free cells only, and no rim, while it turns in place by `turn`
        (rad)."""
        reach = footprint.radius + MARGIN + CELL
        i, j = int((at.x - self.grid.x0) / CELL) + 2, int((at.y - self.grid.y0) / CELL) + 2
        room = self._turning_room[i, j]
        if room > reach + _ASIDE or room < _inner(footprint) - _ASIDE:
            return bool(room > reach)
        x, y = _near(self._turning_border, (at.x, at.y), (at.x, at.y), reach)
        x, y = x - at.x, y - at.y
        near = np.hypot(x, y) <= reach
        if not near.any():
            return True
        yaws = at.yaw + turn * np.linspace(0.0, 1.0, 1 + math.ceil(abs(turn) / _TURN_STEP))
        return not overlaps(footprint, MARGIN, yaws[:, None], x[near], y[near]).any()


def _distances(cells: NDArray[np.bool_]) -> NDArray[np.float64]:
    """m from the centre of each cell to that of the nearest of these."""
    # With the first path only: see `graphs`.
    from scipy.ndimage import distance_transform_edt

    return np.asarray(distance_transform_edt(~cells) * CELL)


def _inner(footprint: Footprint) -> float:
    """m around the robot's middle that it always covers, with the margin, however it is turned."""
    return min(footprint.half_width, footprint.front, footprint.rear) + MARGIN


def _near(
    places: Centers, low: tuple[float, float], high: tuple[float, float], reach: float
) -> Centers:
    """Those within `reach` (m) of the rectangle from `low` to `high`."""
    x, y = places
    part = slice(*np.searchsorted(x, (low[0] - reach, high[0] + reach)))
    x, y = x[part], y[part]
    near = (y >= low[1] - reach) & (y <= high[1] + reach)
    return x[near], y[near]


def smooth(path: Path, flat_map: Callable[[float], FlatMap], robot: RobotSpec) -> Path:
    """The path with every level stretch that is driven forwards shortened where that saves time."""
    motions: list[Motion] = []
    stretch: list[Motion] = []
    for motion in path.motions:
        if motion.gear > 0 and not motion.on_stairs:
            stretch.append(motion)
        else:
            motions += _shorten(stretch, flat_map, robot)
            motions.append(motion)
            stretch = []
    return Path(path.start, tuple(motions + _shorten(stretch, flat_map, robot)))


def _shorten(
    stretch: list[Motion], flat_map: Callable[[float], FlatMap], robot: RobotSpec
) -> list[Motion]:
    if len(stretch) < 2:
        return stretch
    poses = _vertices(stretch)
    cells = flat_map(poses[0].z)
    pieces = [connect(a, b) for a, b in pairwise(poses)]
    plain = _elapsed(pieces, robot)
    table = np.array([[p.x, p.y, p.yaw] for p in poses])
    saved = plain - plain[:, None] - _direct(table[:, None], table, robot)
    kept: list[Motion] = []
    at = 0
    while at < len(poses) - 1:
        to, motions = at + 1, pieces[at]
        worth = at + 2 + np.flatnonzero(saved[at, at + 2 :] > 1e-9)[::-1]
        clear, blocked = cells.obvious_drives(table[at, :2], table[worth, :2], robot.footprint)
        for further, sure in zip(worth[~blocked].tolist(), clear[~blocked].tolist(), strict=True):
            # The drive first: it is what fails most.
            if not sure and not cells.clear_drive(poses[at], poses[further], robot.footprint):
                continue
            short_cut = connect(poses[at], poses[further])
            if all(cells.clear_turn(m.start, m.turn, robot.footprint) for m in short_cut if m.turn):
                to, motions = further, short_cut
                break
        kept += motions
        at = to
    return merge(kept)


def _elapsed(pieces: list[list[Motion]], robot: RobotSpec) -> NDArray[np.float64]:
    """s at the start and after each of the pieces of a way, shape (n + 1,). Motions that go on
    alike are one motion, and set off once."""
    times, last = [0.0], None
    for piece in pieces:
        time = times[-1]
        for motion in piece:
            lost = robot.calibration.pace_for(motion.kind).lost if motion.kind == last else 0.0
            time += motion.duration(robot) - lost
            last = motion.kind
        times.append(time)
    return np.array(times)


def _direct(
    here: NDArray[np.float64], there: NDArray[np.float64], robot: RobotSpec
) -> NDArray[np.float64]:
    """s to turn from each of the poses `here` towards one of `there`, drive to it, and turn as it
    asks. Poses are x, y, yaw; the arrays are broadcast."""
    x, y, yaw = there[..., 0] - here[..., 0], there[..., 1] - here[..., 1], there[..., 2]
    length, towards = np.hypot(x, y), np.arctan2(y, x)
    drives = length >= _SAME_PLACE
    first = np.where(drives, towards, yaw) - here[..., 2]
    last = np.where(drives, yaw - towards, 0.0)
    seconds = np.zeros(length.shape)
    for angle in (first, last):
        size = np.abs((angle + np.pi) % (2 * np.pi) - np.pi)
        turns = size / robot.real_speed(MotionKind.TURN) + robot.calibration.turn.lost
        seconds += np.where(size < _SAME_YAW, 0.0, turns)
    drive = length / robot.real_speed(MotionKind.AHEAD) + robot.calibration.ahead.lost
    return np.asarray(seconds + np.where(drives, drive, 0.0))


def _vertices(stretch: list[Motion]) -> list[Pose]:
    """The ends of the motions, and poses between them along long drives and turns."""
    poses = [stretch[0].start]
    for motion in stretch:
        pieces = math.ceil(
            max(motion.length / _VERTEX_SPACING, abs(motion.turn) / _VERTEX_TURN, 1.0)
        )
        poses += [motion.at(k / pieces) for k in range(1, pieces)]
        poses.append(motion.end)
    return poses


def connect(a: Pose, b: Pose) -> list[Motion]:
    """Turn towards b, drive there, turn as b asks."""
    if math.dist((a.x, a.y), (b.x, b.y)) < _SAME_PLACE:
        return turn(a, b.yaw)
    yaw = math.atan2(b.y - a.y, b.x - a.x)
    start, end = (Pose(x=p.x, y=p.y, z=p.z, yaw=yaw) for p in (a, b))
    return [*turn(a, yaw), Motion(start, end), *turn(end, b.yaw)]


def turn(pose: Pose, yaw: float) -> list[Motion]:
    """The turn in place to a heading of `yaw` (rad), if that is one."""
    angle = wrap(yaw - pose.yaw)
    if abs(angle) < _SAME_YAW:
        return []
    return [Motion(pose, Pose(x=pose.x, y=pose.y, z=pose.z, yaw=yaw), turn=angle)]
