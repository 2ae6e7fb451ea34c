"""Sky, shadows and depth shading of a view, which the renderer omits to be fast."""

import numpy as np
import scipy
from numpy.typing import NDArray

from argo_env.pictures.camera import Camera
from argo_env.pictures.scene import CameraView
from argo_env.site import Site
from argo_env.world.pybullet_client import SUN

ALL = (slice(None), slice(None))
"""rows and columns of the whole picture"""
_SKY = np.array([(222, 231, 240), (247, 249, 251)], dtype=np.float64)
_SHADE = 0.66  # share of the brightness that remains in the shadow
_SUN_DISTANCE = 120.0  # m, far enough for rays that are nearly parallel
_BIAS = 0.06  # m that a lit surface may be behind the shadow map, whose pixels are coarse


def sky_colours(size: tuple[int, int]) -> NDArray[np.float64]:
    """Return colours of a sky that is lighter at the bottom, 0 to 255, shape (height, width, 3)."""
    width, height = size
    share = np.linspace(0.0, 1.0, height)[:, None, None]
    return np.broadcast_to(_SKY[0] + share * (_SKY[1] - _SKY[0]), (height, width, 3))


def shade_view(view: CameraView, brightness: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return the view on the backdrop, with each pixel dimmed to its brightness (0 to 1)."""
    height, width = view.depth.shape
    lit = (view.colours * brightness[:, :, None].astype(np.float32)).astype(np.uint8)
    empty = ~np.isfinite(view.depth)
    lit[empty] = sky_colours((width, height))[empty]
    return lit


def depth_shading(view: CameraView, radius: float, strength: float) -> NDArray[np.float64]:
    """Return brightness, up to 1, that sets things off from their background, shape as the depth.

    What is farther away than its surroundings gets darker: the depth buffer minus its blurred self
    (Luft, Colditz and Deussen, "Image enhancement by unsharp masking the depth buffer", 2006).

    Args:
        view: View to shade.
        radius: Radius of the blur in px.
        strength: Share of the brightness that is lost where the depth is 10 % over the blurred one.
    """
    seen = np.isfinite(view.depth)
    if not seen.any():
        return np.ones_like(view.depth)
    depth = np.log(np.where(seen, view.depth, view.depth[seen].max())).astype(np.float32)
    behind = (
        np.clip(depth - scipy.ndimage.gaussian_filter(depth, radius, truncate=2.0), 0.0, 0.1) * 10
    )
    return np.asarray(1.0 - strength * behind, dtype=np.float64)


def sun_camera(site: Site, size: int) -> Camera:
    """Return a camera at the sun, whose view of `size` px by `size` px is the shadow map."""
    x0, y0, x1, y1 = site.spec.ground
    top = site.spec.floors[-1].z + site.spec.storey
    middle = np.array([(x0 + x1) / 2, (y0 + y1) / 2, top / 2])
    reach = float(np.linalg.norm([x1 - x0, y1 - y0, top])) / 2
    eye = middle + _SUN_DISTANCE * np.array(SUN) / np.linalg.norm(SUN)
    return Camera(
        (float(eye[0]), float(eye[1]), float(eye[2])),
        (float(middle[0]), float(middle[1]), float(middle[2])),
        (size, size),
        2 * float(np.degrees(np.arctan(reach / _SUN_DISTANCE))),
        near=_SUN_DISTANCE - 2 * reach,
        far=_SUN_DISTANCE + 2 * reach,
    )


def shadow_mask(
    camera: Camera,
    depth: NDArray[np.float64],
    sun: Camera,
    lit_depth: NDArray[np.float64],
    part: tuple[slice, slice] = ALL,
) -> NDArray[np.bool_]:
    """Return a mask of the pixels in a part of the picture that the sun does not reach.

    Args:
        camera: Camera of the picture.
        depth: Depth (m) of the whole picture.
        sun: Camera at the sun.
        lit_depth: Depth (m) of the sun's view, which is the shadow map.
        part: Rows and columns of the part.

    Returns:
        Mask in the shape of the part.
    """
    within = depth[part]
    dark = np.zeros(within.shape, dtype=np.bool_)
    row, column = np.nonzero(np.isfinite(within))
    below, right = part[0].start or 0, part[1].start or 0
    points = camera.unproject(column + right, row + below, within[row, column])
    x, y, away = sun.project_with_depth(points).T
    width, height = sun.size
    # Points outside the map are lit.
    inside = (x >= 0) & (x < width) & (y >= 0) & (y < height)
    nearest = np.full(away.shape, np.inf)
    nearest[inside] = lit_depth[y[inside].astype(int), x[inside].astype(int)]
    dark[row, column] = away > nearest + _BIAS
    return dark


def shadow_brightness(dark: NDArray[np.bool_], softness: float) -> NDArray[np.float64]:
    """Return the brightness, from 0.66 to 1, of a picture with a mask of pixels in the shadow.

    The shadow's edges are blurred by `softness` px.
    """
    blurred = scipy.ndimage.gaussian_filter(dark.astype(np.float32), softness)
    return np.asarray(1.0 - (1.0 - _SHADE) * blurred, dtype=np.float64)
