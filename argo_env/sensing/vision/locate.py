"""Finding a face in a picture: first where bright patches of the right shape and size are, and how
it is rolled, then how it stands exactly."""

import math
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from argo_env.sensing.vision.align import FacePose, Fit, compare, refine, sample
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


_ROLLS = np.radians(np.arange(-93, 94, 3))
_DARKEST = 0.03  # of full scale: white that is darker is not looked at


def spacing(instrument: Instrument) -> float:
    """m between the points of a face that is compared with pictures."""
    return 0.004 if instrument.shape.round else 0.0045


@dataclass(frozen=True)
class _RolledFaces:
    """A face at every roll, at the same points: its brightness and weights, (rolls, points)."""

    template: Template
    brightness: NDArray[np.float32]
    weights: NDArray[np.float32]


@cache
def _rolled_faces(instrument: Instrument, blur: float) -> _RolledFaces:
    template = make_template(instrument, 1.5 * spacing(instrument), blur)
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
    """The pose with the rolls at which the face is most like the picture, and how much so."""
    faces = _rolled_faces(instrument, blur)
    spots = photo.lens.project(pose.to_site(faces.template.points), photo.pose)
    values = sample(photo.brightness, spots)
    red = sample(photo.redness, spots)
    seen = np.isfinite(values) & ~(red > 0.35)
    if seen.sum() < len(seen) / 4:
        return []
    values = values[seen].astype(np.float32)
    # White is most of what is seen; black reflects nearly nothing.
    white = float(np.percentile(values, 70)) / float(faces.brightness.max())
    if white < _DARKEST:
        return []
    weights = faces.weights[:, seen]
    difference = (values - white * faces.brightness[:, seen]) / (0.35 * white)
    likeness = (weights * np.exp(-(difference**2))).sum(axis=1) / weights.sum(axis=1)
    if not instrument.rolled:
        return [(float(likeness[0]), replace(pose, roll=0.0))]
    found = []
    for _ in range(3):
        best = int(likeness.argmax())
        found.append((float(likeness[best]), replace(pose, roll=float(_ROLLS[best]))))
        likeness = np.where(np.abs(_ROLLS - _ROLLS[best]) > math.radians(12), likeness, -1.0)
    return found


_OUTLINES = 30  # that are looked at more closely
_FITS = 7  # that are fitted
_CLEARLY = 0.86  # match from which nothing else is looked for
_AS_GOOD = 0.12  # likeness that another pose may lack to be tried
_CLEAR = 0.94  # match from which no other candidate is tried
_OWN_BLUR = 1.1  # px, of the pictures themselves
_BLUR_STEP = 0.0003  # m
_ROUGH, _SOFT, _SHARP = 0.006, 0.003, 0.0012  # m, blur of the drawn face from fit to fit
_SLACK = 0.015  # m, and rad times 10, beyond the rules' limits


def find_face(photo: Photo, instrument: Instrument, planned: FacePose) -> Fit | None:
    """The best match of the face in the picture within what the rules allow about `planned`; None
    if nothing there looks like it."""
    pixel = _pixel(photo, planned.center)
    rough, fine = photo.blurred(_ROUGH / pixel), photo.blurred(_SOFT / pixel)
    outlines = [
        (filled, pose)
        for filled, pose in find_outlines(photo, instrument, planned)
        if _allowed(pose, planned, 0.03)
    ]
    starts: list[tuple[float, FacePose]] = []
    for candidate in _best_apart(outlines, _OUTLINES):
        starts += likely_rolls(fine, instrument, candidate, _SOFT)
        starts += likely_rolls(rough, instrument, candidate, _ROUGH)
    best = _best_fit(photo, rough, fine, instrument, planned, starts)
    if best is not None and best.match > _CLEARLY:
        return best
    # The outline may be hidden in part, or run into what is behind.
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
    """The best match from any of the starts; `rough` and `fine` are the photo blurred so."""
    fits = []
    for pose in _best_apart(starts, _FITS):
        for blur, blurred in ((_ROUGH, rough), (_SOFT, fine)):
            template = make_template(instrument, spacing(instrument), blur)
            fit = refine(blurred, template, pose, instrument.rolled, 8)
            pose = fit.pose
        if _allowed(fit.pose, planned):
            fits.append(fit)
            if fit.match > _CLEAR:
                break
    fits.sort(key=lambda fit: -fit.match)
    sharp = [look_closer(photo, instrument, fit.pose) for fit in fits[:2]]
    return max((f for f in sharp if _allowed(f.pose, planned)), key=lambda f: f.match, default=None)


def look_closer(photo: Photo, instrument: Instrument, pose: FacePose) -> Fit:
    """The best match near `pose`. A face that is turned to the left looks much like one that is
    turned to the right, and a scale much like itself a few marks farther on: so these are tried
    too."""
    best = sharpen(photo, instrument, pose)
    if best.match > _CLEAR:
        return best
    fine = photo.blurred(_SOFT / _pixel(photo, pose.center))
    here = likely_rolls(fine, instrument, best.pose, _SOFT)
    starts = list(here)
    for start in (_mirrored(best.pose, photo), *_slipped(best.pose, photo, instrument)):
        starts += likely_rolls(fine, instrument, start, _SOFT)
    as_good = max((likeness for likeness, _ in here), default=0.0) - _AS_GOOD
    others = _best_apart([s for s in starts if s[0] > as_good], 4)
    # Seen turned to the other side, a face is elsewhere too: the fit must find where.
    others.insert(0, _mirrored(best.pose, photo))
    for other in others:
        if _apart(other, best.pose):
            best = max(best, sharpen(photo, instrument, other), key=lambda fit: fit.match)
    return best


def _slipped(pose: FacePose, photo: Photo, instrument: Instrument) -> list[FacePose]:
    """Poses at which a straight scale looks like itself: marks over other marks."""
    if instrument.rolled:
        return []
    sight = pose.center - photo.pose.position
    found = []
    for up, farther in ((0, -0.08), (0, 0.08), (0.012, 0), (-0.012, 0), (0.024, 0), (-0.024, 0)):
        x, y, z = (pose.center + farther * sight).tolist()
        found.append(replace(pose, x=x, y=y, z=z + up))
    return found


def _mirrored(pose: FacePose, photo: Photo) -> FacePose:
    """The pose turned to the other side of the line of sight."""
    eye = photo.pose.position
    toward = math.atan2(eye[1] - pose.y, eye[0] - pose.x)
    return replace(pose, yaw=2 * toward - pose.yaw)


def sharpen(photo: Photo, instrument: Instrument, pose: FacePose) -> Fit:
    """The best match near `pose`, with the face as sharp as the picture shows it."""
    pixel = _pixel(photo, pose.center)
    # In steps, so that there are few different templates.
    own = math.ceil(_OWN_BLUR * pixel / _BLUR_STEP) * _BLUR_STEP
    for blur in (_ROUGH, _SOFT, max(_SHARP, own)):
        template = make_template(instrument, spacing(instrument), blur)
        blurred = photo.blurred(math.sqrt(max(blur**2 - own**2, 0.0)) / pixel)
        pose = refine(blurred, template, pose, instrument.rolled).pose
    return compare(blurred, template, pose)


def _pixel(photo: Photo, point: NDArray[np.float64]) -> float:
    """How wide a pixel is at a point, in m."""
    return float(np.linalg.norm(point - photo.pose.position)) / photo.lens.focal


def _best_apart(starts: list[tuple[float, FacePose]], count: int) -> list[FacePose]:
    """The best of the poses, best first, that differ from each other."""
    chosen: list[FacePose] = []
    for _, pose in sorted(starts, key=lambda start: -start[0]):
        if len(chosen) < count and all(_apart(pose, other) for other in chosen):
            chosen.append(pose)
    return chosen


def _apart(pose: FacePose, other: FacePose) -> bool:
    return bool(
        np.linalg.norm(pose.center - other.center) > 0.008
        or abs(pose.yaw - other.yaw) > math.radians(5)
        or abs(pose.roll - other.roll) > math.radians(5)
    )


def _allowed(pose: FacePose, planned: FacePose, slack: float = _SLACK) -> bool:
    turn = (pose.yaw - planned.yaw + math.pi) % (2 * math.pi) - math.pi
    return (
        float(np.linalg.norm(pose.center - planned.center)) <= MAX_OFFSET + slack
        and abs(turn) <= MAX_TURN + 10 * slack
        and abs(pose.roll) <= MAX_TURN + 10 * slack
    )
