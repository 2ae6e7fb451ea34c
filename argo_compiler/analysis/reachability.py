"""Reachability of nodes and transitions on all paths, with the readings that are possible there.

A fixed point over the control-flow graph. The state of a node says, for each object, in which
regions its last value may lie, and whether its reading may be missing, unreadable or failed. A
transition that is taken narrows the state to the readings that satisfy its conditions; a transition
that is not taken narrows it to the others. The states are over-approximations: what can't happen in
them can't happen at all.

A value may also arrive late: an action that is being cancelled may still succeed while the machine
is already at a WAIT that follows. And a WAIT for conditions waits for values that others report,
which may happen at any time. Such values are not narrowed.
"""

import heapq
from collections import Counter
from collections.abc import Callable, Iterable, Iterator

from argo_compiler.analysis.flow import Flow, LeafFlow
from argo_compiler.analysis.value_regions import Fields, Scale, make_scale, union_of_bits
from argo_compiler.base.catalog import Catalog
from argo_compiler.base.records import dataclass
from argo_compiler.il import Condition, ConditionType

TRACKED_BITS = 800_000_000
"""greatest number of bits of all nodes together; beyond it, the largest objects are not tracked"""
_WIDEN_AFTER = 20  # updates of a node, after which objects that still change may have any reading
_GIVE_UP_AFTER = 40  # updates of a node, after which all objects may have any reading


@dataclass(frozen=True, slots=True)
class GuardStatus:
    """Result of evaluating the conditions of one transition of a leaf."""

    possible: bool
    """whether the conditions can be satisfied"""
    certain: bool
    """whether the conditions are always satisfied"""
    state: int
    """readings that are possible before the evaluation"""


@dataclass(frozen=True)
class Reachability:
    """Nodes that can be reached, with the possible readings, and transitions that can be taken."""

    fields: Fields
    states: tuple[int | None, ...]
    """for each node, the readings before its action; None if no path leads there"""
    guards: tuple[tuple[GuardStatus, ...], ...]
    """for each leaf, its conditional transitions up to the last one that may be evaluated, and then
    the unconditional transition if it can be taken"""
    failures: bool = False
    """whether any action may fail"""
    late: tuple[int, ...] = ()
    """for each node, the readings that an action that is being cancelled may still report there"""

    def is_reached(self, node: int) -> bool:
        return self.states[node] is not None

    def conditional_guards(self, flow: Flow, leaf: int) -> tuple[GuardStatus, ...]:
        return self.guards[leaf][: len(flow.leaves[leaf].conditional)]

    def unconditional_possible(self, flow: Flow, leaf: int) -> bool:
        return len(self.guards[leaf]) > len(flow.leaves[leaf].conditional)

    def targets(self, flow: Flow, leaf: int) -> Iterator[int]:
        """Yield the nodes that can follow when a leaf has ended or failed.

        Without `failures`, only a WAIT that gives up fails.
        """
        successors = flow.leaves[leaf].conditional
        for guard, (_, target) in zip(self.guards[leaf], successors, strict=False):
            if guard.possible:
                yield target
        if self.unconditional_possible(flow, leaf):
            yield flow.leaves[leaf].unconditional
        failure = flow.leaves[leaf].failure
        if failure is not None and (self.failures or flow.leaves[leaf].has_wait_limit):
            yield failure

    def targets_when_missed(self, flow: Flow, leaf: int) -> Iterator[int]:
        """Yield the nodes that can follow when the hard window of a leaf has closed."""
        here = flow.leaves[leaf]
        if here.deadline is None:
            return
        if here.missed is not None:
            yield here.missed
        elif here.failure is not None:
            yield here.failure
        else:
            yield from self.targets(flow, leaf)


def make_fields(
    flow: Flow, catalog: Catalog | None, bits_of_all_nodes: int = TRACKED_BITS
) -> Fields:
    """Return the layout of a state: the bit sets of the readings of all objects that are compared.

    An object is a checkpoint. As many are tracked as fit into `bits_of_all_nodes`, the number of
    bits for the states of all nodes together; the others may have any reading anywhere. Objects
    that are compared at a task that does not measure them are tracked first, as they need it most.
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
        if (width + scales[o].width) * flow.size <= bits_of_all_nodes:
            shift[o] = width
            width += scales[o].width
    return Fields(scales, shift, width)


def compute_reachability(flow: Flow, fields: Fields, actions_may_fail: bool) -> Reachability:
    """Return the nodes that can be reached, and the readings that are possible there.

    It covers all execution paths. With `actions_may_fail`, any action may fail and any measurement
    may lack its value.
    """
    return ReachabilitySearch(flow, fields, actions_may_fail).run()


def objects_that_others_may_report(flow: Flow) -> frozenset[str]:
    """Return the ids of the objects whose values others than the mission's tasks may report.

    These are the objects that a WAIT waits for, and those that are compared but that no task
    measures.
    """
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
"""status of a transition, its target node, and the readings if it is taken"""


@dataclass(frozen=True, slots=True)
class _Effect:
    """Change of the state at the end of a measurement."""

    mask: int
    """bits of all other objects, which do not change"""
    added: int
    """readings that become possible"""


class ReachabilitySearch:
    """Successors of each node, and the search for the fixed point; its states grow during `run`."""

    def __init__(self, flow: Flow, fields: Fields, failures: bool) -> None:
        self.flow = flow
        self.fields = fields
        self.failures = failures
        self.states: list[int | None] = [None] * flow.size
        self.updates = [0] * flow.size
        # Nodes in the order of the mission's list, so that most are visited only once.
        rank = [
            *((i, 0) for i in range(len(flow.leaves))),
            *((g.last, len(flow.groups) - k) for k, g in enumerate(flow.groups)),
            *((g.last, 2 * len(flow.groups) - k) for k, g in enumerate(flow.groups)),
            (len(flow.leaves), 0),
        ]
        self.order = sorted(range(flow.size), key=rank.__getitem__)
        self.rank_of = [0] * flow.size
        """for each node, its index in the order"""
        for number, node in enumerate(self.order):
            self.rank_of[node] = number
        self.pending: list[int] = []
        """heap of the ranks of nodes to visit"""
        self.queued = [False] * flow.size
        self.satisfying: dict[tuple[object, ...], int] = {}
        self.reported = union_of_bits(self._values(o) for o in objects_that_others_may_report(flow))
        self.late = _late_readings(flow, self._late_readings)
        self.guards: list[tuple[GuardStatus, ...]] = [()] * len(flow.leaves)
        self._effects: dict[tuple[str, bool], _Effect] = {}
        self.effects = [*map(self._effect_of, flow.leaves)]
        """for each leaf, the change at its end; None if there is none"""
        self.only_successor = [
            *map(self._find_only_successor, flow.leaves),
            *([None] * (flow.size - len(flow.leaves))),
        ]
        """for each node, the node that always follows; None if there may be several"""

    def _find_only_successor(self, leaf: LeafFlow) -> int | None:
        timed = leaf.parent >= 0 and self.flow.timed[leaf.parent]
        simple = not leaf.conditional and leaf.wait is None and leaf.deadline is None and not timed
        return (
            leaf.unconditional
            if simple and not (self.failures and leaf.failure is not None)
            else None
        )

    def run(self) -> Reachability:
        self._join(self.flow.initial, self.fields.unmeasured_state | self.reported)
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
            return self.fields.any_readings_state
        for o in self.fields.shift:
            if self.fields.get(known, o) != self.fields.get(joined, o):
                scale = self.fields.scales[o]
                joined = self.fields.set(joined, o, scale.possible | scale.without_value_bits)
        return joined

    def successors(self, node: int, state: int) -> Iterator[tuple[int, int]]:
        """Yield the nodes that can follow a node, each with the readings that are possible there.

        `state` has the readings that are possible at the node, before its action.
        """
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
                yield flow.time_up_node(leaf.parent), state | self._after_success(leaf, state)
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
            yield flow.time_up_node(group.parent), state

    def _successors_of_round(self, number: int, state: int) -> Iterator[tuple[int, int]]:
        """Yield the nodes that can follow a round's end, each with the readings possible there."""
        group = self.flow.groups[number]
        guard, ended, repeated = self._evaluate(group.until, state, None)
        by_value = bool(group.until)
        changing = self.late[self.flow.round_end_node(number)] | self.reported
        if group.may_repeat and not (by_value and guard.certain):
            yield group.start, repeated | changing if by_value else state
        if group.has_round_or_time_limit:
            yield group.successor, state
        elif by_value and guard.possible:
            yield group.successor, ended | changing

    def _fails_by_itself(self, leaf: LeafFlow) -> bool:
        """Return True if a leaf may fail although no action fails."""
        return leaf.has_wait_limit or (leaf.deadline is not None and leaf.missed is None)

    def _values(self, object_id: str) -> int:
        """Return the state bits of all values in an object's range; 0 if it is not tracked."""
        shift = self.fields.shift.get(object_id)
        return 0 if shift is None else self.fields.scales[object_id].possible << shift

    def _late_readings(self, object_id: str) -> int:
        """Return the state bits of the readings that a cancelled measurement may still report.

        It may succeed before it is cancelled. With failures, the success may have no value.
        """
        shift = self.fields.shift.get(object_id)
        if shift is None or not self.failures:
            return self._values(object_id)
        scale = self.fields.scales[object_id]
        return (scale.possible | scale.unreadable_bit) << shift

    def _after_success(self, leaf: LeafFlow, state: int) -> int:
        """Return the possible readings after a leaf's measurement succeeded, from those before."""
        object_id = leaf.measures
        if object_id is None or object_id not in self.fields.scales:
            return state
        return (
            self.fields.set(state, object_id, self.fields.scales[object_id].possible)
            | self.reported
        )

    def _after_failure(self, leaf: LeafFlow, state: int) -> int:
        """Return the possible readings after a leaf's measurement failed, from those before.

        It has failed finally: there is no further attempt.
        """
        object_id = leaf.measures
        if object_id is None or object_id not in self.fields.scales:
            return state
        return self.fields.set(state, object_id, self._without_value(object_id)) | self.reported

    def _without_value(self, object_id: str) -> int:
        scale = self.fields.scales[object_id]
        # A task that a person does without giving a value leaves no reading. That is no failure,
        # but it is treated here too.
        return scale.without_value_bits if self.failures else scale.otherwise_failed_bit

    def _effect_of(self, leaf: LeafFlow) -> _Effect | None:
        """Return the change of the possible readings by a leaf's end; None if there is none.

        The end may be a success or a failure. Readings without a value are possible only if
        failures are, or if a missed window is followed by the transitions of a success.
        """
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
            mask = self.fields.set(self.fields.any_readings_state, object_id, 0)
            self._effects[key] = _Effect(mask, added | self.reported)
        return self._effects[key]

    def _after_leaf(self, node: int, state: int) -> int:
        """Return the possible readings after a leaf, from those before its action."""
        effect = self.effects[node]
        return state if effect is None else state & effect.mask | effect.added

    def _may_go_on_unmeasured(self, leaf: LeafFlow) -> bool:
        """Return True if a leaf's missed window is followed by the transitions of its success."""
        return leaf.deadline is not None and leaf.missed is None and leaf.failure is None

    def _evaluate_guards(self, node: int, state: int) -> list[_GuardResult]:
        """Return status, target and readings when taken, of each transition that may be evaluated.

        `state` has the readings that are possible before the leaf's action. The order is that of
        the transitions; the unconditional one comes last, if it can be taken. Other nodes have no
        results.
        """
        if not self.flow.is_leaf(node):
            return []
        leaf = self.flow.leaves[node]
        results: list[_GuardResult] = []
        # A value that was just measured exists and is new, whether its object is tracked or not.
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
        """Return the status of conditions, and the possible readings if all hold and if not.

        `fresh` is an object that has certainly just been measured; None if there is none.
        """
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
            # If one of these two is not satisfied, that says nothing about the value.
            timely = condition.type not in (ConditionType.STALE, ConditionType.ABNORMAL)
            timely = timely and (condition.max_age is None or o == fresh)
            if not timely or self._possible_readings(state, o, fresh) & ~satisfying:
                unsure.append((condition, timely))
        rest = state
        if len(unsure) == 1 and unsure[0][1]:
            condition = unsure[0][0]
            excluded = self._possible_readings(
                state, condition.object_id, fresh
            ) & ~self._satisfying(condition)
            rest = fields.set(state, condition.object_id, excluded)
        return GuardStatus(possible, possible and not unsure, state), taken, rest

    def _possible_readings(self, state: int, object_id: str, fresh: str | None) -> int:
        possible_readings = self.fields.get(state, object_id)
        if object_id == fresh and object_id not in self.fields.shift:
            return possible_readings & ~self.fields.scales[object_id].without_value_bits
        return possible_readings

    def _satisfying(self, condition: Condition) -> int:
        key = (condition.object_id, condition.type, condition.param1, condition.param2,
               condition.inclusive)  # fmt: skip
        satisfying = self.satisfying.get(key)
        if satisfying is None:
            scale: Scale = self.fields.scales[condition.object_id]
            satisfying = self.satisfying[key] = scale.satisfying_bits(condition)
        return satisfying


def compared_objects(conditions: Iterable[Condition]) -> frozenset[str]:
    """Return the objects whose readings the conditions compare."""
    return frozenset(c.object_id for c in conditions)


def _late_readings(flow: Flow, readings: Callable[[str], int]) -> list[int]:
    """Return for each node the readings that an action being cancelled may still report there.

    `readings` gives the readings that the measurement of an object may report late.
    """
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
    """Return the nodes that can follow a node while an action is still being cancelled."""
    if node == flow.end_node:
        return ()
    if not flow.is_leaf(node):
        ended = flow.group_of_round_end(node)
        if ended is not None:
            return flow.groups[ended].start, flow.groups[ended].successor
        group = flow.groups[node - len(flow.leaves) - len(flow.groups)]
        around = group.parent >= 0 and flow.timed[group.parent]
        return (group.successor, *((flow.time_up_node(group.parent),) if around else ()))
    leaf = flow.leaves[node]
    targets = []
    if leaf.wait is not None or leaf.deadline is not None or leaf.leaf.task.time_limit is not None:
        targets += [target for _, target in leaf.conditional]
        targets += [leaf.unconditional]
        targets += [target for target in (leaf.failure, leaf.missed) if target is not None]
    if leaf.parent >= 0 and flow.timed[leaf.parent]:
        targets.append(flow.time_up_node(leaf.parent))
    return tuple(targets)
