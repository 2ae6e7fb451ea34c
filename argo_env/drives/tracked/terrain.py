"""Terrain of the tracked robot: the world's solids as bodies that never move, and those of them
that it presses against and must not touch."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from argo_compiler.base.catalog import CheckpointKind
from argo_env.drives.tracked.belts import INNER, TRACK_TOP
from argo_env.site import SiteCheckpoint
from argo_env.site.index import ElementIndex
from argo_env.site.shapes import WALKING_ROLES, Box, Element, Role, Vector
from argo_env.site.urdf import to_urdf
from argo_env.world.world import Touch, World

_HOUSING_DEPTH = 0.06  # m behind a checkpoint's face
_HOUSING_WIDTH = 0.15
_HOUSING_HEIGHT = {CheckpointKind.LIQUID_LEVEL_GAUGE: 0.32}


_WALKING, _OTHER = "grating", "structure"  # materials that stand for two groups of elements


class Terrain:
    """The solids of a world, with its checkpoints' housings as boxes, and their names.

    They make two parts only, what one walks on and all else: each part more costs time in every
    step of the physics.
    """

    def __init__(self, world: World) -> None:
        self.name = world.site.name
        elements = world.solids + tuple(_housing(c) for c in world.site.checkpoints)
        self._elements = tuple(
            replace(e, material=_WALKING if e.role in WALKING_ROLES else _OTHER) for e in elements
        )
        self._index = {m: ElementIndex(self._elements, m) for m in (_WALKING, _OTHER)}
        self.walking = _WALKING
        """the name of the part that tracks may stand on"""

    def elements_at(self, part: str, points: Sequence[Vector]) -> list[str]:
        """The names of the elements of that part at points (m) on its surface."""
        return self._index[part].at_each(points)

    def write(self, folder: str) -> Path:
        """Writes the URDF; returns where it is."""
        path = Path(folder) / "terrain.urdf"
        path.write_text(to_urdf(self.name, self._elements, drawn=False), encoding="utf-8")
        return path


def _housing(checkpoint: SiteCheckpoint) -> Element:
    """A checkpoint as one box: as a body with a joint it would slow every step of the physics."""
    x, y, z = checkpoint.position
    height = _HOUSING_HEIGHT.get(checkpoint.kind, _HOUSING_WIDTH)
    size = (_HOUSING_DEPTH, _HOUSING_WIDTH, height)
    turn = (0.0, 0.0, checkpoint.yaw)
    center = (
        x - _HOUSING_DEPTH / 2 * math.cos(checkpoint.yaw),
        y - _HOUSING_DEPTH / 2 * math.sin(checkpoint.yaw),
        z,
    )
    return Element(checkpoint.name, Role.PIPE, (Box(center, size, turn),), "pipe")


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
