"""The compiler's view of a site: what scripts may name there."""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from argo_compiler.base.catalog import Area, Catalog, CheckpointInfo, Floor, Place
from argo_compiler.base.errors import Unreachable
from argo_compiler.base.model import Pose
from argo_compiler.base.stages import each
from argo_env.files.parts import Parts
from argo_env.site import Site

if TYPE_CHECKING:
    from argo_env.navigation import Navigator

APART = 2.0  # m at least between the waypoints of a patrol


def make_catalog(navigator: "Navigator") -> Catalog:
    """The catalogue of the navigator's site, its patrols along places that the robot can reach."""
    floors = each("looking for patrols of all floors", navigator.site.spec.floors)
    return _catalog(navigator.site, {f.number: patrol(navigator, f.number) for f in floors})


def kept_catalog(site: Site, parts: Parts) -> Catalog | None:
    """The same by the patrols that are kept in `parts`; None if some are not."""
    patrols = {}
    for floor in site.spec.floors:
        corners = parts.find(_part(floor.number))
        if corners is None:
            return None
        patrols[floor.number] = _round(corners["corners"].tolist())
    return _catalog(site, patrols)


def _catalog(site: Site, patrols: Mapping[int, tuple[Pose, ...]]) -> Catalog:
    return Catalog(
        site=site.name,
        checkpoints=tuple(
            CheckpointInfo(
                id=c.id,
                kind=c.kind,
                name=c.name,
                floor=c.floor,
                unit=c.unit,
                range=c.range,
                nominal=c.nominal,
            )
            for c in site.checkpoints
        ),
        areas=tuple(Area(number=n, dock=pose) for n, pose in sorted(site.docks.items())),
        floors=tuple(
            Floor(number=f.number, z=f.z, patrol=patrols[f.number]) for f in site.spec.floors
        ),
        places=tuple(Place(name=name, pose=pose) for name, pose in site.places.items()),
    )


def patrol(navigator: "Navigator", floor: int) -> tuple[Pose, ...]:
    """A round on a floor: the reachable place nearest to each corner, counter-clockwise from the
    south-west, each pose turned towards the next.

    Raises ArgoError if fewer than three of them are apart from each other.
    """
    found = navigator.parts.made(
        _part(floor), lambda: {"corners": np.array(_corners(navigator, floor))}
    )
    return _round(found["corners"].tolist())


def _part(floor: int) -> str:
    return f"patrol-{floor}"


def _round(corners: list[list[float]]) -> tuple[Pose, ...]:
    following = corners[1:] + corners[:1]
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
    places = navigator.turning_places(floor)
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


def _bounds(site: Site, floor: int) -> tuple[float, float, float, float]:
    rects = np.array(list(site.floor(floor).walkways.values()))
    low, high = rects[:, :2].min(axis=0), rects[:, 2:].max(axis=0)
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])
