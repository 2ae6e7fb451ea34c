"""How sure a reading is: from what was measured in one picture, and from several pictures."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from argo_env.sensing.vision.align import Fit
from argo_env.sensing.vision.indicator import Pointing

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
