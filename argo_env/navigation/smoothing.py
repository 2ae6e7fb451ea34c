"""Path smoothing: shortcuts across corners of a lattice path where the whole robot has room."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.memoization import thread_safe_cached_property
from argo_compiler.base.model import Pose
from argo_env.navigation.lattice import DRIVING_LEVEL, MARGIN, TURNING_LEVEL
from argo_env.navigation.path import Motion, Path, merge, wrap
from argo_env.navigation.raster import CELL, Grid
from argo_env.navigation.stencil import overlaps_cells
from argo_env.navigation.surface import DIRECTIONS, Surface
from argo_env.robot.spec import Footprint, MotionKind, RobotSpec

_SAME_PLACE, _SAME_YAW = 1e-9, 1e-9  # m, rad
_TURN_STEP = math.radians(5.0)
_VERTEX_SPACING = 1.0  # m between poses where a shortcut may begin or end
_VERTEX_TURN = math.radians(90.0)  # less than half a turn, so that its direction stays unambiguous
_ASIDE = CELL * math.sqrt(0.5)  # m, greatest distance of a point from the centre of its cell


Centers = tuple[NDArray[np.float64], NDArray[np.float64]]
"""x, ascending, and y of the centres of cells, in m"""


@dataclass(frozen=True)
class FlatMap:
    """Map of the cells at one height: `free[i, j]` is True if the surface continues there.

    The checks assume that the robot stands on free cells. The area that it sweeps is connected, so
    it can leave the free cells only over a cell that borders on them. Only these are checked.
    """

    grid: Grid
    free: NDArray[np.bool_]
    rims: NDArray[np.bool_]
    """free cells that no turn may touch: beside one more than TURNING_LEVEL higher or lower"""

    @staticmethod
    def at_height(surface: Surface, z: float) -> "FlatMap":
        """Return the map of the cells whose height is at most DRIVING_LEVEL from `z` (m)."""
        free = np.zeros((surface.grid.nx, surface.grid.ny), dtype=bool)
        level = np.abs(surface.z - z) <= DRIVING_LEVEL
        free[surface.i[level], surface.j[level]] = True
        height = np.full((surface.grid.nx + 2, surface.grid.ny + 2), np.nan)
        height[1 + surface.i[level], 1 + surface.j[level]] = surface.z[level]
        rims = np.zeros_like(height, dtype=bool)
        for di, dj in DIRECTIONS:
            rims |= np.abs(np.roll(height, (di, dj), axis=(0, 1)) - height) > TURNING_LEVEL
        return FlatMap(surface.grid, free, rims[1:-1, 1:-1])

    @thread_safe_cached_property
    def _border(self) -> Centers:
        """Centres of the cells that are not free and touch free ones."""
        return self._centers(self._beside_free)

    @thread_safe_cached_property
    def _turning_border(self) -> Centers:
        """Centres of the cells of the border, which are not free, and of the rims, which are."""
        return self._centers(self._beside_free | np.pad(self.rims, 2))

    @thread_safe_cached_property
    def _beside_free(self) -> NDArray[np.bool_]:
        """Mask of the border's cells, on the grid with two more cells on each side."""
        free = np.pad(self.free, 2)
        nearby = np.zeros_like(free)
        for di in (-1, 0, 1):
            for dj in (-1, 0, 1):
                nearby |= np.roll(free, (di, dj), axis=(0, 1))
        return nearby & ~free

    def _centers(self, cells: NDArray[np.bool_]) -> Centers:
        i, j = np.nonzero(cells)
        return self.grid.centers(i - 2, j - 2)

    @thread_safe_cached_property
    def _border_distance(self) -> NDArray[np.float64]:
        """Distance (m) of each cell's centre to that of the nearest cell of the border.

        It is on the grid with two more cells on each side, and 0 where a cell is not free.
        """
        return np.where(np.pad(self.free, 2), _distances(self._beside_free), 0.0)

    @thread_safe_cached_property
    def _turning_border_distance(self) -> NDArray[np.float64]:
        """Distance (m) as `_border_distance`, to the nearest cell of the border or of `rims`."""
        near = self._beside_free | np.pad(self.rims, 2)
        return np.where(np.pad(self.free, 2), _distances(near), 0.0)

    def surely_clear_and_surely_blocked(
        self, start: NDArray[np.float64], ends: NDArray[np.float64], footprint: Footprint
    ) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Return masks of the drives that are certainly clear, and certainly blocked.

        The distance to the border along a drive decides; the other drives need `is_drive_clear`.

        Args:
            start: Start x, y (m) of all drives, shape (2,).
            ends: End x, y (m) of each drive, shape (n, 2).
            footprint: Footprint of the robot.

        Returns:
            Two masks of shape (n,).
        """
        away = ends - start
        longest = float(np.hypot(away[:, 0], away[:, 1]).max(initial=0.0))
        shares = np.arange(2 + int(longest / CELL)) / (1 + int(longest / CELL))
        i = ((start[0] - self.grid.x0 + away[:, :1] * shares) / CELL).astype(np.int64) + 2
        j = ((start[1] - self.grid.y0 + away[:, 1:] * shares) / CELL).astype(np.int64) + 2
        room = self._border_distance[i, j].min(axis=1)
        outer = footprint.radius + MARGIN
        return room > outer + 2 * _ASIDE + CELL / 2, room < _inner_radius(footprint) - _ASIDE

    def is_drive_clear(self, a: Pose, b: Pose, footprint: Footprint) -> bool:
        """Return True if the robot touches free cells only as it drives straight from a to b.

        It drives forwards: the headings of a and b are ignored.
        """
        reach = footprint.radius + MARGIN + CELL
        low, high = (min(a.x, b.x), min(a.y, b.y)), (max(a.x, b.x), max(a.y, b.y))
        x, y = _centers_near(self._border, low, high, reach)
        ahead, yaw = math.dist((a.x, a.y), (b.x, b.y)), math.atan2(b.y - a.y, b.x - a.x)
        swept = footprint.model_copy(update={"front": footprint.front + ahead})
        return not overlaps_cells(swept, MARGIN, yaw, x - a.x, y - a.y).any()

    def is_turn_clear(self, at: Pose, turn: float, footprint: Footprint) -> bool:
        """Return True if the robot touches free cells only, and none of `rims`, in a turn in place.

        It turns by `turn` (rad, counter-clockwise) from the pose `at`.
        """
        reach = footprint.radius + MARGIN + CELL
        i, j = int((at.x - self.grid.x0) / CELL) + 2, int((at.y - self.grid.y0) / CELL) + 2
        room = self._turning_border_distance[i, j]
        if room > reach + _ASIDE or room < _inner_radius(footprint) - _ASIDE:
            return bool(room > reach)
        x, y = _centers_near(self._turning_border, (at.x, at.y), (at.x, at.y), reach)
        x, y = x - at.x, y - at.y
        near = np.hypot(x, y) <= reach
        if not near.any():
            return True
        yaws = at.yaw + turn * np.linspace(0.0, 1.0, 1 + math.ceil(abs(turn) / _TURN_STEP))
        return not overlaps_cells(footprint, MARGIN, yaws[:, None], x[near], y[near]).any()


def _distances(cells: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Return the distance (m) from each cell's centre to that of the nearest cell of the mask.

    It is 0 in the mask.
    """
    # scipy is imported with the first path only: see `graphs`.
    from scipy.ndimage import distance_transform_edt

    return np.asarray(distance_transform_edt(~cells) * CELL)


def _inner_radius(footprint: Footprint) -> float:
    """Return the radius (m) about the robot's point of rotation that it covers with any heading.

    The margin is included.
    """
    return min(footprint.half_width, footprint.front, footprint.rear) + MARGIN


def _centers_near(
    centers: Centers, low: tuple[float, float], high: tuple[float, float], reach: float
) -> Centers:
    """Return the centres in a rectangle, from `low` - `reach` to `high` + `reach` (m)."""
    x, y = centers
    part = slice(*np.searchsorted(x, (low[0] - reach, high[0] + reach)))
    x, y = x[part], y[part]
    near = (y >= low[1] - reach) & (y <= high[1] + reach)
    return x[near], y[near]


def smooth(path: Path, flat_map: Callable[[float], FlatMap], robot: RobotSpec) -> Path:
    """Return the path with shortcuts where they save time.

    They replace parts that are driven forwards on the flat; start and end stay. `flat_map` returns
    the map of the cells whose height counts as flat about a height (m).
    """
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
    pieces = [connecting_motions(a, b) for a, b in pairwise(poses)]
    plain = _elapsed_times(pieces, robot)
    table = np.array([[p.x, p.y, p.yaw] for p in poses])
    saved = plain - plain[:, None] - _direct_times(table[:, None], table, robot)
    shortened: list[Motion] = []
    at = 0
    while at < len(poses) - 1:
        to, motions = at + 1, pieces[at]
        worth = at + 2 + np.flatnonzero(saved[at, at + 2 :] > 1e-9)[::-1]
        clear, blocked = cells.surely_clear_and_surely_blocked(
            table[at, :2], table[worth, :2], robot.footprint
        )
        for further, sure in zip(worth[~blocked].tolist(), clear[~blocked].tolist(), strict=True):
            # The drive is checked first, as it is blocked most often.
            if not sure and not cells.is_drive_clear(poses[at], poses[further], robot.footprint):
                continue
            shortcut = connecting_motions(poses[at], poses[further])
            if all(
                cells.is_turn_clear(m.start, m.turn, robot.footprint) for m in shortcut if m.turn
            ):
                to, motions = further, shortcut
                break
        shortened += motions
        at = to
    return merge(shortened)


def _elapsed_times(pieces: list[list[Motion]], robot: RobotSpec) -> NDArray[np.float64]:
    """Return the time (s) since the start, 0 at first and then after each piece of a path.

    Consecutive motions of the same kind count as one motion, for which the robot sets off once.
    """
    times, last = [0.0], None
    for piece in pieces:
        time = times[-1]
        for motion in piece:
            lost = robot.calibration.pace_for(motion.kind).lost if motion.kind == last else 0.0
            time += motion.duration(robot) - lost
            last = motion.kind
        times.append(time)
    return np.array(times)


def _direct_times(
    here: NDArray[np.float64], there: NDArray[np.float64], robot: RobotSpec
) -> NDArray[np.float64]:
    """Return the time (s) to turn from `here` towards `there`, drive, and turn to its heading.

    Poses are x, y, yaw along the last axis; the arrays are broadcast.
    """
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
    """Return the start, the end of each motion, and poses between along long drives and turns."""
    poses = [stretch[0].start]
    for motion in stretch:
        pieces = math.ceil(
            max(motion.length / _VERTEX_SPACING, abs(motion.turn) / _VERTEX_TURN, 1.0)
        )
        poses += [motion.pose_at(k / pieces) for k in range(1, pieces)]
        poses.append(motion.end)
    return poses


def connecting_motions(a: Pose, b: Pose) -> list[Motion]:
    """Return the turn at a towards b, the drive there, and the turn to the heading of b.

    Turns and a drive that are not needed are left out.
    """
    if math.dist((a.x, a.y), (b.x, b.y)) < _SAME_PLACE:
        return turn_motions(a, b.yaw)
    yaw = math.atan2(b.y - a.y, b.x - a.x)
    start, end = (Pose(x=p.x, y=p.y, z=p.z, yaw=yaw) for p in (a, b))
    return [*turn_motions(a, yaw), Motion(start, end), *turn_motions(end, b.yaw)]


def turn_motions(pose: Pose, yaw: float) -> list[Motion]:
    """Return the turn in place from `pose` to the heading `yaw` (rad) as a list with one motion.

    It turns by at most half a turn. The list is empty if `pose` has this heading already.
    """
    angle = wrap(yaw - pose.yaw)
    if abs(angle) < _SAME_YAW:
        return []
    return [Motion(pose, Pose(x=pose.x, y=pose.y, z=pose.z, yaw=yaw), turn=angle)]
