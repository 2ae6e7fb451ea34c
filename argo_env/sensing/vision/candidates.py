"""Coarse search for a face in a picture, by correlation at many turns and distances."""

import math
from dataclasses import replace
from functools import cache
from itertools import product

import numpy as np
from numpy.typing import NDArray

from argo_env.sensing.vision.align import FacePose
from argo_env.sensing.vision.faces import PIXELS_PER_METRE
from argo_env.sensing.vision.instrument import Instrument, blurred_texture, texture
from argo_env.sensing.vision.photo import Photo
from argo_env.world.placement import MAX_OFFSET

_HALF_WIDTH = 11.0  # px, half the width of a face in the picture that is searched
_STEP = math.radians(12)  # between the turns that are tried
_DEPTHS = (-0.075, 0.0, 0.075)  # m, deviations from the planned distance that are tried
_STEEPEST = math.radians(76)  # obliqueness beyond which a face is not searched for
_MAX_CANDIDATES = 24  # that are returned
_BLUR = 0.003  # m, of the drawn face
_BODY = 0.22  # brightness of the bodies behind the faces


def find_candidates(photo: Photo, instrument: Instrument, planned: FacePose) -> list[FacePose]:
    """Return poses at which the picture is similar to the face, the most similar ones first.

    They are near the planned pose, and at most `_MAX_CANDIDATES`. Their roll is 0: a round face is
    compared as the average over all rolls, any other one upright.
    """
    import cv2

    eye = photo.pose.position
    distance = float(np.linalg.norm(planned.center - eye))
    width = instrument.shape.half_width * photo.lens.focal / distance
    shrink = min(1.0, _HALF_WIDTH / width)
    small = cv2.resize(photo.brightness, None, fx=shrink, fy=shrink, interpolation=cv2.INTER_AREA)
    scale = small.shape[0] / photo.lens.size
    toward = math.atan2(eye[1] - planned.y, eye[0] - planned.x)
    scored: list[tuple[float, FacePose]] = []
    turns = np.arange(-math.pi / 2, math.pi / 2 + 1e-9, _STEP)
    for turn, depth in product(turns.tolist(), _DEPTHS):
        yaw = planned.yaw + turn
        if math.cos(yaw - toward) < math.cos(_STEEPEST):
            continue
        center = eye + (planned.center - eye) * (distance + depth) / distance
        patch = _patch(photo, instrument, replace(_face_at(center, yaw), roll=0.0), scale)
        if patch is None or min(np.subtract(small.shape, patch[0].shape)) < 1:
            continue
        appearance, mask = patch
        likeness = np.asarray(
            cv2.matchTemplate(small, appearance, cv2.TM_CCOEFF_NORMED, mask=mask), dtype=np.float64
        )
        likeness = np.where(np.isfinite(likeness) & (np.abs(likeness) <= 1.001), likeness, -1.0)
        half = (np.array(appearance.shape[::-1]) - 1) / 2
        for _ in range(4):
            row, column = np.unravel_index(int(likeness.argmax()), likeness.shape)
            value = float(likeness[row, column])
            if value < 0.25:
                break
            spot = ((np.array([column, row]) + half + 0.5) / scale) - 0.5
            scored.append((value, _face_at(_point_at(photo, spot, distance + depth), yaw)))
            likeness[max(0, row - 4) : row + 5, max(0, column - 4) : column + 5] = -1.0
    scored.sort(key=lambda pair: -pair[0])
    chosen: list[FacePose] = []
    for _, pose in scored:
        if np.linalg.norm(pose.center - planned.center) > MAX_OFFSET + 0.06:
            continue
        if all(
            np.linalg.norm(pose.center - other.center) > 0.025
            or abs(pose.yaw - other.yaw) > 1.5 * _STEP
            for other in chosen
        ):
            chosen.append(pose)
        if len(chosen) == _MAX_CANDIDATES:
            break
    return chosen


def _face_at(center: NDArray[np.float64], yaw: float) -> FacePose:
    x, y, z = center.tolist()
    return FacePose(x, y, z, yaw, 0.0)


def _point_at(photo: Photo, spot: NDArray[np.float64], distance: float) -> NDArray[np.float64]:
    """Return the point (m) at a distance from the camera that is seen at column and row `spot`."""
    middle = (photo.lens.size - 1) / 2
    ray = photo.pose.rotation @ np.array([*((spot - middle) / photo.lens.focal), 1.0])
    return np.asarray(photo.pose.position + ray * distance / np.linalg.norm(ray))


def _patch(
    photo: Photo, instrument: Instrument, pose: FacePose, scale: float
) -> tuple[NDArray[np.float32], NDArray[np.float32]] | None:
    """Render the face at `pose` as in the photo resized by the factor `scale` (at most 1).

    Returns the brightness and a mask of the pixels that belong to the instrument, or None if the
    face is too thin to be seen. A round face is averaged over all rolls.
    """
    shape = instrument.shape
    aspect = shape.half_height / shape.half_width
    slices = ((-shape.depth, shape.half_width), *instrument.body)
    corners = np.array(
        [
            [x, y * half, z * half * aspect]
            for x, half in slices
            for y, z in product((-1.0, 1.0), repeat=2)
        ]
    )
    spots = photo.lens.project(pose.to_site(corners), photo.pose) * scale
    low, high = spots.min(axis=0), spots.max(axis=0)
    size = np.ceil(high - low).astype(int) + 1
    if size.min() < 4:
        return None
    # Project the pixels of the patch back onto the plane of the face.
    columns, rows = np.meshgrid(np.arange(size[0]), np.arange(size[1]))
    middle = (photo.lens.size - 1) / 2
    center = (low + high) / 2
    u = (columns - (size[0] - 1) / 2 + center[0]) / scale - middle
    v = (rows - (size[1] - 1) / 2 + center[1]) / scale - middle
    rays = np.stack([u, v, np.full(u.shape, photo.lens.focal)], axis=-1) @ photo.pose.rotation.T
    normal = pose.normal
    appearance = np.full(u.shape, _BODY)
    mask = np.zeros(u.shape, dtype=bool)
    for x, half in reversed(slices):
        reach = ((pose.center + x * normal - photo.pose.position) @ normal) / (rays @ normal)
        points = photo.pose.position + rays * reach[..., None] - pose.center
        across = points @ np.array([-math.sin(pose.yaw), math.cos(pose.yaw), 0.0])
        up = points[..., 2]
        if shape.round:
            inside = np.hypot(across, up) < half
        else:
            inside = (np.abs(across) < half) & (np.abs(up) < half * aspect)
        mask |= inside
    # The last slice is the face itself.
    appearance = np.where(inside, _face_brightness(instrument, across, up), appearance)
    return appearance.astype(np.float32), mask.astype(np.float32)


def _face_brightness(
    instrument: Instrument, across: NDArray[np.float64], up: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the brightness of the face at points on it (m); a round one is averaged over rolls."""
    shape = instrument.shape
    if shape.round:
        profile = _profile(instrument)
        radius = np.hypot(across, up) * 1000
        return np.asarray(profile[np.minimum(radius.astype(int), len(profile) - 1)])
    image = blurred_texture(instrument.kind, _BLUR)
    column = np.clip((across + shape.half_width) * PIXELS_PER_METRE, 0, image.shape[1] - 1)
    row = np.clip((shape.half_height - up) * PIXELS_PER_METRE, 0, image.shape[0] - 1)
    return np.asarray(image[row.astype(int), column.astype(int)])


@cache
def _profile(instrument: Instrument) -> NDArray[np.float64]:
    """Return the mean brightness of a round face at each mm of radius."""
    image = texture(instrument.kind)
    height, width = image.shape
    rows, columns = np.indices(image.shape)
    radius = np.hypot(rows - height / 2, columns - width / 2) / PIXELS_PER_METRE * 1000
    ring = radius.astype(int).ravel()
    mean = np.bincount(ring, image.ravel()) / np.maximum(np.bincount(ring), 1)
    mean = mean[: int(instrument.shape.half_width * 1000) + 1]
    mean[: int(instrument.hidden_radius * 1000)] = 0.3
    return np.asarray(mean)
