"""Index of a site's solids in arrays, and the first of them that rays meet."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from argo_env.site.shapes import Box, Element, Solid, Vector, half_extents

_NEAR = 0.05  # m from a point, within which the nearest solid is looked for first


class SolidIndex:
    """Finds the solids that may reach into a box."""

    def __init__(self, elements: tuple[Element, ...]) -> None:
        self._solids = [solid for element in elements for solid in element.solids]
        centers = np.array([s.center for s in self._solids])
        halves = np.array([half_extents(s) for s in self._solids])
        self._low, self._high = centers - halves, centers + halves

    def between(self, low: NDArray[np.float64], high: NDArray[np.float64]) -> list[Solid]:
        """The solids whose bounding boxes touch the box from `low` to `high` (m), in order."""
        inside = ((self._high >= low) & (self._low <= high)).all(axis=1)
        return [self._solids[k] for k in np.flatnonzero(inside).tolist()]


class ElementIndex:
    """Finds the element nearest to a point among those of one material."""

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

    def at(self, point: Vector) -> str:
        """The name of the element whose solid, or the box around it, is nearest to `point` (m)."""
        every = np.arange(len(self._names))
        return self._names[int(np.argmin(self._away(np.array(point), every)))]

    def at_each(self, points: Sequence[Vector]) -> list[str]:
        """The same for each of many points, which takes far less time where they lie beside solids
        and close together."""
        places = np.array(points)
        around = np.flatnonzero(
            ((self._low <= places.max(axis=0)) & (self._high >= places.min(axis=0))).all(axis=1)
        )
        low, high, at = self._low[around], self._high[around], places[:, None]
        rows, columns = np.nonzero(((low <= at) & (at <= high)).all(axis=2))
        solids = around[columns]
        away = self._away(places[rows], solids)
        # The nearest first, and of equals the first solid.
        order = np.lexsort((solids, away, rows))
        first = order[np.r_[True, np.diff(rows[order]) > 0]] if len(order) else order
        first = first[away[first] <= _NEAR**2]
        found = dict(zip(rows[first].tolist(), solids[first].tolist(), strict=True))
        return [
            self._names[found[k]] if k in found else self.at(point)
            for k, point in enumerate(points)
        ]

    def _away(self, point: NDArray[np.float64], solids: NDArray[np.int64]) -> NDArray[np.float64]:
        """The square of the distance (m²) from a point, or from one for each, to the boxes around
        these solids."""
        local = np.einsum("nj,njk->nk", point - self._centers[solids], self._rotations[solids])
        away = np.maximum(np.abs(local) - self._halves[solids], 0.0)
        return np.asarray((away**2).sum(axis=1))


_TINY = 1e-9


class SolidRays:
    """The solids of elements in arrays, for many rays at once. A solid goes by its number, counted
    through the elements in order."""

    def __init__(self, elements: tuple[Element, ...]) -> None:
        parts = [(e, s) for e in elements for s in e.solids]
        self.elements = tuple(e for e, _ in parts)
        """for each solid, the one that it belongs to"""
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

    def first(
        self,
        origin: NDArray[np.float64],
        directions: NDArray[np.float64],
        reach: float,
        inside: bool = False,
    ) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """The distance (m) to the first solid from `origin`, shape (3,) or (n, 3), in each of
        `directions`, unit vectors of the shape (n, 3), and which solid it is; inf and -1 where
        there is none within `reach` (m). Solids that a ray starts inside of are left out, or with
        `inside` come first, at less than 0: as far back as they begin."""
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
        met = (entry <= leave) & ((leave if inside else entry) >= 0.0)
        distance = np.where(met, entry, np.inf)
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

    def _crossings(
        self,
        origin: NDArray[np.float64],
        directions: NDArray[np.float64],
        solids: NDArray[np.int64],
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The distances (m) at which each ray enters and leaves the solid that goes with it; the
        former is the greater if it misses it. The arrays have one row for each pair."""
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
        return entries.max(axis=1), leaves.min(axis=1)


def _nonzero(slope: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.where(np.abs(slope) < _TINY, _TINY, slope)
