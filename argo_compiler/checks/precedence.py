"""Which task comes before which (rule M10): whether all that `before` asks for can be so."""

from collections.abc import Iterable, Iterator
from functools import cached_property
from graphlib import CycleError, TopologicalSorter

from argo_compiler.base.graphs import Successors, components, reached_from
from argo_compiler.diagnostics import Diagnostic, Severity, diagnostic_of
from argo_compiler.il import Mission, Order
from argo_compiler.il.velocities import MISSION_START, transition_pairs

_SHOWN = 20
"""pairs whose order is broken, as far as they are named, and tasks of a circle"""
_AT_ONCE = 4096
"""tasks that ways are looked for to in one pass"""


def check_precedence(mission: Mission) -> Iterator[Diagnostic]:
    """What is wrong with the pairs, and with the order of the tasks by them."""
    if not mission.before:
        return
    names = {task.name for task in mission.tasks}
    known = names.union(mission.left_out)
    for i, pair in enumerate(mission.before):
        for name in pair:
            if name not in known:
                yield diagnostic_of(
                    "il.unknown-before",
                    f"'{pair[0]}' is to come before '{pair[1]}', and there is no task '{name}'",
                    "name a task, or take the pair out",
                    f"before[{i}]",
                )
    circle = _circle(mission.before)
    if circle:
        yield diagnostic_of(
            "il.before-itself",
            f"'{circle[0]}' would have to come before itself: {' > '.join(circle[:_SHOWN])}",
            "take one of these pairs out",
            "before",
        )
        return
    yield from _broken(mission, [p for p in mission.before if names.issuperset(p)])


def _circle(pairs: Iterable[tuple[str, str]]) -> list[str]:
    """Tasks each of which is to come before the next, the first one again at the end."""
    before: dict[str, list[str]] = {}
    for first, second in pairs:
        before.setdefault(second, []).append(first)
    try:
        TopologicalSorter(before).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def _broken(mission: Mission, pairs: Iterable[tuple[str, str]]) -> Iterator[Diagnostic]:
    graph = _Ways(mission)
    precise = mission.order is Order.PRECISE
    for shown, (first, second) in enumerate(graph.broken(pairs)):
        if shown == _SHOWN:
            return
        sure = graph.always(second, first)
        severity = Severity.ERROR if precise and sure else Severity.WARNING
        said = "comes" if sure else "may come"
        hint = "move one of them, or take the pair out"
        if not precise:
            hint = "have the order chosen anew, or move one of them"
        yield diagnostic_of(
            "il.order-broken",
            f"'{first}' is to come before '{second}', and '{second}' {said} before it",
            hint,
            "before",
            severity=severity,
        )


class _Ways:
    """The ways between the tasks of a mission, by the tasks' positions."""

    def __init__(self, mission: Mission) -> None:
        self.names = [MISSION_START, *(task.name for task in mission.tasks)]
        self.at = {name: i for i, name in enumerate(self.names)}
        following: list[dict[int, None]] = [{} for _ in self.names]
        begun = False
        for source, target in transition_pairs(mission):
            if not begun:
                following[0][self.at.get(target, 0)] = None
                begun = True
            if source in self.at and target in self.at:
                following[self.at[source]][self.at[target]] = None
        self.following: Successors = [list(targets) for targets in following]
        self.reached = reached_from(self.following, [0])
        self.parts = components(self.following)
        self.part_of = [0] * len(self.names)
        for number, part in enumerate(self.parts):
            for node in part:
                self.part_of[node] = number

    def broken(self, pairs: Iterable[tuple[str, str]]) -> Iterator[tuple[str, str]]:
        """The pairs whose second task can be come to before the first one, with the first one still
        ahead."""
        found = [(self.at[first], self.at[second]) for first, second in pairs]
        found = [(a, b) for a, b in found if self.reached[a] and self.reached[b]]
        apart = [(a, b) for a, b in found if self.part_of[a] != self.part_of[b]]
        # Where each can follow the other, the first one has to lie on all ways to the second.
        around: dict[int, list[int]] = {}
        for a, b in found:
            if self.part_of[a] == self.part_of[b]:
                around.setdefault(a, []).append(b)
        for a, seconds in around.items():
            without = self._reached_without(a)
            yield from ((self.names[a], self.names[b]) for b in seconds if b in without)
        firsts = list(dict.fromkeys(a for a, _ in apart))
        for k in range(0, len(firsts), _AT_ONCE):
            bit = {a: 1 << i for i, a in enumerate(firsts[k : k + _AT_ONCE])}
            ahead = self._ahead(bit)
            yield from (
                (self.names[a], self.names[b])
                for a, b in apart
                if a in bit and ahead[self.part_of[b]] & bit[a]
            )

    def always(self, passed: str, before: str) -> bool:
        """Whether all ways to a task pass another one."""
        return self.at[before] not in self._reached_without(self.at[passed], everywhere=True)

    def _reached_without(self, left_out: int, everywhere: bool = False) -> set[int]:
        """The nodes to which a way leads that does not pass one; of its own part, or all."""
        own = self.part_of[left_out]
        inside = set(range(len(self.names))) if everywhere else set(self.parts[own])
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
        """Of each part, the nodes to which ways lead from others."""
        found: list[list[int]] = [[] for _ in self.parts]
        for node, following in enumerate(self.following):
            if self.reached[node]:
                for other in following:
                    if self.part_of[other] != self.part_of[node]:
                        found[self.part_of[other]].append(other)
        return found

    def _ahead(self, bit: dict[int, int]) -> list[int]:
        """For each part, the bits of the nodes in it and of those that can be come to from it."""
        ahead = [0] * len(self.parts)
        for number, part in enumerate(self.parts):  # what a part leads to comes before it
            for node in part:
                ahead[number] |= bit.get(node, 0)
                for other in self.following[node]:
                    ahead[number] |= ahead[self.part_of[other]]
        return ahead
