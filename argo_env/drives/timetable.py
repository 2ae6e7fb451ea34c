"""When the robot is where on its path, at the pace that plans count with."""

import math
from bisect import bisect_right
from collections.abc import Iterator
from itertools import accumulate
from typing import TYPE_CHECKING

from argo_env.navigation.path import Motion, Path
from argo_env.robot.spec import RobotSpec

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_ROUNDING = 1e-6  # of a step, left by sums of floats


class Timetable:
    """The times of a path's motions: what the drives that know no forces go by."""

    def __init__(self, path: Path, robot: RobotSpec, velocity: float | None = None) -> None:
        """`velocity` (m/s) is that of the plan on the flat, None the robot's own."""
        self._motions = path.motions
        self._durations = [m.duration(robot, velocity) for m in path.motions]
        self._ends = list(accumulate(self._durations))

    @property
    def duration(self) -> float:
        """s."""
        return self._ends[-1] if self._ends else 0.0

    def at(self, t: float) -> tuple[Motion, float] | None:
        """The motion under way `t` s after setting off, and the share of it that is done; the last
        one with 1 from its end on. None if the path has no motion."""
        if not self._motions:
            return None
        k = bisect_right(self._ends, t)
        if k == len(self._motions):
            return self._motions[-1], 1.0
        return self._motions[k], 1.0 - (self._ends[k] - t) / self._durations[k]

    def stretches(
        self, times: "NDArray[np.float64]"
    ) -> Iterator[tuple[Motion, "NDArray[np.float64]"]]:
        """For times (s), shape (n,), that only grow and are before the end: each motion that is
        under way at some of them, and the share of it that is done at each."""
        first = 0
        while first < len(times):
            k = bisect_right(self._ends, times[first])
            last = int(times.searchsorted(self._ends[k]))
            yield self._motions[k], 1.0 - (self._ends[k] - times[first:last]) / self._durations[k]
            first = last


def steps(seconds: float, time_step: float) -> int:
    """The number of time steps (s) that a time takes, the last one begun counted whole."""
    return math.ceil(seconds / time_step - _ROUNDING)
