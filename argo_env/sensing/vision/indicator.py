"""Position of an instrument's indicator in a picture, and confidence of readings from pictures.

The pose of the instrument's face in the picture must be known.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from argo_env.sensing.vision.align import FacePose, Fit, sample_image
from argo_env.sensing.vision.instrument import Instrument
from argo_env.sensing.vision.photo import Photo

_MARGIN = 0.04  # of the scale beyond either end that is searched too
_STEPS = 541  # positions that are tried, 0.2 % of the scale apart


@dataclass(frozen=True)
class IndicatorPosition:
    """Position of an indicator on its scale, and how clearly it is seen there."""

    share: float
    """of the scale, 0 at its low end to 1 at its high end, and a little beyond"""
    strength: float
    """0 to 1, by how much the indicator is redder than the points beside it"""
    lead: float
    """0 to 1, by how much the strength is greater than anywhere else on the scale, as a share"""
    seen: float
    """0 to 1, the share of the indicator that is red"""


def find_indicator_on_scale(
    photo: Photo, instrument: Instrument, pose: FacePose
) -> IndicatorPosition | None:
    """Return where on its scale the indicator of an instrument is whose face is at `pose`.

    Returns None if nothing red is on the scale.
    """
    indicator = instrument.indicator
    shares = np.linspace(-_MARGIN, 1 + _MARGIN, _STEPS)
    positions = indicator.low + shares * (indicator.high - indicator.low)

    def redness(points: np.ndarray) -> np.ndarray:
        spots = photo.lens.project(pose.to_site(indicator.move(points, positions)), photo.pose)
        values = sample_image(photo.redness, spots)
        return np.where(np.isfinite(values), values, 0.0)

    body = redness(indicator.body)
    strength = body.mean(axis=1) - redness(indicator.beside).mean(axis=1)
    best = int(strength.argmax())
    peak = float(strength[best])
    if peak <= 0.02:
        return None
    # Take the weighted middle of the peak, since it may be flat on top.
    above = strength > 0.7 * peak
    first = last = best
    while first > 0 and above[first - 1]:
        first -= 1
    while last < _STEPS - 1 and above[last + 1]:
        last += 1
    near = slice(first, last + 1)
    weight = strength[near] - 0.7 * peak
    share = float(shares[near] @ weight / weight.sum())
    far = np.ones(_STEPS, dtype=bool)
    spread = last - first + 1
    far[max(0, first - spread) : last + 1 + spread] = False
    second = float(max(strength[far].max(initial=0.0), 0.0))
    seen = float((body[best] > 0.4).mean())
    return IndicatorPosition(share, peak, 1.0 - second / peak, seen)


TOLERANCE = 0.015  # of the scale: readings that differ by less agree
_CHANCE = 0.5
"""probability that two wrong readings agree: high, since later pictures are of the face that the
first one found"""
_CEILING = 0.995  # highest probability, however many pictures there are


@dataclass(frozen=True)
class PictureReading:
    """Reading from one picture, or from several ones together."""

    share: float
    """value as a share of the scale, 0 at its low end to 1 at its high end"""
    probability: float
    """probability that the reading is right, 0 to 1"""


def reading_probability(fit: Fit, indicator: IndicatorPosition, cosine: float) -> float:
    """Return the probability that a reading from one picture is right.

    `cosine` is that of the angle between the face's normal and the line of sight.
    """
    score = (
        50.0 * (fit.match - 0.91)
        + 3.0 * (indicator.strength - 0.6)
        + 2.0 * (indicator.lead - 0.6)
        + 2.0 * (indicator.seen - 0.6)
        + cosine
        - 0.6
    )
    if not -0.03 <= indicator.share <= 1.03:
        return 0.02
    return 1.0 / (1.0 + math.exp(-score))


def find_most_probable_reading(readings: Sequence[PictureReading]) -> PictureReading | None:
    """Return the most probable reading, with its probability given all; None without readings.

    Bayes' rule is applied to the hypotheses "this group of readings that agree is right, and the
    others are wrong" and "all are wrong", with a probability that wrong readings agree.
    """
    if not readings:
        return None
    best: tuple[float, float] = (-1.0, 0.0)
    total = math.prod(1.0 - r.probability for r in readings)
    groups: list[tuple[float, list[PictureReading]]] = []
    for leader in readings:
        group = [r for r in readings if abs(r.share - leader.share) <= TOLERANCE]
        if any(leader in known for _, known in groups):
            continue
        others = [r for r in readings if r not in group]
        weight = math.prod(r.probability for r in group) / _CHANCE ** (len(group) - 1)
        weight *= math.prod(1.0 - r.probability for r in others)
        groups.append((weight, group))
        total += weight
    for weight, group in groups:
        share = math.fsum(r.share * r.probability for r in group)
        share /= math.fsum(r.probability for r in group)
        if weight / total > best[0]:
            best = (weight / total, share)
    return PictureReading(best[1], min(best[0], _CEILING))
