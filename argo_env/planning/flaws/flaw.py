"""A flaw of a site, and texts for positions and things on the site."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.listing import listed
from argo_env.site import Site
from argo_env.site.shapes import WALKING_ROLES, half_extents

Point = tuple[float, float]

JOINT_GAP = 0.15  # m, largest gap between two parts that still join
_DIRECTIONS = (
    "east", "north-east", "north", "north-west", "west", "south-west", "south", "south-east",
)  # fmt: skip
_MAX_NAMES = 3  # things in a list; if there are more, the last entry has their number


@dataclass(frozen=True)
class Mark:
    """A position (m) on a floor that a flaw is about."""

    floor: int
    x: float
    y: float


@dataclass(frozen=True)
class Flaw:
    """Something that is wrong with a site."""

    message: str
    """description of the flaw, with a remedy"""
    marks: tuple[Mark, ...] = ()
    """positions on the site's plan"""


def position_text(x: float, y: float) -> str:
    """Return a position (m) as text, such as `(1.00, 2.50)`."""
    return f"({x:.2f}, {y:.2f})"


def compass_direction(yaw: float) -> str:
    """Return the nearest of eight compass directions to a yaw (rad); 0 is east, pi/2 north."""
    return _DIRECTIONS[round(yaw / (math.pi / 4)) % 8]


def obstructions_in_box(site: Site, low: Sequence[float], high: Sequence[float]) -> str:
    """Return a text that lists the elements that reach into a box, except those to stand on.

    An example is `a, b and 2 more things`; it is empty if there are none. `low` and `high` are the
    corners (m) of the box with the lowest and the highest coordinates.
    """
    names = [
        element.name
        for element in site.elements
        if element.role not in WALKING_ROLES
        and any(
            all(
                c - h < top and c + h > bottom
                for c, h, bottom, top in zip(
                    solid.center, half_extents(solid), low, high, strict=True
                )
            )
            for solid in element.solids
        )
    ]
    if len(names) > _MAX_NAMES:
        names[_MAX_NAMES - 1 :] = [f"{len(names) - _MAX_NAMES + 1} more things"]
    return listed(names)


def obstructions_between(
    site: Site, a: NDArray[np.float64], b: NDArray[np.float64], height: float
) -> str:
    """Return a text as `obstructions_in_box` for the box around two positions (x, y, z in m).

    The box reaches from 5 cm above the lower position up to `height` (m) above the higher one.
    """
    low, high = np.minimum(a, b), np.maximum(a, b)
    margin = np.array([0.1, 0.1, 0.0])
    return obstructions_in_box(
        site,
        (low - margin + (0.0, 0.0, 0.05)).tolist(),
        (high + margin + (0.0, 0.0, height)).tolist(),
    )
