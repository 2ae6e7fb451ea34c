"""What all rounds of a group take together, from what one round takes."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from argo_compiler.analysis.flow import GroupFlow
from argo_compiler.analysis.legs import NOTHING, Cost, QuantityRange, Source

_SLACK = 1e-9  # of a round: sums of floats are not exact

WayOut = tuple[Source, int]
"""how a group is left: what ended last, and the node that is next"""


@dataclass(frozen=True, slots=True)
class Out:
    """A way out of a group, counted from when it was entered."""

    cost: Cost
    fewest: float
    most: float
    """rounds, the last one included"""

    def __or__(self, other: "Out") -> "Out":
        return Out(
            self.cost | other.cost, min(self.fewest, other.fewest), max(self.most, other.most)
        )


@dataclass(frozen=True)
class GroupRound:
    """One round of a group."""

    ends: Mapping[Source, Cost]
    """where the round comes to its end, by what ended last"""
    exits: Mapping[WayOut, Cost]
    """where the group is left within the round"""
    energy: float
    """Wh at most at any moment of it"""

    @property
    def end(self) -> Cost | None:
        return union(self.ends.values())


@dataclass(frozen=True)
class Rounds:
    """All ways out of a group, entered in one way."""

    outs: Mapping[WayOut, Out]
    energy: float
    """Wh at most at any moment inside"""
    unlimited: bool
    """rounds may follow each other without any limit of the group's own"""


def union(costs: Iterable[Cost]) -> Cost | None:
    """The smallest cost that holds all of them."""
    joined: Cost | None = None
    for cost in costs:
        joined = cost if joined is None else joined | cost
    return joined


def combine(number: int, group: GroupFlow, first: GroupRound, later: GroupRound | None) -> Rounds:
    """The ways out of group `number` when its first round is `first`, and each other `later`."""
    return _Combination(number, group, first, later).rounds()


class _Combination:
    def __init__(
        self, number: int, group: GroupFlow, first: GroupRound, later: GroupRound | None
    ) -> None:
        self.number = number
        self.group = group
        self.first = first
        self.later = later
        self.first_end = first.end
        self.period = None if later is None else later.end
        self.limit = group.duration or math.inf
        self.count = group.count or math.inf
        self.fewest, self.most = self._range()
        self.outs: dict[WayOut, Out] = {}

    def rounds(self) -> Rounds:
        self._leave_within()
        self._leave_at_end()
        if self.group.hard:
            self._time_out()
        repeats = self.most >= 2 and self.period is not None
        return Rounds(
            outs=self.outs,
            energy=self._energy_inside(),
            unlimited=repeats and not self.group.may_end,
        )

    def _range(self) -> tuple[float, float]:
        """How many rounds are completed at least when the time is up, and begun at most."""
        end, period = self.first_end, self.period
        if end is None:
            return 0, 1
        fewest: float
        most: float
        if end.time.most >= self.limit or period is None:
            fewest = 1
        elif math.isinf(self.limit):
            fewest = math.inf
        else:
            fewest = 1 + _rounds_up(self.limit - end.time.most, period.time.most, -1)
        over = end.time.least > self.limit or (end.time.least == self.limit and not self.group.hard)
        if over or self.later is None or self.count == 1:
            most = 1
        elif math.isinf(self.limit) or period is None or period.time.least == 0:
            most = math.inf if period is not None else 2
        else:
            # Before a hard stop a round may begin at the very moment, and be cut at once.
            filled = _filled if self.group.hard else _rounds_up
            most = 1 + filled(self.limit - end.time.least, period.time.least, 1)
        return min(fewest, self.count), min(most, self.count)

    def _after(self, rounds: float) -> Cost | None:
        """When so many rounds have been completed."""
        if self.first_end is None or rounds < 1:
            return None
        if rounds == 1:
            return self.first_end
        return None if self.period is None else self.first_end + self.period.times(rounds - 1)

    def _leave_within(self) -> None:
        """By transitions of members."""
        for way, cost in self.first.exits.items():
            self._add(way, cost, 1, 1)
        if self.later is None or self.first_end is None or self.most < 2:
            return
        between = NOTHING if self.period is None else self.period.time.times(self.most - 2)
        energy = NOTHING if self.period is None else self.period.energy.times(self.most - 2)
        for way, cost in self.later.exits.items():
            soonest = self.first_end + cost
            # No round begins after the limit.
            latest = min(soonest.time.most + between.most, self.limit + cost.time.most)
            later = Cost(
                QuantityRange(soonest.time.least, max(latest, soonest.time.least)),
                QuantityRange(soonest.energy.least, soonest.energy.most + energy.most),
            )
            self._add(way, later, 2, self.most)

    def _leave_at_end(self) -> None:
        """By the unconditional transition, after the last round."""
        cost, fewest, most = self._last_end()
        if cost is None:
            return
        sources = dict(self.first.ends)
        if most > 1 and self.later is not None:
            sources |= {s: c for s, c in self.later.ends.items() if s not in sources}
        for source in sources:
            exact = self.first.ends.get(source) if most == 1 else None
            self._add((source, self.group.onward), exact or cost, fewest, most)

    def _last_end(self) -> tuple[Cost | None, float, float]:
        if self.first_end is None or not self.group.may_end:
            return None, 0, 0
        by_count = None if math.isinf(self.count) else self._after(self.count)
        if math.isinf(self.limit):
            return by_count, self.count, self.count
        if self.group.hard:
            # At the limit itself the time-out takes over.
            return by_count, self.count, self.count
        by_time = self._after(self.fewest)
        if by_time is None:
            return by_count, self.count, self.count
        least = max(self.limit, by_time.time.least)
        if by_count is not None:
            least = min(least, by_count.time.least)
        last = self._after(self.most)
        round_most = 0.0 if self.period is None else self.period.time.most
        most = max(self.first_end.time.most, self.limit + round_most)
        if last is not None:
            most = min(most, last.time.most)
        energy = by_time.energy | (last or by_time).energy
        return Cost(QuantityRange(min(least, most), most), energy), self.fewest, self.most

    def _time_out(self) -> None:
        end = self._after(self.count) if not math.isinf(self.count) else None
        if end is not None and end.time.most < self.limit:
            return
        completed = 0.0
        if self.first_end is not None and self.first_end.time.most <= self.limit:
            completed = self.fewest
            if self.period is not None and completed > 1:
                # The round that reaches the limit is not among those completed for sure.
                completed -= 1
        least = self._after(1 if math.isinf(completed) else completed)
        cost = Cost(
            QuantityRange(self.limit, self.limit),
            QuantityRange(0.0 if least is None else least.energy.least, self._energy_inside()),
        )
        fewest = completed if 1 <= completed < math.inf else 1
        self._add((("cut", self.number), self.group.onward), cost, fewest, max(1, self.most))

    def _energy_inside(self) -> float:
        energy = self.first.energy
        if self.later is not None and self.first_end is not None and self.most >= 2:
            before = self.first_end.energy.most
            if self.period is not None:
                before += self.period.energy.times(self.most - 2).most
            energy = max(energy, before + self.later.energy)
        return energy

    def _add(self, way: WayOut, cost: Cost, fewest: float, most: float) -> None:
        if self.group.hard and not (isinstance(way[0], tuple) and way[0] == ("cut", self.number)):
            if cost.time.least > self.limit + _SLACK:
                return
            least = min(cost.time.least, self.limit)
            cost = Cost(QuantityRange(least, min(cost.time.most, self.limit)), cost.energy)
        out = Out(cost, fewest, most)
        known = self.outs.get(way)
        self.outs[way] = out if known is None else known | out


def _filled(time: float, period: float, side: int) -> float:
    """How many periods begin within the time, one that begins at its very end included."""
    return 1 + math.floor(time / period + side * _SLACK)


def _rounds_up(time: float, period: float, side: int) -> float:
    """How many periods it takes to fill the time; `side` says where rounding may err to."""
    if period == 0:
        return math.inf
    if math.isinf(period):
        return 1
    # Whole seconds add up exactly, other times nearly.
    exact = time.is_integer() and period.is_integer()
    return math.ceil(time / period + (0.0 if exact else side * _SLACK))
