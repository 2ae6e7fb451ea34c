"""Search for a witness of the least time and energy of a mission."""

import heapq
import math

from argo_compiler.analysis.bound_verification import (
    BEGIN,
    END,
    LeastSteps,
    ProgramPoint,
    SpentByPoint,
)
from argo_compiler.analysis.witness import LeastSpent, LeastWitness

_MOST_STEPS = 100  # greatest number of steps for each task and group
_ROUNDING = 1e-9  # share of a round, so that rounding makes no round cheaper than nothing


def find_least_witness(steps: LeastSteps) -> LeastWitness | None:
    """Return a witness with the least time and energy from the mission's start to each point.

    Returns None if the search would take too many steps.
    """
    search = _Search(steps)
    for planned in (True, False):
        time = search.shortest(of_time=True, planned=planned)
        if time is None:
            continue
        search.always_missed = steps.tasks_always_missing_hard_window(time[0])
        energy = search.shortest(of_time=False, planned=False)
        if energy is not None:
            return LeastWitness(_witness(steps, *time), _witness(steps, *energy))
    return None


_SpentAndPeriods = tuple[dict[ProgramPoint, float], tuple[float, ...]]
"""least time or energy at each point, and period of each group"""


class _Search:
    """Search for the shortest paths over the steps of a mission.

    `always_missed` is set after the search by time, for the search by energy.
    """

    def __init__(self, steps: LeastSteps) -> None:
        self.steps = steps
        self.always_missed: frozenset[int] = frozenset()
        """tasks that never end, as their windows always close before"""
        self._steps_left = 0

    def shortest(self, *, of_time: bool, planned: bool) -> _SpentAndPeriods | None:
        """Return the least time (s) or energy (Wh) until each point, and the period of each group.

        The values until points count from the mission's start. A group's period is the least from
        the end of one of its rounds to the end of the next; if `planned` and `of_time`, it is at
        least the group's `every`. Returns None if the search takes too long.
        """
        groups = self.steps.mission.groups
        self._steps_left = _MOST_STEPS * (100 + len(self.steps.mission.tasks) + len(groups))
        periods = [0.0] * len(groups)
        for g in sorted(range(len(groups)), key=lambda g: -groups[g].name.count("/")):
            shortest = self._shortest_from(("round", g), tuple(periods), of_time, g)
            if shortest is None:
                return None
            _, again = shortest
            every = groups[g].every if of_time and planned else 0.0
            period = 0.0 if math.isinf(again) else max(again, every)
            periods[g] = period if period == every else period * (1 - _ROUNDING)
        shortest = self._shortest_from(BEGIN, tuple(periods), of_time)
        return None if shortest is None else (shortest[0], tuple(periods))

    def _shortest_from(
        self,
        first: ProgramPoint,
        periods: tuple[float, ...],
        of_time: bool,
        group: int | None = None,
    ) -> tuple[dict[ProgramPoint, float], float] | None:
        """Return the least time (s) or energy (Wh) from a point to each other, and back to itself.

        With a `group`, only points within it are visited; without one, those of the whole mission.
        The second member is infinite if no path leads back. Returns None if the search takes too
        long.
        """
        steps = self.steps
        spent: dict[ProgramPoint, float] = {first: 0.0}
        again = math.inf
        # Dijkstra's algorithm, but a further round may take less than its period.
        pending = [(0.0, first)]
        while pending:
            here, point = heapq.heappop(pending)
            if here > spent[point] or (point[1] in self.always_missed and point[0] == "task"):
                continue
            if of_time and point[0] == "task" and steps.always_misses_hard_window(point, spent):
                continue
            for other, least in steps.successors_with_least_totals(
                point, spent, periods, of_time=of_time
            ):
                around = steps.enclosing_groups_outermost_first(other)
                self._steps_left -= 1 + len(around)
                if self._steps_left < 0:
                    return None
                if other == first:
                    again = min(again, least)
                elif (group is None or group in around) and least < spent.get(other, math.inf):
                    spent[other] = least
                    heapq.heappush(pending, (least, other))
                    ended = "round", other[1]
                    if other[0] == "entered" and ended in spent:
                        # The end of a group's time depends on when it was entered.
                        heapq.heappush(pending, (spent[ended], ended))
        return spent, again


def _witness(steps: LeastSteps, spent: SpentByPoint, periods: tuple[float, ...]) -> LeastSpent:
    tasks, groups = range(len(steps.mission.tasks)), range(len(steps.mission.groups))
    return LeastSpent(
        tasks=tuple(spent.get(("task", i)) for i in tasks),
        missed=tuple(spent.get(("missed", i)) for i in tasks),
        rounds=tuple(spent.get(("round", g)) for g in groups),
        left=tuple(spent.get(("left", g)) for g in groups),
        entered=tuple(spent.get(("entered", g)) for g in groups),
        periods=periods,
        end=spent.get(END),
    )
