"""Models of instruments, each with its face and its indicator.

There are dial gauges, liquid level gauges and quarter-turn valves.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from argo_compiler.base.catalog import CheckpointKind
from argo_env.sensing.vision.faces import FACES, PIXELS_PER_METRE, FaceShape, face_file

Points = NDArray[np.float64]


@dataclass(frozen=True)
class Indicator:
    """The part of an instrument that shows the value: a red needle, lever or float.

    Points are in m, shape (n, 3), in the indicator's own frame at position 0. They lie in the
    middle of its thickness, so that they are in the middle of its silhouette from any viewpoint.
    """

    body: Points
    """points on the indicator"""
    beside: Points
    """points next to the indicator"""
    low: float
    """position at the low end of the scale, rad or m"""
    high: float
    """position at the high end of the scale, rad or m"""
    move: Callable[[Points, Points], Points]
    """function that moves points, shape (n, 3), to positions, shape (m,); its result is in the
    instrument's frame, shape (m, n, 3)"""


@dataclass(frozen=True, eq=False)
class Instrument:
    """Model of one kind of checkpoint. In its frame the face's normal is along x, and z is up."""

    kind: CheckpointKind
    shape: FaceShape
    rolled: bool
    """True if it may be rolled about the normal of its face"""
    hidden_radius: float
    """m, radius of the disc in the middle of the face that the instrument's parts cover"""
    extent: float
    """m, radius about the middle of the face within which the whole instrument lies"""
    outlines: tuple[tuple[float, float], ...]
    """half the width and height (m) of the bright patches as which the face may appear: to its
    border, or only to the ring of its scale if the picture can't resolve the gap between them"""
    body: tuple[tuple[float, float], ...]
    """slices of the dark body behind the face: position along x and half the width (m) of each; its
    height is in proportion"""
    indicator: Indicator


@dataclass(frozen=True)
class Template:
    """The drawn face as points that are compared with pictures."""

    points: Points
    """m, in the instrument's frame, shape (n, 3)"""
    brightness: NDArray[np.float64]
    """0 to 1, shape (n,)"""
    weights: NDArray[np.float64]
    """shape (n,), with the sum 1: dark and bright points have half of it each"""


@cache
def texture(kind: CheckpointKind) -> NDArray[np.float32]:
    """Return the drawn face of an instrument as brightness, 0 to 1, shape (height, width)."""
    with Image.open(face_file(kind)) as image:
        return np.asarray(image.convert("L")).astype(np.float32) / np.float32(255)


@cache
def blurred_texture(kind: CheckpointKind, blur_metres: float) -> NDArray[np.float32]:
    """Return `texture`, blurred by a Gaussian filter with the standard deviation `blur_metres`."""
    import cv2

    return np.asarray(cv2.GaussianBlur(texture(kind), (0, 0), blur_metres * PIXELS_PER_METRE))


@cache
def make_template(instrument: Instrument, spacing: float, blur: float) -> Template:
    """Return the face as points on a grid of `spacing` (m), blurred by `blur` (m)."""
    shape = instrument.shape
    y, z = np.meshgrid(
        np.arange(-shape.half_width + spacing / 2, shape.half_width, spacing),
        np.arange(-shape.half_height + spacing / 2, shape.half_height, spacing),
    )
    radius = np.hypot(y, z)
    inside = radius > instrument.hidden_radius
    if shape.round:
        inside &= radius < shape.half_width - 0.001
    y, z = y[inside], z[inside]
    picture = blurred_texture(instrument.kind, blur)
    column = ((y + shape.half_width) * PIXELS_PER_METRE).astype(int)
    row = ((shape.half_height - z) * PIXELS_PER_METRE).astype(int)
    brightness = picture[
        np.clip(row, 0, picture.shape[0] - 1), np.clip(column, 0, picture.shape[1] - 1)
    ].astype(np.float64)
    # The dark and the bright points get half of the weight each.
    bright = brightness > (brightness.min() + brightness.max()) / 2
    weights = np.where(bright, 0.5 / bright.sum(), 0.5 / (~bright).sum())
    points = np.column_stack([np.full(y.shape, -shape.depth), y, z])
    return Template(points, brightness, weights)


def grid(x: float, y: NDArray[np.float64], z: NDArray[np.float64]) -> Points:
    """Return points of all combinations of `y` with `z` (m) at `x`, shape (len(z) * len(y), 3).

    The points with the first z come first, in the order of `y`.
    """
    ys, zs = np.meshgrid(y, z)
    return np.column_stack([np.full(ys.size, x), ys.ravel(), zs.ravel()])


def turn_points_by_each_angle(points: Points, angles: Points) -> Points:
    """Return n points turned about the instrument's x axis by each of m angles, shape (m, n, 3).

    `points` (m) have the shape (n, 3); angles (rad) are clockwise as seen from the front.
    """
    cos, sin = np.cos(angles)[:, None], np.sin(angles)[:, None]
    x, y, z = points.T
    return np.stack(
        [np.broadcast_to(x, (len(angles), len(x))), y * cos + z * sin, z * cos - y * sin], axis=-1
    )


_NEEDLE = np.linspace(0.010, 0.050, 21)  # m from the axis, points of the needle that are searched

DIAL = Instrument(
    kind=CheckpointKind.PRESSURE_GAUGE,
    shape=FACES[CheckpointKind.PRESSURE_GAUGE],
    rolled=True,
    hidden_radius=0.0,
    extent=0.08,
    outlines=((0.065, 0.065), (0.0575, 0.0575)),
    body=((-0.003, 0.069), (-0.010, 0.075), (-0.026, 0.075), (-0.043, 0.075), (-0.060, 0.075)),
    indicator=Indicator(
        body=grid(0.0, np.array([-0.0015, 0.0, 0.0015]), _NEEDLE),
        beside=grid(0.0, np.array([-0.010, -0.008, 0.008, 0.010]), _NEEDLE),
        low=math.radians(-135),
        high=math.radians(135),
        move=turn_points_by_each_angle,
    ),
)
"""a red needle over a round scale of 270 degrees"""

_FLOAT = np.linspace(-0.012, 0.012, 7)  # m from the middle, points of the float that are searched


def lift_points_by_each_height(
    points: NDArray[np.float64], heights: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return n points (m), shape (n, 3), moved up by each of m heights (m), shape (m, n, 3)."""
    return np.asarray(points[None] + heights[:, None, None] * np.array([0.0, 0.0, 1.0]))


LEVEL = Instrument(
    kind=CheckpointKind.LIQUID_LEVEL_GAUGE,
    shape=FACES[CheckpointKind.LIQUID_LEVEL_GAUGE],
    rolled=False,
    hidden_radius=0.0,
    extent=0.17,
    outlines=((0.039, 0.154), (0.019, 0.135), (0.045, 0.160)),
    body=((-0.005, 0.045), (-0.023, 0.045), (-0.041, 0.045), (-0.060, 0.045)),
    indicator=Indicator(
        body=grid(0.0, _FLOAT, np.linspace(-0.006, 0.006, 7)),
        beside=grid(0.0, _FLOAT, np.array([-0.015, -0.013, 0.013, 0.015])),
        low=-0.12,
        high=0.12,
        move=lift_points_by_each_height,
    ),
)
"""a red float in a glass beside a scale of 240 mm"""

_LEVER = np.linspace(0.025, 0.150, 26)  # m from the axis, points of the lever that are searched
_MIDDLE = -0.004  # m along x, middle of the lever's thickness

VALVE = Instrument(
    kind=CheckpointKind.VALVE,
    shape=FACES[CheckpointKind.VALVE],
    rolled=True,
    hidden_radius=0.052,
    extent=0.165,
    outlines=((0.080, 0.080),),
    body=((-0.013, 0.086), (-0.020, 0.086), (-0.040, 0.050), (-0.060, 0.050)),
    indicator=Indicator(
        body=grid(_MIDDLE, np.linspace(-0.008, 0.008, 5), _LEVER),
        beside=grid(_MIDDLE, np.array([-0.026, -0.022, 0.022, 0.026]), _LEVER),
        low=0.0,
        high=math.radians(90),
        move=turn_points_by_each_angle,
    ),
)
"""a red lever over a plate with a mark for shut and one for open"""
