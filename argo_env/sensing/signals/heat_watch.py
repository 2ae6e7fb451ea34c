"""Hot spots: a thermal camera, whose small image in °C shows what lies ahead or to one side, and
the watch that finds in it what is warmer than it may be."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from argo_compiler.il import EventKind
from argo_env.robot.pose import BodyPose
from argo_env.sensing.signals.frames import on_site, point, rotation
from argo_env.sensing.signals.site_map import SiteMap
from argo_env.sensing.watch import Detection
from argo_env.site.shapes import Role, Vector
from argo_env.surroundings import HotSpot, Surroundings
from argo_env.surroundings.heat import temperatures, warmest
from argo_env.world.world import World

WIDTH, HEIGHT = 80, 60
"""pixels"""
FIELD_OF_VIEW = math.radians(90.0)
"""across; the focal length in pixels follows from it"""
FOCAL = WIDTH / 2 / math.tan(FIELD_OF_VIEW / 2)
PLACE: Vector = (0.3, 0.0, 0.7)
"""m in the robot's frame"""
FAR = 10.0  # m up to where a surface is told from the sky
COARSE = 10  # pixels to a ray that finds what is in the background
NOISE = 0.1  # K, standard deviation of a pixel
OFFSET = 1.0  # K, standard deviation of the whole camera's error, fixed for a run
EMISSIVITY = 1.0  # K, standard deviation of patches of paint, rust and dirt


@dataclass(frozen=True)
class ThermalImage:
    """Temperatures (°C), shape (HEIGHT, WIDTH), taken at `origin` (m) along `axes`: the columns of
    this (3, 3) array are ahead, left and up on the site."""

    pixels: NDArray[np.float64]
    origin: NDArray[np.float64]
    axes: NDArray[np.float64]

    def rays(self, rows: NDArray[np.int64], columns: NDArray[np.int64]) -> NDArray[np.float64]:
        """Unit vectors on the site through the middles of pixels, shape (n, 3)."""
        return pixel_rays(rows + 0.5, columns + 0.5) @ self.axes.T

    def project(self, place: Vector) -> tuple[float, float, float]:
        """Row, column (pixels) and depth (m) of a place; behind the camera it is negative."""
        ahead, left, up = ((np.array(place) - self.origin) @ self.axes).tolist()
        scale = FOCAL / max(ahead, 1e-6)
        return HEIGHT / 2 - up * scale, WIDTH / 2 - left * scale, ahead


def pixel_rays(
    rows: NDArray[np.floating[Any]], columns: NDArray[np.floating[Any]]
) -> NDArray[np.float64]:
    """Unit vectors (ahead, left, up) through places of the image in pixels, shape (n, 3)."""
    rays = np.column_stack(
        [np.full(len(rows), FOCAL), WIDTH / 2 - columns, HEIGHT / 2 - np.asarray(rows)]
    )
    return np.asarray(rays / np.linalg.norm(rays, axis=1, keepdims=True))


_ROWS, _COLUMNS = (
    g.ravel().astype(np.float64) + COARSE / 2
    for g in np.meshgrid(np.arange(0, HEIGHT, COARSE), np.arange(0, WIDTH, COARSE), indexing="ij")
)
_COARSE_RAYS = pixel_rays(_ROWS, _COLUMNS)


class ThermalCamera:
    """Takes images. Holds its own offset, which is drawn once."""

    def __init__(self, surroundings: Surroundings, world: World, rng: np.random.Generator) -> None:
        self._surroundings = surroundings
        self._world = world
        self._rng = rng
        self._offset = OFFSET * float(rng.standard_normal())
        self._roles = {e.material: e.role for e in world.site.elements}

    def take(self, pose: BodyPose, pan: float) -> ThermalImage:
        """An image with the camera turned by `pan` (rad, to the left)."""
        c, s = math.cos(pan), math.sin(pan)
        axes = rotation(pose) @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        image = ThermalImage(np.empty((HEIGHT, WIDTH)), on_site(pose, PLACE), axes)
        materials, normals = self._world.surfaces(
            point(image.origin), image.origin + FAR * _COARSE_RAYS @ axes.T
        )
        roles = [None if m is None else self._roles.get(m, Role.STRUCTURE) for m in materials]
        background = temperatures(roles, normals, self._surroundings.weather)
        background += EMISSIVITY * self._rng.standard_normal(len(background))
        coarse = background.reshape(HEIGHT // COARSE, WIDTH // COARSE)
        image.pixels[:] = np.repeat(np.repeat(coarse, COARSE, axis=0), COARSE, axis=1)
        for source in self._surroundings.sources:
            if isinstance(source, HotSpot):
                self._draw(image, source)
        noise = self._rng.standard_normal(image.pixels.shape, dtype=np.float32)
        image.pixels[:] += self._offset + NOISE * noise
        return image

    def _draw(self, image: ThermalImage, spot: HotSpot) -> None:
        """Mixes the spot into the pixels that it covers, by the share that it covers."""
        row, column, depth = image.project(spot.place)
        if depth < 0.1:
            return
        radius = FOCAL * spot.radius / depth
        rows, columns = np.arange(HEIGHT) + 0.5, np.arange(WIDTH) + 0.5
        aside = np.hypot(rows[:, None] - row, columns[None, :] - column)
        # A spot smaller than a pixel fills only its share of that.
        share = np.clip(radius - aside + 0.5, 0.0, min(1.0, math.pi * radius**2))
        if not share.any() or not self._visible(image.origin, spot):
            return
        image.pixels[:] += share * (spot.temperature - image.pixels)

    def _visible(self, origin: NDArray[np.float64], spot: HotSpot) -> bool:
        distance = float(np.linalg.norm(np.array(spot.place) - origin))
        free = self._world.ranges(point(origin), np.array([spot.place]))[0]
        return bool(free >= distance - spot.radius - 0.05)


PANS = (math.radians(40.0), math.radians(-40.0))
"""rad, the ways in which the camera looks by turns"""
MARGIN = 8.0
"""K over what a sound surface can have; camera and dirt have a standard deviation of 1.4 K"""
SUSPICIOUS = 33.0
"""K over the air from which a pixel is looked at: no surface but a pump's gets so warm"""
PIXELS = 3  # of a spot, at least
PROBES = 7  # pixels of a spot that are looked up on the map, at most
REACH = 10.0  # m
LOOKS = 2  # in a row, in which a spot must show
SAME = 1.5  # m between two places of the same spot
SURE = 6.0  # m within which a told spot that is in view must show, or is gone
GONE = 3  # looks that have to miss it


@dataclass(frozen=True)
class Spot:
    """A spot in an image: its place (m) by the map, what is there, and its temperature (°C)."""

    place: Vector
    element: str
    temperature: float


@dataclass
class _Told:
    place: Vector
    missed: int = 0


class HeatWatch:
    """Looks ahead to the left and to the right by turns, and stays on what looks like a hot spot
    until a second image has confirmed it. Tells of each spot once; holds what it has told."""

    name = "heat"
    period = 3.0

    def __init__(self, camera: ThermalCamera, site_map: SiteMap, air: float) -> None:
        """`air` is the temperature (°C) that the robot's own thermometer shows."""
        self._camera = camera
        self._map = site_map
        self._air = air
        self._turn = 0
        self._candidates: tuple[Spot, ...] = ()
        self._told: list[_Told] = []

    def look(self, now: float, pose: BodyPose) -> tuple[Detection, ...]:  # noqa: ARG002
        image = self._camera.take(pose, PANS[self._turn])
        spots = find_spots(image, self._map, self._air)
        self._forget(image, spots)
        new = tuple(s for s in spots if not any(_same(s.place, t.place) for t in self._told))
        confirmed = [s for s in new if any(_same(s.place, c.place) for c in self._candidates)]
        self._candidates = tuple(s for s in new if s not in confirmed)
        if not self._candidates:
            self._turn = (self._turn + 1) % len(PANS)
        detections = []
        for spot in confirmed:
            self._told.append(_Told(spot.place))
            detail = f"a hot spot of {spot.temperature:.0f} °C on {spot.element}"
            detections.append(Detection(EventKind.HOT_SPOT, detail, spot.place))
        return tuple(detections)

    def _forget(self, image: ThermalImage, spots: tuple[Spot, ...]) -> None:
        for told in self._told:
            if any(_same(s.place, told.place) for s in spots):
                told.missed = 0
            elif self._in_view(image, told.place):
                told.missed += 1
        self._told = [told for told in self._told if told.missed < GONE]

    def _in_view(self, image: ThermalImage, place: Vector) -> bool:
        row, column, depth = image.project(place)
        if not (5 <= row <= HEIGHT - 5 and 5 <= column <= WIDTH - 5 and 0.5 < depth < SURE):
            return False
        way = np.array(place) - image.origin
        distance = float(np.linalg.norm(way))
        free, _ = self._map.distances(image.origin, way[None, :] / distance, REACH)
        return bool(free[0] >= distance - 0.3)


def find_spots(image: ThermalImage, site_map: SiteMap, air: float) -> tuple[Spot, ...]:
    """The spots that are warmer than what the map shows there can be; the air has `air` °C."""
    warm = image.pixels > air + SUSPICIOUS
    if not warm.any():
        return ()
    parts, count = scipy.ndimage.label(warm)
    spots = []
    for part in range(1, count + 1):
        rows, columns = np.nonzero(parts == part)
        if len(rows) < PIXELS:
            continue
        warmth = image.pixels[rows, columns]
        # What is mixed from hot and cold at the rim says little, so the warmest go first.
        probed = np.argsort(-warmth, kind="stable")[: 4 * PROBES : 4]
        # The image is coarse: what is in the middle of a cell stands for all of it.
        cells = np.unique(rows // COARSE * WIDTH + columns // COARSE)
        middles = (np.column_stack(np.divmod(cells, WIDTH)) + 0.5) * COARSE
        beside = pixel_rays(middles[:, 0], middles[:, 1]) @ image.axes.T
        rays = np.concatenate([image.rays(rows[probed], columns[probed]), beside])
        depths, solids = site_map.distances(image.origin, rays, REACH)
        there = [int(k) for k in solids if k >= 0]
        depths, solids = depths[: len(probed)], solids[: len(probed)]
        if not np.isfinite(depths).any():
            continue
        allowed = max(warmest(site_map.element(k).role, air) for k in there)
        if float(np.median(warmth[probed])) <= allowed + MARGIN:
            continue
        nearest = int(np.argmin(depths))
        ray = image.rays(rows[probed[[nearest]]], columns[probed[[nearest]]])[0]
        spots.append(
            Spot(
                point(image.origin + depths[nearest] * ray),
                site_map.element(int(solids[nearest])).name,
                float(warmth.max()),
            )
        )
    return tuple(spots)


def _same(a: Vector, b: Vector) -> bool:
    return math.dist(a, b) <= SAME
