"""The site as the robot knows it: the map that it compares its signals with."""

import numpy as np
from numpy.typing import NDArray

from argo_env.site import Site
from argo_env.site.shapes import WALKING_ROLES, Box, Element, Role, Vector, half_extents

EQUIPMENT = frozenset({Role.VESSEL, Role.PIPE, Role.PUMP})


class SiteMap:
    """The solids of a site in arrays, for many rays from one point at once."""

    def __init__(self, site: Site) -> None:
        self.site = site
        parts = [(e, s) for e in site.elements for s in e.solids]
        self._elements = [e for e, _ in parts]
        self._centers = np.array([s.center for _, s in parts])
        self._rotations = np.array([s.rotation() for _, s in parts])
        half = np.array([half_extents(s) for _, s in parts])
        self._low, self._high = self._centers - half, self._centers + half
        self._round = np.array([not isinstance(s, Box) for _, s in parts])
        self._halves = np.array(
            [
                np.array(s.size) / 2 if isinstance(s, Box) else (s.radius, s.radius, s.length / 2)
                for _, s in parts
            ]
        )
        self._checkpoints = np.array([c.position for c in site.checkpoints]).reshape(-1, 3)
        self._walkable = np.array([e.role in WALKING_ROLES for e in self._elements])
        self._equipment = np.array([e.role in EQUIPMENT for e in self._elements])

    def distances(
        self, origin: NDArray[np.float64], directions: NDArray[np.float64], reach: float
    ) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """The distance (m) to the first solid from `origin`, shape (3,) or (n, 3), in each of
        `directions`, unit vectors of the shape (n, 3), and which solid it is; inf and -1 where
        there is none within `reach`."""
        places = np.concatenate([np.atleast_2d(origin), origin + reach * directions])
        low, high = places.min(axis=0), places.max(axis=0)
        near = np.flatnonzero(((self._low <= high) & (self._high >= low)).all(axis=1))
        if origin.ndim == 1:
            near = near[self._between(near, origin, directions)]
        if not len(near):
            return np.full(len(directions), np.inf), np.full(len(directions), -1)
        # Frames of the solids; arrays are (ray, solid, axis).
        rotations, halves, round_ = self._rotations[near], self._halves[near], self._round[near]
        offset = np.atleast_2d(origin)[:, None, :] - self._centers[near]
        start = np.einsum("rmk,mkj->rmj", offset, rotations)
        slope = np.einsum("rk,mkj->rmj", directions, rotations)
        slope = np.where(np.abs(slope) < 1e-9, 1e-9, slope)
        first, second = (-halves - start) / slope, (halves - start) / slope
        entries, leaves = np.minimum(first, second), np.maximum(first, second)
        if round_.any():
            # The round side of a cylinder stands for the slabs across its axis.
            s, d, radius = start[:, round_], slope[:, round_], halves[round_, 0]
            a = d[..., 0] ** 2 + d[..., 1] ** 2
            b = d[..., 0] * s[..., 0] + d[..., 1] * s[..., 1]
            discriminant = b**2 - a * (s[..., 0] ** 2 + s[..., 1] ** 2 - radius**2)
            root = np.sqrt(np.maximum(discriminant, 0.0))
            hit = discriminant >= 0
            for axis in (0, 1):
                entries[:, round_, axis] = np.where(hit, (-b - root) / a, np.inf)
                leaves[:, round_, axis] = np.where(hit, (-b + root) / a, -np.inf)
        entry, leave = entries.max(axis=2), leaves.min(axis=2)
        distance = np.where((entry <= leave) & (entry >= 0.0), entry, np.inf)
        best = distance.argmin(axis=1)
        result = distance[np.arange(len(directions)), best]
        result = np.where(result <= reach, result, np.inf)
        return result, np.where(np.isfinite(result), near[best], -1)

    def _between(
        self, solids: NDArray[np.int64], origin: NDArray[np.float64], rays: NDArray[np.float64]
    ) -> NDArray[np.bool_]:
        """Which solids reach between the two upright planes through `origin` that hold all rays."""
        ahead = np.arctan2(*rays[:, 1::-1].sum(axis=0))
        aside = np.arctan2(rays[:, 1], rays[:, 0]) - ahead
        aside = (aside + np.pi) % (2 * np.pi) - np.pi
        kept = np.ones(len(solids), dtype=bool)
        if np.abs(aside).max() > 1.5:
            return kept
        middle = (self._low[solids, :2] + self._high[solids, :2]) / 2 - origin[:2]
        half = (self._high[solids, :2] - self._low[solids, :2]) / 2
        for angle, sign in ((aside.max(), 1.0), (aside.min(), -1.0)):
            # The normal points into the wedge.
            normal = sign * np.array([np.sin(ahead + angle), -np.cos(ahead + angle)])
            kept &= middle @ normal + half @ np.abs(normal) >= -1e-9
        return kept

    def element(self, solid: int) -> Element:
        """The element that a solid belongs to."""
        return self._elements[solid]

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
        outside = np.maximum(np.maximum(self._low - at, at - self._high), 0.0)
        distance = np.where(self._equipment, np.linalg.norm(outside, axis=1), np.inf)
        return self._elements[int(distance.argmin())].name
