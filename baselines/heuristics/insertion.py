"""Greedy insertion, and a local search with 2-opt and or-opt."""

from collections.abc import Iterator, Sequence

from argo_compiler.route import RouteProblem
from argo_env.envs.observations import Observation
from baselines.planned import PlannedPolicy
from baselines.problem import problem_of

_SEGMENT = 3  # visits that or-opt moves at most


class Insertion(PlannedPolicy):
    """Plans by `insert_and_improve`, and again when something has gone otherwise than planned."""

    name = "insertion"

    def plan(self, observation: Observation) -> list[int]:
        """See Planned."""
        found = problem_of(observation, self._budget)
        return found.order_of(insert_and_improve(found.problem))


def insert_and_improve(problem: RouteProblem, start: Sequence[int] = ()) -> tuple[int, ...]:
    """An order that keeps to the maximum duration and to precedence with `needed`: of visits that
    are all optional, without time windows, rounds and batteries.

    Inserts the visit with the most prize for the time that it adds, where it adds least; then
    reverses stretches (2-opt) and moves up to three visits (or-opt) as long as that saves time;
    then inserts again, until nothing more fits. Goes on from `start`, an order that keeps to the
    maximum duration, less what does not come after all that it needs; nothing may take longer
    where something is left out.
    """
    search = _Search(problem)
    order = search.kept(start)
    while True:
        grown = search.shortened(search.filled(order))
        if len(grown) == len(order):
            return tuple(order)
        order = grown


class _Search:
    """The problem as plain lists."""

    def __init__(self, problem: RouteProblem) -> None:
        self._end = problem.end
        self._travel = problem.travel.tolist()
        self._prizes = [visit.prize for visit in problem.visits]
        self._services = [visit.service for visit in problem.visits]
        self._most = problem.max_duration
        self._first: list[set[int]] = [set() for _ in problem.visits]
        for precedence in problem.precedences:
            for k, visit in enumerate(precedence.sequence):
                self._first[visit].update(precedence.sequence[:k])

    def kept(self, order: Sequence[int]) -> list[int]:
        """The order without what does not come after all that must come before it."""
        made: set[int] = set()
        for visit in order:
            if self._first[visit] <= made:
                made.add(visit)
        return [visit for visit in order if visit in made]

    def filled(self, order: list[int]) -> list[int]:
        """The order with all inserted that can be, the best first."""
        order = list(order)
        while True:
            spare = self._spare(order)
            best: tuple[float, int, int, int] | None = None
            for visit in sorted(set(range(self._end)) - set(order)):
                for place, added in self._places(order, visit):
                    if added <= spare:
                        offer = (self._prizes[visit] / max(added, 1), -added, -visit, place)
                        best = offer if best is None else max(best, offer)
            if best is None:
                return order
            order.insert(best[3], -best[2])

    def shortened(self, order: list[int]) -> list[int]:
        """The order after all moves that save time, each time the first that is found."""
        time = self._time(order)
        while True:
            for changed in self._neighbours(order):
                shorter = self._time(changed)
                if shorter < time and len(self.kept(changed)) == len(changed):
                    order, time = changed, shorter
                    break
            else:
                return order

    def _spare(self, order: list[int]) -> float:
        return float("inf") if self._most is None else self._most - self._time(order)

    def _time(self, order: list[int]) -> int:
        place, time = self._end, 0
        for visit in order:
            time += self._travel[place][visit] + self._services[visit]
            place = visit
        return int(time + self._travel[place][self._end])

    def _places(self, order: list[int], visit: int) -> Iterator[tuple[int, int]]:
        """Where the visit may be inserted, and the time that it adds."""
        if not self._first[visit] <= set(order):
            return
        least = max((order.index(first) + 1 for first in self._first[visit]), default=0)
        around = [self._end, *order, self._end]
        for place in range(least, len(order) + 1):
            a, b = around[place], around[place + 1]
            more = self._travel[a][visit] + self._travel[visit][b] - self._travel[a][b]
            yield place, more + self._services[visit]

    def _neighbours(self, order: list[int]) -> Iterator[list[int]]:
        n = len(order)
        for i in range(n):
            for j in range(i + 2, n + 1):
                yield order[:i] + order[i:j][::-1] + order[j:]
        for size in range(1, _SEGMENT + 1):
            for i in range(n - size + 1):
                rest, moved = order[:i] + order[i + size :], order[i : i + size]
                for j in range(len(rest) + 1):
                    if j != i:
                        yield rest[:j] + moved + rest[j:]
