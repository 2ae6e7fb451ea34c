"""Routes as pictures: where the way leads depends on where the instances come from."""

from collections.abc import Collection, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from argo_env.envs.route_aisles import DEPTH, WIDTH
from argo_env.envs.route_instance import DOCK, RouteInstance
from argo_env.envs.route_legs import Place, legs_of
from argo_env.envs.route_sources import RandomRoutes, RouteSource, SiteRoutes
from argo_env.pictures.drawing.floors import FloorPlan, aisles, open_floors
from argo_env.pictures.drawing.plan import Marker, PlanDrawing, StationMark, draw_plan
from argo_env.pictures.drawing.sheet import FloorSheet, make_sheet
from argo_env.pictures.drawing.site_sheets import site_sheet
from argo_env.pictures.drawing.way import Moment

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
