"""Solver of route problems: random orders, each improved by moving one visit at a time."""

import numpy as np

from argo_compiler.route import RouteProblem, Tour, evaluate
from argo_compiler.route.search import Search

_WORK = 1e-3
"""nominal s for the evaluation of one order"""


class RandomRestarts:
    """Solver that begins again and again with a random order, and offers each better one."""

    name = "random-restarts"

    def supports(self, problem: RouteProblem, /) -> bool:
        """Return True for problems without rounds and chargers, whose orders are permutations."""
        return not problem.rounds and problem.battery is None and problem.size > 1

    def solve(self, search: Search, /) -> None:
        """Offer orders to the search until its time is over."""
        rng = np.random.default_rng(search.seed)
        size = search.problem.size
        while search.remaining_time() > 0.0:
            order = [int(visit) for visit in rng.permutation(size)]
            for visit in range(size):
                order = self._best_position(search, order, visit)

    def _best_position(self, search: Search, order: list[int], visit: int) -> list[int]:
        """Return the order with one visit moved to where the route costs least."""
        others = [other for other in order if other != visit]
        candidates = [[*others[:k], visit, *others[k:]] for k in range(len(order))]
        return min(candidates, key=lambda candidate: self._cost(search, candidate))

    def _cost(self, search: Search, order: list[int]) -> float:
        tour = Tour(tuple(order))
        found = evaluate(search.problem, tour)
        search.spend(_WORK, 1)
        if not found.feasible:
            return float("inf")
        search.offer_tour(tour)
        return found.cost(search.problem.objective)


SOLVER = RandomRestarts()
