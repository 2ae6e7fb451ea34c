"""What of a mission may change places: the tasks that every way through it passes.

A mission, and each round of a group, is a chain of units. Between two units lies nothing: what is
done only in some cases belongs to the unit before it, and stays as it is written.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from argo_compiler.analysis.flow import NOWHERE, Flow
from argo_compiler.analysis.graph import components, is_loop, leading_to, reached_from
from argo_compiler.errors import ArgoError
from argo_compiler.hfsm.lower import lower
from argo_compiler.il import Action, Mission


@dataclass(frozen=True)
class Stop:
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


Unit = Stop | Circuit


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

    def name(self, leaf: int) -> str:
        return self.flow.leaves[leaf].name


def find_spine(mission: Mission) -> Spine:
    """The units of a mission.

    Raises:
        DiagnosticError: `check` finds errors in the mission.
        ArgoError: a task can't be reached, or nothing leads to the mission's end.
    """
    return _Finder(mission).spine()


def stops_of(units: Sequence[Unit]) -> Iterator[Stop]:
    """All stops, those in circuits included, in their order."""
    for unit in units:
        if isinstance(unit, Stop):
            yield unit
        else:
            yield from stops_of(unit.inside)


def leaves_of(unit: Unit) -> Iterator[int]:
    """All leaves of a unit."""
    for stop in stops_of((unit,)):
        yield from stop.leaves


@dataclass(frozen=True)
class _Edge:
    """From one child of a level to another, or to its end."""

    source: int
    target: int
    leaf: int
    """that the way leads from"""
    entry: int | None
    """the leaf that it leads to; None: the end of the level"""
    tail: bool
    """whether it is the leaf's unconditional transition"""
    early: bool = False
    """whether it may be one that ends the mission early"""


@dataclass
class _Level:
    """The mission, or one round of a group: its tasks and groups, and the ways between them."""

    children: list[int]
    """leaves, and groups as -1 - number"""
    child_of: dict[int, int]
    edges: list[_Edge] = field(default_factory=list)
    broken: str | None = None
    """why it is no chain of units"""

    @property
    def sink(self) -> int:
        return len(self.children)

    def successors(self, edges: Sequence[_Edge]) -> list[list[int]]:
        following: list[list[int]] = [[] for _ in range(len(self.children) + 1)]
        for edge in edges:
            following[edge.source].append(edge.target)
        return following


class _Finder:
    """The tables over one mission. Collects gates and reasons."""

    def __init__(self, mission: Mission) -> None:
        self.mission = mission
        self.flow = flow = Flow.of(lower(mission), mission)
        names = {task.name for task in mission.tasks}
        self.own = [i for i, leaf in enumerate(flow.leaves) if leaf.name in names]
        self.end = self._find_end()
        self.apart: set[int] = set()
        self.gates: set[tuple[int, int]] = set()
        self.reasons: list[str] = []

    def spine(self) -> Spine:
        self._require_reachable()
        if not self.own or self.end == self.flow.initial:
            units: tuple[Unit, ...] = ()
        else:
            level = self._level(NOWHERE)
            self._set_apart(level)
            if level.broken:
                raise ArgoError(f"the order of this mission can't be changed: {level.broken}")
            units = self._units(NOWHERE, level, self.flow.initial)
        return Spine(
            self.flow,
            units,
            self.end,
            frozenset(self.apart),
            frozenset(self.gates),
            tuple(dict.fromkeys(self.reasons)),
        )

    def _find_end(self) -> int | None:
        """The drive into the mission's docking station that ends it."""
        for i in reversed(self.own):
            leaf = self.flow.leaves[i]
            task = leaf.leaf.task
            docks = task.action is Action.WAYPOINT and task.pose == self.mission.dock
            if docks and leaf.parent == NOWHERE and not leaf.conditional:
                return i if leaf.tail == self.flow.done else None
        return None

    def _require_reachable(self) -> None:
        flow = self.flow
        following: list[list[int]] = [[] for _ in range(flow.size)]
        for i, leaf in enumerate(flow.leaves):
            following[i] = [target for _, target in leaf.conditional] + [leaf.tail]
            if leaf.parent >= 0:
                following[i].append(flow.time_up(leaf.parent))
        for g, group in enumerate(flow.groups):
            following[flow.round_end(g)].append(group.start)
            if group.may_end:
                following[flow.round_end(g)].append(group.onward)
            if group.hard:
                following[flow.time_up(g)].append(group.onward)
            if group.parent >= 0:
                following[flow.time_up(g)].append(flow.time_up(group.parent))
        reached = reached_from(following, [flow.initial])
        for i in self.own:
            if not reached[i]:
                raise ArgoError(
                    f"no way leads to task '{flow.leaves[i].name}', so there is no place for it in "
                    "an order: remove it, or lead a transition to it (`argo check` says more)"
                )
        if not reached[flow.done]:
            raise ArgoError("nothing leads to the end of this mission: see `argo check`")

    # ---- the graph of a level

    def _level(self, group: int) -> _Level:
        """The graph of the mission (NOWHERE) or of a round of a group."""
        flow = self.flow
        children: list[int] = []
        child_of: dict[int, int] = {}
        for i in self.own:
            child: int | None = i
            at = flow.leaves[i].parent
            while at not in (group, NOWHERE):
                child, at = -1 - at, flow.groups[at].parent
            if at != group:
                continue
            assert child is not None
            if not children or children[-1] != child:
                children.append(child)
            child_of[i] = len(children) - 1
        level = _Level(children, child_of)
        for leaf in child_of:
            if leaf != self.end:
                self._add_edges(level, group, leaf)
        for inner, within in enumerate(flow.groups):
            # Groups come before those that lie in them.
            if inner > group and within.may_end and within.last in child_of:
                direct = inner if within.parent == group else None
                number = child_of[within.last]
                self._add_edge(level, group, number, within.last, within.onward, True, direct)
        level.edges = self._without_early_ends(level)
        ends = leading_to(level.successors(level.edges), [level.sink])
        if group != NOWHERE and not all(ends):
            stuck = children[ends.index(False)]
            level.broken = f"'{self._name(stuck)}' does not lead to the end of a round"
        return level

    def _name(self, child: int) -> str:
        return self.flow.leaves[child].name if child >= 0 else self.flow.groups[-1 - child].name

    def _add_edges(self, level: _Level, group: int, leaf: int) -> None:
        flow = self.flow
        number = level.child_of[leaf]
        for _, target in flow.leaves[leaf].conditional:
            self._add_edge(level, group, number, leaf, target, False, None)
        tail = flow.leaves[leaf].tail
        ended = flow.group_of_round_end(tail)
        if ended is None or ended == group:
            self._add_edge(level, group, number, leaf, tail, True, None)

    def _add_edge(
        self,
        level: _Level,
        group: int,
        number: int,
        leaf: int,
        target: int,
        tail: bool,
        through: int | None,
    ) -> None:
        """A way from a leaf of a child to a node; `through`: by the end of that group."""
        flow = self.flow
        if target in level.child_of and target != self.end:
            there = level.child_of[target]
            inside = there == number and level.children[number] < 0 and through is None
            if not inside:
                level.edges.append(_Edge(number, there, leaf, target, tail))
        elif target == self.end:
            if group == NOWHERE:
                level.edges.append(_Edge(number, level.sink, leaf, None, tail, not tail))
            elif tail:
                level.broken = f"'{flow.leaves[leaf].name}' leaves it"
            else:
                self.gates.add((leaf, target))
        elif target == flow.done:
            branches = bool(flow.leaves[leaf].conditional)
            if group == NOWHERE and self.end is None:
                level.edges.append(_Edge(number, level.sink, leaf, None, tail, branches))
            else:
                self.gates.add((leaf, target))
        elif group != NOWHERE and target == flow.round_end(group):
            level.edges.append(_Edge(number, level.sink, leaf, None, tail))
        elif flow.group_of_round_end(target) is not None:
            pass  # that of a group around, which has its own way on
        elif target in self.apart:
            self.gates.add((leaf, target))
        else:
            level.broken = f"'{flow.leaves[leaf].name}' leaves it"

    def _without_early_ends(self, level: _Level) -> list[_Edge]:
        """The edges without those that only end the mission early, if it goes on else."""
        lasting = [edge for edge in level.edges if not edge.early]
        goes_on = leading_to(level.successors(lasting), [level.sink])
        kept = []
        for edge in level.edges:
            if edge.early and goes_on[edge.source]:
                self.gates.add((edge.leaf, self.flow.done if self.end is None else self.end))
            else:
                kept.append(edge)
        return kept

    def _set_apart(self, level: _Level) -> None:
        """Takes out of the mission's level what does not lead to its usual end."""
        ends = leading_to(level.successors(level.edges), [level.sink])
        last = None if self.end is None else level.child_of[self.end]
        out = {k for k in range(len(level.children)) if not ends[k] and k != last}
        self.apart = {leaf for leaf, k in level.child_of.items() if k in out}
        self.gates = {(leaf, node) for leaf, node in self.gates if leaf not in self.apart}
        for edge in level.edges:
            if edge.target in out and edge.source not in out and edge.entry is not None:
                self.gates.add((edge.leaf, edge.entry))
        if level.child_of[self.flow.initial] in out:
            level.broken = "it does not always come to its docking station"
        for leaf in self.apart:
            for conditions, _ in self.flow.leaves[leaf].conditional:
                if any(condition.max_age is not None for condition in conditions):
                    name = self.flow.leaves[leaf].name
                    level.broken = f"'{name}', with which it may end early, asks how old a value is"
        level.edges = [e for e in level.edges if e.source not in out and e.target not in out]

    # ---- the units of a level

    def _units(self, group: int, level: _Level, entry: int) -> tuple[Unit, ...]:
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

    def _explain_loop(self, level: _Level, part: Sequence[int]) -> None:
        names = [f"'{self._name(level.children[child])}'" for child in sorted(part)]
        what = names[0] if len(names) == 1 else f"{names[0]} to {names[-1]}"
        self.reasons.append(
            f"{what} may be done again by a condition: kept as written, and reckoned once"
        )

    def _entries(self, level: _Level, chain: Sequence[int]) -> set[int]:
        """The leaves at which a chain is entered from outside."""
        inside = set(chain)
        return {
            edge.entry
            for edge in level.edges
            if edge.target in inside and edge.source not in inside and edge.entry is not None
        }

    def _joined(self, level: _Level, group: int, chains: list[list[int]]) -> list[list[int]]:
        """The chains, those made one that can't be apart: what is entered at several tasks, and a
        condition that asks how old a value is with what measures it."""
        joined: list[list[int]] = []
        for chain in chains:
            if joined and len(self._entries(level, chain)) != 1:
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
            for conditions, _ in self.flow.leaves[leaf].conditional:
                for condition in conditions:
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

    def _unit(self, group: int, level: _Level, chain: list[int], entry: int) -> Unit:
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
        if final is not None and flow.leaves[final].conditional:
            final = None
        ends = [level.child_of[entry]]
        if final is not None and level.child_of[final] not in ends:
            ends.append(level.child_of[final])
        order = [ends[0], *(child for child in chain if child not in ends), *ends[1:]]
        by_child: dict[int, list[int]] = {}
        for leaf, child in level.child_of.items():
            by_child.setdefault(child, []).append(leaf)
        leaves = [leaf for child in order for leaf in by_child[child]]
        return Stop(entry, tuple(leaves), final, group)

    def _circuit(self, group: int, around: _Level, child: int, entry: int) -> Circuit | str:
        """The group as a circuit, or why it is none."""
        flow = self.flow.groups[group]
        if not flow.may_end:
            return "only a condition or the time of a group around it ends it"
        if entry != flow.start:
            return f"it is entered at '{self.flow.leaves[entry].name}', not at its start"
        if any(edge.source == edge.target == child for edge in around.edges):
            return "it is entered again by its own end"
        leaving = [
            edge.leaf
            for edge in around.edges
            if edge.source == child and not (edge.tail and edge.leaf == flow.last)
        ]
        if leaving:
            return f"'{self.flow.leaves[leaving[0]].name}' may leave it"
        before = set(self.gates), list(self.reasons)
        level = self._level(group)
        if level.broken is None:
            reached = reached_from(level.successors(level.edges), [level.child_of[flow.start]])
            if all(reached):
                return Circuit(group, self._units(group, level, flow.start))
        self.gates, self.reasons = before
        return level.broken or "not all of it can be reached from its start"
