"""Models of the kinds of checkpoints, with drawn face and indicator: dial gauges, liquid level
gauges and quarter-turn valves."""

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

    `body` and `beside` are points on it and next to it, in its own frame with the position 0, in m,
    shape (n, 3). Points lie in the middle of its thickness, so that its silhouette is even about
    them from wherever one looks.
    """

    body: Points
    beside: Points
    low: float
    """position at the low end of the scale, rad or m"""
    high: float
    """position at the high end of the scale, rad or m"""
    move: Callable[[Points, Points], Points]
    """points, shape (n, 3), at positions, shape (m,), in the instrument's frame, (m, n, 3)"""


@dataclass(frozen=True, eq=False)
class Instrument:
    """A kind of checkpoint as the reader knows it. In its frame the face looks along x, z is up."""

    kind: CheckpointKind
    shape: FaceShape
    rolled: bool
    """whether it may be turned about the normal of its face"""
    hidden_radius: float
    """m, of the disc about the middle in which the drawn face is covered"""
    extent: float
    """m, the radius about the middle of the face in which all of it lies"""
    outlines: tuple[tuple[float, float], ...]
    """half the width and height (m) of the patches that the face may be seen as: to its border, or
    only to the ring of its scale where the gap between is too narrow for the picture"""
    body: tuple[tuple[float, float], ...]
    """the dark body behind the face, as slices: place along x and half the width (m) of each, with
    the height in proportion"""
    indicator: Indicator


@dataclass(frozen=True)
class Template:
    """The drawn face as points to compare pictures with: places in the instrument's frame (m),
    shape (n, 3), brightness from 0 to 1, shape (n,), and weights that sum up to 1, with which dark
    and bright points count alike however few there are of one of them."""

    points: Points
    brightness: NDArray[np.float64]
    weights: NDArray[np.float64]


@cache
def texture(kind: CheckpointKind) -> NDArray[np.float32]:
    """The drawn face, brightness from 0 to 1, shape (height, width)."""
    with Image.open(face_file(kind)) as image:
        return np.asarray(image.convert("L")).astype(np.float32) / np.float32(255)


@cache
def blurred_texture(kind: CheckpointKind, blur: float) -> NDArray[np.float32]:
    """The drawn face, blurred by `blur` (m)."""
    import cv2

    return np.asarray(cv2.GaussianBlur(texture(kind), (0, 0), blur * PIXELS_PER_METRE))


@cache
def make_template(instrument: Instrument, spacing: float, blur: float) -> Template:
    """The face on a grid of `spacing` (m), blurred by `blur` (m)."""
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
    # Spread over the range of brightness, each half of it gets half of the weight.
    bright = brightness > (brightness.min() + brightness.max()) / 2
    weights = np.where(bright, 0.5 / bright.sum(), 0.5 / (~bright).sum())
    points = np.column_stack([np.full(y.shape, -shape.depth), y, z])
    return Template(points, brightness, weights)


def grid(x: float, y: NDArray[np.float64], z: NDArray[np.float64]) -> Points:
    """All points with these coordinates (m), shape (n, 3)."""
    ys, zs = np.meshgrid(y, z)
    return np.column_stack([np.full(ys.size, x), ys.ravel(), zs.ravel()])


def turned(points: Points, angles: Points) -> Points:
    """Points turned clockwise about the instrument's x axis by angles (rad), shape (m, n, 3)."""
    cos, sin = np.cos(angles)[:, None], np.sin(angles)[:, None]
    x, y, z = points.T
    return np.stack(
        [np.broadcast_to(x, (len(angles), len(x))), y * cos + z * sin, z * cos - y * sin], axis=-1
    )


_NEEDLE = np.linspace(0.010, 0.050, 21)  # m, of the needle that is looked at

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
        move=turned,
    ),
)
"""a red needle over a round scale of 270 degrees"""

_FLOAT = np.linspace(-0.012, 0.012, 7)  # m, of the float that is looked at


def _lifted(points: NDArray[np.float64], heights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points moved up by heights (m), shape (m, n, 3)."""
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
        move=_lifted,
    ),
)
"""a red float in a glass beside a scale of 240 mm"""

_LEVER = np.linspace(0.025, 0.150, 26)  # m, of the lever that is looked at
_MIDDLE = -0.004  # m, of its thickness

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
        move=turned,
    ),
)
"""a red lever over a plate with a mark for shut and one for open"""
