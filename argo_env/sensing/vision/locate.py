"""Search for a face in a picture.

First come bright patches of the right shape and size, then their rolls, then the exact pose.
"""

import math
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from argo_env.sensing.vision.align import FacePose, Fit, compare, refine, sample_image
from argo_env.sensing.vision.candidates import find_candidates
from argo_env.sensing.vision.faces import PIXELS_PER_METRE
from argo_env.sensing.vision.instrument import (
    Instrument,
    Template,
    blurred_texture,
    make_template,
)
from argo_env.sensing.vision.photo import Photo
from argo_env.world.placement import MAX_OFFSET, MAX_TURN

_THRESHOLDS = 10  # levels of brightness at which patches are cut out
_SMALLEST = 0.06  # of the area that the face would cover if seen from the front
_UPRIGHT = 0.9  # cosine to the vertical, at least, of an upright face
_FILLED = 0.8  # ratio of the areas of a patch's hull and of its ellipse or rectangle, at least


def find_unsorted_poses_by_outline(
    photo: Photo, instrument: Instrument, planned: FacePose
) -> list[tuple[float, FacePose]]:
    """Return the poses, without roll, of all bright patches of the picture that could be the face.

    Each pose comes after a number from 0 to 1: how well the hull of the patch fills the outline of
    a face. `planned` is the planned pose of the face.
    """
    import cv2

    picture = cv2.GaussianBlur(photo.brightness, (0, 0), 1.0)
    low, high = np.percentile(picture, (2, 99))
    poses = []
    for level in np.linspace(low, high, _THRESHOLDS + 2)[1:-1]:
        patches, _ = cv2.findContours(
            (picture > level).astype(np.uint8), cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE
        )
        for patch in patches:
            poses += _poses_from_patch(np.asarray(patch), photo, instrument, planned)
    return poses


def _poses_from_patch(
    patch: NDArray[np.int32], photo: Photo, instrument: Instrument, planned: FacePose
) -> list[tuple[float, FacePose]]:
    """Return the possible poses of a face with this outline, shape (n, 1, 2) in px.

    Each comes after a number, as in `find_unsorted_poses_by_outline`.
    """
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
        return _poses_from_ellipse(hull if len(hull) >= 12 else patch, area, photo, instrument)
    return _poses_from_corners(hull, area, photo, instrument, planned)


def _poses_from_ellipse(
    outline: NDArray[np.int32], area: float, photo: Photo, instrument: Instrument
) -> list[tuple[float, FacePose]]:
    """Return the poses of a disc that is seen as this outline: it may be turned to either side."""
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
    poses = []
    for radius, _ in instrument.outlines:
        x, y, z = (eye + ray * focal * radius / large).tolist()
        for side in (-1.0, 1.0):
            poses.append((filled, FacePose(x, y, z, toward + side * away, 0.0)))
    return poses


def _poses_from_corners(
    hull: NDArray[np.int32],
    area: float,
    photo: Photo,
    instrument: Instrument,
    planned: FacePose,
) -> list[tuple[float, FacePose]]:
    """Return the poses of an upright rectangle whose four corners are those of the hull."""
    import cv2

    corners = cv2.approxPolyDP(hull, 0.03 * cv2.arcLength(hull, True), True)
    if len(corners) != 4:
        return []
    quad = corners[:, 0].astype(np.float64)
    filled = float(min(area / max(cv2.contourArea(corners), 1.0), 1.0))
    if filled < _FILLED:
        return []
    # Assign the corners by the direction of the vertical in the picture.
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
    poses = []
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
                # Gauges are upright, and turn their front to the camera.
                if abs(rotation[2, 1]) < _UPRIGHT:
                    continue
                x, y, z = (photo.pose.position + photo.pose.rotation @ shift.ravel()).tolist()
                normal = rotation[:, 2]
                if normal @ (photo.pose.position - np.array([x, y, z])) < 0:
                    normal = -normal
                poses.append((filled, FacePose(x, y, z, math.atan2(normal[1], normal[0]), 0.0)))
    return poses


_ROLLS = np.radians(np.arange(-93, 94, 3))
_DARKEST = 0.03  # of full scale: faces whose white is darker are ignored


def template_spacing(instrument: Instrument) -> float:
    """Return the distance (m) between the points of the face's template (see `make_template`)."""
    return 0.004 if instrument.shape.round else 0.0045


@dataclass(frozen=True)
class _RolledFaces:
    """A face at every roll: its brightness and weights at equal points, shape (rolls, points)."""

    template: Template
    brightness: NDArray[np.float32]
    weights: NDArray[np.float32]


@cache
def _rolled_faces(instrument: Instrument, blur: float) -> _RolledFaces:
    template = make_template(instrument, 1.5 * template_spacing(instrument), blur)
    faces = template.brightness[None]
    if instrument.rolled:
        image = blurred_texture(instrument.kind, blur)
        half = instrument.shape.half_width
        y, z = template.points[:, 1], template.points[:, 2]
        cos, sin = np.cos(_ROLLS)[:, None], np.sin(_ROLLS)[:, None]
        column = ((half + y * cos + z * sin) * PIXELS_PER_METRE).astype(int)
        row = ((half - z * cos + y * sin) * PIXELS_PER_METRE).astype(int)
        faces = image[np.clip(row, 0, image.shape[0] - 1), np.clip(column, 0, image.shape[1] - 1)]
    bright = faces > (faces.min() + faces.max()) / 2
    weights = np.where(
        bright,
        0.5 / bright.sum(axis=1, keepdims=True),
        0.5 / (~bright).sum(axis=1, keepdims=True),
    )
    return _RolledFaces(template, faces.astype(np.float32), weights.astype(np.float32))


def likely_rolls(
    photo: Photo, instrument: Instrument, pose: FacePose, blur: float
) -> list[tuple[float, FacePose]]:
    """Return `pose` with each of the three rolls at which the face is most similar to the picture.

    Each comes after its likeness from 0 to 1, the most similar first. For an instrument that can't
    be rolled, the only roll is 0. The list is empty if too little of the face is visible, or if the
    picture is too dark. `blur` (m) is that of the face to compare with.
    """
    faces = _rolled_faces(instrument, blur)
    spots = photo.lens.project(pose.to_site(faces.template.points), photo.pose)
    values = sample_image(photo.brightness, spots)
    red = sample_image(photo.redness, spots)
    seen = np.isfinite(values) & ~(red > 0.35)
    if seen.sum() < len(seen) / 4:
        return []
    values = values[seen].astype(np.float32)
    # Most of a face is white; black reflects nearly nothing.
    white = float(np.percentile(values, 70)) / float(faces.brightness.max())
    if white < _DARKEST:
        return []
    weights = faces.weights[:, seen]
    difference = (values - white * faces.brightness[:, seen]) / (0.35 * white)
    likeness = (weights * np.exp(-(difference**2))).sum(axis=1) / weights.sum(axis=1)
    if not instrument.rolled:
        return [(float(likeness[0]), replace(pose, roll=0.0))]
    poses = []
    for _ in range(3):
        best = int(likeness.argmax())
        poses.append((float(likeness[best]), replace(pose, roll=float(_ROLLS[best]))))
        likeness = np.where(np.abs(_ROLLS - _ROLLS[best]) > math.radians(12), likeness, -1.0)
    return poses


_MAX_OUTLINES = 30  # whose rolls are compared
_MAX_FITS = 7  # poses that are fitted
_GOOD_MATCH = 0.86  # match from which the search ends after the outlines
_LIKENESS_SLACK = 0.12  # by how much the likeness of another pose may be lower for it to be tried
_SURE_MATCH = 0.94  # match from which no other candidate is tried
_OWN_BLUR = 1.1  # px, of the pictures themselves
_BLUR_STEP = 0.0003  # m
_ROUGH, _SOFT, _SHARP = 0.006, 0.003, 0.0012  # m, blur of the drawn face in successive fits
_SLACK = 0.015  # m, and times 10 in rad, that a pose may exceed the limits of displacements


def find_face(photo: Photo, instrument: Instrument, planned: FacePose) -> Fit | None:
    """Search the picture for the face, and return the best fit, or None if no face is found.

    Only poses are searched to which a fault can displace the instrument from `planned`: at most
    `MAX_OFFSET` and `MAX_TURN` away, with some slack.
    """
    pixel_size = _pixel_size(photo, planned.center)
    rough, fine = photo.blurred(_ROUGH / pixel_size), photo.blurred(_SOFT / pixel_size)
    outlines = [
        (filled, pose)
        for filled, pose in find_unsorted_poses_by_outline(photo, instrument, planned)
        if _is_allowed(pose, planned, 0.03)
    ]
    starts: list[tuple[float, FacePose]] = []
    for candidate in _best_distinct(outlines, _MAX_OUTLINES):
        starts += likely_rolls(fine, instrument, candidate, _SOFT)
        starts += likely_rolls(rough, instrument, candidate, _ROUGH)
    best = _best_fit(photo, rough, fine, instrument, planned, starts)
    if best is not None and best.match > _GOOD_MATCH:
        return best
    # The outline may be partly hidden, or merge with the background.
    starts = []
    for candidate in find_candidates(photo, instrument, planned):
        starts += likely_rolls(rough, instrument, candidate, _ROUGH)
    other = _best_fit(photo, rough, fine, instrument, planned, starts)
    return max((f for f in (best, other) if f), key=lambda fit: fit.match, default=None)


def _best_fit(
    photo: Photo,
    rough: Photo,
    fine: Photo,
    instrument: Instrument,
    planned: FacePose,
    starts: list[tuple[float, FacePose]],
) -> Fit | None:
    """Return the fit with the highest match from the most likely start poses.

    Returns None if none leads to a pose that a displacement from `planned` can lead to. `rough` and
    `fine` are the photo with the blur `_ROUGH` and `_SOFT` (m). Each start comes with its likeness.
    """
    fits = []
    for pose in _best_distinct(starts, _MAX_FITS):
        for blur, blurred in ((_ROUGH, rough), (_SOFT, fine)):
            template = make_template(instrument, template_spacing(instrument), blur)
            fit = refine(blurred, template, pose, instrument.rolled, 8)
            pose = fit.pose
        if _is_allowed(fit.pose, planned):
            fits.append(fit)
            if fit.match > _SURE_MATCH:
                break
    fits.sort(key=lambda fit: -fit.match)
    sharp = [find_face_near(photo, instrument, fit.pose) for fit in fits[:2]]
    return max(
        (f for f in sharp if _is_allowed(f.pose, planned)), key=lambda f: f.match, default=None
    )


def find_face_near(photo: Photo, instrument: Instrument, pose: FacePose) -> Fit:
    """Return the fit with the highest match near `pose`, or near a pose that looks similar.

    A face that is turned to the left looks similar to one that is turned to the right, and a scale
    is similar to itself when shifted by a few marks: so such poses are tried too.
    """
    best = refine_coarse_to_fine(photo, instrument, pose)
    if best.match > _SURE_MATCH:
        return best
    fine = photo.blurred(_SOFT / _pixel_size(photo, pose.center))
    here = likely_rolls(fine, instrument, best.pose, _SOFT)
    starts = list(here)
    for start in (_mirrored_pose(best.pose, photo), *_shifted_poses(best.pose, photo, instrument)):
        starts += likely_rolls(fine, instrument, start, _SOFT)
    as_good = max((likeness for likeness, _ in here), default=0.0) - _LIKENESS_SLACK
    others = _best_distinct([s for s in starts if s[0] > as_good], 4)
    # A face that is turned to the other side also has another position, which the fit must find.
    others.insert(0, _mirrored_pose(best.pose, photo))
    for other in others:
        if _differ(other, best.pose):
            best = max(
                best, refine_coarse_to_fine(photo, instrument, other), key=lambda fit: fit.match
            )
    return best


def _shifted_poses(pose: FacePose, photo: Photo, instrument: Instrument) -> list[FacePose]:
    """Return poses at which a straight scale looks similar, with its marks over other marks."""
    if instrument.rolled:
        return []
    sight = pose.center - photo.pose.position
    poses = []
    for up, farther in ((0, -0.08), (0, 0.08), (0.012, 0), (-0.012, 0), (0.024, 0), (-0.024, 0)):
        x, y, z = (pose.center + farther * sight).tolist()
        poses.append(replace(pose, x=x, y=y, z=z + up))
    return poses


def _mirrored_pose(pose: FacePose, photo: Photo) -> FacePose:
    """Return the pose turned to the other side of the line of sight."""
    eye = photo.pose.position
    toward = math.atan2(eye[1] - pose.y, eye[0] - pose.x)
    return replace(pose, yaw=2 * toward - pose.yaw)


def refine_coarse_to_fine(photo: Photo, instrument: Instrument, pose: FacePose) -> Fit:
    """Return the fit near `pose` that a series of fits with less and less blur leads to.

    The last fit has the blur of the picture itself.
    """
    pixel_size = _pixel_size(photo, pose.center)
    # Round the blur, so that there are few different templates.
    own = math.ceil(_OWN_BLUR * pixel_size / _BLUR_STEP) * _BLUR_STEP
    for blur in (_ROUGH, _SOFT, max(_SHARP, own)):
        template = make_template(instrument, template_spacing(instrument), blur)
        blurred = photo.blurred(math.sqrt(max(blur**2 - own**2, 0.0)) / pixel_size)
        pose = refine(blurred, template, pose, instrument.rolled).pose
    return compare(blurred, template, pose)


def _pixel_size(photo: Photo, point: NDArray[np.float64]) -> float:
    """Return the width of a pixel at the distance of a point, in m."""
    return float(np.linalg.norm(point - photo.pose.position)) / photo.lens.focal


def _best_distinct(starts: list[tuple[float, FacePose]], count: int) -> list[FacePose]:
    """Return up to `count` poses that differ from each other, those with the highest number first.

    Each of `starts` is a number, such as a likeness, and a pose.
    """
    chosen: list[FacePose] = []
    for _, pose in sorted(starts, key=lambda start: -start[0]):
        if len(chosen) < count and all(_differ(pose, other) for other in chosen):
            chosen.append(pose)
    return chosen


def _differ(pose: FacePose, other: FacePose) -> bool:
    return bool(
        np.linalg.norm(pose.center - other.center) > 0.008
        or abs(pose.yaw - other.yaw) > math.radians(5)
        or abs(pose.roll - other.roll) > math.radians(5)
    )


def _is_allowed(pose: FacePose, planned: FacePose, slack: float = _SLACK) -> bool:
    turn = (pose.yaw - planned.yaw + math.pi) % (2 * math.pi) - math.pi
    return (
        float(np.linalg.norm(pose.center - planned.center)) <= MAX_OFFSET + slack
        and abs(turn) <= MAX_TURN + 10 * slack
        and abs(pose.roll) <= MAX_TURN + 10 * slack
    )
