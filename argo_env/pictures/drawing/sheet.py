"""A sheet of floors: the position of each floor's plan in a picture, with the plans drawn."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

from PIL import Image, ImageDraw, ImageFont

from argo_env.pictures.drawing.floors import FloorPlan, floor_plans
from argo_env.planning import open_site
from argo_env.site.shapes import Role

SIZE = (1280, 720)
"""width and height of a picture in px"""
FINER = 2
"""factor by which a picture is drawn larger and then reduced, for smooth edges"""
HEAD, FOOT = 40, 40
"""height in px of the headline above the floors, and of the legend below them"""
INK, SOFT, PAPER = (28, 39, 51), (91, 107, 124), (255, 255, 255)
_TITLE = 20  # px above each floor
_GAP = 12  # px
_LARGEST = 60.0  # px for 1 m, at most
_WIDTH, _HEIGHT = FINER * SIZE[0], FINER * (SIZE[1] - HEAD - FOOT)  # of all floors
_PANEL, _FRAME = (248, 249, 250), (205, 212, 219)

# Colours are paler than in a report, as the checkpoints and the path must stand out.
_COLOURS: dict[Role, tuple[str, str]] = {
    Role.GROUND: ("#f4f2ec", "#f4f2ec"),
    Role.DECK: ("#e3e8ed", "#ccd4dc"),
    Role.STAIR: ("#cfdded", "#8aa2bd"),
    Role.PUMP: ("#cfdcd2", "#94ab9a"),
    Role.VESSEL: ("#ecdfcc", "#c0a988"),
    Role.PIPE: ("#e3cdb2", "#b89c79"),
    Role.STRUCTURE: ("#a5adb5", "#a5adb5"),
    Role.DOCK: ("#b9cfc0", "#7fa08b"),
    Role.RAILING: ("#7d8993", "#7d8993"),
}

Font = ImageFont.ImageFont | ImageFont.FreeTypeFont
Pixel = tuple[float, float]
"""x and y in px of the enlarged picture"""


@dataclass(frozen=True)
class Panel:
    """A floor's part of the sheet, in px of the enlarged picture."""

    plan: FloorPlan
    left: int
    top: int
    width: int
    height: int


@dataclass(frozen=True)
class FloorSheet:
    """Floors side by side, all on the same scale, with north up."""

    panels: dict[int, Panel]
    """panels by the number of the floor"""
    scale: float
    """size of 1 m in px of the enlarged picture"""
    image: Image.Image
    """drawn plans, FINER times as large as a picture; do not draw on it"""

    def pixel_at(self, x: float, y: float, floor: int) -> Pixel:
        """Return the pixel of a point (m) of a floor."""
        panel = self.panels[floor]
        x0, _, _, y1 = panel.plan.bounds
        return panel.left + (x - x0) * self.scale, panel.top + (y1 - y) * self.scale


def make_sheet(plans: Sequence[FloorPlan], pale_floors: Sequence[int] = ()) -> FloorSheet:
    """Arrange and draw the plans of floors in their order, pale if numbered in `pale_floors`."""
    grid = max((_Grid.arrange(plans, n) for n in range(1, len(plans) + 1)), key=lambda g: g.scale)
    scale = grid.scale
    beside = (_WIDTH - scale * sum(grid.widths)) / (len(grid.widths) + 1)
    below = (_HEIGHT - scale * sum(grid.heights)) / len(grid.heights) - FINER * _TITLE
    panels, top = {}, FINER * HEAD + below / 2
    for row, height in zip(grid.rows, grid.heights, strict=True):
        top, left = top + FINER * _TITLE, beside
        for plan, width in zip(row, grid.widths, strict=False):
            size = round(scale * _width(plan)), round(scale * _height(plan))
            panels[plan.number] = Panel(plan, round(left), round(top), *size)
            left += scale * width + beside
        top += scale * height + below
    image = Image.new("RGB", (SIZE[0] * FINER, SIZE[1] * FINER), PAPER)
    for panel in panels.values():
        _draw(image, panel, scale, panel.plan.number in pale_floors)
    return FloorSheet(panels, scale, image)


def font(size: float) -> Font:
    """Return the font of pictures for texts with a height of `size` px in the reduced picture."""
    return _font(round(size * FINER))


@lru_cache(maxsize=64)
def _font(size: int) -> Font:
    return ImageFont.load_default(size)


@dataclass(frozen=True)
class _Grid:
    """Floors in rows, and the widths of the columns and heights of the rows in m."""

    rows: tuple[tuple[FloorPlan, ...], ...]
    widths: tuple[float, ...]
    heights: tuple[float, ...]

    @classmethod
    def arrange(cls, plans: Sequence[FloorPlan], columns: int) -> "_Grid":
        rows = tuple(tuple(plans[k : k + columns]) for k in range(0, len(plans), columns))
        widths = tuple(max(_width(plan) for plan in plans[k::columns]) for k in range(columns))
        return cls(rows, widths, tuple(max(map(_height, row)) for row in rows))

    @property
    def scale(self) -> float:
        """Largest scale with which the floors fit, in px of the enlarged picture for 1 m."""
        across = (_WIDTH - FINER * _GAP * (len(self.widths) + 1)) / sum(self.widths)
        down = (_HEIGHT - FINER * (_TITLE + _GAP) * len(self.heights)) / sum(self.heights)
        return min(across, down, FINER * _LARGEST)


def _width(plan: FloorPlan) -> float:
    return plan.bounds[2] - plan.bounds[0]


def _height(plan: FloorPlan) -> float:
    return plan.bounds[3] - plan.bounds[1]


def _draw(image: Image.Image, panel: Panel, scale: float, dim: bool) -> None:
    """Draw the plan of a floor in its panel, with its number above."""
    x0, _, _, y1 = panel.plan.bounds
    part = Image.new("RGB", (panel.width, panel.height), _PANEL)
    draw = ImageDraw.Draw(part)
    for role, shapes in panel.plan.shapes:
        fill, line = _COLOURS[role]
        for shape in shapes:
            corners = [((x - x0) * scale, (y1 - y) * scale) for x, y in shape]
            if len(corners) > 2:
                draw.polygon(corners, fill=fill, outline=line)
    if dim:
        part = Image.blend(part, Image.new("RGB", part.size, PAPER), 0.45)
    image.paste(part, (panel.left, panel.top))
    draw = ImageDraw.Draw(image)
    edge = (panel.left, panel.top, panel.left + panel.width, panel.top + panel.height)
    draw.rectangle(edge, outline=_FRAME, width=FINER)
    title = f"floor {panel.plan.number}" + (" (not asked for)" if dim else "")
    position = (panel.left, panel.top - math.ceil(3 * FINER))
    draw.text(position, title, fill=SOFT if dim else INK, font=font(13), anchor="ls")


@lru_cache(maxsize=4)  # a sheet takes 11 MB
def site_sheet(scenario: str, low: int, high: int, requested_floors: tuple[int, ...]) -> FloorSheet:
    """Return a sheet of the floors numbered `low` to `high` of a scenario's site.

    Floors that are not in `requested_floors` are pale.
    """
    plans = [plan for plan in _plans(scenario) if low <= plan.number <= high]
    return make_sheet(plans, [p.number for p in plans if p.number not in requested_floors])


# The key is a name, as a cache of navigators would keep them alive.
@lru_cache(maxsize=8)
def _plans(scenario: str) -> tuple[FloorPlan, ...]:
    return floor_plans(open_site(scenario).site)
