"""The watch for what is in the way, or missing from it."""

import math
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from argo_compiler.il import EventKind
from argo_env.navigation.closed_areas import LAYER, Blockage
from argo_env.navigation.path import wrap
from argo_env.robot.pose import BodyPose
from argo_env.sensing.signals.frames import point
from argo_env.sensing.signals.terrain_scanner import (
    RAISED,
    Pattern,
    Scan,
    TerrainScanner,
    make_pattern,
)
from argo_env.sensing.watch import Detection
from argo_env.site.spec import Rect

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
