"""The robot's path on a sheet: lines coloured by time, and marks where stairs were taken."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise

import numpy as np
from numpy.typing import NDArray
from PIL import ImageDraw

from argo_env.pictures.drawing.label_placement import LabelPlacer
from argo_env.pictures.drawing.sheet import FINER, PAPER, FloorSheet
from argo_env.pictures.drawing.style import STAIRS, draw_disc, paint_stairs, rotate_shape
from argo_env.report.track import SHADES, colour

_WIDTH = 3.0  # px
_ASIDE = 2.2  # px to the right of the driven path, so that the path back is visible beside it
_SPACING = 8.0  # px of the enlarged picture between the points of a line
_HEADS = 56.0  # px of the path between two arrow heads
_HEAD = ((-4.5, -4.5), (5.5, 0.0), (-4.5, 4.5))
_SAME_STAIRS = 1.5  # m within which two changes of floor have one mark


@dataclass(frozen=True)
class PathPoint:
    """A position of the robot at a time."""

    t: float
    """time in s"""
    x: float
    """m"""
    y: float
    """m"""
    floor: int


@dataclass(frozen=True)
class PathLine:
    """An unbroken part of the path on one floor, in points at equal distances."""

    points: NDArray[np.float64]
    """pixels of the enlarged picture, shape (n, 2), n > 1"""
    along: NDArray[np.float64]
    """unit vectors of the direction, shape (n, 2)"""
    shades: NDArray[np.int64]
    """number of the colour, by time, 0 to SHADES - 1, shape (n,)"""


def path_lines(sheet: FloorSheet, path: Sequence[PathPoint]) -> list[PathLine]:
    """Return one line for each stretch of the path on one floor, for floors that the sheet has."""
    made = []
    for floor, stretch in groupby(path, key=lambda point: point.floor):
        if floor not in sheet.panels:
            continue
        part = list(stretch)
        points = np.array([sheet.pixel_at(m.x, m.y, m.floor) for m in part])
        times = np.array([m.t for m in part])
        distances = np.concatenate([[0.0], np.hypot(*np.diff(points, axis=0).T).cumsum()])
        if distances[-1] < 1.0:
            continue
        at = np.linspace(0.0, distances[-1], math.ceil(distances[-1] / _SPACING) + 1)
        points = np.column_stack([np.interp(at, distances, axis) for axis in points.T])
        along = np.gradient(points, axis=0)
        along /= np.maximum(np.hypot(*along.T), 1e-9)[:, None]
        aside = np.column_stack([-along[:, 1], along[:, 0]])
        shades = SHADES * np.interp(at, distances, times) / (path[-1].t or 1.0)
        shades = np.minimum(shades.astype(np.int64), SHADES - 1)
        made.append(PathLine(points + _ASIDE * FINER * aside, along, shades))
    return made


def draw_lines_with_arrows(draw: ImageDraw.ImageDraw, path: Sequence[PathLine]) -> None:
    """Draw the lines with a white rim, and arrow heads in their direction."""
    wide = round(_WIDTH * FINER)
    for line in path:
        _stroke(draw, line.points, wide + 2 * FINER, PAPER)
    for line in path:
        cuts = np.flatnonzero(np.diff(line.shades)) + 1
        for first, last in pairwise([0, *cuts.tolist(), len(line.shades)]):
            _stroke(draw, line.points[first : last + 1], wide, _ink(line.shades[first]))
    step = round(_HEADS * FINER / _SPACING)
    for line in path:
        for k in range(min(step, len(line.points)) // 2, len(line.points), step):
            x, y = line.points[k].tolist()
            turn = math.atan2(line.along[k, 1], line.along[k, 0])
            draw.polygon(rotate_shape(_HEAD, (x, y), turn, 1.4 * FINER), fill=PAPER)
            draw.polygon(rotate_shape(_HEAD, (x, y), turn, FINER), fill=_ink(line.shades[k]))


def draw_thin_lines(
    draw: ImageDraw.ImageDraw, path: Sequence[PathLine], ink: tuple[int, int, int]
) -> None:
    """Draw the lines thin and in one colour, for a path that is only compared with."""
    for line in path:
        _stroke(draw, line.points, round(1.2 * FINER), ink)


def draw_any_stairs_taken(
    draw: ImageDraw.ImageDraw, sheet: FloorSheet, labels: LabelPlacer, path: Sequence[PathPoint]
) -> bool:
    """Draw a mark at each position where the path changes floors, with the other floor's number.

    Returns:
        True if a mark was drawn: stairs are taken on a floor that the sheet has.
    """
    marked: list[tuple[PathPoint, int, str]] = []
    for here, other, ink in _floor_changes(path):
        if here.floor in sheet.panels and not any(
            _same(here, other, one, to) for one, to, _ in marked
        ):
            marked.append((here, other, ink))
    positions = []
    for here, _, ink in marked:
        true = sheet.pixel_at(here.x, here.y, here.floor)
        position = labels.reserve_beside(true, STAIRS[0] * FINER, STAIRS[1] * FINER, here.floor)
        positions.append(position)
        draw.line([true, position], fill=ink, width=round(1.5 * FINER))
        draw_disc(draw, true, 4.0 * FINER, PAPER)
        draw_disc(draw, true, 3.0 * FINER, ink)
    for (here, other, ink), position in zip(marked, positions, strict=True):
        paint_stairs(draw, position, other, other > here.floor, ink)
    return bool(marked)


def _floor_changes(path: Sequence[PathPoint]) -> Iterator[tuple[PathPoint, int, str]]:
    """Yield the points where the path leaves or reaches a floor, the other floor, and a colour."""
    end = path[-1].t or 1.0
    for a, b in pairwise(path):
        if a.floor != b.floor:
            yield a, b.floor, colour(a.t / end)
            yield b, a.floor, colour(b.t / end)


def _same(here: PathPoint, other: int, one: PathPoint, to: int) -> bool:
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
    """Draw a line with round ends."""
    corners = [(x, y) for x, y in points.tolist()]
    draw.line(corners, fill=ink, width=width, joint="curve")
    for end in (corners[0], corners[-1]):
        draw_disc(draw, end, width / 2 - 0.5, ink)
