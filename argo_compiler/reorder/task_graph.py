"""The ways between the tasks and groups of a mission, and of one round of a group."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from argo_compiler.analysis.flow import NOWHERE, Flow
from argo_compiler.base.errors import Invalid, Remedy
from argo_compiler.base.graphs import leading_to, reached_from
from argo_compiler.hfsm.lowering import lower
from argo_compiler.il import Action, Condition, Mission


@dataclass(frozen=True)
class Edge:
    """From one child of a level to another, or to its end."""

    source: int
    target: int
    leaf: int
    """that the way leads from"""
    entry: int | None
    """the leaf that it leads to; None: the end of the level"""
    tail: bool
    """whether it is the leaf's unconditional transition"""
    early: bool = False
    """whether it may be one that ends the mission early"""


@dataclass
class Level:
    """The mission, or one round of a group: its tasks and groups, and the ways between them."""

    children: list[int]
    """leaves, and groups as -1 - number"""
    child_of: dict[int, int]
    edges: list[Edge] = field(default_factory=list)
    broken: str | None = None
    """why it is no chain of units"""

    @property
    def sink(self) -> int:
        return len(self.children)

    def successors(self, edges: Sequence[Edge]) -> list[list[int]]:
        following: list[list[int]] = [[] for _ in range(len(self.children) + 1)]
        for edge in edges:
            following[edge.source].append(edge.target)
        return following


class TaskGraph:
    """The levels of a mission. Collects what lies apart, and where the mission may end early."""

    def __init__(self, mission: Mission) -> None:
        """Raises DiagnosticError if `check` finds errors in the mission."""
        self.flow = flow = Flow.of(lower(mission), mission)
        names = {task.name for task in mission.tasks}
        # `lower` may add the return to the dock, to which only failures lead.
        self.own = [i for i, leaf in enumerate(flow.leaves) if leaf.name in names]
        self._own = frozenset(self.own)
        self.end = self._find_end(mission)
        """the leaf that the mission always ends with: the way into the docking station"""
        self.apart: set[int] = set()
        """leaves from which the mission ends without the rest"""
        self.gates: set[tuple[int, int]] = set()
        """leaves after which the mission may end early, and the nodes that they lead to then"""

    def _find_end(self, mission: Mission) -> int | None:
        """The drive into the mission's docking station that ends it."""
        for i in reversed(self.own):
            leaf = self.flow.leaves[i]
            task = leaf.leaf.task
            docks = task.action is Action.WAYPOINT and task.pose == mission.dock
            branches = leaf.conditional or self.troubled(i)
            if docks and leaf.parent == NOWHERE and not branches:
                return i if leaf.tail == self.flow.done else None
        return None

    def troubled(self, leaf: int) -> tuple[int, ...]:
        """The leaves that follow where a task fails for good or misses its window, as it says."""
        found = self.flow.leaves[leaf]
        return tuple(k for k in (found.failure, found.missed) if k is not None and k in self._own)

    def stands(self, leaf: int) -> bool:
        """Whether the robot stands there where the task before has left it."""
        return self.flow.leaves[leaf].leaf.task.action is Action.WAIT

    def asked(self, leaf: int) -> Iterator[Condition]:
        """What is looked at when a task ends: to go on, to wait on, and to begin another round."""
        flow = self.flow
        for conditions, _ in flow.leaves[leaf].conditional:
            yield from conditions
        if wait := flow.leaves[leaf].leaf.task.wait:
            yield from wait.conditions
        for group in flow.groups:
            if group.last == leaf:
                yield from group.until

    def require_reachable(self) -> None:
        """Raises ArgoError if a task can't be reached, or the end of the mission."""
        flow = self.flow
        following: list[list[int]] = [[] for _ in range(flow.size)]
        for i, leaf in enumerate(flow.leaves):
            following[i] = [target for _, target in leaf.conditional] + [leaf.tail]
            following[i] += self.troubled(i) if i in self._own else ()
            if leaf.parent >= 0:
                following[i].append(flow.time_up(leaf.parent))
        for g, group in enumerate(flow.groups):
            following[flow.round_end(g)].append(group.start)
            if group.may_end:
                following[flow.round_end(g)].append(group.onward)
            if group.hard:
                following[flow.time_up(g)].append(group.onward)
            if group.parent >= 0:
                following[flow.time_up(g)].append(flow.time_up(group.parent))
        reached = reached_from(following, [flow.initial])
        for i in self.own:
            if not reached[i]:
                raise Invalid(
                    f"no way leads to task '{flow.leaves[i].name}', so there is no place for it in "
                    "an order: remove it, or lead a transition to it; a check says more",
                    remedies=(Remedy.CHECK_MISSION,),
                )
        if not reached[flow.done]:
            raise Invalid(
                "nothing leads to the end of this mission: a check says why",
                remedies=(Remedy.CHECK_MISSION,),
            )

    def level(self, group: int) -> Level:
        """The graph of the mission (NOWHERE) or of a round of a group."""
        flow = self.flow
        children: list[int] = []
        child_of: dict[int, int] = {}
        for i in self.own:
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
            # Groups come before those that lie in them.
            if inner > group and within.may_end and within.last in child_of:
                direct = inner if within.parent == group else None
                number = child_of[within.last]
                self._add_edge(level, group, number, within.last, within.onward, True, direct)
        level.edges = self._without_early_ends(level)
        ends = leading_to(level.successors(level.edges), [level.sink])
        if group != NOWHERE and not all(ends):
            stuck = children[ends.index(False)]
            level.broken = f"'{self.name(stuck)}' does not lead to the end of a round"
        return level

    def name(self, child: int) -> str:
        return self.flow.leaves[child].name if child >= 0 else self.flow.groups[-1 - child].name

    def _add_edges(self, level: Level, group: int, leaf: int) -> None:
        flow = self.flow
        number = level.child_of[leaf]
        for _, target in flow.leaves[leaf].conditional:
            self._add_edge(level, group, number, leaf, target, False, None)
        for target in self.troubled(leaf):
            self._add_edge(level, group, number, leaf, target, False, None)
        tail = flow.leaves[leaf].tail
        ended = flow.group_of_round_end(tail)
        if ended is None or ended == group:
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
        """A way from a leaf of a child to a node; `through`: by the end of that group."""
        flow = self.flow
        if target in level.child_of and target != self.end:
            there = level.child_of[target]
            inside = there == number and level.children[number] < 0 and through is None
            if not inside:
                level.edges.append(Edge(number, there, leaf, target, tail))
        elif target == self.end:
            if group == NOWHERE:
                level.edges.append(Edge(number, level.sink, leaf, None, tail, not tail))
            elif tail:
                level.broken = f"'{flow.leaves[leaf].name}' leaves it"
            else:
                self.gates.add((leaf, target))
        elif target == flow.done:
            branches = bool(flow.leaves[leaf].conditional or self.troubled(leaf))
            if group == NOWHERE and self.end is None:
                level.edges.append(Edge(number, level.sink, leaf, None, tail, branches))
            else:
                self.gates.add((leaf, target))
        elif group != NOWHERE and target == flow.round_end(group):
            level.edges.append(Edge(number, level.sink, leaf, None, tail))
        elif flow.group_of_round_end(target) is not None:
            pass  # that of a group around, which has its own way on
        elif target in self.apart:
            self.gates.add((leaf, target))
        else:
            level.broken = f"'{flow.leaves[leaf].name}' leaves it"

    def _without_early_ends(self, level: Level) -> list[Edge]:
        """The edges without those that only end the mission early, if it goes on else."""
        lasting = [edge for edge in level.edges if not edge.early]
        goes_on = leading_to(level.successors(lasting), [level.sink])
        kept = []
        for edge in level.edges:
            if edge.early and goes_on[edge.source]:
                self.gates.add((edge.leaf, self.flow.done if self.end is None else self.end))
            else:
                kept.append(edge)
        return kept

    def set_apart(self, level: Level) -> None:
        """Takes out of the mission's level what does not lead to its usual end."""
        ends = leading_to(level.successors(level.edges), [level.sink])
        last = None if self.end is None else level.child_of[self.end]
        out = {k for k in range(len(level.children)) if not ends[k] and k != last}
        self.apart = {leaf for leaf, k in level.child_of.items() if k in out}
        self.gates = {(leaf, node) for leaf, node in self.gates if leaf not in self.apart}
        for edge in level.edges:
            if edge.target in out and edge.source not in out and edge.entry is not None:
                self.gates.add((edge.leaf, edge.entry))
        if level.child_of[self.flow.initial] in out:
            level.broken = "it does not always come to its docking station"
        for leaf in self.apart:
            if any(condition.max_age is not None for condition in self.asked(leaf)):
                name = self.flow.leaves[leaf].name
                level.broken = f"'{name}', with which it may end early, asks how old a value is"
        level.edges = [e for e in level.edges if e.source not in out and e.target not in out]
