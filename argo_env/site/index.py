"""Which element is at a point: the solids of one material in arrays."""

import numpy as np

from argo_env.site.shapes import Box, Element, Vector


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
