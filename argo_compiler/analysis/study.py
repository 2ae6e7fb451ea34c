"""Shared inputs of all diagnostics, computed once for a mission."""

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from argo_compiler.analysis.bounds import MissionBounds, compute_bounds, has_too_many_cancellations
from argo_compiler.analysis.flow import Flow
from argo_compiler.analysis.path_lengths import BoundsTooLargeError
from argo_compiler.analysis.reachability import Reachability
from argo_compiler.analysis.step_costs import StepCosts
from argo_compiler.analysis.travel import Travel
from argo_compiler.base.catalog import Catalog
from argo_compiler.base.graphs import (
    can_reach,
    components,
    is_loop,
    path_to,
    reachable_from,
    shortest_path_predecessors,
)
from argo_compiler.base.listing import brief_quoted_list
from argo_compiler.base.message import Message
from argo_compiler.diagnostics import Diagnostic, Severity, diagnostic_of
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.il import Afterwards, EventKind, Mission, Response, Task

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
        return tuple(
            tuple(dict.fromkeys(self._successors_of(n, self.nominal)))
            for n in range(self.flow.size)
        )

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

    @cached_property
    def certain_failures(self) -> frozenset[int]:
        """Leaves that fail in each visit as planned, as they take longer than their time limit.

        After a failure the robot is somewhere on its way. A leaf that it may drive to from there is
        left out, unless its work alone takes too long, and so is one in a group whose time may be
        up before its limit.
        """
        possible = {
            leaf
            for leaf in self.costs.too_slow
            if not self.leaf_task(leaf).retries and not self._is_timed(leaf)
        }
        if not possible:
            return frozenset()
        return frozenset(
            possible - self._begin_elsewhere() | possible & self.costs.too_slow_anywhere
        )

    def _begin_elsewhere(self) -> set[int]:
        """Return the leaves that the robot may drive to from where no planned drive begins.

        So it is after the failure of a task with a time limit, and after tasks and transitions that
        only such a failure leads to.
        """
        flow = self.flow
        may_fail, known = set(self.costs.sometimes_too_slow), None
        while may_fail != known:
            known = frozenset(may_fail)
            found = self._reached_from_elsewhere(known)
            may_fail |= {i for i in found if flow.leaves[i].leaf.task.time_limit is not None}
        return found

    def _reached_from_elsewhere(self, may_fail: Collection[int]) -> set[int]:
        """Return the leaves of `_begin_elsewhere`, if the leaves `may_fail` may fail."""
        flow = self.flow
        pending = [(target, True) for leaf in may_fail for target in self._after_failure(leaf)]
        seen = set(pending)
        found: set[int] = set()
        while pending:
            node, elsewhere = pending.pop()
            moves = flow.is_leaf(node) and flow.leaves[node].wait is None
            if moves and elsewhere:
                found.add(node)
            stays_elsewhere = not self.nominal.is_reached(node) if moves else elsewhere
            for target in self._ways_on(node):
                step = (target, stays_elsewhere or target not in self.successors[node])
                if step not in seen:
                    seen.add(step)
                    pending.append(step)
        return found

    @cached_property
    def planned_successors(self) -> tuple[tuple[int, ...], ...]:
        """Nodes that can follow each node as planned: `certain_failures` do fail, nothing else."""
        if not self.certain_failures:
            return self.successors
        return tuple(
            tuple(
                dict.fromkeys(
                    self._after_failure(node)
                    if node in self.certain_failures
                    else self._ways_on(node)
                )
            )
            for node in range(self.flow.size)
        )

    @cached_property
    def reached_as_planned(self) -> Sequence[bool]:
        """For each node, whether `planned_successors` lead to it."""
        return reachable_from(self.planned_successors, [self.flow.initial])

    @cached_property
    def late_successors(self) -> tuple[tuple[int, ...], ...]:
        """Successors of each node as in `planned_successors`, when all hard windows have closed."""
        late = list(self.planned_successors)
        for i, leaf in enumerate(self.flow.leaves):
            if leaf.deadline is not None and self.with_failures.is_reached(i):
                up = [self.flow.time_up_node(leaf.parent)] if self._is_timed(i) else []
                late[i] = (*self.with_failures.targets_when_missed(self.flow, i), *up)
        return tuple(late)

    @cached_property
    def ends_by_time_up(self) -> bool:
        """True if a reaction ends the mission for certain when its maximum duration is over."""
        return self.mission.max_duration is not None and any(
            r.event is EventKind.TIME_UP
            and (
                r.response is Response.ABORT
                or (r.response.drives and r.until is None and r.afterwards is Afterwards.END)
            )
            for r in self.mission.reactions
        )

    def is_kept_as_planned(self, nodes: Collection[int]) -> bool:
        """Return True if the mission gets to a loop as planned, and no sure failure leaves it."""
        reached = any(self.reached_as_planned[node] for node in nodes)
        return reached and self.is_closed_as_planned(nodes)

    def is_closed_as_planned(self, nodes: Collection[int]) -> bool:
        """Return True if the failure of no task in `certain_failures` leads out of the nodes."""
        return all(
            target in nodes
            for node in self.certain_failures.intersection(nodes)
            for target in self.planned_successors[node]
        )

    def repeats_as_planned(self, nodes: Collection[int]) -> bool:
        """Return True if the nodes can be repeated although `certain_failures` fail."""
        return not self.certain_failures or self._has_cycle(nodes, self.planned_successors)

    def repeats_when_late(self, nodes: Collection[int]) -> bool:
        """Return True if the nodes can be repeated when all hard windows have closed."""
        windowed = any(map(self._is_windowed, nodes))
        return not windowed or self._has_cycle(nodes, self.late_successors)

    @cached_property
    def leaves_until_window(self) -> frozenset[int]:
        """Leaves with a hard window whose closing ends a loop that nothing else limits."""
        bounds = self.bounds_if_computable
        loops = () if bounds is None else bounds.loops
        found: set[int] = set()
        for loop in loops:
            nodes = self.nodes_within(loop.leaves, loop.groups)
            if self.repeats_as_planned(nodes) and not self.repeats_when_late(nodes):
                found |= {n for n in nodes if self._is_windowed(n)}
        return frozenset(found)

    @cached_property
    def all_loops_end(self) -> bool:
        """True if each loop of the bounds ends, at the latest when its hard windows close."""
        bounds = self.bounds_if_computable
        return (
            bounds is not None
            and bool(bounds.loops)
            and not self.trap_leaves
            and not any(
                self.repeats_when_late(self.nodes_within(loop.leaves, loop.groups))
                for loop in bounds.loops
            )
        )

    def _has_cycle(self, nodes: Collection[int], successors: Sequence[Sequence[int]]) -> bool:
        """Return True if the successors lead from some of the nodes back to it within them.

        They may lead over the ends of any groups.
        """
        ends = range(len(self.flow.leaves), self.flow.end_node)
        number = {node: k for k, node in enumerate({*nodes, *ends})}
        within = [[number[x] for x in successors[node] if x in number] for node in number]
        return any(is_loop(part, within) for part in components(within))

    def _is_windowed(self, node: int) -> bool:
        return self.flow.is_leaf(node) and self.flow.leaves[node].deadline is not None

    def nodes_within(self, leaves: Iterable[int], groups: Iterable[int]) -> frozenset[int]:
        """Return the nodes of leaves, and of groups with all that lies in them."""
        nodes = set(leaves)
        for number in groups:
            group = self.flow.groups[number]
            nodes.update(range(group.first, group.last + 1))
            nodes |= {self.flow.round_end_node(number), self.flow.time_up_node(number)}
            for leaf in range(group.first, group.last + 1):
                inner = self.flow.leaves[leaf].parent
                while inner != number and self.flow.round_end_node(inner) not in nodes:
                    nodes |= {self.flow.round_end_node(inner), self.flow.time_up_node(inner)}
                    inner = self.flow.groups[inner].parent
        return frozenset(nodes)

    def leads_out_if_failing(self, nodes: Collection[int]) -> bool:
        """Return True if the failure of some action leads out of the nodes."""
        return any(
            target not in nodes
            for node in nodes
            if self.flow.is_leaf(node) and self.flow.leaves[node].wait is None
            for target in self._after_failure(node)
        )

    def _is_timed(self, leaf: int) -> bool:
        parent = self.flow.leaves[leaf].parent
        return parent >= 0 and self.flow.timed[parent]

    def _after_failure(self, leaf: int) -> Iterator[int]:
        """Yield the nodes that can follow the failure of a leaf, or its missed window."""
        flow = self.flow
        here = flow.leaves[leaf]
        if here.failure is not None:
            yield here.failure
        else:
            yield from self.with_failures.targets(flow, leaf)
        yield from self.with_failures.targets_when_missed(flow, leaf)
        if self._is_timed(leaf):
            yield flow.time_up_node(here.parent)

    def _ways_on(self, node: int) -> Iterator[int]:
        """Yield the nodes that can follow a node whose action succeeds, whatever failed before."""
        flow, reach = self.flow, self.with_failures
        if not flow.is_leaf(node):
            yield from self._successors_of(node, reach)
        elif reach.is_reached(node):
            yield from replace(reach, failures=False).targets(flow, node)
            yield from reach.targets_when_missed(flow, node)
            if self._is_timed(node):
                yield flow.time_up_node(flow.leaves[node].parent)

    def name(self, leaf: int) -> str:
        return self.flow.leaves[leaf].name

    def tasks_text(self, leaves: Sequence[int]) -> str:
        """Return the names of leaves as text, such as `tasks 'A' and 'B'`."""
        names = brief_quoted_list([self.name(leaf) for leaf in leaves])
        if len(leaves) > 1:
            return Message("tasks {names}", names=names)
        return Message("task {names}", names=names)

    def object_text(self, object_id: str) -> str:
        """Return the text that messages use for a checkpoint."""
        if self.catalog is not None and object_id.isdecimal():
            info = self.catalog.checkpoint(int(object_id))
            if info is not None:
                return Message(
                    "checkpoint {object_id} ({info})", object_id=object_id, info=info.name
                )
        return Message("checkpoint '{object_id}'", object_id=object_id)

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
            return Message("{path:>}", path=tuple(map(self.name, leaves)))
        half = _MOST_NAMES // 2
        shown = [
            *map(self.name, leaves[:half]),
            Message("({count} more)", count=len(leaves) - 2 * half),
        ]
        return Message("{path:>}", path=(*shown, *map(self.name, leaves[-half:])))

    @cached_property
    def _path_tree(self) -> list[int | None]:
        return shortest_path_predecessors(self.successors, self.flow.initial, lambda _a, _b: True)

    def _successors_of(self, node: int, reach: Reachability) -> Iterator[int]:
        flow = self.flow
        if not reach.is_reached(node) or node == flow.end_node:
            return
        if flow.is_leaf(node):
            yield from reach.targets(flow, node)
            yield from reach.targets_when_missed(flow, node)
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
