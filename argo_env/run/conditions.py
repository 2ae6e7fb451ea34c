"""The conditions of a run: what is as planned unless something else is said."""

import math

from pydantic import Field

from argo_compiler.base.model import Model, Pose


class ValueStep(Model):
    """A value that changes all at once."""

    at: float = Field(ge=0)
    """s"""
    change: float
    """in the checkpoint's unit"""


class ValueProfile(Model):
    """How the value that a checkpoint shows changes during a run. It stays on the scale."""

    drift: float = 0.0
    """in the checkpoint's unit an hour"""
    steps: tuple[ValueStep, ...] = ()
    noise: float = Field(default=0.0, ge=0)
    """standard deviation of what flickers, in the checkpoint's unit"""


class RunConditions(Model):
    """What the robot does not know, and no fault is: how its world differs from the plan's."""

    ahead: float = Field(default=0.0, ge=-1, le=1)
    """m that the robot stands ahead of where the mission starts"""
    left: float = Field(default=0.0, ge=-1, le=1)
    """m that it stands to the left of there"""
    turned: float = Field(default=0.0, ge=-180, le=180)
    """deg that it is turned there, counter-clockwise"""
    speed: float = Field(default=1.0, gt=0, le=1)
    """share of its speed that the drive makes"""
    friction: float = Field(default=1.0, gt=0, le=1.3)
    """beside that of the calibration; for the drive `tracked`, as no other knows forces, and up to
    where its belts are stable"""
    charge: float | None = Field(default=None, gt=0, le=1)
    """of the battery at the start; None: full, or as the run goes on from"""
    capacity: float = Field(default=1.0, gt=0, le=1)
    """share of the battery's capacity that is left"""
    sensor_noise: float = Field(default=0.0, ge=0, le=1)
    """standard deviation of readings, as a share of the scale"""
    values: dict[int, ValueProfile] = Field(default_factory=dict)
    """how values change, by number of the checkpoint"""

    def standing(self, start: Pose) -> Pose:
        """Where the robot really stands when it is to stand there."""
        c, s = math.cos(start.yaw), math.sin(start.yaw)
        return start.model_copy(
            update={
                "x": start.x + c * self.ahead - s * self.left,
                "y": start.y + s * self.ahead + c * self.left,
                "yaw": start.yaw + math.radians(self.turned),
            }
        )


AS_PLANNED = RunConditions()
"""all is as planned"""
