"""Graph of the transitions between the tasks and groups of a mission, and of a group's round.

A leaf is a state of the mission's state machine that executes one task; leaves are named by their
numbers in the flow (see `argo_compiler.analysis.flow`).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from argo_compiler.analysis.flow import NOWHERE, Flow
from argo_compiler.base.errors import Invalid, Remedy
from argo_compiler.base.graphs import can_reach, reachable_from
from argo_compiler.base.message import Message
from argo_compiler.hfsm.lowering import lower
from argo_compiler.il import Action, Condition, Mission


@dataclass(frozen=True)
class Edge:
    """Transition from one child of a level to another child or to the end of the level."""

    source: int
    target: int
    leaf: int
    """leaf that the transition starts from"""
    entry: int | None
    """leaf that it leads to; None for the end of the level"""
    tail: bool
    """whether it is the leaf's unconditional transition"""
    early: bool = False
    """whether it may end the mission early"""


@dataclass
class Level:
    """Tasks and groups of a mission or of a group's round, with their transitions. Mutable."""

    children: list[int]
    """leaves by number, and groups as -1 - number"""
    child_of: dict[int, int]
    """position in `children` of each leaf, or of the group that contains it"""
    edges: list[Edge] = field(default_factory=list)
    chain_error: str | None = None
    """why the level is not a chain of units; None if it is one"""

    @property
    def sink(self) -> int:
        """Node of the end of the level."""
        return len(self.children)

    def successors(self, edges: Sequence[Edge]) -> list[list[int]]:
        """Return the positions that these edges lead to, for each child and for the sink."""
        following: list[list[int]] = [[] for _ in range(len(self.children) + 1)]
        for edge in edges:
            following[edge.source].append(edge.target)
        return following


class TaskGraph:
    """Levels of a mission. Mutable: collects detached leaves and early exits of the mission."""

    def __init__(self, mission: Mission) -> None:
        """Lower the mission. Raises DiagnosticError if `check` finds errors in it."""
        self.flow = flow = Flow.from_machine(lower(mission), mission)
        names = {task.name for task in mission.tasks}
        # `lower` may add a return to the dock, which is reached only after failures.
        self.own_leaves = [i for i, leaf in enumerate(flow.leaves) if leaf.name in names]
        self._own_leaf_set = frozenset(self.own_leaves)
        self.end = self._find_end(mission)
        """leaf that always ends the mission, the drive into the docking station; None if none"""
        self.detached: set[int] = set()
        """leaves that lead only to an early end of the mission"""
        self.early_exits: set[tuple[int, int]] = set()
        """transitions that end the mission early: a leaf and the node that it leads to"""

    def _find_end(self, mission: Mission) -> int | None:
        """Return the leaf of the drive into the docking station that ends the mission, if any."""
        for i in reversed(self.own_leaves):
            leaf = self.flow.leaves[i]
            task = leaf.leaf.task
            docks = task.action is Action.WAYPOINT and task.pose == mission.dock
            branches = leaf.conditional or self.leaves_after_failure_or_miss(i)
            if docks and leaf.parent == NOWHERE and not branches:
                return i if leaf.unconditional == self.flow.end_node else None
        return None

    def leaves_after_failure_or_miss(self, leaf: int) -> tuple[int, ...]:
        """Return the leaves that the task names for a final failure and for a missed window."""
        flow = self.flow.leaves[leaf]
        return tuple(
            k for k in (flow.failure, flow.missed) if k is not None and k in self._own_leaf_set
        )

    def is_wait(self, leaf: int) -> bool:
        """Return True if the task is a WAIT, for which the robot stays where it is."""
        return self.flow.leaves[leaf].leaf.task.action is Action.WAIT

    def conditions_checked_after(self, leaf: int) -> Iterator[Condition]:
        """Yield the conditions that are checked when a task ends.

        They choose the next task, end a WAIT, or end the rounds of a group.
        """
        flow = self.flow
        for conditions, _ in flow.leaves[leaf].conditional:
            yield from conditions
        if wait := flow.leaves[leaf].leaf.task.wait:
            yield from wait.conditions
        for group in flow.groups:
            if group.last == leaf:
                yield from group.until

    def require_reachable(self) -> None:
        """Raise ArgoError if a task or the end of the mission can't be reached."""
        flow = self.flow
        following: list[list[int]] = [[] for _ in range(flow.size)]
        for i, leaf in enumerate(flow.leaves):
            following[i] = [target for _, target in leaf.conditional] + [leaf.unconditional]
            following[i] += self.leaves_after_failure_or_miss(i) if i in self._own_leaf_set else ()
            if leaf.parent >= 0:
                following[i].append(flow.time_up_node(leaf.parent))
        for g, group in enumerate(flow.groups):
            following[flow.round_end_node(g)].append(group.start)
            if group.has_limit_or_until:
                following[flow.round_end_node(g)].append(group.successor)
            if group.hard:
                following[flow.time_up_node(g)].append(group.successor)
            if group.parent >= 0:
                following[flow.time_up_node(g)].append(flow.time_up_node(group.parent))
        reached = reachable_from(following, [flow.initial])
        for i in self.own_leaves:
            if not reached[i]:
                raise Invalid(
                    Message(
                        "no execution path leads to task '{leave}', so it can't be part of an "
                        "order: remove it, or add a transition to it; a check gives details",
                        leave=flow.leaves[i].name,
                    ),
                    remedies=(Remedy.CHECK_MISSION,),
                )
        if not reached[flow.end_node]:
            raise Invalid(
                "nothing leads to the end of this mission: a check states why",
                remedies=(Remedy.CHECK_MISSION,),
            )

    def level(self, group: int) -> Level:
        """Return the graph of the mission (NOWHERE) or of a group's round."""
        flow = self.flow
        children: list[int] = []
        child_of: dict[int, int] = {}
        for i in self.own_leaves:
            child: int | None = i
            at = flow.leaves[i].parent
            while at not in (group, NOWHERE):
                child, at = -1 - at, flow.groups[at].parent
            if at != group:
                continue
            assert child is not None
            if not children or children[-1] != child:
                children.append(child)
            child_of[i] = len(children) - 1
        level = Level(children, child_of)
        for leaf in child_of:
            if leaf != self.end:
                self._add_edges(level, group, leaf)
        for inner, within in enumerate(flow.groups):
            # Outer groups have smaller numbers than their inner groups.
            if inner > group and within.has_limit_or_until and within.last in child_of:
                direct = inner if within.parent == group else None
                number = child_of[within.last]
                self._add_edge(level, group, number, within.last, within.successor, True, direct)
        level.edges = self._without_early_ends(level)
        leads_to_end = can_reach(level.successors(level.edges), [level.sink])
        if group != NOWHERE and not all(leads_to_end):
            stuck = children[leads_to_end.index(False)]
            level.chain_error = Message(
                "'{task}' does not lead to the end of a round", task=self.name(stuck)
            )
        return level

    def name(self, child: int) -> str:
        return self.flow.leaves[child].name if child >= 0 else self.flow.groups[-1 - child].name

    def _add_edges(self, level: Level, group: int, leaf: int) -> None:
        flow = self.flow
        number = level.child_of[leaf]
        for _, target in flow.leaves[leaf].conditional:
            self._add_edge(level, group, number, leaf, target, False, None)
        for target in self.leaves_after_failure_or_miss(leaf):
            self._add_edge(level, group, number, leaf, target, False, None)
        tail = flow.leaves[leaf].unconditional
        ended_group = flow.group_of_round_end(tail)
        if ended_group is None or ended_group == group:
            self._add_edge(level, group, number, leaf, tail, True, None)

    def _add_edge(
        self,
        level: Level,
        group: int,
        number: int,
        leaf: int,
        target: int,
        tail: bool,
        through: int | None,
    ) -> None:
        """Add the edge from a leaf of a child to a node, or an early exit, or set `chain_error`.

        `number` is the child's position in the level. `tail` states that the transition is the
        leaf's unconditional one. `through` is the group whose end the transition passes, if any. A
        chain error is stored in the level, not raised.
        """
        flow = self.flow
        if target in level.child_of and target != self.end:
            target_child = level.child_of[target]
            inside = target_child == number and level.children[number] < 0 and through is None
            if not inside:
                level.edges.append(Edge(number, target_child, leaf, target, tail))
        elif target == self.end:
            if group == NOWHERE:
                level.edges.append(Edge(number, level.sink, leaf, None, tail, not tail))
            elif tail:
                level.chain_error = Message("'{leave}' leaves it", leave=flow.leaves[leaf].name)
            else:
                self.early_exits.add((leaf, target))
        elif target == flow.end_node:
            branches = bool(
                flow.leaves[leaf].conditional or self.leaves_after_failure_or_miss(leaf)
            )
            if group == NOWHERE and self.end is None:
                level.edges.append(Edge(number, level.sink, leaf, None, tail, branches))
            else:
                self.early_exits.add((leaf, target))
        elif group != NOWHERE and target == flow.round_end_node(group):
            level.edges.append(Edge(number, level.sink, leaf, None, tail))
        elif flow.group_of_round_end(target) is not None:
            pass  # the end of an outer group, whose own transition is added for that group
        elif target in self.detached:
            self.early_exits.add((leaf, target))
        else:
            level.chain_error = Message("'{leave}' leaves it", leave=flow.leaves[leaf].name)

    def _without_early_ends(self, level: Level) -> list[Edge]:
        """Return a level's edges without those that only end the mission early.

        An edge remains if its child does not reach the usual end otherwise. The others are recorded
        in `early_exits`.
        """
        usual = [edge for edge in level.edges if not edge.early]
        leads_to_end = can_reach(level.successors(usual), [level.sink])
        remaining = []
        for edge in level.edges:
            if edge.early and leads_to_end[edge.source]:
                self.early_exits.add(
                    (edge.leaf, self.flow.end_node if self.end is None else self.end)
                )
            else:
                remaining.append(edge)
        return remaining

    def detach_early_end_tasks(self, level: Level) -> None:
        """Remove from the mission's level the children that do not lead to its usual end.

        Transitions to them become early exits.
        """
        leads_to_end = can_reach(level.successors(level.edges), [level.sink])
        last = None if self.end is None else level.child_of[self.end]
        out = {k for k in range(len(level.children)) if not leads_to_end[k] and k != last}
        self.detached = {leaf for leaf, k in level.child_of.items() if k in out}
        self.early_exits = {
            (leaf, node) for leaf, node in self.early_exits if leaf not in self.detached
        }
        for edge in level.edges:
            if edge.target in out and edge.source not in out and edge.entry is not None:
                self.early_exits.add((edge.leaf, edge.entry))
        if level.child_of[self.flow.initial] in out:
            level.chain_error = Message("it does not always reach its docking station")
        for leaf in self.detached:
            if any(
                condition.max_age is not None for condition in self.conditions_checked_after(leaf)
            ):
                name = self.flow.leaves[leaf].name
                level.chain_error = Message(
                    "'{name}', with which it may end early, checks the age of a value", name=name
                )
        level.edges = [e for e in level.edges if e.source not in out and e.target not in out]
