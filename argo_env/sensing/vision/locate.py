"""Finding a face in a picture: first where something like it is, then how it stands exactly."""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from argo_env.sensing.vision.align import FacePose, Fit, compare, refine
from argo_env.sensing.vision.candidates import find_candidates
from argo_env.sensing.vision.instrument import Instrument, make_template
from argo_env.sensing.vision.outlines import find_outlines
from argo_env.sensing.vision.photo import Photo
from argo_env.sensing.vision.rolls import likely_rolls, spacing
from argo_env.world.placement import MAX_OFFSET, MAX_TURN

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
