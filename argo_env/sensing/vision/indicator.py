"""Position of an instrument's indicator in a picture in which the pose of its face is known; and
confidence of such readings, one or several."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from argo_env.sensing.vision.align import FacePose, Fit, sample
from argo_env.sensing.vision.instrument import Instrument
from argo_env.sensing.vision.photo import Photo

_MARGIN = 0.04  # of the scale beyond either end that is looked at too
_STEPS = 541  # positions that are tried: 0.2 % of the scale each


@dataclass(frozen=True)
class Pointing:
    """Where an indicator stands."""

    share: float
    """of the scale, 0 at its low end to 1 at its high end, and a little beyond"""
    strength: float
    """0 to 1, how much redder the indicator is than what is beside it"""
    lead: float
    """by how much (0 to 1) that is more than at any other place on the scale"""
    seen: float
    """0 to 1, the share of the indicator that is red"""


def find_indicator(photo: Photo, instrument: Instrument, pose: FacePose) -> Pointing | None:
    """Where the indicator stands; None if nothing red is there."""
    indicator = instrument.indicator
    shares = np.linspace(-_MARGIN, 1 + _MARGIN, _STEPS)
    positions = indicator.low + shares * (indicator.high - indicator.low)

    def redness(points: np.ndarray) -> np.ndarray:
        spots = photo.lens.project(pose.to_site(indicator.move(points, positions)), photo.pose)
        values = sample(photo.redness, spots)
        return np.where(np.isfinite(values), values, 0.0)

    body = redness(indicator.body)
    strength = body.mean(axis=1) - redness(indicator.beside).mean(axis=1)
    best = int(strength.argmax())
    peak = float(strength[best])
    if peak <= 0.02:
        return None
    # The middle of the peak at half its height: it may be flat on top.
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
    return Pointing(share, peak, 1.0 - second / peak, seen)


TOLERANCE = 0.015  # of the scale: readings that differ by less say the same
_CHANCE = 0.5
"""that two wrong readings say the same: often, since what was found is looked at again"""
_CEILING = 0.995  # no number of pictures makes surer than this


@dataclass(frozen=True)
class PictureReading:
    """What one picture says."""

    share: float
    """of the scale"""
    probability: float
    """that this is right"""


def probability(fit: Fit, pointing: Pointing, cosine: float) -> float:
    """That a reading from one picture is right; `cosine` is of the obliqueness."""
    score = (
        50.0 * (fit.match - 0.91)
        + 3.0 * (pointing.strength - 0.6)
        + 2.0 * (pointing.lead - 0.6)
        + 2.0 * (pointing.seen - 0.6)
        + cosine
        - 0.6
    )
    if not -0.03 <= pointing.share <= 1.03:
        return 0.02
    return 1.0 / (1.0 + math.exp(-score))


def combine_readings(readings: Sequence[PictureReading]) -> PictureReading | None:
    """The share that the readings speak for, and how probable it is; None if there are none.

    Bayes' rule over "this group of like readings is right and the others are wrong" and "all are
    wrong", with a chance that wrong readings agree.
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
        share = sum(r.share * r.probability for r in group) / sum(r.probability for r in group)
        if weight / total > best[0]:
            best = (weight / total, share)
    return PictureReading(best[1], min(best[0], _CEILING))
