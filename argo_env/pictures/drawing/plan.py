"""Pictures of episodes: floor plans with the checkpoints, the path and the robot."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import ImageDraw

from argo_env.pictures.drawing.label_placement import LabelPlacer, draw_plate
from argo_env.pictures.drawing.path import (
    PathPoint,
    draw_any_stairs_taken,
    draw_lines_with_arrows,
    path_lines,
)
from argo_env.pictures.drawing.sheet import FINER, FloorSheet, Pixel
from argo_env.pictures.drawing.style import (
    POINT,
    STYLES,
    LegendContent,
    draw_disc,
    draw_headline,
    draw_legend,
    paint_checkpoint,
    paint_point_robot,
    paint_ring,
    paint_robot,
    paint_station,
)
from argo_env.robot.spec import Footprint

_SHORTEST = 17.0  # px, smallest length of the robot
_STATION = 7.0  # px from the middle of a station's mark to its sides


@dataclass(frozen=True)
class Marker:
    """A checkpoint; `state` is a key of STYLES."""

    x: float
    y: float
    floor: int
    name: str
    state: str
    radius: float = 10.0
    """radius of its disc in px"""
    chosen: bool = False
    """True if the last action chose it"""


@dataclass(frozen=True)
class StationMark:
    """A position where the robot starts, ends or charges."""

    x: float
    y: float
    floor: int
    name: str


@dataclass(frozen=True)
class PlanDrawing:
    """Content of a picture."""

    headline: str
    markers: Sequence[Marker]
    stations: Sequence[StationMark]
    path: Sequence[PathPoint]
    """path up to the robot's present position"""
    heading: float
    """heading of the robot in rad"""
    footprint: Footprint | None
    """footprint of the robot; None for a robot without extent"""
    legend: Mapping[str, str]
    """meanings of the states of markers"""


def draw_plan(sheet: FloorSheet, plan: PlanDrawing) -> NDArray[np.uint8]:
    """Return the picture of an episode on floor plans: red, green, blue, shape (720, 1280, 3)."""
    image = sheet.image.copy()
    draw = ImageDraw.Draw(image)
    labels = LabelPlacer(sheet)
    stations = [sheet.pixel_at(s.x, s.y, s.floor) for s in plan.stations]
    for position in stations:
        labels.occupy(position, (_STATION + 1.0) * FINER, (_STATION + 1.0) * FINER)
    now, scale, reach = plan.path[-1], sheet.scale, POINT * FINER
    robot = sheet.pixel_at(now.x, now.y, now.floor)
    if plan.footprint:
        front, rear = plan.footprint.front, plan.footprint.rear
        scale = max(scale, _SHORTEST * FINER / (front + rear))
        reach = max(front, rear) * scale
    labels.occupy(robot, reach, reach)
    discs = [_place_disc(sheet, labels, marker) for marker in plan.markers]
    path = path_lines(sheet, plan.path)
    for line in path:
        labels.avoid_path_if_possible(line.points)
    draw_lines_with_arrows(draw, path)
    for position in stations:
        paint_station(draw, position, _STATION)
    for marker, position in zip(plan.markers, discs, strict=True):
        _draw_pointer(draw, sheet, marker, position)
    if plan.footprint:
        paint_robot(draw, robot, plan.footprint, scale, plan.heading)
    else:
        paint_point_robot(draw, robot)
    stairs = draw_any_stairs_taken(draw, sheet, labels, plan.path)
    for marker, position in zip(plan.markers, discs, strict=True):
        if marker.chosen:
            paint_ring(draw, position, marker.radius)
        paint_checkpoint(draw, position, marker.radius, marker.state, marker.name)
    for station, position in zip(plan.stations, stations, strict=True):
        draw_plate(draw, labels, position, station.name, station.floor, large=True)
    draw_headline(draw, plan.headline)
    present = {marker.state for marker in plan.markers}
    states = {state: meaning for state, meaning in plan.legend.items() if state in present}
    chosen = any(marker.chosen for marker in plan.markers)
    end = now.t if path else None
    draw_legend(draw, sheet, LegendContent(states, chosen, plan.footprint, stairs, end))
    return np.asarray(image.reduce(FINER), dtype=np.uint8)


def _place_disc(sheet: FloorSheet, labels: LabelPlacer, marker: Marker) -> Pixel:
    """Return the position of a checkpoint's disc: on it, or beside it where something else is."""
    size = (marker.radius + 1.0) * FINER
    return labels.reserve_nearest(
        sheet.pixel_at(marker.x, marker.y, marker.floor), size, size, marker.floor
    )


def _draw_pointer(
    draw: ImageDraw.ImageDraw, sheet: FloorSheet, marker: Marker, position: Pixel
) -> None:
    """Draw a line from a disc that is beside its checkpoint to the checkpoint."""
    true = sheet.pixel_at(marker.x, marker.y, marker.floor)
    if position != true:
        ink = STYLES[marker.state].rim
        draw.line([true, position], fill=ink, width=2 * FINER)
        draw_disc(draw, true, 3.0 * FINER, ink)
