"""Greedy insertion, and a local search with 2-opt and or-opt."""

from collections.abc import Iterator, Sequence

from argo_compiler.route import RouteProblem
from argo_env.envs.observations import Observation
from baselines.planned import PlannedPolicy
from baselines.problem import problem_from_observation

_SEGMENT = 3  # greatest number of visits that or-opt moves


class Insertion(PlannedPolicy):
    """Policy that plans by insertion and local search, and again after each deviation."""

    name = "insertion"

    def plan_route(self, observation: Observation) -> list[int]:
        open_problem = problem_from_observation(observation, self._budget)
        return open_problem.to_nodes(insert_and_improve(open_problem.problem))


def insert_and_improve(problem: RouteProblem, start: Sequence[int] = ()) -> tuple[int, ...]:
    """Return an order within the maximum duration, by greedy insertion and local search.

    Inserts the visit with the highest prize for the time that it adds, where it adds least; then
    reverses parts of the order (2-opt) and moves up to three visits (or-opt) as long as that saves
    time; then inserts again, until no visit fits any more.

    Args:
        problem: a problem whose visits are all optional, without time windows, rounds and
            batteries. Its precedence constraints must have `needed` set: a visit is only
            allowed if its predecessors come before it. The returned order satisfies them.
        start: order within the maximum duration with which the search starts. Visits without
            their predecessors before them are dropped from it; the travel times must be such
            that this makes no order longer.
    """
    search = _Search(problem)
    order = search.drop_violations(start)
    while True:
        grown = search.shorten(search.insert_visits(order))
        if len(grown) == len(order):
            return tuple(order)
        order = grown


class _Search:
    """Operations of the search, on a route problem as plain lists."""

    def __init__(self, problem: RouteProblem) -> None:
        self._end = problem.end
        self._travel = problem.travel.tolist()
        self._prizes = [visit.prize for visit in problem.visits]
        self._services = [visit.service for visit in problem.visits]
        self._max_duration = problem.max_duration
        self._predecessors: list[set[int]] = [set() for _ in problem.visits]
        for precedence in problem.precedences:
            for k, visit in enumerate(precedence.sequence):
                self._predecessors[visit].update(precedence.sequence[:k])

    def drop_violations(self, order: Sequence[int]) -> list[int]:
        """Return the order without visits that do not come after all of their predecessors."""
        valid: set[int] = set()
        for visit in order:
            if self._predecessors[visit] <= valid:
                valid.add(visit)
        return [visit for visit in order if visit in valid]

    def insert_visits(self, order: list[int]) -> list[int]:
        """Return the order with visits inserted, one after the other, until none fits.

        Each time, that visit is inserted which wins the highest prize for the time that it adds,
        at the index where it adds least.
        """
        order = list(order)
        while True:
            spare = self._spare_time(order)
            best: tuple[float, int, int, int] | None = None
            for visit in sorted(set(range(self._end)) - set(order)):
                for index, added in self._insertions(order, visit):
                    if added <= spare:
                        candidate = (self._prizes[visit] / max(added, 1), -added, -visit, index)
                        best = candidate if best is None else max(best, candidate)
            if best is None:
                return order
            order.insert(best[3], -best[2])

    def shorten(self, order: list[int]) -> list[int]:
        """Return the order after 2-opt and or-opt moves that save time, until none saves any.

        Each time, the first such move that is found is made, if it keeps all precedences.
        """
        time = self._time(order)
        while True:
            for changed in self._neighbours(order):
                shorter = self._time(changed)
                if shorter < time and len(self.drop_violations(changed)) == len(changed):
                    order, time = changed, shorter
                    break
            else:
                return order

    def _spare_time(self, order: list[int]) -> float:
        return (
            float("inf") if self._max_duration is None else self._max_duration - self._time(order)
        )

    def _time(self, order: list[int]) -> int:
        """Return the time of a tour in this order, from the start to the end."""
        previous, time = self._end, 0
        for visit in order:
            time += self._travel[previous][visit] + self._services[visit]
            previous = visit
        return int(time + self._travel[previous][self._end])

    def _insertions(self, order: list[int], visit: int) -> Iterator[tuple[int, int]]:
        """Yield each index that precedence allows for the visit, with the time that it adds."""
        if not self._predecessors[visit] <= set(order):
            return
        first = max((order.index(other) + 1 for other in self._predecessors[visit]), default=0)
        stops = [self._end, *order, self._end]
        for index in range(first, len(order) + 1):
            a, b = stops[index], stops[index + 1]
            more = self._travel[a][visit] + self._travel[visit][b] - self._travel[a][b]
            yield index, more + self._services[visit]

    def _neighbours(self, order: list[int]) -> Iterator[list[int]]:
        """Yield all orders that one 2-opt or or-opt move leads to, valid or not."""
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
