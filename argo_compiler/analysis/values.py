"""What values may be when a task has ended, over all paths, and which transitions that leaves.

A fixed point over the flow graph: at each node the set of regions that the last value of each
object may lie in, and whether it may be missing. A transition that is taken narrows the sets to
what its conditions say, one that is passed over to what they exclude. All sets are as large as they
could be or larger, so what can't happen here can't happen at all.
"""

import heapq
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from argo_compiler.analysis.flow import Flow, LeafFlow
from argo_compiler.analysis.regions import Fields, Scale, make_scale
from argo_compiler.catalog import Catalog
from argo_compiler.il import Condition

TRACKED_BITS = 800_000_000
"""of all nodes together; beyond, the objects that need the most are not kept track of"""
_WIDEN_AFTER = 20  # updates of a node, after which what still changes may be anything
_GIVE_UP_AFTER = 40  # updates of a node, after which all its values may be anything


@dataclass(frozen=True, slots=True)
class GuardStatus:
    """What is known when one transition of a leaf is looked at."""

    possible: bool
    """its conditions may hold"""
    certain: bool
    """they do hold"""
    state: int
    """the values that may be there"""


@dataclass(frozen=True)
class Paths:
    """Which nodes may be reached, with which values, and which ways on may be taken."""

    fields: Fields
    states: tuple[int | None, ...]
    """at each node before its action; None where no path leads"""
    looks: tuple[tuple[GuardStatus, ...], ...]
    """of each leaf: its conditional transitions, up to the last one that may be looked at, and
    then, if it may be, the tail"""

    def reached(self, node: int) -> bool:
        return self.states[node] is not None

    def conditional(self, flow: Flow, leaf: int) -> tuple[GuardStatus, ...]:
        return self.looks[leaf][: len(flow.leaves[leaf].conditional)]

    def tail_possible(self, flow: Flow, leaf: int) -> bool:
        return len(self.looks[leaf]) > len(flow.leaves[leaf].conditional)

    def targets(self, flow: Flow, leaf: int) -> Iterator[int]:
        """The nodes that may come next when the action of a leaf has ended."""
        ways = flow.leaves[leaf].conditional
        for look, (_, target) in zip(self.looks[leaf], ways, strict=False):
            if look.possible:
                yield target
        if self.tail_possible(flow, leaf):
            yield flow.leaves[leaf].tail


def make_fields(flow: Flow, catalog: Catalog | None, bits: int = TRACKED_BITS) -> Fields:
    """The scales of all objects that conditions compare, as many tracked as `bits` allows.

    Objects that are compared where they were not just measured come first: those need it most.
    """
    ranges = {} if catalog is None else {str(c.id): c.range for c in catalog.checkpoints}
    compared: dict[str, list[Condition]] = {}
    remote: Counter[str] = Counter()
    for leaf in flow.leaves:
        for conditions, _ in leaf.conditional:
            for condition in conditions:
                compared.setdefault(condition.object_id, []).append(condition)
                remote[condition.object_id] += condition.object_id != leaf.measures
    scales = {o: make_scale(c, ranges.get(o)) for o, c in compared.items()}
    shift: dict[str, int] = {}
    width = 0
    for o in sorted(scales, key=lambda o: (not remote[o], scales[o].width)):
        if (width + scales[o].width) * flow.size <= bits:
            shift[o] = width
            width += scales[o].width
    return Fields(scales, shift, width)


def find_paths(flow: Flow, fields: Fields, failures: bool) -> Paths:
    """The fixed point. With `failures` any action may fail and any measurement lack its value."""
    return _Search(flow, fields, failures).run()


class _Search:
    """The fixed point in the making."""

    def __init__(self, flow: Flow, fields: Fields, failures: bool) -> None:
        self.flow = flow
        self.fields = fields
        self.failures = failures
        self.states: list[int | None] = [None] * flow.size
        self.updates = [0] * flow.size
        # Nodes in the order of the mission's list, so that most are looked at once.
        self.rank = [
            *((i, 0) for i in range(len(flow.leaves))),
            *((g.last, len(flow.groups) - k) for k, g in enumerate(flow.groups)),
            *((g.last, 2 * len(flow.groups) - k) for k, g in enumerate(flow.groups)),
            (len(flow.leaves), 0),
        ]
        self.waiting: list[tuple[tuple[int, int], int]] = []
        self.queued = [False] * flow.size
        self.satisfying: dict[tuple[object, ...], int] = {}

    def run(self) -> Paths:
        self._reach(self.flow.initial, self.fields.unmeasured)
        while self.waiting:
            node = heapq.heappop(self.waiting)[1]
            self.queued[node] = False
            for target, state in self._ways(node):
                self._reach(target, state)
        looks = tuple(
            tuple(look for look, _, _ in self._look(i, self._after(i)))
            if self.states[i] is not None
            else ()
            for i in range(len(self.flow.leaves))
        )
        return Paths(self.fields, tuple(self.states), looks)

    def _reach(self, node: int, state: int) -> None:
        known = self.states[node]
        joined = state if known is None else known | state
        if joined == known:
            return
        self.updates[node] += 1
        if known is not None and self.updates[node] > _WIDEN_AFTER:
            joined = self._widened(known, joined, self.updates[node] > _GIVE_UP_AFTER)
        self.states[node] = joined
        if not self.queued[node]:
            self.queued[node] = True
            heapq.heappush(self.waiting, (self.rank[node], node))

    def _widened(self, known: int, joined: int, everything: bool) -> int:
        if everything:
            return self.fields.anything
        for o in self.fields.shift:
            if self.fields.get(known, o) != self.fields.get(joined, o):
                scale = self.fields.scales[o]
                joined = self.fields.set(joined, o, scale.possible | scale.missing)
        return joined

    def _ways(self, node: int) -> Iterator[tuple[int, int]]:
        """Where to go on from a node, and with which values."""
        state = self.states[node]
        assert state is not None
        flow = self.flow
        if flow.is_leaf(node):
            leaf = flow.leaves[node]
            for look, target, taken in self._look(node, self._after(node)):
                if look.possible:
                    yield target, taken
            if self.failures and leaf.failure is not None:
                yield leaf.failure, state
            if leaf.parent >= 0 and flow.timed[leaf.parent]:
                # An action that is cancelled may still report its value.
                yield flow.time_up(leaf.parent), state | self._measured(leaf, state)
            return
        if node == flow.done:
            return
        ended = flow.group_of_round_end(node)
        if ended is not None:
            group = flow.groups[ended]
            if group.may_repeat:
                yield group.start, state
            if group.may_end:
                yield group.onward, state
            return
        number = node - len(flow.leaves) - len(flow.groups)
        group = flow.groups[number]
        if group.hard:
            yield group.onward, state
        if group.parent >= 0 and flow.timed[group.parent]:
            yield flow.time_up(group.parent), state

    def _measured(self, leaf: LeafFlow, state: int) -> int:
        object_id = leaf.measures
        if object_id is None or object_id not in self.fields.scales:
            return state
        return self.fields.set(state, object_id, self.fields.scales[object_id].possible)

    def _after(self, node: int) -> int:
        """The values when the action of a leaf has ended."""
        state = self.states[node]
        assert state is not None
        measured = self._measured(self.flow.leaves[node], state)
        return state | measured if self.failures else measured

    def _look(self, node: int, state: int) -> Iterator[tuple[GuardStatus, int, int]]:
        """The transitions of a leaf as long as they may be looked at: what is known of each, where
        it leads, and the values if it is taken."""
        leaf = self.flow.leaves[node]
        fields = self.fields
        # What was just measured is there and new, tracked or not.
        fresh = None if self.failures else leaf.measures
        for conditions, target in leaf.conditional:
            taken = state
            possible = True
            unsure = []
            for condition in conditions:
                o = condition.object_id
                satisfying = self._satisfying(condition)
                there = self._there(taken, o, fresh)
                possible = possible and bool(there & satisfying)
                taken = fields.set(taken, o, there & satisfying)
                timely = condition.max_age is None or o == fresh
                if not timely or self._there(state, o, fresh) & ~satisfying:
                    unsure.append((condition, timely))
            certain = possible and not unsure
            yield GuardStatus(possible, certain, state), target, taken
            if certain:
                return
            if len(unsure) == 1 and unsure[0][1]:
                condition = unsure[0][0]
                rest = self._there(state, condition.object_id, fresh)
                rest &= ~self._satisfying(condition)
                state = fields.set(state, condition.object_id, rest)
        yield GuardStatus(True, True, state), leaf.tail, state

    def _there(self, state: int, object_id: str, fresh: str | None) -> int:
        there = self.fields.get(state, object_id)
        if object_id == fresh and object_id not in self.fields.shift:
            return there & ~self.fields.scales[object_id].missing
        return there

    def _satisfying(self, condition: Condition) -> int:
        key = (condition.object_id, condition.type, condition.param1, condition.param2,
               condition.inclusive)  # fmt: skip
        found = self.satisfying.get(key)
        if found is None:
            scale: Scale = self.fields.scales[condition.object_id]
            found = self.satisfying[key] = scale.satisfying(condition)
        return found


def objects_of(conditions: Iterable[Condition]) -> frozenset[str]:
    """The objects whose values the conditions compare."""
    return frozenset(c.object_id for c in conditions)
