"""Catalogue of a site: the names that a script may use, and what they stand for.

The catalogue is data. `argo_env` makes it from a site; the compiler knows no geometry.
"""

from enum import StrEnum

from pydantic import Field, model_validator

from argo_compiler.base.model import Model, Pose


class CheckpointKind(StrEnum):
    """Kind of checkpoint in the competition (thesis 1.2)."""

    PRESSURE_GAUGE = "pressure gauge"
    LIQUID_LEVEL_GAUGE = "liquid level gauge"
    VALVE = "valve"


class Interval(Model):
    """Closed interval of values, in the unit of the quantity that it belongs to."""

    low: float
    high: float

    @model_validator(mode="after")
    def _ordered(self) -> "Interval":
        if self.low > self.high:
            raise ValueError(f"low {self.low} is above high {self.high}")
        return self

    def contains(self, value: float) -> bool:
        return self.low <= value <= self.high


class CheckpointInfo(Model):
    """Checkpoint as a script sees it: `range` is its scale, `nominal` the normal values."""

    id: int = Field(ge=1)
    kind: CheckpointKind
    name: str
    """with its kind, as scripts write it: `pressure gauge 1`, `valve R25`"""
    floor: int = Field(ge=1)
    unit: str
    range: Interval
    nominal: Interval
    tags: tuple[str, ...] = ()
    """plant tags, such as `20-PI-1034A`"""


class Area(Model):
    """Starting area outside the site, with the pose of a robot docked in its station."""

    number: int = Field(ge=1)
    dock: Pose


class Floor(Model):
    """Floor, counted from 1 at the bottom (thesis 5.1)."""

    number: int = Field(ge=1)
    z: float
    """m, height of its deck"""
    patrol: tuple[Pose, ...]
    """at least three poses near the floor's corners that the robot can reach, in the order of a
    patrol; empty: there are no three"""


class Place(Model):
    """Named place to which a script may send the robot, such as `front of the site`."""

    name: str
    pose: Pose


class Catalog(Model):
    """Everything that a script can name on one site."""

    site: str
    checkpoints: tuple[CheckpointInfo, ...]
    areas: tuple[Area, ...]
    floors: tuple[Floor, ...]
    places: tuple[Place, ...] = ()

    def checkpoint(self, id: int) -> CheckpointInfo | None:
        return next((c for c in self.checkpoints if c.id == id), None)

    def area(self, number: int) -> Area | None:
        return next((a for a in self.areas if a.number == number), None)

    def floor(self, number: int) -> Floor | None:
        return next((f for f in self.floors if f.number == number), None)

    def find_place(self, name: str) -> Place | None:
        return next((p for p in self.places if p.name == name), None)
