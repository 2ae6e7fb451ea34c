"""Solids of a site: boxes and cylinders, grouped into named elements."""

from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Vector = tuple[float, float, float]


class Role(StrEnum):
    """Purpose of an element; the robot may stand on `WALKING_ROLES` and must touch no other."""

    GROUND = "ground"
    DECK = "deck"
    STAIR = "stair"
    RAILING = "railing"
    VESSEL = "vessel"
    PIPE = "pipe"
    PUMP = "pump"
    STRUCTURE = "structure"
    DOCK = "dock"


WALKING_ROLES = frozenset({Role.GROUND, Role.DECK, Role.STAIR})


@dataclass(frozen=True)
class Box:
    """Box with edge lengths `size` (m) about `center` (m), turned by `rpy` (rad, fixed axes)."""

    center: Vector
    size: Vector
    rpy: Vector = (0.0, 0.0, 0.0)

    def rotation(self) -> NDArray[np.float64]:
        """Return the box's axes x, y, z in the site's frame as columns of a (3, 3) matrix."""
        return _rotation(self.rpy)


@dataclass(frozen=True)
class Cylinder:
    """Cylinder of `radius` and `length` (m) about `center`, its axis z turned by `rpy` (rad)."""

    center: Vector
    radius: float
    length: float
    rpy: Vector = (0.0, 0.0, 0.0)

    def rotation(self) -> NDArray[np.float64]:
        """Return the cylinder's axes x, y, z in the site's frame as columns of a (3, 3) matrix."""
        return _rotation(self.rpy)


Solid = Box | Cylinder


@lru_cache(maxsize=1024)
def _rotation(rpy: Vector) -> NDArray[np.float64]:
    # Cached, as a site has thousands of solids with few different rotations. The import is here, as
    # that of scipy takes long and most users of a site do not need its solids.
    from scipy.spatial.transform import Rotation

    matrix = Rotation.from_euler("xyz", rpy).as_matrix()
    matrix.setflags(write=False)
    return np.asarray(matrix)


@dataclass(frozen=True)
class Element:
    """Named part of the site, such as one flight of stairs or one run of railing."""

    name: str
    role: Role
    solids: tuple[Solid, ...]
    material: str


def half_extents(solid: Solid) -> NDArray[np.float64]:
    """Return half the edges (m) of the solid's bounding box along the site's axes, shape (3,)."""
    if isinstance(solid, Box):
        return np.asarray(np.abs(solid.rotation()) @ (np.array(solid.size) / 2))
    axis = solid.rotation()[:, 2]
    # A disc of radius r across the axis a reaches r * sqrt(1 - a_i^2) along axis i.
    disc = solid.radius * np.sqrt(np.clip(1.0 - axis**2, 0.0, None))
    return np.asarray(np.abs(axis) * solid.length / 2 + disc)


def crossing(
    solid: Solid, origins: NDArray[np.float64], direction: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the t at which the lines origins + t * direction enter a solid, and leave it.

    A line extends in both directions, so t may be negative. `origins` has the shape (..., 3);
    `direction` is one vector or has the same shape. Both results have the shape (...); lines that
    miss the solid give (inf, -inf).
    """
    rotation = solid.rotation()
    start = (origins - np.array(solid.center)) @ rotation
    slope = np.broadcast_to(direction @ rotation, start.shape)
    if isinstance(solid, Box):
        low, high = np.full(start.shape[:-1], -np.inf), np.full(start.shape[:-1], np.inf)
        slabs = [(axis, size / 2) for axis, size in enumerate(solid.size)]
    else:
        low, high = _disc_crossing(start, slope, solid.radius)
        slabs = [(2, solid.length / 2)]
    for axis, half in slabs:
        entry, leave = _slab_crossing(start[..., axis], slope[..., axis], half)
        low, high = np.maximum(low, entry), np.minimum(high, leave)
    missed = low > high
    return np.where(missed, np.inf, low), np.where(missed, -np.inf, high)


def _slab_crossing(
    start: NDArray[np.float64], slope: NDArray[np.float64], half: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the lowest and the highest t for which start + t * slope is from -half to half.

    They are (inf, -inf) if there is none, and (-inf, inf) if all t are.
    """
    parallel = np.abs(slope) < 1e-12
    divisor = np.where(parallel, 1.0, slope)
    first, second = (-half - start) / divisor, (half - start) / divisor
    outside = np.abs(start) > half
    low = np.where(parallel, np.where(outside, np.inf, -np.inf), np.minimum(first, second))
    high = np.where(parallel, np.where(outside, -np.inf, np.inf), np.maximum(first, second))
    return low, high


def _disc_crossing(
    start: NDArray[np.float64], slope: NDArray[np.float64], radius: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the t where lines enter and leave an infinite cylinder about z.

    They are the roots of |p + t d|^2 = r^2 in the plane of x and y; (inf, -inf) for lines that miss
    the cylinder, (-inf, inf) for lines along z within it. `slope` (d) has the shape of `start` (p).
    """
    a = slope[..., 0] ** 2 + slope[..., 1] ** 2
    b = start[..., 0] * slope[..., 0] + start[..., 1] * slope[..., 1]
    c = start[..., 0] ** 2 + start[..., 1] ** 2 - radius**2
    parallel, discriminant = a < 1e-12, b**2 - a * c
    root = np.sqrt(np.clip(discriminant, 0.0, None))
    divisor = np.where(parallel, 1.0, a)
    hit = np.where(parallel, c <= 0, discriminant >= 0)
    low = np.where(parallel, -np.inf, (-b - root) / divisor)
    high = np.where(parallel, np.inf, (-b + root) / divisor)
    return np.where(hit, low, np.inf), np.where(hit, high, -np.inf)
