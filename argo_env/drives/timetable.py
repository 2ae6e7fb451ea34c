"""Timetable of a path: where the robot is at each time, at the speeds that plans assume."""

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

_ROUNDING = 1e-6  # of a step: rounding error that sums of floats may have


class Timetable:
    """Times of a path's motions, which the drives without forces follow."""

    def __init__(self, path: Path, robot: RobotSpec, velocity: float | None = None) -> None:
        """Compute the times of the path's motions.

        `velocity` (m/s) is the planned speed on the flat; None means the robot's own speed.
        """
        self._motions = path.motions
        self._durations = [m.duration(robot, velocity) for m in path.motions]
        self._ends = list(accumulate(self._durations))

    @property
    def duration(self) -> float:
        """Duration of the whole path in s."""
        return self._ends[-1] if self._ends else 0.0

    def motion_and_share_at(self, t: float) -> tuple[Motion, float] | None:
        """Return the motion under way `t` s after the start, and the share of it that is done.

        After the end of the path this is the last motion, with share 1. Returns None if the path
        has no motion.
        """
        if not self._motions:
            return None
        k = bisect_right(self._ends, t)
        if k == len(self._motions):
            return self._motions[-1], 1.0
        return self._motions[k], 1.0 - (self._ends[k] - t) / self._durations[k]

    def iter_motions_and_shares_at(
        self, times: "NDArray[np.float64]"
    ) -> Iterator[tuple[Motion, "NDArray[np.float64]"]]:
        """Yield each motion under way at some of the times, and the shares of it that are done.

        The times (s), shape (n,), increase and lie before the end of the path. There is one share
        for each time at which the motion is under way.
        """
        first = 0
        while first < len(times):
            k = bisect_right(self._ends, times[first])
            last = int(times.searchsorted(self._ends[k]))
            yield self._motions[k], 1.0 - (self._ends[k] - times[first:last]) / self._durations[k]
            first = last


def count_steps(seconds: float, time_step: float) -> int:
    """Return the number of steps of `time_step` (s) in which `seconds` pass, rounded up."""
    return math.ceil(seconds / time_step - _ROUNDING)
