"""Presses: what the robot pushes against that it must not touch."""

from dataclasses import dataclass
from typing import Any

from argo_env.drives.tracked.belts import INNER, TRACK_TOP
from argo_env.drives.tracked.terrain import Terrain
from argo_env.site.shapes import Vector
from argo_env.world.world import Touch

_PRESS = 20.0  # N from which a contact counts; less is a brush
_HULL_TOP = 0.57  # m; what is higher is arm
_MANY = 1000  # presses whose elements are looked up at once, to be found together


@dataclass(frozen=True, slots=True)
class Press:
    """One contact that counts: what of the robot, on which part of the terrain, and where."""

    part: str
    ground: str
    point: Vector
    distance: float
    """m, less than 0 for an overlap"""


class Presses:
    """Collects presses until they are taken. Holds those whose elements have not been looked up
    yet, in their order, and of the others the deepest of each part on each element."""

    def __init__(self, terrain: Terrain, grounds: dict[int, str], names: dict[int, str]) -> None:
        """`grounds` and `names` are the links of the terrain and of the robot by number."""
        self._terrain = terrain
        self._grounds = grounds
        self._names = names
        self._noted: list[Press] = []
        self._found: dict[tuple[str, str], Touch] = {}

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
            self._noted.append(Press(part, self._grounds[other], point, distance))
        if len(self._noted) >= _MANY:
            self._look_up()

    def take(self) -> tuple[Touch, ...]:
        """All presses since the last call."""
        touches = tuple(touch for _, touch in self.memory())
        self._found = {}
        return touches

    def memory(self) -> tuple[tuple[tuple[str, str], Touch], ...]:
        """All presses since they were last taken, to be remembered."""
        if self._noted:
            self._look_up()
        return tuple(self._found.items())

    def remember(self, memory: tuple[tuple[tuple[str, str], Touch], ...]) -> None:
        """Goes back to what `memory` gave."""
        self._noted, self._found = [], dict(memory)

    def _look_up(self) -> None:
        """Finds the elements, for all at once, as the time that takes hardly grows with them."""
        noted, self._noted = self._noted, []
        elements: dict[int, str] = {}
        for ground in {press.ground for press in noted}:
            rows = [k for k, press in enumerate(noted) if press.ground == ground]
            names = self._terrain.elements_at(ground, [noted[k].point for k in rows])
            elements.update(zip(rows, names, strict=True))
        for k, press in enumerate(noted):
            key = press.part, elements[k]
            known = self._found.get(key)
            if known is None or -press.distance > known.depth:
                self._found[key] = Touch(*key, press.point, max(0.0, -press.distance))


def _part_at(point: Vector, origin: Vector, m: tuple[float, ...]) -> str:
    """Which part of the body has that point: hull, track, or the stowed arm."""
    x, y, z = point[0] - origin[0], point[1] - origin[1], point[2] - origin[2]
    left, up = x * m[1] + y * m[4] + z * m[7], x * m[2] + y * m[5] + z * m[8]
    if up > _HULL_TOP:
        return "upper_arm"
    if abs(left) > INNER and up < TRACK_TOP:
        return "left_track" if left > 0 else "right_track"
    return "base_link"
