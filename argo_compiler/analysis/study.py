"""Shared inputs of all diagnostics, computed once for a mission."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from argo_compiler.analysis.bounds import MissionBounds, compute_bounds, has_too_many_cancellations
from argo_compiler.analysis.flow import Flow
from argo_compiler.analysis.path_lengths import BoundsTooLargeError
from argo_compiler.analysis.reachability import Reachability
from argo_compiler.analysis.step_costs import StepCosts
from argo_compiler.analysis.travel import Travel
from argo_compiler.base.catalog import Catalog
from argo_compiler.base.graphs import can_reach, components, path_to, shortest_path_predecessors
from argo_compiler.diagnostics import Diagnostic, Severity, diagnostic_of
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.il import Afterwards, Mission, Response, Task

_MOST_NAMES = 6  # names of a path that a message lists


@dataclass(frozen=True)
class Study:
    """Mission with its control-flow graph, reachability, costs and bounds; immutable."""

    mission: Mission
    catalog: Catalog | None
    travel: Travel | None
    flow: Flow
    nominal: Reachability
    """reachability if every action succeeds and every measurement gives a value"""
    with_failures: Reachability
    """reachability if any action or measurement may fail"""

    @cached_property
    def position(self) -> dict[str, int]:
        """Index of each task in the mission's list."""
        return {task.name: i for i, task in enumerate(self.mission.tasks)}

    @cached_property
    def successors(self) -> tuple[tuple[int, ...], ...]:
        """Nodes that can follow each node if nothing fails."""
        return tuple(tuple(dict.fromkeys(self._successors_of(n))) for n in range(self.flow.size))

    @cached_property
    def trap_nodes(self) -> tuple[tuple[int, ...], ...]:
        """Nodes of each loop that can be reached and that only a failure leaves."""
        ends = can_reach(self.successors, [self.flow.end_node])
        traps = []
        for part in components(self.successors):
            if ends[part[0]] or not self.nominal.is_reached(part[0]):
                continue
            inside = set(part)
            if all(other in inside for node in part for other in self.successors[node]):
                traps.append(tuple(sorted(part)))
        return tuple(sorted(traps))

    @cached_property
    def predecessors(self) -> tuple[tuple[int, ...], ...]:
        """Nodes that can precede each node if nothing fails."""
        before: list[list[int]] = [[] for _ in range(self.flow.size)]
        for node, following in enumerate(self.successors):
            for other in following:
                before[other].append(node)
        return tuple(map(tuple, before))

    @cached_property
    def trap_leaves(self) -> tuple[tuple[int, ...], ...]:
        """Leaves of each loop in `trap_nodes`, in the same order."""
        return tuple(tuple(filter(self.flow.is_leaf, nodes)) for nodes in self.trap_nodes)

    @cached_property
    def costs(self) -> StepCosts:
        return StepCosts(self.flow, self.nominal, self.travel, self.mission)

    @cached_property
    def bounds_if_computable(self) -> MissionBounds | None:
        """Bounds on duration and energy; None if the mission is too large or too deeply nested."""
        if has_too_many_cancellations(self.flow):
            return None
        if self.costs.too_many:
            return None
        try:
            return compute_bounds(
                self.flow, self.nominal, self.costs, endless=bool(self.trap_leaves)
            )
        except BoundsTooLargeError:
            return None

    def name(self, leaf: int) -> str:
        return self.flow.leaves[leaf].name

    def object_text(self, object_id: str) -> str:
        """Return the text that messages use for a checkpoint."""
        if self.catalog is not None and object_id.isdecimal():
            info = self.catalog.checkpoint(int(object_id))
            if info is not None:
                return f"checkpoint {object_id} ({info.name})"
        return f"checkpoint '{object_id}'"

    def leaf_task(self, leaf: int) -> Task:
        return self.flow.leaves[leaf].leaf.task

    def is_mission_task(self, leaf: int) -> bool:
        """Return True if a leaf is a task of the mission, not one that the machine adds."""
        return self.name(leaf) in self.position

    def conditional_indices(self, leaf: int) -> list[int]:
        """Return the indices of the task's transitions that have conditions, in order."""
        return [k for k, t in enumerate(self.leaf_task(leaf).transitions) if t.conditions]

    @cached_property
    def may_end_by_reaction(self) -> bool:
        """True if the reaction to some event can end the mission."""
        return any(
            r.response is Response.ABORT
            or (r.response.drives and r.afterwards is Afterwards.END)
            or (r.hold_limit is not None and r.on_limit is Afterwards.END)
            for r in self.mission.reactions
        )

    def shortest_path_text(self, leaf: int) -> str:
        """Return the names of the tasks on a shortest execution path to a leaf if nothing fails.

        The text is empty if there is no such path.
        """
        path = path_to(self._path_tree, self.flow.initial, leaf)
        return "" if path is None else self.path_text(path)

    def path_text(self, path: tuple[int, ...]) -> str:
        """Return the tasks on a path of nodes as text, `A > (3 more) > B` if they are many."""
        leaves = [n for n in path if n < len(self.flow.leaves)]
        if len(leaves) <= _MOST_NAMES + 1:
            return " > ".join(map(self.name, leaves))
        half = _MOST_NAMES // 2
        shown = [*map(self.name, leaves[:half]), f"({len(leaves) - 2 * half} more)"]
        return " > ".join([*shown, *map(self.name, leaves[-half:])])

    @cached_property
    def _path_tree(self) -> list[int | None]:
        return shortest_path_predecessors(self.successors, self.flow.initial, lambda _a, _b: True)

    def _successors_of(self, node: int) -> Iterator[int]:
        flow = self.flow
        if not self.nominal.is_reached(node) or node == flow.end_node:
            return
        if flow.is_leaf(node):
            yield from self.nominal.targets(flow, node)
            yield from self.nominal.targets_when_missed(flow, node)
            parent = flow.leaves[node].parent
            if parent >= 0 and flow.timed[parent]:
                yield flow.time_up_node(parent)
            return
        ended = flow.group_of_round_end(node)
        if ended is not None:
            if flow.groups[ended].may_repeat:
                yield flow.groups[ended].start
            if flow.groups[ended].has_limit_or_until:
                yield flow.groups[ended].successor
            return
        group = flow.groups[node - len(flow.leaves) - len(flow.groups)]
        if group.hard:
            yield group.successor
        if group.parent >= 0 and flow.timed[group.parent]:
            yield flow.time_up_node(group.parent)

    def diagnostic(
        self,
        code: str,
        message: str,
        hint: str,
        leaf: int | None = None,
        transition: int | None = None,
        subject: str | None = None,
        severity: Severity | None = None,
    ) -> Diagnostic:
        """Return a diagnostic about a leaf's task, one of its transitions, or a `subject`.

        `transition` is an index into all of the task's transitions. For a leaf that the machine
        adds, only `subject` counts. Without a severity, the diagnostic has that of its code.
        """
        span = None
        if leaf is not None and self.is_mission_task(leaf):
            span = self.leaf_task(leaf).source
            subject = subject_of("tasks", self.name(leaf))
            if transition is not None:
                subject += f".transitions[{transition}]"
        return diagnostic_of(f"analysis.{code}", message, hint, subject, span, severity)
