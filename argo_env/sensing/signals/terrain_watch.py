"""Watch for what is in the way or missing from it, with its scanner: depth along rays to the lane
ahead, beside the depth that the map lets expect."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy
from numpy.typing import NDArray

from argo_compiler.il import EventKind
from argo_env.navigation.closed_areas import LAYER, Blockage
from argo_env.navigation.path import wrap
from argo_env.robot.pose import BodyPose
from argo_env.sensing.signals.frames import on_site, point, rotation
from argo_env.sensing.signals.site_map import SiteMap
from argo_env.sensing.watch import Detection
from argo_env.site.shapes import Vector
from argo_env.site.spec import Rect
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


ROW, ROWS, COLUMNS = 0.12, 16, 7
"""m between the rows of rays, how many rows, and rays in a row"""
STAIRS = 0.1  # rad of pitch from which the robot is on stairs
STAIR_ROW, STAIR_ROWS, STAIR_COLUMNS = 0.2, 10, 5
"""there, what blocks the way is large, and almost every ray has to be looked up on the map"""
TURNING_ROWS, TURNING_REACH = 9, 1.7
"""rows, and m from the middle, while the robot turns in place"""
CLOSE_ROW, CLOSE_ROWS, CLOSE_COLUMNS = 0.08, 25, 11
"""the second look that every suspicion gets"""
RAISED_RAYS, SUNK_RAYS = 3, 6
"""rays side by side in the second look that make a detection"""
SUNK_ROWS = 2  # rows that a hole spans at least: a single one looks through the seam of two plates
GONE = 2  # rays that show where something was that it is gone, in each of as many looks
PADDING = 0.05  # m around what the rays have struck, as they are 8 cm apart
KNOWN = 0.15  # m around what was told within which it is the same
LIFT = np.array([0.0, 0.0, 0.1])  # m over a hit from where the ground below it is looked up
STILL = 0.03  # m or rad under which the robot has not moved
REPEAT, TURNING = 5.0, 2.0  # s between looks while it stands still, and while it turns in place
EIGHT = np.ones((3, 3), dtype=int)  # neighbours, diagonals included


@dataclass(frozen=True, kw_only=True)
class ObstacleDetection(Detection):
    """Something in the way or missing from it, with the part of the surface to keep off."""

    blockage: Blockage


@dataclass
class _Told:
    kind: EventKind
    rect: Rect
    z: float
    gone: int = 0
    """looks in a row that have shown nothing of it"""


class TerrainWatch:
    """Scans the lane that the robot drives along, ahead or behind, and tells of each obstacle once.

    Holds where it has looked last, and what has been told. What grows beyond what was told as the
    robot comes nearer is told again.
    """

    name = "terrain"
    period = 1.0

    def __init__(self, scanner: TerrainScanner) -> None:
        self._scanner = scanner
        self._told: list[_Told] = []
        self._last: tuple[float, BodyPose] | None = None
        self._backwards = False
        self._seen_far = False

    def look(self, now: float, pose: BodyPose) -> tuple[ObstacleDetection, ...]:
        pattern = self._pattern(now, pose)
        if pattern is None:
            return ()
        scan = self._scanner.scan(pose, pattern)
        self._forget(scan)
        if not any(self._new(scan, kind).any() for kind in _KINDS):
            return ()
        close = make_pattern(self._backwards, CLOSE_ROW, CLOSE_ROWS, CLOSE_COLUMNS)
        scan = self._scanner.scan(pose, close)
        return tuple(f for kind in _KINDS for f in self._detections(scan, kind))

    def _pattern(self, now: float, pose: BodyPose) -> Pattern | None:
        """Where to look: at what has come into view since the last look, if anything."""
        on_stairs = abs(pose.pitch) > STAIRS
        row, rows, columns = (
            (STAIR_ROW, STAIR_ROWS, STAIR_COLUMNS) if on_stairs else (ROW, ROWS, COLUMNS)
        )
        if self._last is None:
            self._last, self._seen_far = (now, pose), True
            return make_pattern(self._backwards, row, rows, columns)
        then, before = self._last
        ahead = (pose.x - before.x) * math.cos(pose.yaw) + (pose.y - before.y) * math.sin(pose.yaw)
        turned = abs(wrap(pose.yaw - before.yaw)) + abs(pose.pitch - before.pitch)
        moving, turning = abs(ahead) >= STILL, turned >= STILL
        if not moving and now - then < (TURNING if turning else REPEAT):
            return None
        self._last = now, pose
        if turning and not moving:
            # Both ends of the robot swing round.
            self._backwards, self._seen_far = not self._backwards, False
            return make_pattern(self._backwards, ROW, TURNING_ROWS, COLUMNS, TURNING_REACH)
        backwards = ahead < 0 if moving else self._backwards
        if self._seen_far and backwards == self._backwards and moving and not turning:
            rows = min(rows, 1 + math.ceil(abs(ahead) / row))
        self._backwards, self._seen_far = backwards, True
        return make_pattern(backwards, row, rows, columns)

    def _new(self, scan: Scan, kind: EventKind) -> NDArray[np.bool_]:
        """Which rays show something of that kind that has not been told."""
        found, places = _evidence(scan, kind)
        for told in self._told:
            if told.kind is kind:
                found = found & ~_inside(places, told.rect, told.z, KNOWN)
        return found

    def _detections(self, scan: Scan, kind: EventKind) -> list[ObstacleDetection]:
        _, places = _evidence(scan, kind)
        new = self._new(scan, kind)
        # Grown by one ray, as what is narrow is hit in every other row only.
        parts, count = scipy.ndimage.label(
            scipy.ndimage.binary_dilation(new, EIGHT), structure=EIGHT
        )
        detections = []
        for part in range(1, count + 1):
            rays = new & (parts == part)
            if rays.sum() < (RAISED_RAYS if kind is EventKind.POSITIVE_OBSTACLE else SUNK_RAYS):
                continue
            if kind is EventKind.NEGATIVE_OBSTACLE and rays.any(axis=1).sum() < SUNK_ROWS:
                continue
            low, high = places[rays].min(axis=0) - PADDING, places[rays].max(axis=0) + PADDING
            (x0, y0, _), (x1, y1, _) = point(low), point(high)
            z = float(np.median(scan.surface[rays][:, 2]))
            if kind is EventKind.POSITIVE_OBSTACLE:
                # What was expected lies behind it, perhaps on another step.
                lowest = scan.hits[rays][scan.hits[rays][:, 2].argmin()]
                z = self._scanner.ground_below(lowest + LIFT) or z
            z, height = round(z, 3), float(scan.hits[rays][:, 2].max()) - z
            if kind is EventKind.POSITIVE_OBSTACLE and height < RAISED:
                continue  # an edge that is not quite where it is believed to be
            detections.append(_detection(kind, (x0, y0, x1, y1), z, height))
            self._told.append(_Told(kind, (x0, y0, x1, y1), z))
        return detections

    def _forget(self, scan: Scan) -> None:
        """Drops what was told and is gone: seen twice without a sign of it."""
        for told in self._told:
            found, places = _evidence(scan, told.kind)
            over = _inside(scan.surface, told.rect, told.z, 0.0)
            if (found & _inside(places, told.rect, told.z, KNOWN)).any():
                told.gone = 0
            elif (over & scan.good).sum() >= GONE:
                told.gone += 1
        self._told = [told for told in self._told if told.gone < GONE]


_KINDS = (EventKind.POSITIVE_OBSTACLE, EventKind.NEGATIVE_OBSTACLE)


def _evidence(scan: Scan, kind: EventKind) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """Which rays show something of that kind, and the places that they show."""
    if kind is EventKind.POSITIVE_OBSTACLE:
        return scan.raised, scan.hits
    return scan.sunk, scan.surface


def _inside(places: NDArray[np.float64], rect: Rect, z: float, margin: float) -> NDArray[np.bool_]:
    x0, y0, x1, y1 = rect
    x, y = places[..., 0], places[..., 1]
    return np.asarray(
        (x >= x0 - margin)
        & (x <= x1 + margin)
        & (y >= y0 - margin)
        & (y <= y1 + margin)
        & (np.abs(places[..., 2] - z) < LAYER)
    )


def _detection(kind: EventKind, rect: Rect, z: float, height: float) -> ObstacleDetection:
    x0, y0, x1, y1 = rect
    size = f"{x1 - x0:.2f} m by {y1 - y0:.2f} m"
    if kind is EventKind.POSITIVE_OBSTACLE:
        detail = f"an obstacle, {size} in plan as far as it is seen, {height:.2f} m high"
    else:
        detail = f"a part of the way is missing, {size}"
    place = point(np.array([(x0 + x1) / 2, (y0 + y1) / 2, z]))
    return ObstacleDetection(kind, detail, place, blockage=Blockage(rect, z, detail))
