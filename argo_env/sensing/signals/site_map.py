"""The site as the robot knows it: the map that it compares its signals with."""

import numpy as np
from numpy.typing import NDArray

from argo_env.site import Site
from argo_env.site.shapes import WALKING_ROLES, Element, Role, Vector

EQUIPMENT = frozenset({Role.VESSEL, Role.PIPE, Role.PUMP})


class SiteMap:
    """The solids of a site, for many rays from one point at once, and what they are there for."""

    def __init__(self, site: Site) -> None:
        self.site = site
        self._rays = site.rays
        self._checkpoints = np.array([c.position for c in site.checkpoints]).reshape(-1, 3)
        self._walkable = np.array([e.role in WALKING_ROLES for e in self._rays.elements])
        self._equipment = np.array([e.role in EQUIPMENT for e in self._rays.elements])

    def distances(
        self, origin: NDArray[np.float64], directions: NDArray[np.float64], reach: float
    ) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """The distance (m) to the first solid from `origin`, shape (3,) or (n, 3), in each of
        `directions`, unit vectors of the shape (n, 3), and which solid it is; inf and -1 where
        there is none within `reach`."""
        return self._rays.first(origin, directions, reach)

    def element(self, solid: int) -> Element:
        """The element that a solid belongs to."""
        return self._rays.elements[solid]

    def walkable(self, solids: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Which of the solids are there to walk on; -1 is none."""
        return np.asarray(self._walkable[solids] & (solids >= 0))

    def near_checkpoint(self, points: NDArray[np.float64], radius: float) -> NDArray[np.bool_]:
        """Which of `points`, shape (n, 3), lie within `radius` (m) of where a checkpoint is."""
        if not len(self._checkpoints) or not len(points):
            return np.zeros(len(points), dtype=bool)
        apart = points[:, None, :] - self._checkpoints
        return np.asarray((np.einsum("nck,nck->nc", apart, apart) <= radius**2).any(axis=1))

    def nearest_equipment(self, point: Vector) -> str:
        """The name of the vessel, pipe or pump that is nearest to `point` (m)."""
        if not self._equipment.any():
            return f"floor {self.site.floor_at(point[2])}"
        at = np.array(point)
        outside = np.maximum(np.maximum(self._rays.low - at, at - self._rays.high), 0.0)
        distance = np.where(self._equipment, np.linalg.norm(outside, axis=1), np.inf)
        return self._rays.elements[int(distance.argmin())].name
