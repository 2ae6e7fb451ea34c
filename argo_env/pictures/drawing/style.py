"""Styles of marks on a plan, the headline of a picture, its legend and its scales."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from PIL import ImageDraw

from argo_env.pictures.drawing.sheet import (
    FINER,
    FOOT,
    HEAD,
    INK,
    PAPER,
    SIZE,
    SOFT,
    FloorSheet,
    Pixel,
    font,
)
from argo_env.report.svg import shorten
from argo_env.report.track import colour
from argo_env.robot.spec import Footprint

Ink = str | tuple[int, int, int]

ROBOT = (29, 78, 216)
POINT = 8.0
"""distance in px from the middle to the corners of the mark of a robot without extent"""
STAIRS = (15.0, 8.0)
"""half of the width and of the height in px of the mark of stairs"""


@dataclass(frozen=True)
class Style:
    """Colours of a checkpoint's disc."""

    fill: str
    rim: str
    text: str
    struck: bool = False
    """True if a line goes through the disc"""


STYLES = {
    "open": Style("#fbbf24", "#92400e", "#1c2733"),
    "waiting": Style("#ffffff", "#b45309", "#1c2733"),
    "done": Style("#15803d", "#0b4a23", "#ffffff"),
    "abnormal": Style("#c81e1e", "#6f0f0f", "#ffffff"),
    "closed": Style("#cbd2d9", "#64707c", "#3c4854", struck=True),
    "outside": Style("#f8f9fa", "#b4bdc6", "#97a2ad"),
}
"""styles by the state of the checkpoint, with different lightness, for prints without colour"""


def paint_checkpoint(
    draw: ImageDraw.ImageDraw, position: Pixel, radius: float, state: str, name: str
) -> None:
    """Draw the disc of a checkpoint with its name, in the style of its state (see `STYLES`).

    `radius` is in px of the reduced picture, `position` in px of the enlarged one.
    """
    (x, y), r, style = position, radius * FINER, STYLES[state]
    draw.ellipse((x - r, y - r, x + r, y + r), style.fill, style.rim, round(1.5 * FINER))
    if style.struck:
        half = 0.7 * r
        draw.line((x - half, y + half, x + half, y - half), "#98a2ac", round(1.5 * FINER))
    size = min(13.0, 1.25 * radius) * min(1.0, 2.4 / max(len(name), 1))
    draw.text((x, y), name, style.text, font(size), "mm")


def paint_station(draw: ImageDraw.ImageDraw, position: Pixel, half: float) -> None:
    """Draw the square of a station; `half` is half its side in px of the reduced picture."""
    (x, y), r = position, half * FINER
    draw.rectangle((x - r, y - r, x + r, y + r), fill=INK, outline=PAPER, width=FINER)


def paint_ring(draw: ImageDraw.ImageDraw, position: Pixel, radius: float) -> None:
    """Draw a ring about the disc of a chosen checkpoint.

    `radius` is that of the disc, in px of the reduced picture.
    """
    for wider, ink in ((5.0, PAPER), (4.5, ROBOT), (1.5, PAPER)):
        draw_disc(draw, position, (radius + wider) * FINER, ink)


def paint_robot(
    draw: ImageDraw.ImageDraw, position: Pixel, footprint: Footprint, scale: float, heading: float
) -> None:
    """Draw the robot's footprint with its front.

    `scale` is in px of the enlarged picture for 1 m, `heading` in rad, counter-clockwise in the
    picture from its x axis.
    """
    front, rear, wide = (scale * v for v in (footprint.front, footprint.rear, footprint.half_width))
    for rim, ink in ((1.5 * FINER, PAPER), (0.0, ROBOT)):
        x0, x1, y = -rear - rim, front + rim, wide + rim
        body = ((x0, -y), (x1, -y), (x1, y), (x0, y))
        draw.polygon(rotate_shape(body, position, -heading), fill=ink)
    nose = ((0.1 * front, -0.6 * wide), (0.75 * front, 0.0), (0.1 * front, 0.6 * wide))
    draw.polygon(rotate_shape(nose, position, -heading), fill=PAPER)


def paint_point_robot(draw: ImageDraw.ImageDraw, position: Pixel) -> None:
    """Draw a diamond, which stands for a robot without extent."""
    for share, ink in ((1.3, PAPER), (1.0, ROBOT), (0.4, PAPER)):
        r = share * POINT * FINER
        draw.polygon(
            rotate_shape(((-r, 0.0), (0.0, -r), (r, 0.0), (0.0, r)), position, 0.0), fill=ink
        )


def paint_stairs(
    draw: ImageDraw.ImageDraw, position: Pixel, to_floor: int, up: bool, ink: Ink
) -> None:
    """Draw the mark of stairs to the floor with this number, with an arrow up or down."""
    x, y = position
    wide, high = STAIRS[0] * FINER, STAIRS[1] * FINER
    draw.rounded_rectangle((x - wide, y - high, x + wide, y + high), high, fill=ink)
    rise = -4.5 * FINER if up else 4.5 * FINER
    arrow = [(x - 11 * FINER, y - rise), (x - 1 * FINER, y - rise), (x - 6 * FINER, y + rise)]
    draw.polygon(arrow, fill=PAPER)
    draw.text((x + 6.5 * FINER, y), str(to_floor), fill=PAPER, font=font(12), anchor="mm")


def draw_disc(draw: ImageDraw.ImageDraw, position: Pixel, r: float, ink: Ink) -> None:
    """Draw a disc; `r` in px of the enlarged picture."""
    x, y = position
    draw.ellipse((x - r, y - r, x + r, y + r), fill=ink)


def rotate_shape(
    shape: Sequence[Pixel], position: Pixel, turn: float, scale: float = 1.0
) -> list[Pixel]:
    """Return the shape about (0, 0), turned by `turn` (rad, clockwise in the picture) and moved.

    `position` is where its origin is moved, `scale` the factor of its size.
    """
    cos, sin = scale * math.cos(turn), scale * math.sin(turn)
    return [(position[0] + cos * x - sin * y, position[1] + sin * x + cos * y) for x, y in shape]


_ROBOT = 18.0 * FINER  # px long
_LEFT = 16.0 * FINER
_BAR = 90.0 * FINER  # px, length of the time scale
_BARS = (1, 2, 5, 10, 20, 50)
"""possible lengths of the length scale in m"""
_LONGEST = 110.0 * FINER  # px, greatest length of the length scale


@dataclass(frozen=True)
class LegendContent:
    """Things in a picture that the legend explains."""

    states: Mapping[str, str]
    """states of checkpoints, and their meanings"""
    chosen: bool
    """True if a checkpoint was chosen last"""
    footprint: Footprint | None
    """footprint of the robot; None for a robot without extent"""
    stairs: bool
    """True if the picture marks where the robot took stairs"""
    end: float | None
    """time at the end of the path in s; None without a path"""


def draw_headline(draw: ImageDraw.ImageDraw, text: str) -> None:
    """Draw the text above the floors, shortened until it fits."""
    face, room = font(16), SIZE[0] * FINER - 2 * _LEFT
    while draw.textlength(text, font=face) > room:
        text = shorten(text, len(text) - 1)
    draw.text((_LEFT, HEAD * FINER / 2), text, fill=INK, font=face, anchor="lm")


def draw_legend(draw: ImageDraw.ImageDraw, sheet: FloorSheet, content: LegendContent) -> None:
    """Draw the legend of states and marks, and the scales of time and length."""
    x, y = _LEFT, (SIZE[1] - FOOT / 2) * FINER
    for state, meaning in content.states.items():
        paint_checkpoint(draw, (x + 7 * FINER, y), 7.0, state, "")
        x = _draw_entry(draw, meaning, x + 19 * FINER, y)
    if content.chosen:
        paint_ring(draw, (x + 7 * FINER, y), 4.0)
        x = _draw_entry(draw, "chosen last", x + 20 * FINER, y)
    if content.footprint:
        length = content.footprint.front + content.footprint.rear
        paint_robot(draw, (x + 9 * FINER, y), content.footprint, _ROBOT / length, 0.0)
    else:
        paint_point_robot(draw, (x + POINT * FINER, y))
    x = _draw_entry(draw, "robot", x + 22 * FINER, y)
    if content.stairs:
        paint_stairs(draw, (x + STAIRS[0] * FINER, y), 2, True, colour(0.5))
        _draw_entry(draw, "stairs taken", x + (2 * STAIRS[0] + 4) * FINER, y)
    right = draw_length_scale(draw, sheet, SIZE[0] * FINER - _LEFT, y) - 22 * FINER
    if content.end is not None:
        _draw_time_scale(draw, right, y, content.end)


def _draw_entry(draw: ImageDraw.ImageDraw, text: str, x: float, y: float) -> float:
    """Draw the text, and return the x at which the next entry begins."""
    face = font(12)
    draw.text((x, y), text, fill=SOFT, font=face, anchor="lm")
    return x + draw.textlength(text, font=face) + 14 * FINER


def draw_length_scale(
    draw: ImageDraw.ImageDraw, sheet: FloorSheet, right: float, y: float
) -> float:
    """Draw a bar of some metres, up to x = `right`, after its text; return the text's left x."""
    metres = max((m for m in _BARS if m * sheet.scale <= _LONGEST), default=_BARS[0])
    left, tick, face = right - metres * sheet.scale, 4 * FINER, font(12)
    bar = [(left, y - tick), (left, y + tick), (left, y), (right, y), (right, y - tick)]
    draw.line([*bar, (right, y + tick)], fill=INK, width=round(1.5 * FINER))
    text = f"{metres} m"
    draw.text((left - 6 * FINER, y), text, fill=INK, font=face, anchor="rm")
    return left - 6 * FINER - draw.textlength(text, font=face)


def _draw_time_scale(draw: ImageDraw.ImageDraw, right: float, y: float, end: float) -> None:
    """Draw the scale of the path's colours, from 0 s to `end` (s)."""
    face, text = font(12), f"{end:.0f} s"
    draw.text((right, y), text, fill=SOFT, font=face, anchor="rm")
    right -= draw.textlength(text, font=face) + 6 * FINER
    left, half = right - _BAR, 3 * FINER
    for k in range(round(_BAR)):
        draw.line((left + k, y - half, left + k, y + half), fill=colour(k / _BAR))
    draw.text((left - 6 * FINER, y), "path  0 s", fill=SOFT, font=face, anchor="rm")
