"""Terrain of the tracked robot: the world's solids as static bodies, and contacts with them.

The contacts are those with elements that the robot presses against and must not touch.
"""

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


_WALKING, _OTHER = "grating", "structure"  # materials that mark the two groups of elements


class Terrain:
    """Solids of a world, with its checkpoints' housings as boxes, and their names.

    They form only two parts, the walking surfaces and all else, because each further part costs
    time in every step of the physics.
    """

    def __init__(self, world: World) -> None:
        self.name = world.site.name
        elements = world.solids + tuple(_housing(c) for c in world.site.checkpoints)
        self._elements = tuple(
            replace(e, material=_WALKING if e.role in WALKING_ROLES else _OTHER) for e in elements
        )
        self._index = {m: ElementIndex(self._elements, m) for m in (_WALKING, _OTHER)}
        self.walking = _WALKING
        """name of the part that tracks may stand on"""

    def elements_at(self, part: str, points: Sequence[Vector]) -> list[str]:
        """Return the name of the nearest element to each of some points (m) on the terrain.

        Only elements of `part`, which is `_WALKING` or `_OTHER`, count.
        """
        return self._index[part].nearest_each(points)

    def write_urdf(self, folder: str) -> Path:
        """Write the terrain's URDF to the folder, and return the file's path."""
        path = Path(folder) / "terrain.urdf"
        path.write_text(
            to_urdf(self.name, self._elements, with_visual_shapes=False), encoding="utf-8"
        )
        return path


def _housing(checkpoint: SiteCheckpoint) -> Element:
    """Return a checkpoint's housing as one box: a body with a joint would slow the physics."""
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


_LEAST_FORCE = 20.0  # N, from which a contact counts; less is only a brush
_HULL_TOP = 0.57  # m; all that is higher is the arm
_BATCH = 1000  # pending contacts at which their elements are looked up


@dataclass(frozen=True, slots=True)
class StrongContact:
    """Contact strong enough to count: part of the robot, part of the terrain, and point."""

    part: str
    ground: str
    point: Vector
    distance: float
    """distance in m, less than 0 for an overlap"""


class ContactLog:
    """Log of strong contacts until they are read.

    It holds the contacts whose elements have not been looked up yet, in their order, and of the
    others the deepest for each part of the robot and each element.
    """

    def __init__(self, terrain: Terrain, grounds: dict[int, str], names: dict[int, str]) -> None:
        """`grounds` and `names` are the names of the terrain's and the robot's links by number."""
        self._terrain = terrain
        self._grounds = grounds
        self._names = names
        self._pending: list[StrongContact] = []
        self._deepest: dict[tuple[str, str], Touch] = {}

    def add_strong_contacts(
        self, contacts: list[tuple[Any, ...]], origin: Vector, axes: tuple[float, ...]
    ) -> None:
        """Add the contacts (rows of PyBullet's `getContactPoints`) with at least `_LEAST_FORCE` N.

        `origin` (m) and `axes`, a rotation matrix row by row, are those of the robot's frame.
        """
        for contact in contacts:
            link, other, on_robot, point, distance, force = (
                contact[3], contact[4], contact[5], contact[6], contact[8], contact[9],
            )  # fmt: skip
            if force < _LEAST_FORCE:
                continue
            part = self._names[link] if link >= 0 else _part_at(on_robot, origin, axes)
            self._pending.append(StrongContact(part, self._grounds[other], point, distance))
        if len(self._pending) >= _BATCH:
            self._look_up()

    def pop_deepest_touches(self) -> tuple[Touch, ...]:
        """Return the deepest contact of each part with each element, and clear the log."""
        touches = tuple(touch for _, touch in self.deepest_touches())
        self._deepest = {}
        return touches

    def deepest_touches(self) -> tuple[tuple[tuple[str, str], Touch], ...]:
        """Return what `pop_deepest_touches` would, in a form for `restore`; clear nothing."""
        if self._pending:
            self._look_up()
        return tuple(self._deepest.items())

    def restore(self, state: tuple[tuple[tuple[str, str], Touch], ...]) -> None:
        """Set the log to a state that `deepest_touches` returned."""
        self._pending, self._deepest = [], dict(state)

    def _look_up(self) -> None:
        """Look up the elements of all pending contacts at once: more take hardly more time."""
        pending, self._pending = self._pending, []
        elements: dict[int, str] = {}
        for ground in {contact.ground for contact in pending}:
            rows = [k for k, contact in enumerate(pending) if contact.ground == ground]
            names = self._terrain.elements_at(ground, [pending[k].point for k in rows])
            elements.update(zip(rows, names, strict=True))
        for k, contact in enumerate(pending):
            key = contact.part, elements[k]
            deepest = self._deepest.get(key)
            if deepest is None or -contact.distance > deepest.depth:
                self._deepest[key] = Touch(*key, contact.point, max(0.0, -contact.distance))


def _part_at(point: Vector, origin: Vector, m: tuple[float, ...]) -> str:
    """Return the name of the body's part at a point: hull, track, or the stowed arm.

    `point` and `origin` (m) are in the world's frame; `origin` and `m`, a rotation matrix row by
    row, are those of the robot's frame.
    """
    x, y, z = point[0] - origin[0], point[1] - origin[1], point[2] - origin[2]
    left, up = x * m[1] + y * m[4] + z * m[7], x * m[2] + y * m[5] + z * m[8]
    if up > _HULL_TOP:
        return "upper_arm"
    if abs(left) > INNER and up < TRACK_TOP:
        return "left_track" if left > 0 else "right_track"
    return "base_link"
