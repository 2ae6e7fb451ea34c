"""The terrain scanner: depth along rays to the lane ahead, beside what the map lets expect."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy
from numpy.typing import NDArray

from argo_env.robot.pose import BodyPose
from argo_env.sensing.signals.frames import on_site, point, rotation
from argo_env.sensing.signals.site_map import SiteMap
from argo_env.site.shapes import Vector
from argo_env.world.world import World

FRONT: Vector = (0.4, 0.0, 0.8)
REAR: Vector = (-0.45, 0.0, 0.8)
"""m in the robot's frame: one scanner looks ahead, the other back"""
HALF_LANE = 0.46
"""m to both sides that are looked at: half the robot's width, and what it may need to turn"""
FARTHEST = 2.5
"""m from the robot's middle, along the lane"""
DEPTH_NOISE = (0.005, 0.003)
"""standard deviation of a depth: m, and m a metre"""
POSITION_ERROR, HEIGHT_ERROR = 0.01, 0.003
"""m, standard deviations of where the robot believes to be on its map, along each axis and up"""
YAW_ERROR, PITCH_ERROR = math.radians(0.3), math.radians(0.1)
"""rad"""
_STEPS = 0.025 * np.arange(-3, 4)
_RISES = 0.015 * np.arange(-1, 2)
ELSEWHERE = np.stack(np.meshgrid(_STEPS, _STEPS, _RISES), axis=-1).reshape(-1, 3)
"""m: where else the robot may be; what the map explains from any of these places is no detection.
Up and down too, for rays that pass just over the edges of treads"""
PLANAR = 0.035  # m off the plane that the robot stands on within which the lane is as it should be
RAISED, SUNK = 0.05, 0.08
"""m above or below all that the map lets expect from which something is wrong"""
DEEPEST = 0.6  # m below the lane beyond which nothing is told apart
AROUND_CHECKPOINT = 0.35  # m within which a hit may be the checkpoint, wherever it is


@dataclass(frozen=True)
class Scan:
    """What a scan has shown; arrays have the shape (rows, columns) of the rays, or one more axis.

    A ray is `good` if it shows what the map lets expect, `raised` if it ends above, and `sunk` if
    it goes on below a surface to walk on. `surface` is where it should end, in m.
    """

    good: NDArray[np.bool_]
    raised: NDArray[np.bool_]
    sunk: NDArray[np.bool_]
    hits: NDArray[np.float64]
    surface: NDArray[np.float64]


@dataclass(frozen=True)
class Pattern:
    """Rays from a scanner to the plane that the robot stands on, in the robot's frame."""

    origin: Vector
    directions: NDArray[np.float64]
    """unit vectors, shape (rays, 3)"""
    planar: NDArray[np.float64]
    """m to the plane"""
    fall: NDArray[np.float64]
    """m that a ray sinks a metre"""
    reach: NDArray[np.float64]
    """m after which a ray is given up"""
    shape: tuple[int, int]
    """rows and columns"""


@lru_cache(maxsize=128)
def make_pattern(
    backwards: bool, row: float, count: int, columns: int, farthest: float = FARTHEST
) -> Pattern:
    """The pattern of `count` rows, `row` (m) apart, up to `farthest` (m from the robot's middle),
    with rays in `columns`; every other row stands half a gap aside, so that what lies between two
    columns is hit in the next row."""
    rows = farthest - row * np.arange(count)[::-1]
    step = 2 * HALF_LANE / columns
    along, left = np.meshgrid(rows, (np.arange(columns) + 0.25) * step - HALF_LANE, indexing="ij")
    left[1::2] += step / 2
    place, along = (REAR, -along) if backwards else (FRONT, along)
    ways = np.column_stack([along.ravel(), left.ravel(), np.zeros(along.size)]) - np.array(place)
    planar = np.linalg.norm(ways, axis=1)
    fall = place[2] / planar
    return Pattern(
        place, ways / planar[:, None], planar, fall, planar + DEEPEST / fall, (count, columns)
    )


class TerrainScanner:
    """Scans the lane ahead, or the one behind."""

    def __init__(self, world: World, site_map: SiteMap, rng: np.random.Generator) -> None:
        self._world = world
        self._map = site_map
        self._rng = rng

    def scan(self, pose: BodyPose, pattern: Pattern) -> Scan:
        """A scan from `pose`."""
        origin, directions = on_site(pose, pattern.origin), pattern.directions @ rotation(pose).T
        planar, fall, reach = pattern.planar, pattern.fall, pattern.reach
        measured = np.minimum(self._measure(origin, directions, reach), reach)
        # From here on, all is where the robot believes to be.
        believed = self._localised(pose)
        turned = rotation(believed)
        origin, directions = on_site(believed, pattern.origin), pattern.directions @ turned.T
        # All depths as metres below the plane of the lane: what is near an edge can then be
        # compared with its neighbours.
        below = (measured - planar) * fall
        expected, walkable = np.zeros(len(planar)), np.ones(len(planar), dtype=bool)
        odd = np.flatnonzero(np.abs(below) > PLANAR)
        if len(odd):
            depth, solids = self._map.distances(origin, directions[odd], float(reach[odd].max()))
            expected[odd] = (np.minimum(depth, reach[odd]) - planar[odd]) * fall[odd]
            walkable[odd] = self._map.walkable(solids)
        hits = origin + measured[:, None] * directions
        raised, sunk = below < expected - RAISED, walkable & (below > expected + SUNK)
        grid = expected.reshape(pattern.shape)
        if raised.any():
            raised &= below < scipy.ndimage.minimum_filter(grid, 3, mode="nearest").ravel() - RAISED
            raised[raised] = ~self._map.near_checkpoint(hits[raised], AROUND_CHECKPOINT)
        if sunk.any():
            sunk &= below > scipy.ndimage.maximum_filter(grid, 3, mode="nearest").ravel() + SUNK
        doubtful = np.flatnonzero(raised | sunk)
        if len(doubtful):
            least, most = self._from_elsewhere(origin, directions[doubtful], pattern, doubtful)
            raised[doubtful] &= below[doubtful] < least - RAISED
            sunk[doubtful] &= below[doubtful] > most + SUNK
        return Scan(
            (np.abs(below - expected) <= RAISED).reshape(pattern.shape),
            raised.reshape(pattern.shape),
            sunk.reshape(pattern.shape),
            hits.reshape(*pattern.shape, 3),
            (origin + (planar + expected / fall)[:, None] * directions).reshape(*pattern.shape, 3),
        )

    def ground_below(self, place: NDArray[np.float64]) -> float | None:
        """The height (m) of what the map has below a place, shape (3,); None within 2 m."""
        down = np.array([[0.0, 0.0, -1.0]])
        depth, _ = self._map.distances(place, down, 2.0)
        return float(place[2] - depth[0]) if np.isfinite(depth[0]) else None

    def _from_elsewhere(
        self,
        origin: NDArray[np.float64],
        directions: NDArray[np.float64],
        pattern: Pattern,
        rays: NDArray[np.int64],
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The least and the most that the map lets expect below the plane of the lane, if the
        robot is not where it believes to be."""
        origins = origin + np.repeat(ELSEWHERE, len(rays), axis=0)
        reach, planar, fall = pattern.reach[rays], pattern.planar[rays], pattern.fall[rays]
        many = np.tile(directions, (len(ELSEWHERE), 1))
        depth, _ = self._map.distances(origins, many, float(reach.max()))
        expected = (np.minimum(depth.reshape(len(ELSEWHERE), -1), reach) - planar) * fall
        return expected.min(axis=0), expected.max(axis=0)

    def _localised(self, pose: BodyPose) -> BodyPose:
        x, y, z, yaw, pitch = map(float, self._rng.standard_normal(5))
        return BodyPose(
            pose.x + POSITION_ERROR * x,
            pose.y + POSITION_ERROR * y,
            pose.z + HEIGHT_ERROR * z,
            pose.yaw + YAW_ERROR * yaw,
            pose.pitch + PITCH_ERROR * pitch,
        )

    def _measure(
        self,
        origin: NDArray[np.float64],
        directions: NDArray[np.float64],
        reach: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        """Depths as the scanner gives them, in m; inf beyond `reach`."""
        true = self._world.ranges(point(origin), origin + reach[:, None] * directions)
        fixed, share = DEPTH_NOISE
        noise = self._rng.standard_normal(len(true))
        return np.asarray(true + (fixed + share * np.minimum(true, reach)) * noise)
