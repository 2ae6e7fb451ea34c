"""Shortest and longest ways through a machine, level by level.

A level is the mission or one round of a group. Its nodes are the leaves that lie in it directly and
the groups in it, a group once for each way of entering it. What a group takes is computed once for
each way of entering it, so rounds need not be counted off, and a loop that no count and no time
limits shows as a cycle within a level.
"""

import heapq
import math
from collections.abc import Generator
from dataclasses import dataclass, field
from typing import cast

from argo_compiler.analysis.flow import NOWHERE, Flow
from argo_compiler.analysis.graph import components, is_loop
from argo_compiler.analysis.legs import ANY, BEGIN, FREE, Cost, Legs, QuantityRange, Source
from argo_compiler.analysis.rounds import GroupRound, Out, Rounds, WayOut, combine
from argo_compiler.analysis.values import Paths

WORK = 400_000
"""steps after which the search is given up"""
_SOURCES = 8  # of one entry of a group that are told apart

Key = int | tuple[int, int, Source]
"""a leaf, or (group, leaf it is entered at, from where)"""


class BoundsTooLargeError(Exception):
    """The bounds would take too long to compute."""


@dataclass(frozen=True, slots=True)
class Hop:
    """A step between two nodes of a level."""

    target: int
    cost: Cost
    out: Out | None
    """how the group was left, if a group is"""


@dataclass
class LevelGraph:
    """The graph of a level, entered in one way, and the distances in it."""

    keys: list[Key] = field(default_factory=list)
    hops: list[list[Hop]] = field(default_factory=list)
    outs: list[tuple[int, WayOut, Cost, Out | None]] = field(default_factory=list)
    """node, how the level is left or its round ends, what it takes from the node on"""
    first: Cost = FREE
    """until the first node"""
    least: dict[str, list[float]] = field(default_factory=dict)
    most: dict[str, list[float]] = field(default_factory=dict)
    least_before: dict[str, list[tuple[int, Out | None] | None]] = field(default_factory=dict)
    most_before: dict[str, list[tuple[int, Out | None] | None]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Loop:
    """Tasks and groups that may follow each other without limit."""

    leaves: tuple[int, ...]
    groups: tuple[int, ...]
    left: bool
    """whether some way leads out of it; a way that would be taken too late for a hard stop does not
    count"""


class Levels:
    """Computes levels and keeps them."""

    def __init__(self, flow: Flow, paths: Paths, legs: Legs, work: int = WORK) -> None:
        self.flow = flow
        self.paths = paths
        self.legs = legs
        self.loops: dict[tuple[tuple[int, ...], tuple[int, ...]], Loop] = {}
        self._work = work
        self._rounds: dict[tuple[int, int, Source], Rounds] = {}
        self._later: dict[int, GroupRound] = {}
        self._sources: dict[tuple[int, int], set[Source]] = {}
        self._children: list[list[int]] = [[] for _ in range(len(flow.groups) + 1)]
        for number, group in enumerate(flow.groups):
            self._children[group.parent].append(number)

    def mission(self) -> LevelGraph:
        """The level of the mission. Raises TooLargeError."""
        # Levels are computed inside each other; a stack of generators instead of calls, as groups
        # may nest deeper than calls can.
        stack: list[Generator[tuple[int, int, Source], Rounds, LevelGraph | Rounds]]
        stack = [self._level(NOWHERE, self.flow.initial, BEGIN)]
        keys: list[tuple[int, int, Source] | None] = [None]
        answer: Rounds | None = None
        while True:
            try:
                wanted = stack[-1].send(answer)  # type: ignore[arg-type]
            except StopIteration as stop:
                stack.pop()
                key = keys.pop()
                if key is None:
                    return cast(LevelGraph, stop.value)
                answer = self._rounds[key] = cast(Rounds, stop.value)
                continue
            answer = self._rounds.get(wanted)
            if answer is None:
                stack.append(self._group(*wanted))
                keys.append(wanted)

    def _group(
        self, group: int, entry: int, source: Source
    ) -> Generator[tuple[int, int, Source], Rounds, Rounds]:
        """All rounds of a group, entered at a leaf from a source."""
        first = self._round(group, (yield from self._level(group, entry, source)))
        flow = self.flow.groups[group]
        later = None
        if flow.may_repeat and first.ends:
            if group not in self._later:
                level = yield from self._level(group, flow.start, ("repeat", group))
                self._later[group] = self._round(group, level)
            # The way back to the start depends on what ended last.
            later = self._later[group]
        rounds = combine(group, flow, first, later)
        timed = flow.parent >= 0 and self.flow.timed[flow.parent]
        if rounds.unlimited and not timed:
            self._note_loop((), (group,), left=bool(rounds.outs))
        return rounds

    def _round(self, group: int, level: LevelGraph) -> GroupRound:
        end = self.flow.round_end(group)
        ends: dict[Source, Cost] = {}
        exits: dict[WayOut, Cost] = {}
        for node, (source, target), cost, _ in level.outs:
            total = _spans(level, node) + cost
            if target == end:
                known = ends.get(source)
                ends[source] = total if known is None else known | total
            else:
                at = exits.get((source, target))
                exits[source, target] = total if at is None else at | total
        energy = level.first.energy.most
        for node, key in enumerate(level.keys):
            inside = 0.0 if isinstance(key, int) else self._rounds[key].energy
            energy = max(energy, level.most["energy"][node] + inside)
        return GroupRound(ends, exits, energy)

    def _level(
        self, level: int, entry: int, source: Source
    ) -> Generator[tuple[int, int, Source], Rounds, LevelGraph]:
        """The graph of a level that is entered at a leaf from a source, with its distances."""
        graph = LevelGraph()
        number: dict[Key, int] = {}

        def node(key: Key) -> int:
            if key not in number:
                number[key] = len(graph.keys)
                graph.keys.append(key)
                graph.hops.append([])
            return number[key]

        if not self.flow.is_leaf(entry):
            graph.outs.append((0, (source, entry), FREE, None))
            graph.keys.append(entry)
            graph.hops.append([])
            self._measure(graph, level)
            return graph
        first = self._key(level, entry, source)
        graph.first = self.legs.step(source, entry) if isinstance(first, int) else FREE
        node(first)
        at = 0
        while at < len(graph.keys):
            key = graph.keys[at]
            ways: list[tuple[WayOut, Cost, Out | None]]
            if isinstance(key, int):
                ways = [((key, t), FREE, None) for t in self.paths.targets(self.flow, key)]
            else:
                rounds = yield key
                ways = [(way, out.cost, out) for way, out in rounds.outs.items()]
            self._work -= 1 + len(ways)
            if self._work < 0:
                raise BoundsTooLargeError
            for (last, target), cost, out in ways:
                if self.flow.is_leaf(target) and self._holds(level, target):
                    following = self._key(level, target, last)
                    step = self.legs.step(last, target) if isinstance(following, int) else FREE
                    graph.hops[at].append(Hop(node(following), cost + step, out))
                else:
                    graph.outs.append((at, (last, target), cost, out))
            at += 1
        self._measure(graph, level)
        return graph

    def _holds(self, level: int, leaf: int) -> bool:
        return level < 0 or self.flow.groups[level].holds(leaf)

    def _key(self, level: int, leaf: int, source: Source) -> Key:
        """The node of a level that a leaf lies in."""
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
            if len(sources) >= _SOURCES:
                return child, leaf, ANY
            sources.add(source)
        return child, leaf, source

    def _measure(self, graph: LevelGraph, level: int) -> None:
        """Distances to all nodes of a level, and its loops."""
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
                    self._note_loop(
                        tuple(sorted(k for k in keys if isinstance(k, int))),
                        tuple(sorted({k[0] for k in keys if not isinstance(k, int)})),
                        left=any(out[0] in inside for out in graph.outs)
                        or any(t not in inside for node in part for t in successors[node]),
                    )
        order = [node for part in reversed(parts) for node in part]
        for measure in ("time", "energy"):
            _least(graph, measure)
            _most(graph, measure, order, looping)

    def _note_loop(self, leaves: tuple[int, ...], groups: tuple[int, ...], *, left: bool) -> None:
        known = self.loops.get((leaves, groups))
        # The same loop may be entered in several ways, in time or not.
        left = left or (known is not None and known.left)
        self.loops[leaves, groups] = Loop(leaves, groups, left)


def _spans(level: LevelGraph, node: int) -> Cost:
    """What it takes to come to a node of a level."""
    return Cost(
        QuantityRange(level.least["time"][node], level.most["time"][node]),
        QuantityRange(level.least["energy"][node], level.most["energy"][node]),
    )


def _least(graph: LevelGraph, measure: str) -> None:
    """Dijkstra's algorithm."""
    distance = [math.inf] * len(graph.keys)
    before: list[tuple[int, Out | None] | None] = [None] * len(graph.keys)
    distance[0] = getattr(graph.first, measure).least
    heap = [(distance[0], 0)]
    while heap:
        here, node = heapq.heappop(heap)
        if here > distance[node]:
            continue
        for hop in graph.hops[node]:
            there = here + getattr(hop.cost, measure).least
            if there < distance[hop.target]:
                distance[hop.target] = there
                before[hop.target] = node, hop.out
                heapq.heappush(heap, (there, hop.target))
    graph.least[measure], graph.least_before[measure] = distance, before


def _most(graph: LevelGraph, measure: str, order: list[int], looping: list[bool]) -> None:
    """The longest ways; without bound in loops and after them."""
    distance = [-math.inf] * len(graph.keys)
    before: list[tuple[int, Out | None] | None] = [None] * len(graph.keys)
    distance[0] = getattr(graph.first, measure).most
    for node in order:
        if looping[node]:
            distance[node] = math.inf
        for hop in graph.hops[node]:
            there = distance[node] + getattr(hop.cost, measure).most
            if there > distance[hop.target]:
                distance[hop.target] = there
                before[hop.target] = node, hop.out
    graph.most[measure], graph.most_before[measure] = distance, before
