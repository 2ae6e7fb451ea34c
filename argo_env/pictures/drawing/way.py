"""The robot's way on a sheet: lines that are coloured by time, and where stairs were taken."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise

import numpy as np
from numpy.typing import NDArray
from PIL import ImageDraw

from argo_env.pictures.drawing.sheet import FINER, PAPER, FloorSheet
from argo_env.pictures.drawing.spots import Spots
from argo_env.pictures.drawing.style import STAIRS, disc, paint_stairs, turned
from argo_env.report.track import SHADES, colour

_WIDTH = 3.0  # px
_ASIDE = 2.2  # px to the right of where it was driven, so that the way back is seen beside it
_SPACING = 8.0  # px of the finer picture between the points of a line
_HEADS = 56.0  # px of way between two heads
_HEAD = ((-4.5, -4.5), (5.5, 0.0), (-4.5, 4.5))
_SAME_STAIRS = 1.5  # m within which two crossings are one mark


@dataclass(frozen=True)
class Moment:
    """Where the robot was."""

    t: float
    """s"""
    x: float
    """m"""
    y: float
    """m"""
    floor: int


@dataclass(frozen=True)
class Line:
    """An unbroken part of the way on one floor, in points at equal distances."""

    points: NDArray[np.float64]
    """px of the finer picture, shape (n, 2), n > 1"""
    along: NDArray[np.float64]
    """unit vectors, shape (n, 2)"""
    shades: NDArray[np.int64]
    """by time, 0 to SHADES - 1, shape (n,)"""


def lines(sheet: FloorSheet, way: Sequence[Moment]) -> list[Line]:
    """The way as it is drawn, on the floors that the sheet has."""
    made = []
    for floor, stretch in groupby(way, key=lambda moment: moment.floor):
        if floor not in sheet.panels:
            continue
        moments = list(stretch)
        points = np.array([sheet.at(m.x, m.y, m.floor) for m in moments])
        times = np.array([m.t for m in moments])
        gone = np.concatenate([[0.0], np.hypot(*np.diff(points, axis=0).T).cumsum()])
        if gone[-1] < 1.0:
            continue
        at = np.linspace(0.0, gone[-1], math.ceil(gone[-1] / _SPACING) + 1)
        points = np.column_stack([np.interp(at, gone, axis) for axis in points.T])
        along = np.gradient(points, axis=0)
        along /= np.maximum(np.hypot(*along.T), 1e-9)[:, None]
        aside = np.column_stack([-along[:, 1], along[:, 0]])
        shades = SHADES * np.interp(at, gone, times) / (way[-1].t or 1.0)
        shades = np.minimum(shades.astype(np.int64), SHADES - 1)
        made.append(Line(points + _ASIDE * FINER * aside, along, shades))
    return made


def draw_lines(draw: ImageDraw.ImageDraw, way: Sequence[Line]) -> None:
    """The lines with a white rim, and heads that tell the direction."""
    wide = round(_WIDTH * FINER)
    for line in way:
        _stroke(draw, line.points, wide + 2 * FINER, PAPER)
    for line in way:
        cuts = np.flatnonzero(np.diff(line.shades)) + 1
        for first, last in pairwise([0, *cuts.tolist(), len(line.shades)]):
            _stroke(draw, line.points[first : last + 1], wide, _ink(line.shades[first]))
    step = round(_HEADS * FINER / _SPACING)
    for line in way:
        for k in range(min(step, len(line.points)) // 2, len(line.points), step):
            x, y = line.points[k].tolist()
            turn = math.atan2(line.along[k, 1], line.along[k, 0])
            draw.polygon(turned(_HEAD, (x, y), turn, 1.4 * FINER), fill=PAPER)
            draw.polygon(turned(_HEAD, (x, y), turn, FINER), fill=_ink(line.shades[k]))


def draw_thin(draw: ImageDraw.ImageDraw, way: Sequence[Line], ink: tuple[int, int, int]) -> None:
    """The lines thin and in one colour, for what is only compared with."""
    for line in way:
        _stroke(draw, line.points, round(1.2 * FINER), ink)


def draw_crossings(
    draw: ImageDraw.ImageDraw, sheet: FloorSheet, spots: Spots, way: Sequence[Moment]
) -> bool:
    """A mark where stairs were taken, with the floor that they connect to; whether any were, on the
    floors that the sheet has."""
    marked: list[tuple[Moment, int, str]] = []
    for here, other, ink in _crossings(way):
        if here.floor in sheet.panels and not any(
            _same(here, other, one, to) for one, to, _ in marked
        ):
            marked.append((here, other, ink))
    places = []
    for here, _, ink in marked:
        true = sheet.at(here.x, here.y, here.floor)
        place = spots.beside(true, STAIRS[0] * FINER, STAIRS[1] * FINER, here.floor)
        places.append(place)
        draw.line([true, place], fill=ink, width=round(1.5 * FINER))
        disc(draw, true, 4.0 * FINER, PAPER)
        disc(draw, true, 3.0 * FINER, ink)
    for (here, other, ink), place in zip(marked, places, strict=True):
        paint_stairs(draw, place, other, other > here.floor, ink)
    return bool(marked)


def _crossings(way: Sequence[Moment]) -> Iterator[tuple[Moment, int, str]]:
    """Where the way leaves a floor and where it comes to one, the other floor, and the colour."""
    end = way[-1].t or 1.0
    for a, b in pairwise(way):
        if a.floor != b.floor:
            yield a, b.floor, colour(a.t / end)
            yield b, a.floor, colour(b.t / end)


def _same(here: Moment, other: int, one: Moment, to: int) -> bool:
    apart = math.dist((here.x, here.y), (one.x, one.y))
    return (here.floor, other) == (one.floor, to) and apart < _SAME_STAIRS


def _ink(shade: int) -> str:
    return colour(float(shade) / (SHADES - 1))


def _stroke(
    draw: ImageDraw.ImageDraw,
    points: NDArray[np.float64],
    width: int,
    ink: str | tuple[int, int, int],
) -> None:
    """A line with round ends."""
    corners = [(x, y) for x, y in points.tolist()]
    draw.line(corners, fill=ink, width=width, joint="curve")
    for end in (corners[0], corners[-1]):
        disc(draw, end, width / 2 - 0.5, ink)
