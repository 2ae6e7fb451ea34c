"""Data model of a site: the content of `scenarios/<site>/site.yaml`.

Lengths are in m, angles in degrees. Rectangles are `[x0, y0, x1, y1]` in the site's frame. Heights
of things on a floor are above that floor's deck.
"""

import math
from itertools import pairwise
from typing import Annotated, Literal

from pydantic import AfterValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from argo_compiler.base.catalog import CheckpointKind, Interval
from argo_compiler.base.model import Model

LEDGE = 5e-3  # m, greatest difference of two heights that is level for a robot
MAX_BYTES = 50_000_000
"""greatest size of a site's file; one with hundreds of checkpoints takes about 100 kB"""
MAX_GROUND = 200.0  # m along an edge; navigation keeps a grid of 0.1 m over it

# Limits that no site exceeds. All solids are made from the description, so a typing error in a
# number must not lead to millions of them.
MAX_FLOORS = 50
MAX_RISERS = 100  # of a flight; the norm asks for a landing after about 18
_MOST_TAGS = 20
MAX_THINGS = 1000  # items of one kind, on a floor or on the whole site
_FAR = 10_000.0  # m from the origin
_BULKY = 50.0  # m, for a radius or a width
_STEEP = 2.0  # m, for a rise or a going

Coordinate = Annotated[float, Field(ge=-_FAR, le=_FAR)]
Point = tuple[Coordinate, Coordinate]
Point3 = tuple[Coordinate, Coordinate, Coordinate]
Stance = tuple[Coordinate, Coordinate, float]
"""x, y, yaw"""
Length = Annotated[float, Field(gt=0, le=MAX_GROUND)]
Thickness = Annotated[float, Field(gt=0, le=_BULKY)]
StepSize = Annotated[float, Field(gt=0, le=_STEEP)]


def _ordered(rect: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    x0, y0, x1, y1 = rect
    if x0 >= x1 or y0 >= y1:
        raise ValueError(f"a rectangle is [x0, y0, x1, y1] with x0 < x1 and y0 < y1, not {rect}")
    if max(x1 - x0, y1 - y0) > MAX_GROUND:
        raise ValueError(f"it is larger than {MAX_GROUND:.0f} m by {MAX_GROUND:.0f} m")
    return rect


Rect = Annotated[tuple[Coordinate, Coordinate, Coordinate, Coordinate], AfterValidator(_ordered)]


def distance_to_rect(rect: Rect, x: float, y: float) -> float:
    """Return the distance (m) of the point (x, y) from a rectangle, 0 within it."""
    return math.hypot(max(rect[0] - x, 0.0, x - rect[2]), max(rect[1] - y, 0.0, y - rect[3]))


def _no_longer(line: tuple[tuple[float, ...], ...]) -> tuple[tuple[float, ...], ...]:
    for a, b in pairwise(line):
        if math.dist(a, b) > MAX_GROUND:
            raise ValueError(f"it is longer than {MAX_GROUND:.0f} m from {a} to {b}")
    return line


Line = Annotated[tuple[Point, ...], Field(max_length=MAX_THINGS), AfterValidator(_no_longer)]
Line3 = Annotated[
    tuple[Point3, ...], Field(min_length=2, max_length=MAX_THINGS), AfterValidator(_no_longer)
]


class VesselSpec(Model):
    """Vessel of a `length` about its `center`: upright, or lying on saddles along x or y."""

    name: str
    axis: Literal["x", "y", "z"] = "z"
    center: Point3
    radius: Thickness
    length: Length


class PipeSpec(Model):
    """Pipe through the given points, in the site's frame."""

    name: str
    points: Line3
    radius: Thickness = 0.06

    @model_validator(mode="after")
    def _distinct(self) -> "PipeSpec":
        if any(a == b for a, b in pairwise(self.points)):
            raise ValueError("two points in a row must differ")
        return self


class PumpSpec(Model):
    """Pump with its motor on a skid; `yaw` turns the motor's axis."""

    name: str
    center: Point
    yaw: float = 0.0


class CheckpointSpec(Model):
    """Checkpoint: the position and direction (`yaw`) of its face, and its nominal range."""

    id: int = Field(ge=1)
    kind: CheckpointKind
    name: str
    position: Point3
    """x, y and the height above the floor's deck"""
    yaw: float
    nominal: Interval
    tags: tuple[str, ...] = Field(default=(), max_length=_MOST_TAGS)
    """plant tags by which scripts name it, such as `20-PI-1034A`"""


class FloorSpec(Model):
    """Floor: the deck's rectangles less its openings, and the equipment and checkpoints on it."""

    number: int = Field(ge=1)
    z: Coordinate
    walkways: dict[str, Rect] = Field(min_length=1, max_length=MAX_THINGS)
    openings: dict[str, Rect] = Field(default_factory=dict, max_length=MAX_THINGS)
    railed: bool = True
    """True if free edges of the deck carry a railing"""
    gates: dict[str, Rect] = Field(default_factory=dict, max_length=MAX_THINGS)
    """areas without railing"""
    barriers: dict[str, Line] = Field(default_factory=dict, max_length=MAX_THINGS)
    """railings that stand on the deck, along polylines"""
    vessels: tuple[VesselSpec, ...] = Field(default=(), max_length=MAX_THINGS)
    pumps: tuple[PumpSpec, ...] = Field(default=(), max_length=MAX_THINGS)
    checkpoints: tuple[CheckpointSpec, ...] = Field(default=(), max_length=MAX_THINGS)


class FlightSpec(Model):
    """Flight of open steps that rises along `yaw` from `foot`, the middle of its first nosing."""

    name: str
    foot: Point3
    yaw: float
    risers: int = Field(ge=2, le=MAX_RISERS)
    rise: StepSize
    going: StepSize
    width: Thickness


class LandingSpec(Model):
    """Landing between flights, with a railing where no flight joins it."""

    name: str
    rect: Rect
    z: Coordinate


class TowerSpec(Model):
    """Stair tower, repeated from floor to floor: flights and landings relative to each floor."""

    name: str
    flights: tuple[FlightSpec, ...] = Field(max_length=MAX_FLOORS)
    landings: tuple[LandingSpec, ...] = Field(default=(), max_length=MAX_FLOORS)


class AreaSpec(Model):
    """Starting area, with the pose of a robot that is docked in front of the area's station."""

    number: int = Field(ge=1)
    dock: Stance
    """x, y, yaw"""


class PlaceSpec(Model):
    """Named pose on the ground, as x, y, yaw."""

    name: str
    pose: Stance


def _usable_name(name: str) -> str:
    if not name.strip() or name.startswith(".") or any(c in "/\\" or ord(c) < 32 for c in name):
        raise ValueError(
            f"`{name}` can't be the name of a site, as files are named after it: use a name "
            "without slashes that does not begin with a dot"
        )
    return name


class SiteSpec(Model):
    """Description of a whole site."""

    name: Annotated[str, Field(max_length=200), AfterValidator(_usable_name)]
    """name of the site, by which files are named"""
    title: str
    storey: Length
    """m from floor to floor"""
    ground: Rect
    ground_z: Coordinate
    towers: tuple[TowerSpec, ...] = Field(max_length=MAX_FLOORS)
    floors: tuple[FloorSpec, ...] = Field(min_length=1, max_length=MAX_FLOORS)
    columns: tuple[Point, ...] = Field(default=(), max_length=MAX_THINGS)
    pipes: tuple[PipeSpec, ...] = Field(default=(), max_length=MAX_THINGS)
    vessels: tuple[VesselSpec, ...] = Field(default=(), max_length=MAX_THINGS)
    areas: tuple[AreaSpec, ...] = Field(min_length=1, max_length=MAX_THINGS)
    places: tuple[PlaceSpec, ...] = Field(default=(), max_length=MAX_THINGS)

    @model_validator(mode="after")
    def _consistent(self) -> "SiteSpec":
        for index, floor in enumerate(self.floors, start=1):
            if floor.number != index:
                raise ValueError(
                    f"floors must be numbered 1, 2, …; item {index} has the number {floor.number}"
                )
        for below, above in pairwise(self.floors):
            if abs(above.z - below.z - self.storey) > LEDGE:
                raise PydanticCustomError(
                    "storey",
                    "it is {storey} m, and floor {above} lies {apart} m above floor {below}: give "
                    "it the height from floor to floor, which is the same everywhere",
                    {
                        "storey": f"{self.storey:g}",
                        "above": above.number,
                        "apart": f"{above.z - below.z:g}",
                        "below": below.number,
                        "path": ("storey",),
                    },
                )
        for (kind, name), paths in self._named().items():
            if len(paths) > 1:
                raise PydanticCustomError(
                    "duplicate",
                    "{thing} occurs twice: names and numbers must be unique",
                    {"thing": f"{kind} {name}", "path": paths[1]},
                )
        return self

    def _named(self) -> dict[tuple[str, str], list[tuple[str | int, ...]]]:
        """Return each kind and name of a named part, with the paths of the fields that hold it."""
        paths: dict[tuple[str, str], list[tuple[str | int, ...]]] = {}

        def add(kind: str, name: object, *path: str | int) -> None:
            paths.setdefault((kind, str(name)), []).append(path)

        for i, area in enumerate(self.areas):
            add("starting area", area.number, "areas", i, "number")
        for i, place in enumerate(self.places):
            add("place", place.name.casefold(), "places", i, "name")
        for i, tower in enumerate(self.towers):
            add("tower", tower.name, "towers", i, "name")
            for k, flight in enumerate(tower.flights):
                add(f"in {tower.name}:", flight.name, "towers", i, "flights", k, "name")
            for k, landing in enumerate(tower.landings):
                add(f"in {tower.name}:", landing.name, "towers", i, "landings", k, "name")
        # Contacts and pictures identify equipment by its name alone.
        for i, vessel in enumerate(self.vessels):
            add("equipment", vessel.name, "vessels", i, "name")
        for i, pipe in enumerate(self.pipes):
            add("equipment", pipe.name, "pipes", i, "name")
        for i, floor in enumerate(self.floors):
            for k, vessel in enumerate(floor.vessels):
                add("equipment", vessel.name, "floors", i, "vessels", k, "name")
            for k, pump in enumerate(floor.pumps):
                add("equipment", pump.name, "floors", i, "pumps", k, "name")
            for k, checkpoint in enumerate(floor.checkpoints):
                path = ("floors", i, "checkpoints", k)
                add("checkpoint", checkpoint.id, *path, "id")
                for n, tag in enumerate(checkpoint.tags):
                    add("tag", tag.upper(), *path, "tags", n)
        return paths
