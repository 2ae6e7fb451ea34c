"""How fast a robot gets ahead in fact, beside the speeds that it is told to go at."""

from enum import StrEnum

from pydantic import Field

from argo_compiler.base.model import Model


class MotionKind(StrEnum):
    """The kinds of motions that a path is made of; each has a speed of its own."""

    AHEAD = "ahead"
    """forwards on the flat"""
    REVERSE = "reverse"
    """backwards on the flat"""
    UP = "up"
    """backwards up stairs"""
    DOWN = "down"
    """forwards down stairs"""
    TURN = "turn"
    """in place"""


def drive_kind(gear: int, on_stairs: bool) -> MotionKind:
    """The kind of a drive in gear +1 or -1. On stairs the front is the lower end."""
    if on_stairs:
        return MotionKind.DOWN if gear > 0 else MotionKind.UP
    return MotionKind.AHEAD if gear > 0 else MotionKind.REVERSE


class MotionPace(Model):
    """What one kind of motion takes: its length over the real speed, and a time for each motion."""

    share: float = Field(1.0, gt=0)
    """of the speed that is told, what the robot reaches"""
    lost: float = Field(0.0, ge=0)
    """s that each motion takes in addition, to set off and to come to rest"""


class Calibration(Model):
    """The pace of each kind of motion. Without a measurement a robot does as it is told."""

    ahead: MotionPace = MotionPace()
    reverse: MotionPace = MotionPace()
    up: MotionPace = MotionPace()
    down: MotionPace = MotionPace()
    turn: MotionPace = MotionPace()

    def pace(self, kind: MotionKind) -> MotionPace:
        pace: MotionPace = getattr(self, kind)
        return pace
