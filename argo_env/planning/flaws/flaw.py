"""What is wrong with a site, and the words for places in it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.listing import listed
from argo_env.site import Site
from argo_env.site.shapes import WALKING_ROLES, half_extents

Point = tuple[float, float]

ASIDE = 0.15  # m that two things may be apart and still join
_DIRECTIONS = (
    "east", "north-east", "north", "north-west", "west", "south-west", "south", "south-east",
)  # fmt: skip
_NAMED = 3  # things that are in the way, at most


@dataclass(frozen=True)
class Mark:
    """A place (m) on a floor that a flaw is about."""

    floor: int
    x: float
    y: float


@dataclass(frozen=True)
class Flaw:
    """What is wrong with a site, what to do about it, and where it shows."""

    message: str
    marks: tuple[Mark, ...] = ()


def place(x: float, y: float) -> str:
    """A place (m) as messages show it."""
    return f"({x:.2f}, {y:.2f})"


def direction(yaw: float) -> str:
    """Where someone looks who is turned by `yaw` (rad) from the east."""
    return _DIRECTIONS[round(yaw / (math.pi / 4)) % 8]


def in_the_way(site: Site, low: Sequence[float], high: Sequence[float]) -> str:
    """What is in a box that the robot can't stand on: `a, b and 2 more things`, or nothing."""
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
    if len(names) > _NAMED:
        names[_NAMED - 1 :] = [f"{len(names) - _NAMED + 1} more things"]
    return listed(names)


def between(site: Site, a: NDArray[np.float64], b: NDArray[np.float64], height: float) -> str:
    """What stands between two places on the ground (x, y, z), up to a `height` (m) over them."""
    low, high = np.minimum(a, b), np.maximum(a, b)
    margin = np.array([0.1, 0.1, 0.0])
    return in_the_way(
        site,
        (low - margin + (0.0, 0.0, 0.05)).tolist(),
        (high + margin + (0.0, 0.0, height)).tolist(),
    )
