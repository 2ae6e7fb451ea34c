"""The plan while a script's commands are carried out: what is to be done, in order.

A plan is mutable. Its order is edited as that of a mission is (`argo_compiler.editing`); the tasks
get their names and transitions at the end, when their order is known.
"""

from dataclasses import dataclass

from argo_compiler.diagnostics import Span
from argo_compiler.editing.linked import Linked, LinkedList
from argo_compiler.il import Action, Condition, JointState, OnFailure, WaitRule
from argo_compiler.model import Pose
from argo_compiler.script.syntax.commands import Limits, Plain
from argo_compiler.script.syntax.terms import StepRef


@dataclass(eq=False, slots=True)
class Item(Linked):
    """One task to be."""

    base: str
    """what the task is called where it is the only one of its kind"""
    action: Action
    source: Span | None = None
    pose: Pose | None = None
    object_id: str | None = None
    name: str | None = None
    """set if the script names the task itself"""
    docks: bool = False
    apart: bool = False
    """the task before it does not go on with it: only routes lead there"""
    arriving: float | None = None
    """m/s on the way to it"""
    leaving: float | None = None
    """m/s on all ways that lead on from it"""
    retries: int = 0
    on_failure: OnFailure = OnFailure.CONTINUE
    joints: JointState | None = None
    shown_in: str | None = None
    routes: list["ResolvedBranch"] | None = None
    detour: "Item | None" = None
    """the last item of those that are carried out only if a route of this one leads there"""
    returns: "Item | None" = None
    """the item of whose detours this one is the last; after it the mission goes on behind them"""


@dataclass(eq=False, slots=True)
class ResolvedBranch:
    """A route of an item, its checkpoints looked up; no alternatives: unconditional."""

    alternatives: tuple[tuple[Condition, ...], ...]
    target: "Plain | StepRef | Item | Home"
    span: Span
    otherwise: bool = False
    """whether it is one of several cases; without it, unconditional is what comes then"""


@dataclass(frozen=True, slots=True)
class Home:
    """The drive to the docking station at the end of the mission."""

    area: int | None
    span: Span


@dataclass(eq=False, slots=True)
class PlannedGroup:
    """A group to be: from an item to an item, or over steps that are looked up at the end."""

    base: str
    limits: Limits
    span: Span
    name: str | None = None
    first: Item | None = None
    last: Item | None = None
    steps: StepRef | None = None
    whole: bool = False
    """over all tasks but START"""
    after: Item | None = None
    """the place behind it, where it is decided how the mission goes on after the last round"""

    @property
    def title(self) -> str:
        """What it is called in the names of its places."""
        return self.name or self.base


class Plan(LinkedList[Item]):
    """Items in order, and rounds in the order in which they were asked for."""

    def __init__(self) -> None:
        super().__init__()
        self.rounds: list[PlannedGroup] = []


def start_item(pose: Pose | None, source: Span | None) -> Item:
    """Where the mission begins."""
    return Item("START", Action.START, source, pose)


def dock_item(pose: Pose, source: Span | None) -> Item:
    """The way into the docking station."""
    return Item("DOCK", Action.WAYPOINT, source, pose, docks=True)


def waypoint_item(pose: Pose, source: Span | None) -> Item:
    """The way to a place."""
    return Item("WAYPOINT", Action.WAYPOINT, source, pose)


def measure_item(checkpoint: int, source: Span | None) -> Item:
    """One measurement."""
    return Item(f"MEASURE {checkpoint}", Action.MEASURE, source, object_id=str(checkpoint))


def place_item(name: str, source: Span | None) -> Item:
    """A place of no duration, at which ways meet."""
    return Item(name, Action.WAIT, source)


MEETING = WaitRule(duration=0)
"""how long such a place takes"""
