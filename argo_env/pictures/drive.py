"""Drives as pictures: what the camera behind the robot sees, the goal, and how far it is."""

import math

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from argo_env.pictures.camera import Camera
from argo_env.pictures.caption import BRIGHT, DIM, HEIGHT, add_bar
from argo_env.pictures.scene import CameraView

GOAL = (251, 191, 36)
_RIM = (255, 255, 255)
_POLE = 0.8  # m from the goal up to the head of its mark
_HEAD = 0.09  # m, its radius
_LEAST = 4.0  # px, likewise
_BEHIND = 0.1  # m that something may be before the head


def draw_drive(
    view: CameraView,
    camera: Camera,
    goal: tuple[float, float, float],
    time: float,
    floors: tuple[int, int],
    togo: float,
) -> NDArray[np.uint8]:
    """What the camera sees, with the goal marked if it is in view, and a caption: the `time` (s),
    the floors of the robot and of the goal, and the s to go at planning speeds."""
    frame = Image.fromarray(view.colours)
    _mark(ImageDraw.Draw(frame), view, camera, goal)
    here, there = floors
    way = f"{togo:.0f} s to the goal" if math.isfinite(togo) else "no way to the goal"
    left = [(f"{time:.1f} s", BRIGHT), (f"floor {here}", DIM)]
    right = [(way, BRIGHT), (f"floor {there}", DIM)]
    return np.asarray(add_bar(frame, left, right), dtype=np.uint8)


def _mark(
    draw: ImageDraw.ImageDraw, view: CameraView, camera: Camera, goal: tuple[float, float, float]
) -> None:
    """A pole with a round head on the goal, unless all of its head is hidden."""
    x, y, z = goal
    foot, head = camera.project(np.array([goal, (x, y, z + _POLE)]))
    width, height = camera.size
    column, row, depth = head.tolist()
    if min(depth, foot[2]) < camera.near:
        return
    focal = height / 2 / math.tan(math.radians(camera.field_of_view) / 2)
    radius = max(_HEAD * focal / depth, _LEAST)
    bottom = height * (1 - HEIGHT) - radius  # above the caption
    if not (radius <= column < width - radius and radius <= row < bottom):
        return
    sides = (column - radius, column, column + radius), (row - radius, row, row + radius)
    columns, rows = np.array(sides, dtype=np.int64)
    if (view.depth[np.ix_(rows, columns)] < depth - _BEHIND).all():
        return
    for wider, ink in ((1.5, _RIM), (0.0, GOAL)):
        r, wide = radius + wider, round(radius / 2 + 2 * wider)
        draw.line((*foot[:2].tolist(), column, row), fill=ink, width=wide)
        draw.ellipse((column - r, row - r, column + r, row + r), fill=ink)
