"""A picture of a site: plans of its floors, and marks at its flaws."""

import io
import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from argo_env.navigation.raster import CELL
from argo_env.pictures.drawing.floors import floor_plans
from argo_env.pictures.drawing.label_placement import LabelPlacer, draw_plate
from argo_env.pictures.drawing.sheet import (
    FINER,
    FOOT,
    HEAD,
    INK,
    PAPER,
    SIZE,
    SOFT,
    FloorSheet,
    Panel,
    Pixel,
    font,
    make_sheet,
)
from argo_env.pictures.drawing.style import (
    STYLES,
    draw_headline,
    draw_length_scale,
    paint_checkpoint,
)
from argo_env.planning.flaws import Flaw, SafeStates
from argo_env.site import Site

_RADIUS = 9.0  # px of a checkpoint's disc
_FACE = 15.0  # px, length of the line that shows a checkpoint's direction
_STATION = 6.0  # px from the middle of a dock's mark to its sides
_FLAW = 10.0  # px from the middle of a flaw's mark to its corners
_LEFT = 16.0 * FINER
_LINE = 17 * FINER  # px from one line of text to the next
_SWEPT = 4  # cells about the robot's middle that it covers approximately
_MIN_WIDTH = 5  # cells; narrower pieces of deck are too small for a robot, and not hatched
_HATCH = 9 * FINER  # px between the lines of a hatch
_REACHED, _UNREACHED, _RED = (52, 168, 110), (205, 50, 50), (190, 24, 24)


def draw_site_plan(
    site: Site, flaws: Sequence[Flaw] = (), safe_states: SafeStates | None = None
) -> bytes:
    """Return a PNG of the floors with checkpoints, docking stations, named locations and stairs.

    Flaws are numbered at their marks, and described below the plans. With `safe_states`, poses and
    moves at which the robot touches nothing, the part of the decks that it can reach is shaded and
    the other part hatched, if a docking station is usable.
    """
    sheet = make_sheet(floor_plans(site))
    image = sheet.image.copy()
    shaded = safe_states is not None and safe_states.lowest_usable_dock_number is not None
    if safe_states is not None and shaded:
        for number in sheet.panels:
            _shade(image, sheet, number, safe_states)
    draw = ImageDraw.Draw(image)
    labels = LabelPlacer(sheet)
    numbers: dict[tuple[int, float, float], str] = {}
    for k, flaw in enumerate(flaws, start=1):
        for mark in flaw.marks:
            numbers.setdefault(
                (mark.floor, *_pixel_within(sheet, mark.x, mark.y, mark.floor)), str(k)
            )
    for _, x, y in numbers:
        labels.occupy((x, y), 3 * FINER, 3 * FINER)
    _draw_marks(draw, sheet, labels, site)
    for (floor, x, y), text in numbers.items():
        _draw_flaw(draw, labels, (x, y), floor, text)
    wrong = f": {len(flaws)} error{'s' if len(flaws) > 1 else ''}" if flaws else ""
    draw_headline(draw, f"{site.spec.title} ({site.name}){wrong}")
    _draw_north(draw)
    _draw_legend(draw, sheet, bool(site.places), shaded, bool(flaws))
    content = io.BytesIO()
    _add_flaw_texts(image, flaws).reduce(FINER).save(content, "png")
    return content.getvalue()


def _shade(image: Image.Image, sheet: FloorSheet, number: int, safe_states: SafeStates) -> None:
    """Shade the part of a floor that the robot can reach, and hatch the rest.

    To reach a part means to drive there from the first usable docking station and back, over the
    poses of `safe_states`. Parts that are too narrow for a robot are not hatched. The floor with
    this number is drawn in its panel of the picture.
    """
    from scipy.ndimage import binary_dilation, binary_opening

    surface, site = safe_states.lattice.surface, safe_states.site
    levels = np.array([floor.z for floor in site.spec.floors]) - 0.1
    here = np.maximum(np.searchsorted(levels, surface.z, side="right"), 1) == number
    deck = np.zeros((surface.grid.nx, surface.grid.ny), dtype=bool)
    deck[surface.i[here], surface.j[here]] = True
    middles = np.zeros_like(deck)
    cells = safe_states.lattice.cell[safe_states.reached]
    cells = cells[here[cells]]
    middles[surface.i[cells], surface.j[cells]] = True
    across = np.hypot(*np.mgrid[-_SWEPT : _SWEPT + 1, -_SWEPT : _SWEPT + 1])
    reached = binary_dilation(middles, across <= _SWEPT + 0.5) & deck
    unreached = binary_opening(deck & ~reached, np.ones((_MIN_WIDTH, _MIN_WIDTH), dtype=bool))
    panel = sheet.panels[number]
    rows, columns = np.mgrid[0 : panel.height, 0 : panel.width]
    stripes = (rows + columns) % _HATCH < 2 * FINER
    for cells_shown, ink, opacity, pattern in (
        (reached, _REACHED, 60, None),
        (unreached, _UNREACHED, 35, None),
        (unreached, _UNREACHED, 200, stripes),
    ):
        shown = _in_panel(cells_shown, panel, sheet.scale, (surface.grid.x0, surface.grid.y0))
        if pattern is not None:
            shown &= pattern
        mask = Image.fromarray(np.where(shown, opacity, 0).astype(np.uint8))
        image.paste(ink, (panel.left, panel.top), mask)


def _in_panel(
    cells: NDArray[np.bool_], panel: Panel, scale: float, origin: tuple[float, float]
) -> NDArray[np.bool_]:
    """Return a mask of a panel's pixels from a mask of cells, whose grid begins at `origin` (m)."""
    x0, _, _, y1 = panel.plan.bounds
    x = x0 + (np.arange(panel.width) + 0.5) / scale
    y = y1 - (np.arange(panel.height) + 0.5) / scale
    i = np.floor((x - origin[0]) / CELL).astype(int)
    j = np.floor((y - origin[1]) / CELL).astype(int)
    inside = ((i >= 0) & (i < cells.shape[0]))[None, :] & ((j >= 0) & (j < cells.shape[1]))[:, None]
    i, j = i.clip(0, cells.shape[0] - 1), j.clip(0, cells.shape[1] - 1)
    return np.asarray(cells[i[None, :], j[:, None]] & inside)


def _pixel_within(sheet: FloorSheet, x: float, y: float, floor: int) -> Pixel:
    """Return the pixel of a point (m), or the nearest one in its floor's panel."""
    panel, margin = sheet.panels[floor], _STATION * FINER
    px, py = sheet.pixel_at(x, y, floor)
    return (
        min(max(px, panel.left + margin), panel.left + panel.width - margin),
        min(max(py, panel.top + margin), panel.top + panel.height - margin),
    )


def _draw_marks(
    draw: ImageDraw.ImageDraw, sheet: FloorSheet, labels: LabelPlacer, site: Site
) -> None:
    """Draw docking stations, places, checkpoints and the names of stairs."""
    lowest = site.spec.floors[0].number
    named: list[tuple[Pixel, int, str]] = []
    for number, dock in site.docks.items():
        x, y = position = _pixel_within(sheet, dock.x, dock.y, lowest)
        r = _STATION * FINER
        labels.occupy(position, r, r)
        draw.rectangle((x - r, y - r, x + r, y + r), fill=INK, outline=PAPER, width=FINER)
        named.append((position, lowest, f"dock {number}"))
    for name, pose in site.places.items():
        x, y = position = _pixel_within(sheet, pose.x, pose.y, lowest)
        r = _STATION * FINER * 0.7
        labels.occupy(position, r, r)
        draw.ellipse((x - r, y - r, x + r, y + r), fill=PAPER, outline=INK, width=2 * FINER)
        named.append((position, lowest, name))
    for checkpoint in site.checkpoints:
        true = _pixel_within(sheet, *checkpoint.position[:2], checkpoint.floor)
        size = (_RADIUS + 1.0) * FINER
        position = labels.reserve_nearest(true, size, size, checkpoint.floor)
        if position != true:
            draw.line([true, position], fill=STYLES["open"].rim, width=FINER)
        _draw_face(draw, true, checkpoint.yaw)
        paint_checkpoint(draw, position, _RADIUS, "open", str(checkpoint.id))
    named += _stairs(sheet, site)
    for position, floor, name in named:
        draw_plate(draw, labels, position, name, floor)


def _stairs(sheet: FloorSheet, site: Site) -> Iterator[tuple[Pixel, int, str]]:
    """Yield the pixel, the floor's number and the name of stairs, for each floor but the highest.

    The pixel is that of the foot of the lowest flight, on the panel of the floor.
    """
    for tower in site.spec.towers:
        for floor in site.spec.floors[:-1]:
            if tower.flights:
                x, y = min(tower.flights, key=lambda flight: flight.foot[2]).foot[:2]
                yield _pixel_within(sheet, x, y, floor.number), floor.number, tower.name


def _draw_face(draw: ImageDraw.ImageDraw, position: Pixel, yaw: float) -> None:
    """Draw a line from a checkpoint in the direction of its face."""
    end = (
        position[0] + _FACE * FINER * math.cos(yaw),
        position[1] - _FACE * FINER * math.sin(yaw),
    )
    draw.line([position, end], fill=STYLES["open"].rim, width=2 * FINER)


def _draw_flaw(
    draw: ImageDraw.ImageDraw, labels: LabelPlacer, true: Pixel, floor: int, text: str
) -> None:
    """Draw a point at a flaw, with its number beside it."""
    size = _FLAW * FINER
    position = labels.reserve_beside(true, size, size, floor, 4.0 * FINER)
    draw.line([true, position], fill=_RED, width=2 * FINER)
    r = 4.0 * FINER
    x, y = true
    draw.ellipse((x - r, y - r, x + r, y + r), fill=_RED, outline=PAPER, width=FINER)
    _paint_flaw(draw, position, text)


def _paint_flaw(draw: ImageDraw.ImageDraw, position: Pixel, text: str) -> None:
    (x, y), r = position, _FLAW * FINER
    box = (x - r, y - r, x + r, y + r)
    draw.rounded_rectangle(box, 3 * FINER, fill=_RED, outline=PAPER, width=FINER)
    draw.text(position, text, fill=PAPER, font=font(13), anchor="mm")


def _draw_north(draw: ImageDraw.ImageDraw) -> None:
    """Draw an arrow to the north, at the upper right."""
    x, y = SIZE[0] * FINER - _LEFT - 6 * FINER, HEAD * FINER / 2
    high, wide = 12 * FINER, 6 * FINER
    draw.polygon(
        [(x, y - high), (x + wide, y + high), (x, y + high / 2), (x - wide, y + high)], INK
    )
    draw.text((x - 2 * wide, y), "N", fill=INK, font=font(14), anchor="rm")


def _draw_legend(
    draw: ImageDraw.ImageDraw, sheet: FloorSheet, places: bool, shaded: bool, flaws: bool
) -> None:
    """Draw the legend of the marks, and the scale."""
    y, face, x = (SIZE[1] - FOOT / 2) * FINER, font(12), _LEFT
    r = 7 * FINER

    def draw_entry(text: str) -> None:
        nonlocal x
        draw.text((x + 2 * r, y), text, fill=SOFT, font=face, anchor="lm")
        x += 2 * r + draw.textlength(text, font=face) + 16 * FINER

    _draw_face(draw, (x + r / 2, y), 0.0)
    paint_checkpoint(draw, (x + r / 2, y), 7.0, "open", "3")
    x += r
    draw_entry("checkpoint, and where it looks")
    draw.rectangle((x, y - r + FINER, x + 2 * r - 2 * FINER, y + r - FINER), fill=INK)
    x += r / 2
    draw_entry("docking station")
    if places:
        draw.ellipse((x, y - r / 1.5, x + 1.33 * r, y + r / 1.5), PAPER, INK, 2 * FINER)
        draw_entry("place")
    if shaded:
        for ink, text in ((_REACHED, "can be reached"), (_UNREACHED, "can't be reached")):
            pale = tuple(round(255 - (255 - c) * 0.35) for c in ink)
            box = (x, y - r, x + 2 * r, y + r)
            draw.rectangle(box, fill=pale, outline=ink, width=FINER)
            if ink is _UNREACHED:
                draw.line((x, y + r, x + 2 * r, y - r), fill=ink, width=2 * FINER)
            x += r
            draw_entry(text)
    if flaws:
        _paint_flaw(draw, (x + r, y), "1")
        x += r
        draw_entry("error, see below")
    draw_length_scale(draw, sheet, SIZE[0] * FINER - _LEFT, y)


def _add_flaw_texts(image: Image.Image, flaws: Sequence[Flaw]) -> Image.Image:
    """Return the picture with the messages of the flaws below it."""
    draw = ImageDraw.Draw(image)
    lines = []
    for k, flaw in enumerate(flaws, start=1):
        room = SIZE[0] * FINER - 2 * _LEFT - 30 * FINER
        for n, line in enumerate(_wrapped(draw, flaw.message, room)):
            lines.append(("" if n else str(k), line))
    if not lines:
        return image
    width, height = image.size
    whole = Image.new("RGB", (width, height + _LINE * (len(lines) + 1)), PAPER)
    whole.paste(image)
    draw = ImageDraw.Draw(whole)
    for n, (number, line) in enumerate(lines):
        y = height + _LINE * (n + 0.5)
        draw.text((_LEFT, y), number, fill=_RED, font=font(13), anchor="lm")
        draw.text((_LEFT + 30 * FINER, y), line, fill=INK, font=font(13), anchor="lm")
    return whole


def _wrapped(draw: ImageDraw.ImageDraw, text: str, room: float) -> Iterator[str]:
    """Yield the text in lines of no more than `room` px, broken between words."""
    line = ""
    for word in text.split():
        longer = f"{line} {word}".strip()
        if line and draw.textlength(longer, font=font(13)) > room:
            yield line
            longer = word
        line = longer
    yield line
