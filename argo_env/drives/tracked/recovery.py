"""Getting free again: back off, turn straight, go on with the flippers at another angle."""

import math
from dataclasses import dataclass

from argo_env.navigation.path import Motion

ATTEMPTS = 3
GOING_ON = 3.0  # s for which the flippers keep the other angle
_ANGLES = tuple(math.radians(a) for a in (30.0, -10.0, 45.0))  # of the flippers, attempt by attempt
_BACK = 0.12  # m/s
_BACK_TIME = 2.0  # s
_ASIDE = 0.10  # m/s
_ASIDE_TIME = 1.2  # s
_TURN = 0.3  # rad/s
_LEVEL = math.radians(8.0)  # of pitch, up to which it turns straight


@dataclass(frozen=True)
class RecoveryPhase:
    """One thing that is done for a while."""

    duration: float
    """s"""
    speed: float
    """m/s"""
    turn_rate: float | None
    """rad/s; None turns towards the heading of the motion"""
    flipper: float
    """rad"""


def phases(motion: Motion, attempt: int, pitch: float) -> tuple[RecoveryPhase, ...]:
    """What to do for the attempt (0, 1, ...) to get free from where `motion` is stuck."""
    angle = _ANGLES[attempt % len(_ANGLES)]
    if motion.turn:
        side = 1 if attempt % 2 == 0 else -1
        return (
            RecoveryPhase(1.0, 0.0, -math.copysign(_TURN, motion.turn), angle),
            RecoveryPhase(_ASIDE_TIME, side * _ASIDE, 0.0, angle),
        )
    back = RecoveryPhase(_BACK_TIME, -motion.gear * _BACK, 0.0, angle)
    if abs(pitch) > _LEVEL:
        return (back,)
    return (back, RecoveryPhase(2.0, 0.0, None, angle))
