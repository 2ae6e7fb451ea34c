"""What the tracked robot drives on: the world's solids as bodies that never move."""

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from argo_compiler.base.catalog import CheckpointKind
from argo_env.site import SiteCheckpoint
from argo_env.site.index import ElementIndex
from argo_env.site.shapes import WALKING_ROLES, Box, Element, Role, Vector
from argo_env.site.urdf import to_urdf
from argo_env.world.world import World

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
