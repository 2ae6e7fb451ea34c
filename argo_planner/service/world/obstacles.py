"""Obstacles on a site that its description does not have.

They are solid in the worlds of runs, and close the surface for plans.
"""

import math
from collections.abc import Callable, Sequence
from functools import lru_cache
from itertools import pairwise
from typing import Annotated, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, field_validator

from argo_compiler.base.errors import Invalid
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model, Pose
from argo_env.navigation import Blockage, Navigator
from argo_env.navigation.closed_areas import LAYER
from argo_env.navigation.raster import CELL
from argo_env.planning.opening import OpenedSite
from argo_env.site.shapes import Box, Element, Role
from argo_env.site.spec import Rect
from argo_planner.service.core.plan_limits import require_displayable_name

T = TypeVar("T")
MOST_OBSTACLES = 200
MAX_COORDINATE = 10_000.0
"""largest absolute coordinate of a pose in the site's frame, in m"""
MAX_YAW = 1_000.0
"""largest absolute yaw of a pose, in rad"""
_SLABS = 32  # maximum number of rectangles that cover a turned obstacle
_STRAIGHT = 1e-6  # rad; an obstacle turned by less is taken as parallel to the axes

_Edge = Annotated[float, Field(gt=0, le=20)]


class Obstacle(Model):
    """Box on the site."""

    id: str = Field(min_length=1, max_length=200)
    name: str = Field(default="", max_length=200)
    pose: Pose
    """pose of the centre of its lower face, in m and rad"""
    size: tuple[_Edge, _Edge, _Edge]
    """edges in m, along its own axes: x, y and upwards"""

    @field_validator("id", "name")
    @classmethod
    def _check_text(cls, text: str) -> str:
        if text:
            _raise_as_value_error(require_displayable_name, text, Message("the obstacle"))
        return text

    @field_validator("pose")
    @classmethod
    def _check_pose(cls, pose: Pose) -> Pose:
        _raise_as_value_error(require_pose_within_limits, pose, Message("the obstacle"))
        return pose

    def to_solid(self) -> Box:
        """Return the obstacle as a solid in the site's frame."""
        x, y, z = self.pose.x, self.pose.y, self.pose.z + self.size[2] / 2
        return Box((x, y, z), self.size, (0.0, 0.0, self.pose.yaw))


def _raise_as_value_error(require: Callable[[T, str], None], value: T, what: str) -> None:
    """Call a check and raise its Invalid as a ValueError, to which Pydantic adds the field."""
    try:
        require(value, what)
    except Invalid as error:
        raise ValueError(str(error)) from None


def require_pose_within_limits(pose: Pose, what: str) -> None:
    """Raise Invalid if a coordinate or the yaw of a pose is too large for any site.

    `what` names the subject of the error message.
    """
    if max(abs(pose.x), abs(pose.y), abs(pose.z)) > MAX_COORDINATE:
        raise Invalid(
            Message(
                "{what} is more than {max_coordinate:g} m from the origin of the site: "
                "give smaller coordinates",
                what=what,
                max_coordinate=MAX_COORDINATE,
            )
        )
    if abs(pose.yaw) > MAX_YAW:
        raise Invalid(
            Message(
                "{what} has a yaw of {yaw:g} rad: give a yaw from -pi to pi",
                what=what,
                yaw=pose.yaw,
            )
        )


def with_obstacles(site: OpenedSite, obstacles: Sequence[Obstacle]) -> OpenedSite:
    """Return the site with obstacles on it, or the site itself if there are none.

    Paths lead round the obstacles, checkpoints are not visible through them, and they are solid in
    the worlds of runs. The catalogue is that of the site. The result can't be sent to another
    process, which must call this function itself.

    Raises Invalid if two obstacles have the same id, or there are too many.
    """
    if len(obstacles) > MOST_OBSTACLES:
        raise Invalid(
            Message(
                "{count} obstacles are too many: at most {most_obstacles} are possible",
                count=len(obstacles),
                most_obstacles=MOST_OBSTACLES,
            )
        )
    ids = [obstacle.id for obstacle in obstacles]
    if duplicate := next((id for id in ids if ids.count(id) > 1), None):
        raise Invalid(
            Message(
                "two obstacles have the id `{duplicate}`: give each an id of its own",
                duplicate=duplicate,
            )
        )
    return _with_obstacles(site, tuple(obstacles)) if obstacles else site


@lru_cache(maxsize=4)  # each holds some 10 MB
def _with_obstacles(site: OpenedSite, obstacles: tuple[Obstacle, ...]) -> OpenedSite:
    elements = [
        Element(
            Message("obstacle {id}", id=obstacle.id),
            Role.STRUCTURE,
            (obstacle.to_solid(),),
            "brick",
        )
        for obstacle in obstacles
    ]
    navigator = site.navigator
    blockages = [b for obstacle in obstacles for b in obstacle_blockages(obstacle, navigator)]
    altered = site.site.replacing_elements((*site.site.elements, *elements))
    opened = OpenedSite.from_navigator(navigator.with_added_blockages(blockages, altered))
    opened.catalog = site.catalog
    return opened


def obstacle_blockages(obstacle: Obstacle, navigator: Navigator) -> list[Blockage]:
    """Return the parts of the surface that an obstacle closes to the robot.

    They are rectangles that cover the obstacle's outline, at the height of each level on which the
    robot would touch it. The list is empty if it blocks nothing.
    """
    rects = _covering_rects(obstacle)
    levels = _blocked_levels(obstacle, rects, navigator)
    name = obstacle.name or obstacle.id
    return [
        Blockage(rect, z, Message("obstacle `{name}`", name=name)) for z in levels for rect in rects
    ]


def _blocked_levels(obstacle: Obstacle, rects: Sequence[Rect], navigator: Navigator) -> list[float]:
    """Return heights in m that, with LAYER above and below each, contain the blocked surface."""
    surface = navigator.surface
    x, y, z = surface.cell_positions().T
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


def _covering_rects(obstacle: Obstacle) -> list[Rect]:
    """Return rectangles along the site's axes that cover an obstacle: one, or slabs if turned."""
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
    return [_slab_rect(corners, a, b) for a, b in pairwise(edges)]


def _slab_rect(corners: NDArray[np.float64], x0: float, x1: float) -> Rect:
    """Return the smallest rectangle around the part of a polygon between `x0` and `x1`."""
    heights = [y for x, y in corners.tolist() if x0 <= x <= x1]
    for (ax, ay), (bx, by) in zip(
        corners.tolist(), np.roll(corners, -1, axis=0).tolist(), strict=True
    ):
        for x in (x0, x1):
            if min(ax, bx) <= x <= max(ax, bx) and ax != bx:
                heights.append(float(ay + (x - ax) / (bx - ax) * (by - ay)))
    return (x0, min(heights), x1, max(heights))
