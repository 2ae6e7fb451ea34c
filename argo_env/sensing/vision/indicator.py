"""Where the indicator of an instrument stands, in a picture with the pose of its face known."""

from dataclasses import dataclass

import numpy as np

from argo_env.sensing.vision.align import FacePose, sample
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
