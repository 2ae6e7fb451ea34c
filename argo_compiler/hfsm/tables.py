"""The tables that an executor runs on: a machine whose states know each other directly."""

from collections.abc import Callable
from dataclasses import dataclass, field

from argo_compiler.garbage_collector import collector_held
from argo_compiler.hfsm.conditions import comparison
from argo_compiler.hfsm.events import StartAction
from argo_compiler.hfsm.model import (
    MISSION,
    Composite,
    Hfsm,
    Leaf,
    ReactionState,
    StateTransition,
    TransitionKind,
)
from argo_compiler.hfsm.trace import Cause
from argo_compiler.il import Action, Condition, EventKind, Stop, Task

_CAUSES = {
    TransitionKind.CONDITIONAL: Cause.CONDITION,
    TransitionKind.REPEAT: Cause.REPEAT,
    TransitionKind.DEFAULT: Cause.DEFAULT,
    TransitionKind.TIMEOUT: Cause.TIMEOUT,
    TransitionKind.FAILURE: Cause.FAILURE,
}

Guard = tuple[str, Callable[[float], bool], float | None]
"""A condition: the checkpoint, the test of its value, and its greatest age (s)."""


@dataclass(slots=True, eq=False)
class CompiledTransition:
    """A transition. Filled in while the tables are made, then never changed."""

    cause: Cause
    guards: tuple[Guard, ...]
    conditions: tuple[Condition, ...]
    target: "LeafNode | None"
    """None: the final state, or `completes`"""
    keep: int
    """how many of the active groups, from the outermost, are not left"""
    domain: "GroupNode | None"
    """the innermost of them"""
    completes: "GroupNode | None"
    repeats: "GroupNode | None"


@dataclass(slots=True, eq=False)
class GroupNode:
    """A group. `depth` is its place among the active groups, from 0."""

    id: str
    name: str
    parent: "GroupNode | None"
    depth: int
    count: int
    duration: float
    counts_interruptions: bool
    hard: bool
    """whether a time-out leaves it"""
    ways: tuple[CompiledTransition, ...] = ()
    timeout: CompiledTransition | None = None


@dataclass(slots=True, eq=False)
class LeafNode:
    """A task, with the command that starts its action."""

    id: str
    name: str
    task: Task
    parent: GroupNode | None
    start: tuple[StartAction, ...]
    retries: int
    measures: str | None
    """the checkpoint, for MEASURE"""
    ways: tuple[CompiledTransition, ...] = ()
    failure: CompiledTransition | None = None


@dataclass(slots=True, eq=False)
class ReactionNode:
    """A reaction, with the command that starts its drive."""

    state: ReactionState
    start: tuple[StartAction, ...]

    @property
    def rank(self) -> tuple[int, int]:
        return self.state.reaction.rank


@dataclass(slots=True, eq=False)
class Tables:
    """A machine, looked up by ids. It does not change."""

    initial: LeafNode | None
    leaves: dict[str, LeafNode]
    groups: dict[str, GroupNode]
    reactions: dict[EventKind, ReactionNode]
    max_duration: float | None
    has_hard_groups: bool = field(default=False)


def tables(hfsm: Hfsm) -> Tables:
    """The tables of a machine, in linear time."""
    with collector_held():
        return _tables(hfsm)


def _tables(hfsm: Hfsm) -> Tables:
    groups: dict[str, GroupNode] = {}
    for composite in hfsm.composites[1:]:
        groups[composite.id] = _group(composite, groups)
    leaves = {leaf.id: _leaf(leaf, groups) for leaf in hfsm.leaves}

    def way(transition: StateTransition) -> CompiledTransition:
        domain = None if transition.domain is None else groups.get(transition.domain)
        return CompiledTransition(
            cause=_CAUSES[transition.kind],
            guards=tuple((c.object_id, comparison(c), c.max_age) for c in transition.conditions),
            conditions=transition.conditions,
            target=None if transition.target is None else leaves.get(transition.target),
            keep=0 if domain is None else domain.depth + 1,
            domain=domain,
            completes=None if transition.completes is None else groups[transition.completes],
            repeats=domain if transition.kind is TransitionKind.REPEAT else None,
        )

    for leaf in hfsm.leaves:
        node = leaves[leaf.id]
        node.ways = tuple(map(way, leaf.transitions))
        node.failure = None if leaf.failure is None else way(leaf.failure)
    for composite in hfsm.composites[1:]:
        group = groups[composite.id]
        group.ways = tuple(map(way, composite.transitions))
        group.timeout = None if composite.timeout is None else way(composite.timeout)
    return Tables(
        initial=leaves.get(hfsm.mission.initial),
        leaves=leaves,
        groups=groups,
        reactions={
            state.reaction.event: ReactionNode(
                state, () if state.task is None else (StartAction(state.task),)
            )
            for state in hfsm.reactions
        },
        max_duration=hfsm.max_duration,
        has_hard_groups=any(group.hard for group in groups.values()),
    )


def _group(composite: Composite, groups: dict[str, GroupNode]) -> GroupNode:
    parent = None if composite.parent in (None, MISSION) else groups[composite.parent or ""]
    repeat = composite.repeat
    return GroupNode(
        id=composite.id,
        name=composite.name,
        parent=parent,
        depth=0 if parent is None else parent.depth + 1,
        count=repeat.count if repeat else 1,
        duration=repeat.duration if repeat else 0.0,
        counts_interruptions=bool(repeat and repeat.count_interruptions),
        hard=composite.timeout is not None and bool(repeat and repeat.stop is Stop.HARD),
    )


def _leaf(leaf: Leaf, groups: dict[str, GroupNode]) -> LeafNode:
    task = leaf.task
    return LeafNode(
        id=leaf.id,
        name=task.name,
        task=task,
        parent=groups.get(leaf.parent),
        start=(StartAction(task),),
        retries=task.retries,
        measures=task.object_id if task.action is Action.MEASURE else None,
    )
