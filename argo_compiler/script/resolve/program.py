"""The plan while a script's orders are carried out: what is to be done, in blocks.

A program is mutable: orders add to it, change it and wrap parts of it into rounds. At the end
`lowering` makes the tasks, transitions and groups of a mission from it.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import field
from enum import StrEnum

from argo_compiler.base.catalog import CheckpointInfo
from argo_compiler.base.model import Pose
from argo_compiler.base.records import dataclass
from argo_compiler.diagnostics import Span
from argo_compiler.editing.linked_list import LinkedList, ListItem
from argo_compiler.il import Action, Condition, JointState, OnFailure, TimeWindow, WaitRule
from argo_compiler.script.sentences.tree.places import Steps

Alternatives = tuple[tuple[Condition, ...], ...]
"""conditions, of one of whose tuples all must hold; none at all: in any case"""


class Ahead(StrEnum):
    """Where a way may lead besides a step."""

    GO_ON = "go on"
    END = "end"


@dataclass(frozen=True, slots=True)
class HomeAhead:
    """The drive into the docking station with which the mission ends."""

    dock: Pose | None
    """None: the mission's"""
    span: Span


Target = Ahead | HomeAhead | Steps


@dataclass(frozen=True, slots=True)
class Way:
    """A way on from a task that leads to another one; without conditions, if no other is taken."""

    alternatives: Alternatives
    target: Target
    span: Span
    otherwise: bool = False
    """whether no condition behind it is looked at any more"""
    last_round: bool = False
    """of a way without conditions: it is taken after the last round that ends with its task"""


@dataclass(eq=False, slots=True)
class ProgramNode(ListItem):
    """A part of a block."""

    block: "ProgramBlock | None" = field(default=None, init=False, repr=False)

    @property
    def home(self) -> "ProgramBlock":
        """The block that it stands in."""
        assert self.block is not None
        return self.block

    @property
    def owner(self) -> "ProgramNode | None":
        """The node in whose block it stands; None: in the program itself, or not at all."""
        return None if self.block is None else self.block.owner


class ProgramBlock(LinkedList[ProgramNode]):
    """Nodes that are carried out one after the other."""

    def __init__(self, owner: ProgramNode | None = None) -> None:
        super().__init__()
        self.owner = owner
        """the node that this is a part of"""

    def insert_after(self, anchor: ProgramNode | None, item: ProgramNode) -> None:
        super().insert_after(anchor, item)
        item.block = self


@dataclass(eq=False, slots=True)
class Do(ProgramNode):
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
    wait: WaitRule | None = None
    velocity: float | None = None
    """m/s on the way to it"""
    leaving: float | None = None
    """m/s on all ways that lead on from it"""
    retries: int = 0
    on_failure: OnFailure = OnFailure.CONTINUE
    failure: ProgramBlock | None = None
    """what is done if it fails, with BRANCH"""
    missed: ProgramBlock | None = None
    """what is done if its window is missed"""
    joints: JointState | None = None
    shown_in: str | None = None
    time_limit: float | None = None
    reading_limit: float | None = None
    optional: bool = False
    priority: int = 1
    window: TimeWindow | None = None
    ways: list[Way] = field(default_factory=list)

    @property
    def branches(self) -> bool:
        """Return True if the mission may go on elsewhere than with the next task."""
        return bool(self.ways or self.failure or self.missed)


@dataclass(eq=False, slots=True)
class Choice(ProgramNode):
    """What is done if a condition holds, and what if it does not."""

    alternatives: Alternatives
    span: Span
    negated: bool = False
    bound: bool = False
    """whether it stands in the step of what it is looked at after"""
    then: ProgramBlock = field(init=False)
    otherwise: ProgramBlock = field(init=False)

    def __post_init__(self) -> None:
        self.then, self.otherwise = ProgramBlock(self), ProgramBlock(self)


@dataclass(frozen=True, slots=True)
class Limits:
    """What ends a round's repetitions, and when each begins."""

    count: int = 0
    duration: float = 0.0
    """s"""
    every: float = 0.0
    """s"""
    pause: float = 0.0
    """s between one round and the next"""
    until: tuple[Condition, ...] = ()
    soft: bool = False
    count_interruptions: bool = False


@dataclass(eq=False, slots=True)
class ProgramRound(ProgramNode):
    """A block that is repeated."""

    base: str
    limits: Limits
    span: Span
    order: int
    """which one it is of those that the script asks for"""
    name: str | None = None
    body: ProgramBlock = field(init=False)

    def __post_init__(self) -> None:
        self.body = ProgramBlock(self)

    @property
    def title(self) -> str:
        return self.name or self.base


@dataclass(eq=False, slots=True)
class Leave(ProgramNode):
    """A way that leads elsewhere than to what follows."""

    target: Target
    span: Span


def all_nodes(block: Iterable[ProgramNode]) -> Iterator[ProgramNode]:
    """All nodes of a block and of those in it, in the order of the tasks that they become."""
    stack: list[Iterator[ProgramNode]] = [iter(block)]
    while stack:
        node = next(stack[-1], None)
        if node is None:
            stack.pop()
            continue
        yield node
        stack.extend(iter(inner) for inner in reversed(inner_blocks(node)))


def depth(block: ProgramBlock) -> int:
    """Return the number of nested blocks, at the deepest point."""
    deepest, waiting = 0, [(block, 1)]
    while waiting:
        block, level = waiting.pop()
        deepest = max(deepest, level)
        waiting += [(inner, level + 1) for node in block for inner in inner_blocks(node)]
    return deepest


def inner_blocks(node: ProgramNode) -> tuple[ProgramBlock, ...]:
    """The blocks of a node, in order."""
    match node:
        case Do(failure=None, missed=None):
            return ()  # most nodes
        case Do():
            return tuple(b for b in (node.failure, node.missed) if b is not None)
        case Choice():
            return node.then, node.otherwise
        case ProgramRound():
            return (node.body,)
    return ()


def in_branch(block: ProgramBlock) -> bool:
    """Whether a block is carried out in one case only."""
    owner = block.owner
    while isinstance(owner, ProgramRound):
        owner = owner.owner
    return owner is not None


def leads_away(node: ProgramNode | None) -> bool:
    """Whether the mission never comes to what stands behind a node."""
    if isinstance(node, Leave):
        return node.target is not Ahead.GO_ON
    if isinstance(node, Do):
        return any(
            not w.alternatives and not w.last_round and w.target is not Ahead.GO_ON
            for w in node.ways
        )
    return False


def own_names(tasks: Sequence[Do]) -> list[str]:
    """The names of tasks: the script's own ones, and numbered ones for the others."""
    own = {do.name for do in tasks if do.name is not None}
    used: Counter[str] = Counter()

    def numbered(base: str) -> str:
        while True:
            used[base] += 1
            found = base if used[base] == 1 else f"{base} ({used[base]})"
            if base == Action.WAYPOINT:
                found = f"{base} {used[base]}"
            if found not in own:
                return found

    return [numbered(do.base) if do.name is None else do.name for do in tasks]


def dock(pose: Pose, source: Span | None) -> Do:
    """The way into the docking station."""
    return Do("DOCK", Action.WAYPOINT, source, pose, docks=True)


def measurement(checkpoint: CheckpointInfo, source: Span) -> Do:
    """One measurement."""
    number = str(checkpoint.id)
    return Do(f"MEASURE {number}", Action.MEASURE, source, object_id=number)
