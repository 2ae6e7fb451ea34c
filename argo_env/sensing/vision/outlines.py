"""Where the outline of a face is in a picture: bright patches of the right shape and size."""

import math

import numpy as np
from numpy.typing import NDArray

from argo_env.sensing.vision.align import FacePose
from argo_env.sensing.vision.instrument import Instrument
from argo_env.sensing.vision.photo import Photo

_THRESHOLDS = 10  # levels of brightness at which patches are cut out
_SMALLEST = 0.06  # of the area that the face would cover seen from the front
_UPRIGHT = 0.9  # cosine to the vertical of what may be an upright face
_FILLED = 0.8  # of an ellipse or rectangle that the hull of a patch must fill, and be filled by


def find_outlines(
    photo: Photo, instrument: Instrument, planned: FacePose
) -> list[tuple[float, FacePose]]:
    """The poses, with no roll, of all bright patches that could be the face, with how well the
    hull of each fills the outline (0 to 1)."""
    import cv2

    picture = cv2.GaussianBlur(photo.brightness, (0, 0), 1.0)
    low, high = np.percentile(picture, (2, 99))
    poses = []
    for level in np.linspace(low, high, _THRESHOLDS + 2)[1:-1]:
        patches, _ = cv2.findContours(
            (picture > level).astype(np.uint8), cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE
        )
        for patch in patches:
            poses += _poses(np.asarray(patch), photo, instrument, planned)
    return poses


def _poses(
    patch: NDArray[np.int32], photo: Photo, instrument: Instrument, planned: FacePose
) -> list[tuple[float, FacePose]]:
    """The poses of a face with this outline, shape (n, 1, 2) in px: turned to either side."""
    import cv2

    shape, eye, focal = instrument.shape, photo.pose.position, photo.lens.focal
    distance = float(np.linalg.norm(planned.center - eye))
    expected = 4 * shape.half_width * shape.half_height * (focal / distance) ** 2
    if len(patch) < 20:
        return []
    hull = np.asarray(cv2.convexHull(patch), dtype=np.int32)
    area = cv2.contourArea(hull)
    if not _SMALLEST * expected < area < 2 * expected:
        return []
    if shape.round:
        return _from_ellipse(hull if len(hull) >= 12 else patch, area, photo, instrument)
    return _from_corners(hull, area, photo, instrument, planned)


def _from_ellipse(
    outline: NDArray[np.int32], area: float, photo: Photo, instrument: Instrument
) -> list[tuple[float, FacePose]]:
    """The poses of a disc that is seen as this outline: turned to either side."""
    import cv2

    eye, focal = photo.pose.position, photo.lens.focal
    middle, axes, _ = cv2.fitEllipseDirect(outline)
    large, small = max(axes) / 2, min(axes) / 2
    if not math.isfinite(large) or small < 2:
        return []
    full = math.pi * large * small
    filled = min(area / full, full / area)
    if filled < _FILLED:
        return []
    centre = (photo.lens.size - 1) / 2
    column, row = (middle[0] - centre) / focal, (middle[1] - centre) / focal
    ray = photo.pose.rotation @ np.array([column, row, 1.0])
    back = -ray / np.linalg.norm(ray)
    toward, level = math.atan2(back[1], back[0]), math.hypot(back[0], back[1])
    away = math.acos(min(1.0, small / large / max(level, 1e-6)))
    found = []
    for radius, _ in instrument.outlines:
        x, y, z = (eye + ray * focal * radius / large).tolist()
        for side in (-1.0, 1.0):
            found.append((filled, FacePose(x, y, z, toward + side * away, 0.0)))
    return found


def _from_corners(
    hull: NDArray[np.int32],
    area: float,
    photo: Photo,
    instrument: Instrument,
    planned: FacePose,
) -> list[tuple[float, FacePose]]:
    """The poses of an upright rectangle whose four corners are those of the hull."""
    import cv2

    corners = cv2.approxPolyDP(hull, 0.03 * cv2.arcLength(hull, True), True)
    if len(corners) != 4:
        return []
    quad = corners[:, 0].astype(np.float64)
    filled = float(min(area / max(cv2.contourArea(corners), 1.0), 1.0))
    if filled < _FILLED:
        return []
    # Which corner is which: by how the vertical looks in the picture.
    up = photo.lens.project(
        planned.center + np.array([[0.0, 0.0, 0.05], [0.0, 0.0, 0.0]]), photo.pose
    )
    axis = up[0] - up[1]
    by_height = quad[np.argsort(-(quad @ axis), kind="stable")]
    aside = np.array([-axis[1], axis[0]])
    top, bottom = (
        pair[np.argsort(pair @ aside, kind="stable")] for pair in (by_height[:2], by_height[2:])
    )
    spots = np.array([top[0], top[1], bottom[1], bottom[0]])
    centre, focal = (photo.lens.size - 1) / 2, photo.lens.focal
    matrix = np.array([[focal, 0.0, centre], [0.0, focal, centre], [0.0, 0.0, 1.0]])
    found = []
    for width, height in instrument.outlines:
        flat = np.array(
            [[-width, height, 0], [width, height, 0], [width, -height, 0], [-width, -height, 0]]
        )
        for place in (flat, flat[[1, 0, 3, 2]]):
            _, turns, shifts, _ = cv2.solvePnPGeneric(
                place, spots, matrix, None, flags=cv2.SOLVEPNP_IPPE
            )
            for turn, shift in zip(turns, shifts, strict=True):
                rotation = photo.pose.rotation @ cv2.Rodrigues(turn)[0]
                # A rectangle that is not upright is none of a gauge; its front looks to the camera.
                if abs(rotation[2, 1]) < _UPRIGHT:
                    continue
                x, y, z = (photo.pose.position + photo.pose.rotation @ shift.ravel()).tolist()
                normal = rotation[:, 2]
                if normal @ (photo.pose.position - np.array([x, y, z])) < 0:
                    normal = -normal
                found.append((filled, FacePose(x, y, z, math.atan2(normal[1], normal[0]), 0.0)))
    return found
