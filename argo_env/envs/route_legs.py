"""The ways from place to place, as they are drawn in pictures of routes."""

from collections.abc import Iterable, Sequence
from itertools import pairwise, product
from typing import Protocol

from argo_compiler.base.model import Pose
from argo_env.envs.route_aisles import WIDTH
from argo_env.envs.route_instance import Stair
from argo_env.envs.route_site_times import navigator_without
from argo_env.envs.route_sources import RandomRoutes, RouteSource, SiteRoutes
from argo_env.navigation import Navigator
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
                p = motion.at(k / count)
                way.append((p.x, p.y, self._site.floor_at(p.z)))
        return way or [a], path.end.yaw

    def _pose(self, place: Place) -> Pose:
        if place in self._ids:
            return self._navigator.viewing_pose(self._ids[place])
        return self._navigator.snap(self._site.docks[min(self._site.docks)])
