"""Units of a mission that an order may rearrange: the tasks that every execution path passes.

A mission, and each round of a group, is a chain of units. Nothing lies between two units: tasks
that are done only in some cases belong to the unit before them, and stay as they are written.

A leaf is a state of the mission's state machine that executes one task; leaves are named by their
numbers in the flow (see `argo_compiler.analysis.flow`).
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from argo_compiler.analysis.flow import NOWHERE, Flow
from argo_compiler.base.errors import Invalid
from argo_compiler.base.graphs import components, is_loop, reachable_from
from argo_compiler.base.message import Message
from argo_compiler.il import Condition, Mission
from argo_compiler.reorder.task_graph import Level, TaskGraph


@dataclass(frozen=True)
class TaskUnit:
    """Task with all tasks that may be done between it and the next unit, as leaves of the flow."""

    entry: int
    """the leaf of the task that is always done first"""
    leaves: tuple[int, ...]
    """in the order of the mission's list, but with `entry` first and `final` last"""
    final: int | None
    """the only leaf from which the unit is left, and without a condition; None if there is none"""
    level: int
    """number of the innermost group around the unit, or NOWHERE"""


@dataclass(frozen=True)
class GroupUnit:
    """Group that is entered only at its start, and left only at its end."""

    group: int
    """number of the group in the flow"""
    inside: tuple["Unit", ...]


Unit = TaskUnit | GroupUnit


@dataclass(frozen=True)
class UnitChain:
    """Mission as a chain of units, in the written order."""

    flow: Flow
    units: tuple[Unit, ...]
    end: int | None
    """leaf that always ends the mission: the drive into the docking station; None if none"""
    detached: frozenset[int]
    """leaves that lead only to an early end of the mission; they keep their positions"""
    early_exits: frozenset[tuple[int, int]]
    """transitions that end the mission early: a leaf and the node that it leads to"""
    reasons: tuple[str, ...]
    """reasons why parts stay as they are written, for users"""
    conditions_checked_after: Mapping[int, tuple[Condition, ...]]
    """by leaf, the conditions that are checked when it ends"""
    before: tuple[tuple[str, str], ...] = ()
    """pairs of task names: the first comes before the second, as the mission requires"""

    def name(self, leaf: int) -> str:
        return self.flow.leaves[leaf].name


def find_unit_chain(mission: Mission) -> UnitChain:
    """Return the units of a mission.

    Raises:
        DiagnosticError: `check` finds errors in the mission.
        ArgoError: a task can't be reached, or nothing leads to the mission's end.
    """
    return _Finder(mission).chain()


def task_units_in(units: Sequence[Unit]) -> Iterator[TaskUnit]:
    """Yield all task units in order, including those in group units."""
    for unit in units:
        if isinstance(unit, TaskUnit):
            yield unit
        else:
            yield from task_units_in(unit.inside)


class _Finder:
    """Search for the units of one mission. Collects the reasons why parts stay as written."""

    def __init__(self, mission: Mission) -> None:
        self.before = mission.before
        self.graph = TaskGraph(mission)
        self.flow = self.graph.flow
        self.reasons: list[str] = []

    def chain(self) -> UnitChain:
        graph = self.graph
        graph.require_reachable()
        units: tuple[Unit, ...] = ()
        if graph.own_leaves and graph.end != self.flow.initial:
            level = graph.level(NOWHERE)
            graph.detach_early_end_tasks(level)
            if level.chain_error:
                raise Invalid(
                    Message(
                        "the order of this mission can't be changed: {chain_error}",
                        chain_error=level.chain_error,
                    )
                )
            units = self._units(NOWHERE, level, self.flow.initial)
        return UnitChain(
            self.flow,
            units,
            graph.end,
            frozenset(graph.detached),
            frozenset(graph.early_exits),
            tuple(dict.fromkeys(self.reasons)),
            {leaf: tuple(graph.conditions_checked_after(leaf)) for leaf in graph.own_leaves},
            self.before,
        )

    def _units(self, group: int, level: Level, entry: int) -> tuple[Unit, ...]:
        """Return the units of a level in the written order. Each is entered at one leaf.

        `entry` is the leaf at which the level is entered.
        """
        successors = level.successors(level.edges)
        reached = reachable_from(successors, [level.child_of[entry]])
        parts = [part for part in reversed(components(successors)) if reached[part[0]]]
        position = {child: k for k, part in enumerate(parts) for child in part}
        # A unit starts at each part that no edge passes over.
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
        chains = self._joined_chains(level, group, chains)
        units = []
        for number, chain in enumerate(chains):
            entries = self._entries(level, chain) if number else {entry}
            units.append(self._unit(group, level, sorted(chain), min(entries)))
        return tuple(units)

    def _explain_loop(self, level: Level, part: Sequence[int]) -> None:
        names = [f"'{self.graph.name(level.children[child])}'" for child in sorted(part)]
        what = (
            names[0]
            if len(names) == 1
            else Message("{name} to {name_2}", name=names[0], name_2=names[-1])
        )
        self.reasons.append(
            Message(
                "{what} may be done again by a condition: kept as written, and counted once",
                what=what,
            )
        )

    def _entries(self, level: Level, chain: Sequence[int]) -> set[int]:
        """Return the leaves at which a chain is entered from outside it.

        A chain is here a list of a level's children.
        """
        inside = set(chain)
        return {
            edge.entry
            for edge in level.edges
            if edge.target in inside and edge.source not in inside and edge.entry is not None
        }

    def _joined_chains(self, level: Level, group: int, chains: list[list[int]]) -> list[list[int]]:
        """Return the chains, joined where two of them must stay together.

        A chain with several entries joins the chain before it. So does a WAIT, which takes place
        where the previous task ends. A condition on the age of a value is joined with the
        measurement of that value and all chains between them.
        """
        joined: list[list[int]] = []
        for chain in chains:
            entries = self._entries(level, chain)
            starts_with_wait = any(self.graph.is_wait(leaf) for leaf in entries)
            if joined and (len(entries) != 1 or starts_with_wait):
                joined[-1] += chain
            else:
                joined.append(chain)
        number = {child: k for k, chain in enumerate(joined) for child in chain}
        joined_until = list(range(len(joined)))
        measured: dict[str, set[int]] = {}
        for leaf, child in level.child_of.items():
            measures = self.flow.leaves[leaf].measures
            if measures is not None and child in number:
                measured.setdefault(measures, set()).add(number[child])
        for leaf, child in level.child_of.items():
            if child not in number:
                continue
            here = number[child]
            for condition in self.graph.conditions_checked_after(leaf):
                if condition.max_age is None:
                    continue
                if condition.object_id == self.flow.leaves[leaf].measures:
                    continue
                for there in measured.get(condition.object_id, ()):
                    if there == here or (group == NOWHERE and there > here):
                        continue
                    low, high = min(here, there), max(here, there)
                    joined_until[low] = max(joined_until[low], high)
                    self.reasons.append(
                        Message(
                            "'{leave}' checks the age of the value of checkpoint {object_id}: "
                            "kept as written from its measurement on",
                            leave=self.flow.leaves[leaf].name,
                            object_id=condition.object_id,
                        )
                    )
        result: list[list[int]] = []
        reach = -1
        for k, chain in enumerate(joined):
            if k <= reach:
                result[-1] += chain
            else:
                result.append(list(chain))
            reach = max(reach, joined_until[k])
        return result

    def _unit(self, group: int, level: Level, chain: list[int], entry: int) -> Unit:
        """Return the unit of these children, which is entered at the leaf `entry`."""
        flow = self.flow
        if len(chain) == 1 and level.children[chain[0]] < 0:
            inner = -1 - level.children[chain[0]]
            unit_or_reason = self._group_unit(inner, level, chain[0], entry)
            if isinstance(unit_or_reason, GroupUnit):
                return unit_or_reason
            name = flow.groups[inner].name
            self.reasons.append(
                Message(
                    "group '{name}' is kept as written: {unit_or_reason}",
                    name=name,
                    unit_or_reason=unit_or_reason,
                )
            )
        inside = set(chain)
        exits = [e for e in level.edges if e.source in inside and e.target not in inside]
        final = exits[0].leaf if len(exits) == 1 and exits[0].tail else None
        if final is not None and (
            flow.leaves[final].conditional or self.graph.leaves_after_failure_or_miss(final)
        ):
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

    def _group_unit(self, group: int, around: Level, child: int, entry: int) -> GroupUnit | str:
        """Return the group as a group unit, or the reason why it is none."""
        flow = self.flow.groups[group]
        if not flow.has_round_or_time_limit:
            return Message("only a condition or the time of a group around it ends it")
        if self.graph.is_wait(flow.start):
            return Message(
                "it starts with '{leave}', which is done anywhere",
                leave=self.flow.leaves[flow.start].name,
            )
        if entry != flow.start:
            return Message(
                "it is entered at '{leave}', not at its start", leave=self.flow.leaves[entry].name
            )
        if any(edge.source == edge.target == child for edge in around.edges):
            return Message("it is entered again by its own end")
        if any(condition.max_age is not None for condition in flow.until):
            return Message("its `until` checks the age of a value")
        leaving = [
            edge.leaf
            for edge in around.edges
            if edge.source == child and not (edge.tail and edge.leaf == flow.last)
        ]
        if leaving:
            return Message("'{leave}' may leave it", leave=self.flow.leaves[leaving[0]].name)
        backup = set(self.graph.early_exits), list(self.reasons)
        level = self.graph.level(group)
        if level.chain_error is None:
            reached = reachable_from(level.successors(level.edges), [level.child_of[flow.start]])
            if all(reached):
                return GroupUnit(group, self._units(group, level, flow.start))
        self.graph.early_exits, self.reasons = backup
        return level.chain_error or Message("not all of it can be reached from its start")
