"""What the reader knows of a kind of checkpoint: its drawn face, and its indicator."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from argo_compiler.base.catalog import CheckpointKind
from argo_env.sensing.vision.faces import PIXELS_PER_METRE, FaceShape, face_file

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
