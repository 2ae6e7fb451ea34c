"""What each step of a flow takes: between which durations and energies, over all standings."""

import math
from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from argo_compiler.analysis.flow import Flow
from argo_compiler.analysis.travel import Leg, NoWay, Standing, Travel
from argo_compiler.analysis.values import Paths
from argo_compiler.base.graphs import components
from argo_compiler.il import Mission, Task

BEGIN = "begin"
"""the source of the first step"""
ANY = "any"
"""the source where many are not told apart"""
_STANDINGS = (
    4  # of one leaf that are told apart: from where a checkpoint is read depends on the way
)
_WAITING_PLACES = 64  # of one wait, likewise


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
        if self is FREE:
            return other
        return Cost(self.time + other.time, self.energy + other.energy)

    def __or__(self, other: "Cost") -> "Cost":
        return Cost(self.time | other.time, self.energy | other.energy)

    def times(self, count: float) -> "Cost":
        return Cost(self.time.times(count), self.energy.times(count))


FREE = Cost(NOTHING, NOTHING)
_UNLIMITED = Cost(QuantityRange(0.0, math.inf), QuantityRange(0.0, math.inf))

Source = int | tuple[str, int] | str
"""Where a step begins: after a leaf, BEGIN, ANY, ("cut", g) when the time of group g was up,
("missed", i) when the window of leaf i was over, or ("repeat", g) at the end of a round of g,
whatever ended last."""


@dataclass(frozen=True, slots=True)
class Whereabouts:
    """Where the robot is: at a standing, or somewhere on its way to it."""

    standing: Standing
    on_way_to: int | None = None
    """the leaf whose action was cancelled on the way; None: it stands there"""


class Legs:
    """The steps of a mission. Holds what was asked of the travel before.

    Without travel all steps are free. If the paths have failures, any action may fail, at the
    latest when it would have been done, and is tried again as its task says. Then only what a step
    takes at most is right, and where a failed action has left the robot is known less well: between
    two places of the plan of which one follows the other.
    """

    def __init__(self, flow: Flow, paths: Paths, travel: Travel | None, mission: Mission) -> None:
        self.flow = flow
        self.paths = paths
        self.travel = travel
        self.blocked: dict[int, str] = {}
        """leaves that there is a standing without a way from, and why"""
        self.places: list[list[Whereabouts]] = [[] for _ in flow.leaves]
        """where the robot may be after each leaf"""
        self.too_slow: dict[int, float] = {}
        """leaves that can't be done within their time limit, and what they take (s) at least"""
        self.too_many = False
        """whether there are waits at more places than are told apart"""
        self.standing_power = 0.0 if travel is None else travel.standing_power
        self._steps: dict[tuple[Source, int], Cost] = {}
        self._before: list[list[Whereabouts]] = [[] for _ in flow.leaves]
        """where it may be before each leaf, as far as that matters for what follows"""
        self._origins: list[dict[Standing, None]] = [{} for _ in flow.leaves]
        """where it may stand before each leaf that it goes to from there"""
        self._cuts: dict[Source, dict[tuple[int, int], None]] = {}
        """for each source, the leaf that the robot was on the way to, and the one that follows"""
        self._work: dict[int, Cost] = {}
        self._round_starts = frozenset(g.start for g in flow.groups if g.every)
        self._pending: deque[tuple[int, Whereabouts, bool]] = deque()
        if travel is not None:
            self._spread(travel, mission)
            self._measure_cuts(travel)
            self._join_repeats()
            self._compare_limits()
            if paths.failures:
                self._try_again(travel.clean_up)
            for (_, target), cost in list(self._steps.items()):
                self._join(ANY, target, cost)

    def step(self, source: Source, target: int) -> Cost:
        """The way from a source to a leaf, and the leaf's action, whenever its turn comes."""
        cost = self.way(source, target)
        if self.travel is None or not self.flow.is_leaf(target):
            return cost
        earliest = self.flow.leaves[target].earliest
        if not earliest:
            return cost
        most = max(cost.time.most, earliest + self.work(target).time.most)
        waiting = QuantityRange(0.0, self.standing_power * earliest / 3600)
        return Cost(QuantityRange(cost.time.least, most), cost.energy + waiting)

    def way(self, source: Source, target: int) -> Cost:
        """The same, if the robot does not have to wait at the place."""
        if not self.flow.is_leaf(target):
            return FREE
        if self.travel is None:
            return _UNLIMITED
        return self._steps.get((source, target), FREE)

    def missing(self, source: Source, target: int) -> Cost:
        """What passes from a source until the hard window of a leaf is over."""
        cost = self.step(source, target)
        deadline = self.flow.leaves[target].deadline
        assert deadline is not None
        return Cost(
            QuantityRange(0.0, min(cost.time.most, deadline)), QuantityRange(0.0, cost.energy.most)
        )

    def work(self, leaf: int) -> Cost:
        """What the action of a leaf takes at its place."""
        return self._work.get(leaf, FREE)

    def steps(self) -> dict[object, list[tuple[object, float]]]:
        """What may come next after each leaf and each cut, and the least time (s) it takes."""
        following: dict[object, list[tuple[object, float]]] = {}
        for (source, target), cost in self._steps.items():
            if isinstance(source, str) or (not isinstance(source, int) and source[0] == "repeat"):
                continue
            after = following.setdefault(source, [])
            after.append((target, cost.time.least))
            # It may be cancelled as soon as it is begun.
            after += [(cut, 0.0) for cut, _ in self._cut_ways(target)]
        return following

    def last_clean_up(self, source: Source) -> float:
        """s at most until the mission has ended, if it ends after this source."""
        if self.travel is None or isinstance(source, str):
            return 0.0
        if isinstance(source, int):
            cancelled = any(place.on_way_to is not None for place in self.places[source])
        else:
            cancelled = source[0] in ("cut", "missed")
        return self.travel.clean_up if cancelled else 0.0

    def _successors(self, leaf: int) -> Iterator[tuple[Source, int]]:
        """The leaves that may follow a leaf that has ended, or was cancelled."""
        for target in self.paths.targets(self.flow, leaf):
            yield from ((leaf, t) for t in self._resolve(target))
        yield from self._cut_ways(leaf)

    def _cut_ways(self, leaf: int) -> Iterator[tuple[Source, int]]:
        """The leaves that may follow a leaf whose time was up."""
        flow = self.flow
        group = flow.leaves[leaf].parent
        while group >= 0 and flow.timed[group]:
            if flow.groups[group].hard:
                for t in self._resolve(flow.groups[group].onward):
                    yield ("cut", group), t
            group = flow.groups[group].parent
        for target in self.paths.after_missing(flow, leaf):
            for t in self._resolve(target):
                yield ("missed", leaf), t

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
        """Where the robot may be after each leaf, and the steps between."""
        flow = self.flow
        if not flow.is_leaf(flow.initial):
            return
        self._walk(travel, BEGIN, Whereabouts(travel.start(mission)), flow.initial)
        ended: list[list[tuple[Source, int]] | None] = [None] * len(flow.leaves)
        while self._pending:
            leaf, place, before = self._pending.popleft()
            ways = ended[leaf]
            if ways is None:
                ways = ended[leaf] = list(dict.fromkeys(self._successors(leaf)))
            for source, target in ways:
                if source != leaf:
                    at = place if before else Whereabouts(place.standing, leaf)
                    self._walk(travel, source, at, target)
                elif not before or flow.leaves[leaf].wait is not None:
                    self._walk(travel, source, place, target)
                    if self.paths.failures and not before:
                        self._walk(travel, source, Whereabouts(place.standing, leaf), target)

    def _walk(self, travel: Travel, source: Source, place: Whereabouts, target: int) -> None:
        leaf = self.flow.leaves[target]
        if leaf.wait is not None:
            self._join(source, target, self._waiting(target))
            self._work[target] = FREE
            if self._note(self._before[target], place, target, before=True):
                self.places[target].append(place)
            return
        task = leaf.leaf.task
        leg = travel.leg(place.standing, task, task.velocity)
        if isinstance(leg, NoWay):
            self.blocked.setdefault(target, leg.reason)
            leg = Leg(0.0, 0.0, place.standing)
        if place.on_way_to is None:
            self._join(source, target, _cost(leg))
            self._origins[target].setdefault(place.standing)
        else:
            self._cuts.setdefault(source, {})[place.on_way_to, target] = None
        work = Cost(
            QuantityRange(leg.work, leg.work), QuantityRange(leg.work_energy, leg.work_energy)
        )
        known = self._work.get(target)
        self._work[target] = work if known is None else known | work
        if place.on_way_to is not None or leaf.deadline is not None or target in self._round_starts:
            # It may be cancelled before it is begun.
            self._note(self._before[target], place, target, before=True)
        self._note(self.places[target], Whereabouts(leg.arrival), target, before=False)

    def _note(
        self, known: list[Whereabouts], place: Whereabouts, leaf: int, *, before: bool
    ) -> bool:
        """Whether a place is a new one; it is gone on from then."""
        if place in known:
            return False
        if len(known) >= (_WAITING_PLACES if before else _STANDINGS):
            self.too_many = self.too_many or before
            return False
        known.append(place)
        self._pending.append((leaf, place, before))
        return True

    def _waiting(self, leaf: int) -> Cost:
        """What a WAIT takes, its window apart."""
        rule = self.flow.leaves[leaf].wait
        assert rule is not None
        if rule.duration is not None:
            time = QuantityRange(rule.duration, rule.duration)
        else:
            time = QuantityRange(0.0, math.inf if rule.limit is None else rule.limit)
        # At a dock it takes nothing from the battery.
        energy = self.standing_power * time.most / 3600 if self.standing_power else 0.0
        return Cost(time, QuantityRange(0.0, energy))

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
        ends += [
            (("missed", i), leaf.tail)
            for i, leaf in enumerate(flow.leaves)
            if leaf.deadline is not None
        ]
        ends += [(("cut", i), group.onward) for i, group in enumerate(flow.groups) if group.hard]
        for source, node in ends:
            group = flow.group_of_round_end(node)
            while group is not None:
                start = flow.groups[group].start
                if (source, start) in self._steps:
                    self._join(("repeat", group), start, self._steps[source, start])
                group = flow.group_of_round_end(flow.groups[group].onward)

    def _compare_limits(self) -> None:
        fastest: dict[int, float] = {}
        for (_, target), cost in self._steps.items():
            fastest[target] = min(fastest.get(target, math.inf), cost.time.least)
        for target, taken in fastest.items():
            leaf = self.flow.leaves[target]
            limit = leaf.leaf.task.time_limit
            # The time before `earliest` does not count, so the robot may have arrived by then.
            counted = self.work(target).time.least if leaf.earliest else taken
            if limit is not None and counted > limit:
                self.too_slow[target] = counted

    def _try_again(self, clean_up: float) -> None:
        """The steps with all attempts, each as long as the first one at most."""
        longest: dict[int, Cost] = {}
        for (source, target), cost in self._steps.items():
            leaf = self.flow.leaves[target]
            if leaf.wait is not None:
                continue
            task = leaf.leaf.task
            attempt = cost.time.most
            if task.time_limit is not None:
                attempt = min(attempt, task.time_limit + clean_up)
            tries = task.retries + 1
            spent = Cost(
                QuantityRange(0.0, (attempt + clean_up) * tries),
                QuantityRange(0.0, cost.energy.most * tries),
            )
            self._steps[source, target] = spent
            longest[target] = longest.get(target, FREE) | spent
        self._work |= longest

    def onward(self, leaf: int, target: Task) -> Cost | NoWay:
        """The way to any other task from where the robot is after a leaf."""
        assert self.travel is not None
        cost = FREE
        for place in self.places[leaf]:
            leg = self.travel.leg(place.standing, target, target.velocity)
            if isinstance(leg, NoWay):
                return leg
            cost = cost | _cost(leg)
        return cost

    def way_back(self, leaf: int, target: Task) -> Cost | NoWay:
        """The same from wherever it is on the way to the leaf, or after it."""
        assert self.travel is not None
        onward = self.onward(leaf, target)
        if isinstance(onward, NoWay) or self.flow.leaves[leaf].wait is not None:
            return onward
        ways = _CutWays(self.flow, self.travel, self._origins, self.places)
        return onward + ways.rest(leaf, target.velocity)

    def _measure_cuts(self, travel: Travel) -> None:
        """What the way takes from wherever the robot was when an action was cancelled.

        The robot was on its way to a leaf x, or at its action: it could have gone on there and then
        to the target, at the target's speed, so the rest of that step and the way from x are
        enough, after cleaning up. It may almost be there, so the target's action is the least.
        """
        ways = _CutWays(self.flow, travel, self._origins, self.places)
        if not self.paths.failures:
            ways.chain(self._cuts)
        for source, pairs in self._cuts.items():
            for x, target in pairs:
                most = ways.most(x, target)
                work = self.work(target)
                rest = Cost(
                    QuantityRange(min(work.time.least, most.time.most), most.time.most),
                    QuantityRange(min(work.energy.least, most.energy.most), most.energy.most),
                )
                waited = Cost(QuantityRange(0.0, travel.clean_up), NOTHING)
                self._join(source, target, rest + waited)


class _CutWays:
    """The longest ways from where an action was cancelled. Keeps those that it has found."""

    def __init__(
        self,
        flow: Flow,
        travel: Travel,
        origins: list[dict[Standing, None]],
        places: list[list[Whereabouts]],
    ) -> None:
        self.flow = flow
        self.travel = travel
        self.origins = origins
        self.places = places
        self.detours: list[list[int]] = []
        """for each leaf, those that the robot may have been on the way to when it was begun"""
        self._found: dict[tuple[int, float | None], Cost] = {}
        self._order: dict[int, int] = {}
        """of each leaf, so that it comes after its detours"""
        self._endless: set[int] = set()
        """leaves with detours that lead back to them"""

    def chain(self, cuts: dict[Source, dict[tuple[int, int], None]]) -> None:
        """From now on, cancelled actions may follow each other."""
        self.detours = [[] for _ in self.flow.leaves]
        for pairs in cuts.values():
            for x, target in pairs:
                if x != target and x not in self.detours[target]:
                    self.detours[target].append(x)
        for place, part in enumerate(components(self.detours)):
            self._order |= dict.fromkeys(part, place)
            self._endless.update(part if len(part) > 1 else ())

    def most(self, x: int, target: int) -> Cost:
        """From on the way to x to another leaf, at most."""
        velocity = self.flow.leaves[target].leaf.task.velocity
        cost = self.rest(x, velocity)
        return cost if x == target else cost + self._between(x, target, velocity)

    def rest(self, x: int, velocity: float | None) -> Cost:
        """The rest of the way to x at a speed, at most."""
        if (x, velocity) not in self._found:
            if self.detours:
                self._measure(x, velocity)
            else:
                self._found[x, velocity] = self._to(self.origins[x], x, velocity)
        return self._found[x, velocity]

    def _measure(self, leaf: int, velocity: float | None) -> None:
        """The longest way to a leaf at a speed, from wherever the robot may be before it, and to
        those that it may have been on the way to before."""
        needed: set[int] = set()
        pending = [leaf]
        while pending:
            x = pending.pop()
            if x not in needed and (x, velocity) not in self._found:
                needed.add(x)
                pending += () if x in self._endless else self.detours[x]
        for x in sorted(needed, key=self._order.__getitem__):
            if x in self._endless:
                self._found[x, velocity] = _UNLIMITED
                continue
            cost = self._to(self.origins[x], x, velocity)
            for y in self.detours[x]:
                cost = cost | (self._found[y, velocity] + self._between(y, x, velocity))
            self._found[x, velocity] = cost

    def _between(self, x: int, target: int, velocity: float | None) -> Cost:
        standings = [place.standing for place in self.places[x]]
        return self._to(standings, target, velocity)

    def _to(self, standings: Iterable[Standing], target: int, velocity: float | None) -> Cost:
        task = self.flow.leaves[target].leaf.task
        cost = FREE
        for standing in standings:
            leg = self.travel.leg(standing, task, velocity)
            if not isinstance(leg, NoWay):
                cost = cost | _cost(leg)
        return cost


def _cost(leg: Leg) -> Cost:
    return Cost(QuantityRange(leg.duration, leg.duration), QuantityRange(leg.energy, leg.energy))
