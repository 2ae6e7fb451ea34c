"""What is where: the solids of a site in arrays."""

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
