"""Pictures of routes; the source of an instance determines the paths between its positions."""

from collections.abc import Collection, Iterable, Sequence
from itertools import pairwise, product
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.model import Pose
from argo_env.envs.route_instance import DOCK, RouteInstance, Stair
from argo_env.envs.route_site_times import navigator_without
from argo_env.envs.route_sources import DEPTH, WIDTH, RandomRoutes, RouteSource, SiteRoutes
from argo_env.navigation import Navigator
from argo_env.pictures.drawing.floors import FloorPlan, empty_floor_plans, rectangular_floor_plans
from argo_env.pictures.drawing.path import PathPoint
from argo_env.pictures.drawing.plan import Marker, PlanDrawing, StationMark, draw_plan
from argo_env.pictures.drawing.sheet import FloorSheet, make_sheet, site_sheet
from argo_env.planning import open_site
from argo_env.robot.spec import Footprint

Position = tuple[float, float, int]
"""x, y (m) and floor"""

_STEP = 0.25  # m between the points of a path on a site


class LegPaths(Protocol):
    """Protocol of the paths between positions."""

    footprint: Footprint | None
    """footprint of the robot; None if it is a point"""

    def visiting_pose(self, position: Position) -> tuple[Position, float]:
        """Return where the robot stands when it visits a position, and its heading (rad) there."""
        ...

    def path_and_final_heading(
        self, a: Position, b: Position, blocked: tuple[Stair, ...]
    ) -> tuple[list[Position], float]:
        """Return the points of the path from a to b, and the robot's heading (rad) at its end.

        The path avoids the blocked stairs; there must be one without them.
        """
        ...


def leg_paths_for(source: RouteSource) -> LegPaths:
    """Return the object that finds paths between the positions of a source's instances."""
    if isinstance(source, SiteRoutes):
        return _SiteLegs(open_site(source.scenario).navigator)
    return (
        _AisleLegs(source.ends_with_stairs) if isinstance(source, RandomRoutes) else _StraightLegs()
    )


class _StraightLegs:
    """Straight paths between positions, for sources about whose sites nothing is known."""

    footprint: Footprint | None = None

    def visiting_pose(self, position: Position) -> tuple[Position, float]:
        return position, 0.0

    def path_and_final_heading(
        self, a: Position, b: Position, _: tuple[Stair, ...]
    ) -> tuple[list[Position], float]:
        return [a, b], 0.0


class _AisleLegs(_StraightLegs):
    """Paths along the aisles and over the stairs at an end of the floors.

    The travel times of random routes are those of these paths.
    """

    def __init__(self, ends: int) -> None:
        self._ends = ends

    def path_and_final_heading(
        self, a: Position, b: Position, blocked: tuple[Stair, ...]
    ) -> tuple[list[Position], float]:
        if a[2] == b[2]:
            return [a, (b[0], a[1], a[2]), b], 0.0
        up = b[2] > a[2]
        levels = range(a[2], b[2]) if up else range(a[2] - 1, b[2] - 1, -1)
        path = [a]
        for x, level in zip(self._stair_ends(a, b, levels, blocked), levels, strict=True):
            floor, y = path[-1][2], path[-1][1]
            path += [(x, y, floor), (x, b[1], floor), (x, b[1], level + 1 if up else level)]
        return [*dict.fromkeys(path), b], 0.0

    def _stair_ends(
        self, a: Position, b: Position, levels: Sequence[int], blocked: tuple[Stair, ...]
    ) -> list[float]:
        """Return the x (m) where the shortest path takes the stairs up from each level."""
        choices = [
            [(0.0, WIDTH)[end] for end in range(self._ends) if (end, level) not in blocked]
            for level in levels
        ]

        def length(ends: Iterable[float]) -> float:
            return sum(abs(p - q) for p, q in pairwise((a[0], *ends, b[0])))

        return list(min(product(*choices), key=length))


class _SiteLegs:
    """Paths that the robot's planner finds on a site."""

    footprint: Footprint | None

    def __init__(self, navigator: Navigator) -> None:
        self._navigator, self._site = navigator, navigator.site
        self._avoiding: dict[tuple[Stair, ...], Navigator] = {(): navigator}
        self.footprint = navigator.robot.footprint
        self._ids = {(c.position[0], c.position[1], c.floor): c.id for c in self._site.checkpoints}

    def visiting_pose(self, position: Position) -> tuple[Position, float]:
        pose = self._pose(position)
        return (pose.x, pose.y, position[2]), pose.yaw

    def path_and_final_heading(
        self, a: Position, b: Position, blocked: tuple[Stair, ...]
    ) -> tuple[list[Position], float]:
        if blocked not in self._avoiding:
            self._avoiding[blocked] = navigator_without(self._navigator, blocked)
        path = self._avoiding[blocked].plan(self._pose(a), self._pose(b))
        points: list[Position] = []
        for motion in path.motions:
            count = max(1, round(motion.length / _STEP))
            for k in range(count + 1):
                p = motion.pose_at(k / count)
                points.append((p.x, p.y, self._site.floor_at(p.z)))
        return points or [a], path.end.yaw

    def _pose(self, position: Position) -> Pose:
        if position in self._ids:
            return self._navigator.viewing_pose(self._ids[position])
        return self._navigator.snap_keeping_heading(self._site.docks[min(self._site.docks)])


_LEGEND = {
    "open": "legal now (size: prize)",
    "waiting": "too early or too far",
    "done": "visited",
    "closed": "can't be reached",
    "outside": "not asked for",
}


def draw_route(
    source: RouteSource,
    floors: Collection[int],
    instance: RouteInstance,
    route: Sequence[int],
    visited: Collection[int],
    legal: NDArray[np.bool_],
    time: float,
) -> NDArray[np.uint8]:
    """Return a picture of the route so far, shape (720, 1280, 3).

    The disc of a checkpoint is the larger, the higher its prize is.

    Args:
        source: Source of the instance.
        floors: Floors asked for; checkpoints on others are marked as not asked for. Empty: all.
        instance: The instance.
        route: Rows of the instance in the order of the visits; the last one is where the robot is.
        visited: Nodes of the checkpoints to draw as visited, whether or not they are on the route.
        legal: Mask of the nodes that are legal now.
        time: Time of the route so far in s.
    """
    positions: list[Position] = [
        (x, y, round(floor)) for x, y, floor in instance.positions.tolist()
    ]
    start = instance.start_row
    markers = []
    for node in range(1, instance.node_count):
        x, y, floor = positions[node]
        is_reachable = bool(np.isfinite(instance.arrival[start, node]))
        if not floor:  # an empty slot has no position
            continue
        state = "closed" if not is_reachable else "open" if legal[node] else "waiting"
        state = "outside" if floors and floor not in floors else state
        state = "done" if node in visited else state
        radius = 7.5 + 5.5 * float(instance.prizes[node])
        markers.append(Marker(x, y, floor, str(node), state, radius, node == route[-1]))
    starts_at_dock = positions[DOCK] == positions[start]
    stations = [StationMark(*positions[DOCK], "start, dock" if starts_at_dock else "dock")]
    if not starts_at_dock:
        stations.append(StationMark(*positions[start], "start"))
    legs = leg_paths_for(source)
    first, heading = legs.visiting_pose(positions[route[0]])
    path = [PathPoint(0.0, *first)]
    for a, b in pairwise(route):
        t = path[-1].t
        duration = float(instance.with_known_blockages_at(t).arrival[a, b])
        part, heading = legs.path_and_final_heading(
            positions[a], positions[b], instance.known_blocked_at(t)
        )
        path += [
            PathPoint(t + duration * k / max(len(part) - 1, 1), *p) for k, p in enumerate(part)
        ]
    requested = {marker.floor for marker in markers if marker.state != "outside"}
    used = requested | {station.floor for station in stations} | {moment.floor for moment in path}
    sheet = _sheet(source, positions, min(used), max(used), tuple(sorted(floors)))
    shown = [marker for marker in markers if marker.floor in sheet.panels]
    prize = sum(float(instance.prizes[node]) for node in visited)
    reachable_count = sum(marker.state not in {"closed", "outside"} for marker in markers)
    headline = f"{time:.0f} s of {instance.budget:.0f} s    prize {prize:.2f}    visited "
    headline += f"{len(visited)} of {reachable_count}"
    return draw_plan(
        sheet, PlanDrawing(headline, shown, stations, path, heading, legs.footprint, _LEGEND)
    )


def _sheet(
    source: RouteSource,
    positions: Sequence[Position],
    low: int,
    high: int,
    requested: tuple[int, ...],
) -> FloorSheet:
    """Return the sheet with the floors from `low` to `high`; unless requested, they are pale.

    If none is requested, none is pale.
    """
    numbers = range(low, high + 1)
    if isinstance(source, SiteRoutes):
        return site_sheet(source.scenario, low, high, requested or tuple(numbers))
    plans: tuple[FloorPlan, ...]
    if isinstance(source, RandomRoutes):
        plans = rectangular_floor_plans(WIDTH, DEPTH, high, source.ends_with_stairs)[low - 1 :]
    else:
        plans = empty_floor_plans([position[:2] for position in positions if position[2]], numbers)
    return make_sheet(plans, [n for n in numbers if requested and n not in requested])
