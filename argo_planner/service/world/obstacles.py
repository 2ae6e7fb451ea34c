"""Things that stand on a site besides what its description says: bodies for runs, and closed ground
for plans."""

import math
from collections.abc import Callable, Sequence
from functools import lru_cache
from itertools import pairwise
from typing import Annotated, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, field_validator

from argo_compiler.base.errors import Invalid
from argo_compiler.base.model import Model, Pose
from argo_env.navigation import Blockage, Navigator
from argo_env.navigation.closed_areas import LAYER
from argo_env.navigation.raster import CELL
from argo_env.planning.opening import OpenedSite
from argo_env.site.shapes import Box, Element, Role
from argo_env.site.spec import Rect
from argo_planner.service.core.plan_limits import require_name

T = TypeVar("T")
MOST_OBSTACLES = 200
FARTHEST = 10_000.0
"""m from the middle of the site's frame"""
MOST_TURNED = 1_000.0
"""rad"""
_SLABS = 32  # rectangles at most that stand for an obstacle which is turned
_STRAIGHT = 1e-6  # rad

_Edge = Annotated[float, Field(gt=0, le=20)]


class Obstacle(Model):
    """A box that stands somewhere."""

    id: str = Field(min_length=1, max_length=200)
    name: str = Field(default="", max_length=200)
    pose: Pose
    """m and rad, of the middle of its lower face"""
    size: tuple[_Edge, _Edge, _Edge]
    """m, along its own axes: x, y and upwards"""

    @field_validator("id", "name")
    @classmethod
    def _seen(cls, text: str) -> str:
        if text:
            _required(require_name, text, "the obstacle")
        return text

    @field_validator("pose")
    @classmethod
    def _near(cls, pose: Pose) -> Pose:
        _required(require_on_site, pose, "the obstacle")
        return pose

    def body(self) -> Box:
        """It as a solid."""
        x, y, z = self.pose.x, self.pose.y, self.pose.z + self.size[2] / 2
        return Box((x, y, z), self.size, (0.0, 0.0, self.pose.yaw))


def _required(require: Callable[[T, str], None], value: T, what: str) -> None:
    """Pydantic tells the place of a ValueError."""
    try:
        require(value, what)
    except Invalid as error:
        raise ValueError(str(error)) from None


def require_on_site(pose: Pose, what: str) -> None:
    """Raises Invalid for a pose that is on no site."""
    if max(abs(pose.x), abs(pose.y), abs(pose.z)) > FARTHEST:
        raise Invalid(f"{what} stands farther away than {FARTHEST:g} m, on no site")
    if abs(pose.yaw) > MOST_TURNED:
        raise Invalid(f"{what} has a yaw of {pose.yaw:g} rad: give it one of a turn")


def with_obstacles(site: OpenedSite, obstacles: Sequence[Obstacle]) -> OpenedSite:
    """The site with the obstacles on it: plans go round them, checkpoints are not seen through
    them, and in the worlds of runs on it they are solid. Its catalogue is that of the site.

    It can't be sent to another process: who wants it there makes it there. Raises Invalid for two
    obstacles with one id, or too many.
    """
    if len(obstacles) > MOST_OBSTACLES:
        raise Invalid(f"{len(obstacles)} obstacles are too many: at most {MOST_OBSTACLES}")
    ids = [obstacle.id for obstacle in obstacles]
    if twice := next((id for id in ids if ids.count(id) > 1), None):
        raise Invalid(f"two obstacles have the id `{twice}`: give each one of its own")
    return _with_obstacles(site, tuple(obstacles)) if obstacles else site


@lru_cache(maxsize=4)  # each holds some 10 MB
def _with_obstacles(site: OpenedSite, obstacles: tuple[Obstacle, ...]) -> OpenedSite:
    bodies = [Element(f"obstacle {o.id}", Role.STRUCTURE, (o.body(),), "brick") for o in obstacles]
    navigator = site.navigator
    blockages = [b for obstacle in obstacles for b in closed_by(obstacle, navigator)]
    altered = site.site.with_elements((*site.site.elements, *bodies))
    opened = OpenedSite.of_navigator(navigator.with_blockages(blockages, altered))
    opened.catalog = site.catalog
    return opened


def closed_by(obstacle: Obstacle, navigator: Navigator) -> list[Blockage]:
    """The parts of the surface over which the robot would touch an obstacle: rectangles that cover
    it, on each level that it leaves no headroom on. None if it is in nobody's way."""
    rects = _rects(obstacle)
    levels = _levels(obstacle, rects, navigator)
    what = obstacle.name or obstacle.id
    return [Blockage(rect, z, f"obstacle `{what}`") for z in levels for rect in rects]


def _levels(obstacle: Obstacle, rects: Sequence[Rect], navigator: Navigator) -> list[float]:
    """Heights (m) about which it stands in the way; each counts LAYER up and down."""
    surface = navigator.surface
    x, y, z = surface.positions().T
    under = np.zeros(surface.size, dtype=bool)
    for x0, y0, x1, y1 in rects:
        half = CELL / 2
        under |= (x >= x0 - half) & (x <= x1 + half) & (y >= y0 - half) & (y <= y1 + half)
    low = obstacle.pose.z - navigator.robot.driving_height
    heights = np.sort(z[under & (z > low) & (z < obstacle.pose.z + obstacle.size[2])])
    levels = []
    while len(heights):
        near = heights <= heights[0] + 2 * LAYER
        levels.append(float(heights[near][0] + heights[near][-1]) / 2)
        heights = heights[~near]
    return levels


def _rects(obstacle: Obstacle) -> list[Rect]:
    """Rectangles along the axes of the site that cover it: one, or slabs where it is turned."""
    length, width, _ = obstacle.size
    pose, cos, sin = obstacle.pose, math.cos(obstacle.pose.yaw), math.sin(obstacle.pose.yaw)
    signs = ((1, 1), (-1, 1), (-1, -1), (1, -1))
    corners = np.array(
        [
            (
                pose.x + a * length / 2 * cos - b * width / 2 * sin,
                pose.y + a * length / 2 * sin + b * width / 2 * cos,
            )
            for a, b in signs
        ]
    )
    (x0, y0), (x1, y1) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
    if min(abs(cos), abs(sin)) < _STRAIGHT:
        return [(x0, y0, x1, y1)]
    slabs = min(_SLABS, math.ceil((x1 - x0) / CELL))
    edges = np.linspace(x0, x1, slabs + 1).tolist()
    return [_slab(corners, a, b) for a, b in pairwise(edges)]


def _slab(corners: NDArray[np.float64], x0: float, x1: float) -> Rect:
    """The smallest rectangle around what of the polygon lies between x0 and x1."""
    heights = [y for x, y in corners.tolist() if x0 <= x <= x1]
    for (ax, ay), (bx, by) in zip(
        corners.tolist(), np.roll(corners, -1, axis=0).tolist(), strict=True
    ):
        for x in (x0, x1):
            if min(ax, bx) <= x <= max(ax, bx) and ax != bx:
                heights.append(float(ay + (x - ax) / (bx - ax) * (by - ay)))
    return (x0, min(heights), x1, max(heights))
