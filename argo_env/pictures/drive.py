"""Pictures of drives, with the view of the camera behind the robot, the goal and the time to it."""

import math

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from argo_env.pictures.camera import Camera
from argo_env.pictures.caption import BRIGHT, DIM, HEIGHT, with_bar_over_bottom
from argo_env.pictures.scene import CameraView

GOAL = (251, 191, 36)
_RIM = (255, 255, 255)
_POLE = 0.8  # m from the goal up to the head of its mark
_HEAD = 0.09  # m, radius of the head
_MIN_HEAD = 4.0  # px, smallest radius of the head
_BEHIND = 0.1  # m that something may be in front of the head without hiding it


def draw_drive(
    view: CameraView,
    camera: Camera,
    goal: tuple[float, float, float],
    time: float,
    floors: tuple[int, int],
    time_to_goal: float,
) -> NDArray[np.uint8]:
    """Return the camera's view with a mark at the goal, if it is in view, and a caption.

    Args:
        view: View of the camera.
        camera: Camera behind the robot.
        goal: Position of the goal in m.
        time: Time in s for the caption.
        floors: Numbers of the floors of the robot and of the goal.
        time_to_goal: Time (s) to the goal at planning speeds; infinite without a path.
    """
    frame = Image.fromarray(view.colours)
    _mark(ImageDraw.Draw(frame), view, camera, goal)
    here, there = floors
    remaining = (
        f"{time_to_goal:.0f} s to the goal"
        if math.isfinite(time_to_goal)
        else "no path to the goal"
    )
    left = [(f"{time:.1f} s", BRIGHT), (f"floor {here}", DIM)]
    right = [(remaining, BRIGHT), (f"floor {there}", DIM)]
    return np.asarray(with_bar_over_bottom(frame, left, right), dtype=np.uint8)


def _mark(
    draw: ImageDraw.ImageDraw, view: CameraView, camera: Camera, goal: tuple[float, float, float]
) -> None:
    """Draw a pole with a round head at the goal, unless the whole head is hidden."""
    x, y, z = goal
    foot, head = camera.project_with_depth(np.array([goal, (x, y, z + _POLE)]))
    width, height = camera.size
    column, row, depth = head.tolist()
    if min(depth, foot[2]) < camera.near:
        return
    focal = height / 2 / math.tan(math.radians(camera.field_of_view) / 2)
    radius = max(_HEAD * focal / depth, _MIN_HEAD)
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
