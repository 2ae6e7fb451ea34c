"""Control-flow graph of a state machine: which node can follow which.

Nodes are numbers. A leaf is a state that executes one task; its number is its index among the
machine's leaves. Each group has two nodes: the end of a round, where the group decides about
another one, and the moment when its time is up, whatever was under way. The last node is the end of
the mission.
"""

from dataclasses import field
from functools import cached_property

from argo_compiler.base.records import dataclass
from argo_compiler.hfsm.model import MISSION, Hfsm, Leaf, StateTransition
from argo_compiler.il import Action, Condition, Mission, Stop, WaitRule

NOWHERE = -1
"""parent of the leaves and groups that lie directly in the mission"""


@dataclass(frozen=True, slots=True)
class GroupFlow:
    """Group of a control-flow graph, and what can follow at the end of a round."""

    name: str
    parent: int
    """number of the enclosing group, or NOWHERE"""
    first: int
    last: int
    """last leaf; the group's leaves are `first` to `last`"""
    start: int
    """first leaf of a round"""
    successor: int
    """node after the last round"""
    count: int
    """greatest number of rounds; 0 if unlimited"""
    duration: float
    """time limit in s; 0 if unlimited"""
    hard: bool
    """whether the time limit also ends the round that is under way"""
    every: float = 0.0
    """s from the start of one round to the start of the next; 0 if it follows at once"""
    until: tuple[Condition, ...] = ()
    """the rounds end once all of these conditions hold at the end of a round"""

    @property
    def may_repeat(self) -> bool:
        return self.count != 1

    @property
    def has_round_or_time_limit(self) -> bool:
        """True if a count or a time limit ends the group, whatever is measured."""
        return self.count > 0 or self.duration > 0

    @property
    def has_limit_or_until(self) -> bool:
        return self.has_round_or_time_limit or bool(self.until)

    def contains(self, leaf: int) -> bool:
        return self.first <= leaf <= self.last


@dataclass(frozen=True, slots=True)
class LeafFlow:
    """Leaf of a control-flow graph, with its successors in the order in which they are tried."""

    leaf: Leaf
    parent: int
    conditional: tuple[tuple[tuple[Condition, ...], int], ...]
    """conditions and target node of each conditional transition"""
    unconditional: int
    """node that follows if no condition holds"""
    failure: int | None
    """node after a final failure; None if a failure is treated like any other end"""
    measures: str | None
    """id of the object whose value the action measures; None if it measures nothing"""
    missed: int | None
    """node after a missed window; None if that is treated like a final failure"""
    wait: WaitRule | None
    """rule of a WAIT task, which runs no action; None for other tasks"""
    earliest: float
    """s since the mission's start; the action does not start before, even if the robot is there"""
    deadline: float | None
    """s since the mission's start, at which an unfinished task fails; None if there is none"""

    @property
    def name(self) -> str:
        return self.leaf.task.name

    @property
    def has_wait_limit(self) -> bool:
        """True if this is a WAIT that fails unless something ends it in time."""
        return self.wait is not None and self.wait.limit is not None


@dataclass(frozen=True)
class Flow:
    """Control-flow graph: all leaves and groups, each group before the groups that lie in it."""

    leaves: tuple[LeafFlow, ...]
    groups: tuple[GroupFlow, ...]
    initial: int
    depth: tuple[int, ...] = field(default=())
    """for each group, the number of groups that enclose it"""
    timed: tuple[bool, ...] = field(default=())
    """for each group, whether it or an enclosing group has a hard time limit"""

    @cached_property
    def end_node(self) -> int:
        return len(self.leaves) + 2 * len(self.groups)

    @property
    def size(self) -> int:
        return self.end_node + 1

    def round_end_node(self, group: int) -> int:
        """Return the number of the node at which a round of the group has ended."""
        return len(self.leaves) + group

    def time_up_node(self, group: int) -> int:
        """Return the node for the moment when the time of the group, or of one around it, is up."""
        return len(self.leaves) + len(self.groups) + group

    def is_leaf(self, node: int) -> bool:
        return node < len(self.leaves)

    def group_of_round_end(self, node: int) -> int | None:
        at = node - len(self.leaves)
        return at if 0 <= at < len(self.groups) else None

    @classmethod
    def from_machine(cls, hfsm: Hfsm, mission: Mission) -> "Flow":
        """Return the control-flow graph of a machine, computed in linear time."""
        return _Builder(hfsm, mission).flow()


class _Builder:
    def __init__(self, hfsm: Hfsm, mission: Mission) -> None:
        self.hfsm = hfsm
        self.mission = mission
        self.number = {leaf.id: i for i, leaf in enumerate(hfsm.leaves)}
        self.groups = {c.id: i for i, c in enumerate(hfsm.composites[1:])}
        self.groups[MISSION] = NOWHERE
        self.end_node = len(hfsm.leaves) + 2 * len(hfsm.composites[1:])

    def flow(self) -> Flow:
        groups = self._group_flows()
        depth: list[int] = []
        timed: list[bool] = []
        for group in groups:
            around = group.parent
            depth.append(depth[around] + 1 if around >= 0 else 0)
            timed.append(group.hard or (around >= 0 and timed[around]))
        return Flow(
            leaves=tuple(self._leaf_flow(leaf) for leaf in self.hfsm.leaves),
            groups=groups,
            initial=self.number.get(self.hfsm.mission.initial, self.end_node),
            depth=tuple(depth),
            timed=tuple(timed),
        )

    def _node(self, transition: StateTransition) -> int:
        if transition.completes is not None:
            return len(self.hfsm.leaves) + self.groups[transition.completes]
        return self.number.get(transition.target or "", self.end_node)

    def _leaf_flow(self, leaf: Leaf) -> LeafFlow:
        *conditional, last = leaf.transitions
        task, window = leaf.task, leaf.task.window
        return LeafFlow(
            leaf=leaf,
            parent=self.groups[leaf.parent],
            conditional=tuple((t.conditions, self._node(t)) for t in conditional),
            unconditional=self._node(last),
            failure=None if leaf.failure is None else self._node(leaf.failure),
            measures=task.object_id if task.action is Action.MEASURE else None,
            missed=None if leaf.missed is None else self._node(leaf.missed),
            wait=task.wait if task.action is Action.WAIT else None,
            earliest=0.0 if window is None else window.earliest,
            deadline=window.latest if window is not None and window.hard else None,
        )

    def _group_flows(self) -> tuple[GroupFlow, ...]:
        composites = self.hfsm.composites[1:]
        first = [len(self.hfsm.leaves)] * len(composites)
        last = [-1] * len(composites)
        for i, leaf in enumerate(self.hfsm.leaves):
            at = self.groups[leaf.parent]
            if at >= 0:
                first[at], last[at] = min(first[at], i), max(last[at], i)
        for at in reversed(range(len(composites))):
            around = self.groups[composites[at].parent or MISSION]
            if around >= 0:
                first[around] = min(first[around], first[at])
                last[around] = max(last[around], last[at])
        flows = []
        for at, composite in enumerate(composites):
            repeat = composite.repeat
            assert repeat is not None
            successor = composite.transitions[-1]
            flows.append(
                GroupFlow(
                    name=composite.name,
                    parent=self.groups[composite.parent or MISSION],
                    first=first[at],
                    last=last[at],
                    start=self.number[composite.initial],
                    successor=self._node(successor),
                    count=repeat.count,
                    duration=repeat.duration,
                    hard=repeat.duration > 0 and repeat.stop is Stop.HARD,
                    every=repeat.every,
                    until=repeat.until,
                )
            )
        return tuple(flows)
