"""What is where: the solids of a site in arrays."""

import numpy as np
from numpy.typing import NDArray

from argo_env.site.shapes import Box, Element, Solid, Vector, half_extents


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

    def at(self, point: Vector) -> str:
        """The name of the element whose solid, or the box around it, is nearest to `point` (m)."""
        local = np.einsum("nj,njk->nk", np.array(point) - self._centers, self._rotations)
        away = np.maximum(np.abs(local) - self._halves, 0.0)
        return self._names[int(np.argmin((away**2).sum(axis=1)))]
