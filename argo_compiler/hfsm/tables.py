"""The tables that an executor runs on: a machine whose states know each other directly."""

from collections.abc import Iterator
from dataclasses import dataclass, field

from argo_compiler.base.garbage_collector import collector_held
from argo_compiler.hfsm.conditions import Test, reading_test
from argo_compiler.hfsm.kinds import Cause
from argo_compiler.hfsm.model import (
    MISSION,
    RETURN,
    Composite,
    Hfsm,
    Leaf,
    ReactionState,
    StateTransition,
    TransitionKind,
)
from argo_compiler.il import Action, Condition, EventKind, Stop, Task, WaitRule

_CAUSES = {
    TransitionKind.CONDITIONAL: Cause.CONDITION,
    TransitionKind.REPEAT: Cause.REPEAT,
    TransitionKind.DEFAULT: Cause.DEFAULT,
    TransitionKind.TIMEOUT: Cause.TIMEOUT,
    TransitionKind.FAILURE: Cause.FAILURE,
    TransitionKind.MISSED: Cause.MISSED,
}

Guard = tuple[str, Test]
"""A condition: the checkpoint, and the test of its reading."""


def guards(conditions: tuple[Condition, ...]) -> tuple[Guard, ...]:
    """Conditions as an executor looks at them."""
    return tuple((condition.object_id, reading_test(condition)) for condition in conditions)


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
    free: bool
    """whether it can be taken whatever was measured, in whatever round"""


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
    every: float
    """s from one round to the next; 0: at once"""
    until: tuple[Guard, ...]
    ways: tuple[CompiledTransition, ...] = ()
    timeout: CompiledTransition | None = None


@dataclass(frozen=True, slots=True, eq=False)
class WaitNode:
    """How long a WAIT lasts."""

    duration: float | None
    event: EventKind | None
    guards: tuple[Guard, ...]
    conditions: tuple[Condition, ...]
    limit: float | None


@dataclass(slots=True, eq=False)
class LeafNode:
    """A task, with what its action and its own times need."""

    id: str
    name: str
    task: Task
    parent: GroupNode | None
    retries: int
    optional: bool
    measures: str | None
    """the checkpoint, for MEASURE"""
    wait: WaitNode | None
    """for WAIT, which has no action"""
    earliest: float
    """s since the mission's start; 0: any time"""
    latest: float | None
    """s since the mission's start, for a hard window"""
    time_limit: float | None
    timed: bool
    """whether its own times bring something about while the machine stands at it"""
    done: tuple[str, None, bool]
    """what is kept of a visit that has ended well"""
    returns: bool
    """whether it is the way back to the dock"""
    ways: tuple[CompiledTransition, ...] = ()
    failure: CompiledTransition | None = None
    missed: CompiledTransition | None = None

    @property
    def groups(self) -> Iterator[GroupNode]:
        """The groups that it lies in, from the innermost outward."""
        group = self.parent
        while group is not None:
            yield group
            group = group.parent

    @property
    def may_fail(self) -> bool:
        """Whether it can fail for good other than by its window."""
        return self.wait is None or self.wait.limit is not None


@dataclass(slots=True, eq=False)
class ReactionNode:
    """A reaction, with the task of its drive."""

    state: ReactionState
    task: Task | None

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
            guards=guards(transition.conditions),
            conditions=transition.conditions,
            target=None if transition.target is None else leaves.get(transition.target),
            keep=0 if domain is None else domain.depth + 1,
            domain=domain,
            completes=None if transition.completes is None else groups[transition.completes],
            repeats=domain if transition.kind is TransitionKind.REPEAT else None,
            free=transition.kind is not TransitionKind.REPEAT and not transition.conditions,
        )

    for leaf in hfsm.leaves:
        node = leaves[leaf.id]
        node.ways = tuple(map(way, leaf.transitions))
        node.failure = None if leaf.failure is None else way(leaf.failure)
        node.missed = None if leaf.missed is None else way(leaf.missed)
    for composite in hfsm.composites[1:]:
        group = groups[composite.id]
        group.ways = tuple(map(way, composite.transitions))
        group.timeout = None if composite.timeout is None else way(composite.timeout)
    return Tables(
        initial=leaves.get(hfsm.mission.initial),
        leaves=leaves,
        groups=groups,
        reactions={
            state.reaction.event: ReactionNode(state, state.task) for state in hfsm.reactions
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
        every=repeat.every if repeat else 0.0,
        until=guards(repeat.until) if repeat else (),
    )


def _leaf(leaf: Leaf, groups: dict[str, GroupNode]) -> LeafNode:
    task, window = leaf.task, leaf.task.window
    latest = window.latest if window is not None and window.hard else None
    wait = _wait(task.wait) if task.action is Action.WAIT and task.wait is not None else None
    return LeafNode(
        id=leaf.id,
        name=task.name,
        task=task,
        parent=groups.get(leaf.parent),
        retries=0 if wait is not None else task.retries,
        optional=task.optional,
        measures=task.object_id if task.action is Action.MEASURE else None,
        wait=wait,
        earliest=0.0 if window is None else window.earliest,
        latest=latest,
        time_limit=task.time_limit,
        timed=wait is not None or latest is not None,
        done=(task.name, None, False),
        returns=leaf.id == RETURN,
    )


def _wait(rule: WaitRule) -> WaitNode:
    return WaitNode(rule.duration, rule.event, guards(rule.conditions), rule.conditions, rule.limit)
