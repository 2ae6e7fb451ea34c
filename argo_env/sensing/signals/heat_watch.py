"""Watch for hot spots in the small images (°C) of a thermal camera.

The camera looks ahead to the left and to the right in turn. A hot spot is warmer than surfaces such
as those that the site map has at its position can be without a fault.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from argo_compiler.base.message import Message
from argo_compiler.il import EventKind
from argo_env.robot.pose import BodyPose
from argo_env.sensing.signals.frames import rotation, to_rounded_vector, to_site
from argo_env.sensing.signals.site_map import SiteMap
from argo_env.sensing.watch import Detection
from argo_env.site.shapes import Role, Vector
from argo_env.surroundings import HotSpot, Surroundings
from argo_env.surroundings.heat import highest_temperature_without_fault, surface_temperatures
from argo_env.world.world import World

WIDTH, HEIGHT = 80, 60
"""pixels"""
FIELD_OF_VIEW = math.radians(90.0)
"""rad, horizontal; the focal length in pixels follows from it"""
FOCAL = WIDTH / 2 / math.tan(FIELD_OF_VIEW / 2)
PLACE: Vector = (0.3, 0.0, 0.7)
"""m in the robot's frame: position of the camera"""
FAR = 10.0  # m up to which surfaces are seen; beyond there is sky
COARSE = 10  # pixels, edge of the cells of the background, each of which is found by one ray
NOISE = 0.1  # K, standard deviation of a pixel
OFFSET = 1.0  # K, standard deviation of the whole camera's error, fixed for a run
EMISSIVITY = 1.0  # K, standard deviation of patches of paint, rust and dirt


@dataclass(frozen=True)
class ThermalImage:
    """Image of a thermal camera, with the camera's pose on the site."""

    pixels: NDArray[np.float64]
    """°C, shape (HEIGHT, WIDTH)"""
    origin: NDArray[np.float64]
    """m, position of the camera in the site's frame"""
    axes: NDArray[np.float64]
    """columns are the camera's axes ahead, left and up in the site's frame, shape (3, 3)"""

    def rays(self, rows: NDArray[np.int64], columns: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return unit vectors in the site's frame through the middles of pixels, shape (n, 3)."""
        return directions_through_pixels(rows + 0.5, columns + 0.5) @ self.axes.T

    def row_column_depth(self, place: Vector) -> tuple[float, float, float]:
        """Return row and column (px) of a point of the site (m), and its depth (m).

        The middle of the first pixel is at row and column 0.5. The depth is along the camera's
        axis, and negative for points behind the camera.
        """
        ahead, left, up = ((np.array(place) - self.origin) @ self.axes).tolist()
        scale = FOCAL / max(ahead, 1e-6)
        return HEIGHT / 2 - up * scale, WIDTH / 2 - left * scale, ahead


def directions_through_pixels(
    rows: NDArray[np.floating[Any]], columns: NDArray[np.floating[Any]]
) -> NDArray[np.float64]:
    """Return unit vectors from the camera through points of its image, shape (n, 3).

    `rows` and `columns` are in px, 0.5 for the middle of the first pixel; the vectors are along the
    camera's axes (ahead, left, up).
    """
    rays = np.column_stack(
        [np.full(len(rows), FOCAL), WIDTH / 2 - columns, HEIGHT / 2 - np.asarray(rows)]
    )
    return np.asarray(rays / np.linalg.norm(rays, axis=1, keepdims=True))


_ROWS, _COLUMNS = (
    g.ravel().astype(np.float64) + COARSE / 2
    for g in np.meshgrid(np.arange(0, HEIGHT, COARSE), np.arange(0, WIDTH, COARSE), indexing="ij")
)
_COARSE_RAYS = directions_through_pixels(_ROWS, _COLUMNS)


class ThermalCamera:
    """Thermal camera. It holds its constant error of temperature, which is drawn once."""

    def __init__(self, surroundings: Surroundings, world: World, rng: np.random.Generator) -> None:
        self._surroundings = surroundings
        self._world = world
        self._rng = rng
        self._offset = OFFSET * float(rng.standard_normal())
        self._roles = {e.material: e.role for e in world.site.elements}

    def take_image(self, pose: BodyPose, pan: float) -> ThermalImage:
        """Take an image from a robot at `pose`, with the camera turned left by `pan` (rad)."""
        c, s = math.cos(pan), math.sin(pan)
        axes = rotation(pose) @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        image = ThermalImage(np.empty((HEIGHT, WIDTH)), to_site(pose, PLACE), axes)
        materials, normals = self._world.hit_materials_and_normals(
            to_rounded_vector(image.origin), image.origin + FAR * _COARSE_RAYS @ axes.T
        )
        roles = [None if m is None else self._roles.get(m, Role.STRUCTURE) for m in materials]
        background = surface_temperatures(roles, normals, self._surroundings.weather)
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
        """Blend the spot into the pixels that it covers, by the share of each pixel."""
        row, column, depth = image.row_column_depth(spot.place)
        if depth < 0.1:
            return
        radius = FOCAL * spot.radius / depth
        rows, columns = np.arange(HEIGHT) + 0.5, np.arange(WIDTH) + 0.5
        aside = np.hypot(rows[:, None] - row, columns[None, :] - column)
        # A spot smaller than a pixel covers only a share of it.
        share = np.clip(radius - aside + 0.5, 0.0, min(1.0, math.pi * radius**2))
        if not share.any() or not self._is_visible(image.origin, spot):
            return
        image.pixels[:] += share * (spot.temperature - image.pixels)

    def _is_visible(self, origin: NDArray[np.float64], spot: HotSpot) -> bool:
        distance = float(np.linalg.norm(np.array(spot.place) - origin))
        range_to_solid = self._world.hit_distances_or_inf(
            to_rounded_vector(origin), np.array([spot.place])
        )[0]
        return bool(range_to_solid >= distance - spot.radius - 0.05)


PANS = (math.radians(40.0), math.radians(-40.0))
"""rad, directions in which the camera looks in turn"""
MARGIN = 8.0
"""K over the highest temperature of a normal surface from which a spot is hot; the errors of camera
and dirt have a standard deviation of 1.4 K"""
SUSPICIOUS = 33.0
"""K over the air from which a pixel is examined: no normal surface but a pump's gets as warm"""
PIXELS = 3  # of a spot, at least
PROBES = 7  # pixels of a spot that are looked up on the map, at most
REACH = 10.0  # m, of the rays on the map
SAME_SPOT = 1.5  # m between two estimates of the same spot's position, at most
SURE_RANGE = 6.0  # m within which a reported spot must appear if it is in view and still hot
GONE_IMAGES = 3  # images in which a reported spot is missing from the view, until it is gone


@dataclass(frozen=True)
class Spot:
    """A hot spot in an image."""

    place: Vector
    """m, position according to the map"""
    element: str
    """name of the site's element at this position"""
    temperature: float
    """°C"""


@dataclass
class _ReportedSpot:
    place: Vector
    missed: int = 0
    """number of images that should have shown the spot since it was seen last"""


class HeatWatch:
    """Watch for hot spots. It holds the spots that it has reported, and unconfirmed ones.

    It looks ahead to the left and to the right in turn. After an image with a spot not yet
    reported, it takes the next one in the same direction, and reports the spot if that one shows it
    too. It reports each spot once, and again only after it has been gone.
    """

    name = "heat"
    period = 3.0

    def __init__(self, camera: ThermalCamera, site_map: SiteMap, air: float) -> None:
        """`air`: the temperature (°C) that the robot's own thermometer shows."""
        self._camera = camera
        self._map = site_map
        self._air = air
        self._turn = 0
        self._candidates: tuple[Spot, ...] = ()
        self._reported: list[_ReportedSpot] = []

    def update(self, now: float, pose: BodyPose) -> tuple[Detection, ...]:  # noqa: ARG002
        image = self._camera.take_image(pose, PANS[self._turn])
        spots = find_spots(image, self._map, self._air)
        self._update_reported(image, spots)
        new = tuple(s for s in spots if not any(_is_same(s.place, t.place) for t in self._reported))
        confirmed = [s for s in new if any(_is_same(s.place, c.place) for c in self._candidates)]
        self._candidates = tuple(s for s in new if s not in confirmed)
        if not self._candidates:
            self._turn = (self._turn + 1) % len(PANS)
        detections = []
        for spot in confirmed:
            self._reported.append(_ReportedSpot(spot.place))
            detail = Message(
                "a hot spot of {temperature:.0f} °C on {element}",
                temperature=spot.temperature,
                element=spot.element,
            )
            detections.append(Detection(EventKind.HOT_SPOT, detail, spot.place))
        return tuple(detections)

    def _update_reported(self, image: ThermalImage, spots: tuple[Spot, ...]) -> None:
        for reported in self._reported:
            if any(_is_same(s.place, reported.place) for s in spots):
                reported.missed = 0
            elif self._is_in_view(image, reported.place):
                reported.missed += 1
        self._reported = [reported for reported in self._reported if reported.missed < GONE_IMAGES]

    def _is_in_view(self, image: ThermalImage, place: Vector) -> bool:
        row, column, depth = image.row_column_depth(place)
        if not (5 <= row <= HEIGHT - 5 and 5 <= column <= WIDTH - 5 and 0.5 < depth < SURE_RANGE):
            return False
        sight = np.array(place) - image.origin
        distance = float(np.linalg.norm(sight))
        range_to_solid, _ = self._map.cast_rays(image.origin, sight[None, :] / distance, REACH)
        return bool(range_to_solid[0] >= distance - 0.3)


def find_spots(image: ThermalImage, site_map: SiteMap, air: float) -> tuple[Spot, ...]:
    """Return the hot spots in an image: warmer than its surfaces can be without a fault.

    A spot has at least PIXELS warm pixels; the median of up to PROBES of the warmest is more than
    MARGIN (K) above the highest temperature that the surfaces at its position can have.

    Args:
        image: image of the thermal camera.
        site_map: map of the site, which states what surfaces the camera sees.
        air: temperature of the air in °C.
    """
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
        # Pixels at the rim mix hot and cold and say little, so the warmest pixels go first.
        probed = np.argsort(-warmth, kind="stable")[: 4 * PROBES : 4]
        # The background is coarse: the surface in the middle of a cell stands for all of the cell.
        cells = np.unique(rows // COARSE * WIDTH + columns // COARSE)
        middles = (np.column_stack(np.divmod(cells, WIDTH)) + 0.5) * COARSE
        beside = directions_through_pixels(middles[:, 0], middles[:, 1]) @ image.axes.T
        rays = np.concatenate([image.rays(rows[probed], columns[probed]), beside])
        depths, solids = site_map.cast_rays(image.origin, rays, REACH)
        solids_hit = [int(k) for k in solids if k >= 0]
        depths, solids = depths[: len(probed)], solids[: len(probed)]
        if not np.isfinite(depths).any():
            continue
        allowed = max(
            highest_temperature_without_fault(site_map.element_of(k).role, air) for k in solids_hit
        )
        if float(np.median(warmth[probed])) <= allowed + MARGIN:
            continue
        nearest = int(np.argmin(depths))
        ray = image.rays(rows[probed[[nearest]]], columns[probed[[nearest]]])[0]
        spots.append(
            Spot(
                to_rounded_vector(image.origin + depths[nearest] * ray),
                site_map.element_of(int(solids[nearest])).name,
                float(warmth.max()),
            )
        )
    return tuple(spots)


def _is_same(a: Vector, b: Vector) -> bool:
    return math.dist(a, b) <= SAME_SPOT
