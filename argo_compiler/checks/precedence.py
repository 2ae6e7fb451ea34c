"""Check of precedences (rule M10): whether the pairs in `before` can be and are satisfied."""

from collections.abc import Iterable, Iterator
from functools import cached_property
from graphlib import CycleError, TopologicalSorter

from argo_compiler.base.graphs import Successors, components, reachable_from
from argo_compiler.base.message import Message
from argo_compiler.diagnostics import Diagnostic, Severity, diagnostic_of
from argo_compiler.il import Mission, Order
from argo_compiler.il.velocities import MISSION_START, possible_successor_pairs

_SHOWN = 20
"""how many violated pairs, and tasks of a cycle, are reported"""
_BATCH_SIZE = 4096
"""tasks for which reachability is computed in one pass"""


def check_precedence(mission: Mission) -> Iterator[Diagnostic]:
    """Yield the diagnostics of a mission's precedences, the pairs in `before`.

    They name unknown tasks, pairs that contradict each other, and pairs that an execution path may
    violate.
    """
    if not mission.before:
        return
    names = {task.name for task in mission.tasks}
    known = names.union(mission.left_out)
    for i, pair in enumerate(mission.before):
        for name in pair:
            if name not in known:
                yield diagnostic_of(
                    "il.unknown-before",
                    Message(
                        "'{pair}' must come before '{pair_2}', but there is no task '{name}'",
                        pair=pair[0],
                        pair_2=pair[1],
                        name=name,
                    ),
                    "name a task, or remove the pair",
                    f"before[{i}]",
                )
    cycle = _find_cycle(mission.before)
    if cycle:
        yield diagnostic_of(
            "il.before-itself",
            Message(
                "'{cycle}' would have to come before itself: {names:>}",
                cycle=cycle[0],
                names=tuple(cycle[:_SHOWN]),
            ),
            "remove one of these pairs",
            "before",
        )
        return
    yield from _check_order(mission, [p for p in mission.before if names.issuperset(p)])


def _find_cycle(pairs: Iterable[tuple[str, str]]) -> list[str]:
    """Return a cycle of tasks, each of which must come before the next, or an empty list.

    The first task of the cycle is repeated at its end.
    """
    before: dict[str, list[str]] = {}
    for first, second in pairs:
        before.setdefault(second, []).append(first)
    try:
        TopologicalSorter(before).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def _check_order(mission: Mission, pairs: Iterable[tuple[str, str]]) -> Iterator[Diagnostic]:
    graph = _TaskGraph(mission)
    precise = mission.order is Order.PRECISE
    for shown, (first, second) in enumerate(graph.violated(pairs)):
        if shown == _SHOWN:
            return
        certain = graph.always_passes(second, first)
        severity = Severity.ERROR if precise and certain else Severity.WARNING
        verb = Message("comes") if certain else Message("may come")
        hint = Message("move one of them, or remove the pair")
        if not precise:
            hint = Message("choose the order again, or move one of them")
        yield diagnostic_of(
            "il.order-broken",
            Message(
                "'{first}' must come before '{second}', but '{second}' {verb} before it",
                first=first,
                second=second,
                verb=verb,
            ),
            hint,
            "before",
            severity=severity,
        )


class _TaskGraph:
    """Transitions between the tasks of a mission, as a graph of the tasks' positions."""

    def __init__(self, mission: Mission) -> None:
        self.names = [MISSION_START, *(task.name for task in mission.tasks)]
        self.position = {name: i for i, name in enumerate(self.names)}
        following: list[dict[int, None]] = [{} for _ in self.names]
        begun = False
        for source, target in possible_successor_pairs(mission):
            if not begun:
                following[0][self.position.get(target, 0)] = None
                begun = True
            if source in self.position and target in self.position:
                following[self.position[source]][self.position[target]] = None
        self.following: Successors = [list(targets) for targets in following]
        self.reached = reachable_from(self.following, [0])
        self.components = components(self.following)
        self.component_of = [0] * len(self.names)
        for number, component in enumerate(self.components):
            for node in component:
                self.component_of[node] = number

    def violated(self, pairs: Iterable[tuple[str, str]]) -> Iterator[tuple[str, str]]:
        """Yield the pairs whose first task can follow the second one.

        A pair is left out if both lie on a cycle and the second one can be reached only through the
        first, or if one of them can't be reached.
        """
        nodes = [(self.position[first], self.position[second]) for first, second in pairs]
        nodes = [(a, b) for a, b in nodes if self.reached[a] and self.reached[b]]
        apart = [(a, b) for a, b in nodes if self.component_of[a] != self.component_of[b]]
        # If each can follow the other, the first one has to lie on all paths to the second.
        around: dict[int, list[int]] = {}
        for a, b in nodes:
            if self.component_of[a] == self.component_of[b]:
                around.setdefault(a, []).append(b)
        for a, seconds in around.items():
            without = self._reached_without(a)
            yield from ((self.names[a], self.names[b]) for b in seconds if b in without)
        firsts = list(dict.fromkeys(a for a, _ in apart))
        for k in range(0, len(firsts), _BATCH_SIZE):
            bit = {a: 1 << i for i, a in enumerate(firsts[k : k + _BATCH_SIZE])}
            ahead = self._ahead(bit)
            yield from (
                (self.names[a], self.names[b])
                for a, b in apart
                if a in bit and ahead[self.component_of[b]] & bit[a]
            )

    def always_passes(self, passed: str, before: str) -> bool:
        """Return True if all paths from the mission's start to task `before` pass task `passed`."""
        return self.position[before] not in self._reached_without(
            self.position[passed], everywhere=True
        )

    def _reached_without(self, left_out: int, everywhere: bool = False) -> set[int]:
        """Return the nodes that can be reached from the mission's start without `left_out`.

        The method searches the whole graph if `everywhere` is set, and otherwise only the strongly
        connected component of `left_out`, from the nodes at which it is entered.
        """
        own = self.component_of[left_out]
        inside = set(range(len(self.names))) if everywhere else set(self.components[own])
        entries = [0] if everywhere or 0 in inside else self._entries[own]
        seen = {node for node in entries if node != left_out}
        pending = list(seen)
        while pending:
            for other in self.following[pending.pop()]:
                if other in inside and other != left_out and other not in seen:
                    seen.add(other)
                    pending.append(other)
        return seen

    @cached_property
    def _entries(self) -> list[list[int]]:
        """For each component, its nodes to which transitions from other components lead."""
        entries: list[list[int]] = [[] for _ in self.components]
        for node, following in enumerate(self.following):
            if self.reached[node]:
                for other in following:
                    if self.component_of[other] != self.component_of[node]:
                        entries[self.component_of[other]].append(other)
        return entries

    def _ahead(self, bit: dict[int, int]) -> list[int]:
        """Return, for each component, a bit set of the nodes that can be reached from it.

        `bit` has the bit of each node of interest; other nodes have none. The nodes of the
        component itself are included.
        """
        ahead = [0] * len(self.components)
        for number, component in enumerate(self.components):  # successors come first
            for node in component:
                ahead[number] |= bit.get(node, 0)
                for other in self.following[node]:
                    ahead[number] |= ahead[self.component_of[other]]
        return ahead
