"""Steps and header of a script."""

from argo_compiler.base.records import dataclass
from argo_compiler.il import Mode, Order
from argo_compiler.script.sentences.tree.node import Node, node
from argo_compiler.script.sentences.tree.orders import Fact, Sentence
from argo_compiler.script.sentences.tree.places import Coordinates, Steps


@node
class Text(Node):
    """A field that is kept as text."""

    text: str


@node
class Areas(Node):
    """A field that names starting areas: more than one leaves the choice to the preparation."""

    areas: tuple[int, ...]
    dock: bool = False
    """whether it names the docking station, perhaps without its area"""


@node
class AreaChosen(Node):
    """`Start area: 1`, perhaps `none`, perhaps `as planned`: then the steps stay as they are."""

    area: int | None
    as_planned: bool


@node
class Unread(Node):
    """A sentence with an error: what it would ask for is not known."""


Said = Sentence | Fact | Unread


@node
class ScriptStep(Node):
    """A numbered line, a bullet or a paragraph, with those that lie within it."""

    number: int | None
    """as printed"""
    sentences: tuple[Said, ...]
    steps: "tuple[ScriptStep, ...]" = ()


@dataclass(kw_only=True)
class ScriptHeader:
    """What is said of the mission as a whole. None: nothing is. Mutable: it grows line by line."""

    title: Text | None = None
    format_title: bool = False
    """whether the title is no more than the name of the format, such as `Mission protocol`"""
    designation: Text | None = None
    site: Text | None = None
    mode: Mode | None = None
    max_duration: tuple[float, Node] | None = None
    """s; the node tells where it is said"""
    order: Order | None = None
    anomaly_specification: Text | None = None
    real_time_reporting: Text | None = None
    after_mission_report: Text | None = None
    initial_position: Areas | None = None
    end_of_mission: Areas | None = None
    areas_open: Text | None = None
    """where it says that the areas are chosen when the script is imported"""
    start_area: AreaChosen | None = None
    end_area: AreaChosen | None = None
    dock_said: bool = False
    dock: Coordinates | None = None
    current: Steps | None = None
    left_out: tuple[str, ...] = ()
