"""A picture of the whole site, with the path that the robot drove.

The view of the site alone is the same for all runs on it, so it is rendered once and cached. A
picture of the site and the robot takes, for each pixel, the nearer one of two views: of the site
alone, and of the robot alone.
"""

import hashlib
import io
import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from argo_compiler.files.atomic_write import write_atomically
from argo_env.files import cache
from argo_env.files.folders import CHOOSE_ANOTHER_PLACE, reporting_write_errors
from argo_env.pictures.camera import Camera
from argo_env.pictures.light import (
    depth_shading,
    shade_view,
    shadow_brightness,
    shadow_mask,
    sun_camera,
)
from argo_env.pictures.motion import RecordedMotion, check_record_site
from argo_env.pictures.scene import CameraView, Scene
from argo_env.report.track import colour
from argo_env.robot.spec import RobotSpec
from argo_env.run.record import RunRecord
from argo_env.site import Site

_HERE = Path(__file__).parent
_CODE = (_HERE, _HERE.parent / "site", _HERE.parent / "world")
"""folders of the code that pictures depend on"""
_NEAR = 60  # px about a pixel: a pixel of the shadow map covers several in the picture


@dataclass(frozen=True)
class LitView:
    """View of a camera, and the part of it that the sun reaches."""

    view: CameraView
    lit_depth: NDArray[np.float64]
    """length of the sun's rays in m, shape (height, width) of the shadow map"""
    dark: NDArray[np.bool_]
    """mask of the view's pixels in the shadow, shape (height, width)"""


def view_without_robot(site: Site, robot: RobotSpec, camera: Camera, sun: Camera) -> LitView:
    """Return the view of the site without the robot, from the cache if it was rendered before."""
    key = (_digest_of_code(), repr(site.elements), repr(site.checkpoints), repr((camera, sun)))

    def render_site() -> dict[str, NDArray[Any]]:
        with Scene(site, robot) as scene:
            seen, lit = scene.render_from(camera), scene.render_from(sun)
        # The renderer has single precision.
        return {
            "colours": seen.colours,
            "depth": seen.depth.astype(np.float32),
            "lit_depth": lit.depth.astype(np.float32),
            "dark": shadow_mask(camera, seen.depth, sun, lit.depth),
        }

    arrays = cache.entry_for(key).load_or_make("overview", render_site)
    view = CameraView(arrays["colours"], arrays["depth"].astype(np.float64))
    return LitView(view, arrays["lit_depth"].astype(np.float64), arrays["dark"])


def add_robot(site_only: LitView, robot: Scene, camera: Camera, sun: Camera) -> LitView:
    """Return the view of the site with the robot in it, and with its shadow.

    Args:
        site_only: View of the site alone, from `camera` and with the shadow map of `sun`.
        robot: Scene that contains the robot alone.
        camera: Camera of the view.
        sun: Camera at the sun.
    """
    seen, lit = robot.render_from(camera), robot.render_from(sun)
    front = seen.depth < site_only.view.depth
    colours = np.where(front[:, :, None], seen.colours, site_only.view.colours)
    depth = np.where(front, seen.depth, site_only.view.depth)
    lit_depth = np.minimum(site_only.lit_depth, lit.depth)
    # The light only changes on the robot, and where its shadow falls on the site.
    row, column = np.nonzero((lit.depth < site_only.lit_depth) & np.isfinite(site_only.lit_depth))
    behind = camera.project_with_depth(sun.unproject(column, row, site_only.lit_depth[row, column]))
    part = _part_around(np.vstack([np.argwhere(front)[:, ::-1], behind[:, :2]]), camera.size)
    dark = site_only.dark.copy()
    if part is not None:
        dark[part] = shadow_mask(camera, depth, sun, lit_depth, part)
    return LitView(CameraView(colours, depth), lit_depth, dark)


def _part_around(pixels: NDArray[np.float64], size: tuple[int, int]) -> tuple[slice, slice] | None:
    """Return the rows and columns of a picture that contain some pixels and those near them.

    `pixels` are columns and rows, shape (n, 2). The result is None if none of them is in the
    picture.
    """
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


SIZE = (1200, 900)
"""width and height in px"""
_FINER = 2  # factor by which the picture is drawn larger and then reduced, for smooth edges
_SHADOW_MAP = 1600  # px
_PATH_HEIGHT = 0.25  # m above the robot's tracks at which its path is drawn
_PATH_STEP = 0.05  # m between the points of the drawn path
_PATH_WIDTH = 5  # px
_HIDDEN_WIDTH = 4  # px
_HIDDEN_OPACITY = 0.8
_DASH = 9  # px
_TOLERANCE = 0.3  # m that a visible point may be behind the surface at its pixel
_INK = (23, 32, 42)
_NORMAL, _ABNORMAL = (16, 128, 84), (196, 43, 43)


def write_overview(record: RunRecord, site: Site, robot: RobotSpec, file: Path) -> None:
    """Write a PNG of SIZE of the site seen from the south-west, with the driven path.

    The path's colour depends on the time, as in the report; it is dashed where something hides it.
    Checkpoints with a reading are labelled with their ids, red if the last one is not nominal.

    Raises:
        ArgoError: The record is of another site or has no path, or the file can't be written.
    """
    check_record_site(record, site)
    motion = RecordedMotion(record, robot)
    camera = site_camera(site, (SIZE[0] * _FINER, SIZE[1] * _FINER))
    sun = sun_camera(site, _SHADOW_MAP)
    site_only = view_without_robot(site, robot, camera, sun)
    with Scene(None, robot) as scene:
        scene.place_robot(motion.pose_at(motion.end_time), motion.joint_degrees_at(motion.end_time))
        lit = add_robot(site_only, scene, camera, sun)
    view = lit.view
    brightness = shadow_brightness(lit.dark, float(_FINER))
    brightness *= depth_shading(view, 10.0 * _FINER, 0.3)
    image = Image.fromarray(shade_view(view, brightness))
    _draw_path(image, record, motion, camera, view)
    _draw_markers(image, record, site, motion, camera)
    content = io.BytesIO()
    image.resize(SIZE, Image.Resampling.LANCZOS).save(content, "png")
    with reporting_write_errors(file, "the picture", CHOOSE_ANOTHER_PLACE):
        write_atomically(file, content.getvalue())


def site_camera(site: Site, size: tuple[int, int]) -> Camera:
    """Return a camera above the south-west of the site that has the whole site in view."""
    x0, y0, x1, y1 = site.spec.ground
    low, high = site.spec.ground_z, site.spec.floors[-1].z + site.spec.storey
    middle = np.array([(x0 + x1) / 2, (y0 + y1) / 2, low + 0.37 * (high - low)])
    reach = float(np.linalg.norm([x1 - x0, y1 - y0, high - low])) / 2
    eye = middle + 2.66 * reach * np.array([-0.60, -0.71, 0.37])
    return Camera(
        (float(eye[0]), float(eye[1]), float(eye[2])),
        (float(middle[0]), float(middle[1]), float(middle[2])),
        size,
        38.0,
        near=reach / 2,
        far=8 * reach,
    )


def _draw_path(
    image: Image.Image, record: RunRecord, motion: RecordedMotion, camera: Camera, view: CameraView
) -> None:
    """Draw the path over the picture: hidden parts dashed and faint, the others on top."""
    times = np.array(list(_path_times(record)))
    poses = [motion.pose_at(float(t)) for t in times]
    points = np.array([(p.x, p.y, p.z + _PATH_HEIGHT) for p in poses])
    pixels = camera.project_with_depth(points)
    seen = _visible(pixels, view)
    end = motion.end_time or 1.0
    faint = Image.new("RGBA", image.size, (0, 0, 0, 0))
    clear = Image.new("RGBA", image.size, (0, 0, 0, 0))
    on_faint, on_clear = ImageDraw.Draw(faint), ImageDraw.Draw(clear)
    length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(pixels[:, :2], axis=0).T))])
    rounds = [(on_clear, 3 * _FINER, (255, 255, 255)), (on_clear, 0, None)]
    for k, (a, b) in enumerate(pairwise(pixels)):
        if not (seen[k] and seen[k + 1]) and length[k] // (_DASH * _FINER) % 2 == 0:
            _stroke(on_faint, a, b, _HIDDEN_WIDTH * _FINER, colour(times[k] / end))
    for draw, wider, white in rounds:
        for k, (a, b) in enumerate(pairwise(pixels)):
            if seen[k] and seen[k + 1]:
                ink = white or colour(times[k] / end)
                _stroke(draw, a, b, _PATH_WIDTH * _FINER + wider, ink)
    faint.putalpha(faint.getchannel("A").point(lambda a: round(a * _HIDDEN_OPACITY)))
    image.paste(faint, mask=faint)
    image.paste(clear, mask=clear)


def _path_times(record: RunRecord) -> Iterator[float]:
    """Yield times (s) between which the robot moves by no more than 5 cm."""
    for a, b in pairwise(record.path):
        away = math.dist((a.x, a.y, a.z), (b.x, b.y, b.z))
        count = math.ceil(away / _PATH_STEP)
        yield from (a.t + (b.t - a.t) * k / count for k in range(count))
    yield record.path[-1].t


def _visible(pixels: NDArray[np.float64], view: CameraView) -> NDArray[np.bool_]:
    """Return a mask of the points of a path that nothing in the view hides.

    The majority of seven consecutive points decides for the middle one.

    Args:
        pixels: Column and row (px) and depth (m) of the points, in the path's order, shape (n, 3).
        view: View of the scene without the path.
    """
    height, width = view.depth.shape
    column = np.clip(pixels[:, 0].astype(int), 0, width - 1)
    row = np.clip(pixels[:, 1].astype(int), 0, height - 1)
    free = (pixels[:, 2] < view.depth[row, column] + _TOLERANCE).astype(float)
    # A railing in front of the path does not hide it.
    around = np.convolve(np.pad(free, 3, mode="edge"), np.ones(7) / 7, mode="valid")
    return np.asarray(around > 0.5)


def _stroke(
    draw: ImageDraw.ImageDraw,
    a: NDArray[np.float64],
    b: NDArray[np.float64],
    width: int,
    ink: str | tuple[int, int, int],
) -> None:
    """Draw a line with a round end."""
    draw.line([(a[0], a[1]), (b[0], b[1])], fill=ink, width=width)
    half = width / 2 - 0.5
    draw.ellipse([b[0] - half, b[1] - half, b[0] + half, b[1] + half], fill=ink)


def _draw_markers(
    image: Image.Image, record: RunRecord, site: Site, motion: RecordedMotion, camera: Camera
) -> None:
    draw = ImageDraw.Draw(image)
    font = ImageFont.load_default(21.0 * _FINER)
    labels: dict[tuple[float, float, float], tuple[str, str | tuple[int, int, int]]] = {}
    first, last = motion.pose_at(0.0), motion.pose_at(motion.end_time)
    together = math.dist((first.x, first.y, first.z), (last.x, last.y, last.z)) < 1.0
    if not together:
        labels[(last.x, last.y, last.z + _PATH_HEIGHT)] = ("end", colour(1.0))
    start = "start and end" if together else "start"
    labels[(first.x, first.y, first.z + _PATH_HEIGHT)] = (start, colour(0.0))
    for reading in record.readings:
        position = site.checkpoint(reading.checkpoint).position
        labels[position] = (str(reading.checkpoint), _NORMAL if reading.normal else _ABNORMAL)
    pixels = camera.project_with_depth(np.array(list(labels)))
    # The nearest are drawn last, so that they are on top.
    for index in np.argsort(-pixels[:, 2], kind="stable"):
        text, ink = list(labels.values())[index]
        _pin(draw, float(pixels[index, 0]), float(pixels[index, 1]), text, ink, font)


def _pin(
    draw: ImageDraw.ImageDraw,
    x: float,
    y: float,
    text: str,
    ink: str | tuple[int, int, int],
    font: ImageFont.ImageFont | ImageFont.FreeTypeFont,
) -> None:
    """Draw a label above a dot at (x, y) in px, with a line between them.

    The dot and the box of the label have the colour `ink`; the text in the box is white.
    """
    n = _FINER
    half = max(17 * n, draw.textlength(text, font=font) / 2 + 11 * n)
    middle, radius = y - 44 * n, 17 * n
    draw.line([(x, y), (x, middle)], fill=(255, 255, 255), width=5 * n)
    draw.line([(x, y), (x, middle)], fill=_INK, width=2 * n)
    draw.ellipse(
        [x - 6 * n, y - 6 * n, x + 6 * n, y + 6 * n], fill=ink, outline=(255, 255, 255), width=2 * n
    )
    draw.rounded_rectangle(
        [x - half, middle - radius, x + half, middle + radius],
        radius=radius,
        fill=ink,
        outline=(255, 255, 255),
        width=2 * n + 1,
    )
    draw.text((x, middle), text, fill=(255, 255, 255), font=font, anchor="mm")
