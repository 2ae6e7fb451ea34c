"""Placements: displacements of checkpoints from their planned poses."""

import math
from dataclasses import dataclass, replace

import numpy as np

from argo_env.site import SiteCheckpoint
from argo_env.site.shapes import Vector

MAX_OFFSET = 0.10  # m, the radius of the sphere (thesis, 1.2)
MAX_TURN = math.pi / 2  # rad, either way (thesis, 1.2)


@dataclass(frozen=True)
class Placement:
    """Displacement of a checkpoint from its planned pose."""

    offset: Vector = (0.0, 0.0, 0.0)
    """m, along the site's axes"""
    turn: float = 0.0
    """rad about the vertical"""
    roll: float = 0.0
    """rad about the normal of its face after the turn, clockwise seen from the front"""


AS_PLANNED = Placement()


def displaced_checkpoint(checkpoint: SiteCheckpoint, placement: Placement) -> SiteCheckpoint:
    """Return the checkpoint with its position and yaw after the displacement; roll is left out."""
    x, y, z = (p + d for p, d in zip(checkpoint.position, placement.offset, strict=True))
    return replace(checkpoint, position=(x, y, z), yaw=checkpoint.yaw + placement.turn)


def draw_checkpoint_placement(rng: np.random.Generator, keep_upright: bool = False) -> Placement:
    """Draw a random displacement of a checkpoint, within the competition's limits (thesis, 1.2).

    The offset is uniform in a sphere, turn and roll are uniform up to ±90°. With `keep_upright`,
    the roll is 0: level gauges work only when upright.
    """
    direction = rng.normal(size=3)
    direction *= MAX_OFFSET * rng.uniform() ** (1 / 3) / np.linalg.norm(direction)
    turn, roll = rng.uniform(-MAX_TURN, MAX_TURN, size=2)
    x, y, z = direction.tolist()
    return Placement((x, y, z), float(turn), 0.0 if keep_upright else float(roll))
