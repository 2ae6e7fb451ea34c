"""Patrols: poses on a floor, one near each corner, between which the robot can drive a round."""

import json
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from argo_compiler.base.model import Pose
from argo_env.files.parts import Parts

if TYPE_CHECKING:
    from argo_env.navigation import Navigator
    from argo_env.site import Site

MIN_SPACING = 2.0  # m, minimum distance between two poses of a patrol


def find_patrol(navigator: "Navigator", floor: int) -> tuple[Pose, ...]:
    """Return the poses of a floor's patrol, from the disk cache or computed and stored there.

    They are at the positions of `patrol_corners`, counter-clockwise from the south-west, and each
    is turned towards the next one. There are none if there are fewer than three positions.
    """
    poses = load_patrol(navigator.parts, floor)
    if poses is None:
        corners = patrol_corners(navigator, floor)
        if len(corners) < 3:
            corners = []
        navigator.parts.store_text(_part_name(floor), json.dumps(corners))
        poses = _patrol_poses(corners)
    return poses


def load_patrol(parts: Parts, floor: int) -> tuple[Pose, ...] | None:
    """Return the poses of a floor's patrol from the disk cache; None if it is not there.

    `parts` is the site's entry of the cache.
    """
    corners = parts.load_text(_part_name(floor))
    return None if corners is None else _patrol_poses(json.loads(corners))


def _part_name(floor: int) -> str:
    return f"patrol-{floor}"


def _patrol_poses(corners: Sequence[Sequence[float]]) -> tuple[Pose, ...]:
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


def patrol_corners(navigator: "Navigator", floor: int) -> list[tuple[float, float, float]]:
    """Return the positions (x, y, z in m) for a patrol that are nearest to a floor's corners.

    The corners are those of the rectangle around its walkways. At each position the robot can turn
    all round inside this rectangle, and it can get there from the docking stations and back. There
    are at most four, counter-clockwise from the south-west: a position that is closer than
    MIN_SPACING to an earlier one is left out.
    """
    import numpy as np  # not needed for patrols from the cache

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
            if all(math.dist(point, other) >= MIN_SPACING for other in corners):
                corners.append(point)
    return corners


def _bounds(site: "Site", floor: int) -> tuple[float, float, float, float]:
    x0, y0, x1, y1 = zip(*site.floor(floor).walkways.values(), strict=True)
    return min(x0), min(y0), max(x1), max(y1)
