"""Alignment of a drawn face with a picture, which gives the pose of the face.

Levenberg-Marquardt minimizes the differences in brightness between the picture and the drawn face.
The parameters are the middle of the face, its turn and its roll. Tukey's weights make needles,
levers and obstacles count little. It is direct alignment as in Baker and Matthews, "Lucas-Kanade 20
years on" (2004), with a model of 5 parameters instead of a free homography.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_env.sensing.vision.instrument import Template
from argo_env.sensing.vision.photo import Photo

_STEPS = np.array([0.0005, 0.0005, 0.0005, 0.005, 0.005])  # m and rad, of the derivatives
_TOLERANCE = 0.30  # of the contrast of the face: a point that differs by less matches
_HAZE = 0.35  # of white: black that is brighter than drawn by more does not belong to a face
_MIN_CONTRAST = 0.02  # of full scale, between black and white of a face


@dataclass(frozen=True)
class FacePose:
    """Pose of a face: its middle `x`, `y`, `z` (m, in the site's frame) and its orientation."""

    x: float
    y: float
    z: float
    yaw: float
    """rad, direction of the face's normal"""
    roll: float
    """rad about the normal, counter-clockwise seen along the normal"""

    @property
    def center(self) -> NDArray[np.float64]:
        return np.array([self.x, self.y, self.z])

    @property
    def normal(self) -> NDArray[np.float64]:
        return np.array([math.cos(self.yaw), math.sin(self.yaw), 0.0])

    def to_site(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the site's coordinates of points in the instrument's frame, shape (..., 3)."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        c, s = math.cos(self.roll), math.sin(self.roll)
        rotation = np.array([[cos, -sin * c, sin * s], [sin, cos * c, -cos * s], [0.0, s, c]])
        return np.asarray(points @ rotation.T + self.center)


@dataclass(frozen=True)
class Fit:
    """Result of comparing a face at `pose` with a picture."""

    pose: FacePose
    match: float
    """0 to 1, the share of the face that looks as drawn; dark and bright parts count equally"""


def sample_image(image: NDArray[np.float32], pixels: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the image's values at `pixels`, column and row, shape (..., 2).

    Column and row are 0 at the middle of the first pixel. Values are interpolated between pixels;
    they are NaN outside of the image.
    """
    import cv2

    pixels = pixels.astype(np.float32)
    flat = pixels.reshape(-1, 2)
    values = np.empty(len(flat))
    # OpenCV takes maps of up to 32,767 columns.
    for first in range(0, len(flat), 30_000):
        part = flat[first : first + 30_000]
        values[first : first + 30_000] = cv2.remap(
            image,
            np.ascontiguousarray(part[None, :, 0]),
            np.ascontiguousarray(part[None, :, 1]),
            cv2.INTER_LINEAR,
            borderMode=cv2.BORDER_CONSTANT,
            borderValue=math.nan,
        )[0]
    return values.reshape(pixels.shape[:-1])


def compare(photo: Photo, template: Template, pose: FacePose) -> Fit:
    """Compare the drawn face, at `pose`, with the picture; return `pose` and how much matches."""
    values, weights = _sample_template(photo, template, pose)
    face, gain, offset = _brightness_levels(values, template, weights)
    match = _match(values, template, weights, gain, offset) if face else 0.0
    return Fit(pose, match)


def refine(
    photo: Photo, template: Template, pose: FacePose, fit_roll: bool, iterations: int = 12
) -> Fit:
    """Return the fit near `pose` at which most of the drawn face looks as in the picture.

    The search starts at `pose`, and ends at a local maximum of `Fit.match`, or after `iterations`
    steps. The roll is changed only if `fit_roll` is True.
    """
    free = 5 if fit_roll else 4
    parameters = np.array([pose.x, pose.y, pose.z, pose.yaw, pose.roll])
    damping = 1e-3
    values, weights = _sample_template(photo, template, pose)
    good, gain, offset = _brightness_levels(values, template, weights)
    for _ in range(iterations):
        if not good:
            break
        difference = values - gain * template.brightness - offset
        robust = weights * _tukey(difference, 1.5 * _TOLERANCE * gain)
        match = _match(values, template, weights, gain, offset)
        jacobian = np.empty((len(values), free))
        for k in range(free):
            shifted = parameters.copy()
            shifted[k] += _STEPS[k]
            there = _brightness(photo, template, FacePose(*shifted.tolist()))
            jacobian[:, k] = (there - values) / _STEPS[k]
        jacobian[~np.isfinite(jacobian)] = 0.0
        # Gain and offset of the brightness are unknowns too, since they don't depend on the pose.
        full = np.column_stack([jacobian, -template.brightness, -np.ones(len(values))])
        normal = full.T @ (robust[:, None] * full) + 1e-12 * np.eye(free + 2)
        gradient = full.T @ (robust * np.where(np.isfinite(difference), difference, 0.0))
        for _ in range(4):
            damped = normal + damping * np.diag(np.diag(normal))
            step = np.clip(
                np.linalg.solve(damped, -gradient)[:free], -40 * _STEPS[:free], 40 * _STEPS[:free]
            )
            trial = parameters.copy()
            trial[:free] += step
            trial_values, trial_weights = _sample_template(
                photo, template, FacePose(*trial.tolist())
            )
            levels = _brightness_levels(trial_values, template, trial_weights, (gain, offset))
            if levels[0] and _match(trial_values, template, trial_weights, *levels[1:]) > match:
                parameters, values, weights = trial, trial_values, trial_weights
                good, gain, offset = levels
                damping = max(damping / 5, 1e-6)
                break
            damping *= 8
        else:
            break
        if np.abs(step / _STEPS[:free]).max() < 0.1:
            break
    return compare(photo, template, FacePose(*parameters.tolist()))


def _brightness(photo: Photo, template: Template, pose: FacePose) -> NDArray[np.float64]:
    """Return the picture's brightness at the template's points; NaN outside of it."""
    return sample_image(
        photo.brightness, photo.lens.project(pose.to_site(template.points), photo.pose)
    )


def _sample_template(
    photo: Photo, template: Template, pose: FacePose
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the picture's brightness at the template's points, and the weights of the points."""
    pixels = photo.lens.project(pose.to_site(template.points), photo.pose)
    values = sample_image(photo.brightness, pixels)
    red = sample_image(photo.redness, pixels)
    seen = np.isfinite(values) & ~(red > 0.35)
    # Points outside of the picture count as a mismatch; red points don't count at all.
    outside = ~np.isfinite(values)
    weights = np.where(seen | outside, template.weights, 0.0)
    return values, weights


def _brightness_levels(
    values: NDArray[np.float64],
    template: Template,
    weights: NDArray[np.float64],
    start: tuple[float, float] | None = None,
) -> tuple[bool, float, float]:
    """Return True if the picture has the contrast of a face, and gain and offset of brightness.

    Gain and offset map the drawn brightness to that of the picture, `values`. Their fit begins at
    `start`, or without it at estimates from the medians and percentiles. If the result is False,
    they mean nothing.
    """
    seen = np.isfinite(values) & (weights > 0)
    if seen.sum() < 20:
        return False, 1.0, 0.0
    v, t, w = values[seen], template.brightness[seen], weights[seen]
    starts = _initial_levels(v, t) if start is None else [start]
    fits = [_fit_levels(v, t, w, first, 4 if start is None else 1) for first in starts]
    _, gain, offset = max(fits)
    white, black = gain * t.max() + offset, gain * t.min() + offset
    drawn = float(template.brightness.min() / template.brightness.max())
    return gain > _MIN_CONTRAST and black < (drawn + _HAZE) * white, gain, offset


def _initial_levels(v: NDArray[np.float64], t: NDArray[np.float64]) -> list[tuple[float, float]]:
    """Return estimates of gain and offset from brightness in the picture, `v`, and as drawn, `t`.

    One is from the brightest points, with black as no light: it is right where much of the face is
    covered. The other is from the medians of the points that are drawn white and black.
    """
    bright = float(np.percentile(v, 85)) / float(t.max())
    guesses = [(max(bright, _MIN_CONTRAST), 0.0)]
    white = t > (t.min() + t.max()) / 2
    if min(white.sum(), (~white).sum()) >= 10:
        light, dark = float(np.median(v[white])), float(np.median(v[~white]))
        high, low = float(np.median(t[white])), float(np.median(t[~white]))
        gain = max((light - dark) / (high - low), _MIN_CONTRAST)
        guesses.append((gain, light - gain * high))
    return guesses


def _fit_levels(
    v: NDArray[np.float64],
    t: NDArray[np.float64],
    w: NDArray[np.float64],
    start: tuple[float, float],
    rounds: int,
) -> tuple[float, float, float]:
    """Return the total weight of the points that fit, and the gain and offset that fit them.

    `v` and `t` are the brightness of points in the picture and as drawn, `w` their weights. The fit
    begins at `start`, and has `rounds` steps at most.
    """
    gain, offset = start
    total = 0.0
    for _ in range(rounds):
        robust = w * _tukey(v - gain * t - offset, 1.5 * _TOLERANCE * gain)
        total = float(robust.sum())
        if total < 0.05:
            break
        mean_t, mean_v = (robust @ t) / total, (robust @ v) / total
        variance = robust @ (t - mean_t) ** 2
        if variance < 1e-6:
            break
        gain = max(float(robust @ ((t - mean_t) * (v - mean_v)) / variance), _MIN_CONTRAST)
        offset = float(mean_v - gain * mean_t)
    return total, gain, offset


def _match(
    values: NDArray[np.float64],
    template: Template,
    weights: NDArray[np.float64],
    gain: float,
    offset: float,
) -> float:
    difference = (values - gain * template.brightness - offset) / (_TOLERANCE * gain)
    alike = np.exp(-(difference**2))
    total = weights.sum()
    return float(weights @ np.where(np.isfinite(alike), alike, 0.0) / total) if total > 0 else 0.0


def _tukey(difference: NDArray[np.float64], scale: float) -> NDArray[np.float64]:
    """Return Tukey's biweight; 0 beyond `scale` and where the difference is NaN."""
    share = np.where(np.isfinite(difference), difference / scale, 2.0)
    return np.where(np.abs(share) < 1.0, (1.0 - share**2) ** 2, 0.0)
