"""Placement of labels in a picture, so that they cover neither each other nor what they name."""

import math

import numpy as np
from numpy.typing import NDArray
from PIL import ImageDraw

from argo_env.pictures.drawing.sheet import FINER, INK, PAPER, SIZE, SOFT, FloorSheet, Pixel, font

_CELL = 4  # px of the enlarged picture
_AROUND = 8  # directions that are tried
_STEP = 6.0 * FINER  # px farther out when all directions are occupied
_TRIES = 16


class LabelPlacer:
    """Placement of labels on a sheet.

    It holds the occupied area and the robot's path. Positions are those of the middle of a label,
    in px of the enlarged picture (see `FINER`); so are `half_width` and `half_height`, which are
    half of its width and of its height.
    """

    def __init__(self, sheet: FloorSheet) -> None:
        self._sheet = sheet
        shape = SIZE[1] * FINER // _CELL, SIZE[0] * FINER // _CELL
        self._taken = np.zeros(shape, np.bool_)
        self._path = np.zeros(shape, np.bool_)

    def occupy(self, position: Pixel, half_width: float, half_height: float) -> None:
        """Mark a rectangle about a position as occupied.

        The rectangle extends `half_width` to each side, and `half_height` up and down, in px of the
        enlarged picture, as `position`.
        """
        self._taken[_cells(position, half_width, half_height)] = True

    def avoid_path_if_possible(self, points: NDArray[np.float64]) -> None:
        """Add points of the path, shape (n, 2), which labels avoid as far as possible."""
        columns, rows = (points / _CELL).astype(np.int64).T
        height, width = self._path.shape
        self._path[rows.clip(0, height - 1), columns.clip(0, width - 1)] = True

    def reserve_nearest(
        self, position: Pixel, half_width: float, half_height: float, floor: int
    ) -> Pixel:
        """Return `position` if a label fits there, else a position beside it; mark it as occupied.

        A label fits where the rectangle about the position, `half_width` px to each side and
        `half_height` px up and down, is free.
        """
        if self._taken[_cells(position, half_width, half_height)].any():
            return self.reserve_beside(
                position, half_width, half_height, floor, min(half_width, half_height)
            )
        self.occupy(position, half_width, half_height)
        return position

    def reserve_beside(
        self,
        position: Pixel,
        half_width: float,
        half_height: float,
        floor: int,
        away: float = 10.0 * FINER,
    ) -> Pixel:
        """Return a free position, `away` px or more beside `position`, and mark it as occupied.

        It lies in the panel of the floor, near `position`, and preferably not on the robot's path.
        If no position that is tried is free, an occupied one is returned.
        """
        tried = []
        for k in range(_AROUND * _TRIES):
            out = away + _STEP * (k // _AROUND)
            turn = 2 * math.pi * (k % _AROUND) / _AROUND
            spot = (
                position[0] + (out + half_width) * math.cos(turn),
                position[1] - (out + half_height) * math.sin(turn),
            )
            if self._inside(spot, half_width, half_height, floor):
                cells = _cells(spot, half_width, half_height)
                # Covering the path is as bad as being three steps farther out.
                worse = 3 * _AROUND * bool(self._path[cells].any())
                tried.append((bool(self._taken[cells].any()), k + worse, spot))
                if tried[-1][:2] == (False, k):
                    break
        _, _, best = min(tried, default=(True, 0, position))
        self.occupy(best, half_width, half_height)
        return best

    def _inside(self, position: Pixel, half_width: float, half_height: float, floor: int) -> bool:
        panel = self._sheet.panels[floor]
        x, y = position
        return (
            panel.left <= x - half_width
            and x + half_width <= panel.left + panel.width
            and panel.top <= y - half_height
            and y + half_height <= panel.top + panel.height
        )


def draw_plate(
    draw: ImageDraw.ImageDraw,
    labels: LabelPlacer,
    position: Pixel,
    text: str,
    floor: int,
    large: bool = False,
) -> None:
    """Draw a text on a plate beside a position, where it covers no other mark if possible.

    The plate lies in the panel of the floor, and its area is then occupied in `labels`.
    """
    size, rim = (12, INK) if large else (11, SOFT)
    face = font(size)
    half_width = draw.textlength(text, font=face) / 2 + (size - 7.0) * FINER
    half_height = (size - 3.0) * FINER
    x, y = labels.reserve_beside(position, half_width, half_height, floor)
    box = (x - half_width, y - half_height, x + half_width, y + half_height)
    draw.rounded_rectangle(box, (size - 8) * FINER, fill=PAPER, outline=rim, width=FINER)
    draw.text((x, y), text, fill=INK, font=face, anchor="mm")


def _cells(position: Pixel, half_width: float, half_height: float) -> tuple[slice, slice]:
    x, y = position
    return (
        slice(max(0, int((y - half_height) / _CELL)), int((y + half_height) / _CELL) + 1),
        slice(max(0, int((x - half_width) / _CELL)), int((x + half_width) / _CELL) + 1),
    )
