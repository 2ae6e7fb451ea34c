"""Episodes as pictures: the plans of the floors with the checkpoints, the way and the robot."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import ImageDraw

from argo_env.envs.drawing.legend import draw_headline, draw_legend
from argo_env.envs.drawing.sheet import FINER, INK, PAPER, Pixel, Sheet, font
from argo_env.envs.drawing.spots import Spots
from argo_env.envs.drawing.style import (
    FOOTPRINT,
    STYLES,
    disc,
    paint_disc,
    paint_ring,
    paint_robot,
)
from argo_env.envs.drawing.way import Moment, draw_crossings, draw_lines, lines

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
class Station:
    """Where the robot starts, ends or charges."""

    x: float
    y: float
    floor: int
    name: str


@dataclass(frozen=True)
class Scene:
    """What a picture shows."""

    headline: str
    markers: Sequence[Marker]
    stations: Sequence[Station]
    way: Sequence[Moment]
    """to where the robot is now"""
    heading: float | None
    """rad, of the robot; None: it is a point"""
    legend: Mapping[str, str]
    """what the states of markers mean"""


def draw_scene(sheet: Sheet, scene: Scene) -> NDArray[np.uint8]:
    """The picture, shape (720, 1280, 3)."""
    image = sheet.image.copy()
    draw = ImageDraw.Draw(image)
    spots = Spots(sheet)
    stations = [sheet.at(s.x, s.y, s.floor) for s in scene.stations]
    for place in stations:
        spots.take(place, (_STATION + 1.0) * FINER, (_STATION + 1.0) * FINER)
    now, length = scene.way[-1], max(FOOTPRINT[0] * sheet.scale, _SHORTEST * FINER)
    robot = sheet.at(now.x, now.y, now.floor)
    if scene.heading is not None:
        spots.take(robot, length / 2, length / 2)
    discs = [_place_disc(sheet, spots, marker) for marker in scene.markers]
    way = lines(sheet, scene.way)
    for line in way:
        spots.pass_by(line.points)
    draw_lines(draw, way)
    if scene.heading is None:
        paint_ring(draw, robot, _STATION)
    for x, y in stations:
        r = _STATION * FINER
        draw.rectangle((x - r, y - r, x + r, y + r), fill=INK, outline=PAPER, width=FINER)
    if scene.heading is not None:
        paint_robot(draw, robot, length, scene.heading)
    draw_crossings(draw, sheet, spots, scene.way)
    for marker, place in zip(scene.markers, discs, strict=True):
        _draw_marker(draw, sheet, marker, place)
    for station, place in zip(scene.stations, stations, strict=True):
        _draw_name(draw, spots, station, place)
    draw_headline(draw, scene.headline)
    draw_legend(draw, sheet, scene.legend, scene.way[-1].t)
    return np.asarray(image.reduce(FINER), dtype=np.uint8)


def _place_disc(sheet: Sheet, spots: Spots, marker: Marker) -> Pixel:
    """Where the disc of a checkpoint goes: on it, or beside it where something else is."""
    size = (marker.radius + 1.0) * FINER
    return spots.nearest(sheet.at(marker.x, marker.y, marker.floor), size, size, marker.floor)


def _draw_marker(draw: ImageDraw.ImageDraw, sheet: Sheet, marker: Marker, place: Pixel) -> None:
    true = sheet.at(marker.x, marker.y, marker.floor)
    if place != true:
        ink = STYLES[marker.state].rim
        draw.line([true, place], fill=ink, width=2 * FINER)
        disc(draw, true, 3.0 * FINER, ink)
    if marker.chosen:
        paint_ring(draw, place, marker.radius)
    paint_disc(draw, place, marker.radius, marker.state, marker.name)


def _draw_name(draw: ImageDraw.ImageDraw, spots: Spots, station: Station, place: Pixel) -> None:
    """The name of a station on a plate where it covers nothing."""
    face = font(12)
    wide, high = draw.textlength(station.name, font=face) / 2 + 5.0 * FINER, 9.0 * FINER
    x, y = spots.beside(place, wide, high, station.floor)
    box = (x - wide, y - high, x + wide, y + high)
    draw.rounded_rectangle(box, 4 * FINER, fill=PAPER, outline=INK, width=FINER)
    draw.text((x, y), station.name, fill=INK, font=face, anchor="mm")
