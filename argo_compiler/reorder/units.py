"""What of a mission may change places: the tasks that every way through it passes.

A mission, and each round of a group, is a chain of units. Between two units lies nothing: what is
done only in some cases belongs to the unit before it, and stays as it is written.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from argo_compiler.analysis.flow import NOWHERE, Flow
from argo_compiler.base.errors import Invalid
from argo_compiler.base.graphs import components, is_loop, reached_from
from argo_compiler.il import Condition, Mission
from argo_compiler.reorder.task_graph import Level, TaskGraph


@dataclass(frozen=True)
class TaskUnit:
    """A task, and with it all that may be done between it and the next unit. Leaves of the flow."""

    entry: int
    """the task that is always done first"""
    leaves: tuple[int, ...]
    """in the order of the mission's list, but with the entry first and the last one last"""
    final: int | None
    """the leaf after which the stop is always left, by no condition; None: there is none"""
    level: int
    """the group that it lies in directly, or NOWHERE"""


@dataclass(frozen=True)
class Circuit:
    """A group that is entered at its start, and left at its end only."""

    group: int
    inside: tuple["Unit", ...]


Unit = TaskUnit | Circuit


@dataclass(frozen=True)
class Spine:
    """A mission as a chain of units, in the order in which it is written."""

    flow: Flow
    units: tuple[Unit, ...]
    end: int | None
    """the leaf that the mission always ends with: the way into the docking station"""
    apart: frozenset[int]
    """leaves from which the mission ends without the rest; they stay where they are"""
    gates: frozenset[tuple[int, int]]
    """leaves after which the mission may end early, and the nodes that they lead to then"""
    reasons: tuple[str, ...]
    """why something stays as it is written"""
    asked: Mapping[int, tuple[Condition, ...]]
    """by leaf, what is looked at when it ends"""
    before: tuple[tuple[str, str], ...] = ()
    """what the mission asks to come before what, by names"""

    def name(self, leaf: int) -> str:
        return self.flow.leaves[leaf].name


def find_spine(mission: Mission) -> Spine:
    """The units of a mission.

    Raises:
        DiagnosticError: `check` finds errors in the mission.
        ArgoError: a task can't be reached, or nothing leads to the mission's end.
    """
    return _Finder(mission).spine()


def stops_of(units: Sequence[Unit]) -> Iterator[TaskUnit]:
    """All stops, those in circuits included, in their order."""
    for unit in units:
        if isinstance(unit, TaskUnit):
            yield unit
        else:
            yield from stops_of(unit.inside)


class _Finder:
    """Finds the units of one mission. Collects reasons."""

    def __init__(self, mission: Mission) -> None:
        self.before = mission.before
        self.passages = TaskGraph(mission)
        self.flow = self.passages.flow
        self.reasons: list[str] = []

    def spine(self) -> Spine:
        passages = self.passages
        passages.require_reachable()
        units: tuple[Unit, ...] = ()
        if passages.own and passages.end != self.flow.initial:
            level = passages.level(NOWHERE)
            passages.set_apart(level)
            if level.broken:
                raise Invalid(f"the order of this mission can't be changed: {level.broken}")
            units = self._units(NOWHERE, level, self.flow.initial)
        return Spine(
            self.flow,
            units,
            passages.end,
            frozenset(passages.apart),
            frozenset(passages.gates),
            tuple(dict.fromkeys(self.reasons)),
            {leaf: tuple(passages.asked(leaf)) for leaf in passages.own},
            self.before,
        )

    def _units(self, group: int, level: Level, entry: int) -> tuple[Unit, ...]:
        """The chain of units. Each is entered at one leaf."""
        successors = level.successors(level.edges)
        reached = reached_from(successors, [level.child_of[entry]])
        parts = [part for part in reversed(components(successors)) if reached[part[0]]]
        position = {child: k for k, part in enumerate(parts) for child in part}
        # No way leads past a part that all ways pass.
        farthest = list(range(len(parts)))
        for edge in level.edges:
            if edge.source in position:
                here = position[edge.source]
                farthest[here] = max(farthest[here], position[edge.target])
        chains: list[list[int]] = []
        reach = 0
        for k, part in enumerate(parts):
            if part == [level.sink]:
                break
            if is_loop(part, successors):
                self._explain_loop(level, part)
            if reach <= k:
                chains.append([])
            chains[-1] += part
            reach = max(reach, farthest[k])
        chains = self._joined(level, group, chains)
        units = []
        for number, chain in enumerate(chains):
            entries = self._entries(level, chain) if number else {entry}
            units.append(self._unit(group, level, sorted(chain), min(entries)))
        return tuple(units)

    def _explain_loop(self, level: Level, part: Sequence[int]) -> None:
        names = [f"'{self.passages.name(level.children[child])}'" for child in sorted(part)]
        what = names[0] if len(names) == 1 else f"{names[0]} to {names[-1]}"
        self.reasons.append(
            f"{what} may be done again by a condition: kept as written, and reckoned once"
        )

    def _entries(self, level: Level, chain: Sequence[int]) -> set[int]:
        """The leaves at which a chain is entered from outside."""
        inside = set(chain)
        return {
            edge.entry
            for edge in level.edges
            if edge.target in inside and edge.source not in inside and edge.entry is not None
        }

    def _joined(self, level: Level, group: int, chains: list[list[int]]) -> list[list[int]]:
        """The chains, those made one that can't be apart: what is entered at several tasks, a WAIT
        with what leads there, as it is done where that ends, and a condition that asks how old a
        value is with what measures it."""
        joined: list[list[int]] = []
        for chain in chains:
            entries = self._entries(level, chain)
            stands = any(self.passages.stands(leaf) for leaf in entries)
            if joined and (len(entries) != 1 or stands):
                joined[-1] += chain
            else:
                joined.append(chain)
        number = {child: k for k, chain in enumerate(joined) for child in chain}
        until = list(range(len(joined)))
        measured: dict[str, set[int]] = {}
        for leaf, child in level.child_of.items():
            measures = self.flow.leaves[leaf].measures
            if measures is not None and child in number:
                measured.setdefault(measures, set()).add(number[child])
        for leaf, child in level.child_of.items():
            if child not in number:
                continue
            here = number[child]
            for condition in self.passages.asked(leaf):
                if condition.max_age is None:
                    continue
                if condition.object_id == self.flow.leaves[leaf].measures:
                    continue
                for there in measured.get(condition.object_id, ()):
                    if there == here or (group == NOWHERE and there > here):
                        continue
                    low, high = min(here, there), max(here, there)
                    until[low] = max(until[low], high)
                    self.reasons.append(
                        f"'{self.flow.leaves[leaf].name}' asks how old the value of checkpoint "
                        f"{condition.object_id} is: kept as written from its measurement on"
                    )
        result: list[list[int]] = []
        reach = -1
        for k, chain in enumerate(joined):
            if k <= reach:
                result[-1] += chain
            else:
                result.append(list(chain))
            reach = max(reach, until[k])
        return result

    def _unit(self, group: int, level: Level, chain: list[int], entry: int) -> Unit:
        """The unit of these children, which is entered at a leaf."""
        flow = self.flow
        if len(chain) == 1 and level.children[chain[0]] < 0:
            inner = -1 - level.children[chain[0]]
            found = self._circuit(inner, level, chain[0], entry)
            if isinstance(found, Circuit):
                return found
            name = flow.groups[inner].name
            self.reasons.append(f"group '{name}' is kept as written: {found}")
        inside = set(chain)
        exits = [e for e in level.edges if e.source in inside and e.target not in inside]
        final = exits[0].leaf if len(exits) == 1 and exits[0].tail else None
        if final is not None and (flow.leaves[final].conditional or self.passages.troubled(final)):
            final = None
        ends = [level.child_of[entry]]
        if final is not None and level.child_of[final] not in ends:
            ends.append(level.child_of[final])
        order = [ends[0], *(child for child in chain if child not in ends), *ends[1:]]
        by_child: dict[int, list[int]] = {}
        for leaf, child in level.child_of.items():
            by_child.setdefault(child, []).append(leaf)
        leaves = [leaf for child in order for leaf in by_child[child]]
        return TaskUnit(entry, tuple(leaves), final, group)

    def _circuit(self, group: int, around: Level, child: int, entry: int) -> Circuit | str:
        """The group as a circuit, or why it is none."""
        flow = self.flow.groups[group]
        if not flow.limited:
            return "only a condition or the time of a group around it ends it"
        if self.passages.stands(flow.start):
            return f"it begins with '{self.flow.leaves[flow.start].name}', which is done anywhere"
        if entry != flow.start:
            return f"it is entered at '{self.flow.leaves[entry].name}', not at its start"
        if any(edge.source == edge.target == child for edge in around.edges):
            return "it is entered again by its own end"
        if any(condition.max_age is not None for condition in flow.until):
            return "its `until` asks how old a value is"
        leaving = [
            edge.leaf
            for edge in around.edges
            if edge.source == child and not (edge.tail and edge.leaf == flow.last)
        ]
        if leaving:
            return f"'{self.flow.leaves[leaving[0]].name}' may leave it"
        before = set(self.passages.gates), list(self.reasons)
        level = self.passages.level(group)
        if level.broken is None:
            reached = reached_from(level.successors(level.edges), [level.child_of[flow.start]])
            if all(reached):
                return Circuit(group, self._units(group, level, flow.start))
        self.passages.gates, self.reasons = before
        return level.broken or "not all of it can be reached from its start"
