"""Presses: what the robot pushes against that it must not touch."""

from typing import Any

from argo_env.drives.tracked.belts import INNER, TRACK_TOP
from argo_env.drives.tracked.terrain import Terrain
from argo_env.site.shapes import Vector
from argo_env.world.world import Touch

_PRESS = 20.0  # N from which a contact counts; less is a brush
_HULL_TOP = 0.57  # m; what is higher is arm


class Presses:
    """Collects presses until they are taken. Holds the deepest of each part on each thing."""

    def __init__(self, terrain: Terrain, grounds: dict[int, str], names: dict[int, str]) -> None:
        """`grounds` and `names` are the links of the terrain and of the robot by number."""
        self._terrain = terrain
        self._grounds = grounds
        self._names = names
        self.found: dict[tuple[str, str], Touch] = {}

    def note(
        self, contacts: list[tuple[Any, ...]], origin: Vector, axes: tuple[float, ...]
    ) -> None:
        """Takes note of contacts, rows of PyBullet's `getContactPoints`; the robot's frame has its
        `origin` (m) and its `axes`, a rotation matrix row by row."""
        for contact in contacts:
            link, other, on_robot, point, distance, force = (
                contact[3], contact[4], contact[5], contact[6], contact[8], contact[9],
            )  # fmt: skip
            if force < _PRESS:
                continue
            part = self._names[link] if link >= 0 else _part_at(on_robot, origin, axes)
            element = self._terrain.element_at(self._grounds[other], point)
            known = self.found.get((part, element))
            if known is None or -distance > known.depth:
                depth = max(0.0, -distance)
                self.found[part, element] = Touch(part, element, point, depth)

    def take(self) -> tuple[Touch, ...]:
        """All presses since the last call."""
        found = tuple(self.found.values())
        self.found = {}
        return found


def _part_at(point: Vector, origin: Vector, m: tuple[float, ...]) -> str:
    """Which part of the body has that point: hull, track, or the stowed arm."""
    x, y, z = (a - b for a, b in zip(point, origin, strict=True))
    left, up = x * m[1] + y * m[4] + z * m[7], x * m[2] + y * m[5] + z * m[8]
    if up > _HULL_TOP:
        return "upper_arm"
    if abs(left) > INNER and up < TRACK_TOP:
        return "left_track" if left > 0 else "right_track"
    return "base_link"
