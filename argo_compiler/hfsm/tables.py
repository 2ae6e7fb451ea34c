"""Tables that an executor runs on: a state machine whose states refer to each other directly."""

from collections.abc import Iterator
from dataclasses import dataclass, field

from argo_compiler.base.garbage_collector import collector_held
from argo_compiler.hfsm.conditions import ReadingTest, reading_test
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

Guard = tuple[str, ReadingTest]
"""condition: the object_id of its checkpoint, and the check of the reading"""


def compile_guards(conditions: tuple[Condition, ...]) -> tuple[Guard, ...]:
    """Return conditions in the form that an executor evaluates quickly."""
    return tuple((condition.object_id, reading_test(condition)) for condition in conditions)


@dataclass(slots=True, eq=False)
class CompiledTransition:
    """Transition. It is filled in while the tables are made, and never changes afterwards."""

    cause: Cause
    guards: tuple[Guard, ...]
    conditions: tuple[Condition, ...]
    target: "LeafNode | None"
    """next leaf; None for the final state, or with `completes`"""
    kept_groups: int
    """how many of the active groups, from the outermost, are not left"""
    kept_rounds: int
    """how many of the active groups, from the outermost, stay in their round"""
    domain: "GroupNode | None"
    """the innermost of the groups that are not left; None if all are left"""
    completes: "GroupNode | None"
    repeats: "GroupNode | None"
    always_possible: bool
    """whether it can be taken in every round and with every reading"""


@dataclass(slots=True, eq=False)
class GroupNode:
    """Group. `depth` is its index among the active groups, from 0 for the outermost."""

    id: str
    name: str
    parent: "GroupNode | None"
    depth: int
    count: int
    duration: float
    counts_interruptions: bool
    has_hard_stop: bool
    """whether the machine leaves it at its time-out"""
    every: float
    """s from the start of one round to the next; 0: the next round starts at once"""
    until: tuple[Guard, ...]
    transitions: tuple[CompiledTransition, ...] = ()
    timeout: CompiledTransition | None = None


@dataclass(frozen=True, slots=True, eq=False)
class WaitNode:
    """End of a WAIT: by time, by an event, or by conditions."""

    duration: float | None
    event: EventKind | None
    guards: tuple[Guard, ...]
    conditions: tuple[Condition, ...]
    limit: float | None


@dataclass(slots=True, eq=False)
class LeafNode:
    """Task, with the data that its action and its own times need."""

    id: str
    name: str
    task: Task
    parent: GroupNode | None
    retries: int
    optional: bool
    measures: str | None
    """object_id of the checkpoint, for MEASURE"""
    wait: WaitNode | None
    """for WAIT, which has no action"""
    earliest: float
    """s since the mission's start; 0: any time"""
    latest: float | None
    """s since the mission's start, for a hard window"""
    time_limit: float | None
    is_timed: bool
    """whether its own times can change the state of the machine during a visit"""
    ended_visit: tuple[str, None, bool]
    """record of a visit that has ended well"""
    is_return: bool
    """whether it is the drive back to the dock after a failure"""
    transitions: tuple[CompiledTransition, ...] = ()
    failure: CompiledTransition | None = None
    missed: CompiledTransition | None = None

    @property
    def groups_outward(self) -> Iterator[GroupNode]:
        """The groups around the task, from the innermost outward."""
        group = self.parent
        while group is not None:
            yield group
            group = group.parent

    @property
    def can_fail_by_action_or_limit(self) -> bool:
        """True if the task can fail for good by its action or its wait's limit, not its window."""
        return self.wait is None or self.wait.limit is not None


@dataclass(slots=True, eq=False)
class ReactionNode:
    """Reaction, with the task of its drive."""

    state: ReactionState
    task: Task | None

    @property
    def urgency_score(self) -> tuple[int, int]:
        return self.state.reaction.urgency_score


@dataclass(slots=True, eq=False)
class Tables:
    """State machine as look-up tables by id. It does not change."""

    initial: LeafNode | None
    leaves: dict[str, LeafNode]
    groups: dict[str, GroupNode]
    reactions: dict[EventKind, ReactionNode]
    max_duration: float | None
    has_hard_groups: bool = field(default=False)


def build_tables(hfsm: Hfsm) -> Tables:
    """Return the tables of a machine, in linear time."""
    with collector_held():
        return _build_tables(hfsm)


def _build_tables(hfsm: Hfsm) -> Tables:
    groups: dict[str, GroupNode] = {}
    for composite in hfsm.composites[1:]:
        groups[composite.id] = _group(composite, groups)
    leaves = {leaf.id: _leaf(leaf, groups) for leaf in hfsm.leaves}

    def compile_transition(transition: StateTransition) -> CompiledTransition:
        domain = None if transition.domain is None else groups.get(transition.domain)
        kept_groups = 0 if domain is None else domain.depth + 1
        repeats = domain if transition.kind is TransitionKind.REPEAT else None
        return CompiledTransition(
            cause=_CAUSES[transition.kind],
            guards=compile_guards(transition.conditions),
            conditions=transition.conditions,
            target=None if transition.target is None else leaves.get(transition.target),
            kept_groups=kept_groups,
            kept_rounds=kept_groups if repeats is None else repeats.depth,
            domain=domain,
            completes=None if transition.completes is None else groups[transition.completes],
            repeats=repeats,
            always_possible=transition.kind is not TransitionKind.REPEAT
            and not transition.conditions,
        )

    for leaf in hfsm.leaves:
        node = leaves[leaf.id]
        node.transitions = tuple(map(compile_transition, leaf.transitions))
        node.failure = None if leaf.failure is None else compile_transition(leaf.failure)
        node.missed = None if leaf.missed is None else compile_transition(leaf.missed)
    for composite in hfsm.composites[1:]:
        group = groups[composite.id]
        group.transitions = tuple(map(compile_transition, composite.transitions))
        group.timeout = None if composite.timeout is None else compile_transition(composite.timeout)
    return Tables(
        initial=leaves.get(hfsm.mission.initial),
        leaves=leaves,
        groups=groups,
        reactions={
            state.reaction.event: ReactionNode(state, state.task) for state in hfsm.reactions
        },
        max_duration=hfsm.max_duration,
        has_hard_groups=any(group.has_hard_stop for group in groups.values()),
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
        has_hard_stop=composite.timeout is not None and bool(repeat and repeat.stop is Stop.HARD),
        every=repeat.every if repeat else 0.0,
        until=compile_guards(repeat.until) if repeat else (),
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
        is_timed=wait is not None or latest is not None,
        ended_visit=(task.name, None, False),
        is_return=leaf.id == RETURN,
    )


def _wait(rule: WaitRule) -> WaitNode:
    return WaitNode(
        rule.duration, rule.event, compile_guards(rule.conditions), rule.conditions, rule.limit
    )
