"""Light on a view: what the renderer leaves out to be fast."""

import numpy as np
import scipy
from numpy.typing import NDArray

from argo_env.pictures.camera import Camera
from argo_env.pictures.scene import CameraView, Scene
from argo_env.world.pybullet_client import SUN

_SKY = np.array([(222, 231, 240), (247, 249, 251)], dtype=np.float64)
_SHADE = 0.66  # of its brightness is left to what lies in the shadow
_SUN_DISTANCE = 120.0  # m: far enough for rays that are nearly parallel
_BIAS = 0.06  # m that a surface may lie behind the shadow map, which has pixels


def backdrop(size: tuple[int, int]) -> NDArray[np.float64]:
    """A soft sky, light at the bottom, shape (height, width, 3)."""
    width, height = size
    share = np.linspace(0.0, 1.0, height)[:, None, None]
    return np.broadcast_to(_SKY[0] + share * (_SKY[1] - _SKY[0]), (height, width, 3))


def compose(view: CameraView, brightness: NDArray[np.float64]) -> NDArray[np.uint8]:
    """The view with each pixel dimmed to its brightness (0 to 1), on the backdrop."""
    height, width = view.depth.shape
    lit = (view.colours * brightness[:, :, None].astype(np.float32)).astype(np.uint8)
    empty = ~np.isfinite(view.depth)
    lit[empty] = backdrop((width, height))[empty]
    return lit


def depth_shading(view: CameraView, radius: float, strength: float) -> NDArray[np.float64]:
    """Brightness that sets things off from what lies behind them, shape (height, width).

    What is farther away than its surroundings gets darker: the depth buffer minus its blurred
    self (Luft, Colditz and Deussen, "Image enhancement by unsharp masking the depth buffer",
    2006). `radius` is that of the blur in px, `strength` the darkening for a step of 1 in 10.
    """
    seen = np.isfinite(view.depth)
    if not seen.any():
        return np.ones_like(view.depth)
    depth = np.log(np.where(seen, view.depth, view.depth[seen].max())).astype(np.float32)
    behind = (
        np.clip(depth - scipy.ndimage.gaussian_filter(depth, radius, truncate=2.0), 0.0, 0.1) * 10
    )
    return np.asarray(1.0 - strength * behind, dtype=np.float64)


def shadows(
    scene: Scene, camera: Camera, view: CameraView, size: int, softness: float
) -> NDArray[np.float64]:
    """Brightness after the sun's shadows, shape (height, width), from 0.66 to 1.

    A shadow map: the depth of the site as seen from the sun, `size` px wide, is compared with that
    of each pixel; edges are blurred by `softness` px.
    """
    x0, y0, x1, y1 = scene.site.spec.ground
    top = scene.site.spec.floors[-1].z + scene.site.spec.storey
    middle = np.array([(x0 + x1) / 2, (y0 + y1) / 2, top / 2])
    reach = float(np.linalg.norm([x1 - x0, y1 - y0, top])) / 2
    eye = middle + _SUN_DISTANCE * np.array(SUN) / np.linalg.norm(SUN)
    sun = Camera(
        (float(eye[0]), float(eye[1]), float(eye[2])),
        (float(middle[0]), float(middle[1]), float(middle[2])),
        (size, size),
        2 * float(np.degrees(np.arctan(reach / _SUN_DISTANCE))),
        near=_SUN_DISTANCE - 2 * reach,
        far=_SUN_DISTANCE + 2 * reach,
    )
    lit_depth = scene.look(sun).depth
    seen = np.isfinite(view.depth)
    points = camera.unproject(np.where(seen, view.depth, 1.0))[seen]
    column, row, depth = sun.project(points).T
    # What lies outside of the map is lit.
    inside = (column >= 0) & (column < size) & (row >= 0) & (row < size)
    nearest = np.full(depth.shape, np.inf)
    nearest[inside] = lit_depth[row[inside].astype(int), column[inside].astype(int)]
    dark = np.zeros(view.depth.shape, dtype=np.float32)
    dark[seen] = depth > nearest + _BIAS
    return np.asarray(
        1.0 - (1.0 - _SHADE) * scipy.ndimage.gaussian_filter(dark, softness), dtype=np.float64
    )
