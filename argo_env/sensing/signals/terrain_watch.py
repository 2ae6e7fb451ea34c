"""Watch for obstacles and holes in the lane ahead, with its scanner.

The scanner measures depths along rays to the lane and compares them with those of the map.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy
from numpy.typing import NDArray

from argo_compiler.base.message import Message
from argo_compiler.il import EventKind
from argo_env.navigation.closed_areas import LAYER, Blockage
from argo_env.navigation.path import wrap
from argo_env.robot.pose import BodyPose
from argo_env.sensing.signals.frames import rotation, to_rounded_vector, to_site
from argo_env.sensing.signals.site_map import SiteMap
from argo_env.sensing.watch import Detection
from argo_env.site.shapes import Vector
from argo_env.site.spec import Rect
from argo_env.world.world import World

FRONT: Vector = (0.4, 0.0, 0.8)
REAR: Vector = (-0.45, 0.0, 0.8)
"""m in the robot's frame: positions of the scanners that look ahead and back"""
HALF_LANE = 0.46
"""m to both sides that are scanned: half the robot's width, and the space that it needs to turn"""
FARTHEST = 2.5
"""m from the robot's middle along the lane, to the farthest row of rays"""
DEPTH_NOISE = (0.005, 0.003)
"""standard deviation of a depth: a constant part in m, and a part in m per metre of depth"""
POSITION_ERROR, HEIGHT_ERROR = 0.01, 0.003
"""m, standard deviations of the robot's localization on its map, along each axis and upwards"""
YAW_ERROR, PITCH_ERROR = math.radians(0.3), math.radians(0.1)
"""rad, standard deviations of the localization"""
_STEPS = 0.025 * np.arange(-3, 4)
_RISES = 0.015 * np.arange(-1, 2)
POSITION_OFFSETS = np.stack(np.meshgrid(_STEPS, _STEPS, _RISES), axis=-1).reshape(-1, 3)
"""m: possible errors of the robot's position; if the map explains a depth from any of these
positions, there is no detection. Heights vary too, for rays that pass just over edges of treads"""
PLANAR = 0.035  # m off the plane that the robot stands on, within which the lane is as expected
RAISED, SUNK = 0.05, 0.08
"""m above or below all depths that the map explains, from which something is wrong"""
DEEPEST = 0.6  # m below the lane at which rays end
AROUND_CHECKPOINT = 0.35  # m within which a hit may be a displaced checkpoint


@dataclass(frozen=True)
class Scan:
    """Result of a scan; arrays have the shape (rows, columns) of the rays, points one more axis."""

    good: NDArray[np.bool_]
    """rays that end where the map has a surface"""
    raised: NDArray[np.bool_]
    """rays that end above the surface"""
    sunk: NDArray[np.bool_]
    """rays that go on below a surface to walk on"""
    hits: NDArray[np.float64]
    """m, points at which the rays end"""
    surface: NDArray[np.float64]
    """m, points at which the rays should end according to the map"""


@dataclass(frozen=True)
class Pattern:
    """Rays from a scanner to the plane that the robot stands on, in the robot's frame."""

    origin: Vector
    directions: NDArray[np.float64]
    """unit vectors, shape (rays, 3)"""
    planar: NDArray[np.float64]
    """m along each ray to the plane"""
    fall: NDArray[np.float64]
    """m that a ray descends per metre"""
    reach: NDArray[np.float64]
    """m, length of each ray"""
    shape: tuple[int, int]
    """rows and columns"""


@lru_cache(maxsize=128)
def make_scan_pattern(
    backwards: bool,
    row_spacing: float,
    row_count: int,
    column_count: int,
    farthest: float = FARTHEST,
) -> Pattern:
    """Return rays to `row_count` rows of points across the lane, `row_spacing` (m) apart.

    The lane is ahead of the robot, or behind it if `backwards`. Each row has `column_count` rays;
    the last row is `farthest` (m) from the robot's middle. Every other row is shifted by half the
    gap between columns, so that the next row hits what lies between two columns.
    """
    rows = farthest - row_spacing * np.arange(row_count)[::-1]
    step = 2 * HALF_LANE / column_count
    lefts = (np.arange(column_count) + 0.25) * step - HALF_LANE
    along, left = np.meshgrid(rows, lefts, indexing="ij")
    left[1::2] += step / 2
    scanner, along = (REAR, -along) if backwards else (FRONT, along)
    rays = np.column_stack([along.ravel(), left.ravel(), np.zeros(along.size)]) - np.array(scanner)
    planar = np.linalg.norm(rays, axis=1)
    fall = scanner[2] / planar
    return Pattern(
        scanner,
        rays / planar[:, None],
        planar,
        fall,
        planar + DEEPEST / fall,
        (row_count, column_count),
    )


class TerrainScanner:
    """Scanner of the lane ahead or behind, which compares depths with the map."""

    def __init__(self, world: World, site_map: SiteMap, rng: np.random.Generator) -> None:
        self._world = world
        self._map = site_map
        self._rng = rng

    def scan(self, pose: BodyPose, pattern: Pattern) -> Scan:
        """Scan along the rays of a pattern from the robot's true pose, and compare with the map.

        The points of the result have the error of the robot's localization.
        """
        origin, directions = to_site(pose, pattern.origin), pattern.directions @ rotation(pose).T
        planar, fall, reach = pattern.planar, pattern.fall, pattern.reach
        measured = np.minimum(self._measure(origin, directions, reach), reach)
        # From here on, all points are where the robot believes them to be.
        believed = self._believed_pose(pose)
        turned = rotation(believed)
        origin, directions = to_site(believed, pattern.origin), pattern.directions @ turned.T
        # Depths become metres below the plane of the lane, so that rays near an edge can be
        # compared with their neighbours.
        below = (measured - planar) * fall
        expected, walkable = np.zeros(len(planar)), np.ones(len(planar), dtype=bool)
        odd = np.flatnonzero(np.abs(below) > PLANAR)
        if len(odd):
            depth, solids = self._map.cast_rays(origin, directions[odd], float(reach[odd].max()))
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
            least, most = self._expected_range(origin, directions[doubtful], pattern, doubtful)
            raised[doubtful] &= below[doubtful] < least - RAISED
            sunk[doubtful] &= below[doubtful] > most + SUNK
        return Scan(
            (np.abs(below - expected) <= RAISED).reshape(pattern.shape),
            raised.reshape(pattern.shape),
            sunk.reshape(pattern.shape),
            hits.reshape(*pattern.shape, 3),
            (origin + (planar + expected / fall)[:, None] * directions).reshape(*pattern.shape, 3),
        )

    def ground_below(self, position: NDArray[np.float64]) -> float | None:
        """Return the height (m) of the map's first solid below a point in m, shape (3,).

        Returns None if there is none within 2 m.
        """
        down = np.array([[0.0, 0.0, -1.0]])
        depth, _ = self._map.cast_rays(position, down, 2.0)
        return float(position[2] - depth[0]) if np.isfinite(depth[0]) else None

    def _expected_range(
        self,
        origin: NDArray[np.float64],
        directions: NDArray[np.float64],
        pattern: Pattern,
        rays: NDArray[np.int64],
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the least and greatest expected depth (m) of `rays` below the plane of the lane.

        There is one of each for each ray; they are over all positions at which the robot may be,
        given the error of its localization.
        """
        origins = origin + np.repeat(POSITION_OFFSETS, len(rays), axis=0)
        reach, planar, fall = pattern.reach[rays], pattern.planar[rays], pattern.fall[rays]
        all_directions = np.tile(directions, (len(POSITION_OFFSETS), 1))
        depth, _ = self._map.cast_rays(origins, all_directions, float(reach.max()))
        expected = (np.minimum(depth.reshape(len(POSITION_OFFSETS), -1), reach) - planar) * fall
        return expected.min(axis=0), expected.max(axis=0)

    def _believed_pose(self, pose: BodyPose) -> BodyPose:
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
        """Return the measured distance (m) along each ray; inf if nothing is within `reach`."""
        true = self._world.hit_distances_or_inf(
            to_rounded_vector(origin), origin + reach[:, None] * directions
        )
        fixed, share = DEPTH_NOISE
        noise = self._rng.standard_normal(len(true))
        return np.asarray(true + (fixed + share * np.minimum(true, reach)) * noise)


ROW, ROWS, COLUMNS = 0.12, 16, 7
"""m between the rows of rays, number of rows, and rays in a row"""
STAIRS = 0.1  # rad of pitch from which the robot is on stairs
STAIR_ROW, STAIR_ROWS, STAIR_COLUMNS = 0.2, 10, 5
"""the same on stairs: obstacles there are large, and almost every ray costs a ray on the map"""
TURNING_ROWS, TURNING_REACH = 9, 1.7
"""number of rows, and m from the middle to the last one, while the robot turns in place"""
CLOSE_ROW, CLOSE_ROWS, CLOSE_COLUMNS = 0.08, 25, 11
"""the same for the second scan, which checks every suspicion"""
RAISED_RAYS, SUNK_RAYS = 3, 6
"""adjacent rays in the second scan that a detection needs"""
SUNK_ROWS = 2  # rows that a hole spans at least: a single row may see through a seam of two plates
GONE_SCANS = 2  # scans, and rays in each of them, that show that an obstacle is gone
PADDING = 0.05  # m around the hits of the rays, which are 8 cm apart
SAME_OBSTACLE = 0.15  # m around a reported obstacle within which a hit belongs to it
LIFT = np.array([0.0, 0.0, 0.1])  # m over a hit, from where the ground below it is looked up
STILL = 0.03  # m or rad below which the robot has not moved
REPEAT, TURNING = 5.0, 2.0  # s between scans while it stands still, and while it turns in place
EIGHT_NEIGHBOURS = np.ones((3, 3), dtype=int)  # diagonals included


@dataclass(frozen=True, kw_only=True)
class ObstacleDetection(Detection):
    """Detection of an obstacle or a hole, with the part of the surface that it blocks."""

    blockage: Blockage


@dataclass
class _ReportedObstacle:
    kind: EventKind
    rect: Rect
    z: float
    gone: int = 0
    """number of scans that have shown the surface instead, since one that showed the obstacle"""


class TerrainWatch:
    """Watch for obstacles and holes in the lane that the robot drives along, ahead or behind.

    It holds the time and pose of its last scan, and the obstacles that it has reported. It reports
    each obstacle once, and again if more of it appears as the robot comes nearer.
    """

    name = "terrain"
    period = 1.0

    def __init__(self, scanner: TerrainScanner) -> None:
        self._scanner = scanner
        self._reported: list[_ReportedObstacle] = []
        self._last: tuple[float, BodyPose] | None = None
        self._backwards = False
        self._seen_far = False

    def update(self, now: float, pose: BodyPose) -> tuple[ObstacleDetection, ...]:
        pattern = self._pattern(now, pose)
        if pattern is None:
            return ()
        scan = self._scanner.scan(pose, pattern)
        self._update_reported(scan)
        if not any(self._new_rays(scan, kind).any() for kind in _KINDS):
            return ()
        close = make_scan_pattern(self._backwards, CLOSE_ROW, CLOSE_ROWS, CLOSE_COLUMNS)
        scan = self._scanner.scan(pose, close)
        return tuple(f for kind in _KINDS for f in self._detections(scan, kind))

    def _pattern(self, now: float, pose: BodyPose) -> Pattern | None:
        """Return rays to the part of the lane that came into view since the last scan.

        Returns None if no scan is due.
        """
        on_stairs = abs(pose.pitch) > STAIRS
        row, rows, columns = (
            (STAIR_ROW, STAIR_ROWS, STAIR_COLUMNS) if on_stairs else (ROW, ROWS, COLUMNS)
        )
        if self._last is None:
            self._last, self._seen_far = (now, pose), True
            return make_scan_pattern(self._backwards, row, rows, columns)
        then, before = self._last
        ahead = (pose.x - before.x) * math.cos(pose.yaw) + (pose.y - before.y) * math.sin(pose.yaw)
        turned = abs(wrap(pose.yaw - before.yaw)) + abs(pose.pitch - before.pitch)
        moving, turning = abs(ahead) >= STILL, turned >= STILL
        if not moving and now - then < (TURNING if turning else REPEAT):
            return None
        self._last = now, pose
        if turning and not moving:
            # Both ends of the robot swing round, so scan ahead and behind in turn.
            self._backwards, self._seen_far = not self._backwards, False
            return make_scan_pattern(self._backwards, ROW, TURNING_ROWS, COLUMNS, TURNING_REACH)
        backwards = ahead < 0 if moving else self._backwards
        if self._seen_far and backwards == self._backwards and moving and not turning:
            rows = min(rows, 1 + math.ceil(abs(ahead) / row))
        self._backwards, self._seen_far = backwards, True
        return make_scan_pattern(backwards, row, rows, columns)

    def _new_rays(self, scan: Scan, kind: EventKind) -> NDArray[np.bool_]:
        """Return which rays show something of that kind that was not reported."""
        evidence, positions = _rays_showing(scan, kind)
        for reported in self._reported:
            if reported.kind is kind:
                evidence = evidence & ~_are_inside(
                    positions, reported.rect, reported.z, SAME_OBSTACLE
                )
        return evidence

    def _detections(self, scan: Scan, kind: EventKind) -> list[ObstacleDetection]:
        _, positions = _rays_showing(scan, kind)
        new = self._new_rays(scan, kind)
        # Grow by one ray, since narrow obstacles are hit in every other row only.
        parts, count = scipy.ndimage.label(
            scipy.ndimage.binary_dilation(new, EIGHT_NEIGHBOURS), structure=EIGHT_NEIGHBOURS
        )
        detections = []
        for part in range(1, count + 1):
            rays = new & (parts == part)
            if rays.sum() < (RAISED_RAYS if kind is EventKind.POSITIVE_OBSTACLE else SUNK_RAYS):
                continue
            if kind is EventKind.NEGATIVE_OBSTACLE and rays.any(axis=1).sum() < SUNK_ROWS:
                continue
            low, high = positions[rays].min(axis=0) - PADDING, positions[rays].max(axis=0) + PADDING
            (x0, y0, _), (x1, y1, _) = to_rounded_vector(low), to_rounded_vector(high)
            z = float(np.median(scan.surface[rays][:, 2]))
            if kind is EventKind.POSITIVE_OBSTACLE:
                # The expected surface lies behind the obstacle, perhaps on another step.
                lowest = scan.hits[rays][scan.hits[rays][:, 2].argmin()]
                z = self._scanner.ground_below(lowest + LIFT) or z
            z, height = round(z, 3), float(scan.hits[rays][:, 2].max()) - z
            if kind is EventKind.POSITIVE_OBSTACLE and height < RAISED:
                continue  # an edge that differs a little from the map
            detections.append(_detection(kind, (x0, y0, x1, y1), z, height))
            self._reported.append(_ReportedObstacle(kind, (x0, y0, x1, y1), z))
        return detections

    def _update_reported(self, scan: Scan) -> None:
        """Drop obstacles that are gone: GONE_SCANS scans showed the surface, none the obstacle."""
        for reported in self._reported:
            evidence, positions = _rays_showing(scan, reported.kind)
            covering = _are_inside(scan.surface, reported.rect, reported.z, 0.0)
            if (evidence & _are_inside(positions, reported.rect, reported.z, SAME_OBSTACLE)).any():
                reported.gone = 0
            elif (covering & scan.good).sum() >= GONE_SCANS:
                reported.gone += 1
        self._reported = [reported for reported in self._reported if reported.gone < GONE_SCANS]


_KINDS = (EventKind.POSITIVE_OBSTACLE, EventKind.NEGATIVE_OBSTACLE)


def _rays_showing(scan: Scan, kind: EventKind) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """Return a mask of the rays that show something of that kind, and the points of all rays."""
    if kind is EventKind.POSITIVE_OBSTACLE:
        return scan.raised, scan.hits
    return scan.sunk, scan.surface


def _are_inside(
    positions: NDArray[np.float64], rect: Rect, z: float, margin: float
) -> NDArray[np.bool_]:
    x0, y0, x1, y1 = rect
    x, y = positions[..., 0], positions[..., 1]
    return np.asarray(
        (x >= x0 - margin)
        & (x <= x1 + margin)
        & (y >= y0 - margin)
        & (y <= y1 + margin)
        & (np.abs(positions[..., 2] - z) < LAYER)
    )


def _detection(kind: EventKind, rect: Rect, z: float, height: float) -> ObstacleDetection:
    x0, y0, x1, y1 = rect
    size = Message("{x1:.2f} m by {y1:.2f} m", x1=x1 - x0, y1=y1 - y0)
    if kind is EventKind.POSITIVE_OBSTACLE:
        detail = Message(
            "an obstacle, {size} in plan as far as it is seen, {height:.2f} m high",
            size=size,
            height=height,
        )
    else:
        detail = Message("a part of the way is missing, {size}", size=size)
    place = to_rounded_vector(np.array([(x0 + x1) / 2, (y0 + y1) / 2, z]))
    return ObstacleDetection(kind, detail, place, blockage=Blockage(rect, z, detail))
