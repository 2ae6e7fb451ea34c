"""Least and greatest time and energy through a control-flow graph, level by level.

A level is the mission or one round of a group. Its nodes are the leaves that lie in it directly,
and the groups that lie in it, each group once for each leaf and source of its entry: the leaf at
which the group is entered, and what ended before. The cost of all rounds of a group is computed
once for each entry, so that rounds need not be enumerated. A loop that no count and no time limits
is then a cycle within one level. The distance of a node is the time or energy from the start of its
level.
"""

import heapq
import math
from collections.abc import Generator, Iterator
from dataclasses import field
from typing import NamedTuple, TypeGuard, cast

from argo_compiler.analysis.flow import NOWHERE, Flow
from argo_compiler.analysis.reachability import Reachability
from argo_compiler.analysis.rounds import ExitKey, GroupExit, GroupRound, Rounds, combine_rounds
from argo_compiler.analysis.step_costs import (
    ANY,
    BEGIN,
    FREE,
    NOTHING,
    Cost,
    QuantityRange,
    Source,
    StepCosts,
)
from argo_compiler.base.graphs import components, is_loop
from argo_compiler.base.records import dataclass

MOST_STEPS = 400_000
"""greatest number of steps of the computation"""
_TOLERANCE = 1e-9  # s, as sums of floats are not exact
_MOST_SOURCES = 8  # sources distinguished for one entry of a group

GroupEntry = tuple[int, int, Source]
"""group, leaf at which it is entered, and source of that step"""

Key = int | tuple[str, int] | GroupEntry
"""node of a level: a leaf that has ended, ("missed", leaf) if its window closed, or a group"""


class BoundsTooLargeError(Exception):
    """Raised when the bounds would take too long to compute."""


class Hop(NamedTuple):
    """Step between two nodes of a level."""

    target: int
    cost: Cost
    group_exit: GroupExit | None
    """exit by which the step leaves a group; None if it leaves no group"""
    before_target: Cost = FREE
    """part of `cost` until the target is the next leaf"""
    without_wait: QuantityRange = NOTHING
    """s of the remaining part if the robot does not have to wait for a window"""


@dataclass
class LevelGraph:
    """Graph of a level that is entered at one leaf from one source, and the distances in it.

    A level is the mission without the insides of its groups, or a group without those of the groups
    in it; each of these groups is one node.

    The distances `least` and `most`, and the predecessors on the shortest and longest paths, are
    computed for each quantity, `time` and `energy`, when the graph is complete.
    """

    keys: list[Key] = field(default_factory=list)
    hops: list[list[Hop]] = field(default_factory=list)
    exits: list[tuple[int, ExitKey, Cost, GroupExit | None]] = field(default_factory=list)
    """node, exit of the level or end of its round, cost from the node on, exit of an inner group"""
    first_hops: list[Hop] = field(default_factory=list)
    """steps to the first nodes"""
    least: dict[str, list[float]] = field(default_factory=dict)
    most: dict[str, list[float]] = field(default_factory=dict)
    least_predecessors: dict[str, list[tuple[int, GroupExit | None] | None]] = field(
        default_factory=dict
    )
    most_predecessors: dict[str, list[tuple[int, GroupExit | None] | None]] = field(
        default_factory=dict
    )


@dataclass(frozen=True, slots=True)
class Loop:
    """Loop of tasks and groups that may be repeated without limit."""

    leaves: tuple[int, ...]
    groups: tuple[int, ...]
    has_exit: bool
    """whether some step leads out of the loop; steps that come too late for a hard stop don't
    count"""


class PathLengths:
    """Path lengths of all levels of a mission; caches the levels and records the loops."""

    def __init__(
        self, flow: Flow, reachability: Reachability, costs: StepCosts, work: int = MOST_STEPS
    ) -> None:
        self.flow = flow
        self.reachability = reachability
        self.costs = costs
        self.loops: dict[tuple[tuple[int, ...], tuple[int, ...]], Loop] = {}
        self._steps_left = work
        self.rounds: dict[GroupEntry, Rounds] = {}
        self._later: dict[int, GroupRound] = {}
        self._graphs: dict[GroupEntry, LevelGraph] = {}
        self._later_graphs: dict[int, LevelGraph] = {}
        self._sources: dict[tuple[int, int], set[Source]] = {}
        self._children: list[list[int]] = [[] for _ in range(len(flow.groups) + 1)]
        for number, group in enumerate(flow.groups):
            self._children[group.parent].append(number)

    def mission_level(self) -> LevelGraph:
        """Return the graph of the mission's level, with the distances from the mission's start.

        Its nodes are the leaves outside of groups, and the outermost groups.

        Raises:
            BoundsTooLargeError: The computation would take too long.
        """
        # A level needs the levels of its groups. Generators on a stack replace recursive calls, as
        # groups may nest deeper than calls can.
        stack: list[Generator[GroupEntry, Rounds, LevelGraph | Rounds]]
        stack = [self._build_level(NOWHERE, self.flow.initial, BEGIN)]
        keys: list[GroupEntry | None] = [None]
        answer: Rounds | None = None
        while True:
            try:
                wanted = stack[-1].send(answer)  # type: ignore[arg-type]
            except StopIteration as stop:
                stack.pop()
                key = keys.pop()
                if key is None:
                    return cast(LevelGraph, stop.value)
                answer = self.rounds[key] = cast(Rounds, stop.value)
                continue
            answer = self.rounds.get(wanted)
            if answer is None:
                stack.append(self._group_rounds(*wanted))
                keys.append(wanted)

    def first_and_later_round_graphs(self, entry: GroupEntry) -> Iterator[LevelGraph]:
        """Yield the graph of a group's first round for one entry, and that of later rounds if any.

        An entry is the group, the leaf at which it is entered, and what ended before.
        """
        yield self._graphs[entry]
        if entry[0] in self._later_graphs:
            yield self._later_graphs[entry[0]]

    def _group_rounds(
        self, group: int, entry: int, source: Source
    ) -> Generator[GroupEntry, Rounds, Rounds]:
        """Return the cost of all rounds of a group that is entered at a leaf from a source.

        The generator yields the entries of inner groups, and is sent the costs of all their rounds.
        """
        graph = yield from self._build_level(group, entry, source)
        self._graphs[group, entry, source] = graph
        first = self._group_round(group, graph)
        flow = self.flow.groups[group]
        later = None
        if flow.may_repeat and first.ends:
            if group not in self._later:
                level = yield from self._build_level(group, flow.start, ("repeat", group))
                self._later_graphs[group] = level
                self._later[group] = self._group_round(group, level)
            # The cost of the step back to the start depends on the leaf that ended last.
            later = self._later[group]
        rounds = combine_rounds(group, flow, first, later, self.costs.standing_power)
        timed = flow.parent >= 0 and self.flow.timed[flow.parent]
        if rounds.unlimited and not timed:
            self._record_loop((), (group,), has_exit=bool(rounds.exits))
        return rounds

    def _group_round(self, group: int, level: LevelGraph) -> GroupRound:
        end = self.flow.round_end_node(group)
        ends: dict[Source, Cost] = {}
        exits: dict[ExitKey, Cost] = {}
        for node, (source, target), cost, _ in level.exits:
            total = _cost_to(level, node) + cost
            if target == end:
                known = ends.get(source)
                ends[source] = total if known is None else known | total
            else:
                at = exits.get((source, target))
                exits[source, target] = total if at is None else at | total
        energy = time = 0.0
        for node, key in enumerate(level.keys):
            inside = self.rounds[key] if is_group_entry(key) else None
            energy = max(energy, level.most["energy"][node] + (inside.energy if inside else 0.0))
            time = max(time, level.most["time"][node] + (inside.time if inside else 0.0))
        return GroupRound(ends, exits, energy, time)

    def _build_level(
        self, level: int, entry: int, source: Source
    ) -> Generator[GroupEntry, Rounds, LevelGraph]:
        """Return the graph of a level that is entered at a leaf from a source, with distances.

        The generator yields the entries of inner groups, and is sent the costs of all their rounds.
        """
        graph = LevelGraph()
        number: dict[Key, int] = {}

        def node(key: Key) -> int:
            if key not in number:
                number[key] = len(graph.keys)
                graph.keys.append(key)
                graph.hops.append([])
            return number[key]

        def hops(
            last: Source, target: int, cost: Cost, group_exit: GroupExit | None
        ) -> Iterator[Hop]:
            """Yield the steps to a leaf: to its end and missed window, or to the group around."""
            following = self._key_for(level, target, last)
            if not isinstance(following, int):
                yield Hop(node(following), cost, group_exit, cost)
                return
            step, without_wait = (
                self.costs.step_cost(last, target),
                self.costs.cost_without_wait(last, target).time,
            )
            yield Hop(node(following), cost + step, group_exit, cost, without_wait)
            if self.flow.leaves[target].deadline is not None and self.costs.travel is not None:
                missed = cost + self.costs.cost_until_window_closes(last, target)
                yield Hop(node(("missed", target)), missed, group_exit, cost, without_wait)

        if not self.flow.is_leaf(entry):
            graph.exits.append((0, (source, entry), FREE, None))
            graph.first_hops.append(Hop(node(entry), FREE, None))
            self._compute_lengths(graph, level)
            return graph
        graph.first_hops += hops(source, entry, FREE, None)
        at = 0
        while at < len(graph.keys):
            key = graph.keys[at]
            continuations: list[tuple[ExitKey, Cost, GroupExit | None]]
            if isinstance(key, int):
                continuations = [
                    ((key, t), FREE, None) for t in self.reachability.targets(self.flow, key)
                ]
            elif is_group_entry(key):
                rounds = yield key
                continuations = [
                    (exit_key, group_exit.cost, group_exit)
                    for exit_key, group_exit in rounds.exits.items()
                ]
            else:
                missed = cast(tuple[str, int], key)
                after = self.reachability.targets_when_missed(self.flow, missed[1])
                continuations = [((missed, t), FREE, None) for t in after]
            self._steps_left -= 1 + len(continuations)
            if self._steps_left < 0:
                raise BoundsTooLargeError
            for (last, target), cost, group_exit in continuations:
                if self.flow.is_leaf(target) and self._is_in_level(level, target):
                    graph.hops[at] += hops(last, target, cost, group_exit)
                else:
                    graph.exits.append((at, (last, target), cost, group_exit))
            at += 1
        self._compute_lengths(graph, level)
        return graph

    def _is_in_level(self, level: int, leaf: int) -> bool:
        return level < 0 or self.flow.groups[level].contains(leaf)

    def _key_for(self, level: int, leaf: int, source: Source) -> Key:
        """Return the node of a level for a leaf: the leaf itself, or the group that contains it."""
        if self.flow.leaves[leaf].parent == level:
            return leaf
        children = self._children[level]
        low, high = 0, len(children) - 1
        while low < high:
            middle = (low + high + 1) // 2
            if self.flow.groups[children[middle]].first <= leaf:
                low = middle
            else:
                high = middle - 1
        child = children[low]
        sources = self._sources.setdefault((child, leaf), set())
        if source not in sources:
            if len(sources) >= _MOST_SOURCES:
                return child, leaf, ANY
            sources.add(source)
        return child, leaf, source

    def _compute_lengths(self, graph: LevelGraph, level: int) -> None:
        """Compute least and greatest time and energy to each node of a level; record its loops."""
        successors = [[hop.target for hop in hops] for hops in graph.hops]
        parts = components(successors)
        looping = [False] * len(graph.keys)
        timed = level >= 0 and self.flow.timed[level]
        for part in parts:
            if is_loop(part, successors):
                for node in part:
                    looping[node] = True
                if not timed:
                    keys = [graph.keys[node] for node in part]
                    inside = set(part)
                    self._record_loop(
                        tuple(sorted(k for k in keys if isinstance(k, int))),
                        tuple(sorted({k[0] for k in keys if is_group_entry(k)})),
                        has_exit=any(exit[0] in inside for exit in graph.exits)
                        or any(t not in inside for node in part for t in successors[node]),
                    )
        order = [node for part in reversed(parts) for node in part]
        for quantity in ("time", "energy"):
            clock = _Clock(self.costs) if level < 0 and quantity == "time" else None
            _find_longest(graph, quantity, order, looping, clock)
            _find_shortest(graph, quantity, clock)

    def _record_loop(
        self, leaves: tuple[int, ...], groups: tuple[int, ...], *, has_exit: bool
    ) -> None:
        known = self.loops.get((leaves, groups))
        # The same loop may be entered from several sources, some of them too late to leave it.
        has_exit = has_exit or (known is not None and known.has_exit)
        self.loops[leaves, groups] = Loop(leaves, groups, has_exit)


def _cost_to(level: LevelGraph, node: int) -> Cost:
    """Return the range of the cost from a level's start to one of its nodes, over all paths."""
    return Cost(
        QuantityRange(level.least["time"][node], level.most["time"][node]),
        QuantityRange(level.least["energy"][node], level.most["energy"][node]),
    )


class _Clock:
    """Clock that counts from the mission's start, for steps with time windows."""

    def __init__(self, costs: StepCosts) -> None:
        self.costs = costs

    def soonest(self, hop: Hop, key: Key, here: float, latest_here: float) -> float:
        """Return the soonest end of a step to node `key` in s; infinite if it can't be taken.

        It counts from the mission's start, as do `here` and `latest_here`, the soonest and the
        latest time at the node where the step begins.
        """
        started = here + hop.before_target.time.least
        leaf = self._window(key)
        if leaf is None:
            return here + hop.cost.time.least
        flow = self.costs.flow.leaves[leaf]
        work = self.costs.action_cost(leaf).time
        if isinstance(key, int):
            ended = max(started + hop.without_wait.least, flow.earliest + work.least)
            late = flow.deadline is not None and ended > flow.deadline + _TOLERANCE
            return math.inf if late else ended
        assert flow.deadline is not None
        ended = max(
            latest_here + hop.before_target.time.most + hop.without_wait.most,
            flow.earliest + work.most,
        )
        return max(started, flow.deadline) if ended >= flow.deadline - _TOLERANCE else math.inf

    def latest(self, hop: Hop, key: Key, here: float) -> float:
        """Return the latest end of a step to node `key` in s; -inf if it can't be taken.

        It counts from the mission's start, as does `here`, the latest time at the node where the
        step begins.
        """
        started = here + hop.before_target.time.most
        leaf = self._window(key)
        if leaf is None:
            return here + hop.cost.time.most
        flow = self.costs.flow.leaves[leaf]
        ended = max(
            started + hop.without_wait.most, flow.earliest + self.costs.action_cost(leaf).time.most
        )
        if isinstance(key, int):
            return ended if flow.deadline is None else min(ended, flow.deadline + _TOLERANCE)
        assert flow.deadline is not None
        return max(started, flow.deadline) if ended >= flow.deadline - _TOLERANCE else -math.inf

    def _window(self, key: Key) -> int | None:
        """Return the leaf of a node if its task has a time window.

        Returns None for other nodes, and for all nodes if travel times are unknown.
        """
        if is_group_entry(key):
            return None
        leaf = key if isinstance(key, int) else key[1]
        flow = self.costs.flow
        windowed = flow.is_leaf(leaf) and flow.leaves[leaf].leaf.task.window is not None
        return leaf if windowed and self.costs.travel is not None else None


def is_group_entry(key: Key) -> TypeGuard[GroupEntry]:
    """Return True if a node is a group."""
    return isinstance(key, tuple) and len(key) == 3


def _find_shortest(graph: LevelGraph, quantity: str, clock: _Clock | None) -> None:
    """Compute the least time or energy to each node of a level with Dijkstra's algorithm.

    With a clock, the distances are times since the mission's start. The results are stored in
    `graph`.
    """
    of_time = quantity == "time"
    distance = [math.inf] * len(graph.keys)
    predecessors: list[tuple[int, GroupExit | None] | None] = [None] * len(graph.keys)
    heap: list[tuple[float, int]] = []

    def reach(hop: Hop, here: float, node: int | None) -> None:
        if clock is None:
            there = here + (hop.cost.time if of_time else hop.cost.energy).least
        else:
            latest = 0.0 if node is None else graph.most[quantity][node]
            there = clock.soonest(hop, graph.keys[hop.target], here, latest)
        if there < distance[hop.target]:
            distance[hop.target] = there
            predecessors[hop.target] = None if node is None else (node, hop.group_exit)
            heapq.heappush(heap, (there, hop.target))

    for hop in graph.first_hops:
        reach(hop, 0.0, None)
    while heap:
        here, node = heapq.heappop(heap)
        if here > distance[node]:
            continue
        for hop in graph.hops[node]:
            reach(hop, here, node)
    graph.least[quantity], graph.least_predecessors[quantity] = distance, predecessors


def _find_longest(
    graph: LevelGraph, quantity: str, order: list[int], looping: list[bool], clock: _Clock | None
) -> None:
    """Compute the greatest time or energy to each node of a level; infinite in and after loops.

    `order` has all nodes, each after its predecessors except in loops; `looping` states for each
    node if it is in a loop. The results are stored in `graph`.
    """
    of_time = quantity == "time"
    distance = [-math.inf] * len(graph.keys)
    predecessors: list[tuple[int, GroupExit | None] | None] = [None] * len(graph.keys)

    def reach(hop: Hop, here: float, node: int | None) -> None:
        if clock is None:
            there = here + (hop.cost.time if of_time else hop.cost.energy).most
        else:
            there = clock.latest(hop, graph.keys[hop.target], here)
        if there > distance[hop.target]:
            distance[hop.target] = there
            predecessors[hop.target] = None if node is None else (node, hop.group_exit)

    for hop in graph.first_hops:
        reach(hop, 0.0, None)
    for node in order:
        if looping[node]:
            distance[node] = math.inf
        elif distance[node] == -math.inf:
            continue
        for hop in graph.hops[node]:
            reach(hop, distance[node], node)
    graph.most[quantity], graph.most_predecessors[quantity] = distance, predecessors
