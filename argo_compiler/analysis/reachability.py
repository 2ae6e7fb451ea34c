"""What readings may be when a task has ended, over all paths, and which transitions that leaves.

A fixed point over the flow graph: at each node the set of regions that the last value of each
object may lie in, and whether it may be missing, unreadable or failed. A transition that is taken
narrows the sets to what its conditions say, one that is passed over to what they exclude. All sets
are as large as they could be or larger, so what can't happen here can't happen at all.

A value may also come late: an action that is cancelled may still succeed, while the machine
already stands at a WAIT that follows. And a WAIT for conditions waits for values that others tell,
which may be at any time. Such values are not narrowed.
"""

import heapq
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from argo_compiler.analysis.flow import Flow, LeafFlow
from argo_compiler.analysis.value_regions import Fields, Scale, make_scale, sum_bits
from argo_compiler.base.catalog import Catalog
from argo_compiler.il import Condition, ConditionType

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
class Reachability:
    """Which nodes may be reached, with which values, and which ways on may be taken."""

    fields: Fields
    states: tuple[int | None, ...]
    """at each node before its action; None where no path leads"""
    looks: tuple[tuple[GuardStatus, ...], ...]
    """of each leaf: its conditional transitions, up to the last one that may be looked at, and
    then, if it may be, the tail"""
    failures: bool = False
    """whether any action may fail"""
    late: tuple[int, ...] = ()
    """at each node: what may still come there, from an action that is being cancelled"""

    def is_reached(self, node: int) -> bool:
        return self.states[node] is not None

    def conditional_guards(self, flow: Flow, leaf: int) -> tuple[GuardStatus, ...]:
        return self.guards[leaf][: len(flow.leaves[leaf].conditional)]

    def unconditional_possible(self, flow: Flow, leaf: int) -> bool:
        return len(self.guards[leaf]) > len(flow.leaves[leaf].conditional)

    def targets(self, flow: Flow, leaf: int) -> Iterator[int]:
        """The nodes that may come next when a leaf has ended, or failed as it may."""
        successors = flow.leaves[leaf].conditional
        for guard, (_, target) in zip(self.guards[leaf], successors, strict=False):
            if guard.possible:
                yield target
        if self.unconditional_possible(flow, leaf):
            yield flow.leaves[leaf].unconditional
        failure = flow.leaves[leaf].failure
        if failure is not None and (self.failures or flow.leaves[leaf].may_give_up):
            yield failure

    def targets_when_missed(self, flow: Flow, leaf: int) -> Iterator[int]:
        """The nodes that may come next when the hard window of a leaf is over."""
        here = flow.leaves[leaf]
        if here.deadline is None:
            return
        if here.missed is not None:
            yield here.missed
        elif here.failure is not None:
            yield here.failure
        else:
            yield from self.targets(flow, leaf)


def make_fields(flow: Flow, catalog: Catalog | None, bits: int = TRACKED_BITS) -> Fields:
    """The scales of all objects that conditions compare, as many tracked as `bits` allows.

    Objects that are compared where they were not just measured come first: those need it most.
    """
    known = (
        {} if catalog is None else {str(c.id): (c.range, c.nominal) for c in catalog.checkpoints}
    )
    compared: dict[str, list[Condition]] = {}
    remote: Counter[str] = Counter()
    for leaf in flow.leaves:
        for conditions, _ in leaf.conditional:
            for condition in conditions:
                compared.setdefault(condition.object_id, []).append(condition)
                remote[condition.object_id] += condition.object_id != leaf.measures
    for group in flow.groups:
        for condition in group.until:
            compared.setdefault(condition.object_id, []).append(condition)
            remote[condition.object_id] += 1
    scales = {o: make_scale(c, *known.get(o, (None, None))) for o, c in compared.items()}
    shift: dict[str, int] = {}
    width = 0
    for o in sorted(scales, key=lambda o: (not remote[o], scales[o].width)):
        if (width + scales[o].width) * flow.size <= bits:
            shift[o] = width
            width += scales[o].width
    return Fields(scales, shift, width)


def compute_reachability(flow: Flow, fields: Fields, failures: bool) -> Reachability:
    """The fixed point. With `failures` any action may fail and any measurement lack its value."""
    return ReachabilitySearch(flow, fields, failures).run()


def reported_by_others(flow: Flow) -> frozenset[str]:
    """The objects that conditions look at and a WAIT waits for, or no task measures."""
    compared = {
        condition.object_id
        for conditions in (
            *(conditions for leaf in flow.leaves for conditions, _ in leaf.conditional),
            *(group.until for group in flow.groups),
        )
        for condition in conditions
    }
    waited = {
        condition.object_id
        for leaf in flow.leaves
        if leaf.wait is not None
        for condition in leaf.wait.conditions
    }
    return frozenset(waited | compared - {leaf.measures for leaf in flow.leaves})


_GuardResult = tuple[GuardStatus, int, int]
"""what is known of a transition, where it leads, and the values if it is taken"""


@dataclass(frozen=True, slots=True)
class _Effect:
    """What the end of a measurement does to the values."""

    kept: int
    """those of all other objects"""
    added: int


class ReachabilitySearch:
    """The ways on from each node, and the fixed point in the making."""

    def __init__(self, flow: Flow, fields: Fields, failures: bool) -> None:
        self.flow = flow
        self.fields = fields
        self.failures = failures
        self.states: list[int | None] = [None] * flow.size
        self.updates = [0] * flow.size
        # Nodes in the order of the mission's list, so that most are looked at once.
        rank = [
            *((i, 0) for i in range(len(flow.leaves))),
            *((g.last, len(flow.groups) - k) for k, g in enumerate(flow.groups)),
            *((g.last, 2 * len(flow.groups) - k) for k, g in enumerate(flow.groups)),
            (len(flow.leaves), 0),
        ]
        self.order = sorted(range(flow.size), key=rank.__getitem__)
        self.rank_of = [0] * flow.size
        """of each node in the order"""
        for number, node in enumerate(self.order):
            self.rank_of[node] = number
        self.pending: list[int] = []
        """places of nodes, a heap"""
        self.queued = [False] * flow.size
        self.satisfying: dict[tuple[object, ...], int] = {}
        self.reported = sum_bits(self._values(o) for o in reported_by_others(flow))
        self.late = _late_readings(flow, self._late_readings)
        self.guards: list[tuple[GuardStatus, ...]] = [()] * len(flow.leaves)
        self._effects: dict[tuple[str, bool], _Effect] = {}
        self.effects = [*map(self._effect_of, flow.leaves)]
        """for each leaf, what its end changes"""
        self.only_successor = [
            *map(self._find_only_successor, flow.leaves),
            *([None] * (flow.size - len(flow.leaves))),
        ]
        """for each node, the one that always follows, if it is so simple"""

    def _find_only_successor(self, leaf: LeafFlow) -> int | None:
        timed = leaf.parent >= 0 and self.flow.timed[leaf.parent]
        simple = not leaf.conditional and leaf.wait is None and leaf.deadline is None and not timed
        return (
            leaf.unconditional
            if simple and not (self.failures and leaf.failure is not None)
            else None
        )

    def run(self) -> Reachability:
        self._join(self.flow.initial, self.fields.unmeasured | self.reported)
        while self.pending:
            node = self.order[heapq.heappop(self.pending)]
            self.queued[node] = False
            state = self.states[node]
            assert state is not None
            following = self.only_successor[node]
            if following is not None:
                self._join(following, self._after_leaf(node, state) | self.reported)
                continue
            results = self._evaluate_guards(node, state)
            if results:
                self.guards[node] = tuple([guard for guard, _, _ in results])
            for target, after in self._successors(node, state, results):
                self._join(target, after)
        for i in range(len(self.guards)):
            state = self.states[i]
            if state is not None and self.only_successor[i] is not None:
                self.guards[i] = (
                    GuardStatus(True, True, self._after_leaf(i, state) | self.reported),
                )
        return Reachability(
            self.fields, tuple(self.states), tuple(self.guards), self.failures, tuple(self.late)
        )

    def _join(self, node: int, state: int) -> None:
        state |= self.late[node]
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
            heapq.heappush(self.pending, self.rank_of[node])

    def _widened(self, known: int, joined: int, everything: bool) -> int:
        if everything:
            return self.fields.anything
        for o in self.fields.shift:
            if self.fields.get(known, o) != self.fields.get(joined, o):
                scale = self.fields.scales[o]
                joined = self.fields.set(joined, o, scale.possible | scale.without_value)
        return joined

    def successors(self, node: int, state: int) -> Iterator[tuple[int, int]]:
        """Where to go on from a node with some readings, and with which ones then."""
        return self._successors(node, state, self._evaluate_guards(node, state))

    def _successors(
        self, node: int, state: int, results: list[_GuardResult]
    ) -> Iterator[tuple[int, int]]:
        flow = self.flow
        if flow.is_leaf(node):
            leaf = flow.leaves[node]
            for guard, target, taken in results:
                if guard.possible:
                    yield target, taken
            if leaf.failure is not None and (self.failures or self._fails_by_itself(leaf)):
                yield leaf.failure, self._after_failure(leaf, state)
            if leaf.missed is not None:
                yield (
                    leaf.missed,
                    self._after_failure(leaf, state) | self._after_success(leaf, state),
                )
            if leaf.parent >= 0 and flow.timed[leaf.parent]:
                # An action that is cancelled may still report its value.
                yield flow.time_up(leaf.parent), state | self._after_success(leaf, state)
            return
        if node == flow.end_node:
            return
        ended = flow.group_of_round_end(node)
        if ended is not None:
            group = flow.groups[ended]
            yield from self._successors_of_round(ended, state)
            return
        number = node - len(flow.leaves) - len(flow.groups)
        group = flow.groups[number]
        if group.hard:
            yield group.successor, state
        if group.parent >= 0 and flow.timed[group.parent]:
            yield flow.time_up(group.parent), state

    def _successors_of_round(self, number: int, state: int) -> Iterator[tuple[int, int]]:
        """Where to go on at the end of a round."""
        group = self.flow.groups[number]
        guard, ended, repeated = self._evaluate(group.until, state, None)
        by_value = bool(group.until)
        changing = self.late[self.flow.round_end(number)] | self.reported
        if group.may_repeat and not (by_value and guard.certain):
            yield group.start, repeated | changing if by_value else state
        if group.limited:
            yield group.successor, state
        elif by_value and guard.possible:
            yield group.successor, ended | changing

    def _fails_by_itself(self, leaf: LeafFlow) -> bool:
        """Whether a leaf may fail although no action does."""
        return leaf.may_give_up or (leaf.deadline is not None and leaf.missed is None)

    def _values(self, object_id: str) -> int:
        """The set in which an object has any value."""
        shift = self.fields.shift.get(object_id)
        return 0 if shift is None else self.fields.scales[object_id].possible << shift

    def _late_readings(self, object_id: str) -> int:
        """What may come of a measurement that is cancelled: a success with a value or without."""
        shift = self.fields.shift.get(object_id)
        if shift is None or not self.failures:
            return self._values(object_id)
        scale = self.fields.scales[object_id]
        return (scale.possible | scale.unreadable) << shift

    def _after_success(self, leaf: LeafFlow, state: int) -> int:
        """After a measurement that succeeded."""
        object_id = leaf.measures
        if object_id is None or object_id not in self.fields.scales:
            return state
        return (
            self.fields.set(state, object_id, self.fields.scales[object_id].possible)
            | self.reported
        )

    def _after_failure(self, leaf: LeafFlow, state: int) -> int:
        """After one that failed for good."""
        object_id = leaf.measures
        if object_id is None or object_id not in self.fields.scales:
            return state
        return self.fields.set(state, object_id, self._without_value(object_id)) | self.reported

    def _without_value(self, object_id: str) -> int:
        scale = self.fields.scales[object_id]
        # What is done by hand without a value leaves none; it is no failure, but comes here too.
        return scale.without_value if self.failures else scale.failed

    def _effect_of(self, leaf: LeafFlow) -> _Effect | None:
        """What the end of a leaf changes, be it without a value."""
        object_id = leaf.measures
        if object_id is None or object_id not in self.fields.scales:
            return None
        unmeasured = self.failures or self._may_go_on_unmeasured(leaf)
        key = object_id, unmeasured
        if key not in self._effects:
            readings = self.fields.scales[object_id].possible
            if unmeasured:
                readings |= self._without_value(object_id)
            added = self.fields.set(0, object_id, readings)
            kept = self.fields.set(self.fields.anything, object_id, 0)
            self._effects[key] = _Effect(kept, added | self.reported)
        return self._effects[key]

    def _after_leaf(self, node: int, state: int) -> int:
        """The values when a leaf has ended."""
        change = self.effects[node]
        return state if change is None else state & change.kept | change.added

    def _may_go_on_unmeasured(self, leaf: LeafFlow) -> bool:
        """Whether a window that is missed counts as the end of the task."""
        return leaf.deadline is not None and leaf.missed is None and leaf.failure is None

    def _evaluate_guards(self, node: int, state: int) -> list[_GuardResult]:
        """The transitions of a leaf with some readings as long as they may be looked at; nothing of
        other nodes."""
        if not self.flow.is_leaf(node):
            return []
        leaf = self.flow.leaves[node]
        results: list[_GuardResult] = []
        # What was just measured is there and new, tracked or not.
        fresh = None if self.failures or self._may_go_on_unmeasured(leaf) else leaf.measures
        changing = self.reported if leaf.wait is None else self.reported | self.late[node]
        state = self._after_leaf(node, state) | changing
        for conditions, target in leaf.conditional:
            guard, taken, rest = self._evaluate(conditions, state, fresh)
            results.append((guard, target, taken | changing))
            if guard.certain:
                return results
            state = rest | changing
        results.append((GuardStatus(True, True, state), leaf.unconditional, state))
        return results

    def _evaluate(
        self, conditions: tuple[Condition, ...], state: int, fresh: str | None
    ) -> tuple[GuardStatus, int, int]:
        """Whether conditions hold, and the values if they do and if they don't."""
        fields = self.fields
        taken = state
        possible = True
        unsure = []
        for condition in conditions:
            o = condition.object_id
            satisfying = self._satisfying(condition)
            possible_readings = self._possible_readings(taken, o, fresh)
            possible = possible and bool(possible_readings & satisfying)
            if o == fresh and condition.type is ConditionType.STALE:
                possible = False
            taken = fields.set(taken, o, possible_readings & satisfying)
            # Those two say nothing of a value when they don't hold.
            timely = condition.type not in (ConditionType.STALE, ConditionType.ABNORMAL)
            timely = timely and (condition.max_age is None or o == fresh)
            if not timely or self._possible_readings(state, o, fresh) & ~satisfying:
                unsure.append((condition, timely))
        rest = state
        if len(unsure) == 1 and unsure[0][1]:
            condition = unsure[0][0]
            left = self._possible_readings(state, condition.object_id, fresh) & ~self._satisfying(
                condition
            )
            rest = fields.set(state, condition.object_id, left)
        return GuardStatus(possible, possible and not unsure, state), taken, rest

    def _possible_readings(self, state: int, object_id: str, fresh: str | None) -> int:
        possible_readings = self.fields.get(state, object_id)
        if object_id == fresh and object_id not in self.fields.shift:
            return possible_readings & ~self.fields.scales[object_id].without_value
        return possible_readings

    def _satisfying(self, condition: Condition) -> int:
        key = (condition.object_id, condition.type, condition.param1, condition.param2,
               condition.inclusive)  # fmt: skip
        found = self.satisfying.get(key)
        if found is None:
            scale: Scale = self.fields.scales[condition.object_id]
            found = self.satisfying[key] = scale.satisfying(condition)
        return found


def compared_objects(conditions: Iterable[Condition]) -> frozenset[str]:
    """The objects whose readings the conditions look at."""
    return frozenset(c.object_id for c in conditions)


def _late_readings(flow: Flow, readings: Callable[[str], int]) -> list[int]:
    """For each node, the readings that may come while the machine stands there, from an action that
    is being cancelled."""
    late = [0] * flow.size
    pending = [
        i
        for i, leaf in enumerate(flow.leaves)
        if leaf.measures is not None and readings(leaf.measures)
    ]
    while pending:
        node = pending.pop()
        passed = late[node]
        if flow.is_leaf(node):
            measured = flow.leaves[node].measures
            passed |= readings(measured) if measured is not None else 0
        for target in _successors_while_cancelling(flow, node):
            if passed | late[target] != late[target]:
                late[target] |= passed
                pending.append(target)
    return late


def _successors_while_cancelling(flow: Flow, node: int) -> tuple[int, ...]:
    """What may follow a node before an action that is being cancelled has ended."""
    if node == flow.end_node:
        return ()
    if not flow.is_leaf(node):
        ended = flow.group_of_round_end(node)
        if ended is not None:
            return flow.groups[ended].start, flow.groups[ended].successor
        group = flow.groups[node - len(flow.leaves) - len(flow.groups)]
        around = group.parent >= 0 and flow.timed[group.parent]
        return (group.successor, *((flow.time_up(group.parent),) if around else ()))
    leaf = flow.leaves[node]
    found = []
    if leaf.wait is not None or leaf.deadline is not None or leaf.leaf.task.time_limit is not None:
        found += [target for _, target in leaf.conditional]
        found += [leaf.unconditional]
        found += [way for way in (leaf.failure, leaf.missed) if way is not None]
    if leaf.parent >= 0 and flow.timed[leaf.parent]:
        found.append(flow.time_up(leaf.parent))
    return tuple(found)
