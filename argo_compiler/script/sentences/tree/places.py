"""Places, floors and steps as a script names them."""

from enum import StrEnum

from argo_compiler.script.sentences.tree.node import Node, node


class NamedFloor(StrEnum):
    """A floor that is named by where it lies."""

    TOP = "top"
    BOTTOM = "bottom"
    GROUND = "ground"


@node
class FloorName(Node):
    """A floor by its number, counted from 1 at the bottom, or as the top or the ground floor."""

    number: int | NamedFloor


@node
class AreaLocation(Node):
    """`starting area 1`."""

    area: int


@node
class DockLocation(Node):
    """The docking station, of the starting area that is named with it, if one is."""

    area: AreaLocation | None = None


@node
class PlaceLocation(Node):
    """A place of the site by its name: `front of the site`."""

    name: str


@node
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


@node
class Steps(Node):
    """Steps by their numbers, or tasks by their names."""

    points: tuple[int | str, ...]
    through: bool = False
    """two points: from the first to the second; else each of them"""
    ahead: bool = False
    """whether they are counted from the step that says so: `the next step`"""
    behind: bool = False
    """what stands behind them is meant"""
