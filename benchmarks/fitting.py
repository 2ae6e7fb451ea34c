"""Fit of a robot's calibration to timed drives."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from argo_env.navigation.path import Motion
from argo_env.robot.spec import Calibration, MotionKind, MotionPace, RobotSpec

_DIGITS = 4
_MOST = 10.0  # upper limit of a motion's nominal time factor, and of the seconds that it loses


@dataclass(frozen=True)
class TimedDrive:
    """Motions driven one after the other, and the seconds that they took together."""

    motions: tuple[Motion, ...]
    seconds: float
    velocity: float | None = None
    """m/s that was commanded on the flat; None: the robot's own speed"""


def fit_calibration(drives: Iterable[TimedDrive], robot: RobotSpec) -> Calibration:
    """Return the calibration with the least squared error over all drives.

    The time of a drive is linear in the unknowns: for each kind of motion, the time at the
    commanded speed times 1 / share, plus the number of motions times the seconds lost. A kind that
    is never driven keeps share 1 and loses no time.

    Raises:
        ValueError: There are no drives.
    """
    drives = [d for d in drives if d.motions]
    if not drives:
        raise ValueError("there are no drives to fit to")
    kinds = list(MotionKind)
    matrix = np.zeros((len(drives), 2 * len(kinds)))
    for row, drive in zip(matrix, drives, strict=True):
        for motion in drive.motions:
            k = 2 * kinds.index(motion.kind)
            row[k] += nominal_seconds(motion, robot, drive.velocity)
            row[k + 1] += 1.0
    seconds = np.array([drive.seconds for drive in drives])
    driven = matrix.any(axis=0)
    low = np.tile([1.0 / _MOST, 0.0], len(kinds))
    solution = lsq_linear(matrix[:, driven], seconds, (low[driven], _MOST))
    values = np.tile([1.0, 0.0], len(kinds))
    values[driven] = solution.x
    return Calibration(
        **{
            kind: MotionPace(share=round(1.0 / slower, _DIGITS), lost=round(lost, _DIGITS))
            for kind, (slower, lost) in zip(kinds, values.reshape(-1, 2).tolist(), strict=True)
        }
    )


def nominal_seconds(motion: Motion, robot: RobotSpec, velocity: float | None = None) -> float:
    """Return the seconds that a motion would take at the commanded speed throughout.

    `velocity` (m/s) replaces the commanded speed forwards on the flat, and limits it on stairs and
    backwards. It has no effect on turns.
    """
    if motion.turn:
        return abs(motion.turn) / robot.target_speed(motion.kind)
    return motion.length / motion.drive_speed(robot, velocity)


def measured_minus_predicted_seconds(
    drives: Sequence[TimedDrive], robot: RobotSpec
) -> NDArray[np.float64]:
    """Return measured minus predicted seconds of each drive, shape (n,)."""
    return np.array(
        [d.seconds - sum(m.duration(robot, d.velocity) for m in d.motions) for d in drives]
    )
