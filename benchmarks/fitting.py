"""The calibration of a robot, fitted to drives whose times were taken."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from argo_env.navigation.path import Motion
from argo_env.robot.spec import Calibration, MotionKind, MotionPace, RobotSpec

_DIGITS = 4
_MOST = 10.0  # times slower than told, or s lost, that a motion is taken to be


@dataclass(frozen=True)
class TimedDrive:
    """Motions driven one after the other, and the seconds that they took together."""

    motions: tuple[Motion, ...]
    seconds: float
    velocity: float | None = None
    """m/s that was asked for on the flat, None for the robot's own"""


def fit(drives: Iterable[TimedDrive], robot: RobotSpec) -> Calibration:
    """The calibration with the least squared error over all `drives`.

    The time of a drive is linear in what is looked for: for each kind of motion its length over the
    told speed, times 1 / share, and the number of motions times the time lost. A kind that is never
    driven is taken to go as told. Raises ValueError if there are no drives.
    """
    drives = [d for d in drives if d.motions]
    if not drives:
        raise ValueError("there are no drives to fit to")
    kinds = list(MotionKind)
    matrix = np.zeros((len(drives), 2 * len(kinds)))
    for row, drive in zip(matrix, drives, strict=True):
        for motion in drive.motions:
            k = 2 * kinds.index(motion.kind)
            row[k] += told_seconds(motion, robot, drive.velocity)
            row[k + 1] += 1.0
    seconds = np.array([drive.seconds for drive in drives])
    driven = matrix.any(axis=0)
    low = np.tile([1.0 / _MOST, 0.0], len(kinds))
    found = lsq_linear(matrix[:, driven], seconds, (low[driven], _MOST))
    values = np.tile([1.0, 0.0], len(kinds))
    values[driven] = found.x
    return Calibration(
        **{
            kind: MotionPace(share=round(1.0 / slower, _DIGITS), lost=round(lost, _DIGITS))
            for kind, (slower, lost) in zip(kinds, values.reshape(-1, 2).tolist(), strict=True)
        }
    )


def told_seconds(motion: Motion, robot: RobotSpec, velocity: float | None = None) -> float:
    """s that a motion would take if the robot were as fast as it is told to be, all the way."""
    if motion.turn:
        return abs(motion.turn) / robot.target_speed(motion.kind)
    return motion.length / motion.speed(robot, velocity)


def errors(drives: Sequence[TimedDrive], robot: RobotSpec) -> NDArray[np.float64]:
    """s by which each drive took longer than the robot's calibration says, shape (n,)."""
    return np.array(
        [d.seconds - sum(m.duration(robot, d.velocity) for m in d.motions) for d in drives]
    )
