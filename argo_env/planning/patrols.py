"""Patrols: the round on each floor that a robot can go."""

import json
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from argo_compiler.base.errors import Unreachable
from argo_compiler.base.model import Pose
from argo_env.files.parts import Parts

if TYPE_CHECKING:
    from argo_env.navigation import Navigator
    from argo_env.site import Site

APART = 2.0  # m at least between the waypoints of a patrol


def patrol(navigator: "Navigator", floor: int) -> tuple[Pose, ...]:
    """A round on a floor: the reachable place nearest to each corner, counter-clockwise from the
    south-west, each pose turned towards the next.

    Raises ArgoError if fewer than three of them are apart from each other.
    """
    found = kept_patrol(navigator.parts, floor)
    if found is None:
        corners = _corners(navigator, floor)
        navigator.parts.store_text(_part(floor), json.dumps(corners))
        found = _round(corners)
    return found


def kept_patrol(parts: Parts, floor: int) -> tuple[Pose, ...] | None:
    """The same as it is kept in `parts`; None if it is not."""
    corners = parts.load_text(_part(floor))
    return None if corners is None else _round(json.loads(corners))


def _part(floor: int) -> str:
    return f"patrol-{floor}"


def _round(corners: Sequence[Sequence[float]]) -> tuple[Pose, ...]:
    following = [*corners[1:], *corners[:1]]
    return tuple(
        Pose(
            x=round(x, 6),
            y=round(y, 6),
            z=round(z, 6),
            yaw=math.atan2(next_y - y, next_x - x),
        )
        for (x, y, z), (next_x, next_y, _) in zip(corners, following, strict=True)
    )


def _corners(navigator: "Navigator", floor: int) -> list[tuple[float, float, float]]:
    corners = patrol_corners(navigator, floor)
    if len(corners) < 3:
        raise Unreachable(
            f"site {navigator.site.name}: floor {floor} has no three places to patrol between"
        )
    return corners


def patrol_corners(navigator: "Navigator", floor: int) -> list[tuple[float, float, float]]:
    """The reachable places (m) nearest to each corner of a floor that are apart from each other.
    Fewer than three make no patrol."""
    import numpy as np  # by what finds patrols, not by what has them in the cache

    places = navigator.turning_poses(floor)
    x0, y0, x1, y1 = _bounds(navigator.site, floor)
    # The whole robot stays on the floor, wherever it turns.
    inset = navigator.robot.footprint.radius
    inside_x = (places[:, 0] >= x0 + inset) & (places[:, 0] <= x1 - inset)
    inside_y = (places[:, 1] >= y0 + inset) & (places[:, 1] <= y1 - inset)
    places = places[inside_x & inside_y]
    corners: list[tuple[float, float, float]] = []
    for x, y in ((x0, y0), (x1, y0), (x1, y1), (x0, y1)):
        if len(places):
            nearest = places[np.argmin(np.hypot(places[:, 0] - x, places[:, 1] - y))]
            point = (float(nearest[0]), float(nearest[1]), float(nearest[2]))
            if all(math.dist(point, other) >= APART for other in corners):
                corners.append(point)
    return corners


def _bounds(site: "Site", floor: int) -> tuple[float, float, float, float]:
    x0, y0, x1, y1 = zip(*site.floor(floor).walkways.values(), strict=True)
    return min(x0), min(y0), max(x1), max(y1)
