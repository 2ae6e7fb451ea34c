"""Routes as pictures: the floors side by side, seen from above."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from argo_env.envs.route_instance import DOCK, RouteInstance

Place = tuple[float, float, float]
"""x, y (m) and floor"""

_SIZE = (960, 540)  # px
_PAPER, _PANEL, _INK, _FAINT = (250, 250, 248), (236, 238, 240), (40, 44, 52), (150, 156, 164)
_ROBOT = (28, 92, 180)
_FILLS = {"open": (232, 180, 60), "done": (110, 184, 124), "closed": _PAPER, "dock": _INK}
_HEAD = 36  # px above the panels
_GAP = 10  # px
_EDGE = 24  # px between a panel's edge and what is in it
_COLUMNS = 3


@dataclass(frozen=True)
class Marker:
    """Something on the plan; its state is `open`, `done`, `closed` or `dock`."""

    place: Place
    name: str
    radius: float
    """px"""
    state: str


def draw_plan(
    markers: Sequence[Marker], way: Sequence[Place], headline: str, floors: int
) -> NDArray[np.uint8]:
    """The markers on their floors and the robot's way in straight lines, shape (540, 960, 3)."""
    image = Image.new("RGB", _SIZE, _PAPER)
    draw = ImageDraw.Draw(image)
    font, small = ImageFont.load_default(16.0), ImageFont.load_default(12.0)
    columns = min(_COLUMNS, floors)
    rows = -(-floors // columns)
    width = (_SIZE[0] - _GAP) / columns - _GAP
    height = (_SIZE[1] - _HEAD) / rows - _GAP
    points = np.array([m.place[:2] for m in markers] + [p[:2] for p in way])
    low = points.min(axis=0)
    span = np.maximum(points.max(axis=0) - low, 1.0)
    # One scale for both directions, so that the plan keeps its shape.
    scale = float(min((width - 2 * _EDGE) / span[0], (height - 2 * _EDGE - 12) / span[1]))

    def corner(floor: float) -> tuple[float, float]:
        k = round(floor) - 1
        return _GAP + k % columns * (width + _GAP), _HEAD + k // columns * (height + _GAP)

    def at(place: Place) -> tuple[float, float]:
        left, top = corner(place[2])
        inset = (width - scale * span[0]) / 2, (height - 12 - scale * span[1]) / 2
        return (
            left + inset[0] + scale * (place[0] - low[0]),
            top + 12 + inset[1] + scale * (low[1] + span[1] - place[1]),
        )

    for floor in range(1, floors + 1):
        left, top = corner(floor)
        draw.rectangle([left, top, left + width, top + height], fill=_PANEL)
        draw.text((left + 6, top + 4), f"floor {floor}", fill=_FAINT, font=small)
    for a, b in pairwise(way):
        if a[2] == b[2]:
            draw.line([at(a), at(b)], fill=_ROBOT, width=2)
    for marker in markers:
        (x, y), r = at(marker.place), marker.radius
        if marker.state == "dock":
            draw.rectangle([x - r, y - r, x + r, y + r], fill=_INK)
            draw.text((x + r + 4, y), marker.name, fill=_INK, font=small, anchor="lm")
            continue
        rim = _FAINT if marker.state == "closed" else _INK
        draw.ellipse([x - r, y - r, x + r, y + r], fill=_FILLS[marker.state], outline=rim)
        draw.text((x, y), marker.name, fill=rim, font=small, anchor="mm")
    x, y = at(way[-1])
    draw.ellipse([x - 15, y - 15, x + 15, y + 15], outline=_ROBOT, width=4)
    draw.text((_GAP, _HEAD / 2), headline, fill=_INK, font=font, anchor="lm")
    return np.asarray(image, dtype=np.uint8)


def draw_route(instance: RouteInstance, route: Sequence[int], time: float) -> NDArray[np.uint8]:
    """The route so far. A checkpoint's disc is as large as its prize is high."""
    places: list[Place] = [(x, y, floor) for x, y, floor in instance.places.tolist()]
    start = instance.start
    markers = []
    for node in range(1, instance.size):
        there = bool(np.isfinite(instance.arrival[start, node]))
        if there or places[node][2]:  # an empty slot is nowhere
            state = "done" if node in route else "open" if there else "closed"
            radius = 7.0 + 7.0 * float(instance.prizes[node])
            markers.append(Marker(places[node], str(node), radius, state))
    together = places[DOCK] == places[start]
    markers.append(Marker(places[DOCK], "start, dock" if together else "dock", 5.0, "dock"))
    if not together:
        markers.append(Marker(places[start], "start", 5.0, "dock"))
    prize = sum(float(instance.prizes[node]) for node in route)
    headline = f"{time:.0f} s of {instance.budget:.0f} s    prize {prize:.2f}"
    way = [places[node] for node in (start, *route)]
    return draw_plan(markers, way, headline, round(float(instance.places[:, 2].max())))
