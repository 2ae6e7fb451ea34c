"""Driven path as lines that are coloured by time."""

import math
from collections.abc import Callable, Sequence
from itertools import groupby, pairwise

import numpy as np
from numpy.typing import NDArray

from argo_env.report.outline import Point
from argo_env.report.svg import Node, node, number, polyline, simplify
from argo_env.run.record import PathSample

TOLERANCE = 0.02  # m, greatest distance of the drawn path from the samples
_AROUND = 0.1  # m of path before and after a point that define its direction
SHADES = 24
"""number of colours from the start to the end of the mission"""

_RAMP = ((0x0F, 0xA3, 0xA3), (0x25, 0x63, 0xEB), (0x7C, 0x3A, 0xED), (0xDB, 0x27, 0x77))


def colour(share: float) -> str:
    """Return the colour of a time, given as its share (0 to 1) of the duration, as `#rrggbb`."""
    position = min(max(share, 0.0), 1.0) * (len(_RAMP) - 1)
    index = min(int(position), len(_RAMP) - 2)
    part = position - index
    mixed = (round(a + part * (b - a)) for a, b in zip(_RAMP[index], _RAMP[index + 1], strict=True))
    return "#" + "".join(f"{channel:02x}" for channel in mixed)


def stretches(path: Sequence[PathSample], floor: int | None) -> list[list[PathSample]]:
    """Return the unbroken parts of the path on a floor; with `floor` None, the whole as one."""
    if floor is None:
        return [list(path)] if path else []
    runs = groupby(path, key=lambda sample: sample.floor == floor)
    return [list(samples) for wanted, samples in runs if wanted]


def draw_track(
    parts: Sequence[Sequence[PathSample]],
    plane: Callable[[PathSample], Point],
    at: Callable[[float, float], Point],
    end: float,
    aside_metres: float = 0.0,
) -> list[Node]:
    """Draw the parts of a path as lines, coloured by time.

    Args:
        parts: Unbroken parts of the path.
        plane: Returns the two coordinates (m) of a sample in the drawing's plane.
        at: Returns the position in px of such coordinates.
        end: Time of the last colour in s.
        aside_metres: Distance of the lines to the right of the path in m.
    """
    lines = []
    for samples in parts:
        shades = [min(int(SHADES * s.t / end), SHADES - 1) if end else 0 for s in samples]
        line = shift_right(np.array([plane(s) for s in samples]), aside_metres)
        cuts = [i for i in range(1, len(samples)) if shades[i] != shades[i - 1]]
        for first, last in pairwise([0, *cuts, len(samples)]):
            # Each line reaches the first sample of the next one, so that there is no gap.
            points = line[first : last + 1]
            corners = points[simplify(points, TOLERANCE)]
            if len(corners) > 1:
                stroke = colour(shades[first] / (SHADES - 1))
                d = polyline(at(x, y) for x, y in corners.tolist())
                lines.append(node("path", d=d, class_="track", stroke=stroke))
    return lines


def shift_right(points: NDArray[np.float64], aside_metres: float) -> NDArray[np.float64]:
    """Return the points of a path in plan, shape (n, 2), moved by `aside_metres` to its right.

    So two passes in opposite directions do not cover each other.
    """
    steps = np.hypot(*np.diff(points, axis=0).T)
    driven = np.concatenate([[0.0], steps.cumsum()])
    if not aside_metres or driven[-1] == 0.0:
        return points
    distinct = np.concatenate([[True], steps > 0.0])  # np.interp needs ascending distances

    def along(by: float) -> NDArray[np.float64]:
        return np.column_stack(
            [np.interp(driven + by, driven[distinct], axis[distinct]) for axis in points.T]
        )

    ahead = along(_AROUND) - along(-_AROUND)
    length = np.hypot(*ahead.T)
    # Where the path turns back, the direction before the turn defines its right side.
    turning = length < _AROUND / 10
    ahead[turning] = (points - along(-_AROUND))[turning]
    length = np.maximum(np.hypot(*ahead.T), 1e-9)
    right = np.column_stack([ahead[:, 1], -ahead[:, 0]]) / length[:, None]
    return np.asarray(points + aside_metres * right)


def draw_arrow_heads(
    samples: Sequence[PathSample],
    at: Callable[[float, float], Point],
    spacing_metres: float,
    aside_metres: float = 0.0,
) -> list[Node]:
    """Draw arrow heads along the path in plan, one every `spacing_metres`.

    They are `aside_metres` to the right of the path.
    """
    heads, since = [], spacing_metres / 2
    line = shift_right(np.array([(s.x, s.y) for s in samples]), aside_metres).tolist()
    for k, (a, b) in enumerate(pairwise(samples), start=1):
        step = math.hypot(b.x - a.x, b.y - a.y)
        since += step
        if since < spacing_metres or step < 0.02:
            continue
        since = 0.0
        (ax, ay), (bx, by) = at(a.x, a.y), at(b.x, b.y)
        turn = math.degrees(math.atan2(by - ay, bx - ax))
        px, py = at(*line[k])
        pose = f"translate({number(px)},{number(py)}) rotate({turn:.0f})"
        heads.append(node("path", d="M-5,-4L3,0L-5,4z", transform=pose, class_="heading"))
    return heads


def draw_letter_mark(center: Point, text: str, class_: str) -> Node:
    """Draw a round mark with a letter, for the start or end of the path, about a position in px."""
    return node(
        "g",
        node("circle", cx=center[0], cy=center[1], r=9.0),
        node("text", x=center[0], y=center[1] + 4, text=text, class_="middle"),
        class_=f"flag {class_}",
    )
