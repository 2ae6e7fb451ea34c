"""How the things on a plan look."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from PIL import ImageDraw

from argo_env.pictures.drawing.sheet import FINER, INK, PAPER, Pixel, font
from argo_env.robot.spec import Footprint

Ink = str | tuple[int, int, int]

ROBOT = (29, 78, 216)
POINT = 8.0
"""px from the middle of the sign of a robot that is a point to its corners"""
STAIRS = (15.0, 8.0)
"""px from the middle of the mark of stairs to its sides, and to its top and bottom"""


@dataclass(frozen=True)
class Style:
    """The colours of a checkpoint's disc."""

    fill: str
    rim: str
    text: str
    struck: bool = False
    """whether a line goes through it"""


STYLES = {
    "open": Style("#fbbf24", "#92400e", "#1c2733"),
    "waiting": Style("#ffffff", "#b45309", "#1c2733"),
    "done": Style("#15803d", "#0b4a23", "#ffffff"),
    "abnormal": Style("#c81e1e", "#6f0f0f", "#ffffff"),
    "closed": Style("#cbd2d9", "#64707c", "#3c4854", struck=True),
    "outside": Style("#f8f9fa", "#b4bdc6", "#97a2ad"),
}
"""By the state of the checkpoint. They differ in lightness too, for prints without colour."""


def paint_disc(
    draw: ImageDraw.ImageDraw, place: Pixel, radius: float, state: str, name: str
) -> None:
    """The disc of a checkpoint with its number; `radius` in px of the picture."""
    (x, y), r, style = place, radius * FINER, STYLES[state]
    draw.ellipse((x - r, y - r, x + r, y + r), style.fill, style.rim, round(1.5 * FINER))
    if style.struck:
        half = 0.7 * r
        draw.line((x - half, y + half, x + half, y - half), "#98a2ac", round(1.5 * FINER))
    size = min(13.0, 1.25 * radius) * min(1.0, 2.4 / max(len(name), 1))
    draw.text((x, y), name, style.text, font(size), "mm")


def paint_station(draw: ImageDraw.ImageDraw, place: Pixel, half: float) -> None:
    """The square of a station; `half` of its side in px of the picture."""
    (x, y), r = place, half * FINER
    draw.rectangle((x - r, y - r, x + r, y + r), fill=INK, outline=PAPER, width=FINER)


def paint_ring(draw: ImageDraw.ImageDraw, place: Pixel, radius: float) -> None:
    """The ring about a checkpoint that was chosen; `radius` of its disc in px of the picture."""
    for wider, ink in ((5.0, PAPER), (4.5, ROBOT), (1.5, PAPER)):
        disc(draw, place, (radius + wider) * FINER, ink)


def paint_robot(
    draw: ImageDraw.ImageDraw, place: Pixel, footprint: Footprint, scale: float, heading: float
) -> None:
    """The robot's footprint with its front; `scale` in px of the finer picture for 1 m."""
    front, rear, wide = (scale * v for v in (footprint.front, footprint.rear, footprint.half_width))
    for rim, ink in ((1.5 * FINER, PAPER), (0.0, ROBOT)):
        x0, x1, y = -rear - rim, front + rim, wide + rim
        body = ((x0, -y), (x1, -y), (x1, y), (x0, y))
        draw.polygon(turned(body, place, -heading), fill=ink)
    nose = ((0.1 * front, -0.6 * wide), (0.75 * front, 0.0), (0.1 * front, 0.6 * wide))
    draw.polygon(turned(nose, place, -heading), fill=PAPER)


def paint_point(draw: ImageDraw.ImageDraw, place: Pixel) -> None:
    """The sign of a robot that is a point: a diamond."""
    for share, ink in ((1.3, PAPER), (1.0, ROBOT), (0.4, PAPER)):
        r = share * POINT * FINER
        draw.polygon(turned(((-r, 0.0), (0.0, -r), (r, 0.0), (0.0, r)), place, 0.0), fill=ink)


def paint_stairs(draw: ImageDraw.ImageDraw, place: Pixel, floor: int, up: bool, ink: Ink) -> None:
    """The mark of stairs to a floor above or below."""
    x, y = place
    wide, high = STAIRS[0] * FINER, STAIRS[1] * FINER
    draw.rounded_rectangle((x - wide, y - high, x + wide, y + high), high, fill=ink)
    rise = -4.5 * FINER if up else 4.5 * FINER
    arrow = [(x - 11 * FINER, y - rise), (x - 1 * FINER, y - rise), (x - 6 * FINER, y + rise)]
    draw.polygon(arrow, fill=PAPER)
    draw.text((x + 6.5 * FINER, y), str(floor), fill=PAPER, font=font(12), anchor="mm")


def disc(draw: ImageDraw.ImageDraw, place: Pixel, r: float, ink: Ink) -> None:
    """A disc; `r` in px of the finer picture."""
    x, y = place
    draw.ellipse((x - r, y - r, x + r, y + r), fill=ink)


def turned(shape: Sequence[Pixel], place: Pixel, turn: float, scale: float = 1.0) -> list[Pixel]:
    """The shape about (0, 0) turned by `turn` (rad, clockwise in the picture), at a place."""
    cos, sin = scale * math.cos(turn), scale * math.sin(turn)
    return [(place[0] + cos * x - sin * y, place[1] + sin * x + cos * y) for x, y in shape]
