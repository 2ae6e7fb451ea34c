"""The site as the robot knows it: the map that it compares its signals with."""

import numpy as np
from numpy.typing import NDArray

from argo_env.site import Site
from argo_env.site.shapes import WALKING_ROLES, Box, Element, Role, Vector, half_extents

EQUIPMENT = frozenset({Role.VESSEL, Role.PIPE, Role.PUMP})

_TINY = 1e-9


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
        # Axis by axis, as most solids are ruled out by a few comparisons of whole columns.
        self._bounds = [
            (self._low[:, k].copy() - _TINY, self._high[:, k].copy() + _TINY) for k in range(3)
        ]
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
        ends = origin + reach * directions
        near = np.ones(len(self._centers), dtype=bool)
        for axis, (low, high) in enumerate(self._bounds):
            start, end = origin[..., axis], ends[:, axis]
            near &= low <= max(start.max(), end.max())
            near &= high >= min(start.min(), end.min())
        rays, solids = self._candidates(np.flatnonzero(near), origin, directions, reach)
        result, which = np.full(len(directions), np.inf), np.full(len(directions), -1)
        if not len(rays):
            return result, which
        distance = self._entries(
            origin[rays] if origin.ndim == 2 else origin, directions[rays], solids
        )
        # The nearest first, and of equals the first solid.
        order = np.lexsort((solids, distance, rays))
        first = order[np.r_[True, np.diff(rays[order]) > 0]]
        first = first[distance[first] <= reach]
        result[rays[first]], which[rays[first]] = distance[first], solids[first]
        return result, which

    def _candidates(
        self,
        near: NDArray[np.int64],
        origin: NDArray[np.float64],
        directions: NDArray[np.float64],
        reach: float,
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Pairs of a ray and one of the solids `near` whose upright bounds it meets."""
        enter, leave = np.zeros((len(directions), len(near))), np.inf
        for axis, (low, high) in enumerate(self._bounds):
            start = origin[..., axis].reshape(-1, 1)
            slope = _nonzero(directions[:, axis, None])
            one, other = (low[near] - start) / slope, (high[near] - start) / slope
            enter = np.maximum(enter, np.minimum(one, other))
            leave = np.minimum(leave, np.maximum(one, other))
        rays, columns = np.nonzero((enter <= leave) & (enter <= reach))
        return rays, near[columns]

    def _entries(
        self,
        origin: NDArray[np.float64],
        directions: NDArray[np.float64],
        solids: NDArray[np.int64],
    ) -> NDArray[np.float64]:
        """The distance (m) to where each ray enters the solid that goes with it; inf if it does
        not, or starts within. The arrays have one row for each pair."""
        rotations, halves, round_ = (
            self._rotations[solids],
            self._halves[solids],
            self._round[solids],
        )
        start = np.einsum("pk,pkj->pj", origin - self._centers[solids], rotations)
        slope = _nonzero(np.einsum("pk,pkj->pj", directions, rotations))
        first, second = (-halves - start) / slope, (halves - start) / slope
        entries, leaves = np.minimum(first, second), np.maximum(first, second)
        if round_.any():
            # The round side of a cylinder stands for the slabs across its axis.
            s, d, radius = start[round_], slope[round_], halves[round_, 0]
            a = d[:, 0] ** 2 + d[:, 1] ** 2
            b = d[:, 0] * s[:, 0] + d[:, 1] * s[:, 1]
            discriminant = b**2 - a * (s[:, 0] ** 2 + s[:, 1] ** 2 - radius**2)
            root = np.sqrt(np.maximum(discriminant, 0.0))
            hit = discriminant >= 0
            entries[round_, :2] = np.where(hit, (-b - root) / a, np.inf)[:, None]
            leaves[round_, :2] = np.where(hit, (-b + root) / a, -np.inf)[:, None]
        entry, leave = entries.max(axis=1), leaves.min(axis=1)
        return np.where((entry <= leave) & (entry >= 0.0), entry, np.inf)

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


def _nonzero(slope: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.where(np.abs(slope) < _TINY, _TINY, slope)
