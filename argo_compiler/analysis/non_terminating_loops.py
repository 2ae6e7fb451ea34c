"""Loops that some readings keep going for ever, as no task in them measures the checkpoint."""

from collections.abc import Iterator, Sequence

from argo_compiler.analysis.reachability import (
    ReachabilitySearch,
    compared_objects,
    objects_that_others_may_report,
)
from argo_compiler.analysis.study import Study
from argo_compiler.analysis.value_regions import Scale
from argo_compiler.analysis.witness import KeptReading, Trap
from argo_compiler.base.records import dataclass

_MOST_STEPS = 50_000  # greatest number of steps of the search


@dataclass(frozen=True)
class NonTerminatingLoop:
    """Loop that never ends once it is entered with some readings of a checkpoint."""

    leaf: int
    """first leaf whose conditions compare the checkpoint"""
    nodes: frozenset[int]
    scale: Scale
    object_id: str
    """the checkpoint"""
    readings: int
    """set of readings that keep the loop going, as bits of `scale`"""

    @property
    def readings_keeping_loop(self) -> KeptReading:
        return KeptReading(self.object_id, self.scale.bounds, self.readings)


def find_loops_kept_by_readings(study: Study) -> Iterator[NonTerminatingLoop]:
    """Yield the loops that some readings of a checkpoint keep going for ever.

    They come in the order of the leaves that compare the checkpoint. A loop is left out if it
    contains another one that the same readings keep going, or if no reading leaves it (see
    `Study.trap_leaves`). Some loops are missing if the search takes too long.
    """
    trapped = {node for nodes in study.trap_nodes for node in nodes}
    search = _Search(study)
    loops: list[NonTerminatingLoop] = []
    for leaf, object_id in search.old_comparisons():
        if leaf in trapped:
            continue
        if search.steps_left < 0:
            break
        closed: dict[frozenset[int], int] = {}
        for reading in search.readings(leaf, object_id):
            nodes = search.closure(leaf, object_id, reading)
            if nodes is not None:
                closed[nodes] = closed.get(nodes, 0) | reading
        scale = study.nominal.fields.scales[object_id]
        loops += [
            NonTerminatingLoop(leaf, nodes, scale, object_id, r) for nodes, r in closed.items()
        ]
    for loop in loops:
        if not any(_is_within(other, loop) for other in loops if other is not loop):
            yield loop


def _is_within(inner: NonTerminatingLoop, outer: NonTerminatingLoop) -> bool:
    """Return True if `inner` lies within `outer` and all readings of `outer` keep it going too."""
    if inner.object_id != outer.object_id or outer.readings & ~inner.readings:
        return False
    smaller = inner.nodes < outer.nodes
    same = inner.nodes == outer.nodes
    wider = inner.readings != outer.readings or inner.leaf < outer.leaf
    return smaller or (same and wider)


def make_trap(study: Study, nodes: Sequence[int], kept: KeptReading | None = None) -> Trap:
    """Return the witness of a loop, given by `nodes` that no step leads out of.

    `kept` are the readings with which the loop is entered; None if it goes on with any readings.
    """
    flow = study.flow
    groups = len(flow.groups)
    beyond = [node - len(flow.leaves) for node in nodes if not flow.is_leaf(node)]
    return Trap(
        tasks=tuple(study.name(node) for node in nodes if flow.is_leaf(node)),
        rounds=tuple(flow.groups[g].name for g in beyond if g < groups),
        cuts=tuple(flow.groups[g - groups].name for g in beyond if g >= groups),
        kept=kept,
    )


class _Search:
    """Search for the nodes that follow a task while a checkpoint keeps its reading.

    `steps_left` decreases with each step; the search ends when it is negative.
    """

    def __init__(self, study: Study) -> None:
        self.study = study
        self.steps_left = _MOST_STEPS
        self.reported = objects_that_others_may_report(study.flow)
        self.search = ReachabilitySearch(study.flow, study.nominal.fields, failures=False)
        self.guard_nodes: dict[str, set[int]] = {}
        """for each checkpoint, the nodes whose conditions compare it"""
        for i, leaf in enumerate(study.flow.leaves):
            for conditions, _ in leaf.conditional:
                for condition in conditions:
                    self.guard_nodes.setdefault(condition.object_id, set()).add(i)
        for g, group in enumerate(study.flow.groups):
            for condition in group.until:
                self.guard_nodes.setdefault(condition.object_id, set()).add(
                    study.flow.round_end_node(g)
                )

    def old_comparisons(self) -> Iterator[tuple[int, str]]:
        """Yield each leaf with the id of a checkpoint that it compares but does not measure itself.

        Left out are leaves that can't be reached, and checkpoints that are not tracked or whose
        values others than the mission's tasks may report.
        """
        study = self.study
        for i, leaf in enumerate(study.flow.leaves):
            if not study.nominal.is_reached(i):
                continue
            objects: set[str] = set()
            for conditions, _ in leaf.conditional:
                objects |= compared_objects(conditions)
            for o in sorted(objects - self.reported - {leaf.measures}):
                if o in study.nominal.fields.shift:
                    yield i, o

    def readings(self, leaf: int, object_id: str) -> Iterator[int]:
        """Yield the possible readings of an object at a leaf, each as a mask with one bit set."""
        state = self.study.nominal.states[leaf]
        assert state is not None
        possible = self.study.nominal.fields.get(state, object_id)
        while possible:
            lowest = possible & -possible
            yield lowest
            possible ^= lowest

    def closure(self, leaf: int, object_id: str, reading: int) -> frozenset[int] | None:
        """Return a leaf and all nodes that can follow it while the checkpoint keeps the reading.

        `reading` is one bit. Returns None if some path leads to the mission's end or may change the
        reading, or if the search takes too long.
        """
        study, search = self.study, self.search
        flow, nominal = study.flow, study.nominal
        fields = nominal.fields
        guard_nodes = self.guard_nodes[object_id]
        seen = {leaf}
        pending = [leaf]
        while pending:
            node = pending.pop()
            self.steps_left -= 1
            state = nominal.states[node]
            if self.steps_left < 0 or state is None or node == flow.end_node:
                return None
            if flow.is_leaf(node) and flow.leaves[node].measures == object_id:
                return None
            if nominal.late[node] and fields.get(nominal.late[node], object_id):
                return None
            targets = study.successors[node]
            if node in guard_nodes:
                restricted = fields.set(state, object_id, reading)
                targets = tuple(target for target, _ in search.successors(node, restricted))
            for target in targets:
                if target not in seen:
                    seen.add(target)
                    pending.append(target)
        return frozenset(seen)
