"""What the parser makes of a script: the syntax tree. Every node knows its place.

A `Script` is a `Sheet` or a `Protocol`. Nothing here is looked up yet: a checkpoint is the number
or the name that the script says, whether or not the site has it.
"""

from dataclasses import dataclass
from typing import Literal

from argo_compiler.diagnostics import Diagnostic
from argo_compiler.il import Mode, Order
from argo_compiler.script.syntax.commands import Command
from argo_compiler.script.syntax.terms import (
    Coordinates,
    Duration,
    Node,
    Number,
    Reference,
    StepRef,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class TextField(Node):
    """A field that is kept as text."""

    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class AreaField(Node):
    """A cell that names starting areas: more than one leaves the choice to the preparation."""

    text: str
    areas: tuple[Number, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeField(Node):
    """The main mode."""

    mode: Mode


@dataclass(frozen=True, slots=True, kw_only=True)
class OrderField(Node):
    """Whether the checkpoints' order is free."""

    order: Order


@dataclass(frozen=True, slots=True, kw_only=True)
class SheetStep(Node):
    """`3. Checkpoint #8: read the value on pressure gauge 5`."""

    number: int | None
    """of the step, as printed"""
    checkpoint: Reference


@dataclass(frozen=True, slots=True, kw_only=True)
class Sheet:
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


@dataclass(frozen=True, slots=True, kw_only=True)
class AreaHeader(Node):
    """`Start area: 1`, perhaps `none`, perhaps `as planned`: then the steps stay as they are."""

    area: int | None
    as_planned: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class DockHeader(Node):
    """`Dock: (3.05, -2.55, 0)` or `Dock: none`."""

    dock: Coordinates | None


@dataclass(frozen=True, slots=True, kw_only=True)
class CurrentHeader(Node):
    """`Current: "MEASURE 4"`."""

    task: StepRef


@dataclass(frozen=True, slots=True, kw_only=True)
class LeftOutHeader(Node):
    """`Left out: "MEASURE 4", "MEASURE 5"`."""

    tasks: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class DurationHeader(Node):
    """`Maximum duration: 20'` or `none`."""

    seconds: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class ProtocolStep(Node):
    """One line of a protocol: a command, or several, carried out in order."""

    number: int | None
    """of the step, as printed"""
    commands: tuple[Command, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Hint(Node):
    """A remark to the person who plans. It is kept and has no effect on the mission."""

    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Protocol:
    """A mission protocol: commands that plan a mission, carried out one after the other."""

    kind: Literal["protocol"] = "protocol"
    source_name: str
    source_text: str
    title: TextField | None = None
    designation: TextField | None = None
    site: TextField | None = None
    mode: ModeField | None = None
    max_duration: DurationHeader | None = None
    order: OrderField | None = None
    anomaly_specification: TextField | None = None
    real_time_reporting: TextField | None = None
    after_mission_report: TextField | None = None
    initial_position: AreaField | None = None
    end_of_mission: AreaField | None = None
    start_area: AreaHeader | None = None
    end_area: AreaHeader | None = None
    dock: DockHeader | None = None
    current: CurrentHeader | None = None
    left_out: LeftOutHeader | None = None
    steps: tuple[ProtocolStep, ...] = ()
    hints: tuple[Hint, ...] = ()
    diagnostics: tuple[Diagnostic, ...] = ()


Script = Sheet | Protocol
