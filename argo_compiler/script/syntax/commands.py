"""The commands of a protocol, and what may stand behind them."""

from dataclasses import dataclass
from enum import StrEnum

from argo_compiler.il import Afterwards, ConditionType, EventKind, OnFailure, Response
from argo_compiler.script.syntax.terms import (
    Coordinates,
    DockLocation,
    FloorName,
    Location,
    Node,
    Reference,
    StepRef,
)


class Normality(StrEnum):
    """A comparison with a checkpoint's normal values."""

    NORMAL = "normal"
    ABNORMAL = "abnormal"


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison(Node):
    """`the value of checkpoint #1 is greater than 5 bar`."""

    subject: Reference | None
    """None: the checkpoint that was measured last"""
    test: ConditionType | Normality
    param1: float = 0.0
    param2: float | None = None
    inclusive: bool = False
    units: tuple[str, ...] = ()
    max_age: float | None = None
    """s"""
    id: str = ""


class Plain(StrEnum):
    """Where a route may lead besides a step."""

    GO_ON = "go on"
    END = "end"


@dataclass(frozen=True, slots=True, kw_only=True)
class Branch(Node):
    """Where to go on after a task. The conditions of an alternative must all hold."""

    alternatives: tuple[tuple[Comparison, ...], ...] = ()
    """none: unconditional"""
    target: "Plain | StepRef | DockLocation | tuple[Command, ...]"
    """commands are carried out in this case only"""
    otherwise: bool = False
    """whether it is the case in which no condition holds; without it, unconditional means then"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Joints:
    """Positions of named joints."""

    names: tuple[str, ...]
    positions: tuple[float, ...]


@dataclass(slots=True, kw_only=True)
class Manner:
    """How the tasks of a command are carried out."""

    speed: float | None = None
    """m/s on the way to each of them"""
    leaving: float | None = None
    """m/s on the way to the task after"""
    retries: int | None = None
    on_failure: OnFailure | None = None
    failure_dock: DockLocation | None = None
    """the docking station that is named for a failure"""
    joints: Joints | None = None
    shown_in: str | None = None
    object_id: str | None = None
    pose: Coordinates | None = None


@dataclass(slots=True, kw_only=True)
class Limits:
    """How often and how long a round is driven."""

    count: int = 0
    """rounds in all; 0: no limit"""
    duration: float = 0.0
    """s; 0: no limit"""
    soft: bool = False
    count_interruptions: bool = False
    endless: bool = False
    """that there is no limit was said"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Planned(Node):
    """A command that plans tasks."""

    name: str | None = None
    manner: Manner | None = None
    routes: tuple[Branch, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class SetStart(Planned):
    """`Set a starting point in front of the site`; with `here` it stays where the line stands."""

    location: Location | None
    here: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Patrol(Planned):
    """`Patrol the first floor in circles for 10 minutes`; the first limit reached ends it."""

    places: tuple[FloorName | Location, ...]
    limits: Limits


@dataclass(frozen=True, slots=True, kw_only=True)
class Measure(Planned):
    """`Check the checkpoint #14`: one more measurement, after what was asked for so far."""

    checkpoints: tuple[Reference, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Meet(Planned):
    """`Go on here`: a place of no duration, at which nothing is done and ways meet."""


class Side(StrEnum):
    """Where something is put."""

    BEFORE = "before"
    AFTER = "after"


@dataclass(frozen=True, slots=True, kw_only=True)
class Add(Planned):
    """`Add checkpoint #2 after checkpoint #14`."""

    checkpoints: tuple[Reference, ...]
    anchor: Reference | StepRef
    side: Side


@dataclass(frozen=True, slots=True, kw_only=True)
class Go(Planned):
    """`Go to the front of the site`, `Return to the docking station`."""

    location: Location


@dataclass(frozen=True, slots=True, kw_only=True)
class Amend(Planned):
    """Routes and manner for the task before: `If the value is above 5, skip to step 4`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Delete(Node):
    """`Delete the measuring of checkpoint #2`."""

    things: tuple[Reference | StepRef, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Move(Node):
    """`Move checkpoint #4 before checkpoint #1`."""

    things: tuple[Reference | StepRef, ...]
    anchor: Reference | StepRef
    side: Side


@dataclass(frozen=True, slots=True, kw_only=True)
class Replace(Node):
    """`Replace checkpoint #1 by checkpoint #2`."""

    thing: Reference | StepRef
    by: Reference


@dataclass(frozen=True, slots=True, kw_only=True)
class Repeat(Node):
    """`Repeat steps 2 to 4 three times`."""

    name: str | None = None
    steps: StepRef | None
    """None: all"""
    limits: Limits
    routes: tuple[Branch, ...] = ()
    """where the mission goes on behind the last round"""


@dataclass(frozen=True, slots=True, kw_only=True)
class React(Node):
    """`If a gas leak is detected, report it and return to the docking station`."""

    events: tuple[EventKind, ...]
    """each of them has this reaction"""
    response: Response
    location: Location | None = None
    until: EventKind | None = None
    afterwards: Afterwards = Afterwards.END
    priority: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Done(Node):
    """`Done!`: the protocol ends here."""


Command = (
    SetStart
    | Patrol
    | Measure
    | Meet
    | Add
    | Go
    | Amend
    | Delete
    | Move
    | Replace
    | Repeat
    | React
    | Done
)
