"""What each step of a flow takes: between which durations and energies, over all standings."""

import math
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass

from argo_compiler.analysis.flow import Flow
from argo_compiler.analysis.travel import Leg, NoWay, Standing, Travel
from argo_compiler.analysis.values import Paths
from argo_compiler.il import Mission

BEGIN = "begin"
"""the source of the first step"""
ANY = "any"
"""the source where many are not told apart"""
_STANDINGS = (
    4  # of one leaf that are told apart: from where a checkpoint is read depends on the way
)
_ROUNDS = 8  # over cuts that lead to cuts, before what they take is unbounded


@dataclass(frozen=True, slots=True)
class QuantityRange:
    """Between what a quantity lies, `most` perhaps infinite."""

    least: float
    most: float

    def __add__(self, other: "QuantityRange") -> "QuantityRange":
        return QuantityRange(self.least + other.least, self.most + other.most)

    def __or__(self, other: "QuantityRange") -> "QuantityRange":
        return QuantityRange(min(self.least, other.least), max(self.most, other.most))

    def times(self, count: float) -> "QuantityRange":
        """For as many of it; nothing, if none are."""
        if count <= 0:
            return NOTHING
        return QuantityRange(
            self.least * count if self.least else 0.0, self.most * count if self.most else 0.0
        )


NOTHING = QuantityRange(0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Cost:
    """What something takes."""

    time: QuantityRange
    """s"""
    energy: QuantityRange
    """Wh"""

    def __add__(self, other: "Cost") -> "Cost":
        return Cost(self.time + other.time, self.energy + other.energy)

    def __or__(self, other: "Cost") -> "Cost":
        return Cost(self.time | other.time, self.energy | other.energy)

    def times(self, count: float) -> "Cost":
        return Cost(self.time.times(count), self.energy.times(count))


FREE = Cost(NOTHING, NOTHING)

Source = int | tuple[str, int] | str
"""Where a step begins: after a leaf, BEGIN, ANY, ("cut", g) when the time of group g was up, or
("repeat", g) at the end of a round of it, whatever ended last."""


class Legs:
    """The steps of a mission without failures. Holds what was asked of the travel before.

    Without travel all steps are free.
    """

    def __init__(self, flow: Flow, paths: Paths, travel: Travel | None, mission: Mission) -> None:
        self.flow = flow
        self.paths = paths
        self.travel = travel
        self.blocked: dict[int, str] = {}
        """leaves that there is a standing without a way from, and why"""
        self.standings: list[list[Standing]] = [[] for _ in flow.leaves]
        self._steps: dict[tuple[Source, int], Cost] = {}
        self._cuts: dict[int, list[tuple[int, int]]] = {}
        self._into: list[Cost | None] = [None] * len(flow.leaves)
        self._work: dict[int, tuple[float, float]] = {}
        if travel is not None:
            self._spread(travel, mission)
            self._measure_cuts(travel.clean_up)
            self._join_repeats()
            for (_, target), cost in list(self._steps.items()):
                self._join(ANY, target, cost)

    def step(self, source: Source, target: int) -> Cost:
        """The way from a source to a leaf, and the leaf's action."""
        if self.travel is None or not self.flow.is_leaf(target):
            return FREE
        return self._steps.get((source, target), FREE)

    def steps(self) -> dict[object, list[tuple[object, float]]]:
        """What may come next after each leaf and each cut, and the least time (s) it takes."""
        following: dict[object, list[tuple[object, float]]] = {}
        cut_at: dict[int, list[int]] = {}
        for group, ways in self._cuts.items():
            for x in {x for x, _ in ways}:
                cut_at.setdefault(x, []).append(group)
        for (source, target), cost in self._steps.items():
            if isinstance(source, int) or (isinstance(source, tuple) and source[0] == "cut"):
                after = following.setdefault(source, [])
                after.append((target, cost.time.least))
                after += [(("cut", group), 0.0) for group in cut_at.get(target, ())]
        return following

    def last_clean_up(self, source: Source) -> float:
        """s at most until the mission has ended, if it ends after this source."""
        cut = isinstance(source, tuple) and source[0] == "cut"
        return self.travel.clean_up if cut and self.travel is not None else 0.0

    def _successors(self, leaf: int) -> Iterator[tuple[Source, int]]:
        """The leaves that may follow a leaf whose action ended, or was cut."""
        flow, paths = self.flow, self.paths
        for target in paths.targets(flow, leaf):
            yield from ((leaf, t) for t in self._resolve(target))
        group = flow.leaves[leaf].parent
        while group >= 0 and flow.timed[group]:
            if flow.groups[group].hard:
                yield from ((("cut", group), t) for t in self._onward(group))
            group = flow.groups[group].parent

    def _onward(self, group: int) -> tuple[int, ...]:
        return self._resolve(self.flow.groups[group].onward)

    def _resolve(self, node: int) -> tuple[int, ...]:
        """The leaves that a node leads to at once."""
        flow = self.flow
        found = []
        group = flow.group_of_round_end(node)
        while group is not None:
            if flow.groups[group].may_repeat:
                found.append(flow.groups[group].start)
            if not flow.groups[group].may_end:
                return tuple(found)
            node = flow.groups[group].onward
            group = flow.group_of_round_end(node)
        if flow.is_leaf(node):
            found.append(node)
        return tuple(found)

    def _spread(self, travel: Travel, mission: Mission) -> None:
        """Where the robot may stand after each leaf, and the steps between."""
        flow = self.flow
        if not flow.is_leaf(flow.initial):
            return
        pending: deque[tuple[int, Standing]] = deque()
        first = travel.start(mission)
        self._walk(travel, BEGIN, first, flow.initial, flow.start_velocity, pending)
        after: list[list[tuple[Source, int]] | None] = [None] * len(flow.leaves)
        while pending:
            leaf, standing = pending.popleft()
            ways = after[leaf]
            if ways is None:
                ways = after[leaf] = list(dict.fromkeys(self._successors(leaf)))
            for source, target in ways:
                if source == leaf:
                    velocity = flow.leaves[leaf].leaf.task.velocity
                    self._walk(travel, leaf, standing, target, velocity, pending)
                else:
                    assert isinstance(source, tuple)
                    self._cuts.setdefault(source[1], []).append((leaf, target))
                    velocity = flow.leaves[leaf].leaf.task.velocity
                    self._walk(travel, None, standing, target, velocity, pending, cut_at=leaf)

    def _walk(
        self,
        travel: Travel,
        source: Source | None,
        standing: Standing,
        target: int,
        velocity: float | None,
        pending: deque[tuple[int, Standing]],
        cut_at: int | None = None,
    ) -> None:
        leg = travel.leg(standing, self.flow.leaves[target].leaf.task, velocity)
        if isinstance(leg, NoWay):
            self.blocked.setdefault(target, leg.reason)
            leg = Leg(0.0, 0.0, standing)
        cost = Cost(
            QuantityRange(leg.duration, leg.duration), QuantityRange(leg.energy, leg.energy)
        )
        work = self._work.get(target, (math.inf, math.inf))
        self._work[target] = min(work[0], leg.work), min(work[1], leg.work_energy)
        self._join(_rest(cut_at) if source is None else source, target, cost)
        if source is not None:
            into = self._into[target]
            self._into[target] = cost if into is None else into | cost
        there = self.standings[target]
        if leg.arrival not in there and len(there) < _STANDINGS:
            there.append(leg.arrival)
            pending.append((target, leg.arrival))

    def _join(self, source: Source, target: int, cost: Cost) -> None:
        known = self._steps.get((source, target))
        self._steps[source, target] = cost if known is None else known | cost

    def _join_repeats(self) -> None:
        """The steps from the end of a round to the next one."""
        flow = self.flow
        ends: list[tuple[Source, int]] = [
            (i, leaf.tail)
            for i, leaf in enumerate(flow.leaves)
            if self.paths.reached(i) and self.paths.tail_possible(flow, i)
        ]
        ends += [(("cut", g), flow.groups[g].onward) for g in self._cuts]
        for source, node in ends:
            group = flow.group_of_round_end(node)
            while group is not None:
                start = flow.groups[group].start
                if (source, start) in self._steps:
                    self._join(("repeat", group), start, self._steps[source, start])
                group = flow.group_of_round_end(flow.groups[group].onward)

    def _measure_cuts(self, clean_up: float) -> None:
        """What the way takes from wherever the time of a group was up.

        The robot was on its way to a leaf x, or at its action: it could have gone on there and then
        to the target, so the rest of that step and the way from x are enough, after cleaning up. It
        may almost be there, so the target's action is the least.
        """
        most = {i: cost for i, cost in enumerate(self._into) if cost is not None}
        for attempt in range(_ROUNDS):
            changed = False
            for group, ways in self._cuts.items():
                for x, target in set(ways):
                    if x not in most:
                        continue
                    time, energy = most[x].time.most, most[x].energy.most
                    if x != target:
                        onward = self._steps[_rest(x), target]
                        time, energy = time + onward.time.most, energy + onward.energy.most
                    if attempt == _ROUNDS - 1:
                        time = energy = math.inf
                    work, work_energy = self._work[target]
                    rest = Cost(
                        QuantityRange(min(work, time), time),
                        QuantityRange(min(work_energy, energy), energy),
                    )
                    into = most.get(target)
                    joined = rest if into is None else into | rest
                    changed = changed or joined != into
                    most[target] = joined
                    waited = Cost(QuantityRange(0.0, clean_up), NOTHING)
                    self._join(("cut", group), target, rest + waited)
            if not changed:
                return


def _rest(leaf: int | None) -> tuple[str, int]:
    """The key of the way from a leaf at which the time was up."""
    assert leaf is not None
    return ("rest", leaf)
