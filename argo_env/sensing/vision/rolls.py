"""How a face may be rolled: its drawing at every roll, compared with a picture at once."""

import math
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from argo_env.sensing.vision.align import FacePose, sample
from argo_env.sensing.vision.faces import PIXELS_PER_METRE
from argo_env.sensing.vision.instrument import (
    Instrument,
    Template,
    blurred_texture,
    make_template,
)
from argo_env.sensing.vision.photo import Photo

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
