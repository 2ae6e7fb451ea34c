"""The thermal camera: a small image in °C of what lies ahead, or to one side."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from argo_env.robot.pose import BodyPose
from argo_env.sensing.signals.frames import on_site, point, rotation
from argo_env.site.shapes import Role, Vector
from argo_env.surroundings import HotSpot, Surroundings
from argo_env.surroundings.heat import temperatures
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
