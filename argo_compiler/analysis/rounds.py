"""Cost of all rounds of a group, computed from the cost of one round.

All costs count from the moment at which the group is entered, unless they are those of one round.
"""

import math
from collections.abc import Iterable, Mapping

from argo_compiler.analysis.flow import GroupFlow
from argo_compiler.analysis.step_costs import NOTHING, Cost, QuantityRange, Source
from argo_compiler.base.records import dataclass

_TOLERANCE = 1e-9  # share of a round, as sums of floats are not exact
_MOST_COUNTED = 1e12  # rounds; a greater number counts as infinite

ExitKey = tuple[Source, int]
"""exit of a group: what ended last (the source of the step out of it), and the next node"""


@dataclass(frozen=True, slots=True)
class GroupExit:
    """Cost of one exit of a group since it was entered, with the number of rounds."""

    cost: Cost
    fewest: float
    """least number of rounds, the last one included"""
    most: float
    """greatest number of rounds, the last one included"""

    def __or__(self, other: "GroupExit") -> "GroupExit":
        return GroupExit(
            self.cost | other.cost, min(self.fewest, other.fewest), max(self.most, other.most)
        )


@dataclass(frozen=True)
class GroupRound:
    """Cost of one round of a group."""

    ends: Mapping[Source, Cost]
    """cost until the end of the round, by what ended last: the source of the next step"""
    exits: Mapping[ExitKey, Cost]
    """cost of each exit that leaves the group within the round"""
    energy: float
    """greatest energy in Wh at any moment of the round"""
    time: float
    """greatest duration in s, also if the round does not reach its end"""

    @property
    def cost_until_end(self) -> Cost | None:
        return union(self.ends.values())


@dataclass(frozen=True)
class Rounds:
    """Cost of all rounds of a group that is entered at one leaf from one source."""

    exits: Mapping[ExitKey, GroupExit]
    energy: float
    """greatest energy in Wh at any moment inside the group"""
    time: float
    """greatest time in s inside the group"""
    unlimited: bool
    """whether the rounds may repeat without a limit of the group itself"""


def union(costs: Iterable[Cost]) -> Cost | None:
    """Return the smallest cost range that contains all costs; None if there are none."""
    joined: Cost | None = None
    for cost in costs:
        joined = cost if joined is None else joined | cost
    return joined


def combine_rounds(
    group_number: int,
    group: GroupFlow,
    first: GroupRound,
    later: GroupRound | None,
    power_between_rounds: float = 0.0,
) -> Rounds:
    """Return the cost of all rounds of a group.

    Args:
        group_number: Number of the group.
        group: The group.
        first: Cost of its first round.
        later: Cost of each later round; None if there is none.
        power_between_rounds: Power in W that the robot draws until the next round is due.
    """
    return _Combination(group_number, group, first, later, power_between_rounds).rounds()


class _Combination:
    def __init__(
        self,
        number: int,
        group: GroupFlow,
        first: GroupRound,
        later: GroupRound | None,
        standing_power: float,
    ) -> None:
        self.number = number
        self.group = group
        self.first = first
        self.later = later
        self.standing_power = standing_power
        self.first_end = first.cost_until_end
        self.period = None if later is None else later.cost_until_end
        self.every = group.every
        self.limit = group.duration or math.inf
        self.count = min(group.count or math.inf, _due_before(self.limit, self.every))
        self.fewest, self.most = self._range()
        self.exits: dict[ExitKey, GroupExit] = {}

    def rounds(self) -> Rounds:
        self._leave_within()
        self._leave_at_end()
        if self.group.hard:
            self._time_out()
        repeats = self.most >= 2 and self.period is not None
        return Rounds(
            exits=self.exits,
            energy=self._energy_inside(),
            time=self._time_inside(),
            unlimited=repeats and not self.group.has_round_or_time_limit,
        )

    def _range(self) -> tuple[float, float]:
        """Return the fewest rounds after which the group may end, and the most that may start.

        Both may be infinite. They are 0 and 1 if the first round never reaches its end.
        """
        end, period = self.first_end, self.period
        if end is None:
            return 0, 1
        fewest: float
        most: float
        if self.group.until or end.time.most >= self.limit or period is None:
            fewest = 1
        elif math.isinf(self.limit):
            fewest = math.inf
        else:
            # With `every`, each round starts after the previous one, or when it is due.
            first = max(end.time.most, period.time.most if self.every else 0.0)
            longest = max(period.time.most, self.every)
            fewest = 1
            if first < self.limit:
                fewest += _periods_to_fill(self.limit - first, longest, -1)
        is_too_long = end.time.least > self.limit or (
            end.time.least == self.limit and not self.group.hard
        )
        if is_too_long or self.later is None or self.count == 1:
            most = 1
        elif math.isinf(self.limit) or period is None or period.time.least == 0:
            most = math.inf if period is not None else 2
        else:
            # A round may start at the very moment of a hard stop, which ends it at once.
            count_periods = _periods_started if self.group.hard else _periods_to_fill
            most = 1 + count_periods(self.limit - end.time.least, period.time.least, 1)
        return min(fewest, self.count), min(most, self.count)

    def _end_after(self, rounds: float) -> Cost | None:
        """Return the cost until `rounds` rounds have been completed; None if so many can't be."""
        if self.first_end is None or rounds < 1:
            return None
        if rounds == 1:
            return self.first_end
        if self.period is None:
            return None
        cost = self.first_end + self.period.times(rounds - 1)
        if not self.every:
            return cost
        # The last round that the robot had to wait for is the second one, the last one, or none.
        time = QuantityRange(
            max(cost.time.least, self._end_if_waited(rounds, self.period.time.least)),
            max(cost.time.most, self._end_if_waited(rounds, self.period.time.most)),
        )
        return Cost(time, cost.energy + self._idle_energy(rounds))

    def _end_if_waited(self, rounds: float, period: float) -> float:
        """Return the latest time in s at which `rounds` rounds have ended, with one wait.

        Rounds are due each `every` s. The result is the later one of two cases: the second round
        starts when it is due and the others follow without a wait, or the last round starts when it
        is due. `period` is the duration of a later round in s.
        """
        if math.isinf(rounds):
            return math.inf
        return max(self.every + (rounds - 1) * period, (rounds - 1) * self.every + period)

    def _last_start(self, rounds: float) -> Cost:
        """Return the cost until the last of `rounds` rounds starts.

        `rounds` must be at least two, and must be two if only the first round reaches its end.
        """
        previous_end = self._end_after(rounds - 1)
        assert previous_end is not None
        if not self.every:
            return previous_end
        due = (rounds - 1) * self.every
        time = QuantityRange(max(previous_end.time.least, due), max(previous_end.time.most, due))
        return Cost(time, previous_end.energy + self._idle_energy(rounds))

    def _idle_energy(self, rounds: float) -> QuantityRange:
        """Return the range of the energy in Wh drawn while the robot waits for rounds to be due.

        It may not wait at all, or nearly all the time until the last of `rounds` rounds is due.
        """
        if not self.standing_power:
            return NOTHING
        return QuantityRange(0.0, self.standing_power * (rounds - 1) * self.every / 3600)

    def _leave_within(self) -> None:
        """Add to `exits` the costs of leaving the group by a task's transition within a round."""
        for exit_key, cost in self.first.exits.items():
            self._add(exit_key, cost, 1, 1)
        if self.later is None or self.first_end is None or self.most < 2:
            return
        soonest, latest = self._last_start(2), self._last_start(self.most)
        for exit_key, cost in self.later.exits.items():
            least = soonest.time.least + cost.time.least
            # No round starts after the limit.
            most = min(latest.time.most, self.limit) + cost.time.most
            later = Cost(
                QuantityRange(least, max(most, least)),
                QuantityRange(
                    soonest.energy.least + cost.energy.least, latest.energy.most + cost.energy.most
                ),
            )
            self._add(exit_key, later, 2, self.most)

    def _leave_at_end(self) -> None:
        """Add to `exits` the costs of leaving the group by the transition after the last round."""
        cost, fewest, most = self._end_of_last()
        if cost is None:
            return
        sources = dict(self.first.ends)
        if most > 1 and self.later is not None:
            sources |= {s: c for s, c in self.later.ends.items() if s not in sources}
        for source in sources:
            exact = self.first.ends.get(source) if most == 1 else None
            self._add((source, self.group.successor), exact or cost, fewest, most)

    def _end_of_last(self) -> tuple[Cost | None, float, float]:
        if self.first_end is None or not self.group.has_limit_or_until:
            return None, 0, 0
        by_count = None if math.isinf(self.count) else self._end_after(self.count)
        if self.group.until:
            return self._end_by_value()
        if math.isinf(self.limit):
            return by_count, self.count, self.count
        if self.group.hard:
            # At the limit, the time-out ends the group instead.
            return by_count, self.count, self.count
        by_time = self._end_after(self.fewest)
        if by_time is None:
            return by_count, self.count, self.count
        least = max(self.limit, by_time.time.least)
        if by_count is not None:
            least = min(least, by_count.time.least)
        last = self._end_after(self.most)
        most = self._longest(last)
        energy = by_time.energy | (last or by_time).energy
        return Cost(QuantityRange(min(least, most), most), energy), self.fewest, self.most

    def _end_by_value(self) -> tuple[Cost, float, float]:
        """Return cost, fewest and most rounds of a group that `until` may end after any round."""
        assert self.first_end is not None
        last = self._end_after(self.most)
        if last is None:
            return self.first_end, 1, 1
        ends = self.first_end | last
        most = max(self._longest(last), ends.time.least)
        return Cost(QuantityRange(ends.time.least, most), ends.energy), 1, self.most

    def _longest(self, last: Cost | None) -> float:
        """Return the latest time in s at which the group's last round can end, from its entry on.

        No round starts after the time limit. `last` is the cost until the greatest number of rounds
        has been completed; None if it can't be.
        """
        assert self.first_end is not None
        round_most = 0.0 if self.period is None else self.period.time.most
        most = max(self.first_end.time.most, self.limit + round_most)
        return most if last is None else min(most, last.time.most)

    def _time_out(self) -> None:
        # Rounds need not reach their end before the time is up.
        first = self.first.time
        longest = 0.0
        if self.later is not None:
            longest = max(self.later.time, self.every)
            first = max(first, self.later.time if self.every else 0.0)
        all_rounds = first
        if self.count > 1 and self.later is not None:
            all_rounds += longest * (self.count - 1) if longest else 0.0
        if all_rounds < self.limit:
            return
        completed = 0.0
        # An action that starts when the time is up has not ended, even if it takes no time.
        if self.first_end is not None and first < self.limit:
            completed = 1.0
            if self.period is not None and self.count > 1:
                # The round that reaches the limit may not be completed.
                completed = max(1.0, _periods_to_fill(self.limit - first, longest, -1))
            completed = min(completed, self.count)
        least = self._end_after(1 if math.isinf(completed) else completed)
        cost = Cost(
            QuantityRange(self.limit, self.limit),
            QuantityRange(0.0 if least is None else least.energy.least, self._energy_inside()),
        )
        fewest = completed if 1 <= completed < math.inf else 1
        self._add((("cut", self.number), self.group.successor), cost, fewest, max(1, self.most))

    def _energy_inside(self) -> float:
        energy = self.first.energy
        if self.later is not None and self.first_end is not None and self.most >= 2:
            energy = max(energy, self._last_start(self.most).energy.most + self.later.energy)
        return energy

    def _time_inside(self) -> float:
        time = self.first.time
        if self.later is not None and self.first_end is not None and self.most >= 2:
            last_start = min(self._last_start(self.most).time.most, self.limit)
            time = max(time, last_start + self.later.time)
        return min(time, self.limit) if self.group.hard else time

    def _add(self, exit_key: ExitKey, cost: Cost, fewest: float, most: float) -> None:
        if self.group.hard and not (
            isinstance(exit_key[0], tuple) and exit_key[0] == ("cut", self.number)
        ):
            if cost.time.least > self.limit + _TOLERANCE:
                return
            least = min(cost.time.least, self.limit)
            cost = Cost(QuantityRange(least, min(cost.time.most, self.limit)), cost.energy)
        group_exit = GroupExit(cost, fewest, most)
        known = self.exits.get(exit_key)
        self.exits[exit_key] = group_exit if known is None else known | group_exit


def _due_before(limit: float, every: float) -> float:
    """Return how many rounds are due before `limit` s: the first at 0, then one each `every` s.

    A round that is due at the limit does not count. Infinite if `every` is 0.
    """
    if not every or limit / every > _MOST_COUNTED:
        return math.inf
    rounds = math.ceil(limit / every)
    while (rounds - 1) * every >= limit:
        rounds -= 1
    while rounds * every < limit:
        rounds += 1
    return rounds


def _periods_started(time: float, period: float, side: int) -> float:
    """Return how many periods start from 0 to `time`, both included; the first starts at 0.

    `period` is not 0. If rounding leaves doubt, `side` decides: 1 for the greater number, -1 for
    the smaller one.
    """
    return 1 + math.floor(time / period + side * _TOLERANCE)


def _periods_to_fill(time: float, period: float, side: int) -> float:
    """Return the least number of periods that together last at least a time.

    It is infinite if a period takes no time. If rounding leaves doubt, `side` decides: 1 for the
    greater number, -1 for the smaller one.
    """
    if period == 0:
        return math.inf
    if math.isinf(period):
        return 1
    # Sums of whole seconds are exact; sums of other times are not.
    exact = time.is_integer() and period.is_integer()
    return math.ceil(time / period + (0.0 if exact else side * _TOLERANCE))
