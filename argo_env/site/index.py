"""Indexes of a site's solids: search by box or nearest point, and ray casting, in arrays."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from argo_env.site.shapes import Box, Element, Solid, Vector, half_extents

_NEAR = 0.05  # m, distance within which the nearest solid is searched first


class SolidIndex:
    """Index that finds the solids which may reach into a box."""

    def __init__(self, elements: tuple[Element, ...]) -> None:
        self._solids = [solid for element in elements for solid in element.solids]
        centers = np.array([s.center for s in self._solids])
        halves = np.array([half_extents(s) for s in self._solids])
        self._low, self._high = centers - halves, centers + halves

    def touching_box(self, low: NDArray[np.float64], high: NDArray[np.float64]) -> list[Solid]:
        """Return the solids whose bounding boxes touch the box from `low` to `high` (x, y, z in m).

        They are in the order of the elements.
        """
        inside = ((self._high >= low) & (self._low <= high)).all(axis=1)
        return [self._solids[k] for k in np.flatnonzero(inside).tolist()]


class ElementIndex:
    """Index that finds, among the elements of one material, the one nearest to a point."""

    def __init__(self, elements: tuple[Element, ...], material: str) -> None:
        parts = [(e.name, s) for e in elements if e.material == material for s in e.solids]
        self._names = [name for name, _ in parts]
        self._centers = np.array([s.center for _, s in parts])
        self._rotations = np.array([s.rotation() for _, s in parts])
        self._halves = np.array(
            [
                np.array(s.size) / 2 if isinstance(s, Box) else (s.radius, s.radius, s.length / 2)
                for _, s in parts
            ]
        )
        upright = np.einsum("njk,nk->nj", np.abs(self._rotations), self._halves) + _NEAR
        self._low, self._high = self._centers - upright, self._centers + upright

    def nearest(self, point: Vector) -> str:
        """Return the name of the element nearest to `point` (m).

        A solid counts as the box around it, in the solid's own axes.
        """
        every = np.arange(len(self._names))
        return self._names[int(np.argmin(self._squared_distances(np.array(point), every)))]

    def nearest_each(self, points: Sequence[Vector]) -> list[str]:
        """Return for each of many points (m) the name of the element nearest to it.

        This is far faster than calls of `nearest` if the points lie beside solids and close
        together.
        """
        positions = np.array(points)
        around = np.flatnonzero(
            ((self._low <= positions.max(axis=0)) & (self._high >= positions.min(axis=0))).all(
                axis=1
            )
        )
        low, high, at = self._low[around], self._high[around], positions[:, None]
        rows, columns = np.nonzero(((low <= at) & (at <= high)).all(axis=2))
        solids = around[columns]
        away = self._squared_distances(positions[rows], solids)
        # The nearest solid comes first; among equally near ones, the first in the order.
        order = np.lexsort((solids, away, rows))
        first = order[np.r_[True, np.diff(rows[order]) > 0]] if len(order) else order
        first = first[away[first] <= _NEAR**2]
        nearest = dict(zip(rows[first].tolist(), solids[first].tolist(), strict=True))
        return [
            self._names[nearest[k]] if k in nearest else self.nearest(point)
            for k, point in enumerate(points)
        ]

    def _squared_distances(
        self, point: NDArray[np.float64], solids: NDArray[np.int64]
    ) -> NDArray[np.float64]:
        """Return the squared distances (m²) to the boxes around these solids.

        `point` is one point, or one for each solid.
        """
        local = np.einsum("nj,njk->nk", point - self._centers[solids], self._rotations[solids])
        away = np.maximum(np.abs(local) - self._halves[solids], 0.0)
        return np.asarray((away**2).sum(axis=1))


_TINY = 1e-9


class SolidRays:
    """Solids of elements in arrays, for ray casting with many rays at once.

    The number of a solid is its index among the solids of all elements, in order.
    """

    def __init__(self, elements: tuple[Element, ...]) -> None:
        parts = [(e, s) for e in elements for s in e.solids]
        self.elements = tuple(e for e, _ in parts)
        """element that each solid belongs to"""
        self._centers = np.array([s.center for _, s in parts]).reshape(-1, 3)
        self._rotations = np.array([s.rotation() for _, s in parts]).reshape(-1, 3, 3)
        self._round = np.array([not isinstance(s, Box) for _, s in parts], dtype=bool)
        self._halves = np.array(
            [
                np.array(s.size) / 2 if isinstance(s, Box) else (s.radius, s.radius, s.length / 2)
                for _, s in parts
            ]
        ).reshape(-1, 3)
        half = np.array([half_extents(s) for _, s in parts]).reshape(-1, 3)
        self.low, self.high = self._centers - half, self._centers + half
        """m, corners of the solids' bounding boxes along the site's axes, shape (n, 3)"""
        # Axis by axis, as most solids are ruled out by a few comparisons of whole columns.
        self._bounds = [
            (self.low[:, k].copy() - _TINY, self.high[:, k].copy() + _TINY) for k in range(3)
        ]

    def first_hits(
        self,
        origin: NDArray[np.float64],
        directions: NDArray[np.float64],
        reach: float,
        include_solids_around_origin: bool = False,
    ) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Return the distance (m) to the first solid on each ray, and the number of that solid.

        Args:
            origin: Start of all rays, shape (3,), or of each ray, shape (n, 3).
            directions: Unit vectors, shape (n, 3).
            reach: Length of the rays in m.
            include_solids_around_origin: True to count solids that a ray starts inside of. They
                come first, with a negative distance: that from the origin back to their surface.
                Otherwise they are left out.

        Returns:
            Distances and numbers, both of shape (n,); inf and -1 where a ray meets no solid.
        """
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
        entry, leave = self._crossings(
            origin[rays] if origin.ndim == 2 else origin, directions[rays], solids
        )
        met = (entry <= leave) & ((leave if include_solids_around_origin else entry) >= 0.0)
        distance = np.where(met, entry, np.inf)
        # The nearest solid comes first; among equally near ones, the first in the order.
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
        """Return pairs of a ray and a solid of `near` whose bounding box the ray meets."""
        enter, leave = np.zeros((len(directions), len(near))), np.inf
        for axis, (low, high) in enumerate(self._bounds):
            start = origin[..., axis].reshape(-1, 1)
            slope = _nonzero(directions[:, axis, None])
            one, other = (low[near] - start) / slope, (high[near] - start) / slope
            enter = np.maximum(enter, np.minimum(one, other))
            leave = np.minimum(leave, np.maximum(one, other))
        rays, columns = np.nonzero((enter <= leave) & (enter <= reach))
        return rays, near[columns]

    def _crossings(
        self,
        origin: NDArray[np.float64],
        directions: NDArray[np.float64],
        solids: NDArray[np.int64],
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the distances (m) at which the ray of each pair enters and leaves its solid.

        A ray that misses its solid enters at a greater distance than it leaves. The arrays have one
        row for each pair of a ray and a solid.
        """
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
            # The curved side of a cylinder replaces the slabs across its axis.
            s, d, radius = start[round_], slope[round_], halves[round_, 0]
            a = d[:, 0] ** 2 + d[:, 1] ** 2
            b = d[:, 0] * s[:, 0] + d[:, 1] * s[:, 1]
            discriminant = b**2 - a * (s[:, 0] ** 2 + s[:, 1] ** 2 - radius**2)
            root = np.sqrt(np.maximum(discriminant, 0.0))
            hit = discriminant >= 0
            entries[round_, :2] = np.where(hit, (-b - root) / a, np.inf)[:, None]
            leaves[round_, :2] = np.where(hit, (-b + root) / a, -np.inf)[:, None]
        return entries.max(axis=1), leaves.min(axis=1)


def _nonzero(slope: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.where(np.abs(slope) < _TINY, _TINY, slope)
