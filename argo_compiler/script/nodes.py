"""What the parser makes of a script: the syntax tree. Every node knows its place.

A `Script` is a `Sheet` or a `Protocol`. Nothing here is looked up yet: a checkpoint is the number
or the name that the script says, whether or not the site has it.
"""

from enum import StrEnum
from typing import Literal

from argo_compiler.catalog import CheckpointKind
from argo_compiler.diagnostics import Diagnostic, Span
from argo_compiler.il import Mode, Order
from argo_compiler.model import Model


class Node(Model):
    """A piece of the syntax tree; `span` is where its text begins and how far it goes."""

    span: Span


class Number(Node):
    """A whole number, written in figures or as a word."""

    value: int


class Duration(Node):
    """A length of time."""

    seconds: float


class Quantity(StrEnum):
    """What a script asks to be read."""

    VALUE = "value"
    POSITION = "position"
    LEVEL = "level"


class Name(Node):
    """A checkpoint's name: `valve R25`."""

    kind: CheckpointKind
    identifier: str

    @property
    def text(self) -> str:
        return f"{self.kind} {self.identifier}"


class Reference(Node):
    """A checkpoint as a script names it: by number, by name, or by both."""

    number: int | None = None
    name: Name | None = None
    quantity: Quantity | None = None


# ---- the sheet (thesis, figure 1.4)


class TextField(Node):
    """A cell of the sheet that is kept as text."""

    text: str


class AreaField(Node):
    """A cell that names starting areas: more than one leaves the choice to the preparation."""

    text: str
    areas: tuple[Number, ...]


class ModeField(Node):
    """The main mode."""

    mode: Mode


class OrderField(Node):
    """The sentence that introduces the checkpoints and says whether their order is free."""

    order: Order


class SheetStep(Node):
    """`3. Checkpoint #8: read the value on pressure gauge 5`."""

    number: int | None
    """of the step, as printed"""
    checkpoint: Reference


class Sheet(Model):
    """A mission sheet. A field that the sheet does not have is None."""

    kind: Literal["sheet"] = "sheet"
    source_name: str
    source_text: str
    designation: TextField | None = None
    mode: ModeField | None = None
    max_duration: Duration | None = None
    anomaly_specification: TextField | None = None
    real_time_reporting: TextField | None = None
    after_mission_report: TextField | None = None
    initial_position: AreaField | None = None
    end_of_mission: AreaField | None = None
    order: OrderField | None = None
    steps: tuple[SheetStep, ...] = ()
    diagnostics: tuple[Diagnostic, ...] = ()


# ---- the protocol (thesis, figure 5.1)


class AreaLocation(Node):
    """`starting area 1`."""

    area: Number


class DockLocation(Node):
    """The docking station, of the starting area that is named with it, if one is."""

    area: Number | None = None


class PlaceLocation(Node):
    """A place of the site by its name: `front of the site`."""

    name: str


Location = AreaLocation | DockLocation | PlaceLocation


class SetStart(Node):
    """`Set a starting point in front of the site`."""

    location: Location


class Patrol(Node):
    """`Patrol the first floor in circles for 10 minutes`; the first limit reached ends it."""

    floor: Number
    duration: Duration | None = None
    rounds: Number | None = None


class Measure(Node):
    """`Check the checkpoint #14`: one more measurement, after what was asked for so far."""

    checkpoint: Reference


class Side(StrEnum):
    """Where something is added."""

    BEFORE = "before"
    AFTER = "after"


class Add(Node):
    """`Add checkpoint #2 after checkpoint #14`; without `anchor` the same as `Measure`."""

    checkpoint: Reference
    anchor: Reference | None = None
    side: Side = Side.AFTER


class Delete(Node):
    """`Delete the measuring of checkpoint #2`."""

    checkpoint: Reference


class Go(Node):
    """`Go to the front of the site`, `Return to the docking station`."""

    location: Location


class Done(Node):
    """`Done!`: the protocol ends here."""


Command = SetStart | Patrol | Measure | Add | Delete | Go | Done


class ProtocolStep(Node):
    """One line of a protocol: a command, or several joined by `and`, carried out in order."""

    number: int | None
    """of the step, as printed"""
    commands: tuple[Command, ...]


class Hint(Node):
    """A remark to the person who plans. It is kept and has no effect on the mission."""

    text: str


class Protocol(Model):
    """A mission protocol: commands that plan a mission, carried out one after the other."""

    kind: Literal["protocol"] = "protocol"
    source_name: str
    source_text: str
    title: TextField | None = None
    steps: tuple[ProtocolStep, ...] = ()
    hints: tuple[Hint, ...] = ()
    diagnostics: tuple[Diagnostic, ...] = ()


Script = Sheet | Protocol
