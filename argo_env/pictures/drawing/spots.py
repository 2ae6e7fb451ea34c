"""Where labels go in a picture, so that they cover neither one another nor what they name."""

import math

import numpy as np
from numpy.typing import NDArray
from PIL import ImageDraw

from argo_env.pictures.drawing.sheet import FINER, INK, PAPER, SIZE, SOFT, FloorSheet, Pixel, font

_CELL = 4  # px of the finer picture
_AROUND = 8  # directions that are tried
_STEP = 6.0 * FINER  # px farther out when all are taken
_TRIES = 16


class Spots:
    """Knows what is taken of a sheet. Holds what was placed, and where the way is."""

    def __init__(self, sheet: FloorSheet) -> None:
        self._sheet = sheet
        shape = SIZE[1] * FINER // _CELL, SIZE[0] * FINER // _CELL
        self._taken = np.zeros(shape, np.bool_)
        self._way = np.zeros(shape, np.bool_)

    def take(self, place: Pixel, wide: float, high: float) -> None:
        """Something is at a place, so far to the sides, and up and down (px)."""
        self._taken[_cells(place, wide, high)] = True

    def pass_by(self, points: NDArray[np.float64]) -> None:
        """The way is there, shape (n, 2); labels go elsewhere as far as they can."""
        columns, rows = (points / _CELL).astype(np.int64).T
        height, width = self._way.shape
        self._way[rows.clip(0, height - 1), columns.clip(0, width - 1)] = True

    def nearest(self, place: Pixel, wide: float, high: float, floor: int) -> Pixel:
        """The place itself if it is free, else one beside it; it is taken then."""
        if self._taken[_cells(place, wide, high)].any():
            return self.beside(place, wide, high, floor, min(wide, high))
        self.take(place, wide, high)
        return place

    def beside(
        self, place: Pixel, wide: float, high: float, floor: int, away: float = 10.0 * FINER
    ) -> Pixel:
        """A place beside it, `away` px at least, that is free; it is taken then."""
        tried = []
        for k in range(_AROUND * _TRIES):
            out = away + _STEP * (k // _AROUND)
            turn = 2 * math.pi * (k % _AROUND) / _AROUND
            spot = (
                place[0] + (out + wide) * math.cos(turn),
                place[1] - (out + high) * math.sin(turn),
            )
            if self._inside(spot, wide, high, floor):
                cells = _cells(spot, wide, high)
                # What covers the way is as bad as what is three rounds farther out.
                worse = 3 * _AROUND * bool(self._way[cells].any())
                tried.append((bool(self._taken[cells].any()), k + worse, spot))
                if tried[-1][:2] == (False, k):
                    break
        _, _, best = min(tried, default=(True, 0, place))
        self.take(best, wide, high)
        return best

    def _inside(self, place: Pixel, wide: float, high: float, floor: int) -> bool:
        panel = self._sheet.panels[floor]
        x, y = place
        return (
            panel.left <= x - wide
            and x + wide <= panel.left + panel.width
            and panel.top <= y - high
            and y + high <= panel.top + panel.height
        )


def draw_plate(
    draw: ImageDraw.ImageDraw,
    spots: Spots,
    place: Pixel,
    text: str,
    floor: int,
    large: bool = False,
) -> None:
    """A name on a plate beside a place, where it covers nothing."""
    size, rim = (12, INK) if large else (11, SOFT)
    face = font(size)
    wide = draw.textlength(text, font=face) / 2 + (size - 7.0) * FINER
    high = (size - 3.0) * FINER
    x, y = spots.beside(place, wide, high, floor)
    box = (x - wide, y - high, x + wide, y + high)
    draw.rounded_rectangle(box, (size - 8) * FINER, fill=PAPER, outline=rim, width=FINER)
    draw.text((x, y), text, fill=INK, font=face, anchor="mm")


def _cells(place: Pixel, wide: float, high: float) -> tuple[slice, slice]:
    x, y = place
    return (
        slice(max(0, int((y - high) / _CELL)), int((y + high) / _CELL) + 1),
        slice(max(0, int((x - wide) / _CELL)), int((x + wide) / _CELL) + 1),
    )
