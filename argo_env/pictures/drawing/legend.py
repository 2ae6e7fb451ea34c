"""The headline of a picture, and the legend and scales below it."""

from collections.abc import Mapping
from dataclasses import dataclass

from PIL import ImageDraw

from argo_env.pictures.drawing.sheet import FINER, FOOT, HEAD, INK, SIZE, SOFT, FloorSheet, font
from argo_env.pictures.drawing.style import (
    POINT,
    STAIRS,
    paint_disc,
    paint_point,
    paint_ring,
    paint_robot,
    paint_stairs,
)
from argo_env.report.svg import shorten
from argo_env.report.track import colour
from argo_env.robot.spec import Footprint

_ROBOT = 18.0 * FINER  # px long
_LEFT = 16.0 * FINER
_BAR = 90.0 * FINER  # px long, of times
_BARS = (1, 2, 5, 10, 20, 50)
"""m"""
_LONGEST = 110.0 * FINER  # px of the bar of lengths


@dataclass(frozen=True)
class Shown:
    """What there is in a picture that has to be explained."""

    states: Mapping[str, str]
    """of checkpoints, and what they mean"""
    chosen: bool
    """whether one was chosen last"""
    footprint: Footprint | None
    """of the robot; None: it is a point"""
    stairs: bool
    """whether any were taken"""
    end: float | None
    """s, the time of the end of the way; None: there is no way"""


def draw_headline(draw: ImageDraw.ImageDraw, text: str) -> None:
    """The text above the floors, cut to what fits."""
    face, room = font(16), SIZE[0] * FINER - 2 * _LEFT
    while draw.textlength(text, font=face) > room:
        text = shorten(text, len(text) - 1)
    draw.text((_LEFT, HEAD * FINER / 2), text, fill=INK, font=face, anchor="lm")


def draw_legend(draw: ImageDraw.ImageDraw, sheet: FloorSheet, shown: Shown) -> None:
    """What the states and marks mean, and the scales of time and length."""
    x, y = _LEFT, (SIZE[1] - FOOT / 2) * FINER
    for state, meaning in shown.states.items():
        paint_disc(draw, (x + 7 * FINER, y), 7.0, state, "")
        x = _word(draw, meaning, x + 19 * FINER, y)
    if shown.chosen:
        paint_ring(draw, (x + 7 * FINER, y), 4.0)
        x = _word(draw, "chosen last", x + 20 * FINER, y)
    if shown.footprint:
        length = shown.footprint.front + shown.footprint.rear
        paint_robot(draw, (x + 9 * FINER, y), shown.footprint, _ROBOT / length, 0.0)
    else:
        paint_point(draw, (x + POINT * FINER, y))
    x = _word(draw, "robot", x + 22 * FINER, y)
    if shown.stairs:
        paint_stairs(draw, (x + STAIRS[0] * FINER, y), 2, True, colour(0.5))
        _word(draw, "stairs taken", x + (2 * STAIRS[0] + 4) * FINER, y)
    right = draw_length(draw, sheet, SIZE[0] * FINER - _LEFT, y) - 22 * FINER
    if shown.end is not None:
        _times(draw, right, y, shown.end)


def _word(draw: ImageDraw.ImageDraw, text: str, x: float, y: float) -> float:
    """Writes it; where the next entry begins."""
    face = font(12)
    draw.text((x, y), text, fill=SOFT, font=face, anchor="lm")
    return x + draw.textlength(text, font=face) + 14 * FINER


def draw_length(draw: ImageDraw.ImageDraw, sheet: FloorSheet, right: float, y: float) -> float:
    """A bar of some m that ends at the right; where it begins."""
    metres = max((m for m in _BARS if m * sheet.scale <= _LONGEST), default=_BARS[0])
    left, tick, face = right - metres * sheet.scale, 4 * FINER, font(12)
    bar = [(left, y - tick), (left, y + tick), (left, y), (right, y), (right, y - tick)]
    draw.line([*bar, (right, y + tick)], fill=INK, width=round(1.5 * FINER))
    text = f"{metres} m"
    draw.text((left - 6 * FINER, y), text, fill=INK, font=face, anchor="rm")
    return left - 6 * FINER - draw.textlength(text, font=face)


def _times(draw: ImageDraw.ImageDraw, right: float, y: float, end: float) -> None:
    """The colours of the way from its start to now."""
    face, text = font(12), f"{end:.0f} s"
    draw.text((right, y), text, fill=SOFT, font=face, anchor="rm")
    right -= draw.textlength(text, font=face) + 6 * FINER
    left, half = right - _BAR, 3 * FINER
    for k in range(round(_BAR)):
        draw.line((left + k, y - half, left + k, y + half), fill=colour(k / _BAR))
    draw.text((left - 6 * FINER, y), "way  0 s", fill=SOFT, font=face, anchor="rm")
