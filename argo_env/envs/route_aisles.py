"""Travel times on sites that do not exist: floors with aisles, and stairs along their ends."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from argo_env.envs.route_instance import Stair

WIDTH, DEPTH = 30.0, 20.0
"""m, of the floors of sites that do not exist"""
SPEED = 0.4
"""m/s, see `urdf/robot/tracker.yaml`"""
_UP, _DOWN = 33.0, 16.0  # s for a floor


def stairs_of(floors: int, ends: int) -> list[Stair]:
    """All stairs between so many floors: at the end x = 0 (number 0), and at x = WIDTH (1) if there
    are two."""
    return [(end, floor) for end in range(ends) for floor in range(1, floors)]


def aisle_times(
    places: NDArray[np.float64], floors: int, ends: int = 1, blocked: tuple[Stair, ...] = ()
) -> NDArray[np.float64] | None:
    """Seconds from each of the places (x, y in m, and floor) to each other, shape (n, n): along the
    aisles, and up or down by stairs that reach all along one end, or both ends, of the floors.

    None if a floor can't be reached, as all its stairs are blocked.
    """
    crossing = _crossing(floors, ends, frozenset(blocked))
    if not np.isfinite(crossing).all():
        return None
    x, y, number = places.T
    floor = number.astype(np.int64) - 1
    aside = np.abs(y[:, None] - y)
    level = np.abs(x[:, None] - x) + aside
    to_end = (x, WIDTH - x)
    # In from both sides, and up or down between.
    ways = [
        to_end[a][:, None] + crossing[a, b][floor[:, None], floor] + to_end[b] + aside
        for a in range(ends)
        for b in range(ends)
    ]
    rise = number - number[:, None]
    way = np.where(rise == 0, level, np.minimum.reduce(ways)) / SPEED
    return np.asarray(way + np.where(rise > 0, _UP * rise, -_DOWN * rise))


@lru_cache(maxsize=256)
def _crossing(floors: int, ends: int, blocked: frozenset[Stair]) -> NDArray[np.float64]:
    """m that a way goes from end to end of floors between leaving the first floor at one end and
    coming to the last floor at another, shape (ends, ends, floors, floors); inf: there is none."""
    lengths = np.full((ends, ends, floors, floors), np.inf)
    for first in range(floors):
        way = np.where(np.eye(ends, dtype=np.bool_), 0.0, WIDTH)  # row: where it left from
        lengths[:, :, first, first] = way
        for floor in range(first + 1, floors):
            way = way + [np.inf if (end, floor) in blocked else 0.0 for end in range(ends)]
            way = np.minimum(way, way[:, ::-1] + WIDTH if ends > 1 else way)
            lengths[:, :, first, floor] = way
            lengths[:, :, floor, first] = way.T
    return lengths
