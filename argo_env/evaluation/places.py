"""Where on a site runs fail."""

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field

from argo_env.evaluation.row import RunRow
from argo_env.site.shapes import Vector

_NEAR = 0.5  # m


@dataclass
class FailurePlace:
    """A place where runs failed."""

    floor: int
    at: Vector
    """m, of the first of them; the others are at most half a metre away"""
    tasks: Counter[str] = field(default_factory=Counter)
    """how many failed there at each task"""

    @property
    def runs(self) -> int:
        """How many failed there."""
        return self.tasks.total()


def failure_places_of(rows: Iterable[RunRow]) -> tuple[FailurePlace, ...]:
    """The places where these runs failed, by floor, and where most did first."""
    found: list[FailurePlace] = []
    for row in rows:
        if row.success or row.place is None or row.floor is None:
            continue
        for place in found:
            if place.floor == row.floor and math.dist(place.at, row.place) <= _NEAR:
                break
        else:
            place = FailurePlace(row.floor, row.place)
            found.append(place)
        place.tasks[row.task or "no task"] += 1
    return tuple(sorted(found, key=lambda one: (one.floor, -one.runs, one.at)))
