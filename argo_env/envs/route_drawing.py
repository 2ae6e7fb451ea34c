"""Routes as pictures: where the way leads depends on where the instances come from."""

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
from argo_env.pictures.drawing.floors import FloorPlan, aisles, open_floors
from argo_env.pictures.drawing.plan import Marker, PlanDrawing, StationMark, draw_plan
from argo_env.pictures.drawing.sheet import FloorSheet, make_sheet, site_sheet
from argo_env.pictures.drawing.way import Moment
from argo_env.planning import open_site
from argo_env.robot.spec import Footprint

Place = tuple[float, float, int]
"""x, y (m) and floor"""

_STEP = 0.25  # m between the places of a way on a site


class LegPaths(Protocol):
    """The ways from place to place."""

    footprint: Footprint | None
    """of the robot; None: it is a point"""

    def stand(self, place: Place) -> tuple[Place, float]:
        """Where the robot stands when it is at a place, and its heading (rad)."""
        ...

    def go(self, a: Place, b: Place, blocked: tuple[Stair, ...]) -> tuple[list[Place], float]:
        """The way that avoids stairs that are blocked, and the heading at its end."""
        ...


def legs_of(source: RouteSource) -> LegPaths:
    """The ways between the places of a source's instances."""
    if isinstance(source, SiteRoutes):
        return _SiteLegs(open_site(source.scenario).navigator)
    return _AisleLegs(source.ends) if isinstance(source, RandomRoutes) else _StraightLegs()


class _StraightLegs:
    """From place to place, as of their site nothing is known."""

    footprint: Footprint | None = None

    def stand(self, place: Place) -> tuple[Place, float]:
        return place, 0.0

    def go(self, a: Place, b: Place, _: tuple[Stair, ...]) -> tuple[list[Place], float]:
        return [a, b], 0.0


class _AisleLegs(_StraightLegs):
    """As the travel times of random routes count: along aisles, and by the stairs at an end."""

    def __init__(self, ends: int) -> None:
        self._ends = ends

    def go(self, a: Place, b: Place, blocked: tuple[Stair, ...]) -> tuple[list[Place], float]:
        if a[2] == b[2]:
            return [a, (b[0], a[1], a[2]), b], 0.0
        up = b[2] > a[2]
        levels = range(a[2], b[2]) if up else range(a[2] - 1, b[2] - 1, -1)
        way = [a]
        for x, level in zip(self._ends_of(a, b, levels, blocked), levels, strict=True):
            floor, y = way[-1][2], way[-1][1]
            way += [(x, y, floor), (x, b[1], floor), (x, b[1], level + 1 if up else level)]
        return [*dict.fromkeys(way), b], 0.0

    def _ends_of(
        self, a: Place, b: Place, levels: Sequence[int], blocked: tuple[Stair, ...]
    ) -> list[float]:
        """At which x the shortest way takes the stairs above each of the floors in `levels`."""
        choices = [
            [(0.0, WIDTH)[end] for end in range(self._ends) if (end, level) not in blocked]
            for level in levels
        ]

        def length(ends: Iterable[float]) -> float:
            return sum(abs(p - q) for p, q in pairwise((a[0], *ends, b[0])))

        return list(min(product(*choices), key=length))


class _SiteLegs:
    """The paths that the robot's planner finds on a site."""

    footprint: Footprint | None

    def __init__(self, navigator: Navigator) -> None:
        self._navigator, self._site = navigator, navigator.site
        self._without: dict[tuple[Stair, ...], Navigator] = {(): navigator}
        self.footprint = navigator.robot.footprint
        self._ids = {(c.position[0], c.position[1], c.floor): c.id for c in self._site.checkpoints}

    def stand(self, place: Place) -> tuple[Place, float]:
        pose = self._pose(place)
        return (pose.x, pose.y, place[2]), pose.yaw

    def go(self, a: Place, b: Place, blocked: tuple[Stair, ...]) -> tuple[list[Place], float]:
        if blocked not in self._without:
            self._without[blocked] = navigator_without(self._navigator, blocked)
        path = self._without[blocked].plan(self._pose(a), self._pose(b))
        way: list[Place] = []
        for motion in path.motions:
            count = max(1, round(motion.length / _STEP))
            for k in range(count + 1):
                p = motion.pose_at(k / count)
                way.append((p.x, p.y, self._site.floor_at(p.z)))
        return way or [a], path.end.yaw

    def _pose(self, place: Place) -> Pose:
        if place in self._ids:
            return self._navigator.viewing_pose(self._ids[place])
        return self._navigator.snap(self._site.docks[min(self._site.docks)])


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
    """The `route` so far: the rows of the instance in their order, the last one where the robot is.
    Of `visited` checkpoints the way need not be known. With `floors`, only the checkpoints on these
    count. A checkpoint's disc is as large as its prize is high."""
    places: list[Place] = [(x, y, round(floor)) for x, y, floor in instance.places.tolist()]
    start = instance.start
    markers = []
    for node in range(1, instance.size):
        x, y, floor = places[node]
        there = bool(np.isfinite(instance.arrival[start, node]))
        if not floor:  # an empty slot is nowhere
            continue
        state = "closed" if not there else "open" if legal[node] else "waiting"
        state = "outside" if floors and floor not in floors else state
        state = "done" if node in visited else state
        radius = 7.5 + 5.5 * float(instance.prizes[node])
        markers.append(Marker(x, y, floor, str(node), state, radius, node == route[-1]))
    together = places[DOCK] == places[start]
    stations = [StationMark(*places[DOCK], "start, dock" if together else "dock")]
    if not together:
        stations.append(StationMark(*places[start], "start"))
    legs = legs_of(source)
    first, heading = legs.stand(places[route[0]])
    way = [Moment(0.0, *first)]
    for a, b in pairwise(route):
        t = way[-1].t
        took = float(instance.at(t).arrival[a, b])
        part, heading = legs.go(places[a], places[b], instance.blocked_at(t))
        way += [Moment(t + took * k / max(len(part) - 1, 1), *p) for k, p in enumerate(part)]
    asked = {marker.floor for marker in markers if marker.state != "outside"}
    used = asked | {station.floor for station in stations} | {moment.floor for moment in way}
    sheet = _sheet(source, places, min(used), max(used), tuple(sorted(floors)))
    shown = [marker for marker in markers if marker.floor in sheet.panels]
    prize = sum(float(instance.prizes[node]) for node in visited)
    wanted = sum(marker.state not in {"closed", "outside"} for marker in markers)
    headline = f"{time:.0f} s of {instance.budget:.0f} s    prize {prize:.2f}    visited "
    headline += f"{len(visited)} of {wanted}"
    return draw_plan(
        sheet, PlanDrawing(headline, shown, stations, way, heading, legs.footprint, _LEGEND)
    )


def _sheet(
    source: RouteSource, places: Sequence[Place], low: int, high: int, asked: tuple[int, ...]
) -> FloorSheet:
    """The floors from `low` to `high`; if some are asked for, the others are pale."""
    numbers = range(low, high + 1)
    if isinstance(source, SiteRoutes):
        return site_sheet(source.scenario, low, high, asked or tuple(numbers))
    plans: tuple[FloorPlan, ...]
    if isinstance(source, RandomRoutes):
        plans = aisles(WIDTH, DEPTH, high, source.ends)[low - 1 :]
    else:
        plans = open_floors([place[:2] for place in places if place[2]], numbers)
    return make_sheet(plans, [n for n in numbers if asked and n not in asked])
