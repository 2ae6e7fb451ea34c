"""The small parts of the syntax tree: numbers, durations, checkpoints, places, steps."""

from dataclasses import dataclass
from enum import StrEnum

from argo_compiler.catalog import CheckpointKind
from argo_compiler.diagnostics import Span


@dataclass(frozen=True, slots=True, kw_only=True)
class Node:
    """A piece of the syntax tree; `span` is where its text begins and how far it goes."""

    span: Span


@dataclass(frozen=True, slots=True, kw_only=True)
class Number(Node):
    """A whole number, written in figures or as words."""

    value: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Duration(Node):
    """A length of time."""

    seconds: float


class Quantity(StrEnum):
    """What a script asks to be read."""

    VALUE = "value"
    POSITION = "position"
    LEVEL = "level"


@dataclass(frozen=True, slots=True, kw_only=True)
class Name(Node):
    """A checkpoint's name: `valve R25`."""

    kind: CheckpointKind
    identifier: str

    @property
    def text(self) -> str:
        return f"{self.kind} {self.identifier}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Reference(Node):
    """A checkpoint as a script names it: by number, by name, or by both."""

    number: int | None = None
    name: Name | None = None
    quantity: Quantity | None = None
    last: int | None = None
    """`checkpoints #1 to #4`: the last number of a range"""


class NamedFloor(StrEnum):
    """A floor that is named by where it lies."""

    TOP = "top"
    BOTTOM = "bottom"


@dataclass(frozen=True, slots=True, kw_only=True)
class FloorName(Node):
    """A floor by its number, counted from 1 at the bottom, or as the top or the ground floor."""

    number: int | NamedFloor


@dataclass(frozen=True, slots=True, kw_only=True)
class AreaLocation(Node):
    """`starting area 1`."""

    area: Number


@dataclass(frozen=True, slots=True, kw_only=True)
class DockLocation(Node):
    """The docking station, of the starting area that is named with it, if one is."""

    area: Number | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class PlaceLocation(Node):
    """A place of the site by its name: `front of the site`."""

    name: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Coordinates(Node):
    """A point in the site's frame; the height is given by `z` or by the floor."""

    x: float
    """m"""
    y: float
    """m"""
    z: float | None = None
    """m"""
    floor: FloorName | None = None
    yaw: float = 0.0
    """rad"""


Location = AreaLocation | DockLocation | PlaceLocation | Coordinates


@dataclass(frozen=True, slots=True, kw_only=True)
class StepRef(Node):
    """A step by its number, or a task by its name; with `last`, a range of them."""

    first: int | str
    last: int | str | None = None
