"""Base class of all data that Argo reads and writes: frozen, and strict about unknown fields."""

from pydantic import BaseModel, ConfigDict


class Model(BaseModel):
    """Frozen record. Unknown fields, NaN and infinity are errors."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class Pose(Model):
    """Pose of the robot: a point of the walking surface below its centre, and a heading."""

    x: float
    """m, in the site's frame"""
    y: float
    """m, in the site's frame"""
    z: float
    """m, height of the walking surface"""
    yaw: float = 0.0
    """rad, counter-clockwise from the site's x axis"""
