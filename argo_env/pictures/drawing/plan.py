"""Episodes as pictures: the plans of the floors with the checkpoints, the way and the robot."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import ImageDraw

from argo_env.pictures.drawing.sheet import FINER, FloorSheet, Pixel
from argo_env.pictures.drawing.spots import Spots, draw_plate
from argo_env.pictures.drawing.style import (
    POINT,
    STYLES,
    Shown,
    disc,
    draw_headline,
    draw_legend,
    paint_disc,
    paint_point,
    paint_ring,
    paint_robot,
    paint_station,
)
from argo_env.pictures.drawing.way import Moment, draw_crossings, draw_lines, lines
from argo_env.robot.spec import Footprint

_SHORTEST = 17.0  # px that the robot is long at least
_STATION = 7.0  # px from the middle of a station's mark to its sides


@dataclass(frozen=True)
class Marker:
    """A checkpoint; `state` is one of STYLES."""

    x: float
    y: float
    floor: int
    name: str
    state: str
    radius: float = 10.0
    """px"""
    chosen: bool = False
    """whether the last action chose it"""


@dataclass(frozen=True)
class StationMark:
    """Where the robot starts, ends or charges."""

    x: float
    y: float
    floor: int
    name: str


@dataclass(frozen=True)
class PlanDrawing:
    """What a picture shows."""

    headline: str
    markers: Sequence[Marker]
    stations: Sequence[StationMark]
    way: Sequence[Moment]
    """to where the robot is now"""
    heading: float
    """rad, of the robot"""
    footprint: Footprint | None
    """of the robot; None: it is a point"""
    legend: Mapping[str, str]
    """what the states of markers mean"""


def draw_plan(sheet: FloorSheet, plan: PlanDrawing) -> NDArray[np.uint8]:
    """The picture, shape (720, 1280, 3)."""
    image = sheet.image.copy()
    draw = ImageDraw.Draw(image)
    spots = Spots(sheet)
    stations = [sheet.at(s.x, s.y, s.floor) for s in plan.stations]
    for place in stations:
        spots.take(place, (_STATION + 1.0) * FINER, (_STATION + 1.0) * FINER)
    now, scale, reach = plan.way[-1], sheet.scale, POINT * FINER
    robot = sheet.at(now.x, now.y, now.floor)
    if plan.footprint:
        front, rear = plan.footprint.front, plan.footprint.rear
        scale = max(scale, _SHORTEST * FINER / (front + rear))
        reach = max(front, rear) * scale
    spots.take(robot, reach, reach)
    discs = [_place_disc(sheet, spots, marker) for marker in plan.markers]
    way = lines(sheet, plan.way)
    for line in way:
        spots.pass_by(line.points)
    draw_lines(draw, way)
    for place in stations:
        paint_station(draw, place, _STATION)
    for marker, place in zip(plan.markers, discs, strict=True):
        _draw_pointer(draw, sheet, marker, place)
    if plan.footprint:
        paint_robot(draw, robot, plan.footprint, scale, plan.heading)
    else:
        paint_point(draw, robot)
    stairs = draw_crossings(draw, sheet, spots, plan.way)
    for marker, place in zip(plan.markers, discs, strict=True):
        if marker.chosen:
            paint_ring(draw, place, marker.radius)
        paint_disc(draw, place, marker.radius, marker.state, marker.name)
    for station, place in zip(plan.stations, stations, strict=True):
        draw_plate(draw, spots, place, station.name, station.floor, large=True)
    draw_headline(draw, plan.headline)
    there = {marker.state for marker in plan.markers}
    states = {state: meaning for state, meaning in plan.legend.items() if state in there}
    chosen = any(marker.chosen for marker in plan.markers)
    end = now.t if way else None
    draw_legend(draw, sheet, Shown(states, chosen, plan.footprint, stairs, end))
    return np.asarray(image.reduce(FINER), dtype=np.uint8)


def _place_disc(sheet: FloorSheet, spots: Spots, marker: Marker) -> Pixel:
    """Where the disc of a checkpoint goes: on it, or beside it where something else is."""
    size = (marker.radius + 1.0) * FINER
    return spots.nearest(sheet.at(marker.x, marker.y, marker.floor), size, size, marker.floor)


def _draw_pointer(
    draw: ImageDraw.ImageDraw, sheet: FloorSheet, marker: Marker, place: Pixel
) -> None:
    """A line from a disc that is beside its checkpoint to where that is."""
    true = sheet.at(marker.x, marker.y, marker.floor)
    if place != true:
        ink = STYLES[marker.state].rim
        draw.line([true, place], fill=ink, width=2 * FINER)
        disc(draw, true, 3.0 * FINER, ink)
