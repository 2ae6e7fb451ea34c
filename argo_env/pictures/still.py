"""What stands still in the picture of a site: rendered once, and then kept.

A picture of a site and the robot is the nearer of two pictures, pixel by pixel: of the site alone,
which is the same for all runs on it, and of the robot alone.
"""

import hashlib
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from argo_env.files import cache
from argo_env.pictures.camera import Camera
from argo_env.pictures.light import shadowed
from argo_env.pictures.scene import CameraView, Scene
from argo_env.robot.spec import RobotSpec
from argo_env.site import Site

_HERE = Path(__file__).parent
_CODE = (_HERE, _HERE.parent / "site", _HERE.parent / "world")
"""where what changes a picture is written"""
_NEAR = 60  # px: a pixel of the shadow map covers some in the picture


@dataclass(frozen=True)
class LitView:
    """What a camera sees, and what of it the sun reaches."""

    view: CameraView
    lit_depth: NDArray[np.float64]
    """m along the rays of the sun to what they reach, shape (height, width) of the shadow map"""
    dark: NDArray[np.bool_]
    """the pixels of the view that lie in the shadow, shape (height, width)"""


def still_view(site: Site, robot: RobotSpec, camera: Camera, sun: Camera) -> LitView:
    """What is seen of the site without the robot; looked up if it was rendered before."""
    said = (_digest_of_code(), repr(site.elements), repr(site.checkpoints), repr((camera, sun)))

    def rendered() -> dict[str, NDArray[Any]]:
        with Scene(site, robot) as scene:
            seen, lit = scene.look(camera), scene.look(sun)
        # The renderer has no more than single precision.
        return {
            "colours": seen.colours,
            "depth": seen.depth.astype(np.float32),
            "lit_depth": lit.depth.astype(np.float32),
            "dark": shadowed(camera, seen.depth, sun, lit.depth),
        }

    found = cache.entry(said).made("overview", rendered)
    view = CameraView(found["colours"], found["depth"].astype(np.float64))
    return LitView(view, found["lit_depth"].astype(np.float64), found["dark"])


def with_robot(still: LitView, robot: Scene, camera: Camera, sun: Camera) -> LitView:
    """The same with the robot of a scene that has nothing else."""
    seen, lit = robot.look(camera), robot.look(sun)
    front = seen.depth < still.view.depth
    colours = np.where(front[:, :, None], seen.colours, still.view.colours)
    depth = np.where(front, seen.depth, still.view.depth)
    lit_depth = np.minimum(still.lit_depth, lit.depth)
    # Only there the light is another: on the robot, and where the site lies behind it in the sun.
    row, column = np.nonzero((lit.depth < still.lit_depth) & np.isfinite(still.lit_depth))
    behind = camera.project(sun.unproject(column, row, still.lit_depth[row, column]))
    part = _about(np.vstack([np.argwhere(front)[:, ::-1], behind[:, :2]]), camera.size)
    dark = still.dark.copy()
    if part is not None:
        dark[part] = shadowed(camera, depth, sun, lit_depth, part)
    return LitView(CameraView(colours, depth), lit_depth, dark)


def _about(pixels: NDArray[np.float64], size: tuple[int, int]) -> tuple[slice, slice] | None:
    """The part of a picture, rows and columns, that has these pixels (column and row) in it and
    those near them; None if there are none."""
    if not len(pixels):
        return None
    (left, top), (right, bottom) = pixels.min(axis=0) - _NEAR, pixels.max(axis=0) + _NEAR
    columns = slice(max(0, int(left)), min(size[0], int(right) + 1))
    rows = slice(max(0, int(top)), min(size[1], int(bottom) + 1))
    return (rows, columns) if rows.start < rows.stop and columns.start < columns.stop else None


@lru_cache(maxsize=1)
def _digest_of_code() -> str:
    sink = hashlib.blake2b(digest_size=16)
    for folder in _CODE:
        for file in sorted(folder.glob("*.py")):
            sink.update(file.read_bytes())
    return sink.hexdigest()
