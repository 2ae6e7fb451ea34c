"""Map of the site as it was built, which the robot compares its signals with."""

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.message import Message
from argo_env.site import Site
from argo_env.site.shapes import WALKING_ROLES, Element, Role, Vector

EQUIPMENT = frozenset({Role.VESSEL, Role.PIPE, Role.PUMP})


class SiteMap:
    """Solids of a site with their roles, for intersecting many rays at once."""

    def __init__(self, site: Site) -> None:
        self.site = site
        self._rays = site.rays
        self._checkpoints = np.array([c.position for c in site.checkpoints]).reshape(-1, 3)
        self._walkable = np.array([e.role in WALKING_ROLES for e in self._rays.elements])
        self._equipment = np.array([e.role in EQUIPMENT for e in self._rays.elements])

    def cast_rays(
        self, origin: NDArray[np.float64], directions: NDArray[np.float64], reach: float
    ) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Return the distance (m) to the first solid on each ray, and the index of that solid.

        Where there is no solid within `reach`, the distance is inf and the index -1.

        Args:
            origin: start of the rays in m, shape (3,), or one for each ray, shape (n, 3).
            directions: unit vectors, shape (n, 3).
            reach: length of the rays in m.
        """
        return self._rays.first_hits(origin, directions, reach)

    def element_of(self, solid: int) -> Element:
        """Return the element that the solid with this index, from `cast_rays`, belongs to."""
        return self._rays.elements[solid]

    def walkable(self, solids: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Return a mask of the solids (indices from `cast_rays`) to walk on; False for index -1."""
        return np.asarray(self._walkable[solids] & (solids >= 0))

    def near_checkpoint(self, points: NDArray[np.float64], radius: float) -> NDArray[np.bool_]:
        """Return a mask of the points (m), shape (n, 3), within `radius` (m) of any checkpoint."""
        if not len(self._checkpoints) or not len(points):
            return np.zeros(len(points), dtype=bool)
        apart = points[:, None, :] - self._checkpoints
        return np.asarray((np.einsum("nck,nck->nc", apart, apart) <= radius**2).any(axis=1))

    def nearest_equipment(self, point: Vector) -> str:
        """Return the name of the vessel, pipe or pump nearest to `point` (m).

        On a site without equipment, the result is the floor at this height, such as `floor 1`.
        """
        if not self._equipment.any():
            return Message("floor {floor_at}", floor_at=self.site.floor_at(point[2]))
        at = np.array(point)
        outside = np.maximum(np.maximum(self._rays.low - at, at - self._rays.high), 0.0)
        distance = np.where(self._equipment, np.linalg.norm(outside, axis=1), np.inf)
        return self._rays.elements[int(distance.argmin())].name
