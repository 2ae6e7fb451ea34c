"""Loops that only another reading would end, and in which nothing measures: they keep it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from argo_compiler.analysis.regions import Scale
from argo_compiler.analysis.study import Study
from argo_compiler.analysis.values import PathSearch, objects_of, told_by_others
from argo_compiler.analysis.witness import KeptReading, Trap

_WORK = 50_000  # steps that are looked at


@dataclass(frozen=True)
class KeptLoop:
    """A loop that goes on for ever once it is entered with some readings."""

    leaf: int
    """the first one that looks at the checkpoint"""
    nodes: frozenset[int]
    scale: Scale
    object_id: str
    readings: int

    @property
    def reading(self) -> KeptReading:
        return KeptReading(self.object_id, self.scale.bounds, self.readings)


def kept_loops(study: Study) -> Iterator[KeptLoop]:
    """The loops that some readings keep, in the order of their tasks, the shortest ones."""
    trapped = {node for nodes in study.trap_nodes for node in nodes}
    search = _Search(study)
    found: list[KeptLoop] = []
    for leaf, object_id in search.places():
        if leaf in trapped:
            continue
        if search.work < 0:
            break
        closed: dict[frozenset[int], int] = {}
        for reading in search.readings(leaf, object_id):
            nodes = search.kept(leaf, object_id, reading)
            if nodes is not None:
                closed[nodes] = closed.get(nodes, 0) | reading
        scale = study.nominal.fields.scales[object_id]
        found += [KeptLoop(leaf, nodes, scale, object_id, r) for nodes, r in closed.items()]
    for one in found:
        if not any(_within(other, one) for other in found if other is not one):
            yield one


def _within(inner: KeptLoop, outer: KeptLoop) -> bool:
    """Whether a loop lies within another one that is kept by no other reading."""
    if inner.object_id != outer.object_id or outer.readings & ~inner.readings:
        return False
    smaller = inner.nodes < outer.nodes
    same = inner.nodes == outer.nodes
    wider = inner.readings != outer.readings or inner.leaf < outer.leaf
    return smaller or (same and wider)


def trap_of(study: Study, nodes: Sequence[int], kept: KeptReading | None = None) -> Trap:
    """The witness of nodes that no step leads out of."""
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
    """Goes on from a task as long as one reading of a checkpoint is kept."""

    def __init__(self, study: Study) -> None:
        self.study = study
        self.work = _WORK
        self.told = told_by_others(study.flow)
        self.search = PathSearch(study.flow, study.nominal.fields, failures=False)
        self.lookers: dict[str, set[int]] = {}
        """for each checkpoint, the nodes at which a condition looks at it"""
        for i, leaf in enumerate(study.flow.leaves):
            for conditions, _ in leaf.conditional:
                for condition in conditions:
                    self.lookers.setdefault(condition.object_id, set()).add(i)
        for g, group in enumerate(study.flow.groups):
            for condition in group.until:
                self.lookers.setdefault(condition.object_id, set()).add(study.flow.round_end(g))

    def places(self) -> Iterator[tuple[int, str]]:
        """Where a checkpoint is looked at that was not just measured."""
        study = self.study
        for i, leaf in enumerate(study.flow.leaves):
            if not study.nominal.reached(i):
                continue
            objects: set[str] = set()
            for conditions, _ in leaf.conditional:
                objects |= objects_of(conditions)
            for o in sorted(objects - self.told - {leaf.measures}):
                if o in study.nominal.fields.shift:
                    yield i, o

    def readings(self, leaf: int, object_id: str) -> Iterator[int]:
        """One bit for each reading that may be there."""
        state = self.study.nominal.states[leaf]
        assert state is not None
        there = self.study.nominal.fields.get(state, object_id)
        while there:
            lowest = there & -there
            yield lowest
            there ^= lowest

    def kept(self, leaf: int, object_id: str, reading: int) -> frozenset[int] | None:
        """The nodes that follow as long as the reading is kept; None: some way ends it."""
        study, search = self.study, self.search
        flow, nominal = study.flow, study.nominal
        fields = nominal.fields
        lookers = self.lookers[object_id]
        seen = {leaf}
        pending = [leaf]
        while pending:
            node = pending.pop()
            self.work -= 1
            state = nominal.states[node]
            if self.work < 0 or state is None or node == flow.done:
                return None
            if flow.is_leaf(node) and flow.leaves[node].measures == object_id:
                return None
            if nominal.late[node] and fields.get(nominal.late[node], object_id):
                return None
            targets = study.successors[node]
            if node in lookers:
                kept = fields.set(state, object_id, reading)
                targets = tuple(target for target, _ in search.ways(node, kept))
            for target in targets:
                if target not in seen:
                    seen.add(target)
                    pending.append(target)
        return frozenset(seen)
