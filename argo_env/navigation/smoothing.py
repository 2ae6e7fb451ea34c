"""Shorter paths: cut corners of a lattice path where the whole robot has room to."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.model import Pose
from argo_env.navigation.lattice import MARGIN, TURNING_LEVEL
from argo_env.navigation.path import Motion, Path, merge, wrap
from argo_env.navigation.raster import CELL, Grid
from argo_env.navigation.stencil import cells_around, overlaps
from argo_env.navigation.surface import Surface
from argo_env.robot.spec import Footprint, RobotSpec

_DRIVE_STEP = 0.05  # m between the poses that are looked at
_TURN_STEP = math.radians(5.0)
_VERTEX_SPACING = 1.0  # m between places where a short cut may begin or end
_VERTEX_TURN = math.radians(90.0)  # less than half a turn, so that its direction stays clear


@dataclass(frozen=True)
class FlatMap:
    """The cells at one height: `free[i, j]` says whether the surface goes on there."""

    grid: Grid
    free: NDArray[np.bool_]

    @staticmethod
    def at(surface: Surface, z: float) -> "FlatMap":
        """The map of all cells within the height that counts as flat about z (m)."""
        free = np.zeros((surface.grid.nx, surface.grid.ny), dtype=bool)
        level = np.abs(surface.z - z) <= TURNING_LEVEL
        free[surface.i[level], surface.j[level]] = True
        return FlatMap(surface.grid, free)

    def clear(self, poses: NDArray[np.float64], footprint: Footprint) -> bool:
        """Whether a robot at all `poses`, shape (n, 3) as x, y, yaw, touches free cells only."""
        around = cells_around(footprint, MARGIN)
        i = np.floor((poses[:, 0] - self.grid.x0) / CELL).astype(np.int64)[:, None, None]
        j = np.floor((poses[:, 1] - self.grid.y0) / CELL).astype(np.int64)[:, None, None]
        i, j = np.broadcast_arrays(i + around[None, :, None], j + around[None, None, :])
        x, y = self.grid.centers(i, j)
        at_x, at_y, yaw = (poses[:, k, None, None] for k in range(3))
        touched = overlaps(footprint, MARGIN, yaw, x - at_x, y - at_y)
        i, j = i[touched], j[touched]
        inside = (i >= 0) & (i < self.grid.nx) & (j >= 0) & (j < self.grid.ny)
        return bool(inside.all()) and bool(self.free[i, j].all())


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
    kept: list[Motion] = []
    here, at = poses[0], 0
    while at < len(poses) - 1:
        for to in range(len(poses) - 1, at, -1):
            short_cut = _connect(here, poses[to])
            plain = _plain(here, poses[at + 1 : to + 1])
            if to == at + 1 or (
                _duration(short_cut, robot) < _duration(plain, robot) - 1e-9
                and all(cells.clear(_sampled(m), robot.footprint) for m in short_cut)
            ):
                kept += plain if to == at + 1 else short_cut
                here, at = poses[to], to
                break
    return merge(kept)


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


def _connect(a: Pose, b: Pose) -> list[Motion]:
    """Turn towards b, drive there, turn as b asks."""
    if math.dist((a.x, a.y), (b.x, b.y)) < 1e-9:
        return _turn(a, b.yaw)
    yaw = math.atan2(b.y - a.y, b.x - a.x)
    start, end = a.model_copy(update={"yaw": yaw}), b.model_copy(update={"yaw": yaw})
    return [*_turn(a, yaw), Motion(start, end), *_turn(end, b.yaw)]


def _turn(pose: Pose, yaw: float) -> list[Motion]:
    angle = wrap(yaw - pose.yaw)
    if abs(angle) < 1e-9:
        return []
    return [Motion(pose, pose.model_copy(update={"yaw": yaw}), turn=angle)]


def _plain(here: Pose, poses: list[Pose]) -> list[Motion]:
    """The motions through the given vertices as they are."""
    motions = []
    for pose in poses:
        if (pose.x, pose.y) == (here.x, here.y):
            motions += _turn(here, pose.yaw)
        else:
            motions.append(Motion(here, pose))
        here = pose
    return motions


def _duration(motions: list[Motion], robot: RobotSpec) -> float:
    return sum(m.duration(robot) for m in motions)


def _sampled(motion: Motion) -> NDArray[np.float64]:
    """Poses along the motion as x, y, yaw."""
    a, b = motion.start, motion.end
    count = 1 + math.ceil(max(motion.length / _DRIVE_STEP, abs(motion.turn) / _TURN_STEP))
    share = np.linspace(0.0, 1.0, count)
    return np.column_stack(
        [a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), a.yaw + share * motion.turn]
    )
