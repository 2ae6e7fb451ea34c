"""Relaxation of a problem as a mixed-integer programme, for the checks of what solvers claim.

Each block is left as often as it is entered, once if it is mandatory, and all blocks of a route are
connected. Between two consecutive blocks counts the least time, straight or by a charger. The only
other constraint is the maximum duration. Left out are time windows, the state of the battery, and
all precedences except those that forbid one block directly after another.
"""

from collections.abc import Callable
from math import ceil, inf

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import Bounds, LinearConstraint, linear_sum_assignment, milp
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import connected_components

from argo_compiler.route.blocks import Blocks
from argo_compiler.route.problem import NEVER, Objective

_TOLERANCE = 0.25
"""units or prizes by which the programme's bounds are lowered: more than their numerical error"""
_LARGEST = 10**8
"""highest sum of times or prizes for which the tolerance suffices"""
_MOST_ARCS = 20_000

Row = tuple[NDArray[np.intp], NDArray[np.float64], float, float]
"""constraint: variables, their coefficients, and the lower and upper limit of the weighted sum"""


class Relaxation:
    """Mixed-integer programme whose optimal values are bounds for all routes of a problem.

    It has a binary variable for each arc between blocks (the last number is the start and the end),
    and one for each block that the route makes. Constraints are added during the search.
    """

    def __init__(self, blocks: Blocks, clock: Callable[[], float], deadline: float) -> None:
        self._blocks, self._clock, self._deadline = blocks, clock, deadline
        self._least_times, n = blocks.least_end_to_end_times, blocks.count
        has_arc = self._least_times < NEVER
        self._origin, self._goal = np.nonzero(has_arc)
        self._arcs = len(self._origin)
        self._times = np.append(self._least_times[has_arc], np.zeros(n)).astype(float)
        self._prizes = np.append(np.zeros(self._arcs), blocks.prize)
        longest = int(self._least_times[has_arc].max(initial=0)) * (n + 1)
        self._fits = self._arcs <= _MOST_ARCS and max(longest, sum(blocks.prize)) <= _LARGEST
        self._rows: list[Row] = []
        for b in range(n + 1):
            value = 1.0 if b == n else 0.0
            for end in (self._origin, self._goal):
                self._rows.append(self._row(end == b, b, value, value))
        if (limit := blocks.problem.max_duration) is not None:
            self._rows.append((np.arange(n + self._arcs), self._times, -inf, limit + 0.5))

    def prize_bound(self, enough_bound: int) -> int | None:
        """Return an upper bound on the prize of any route, or None if the relaxation has no route.

        The search ends when the bound is at most `enough_bound`.
        """
        least = self._minimum(-self._prizes, 0, -enough_bound)
        return None if least is None else -least

    def cost_bound(self, least_prize: int, enough_bound: int) -> int | None:
        """Return a lower bound on the cost of routes that win at least `least_prize`.

        Returns None if there is no such route. The search ends when the bound is at least
        `enough_bound`.
        """
        if self._blocks.problem.objective is Objective.PRIZE:
            return 0
        cost = 0
        if not self._blocks.problem.selective:
            rows, columns = linear_sum_assignment(self._least_times)
            cost = int(self._least_times[rows, columns].sum())
            if cost >= enough_bound:
                return None if cost >= NEVER else cost
        least = self._minimum(self._times, least_prize, enough_bound)
        return None if least is None else max(least, cost)

    def _row(self, arcs: NDArray[np.bool_], block: int, least: float, most: float) -> Row:
        """Return a constraint on how many of some arcs a route has.

        Their number, minus 1 if the route makes the block, lies from `least` to `most`. Nothing is
        subtracted for the start and end, which have the number after the last block's.
        """
        variables = np.flatnonzero(arcs)
        coefficients = np.ones(len(variables))
        if block == self._blocks.count:
            return variables, coefficients, least, most
        return np.append(variables, self._arcs + block), np.append(coefficients, -1.0), least, most

    def _minimum(self, objective: NDArray[np.float64], prize: int, enough: int) -> int | None:
        """Return a lower bound on an objective of routes that win at least `prize`.

        `objective` has the coefficients of the variables. The search ends when the bound is at
        least `enough`, or at the deadline. Returns None if no route wins the prize.
        """
        best = int(np.minimum(objective, 0.0).sum())
        lower = np.zeros(len(objective))
        lower[self._arcs :] = [self._blocks.mandatory >> b & 1 for b in range(self._blocks.count)]
        prize_row = (np.arange(len(objective)), self._prizes, prize - 0.5, inf)
        while self._fits and best < enough and (seconds := self._deadline - self._clock()) > 0.0:
            solution = milp(
                objective,
                integrality=np.ones(len(objective), np.int64),
                bounds=Bounds(lower, 1.0),
                constraints=_constraints([*self._rows, prize_row], len(objective)),
                options={"time_limit": seconds, "mip_rel_gap": 0.0},
            )
            if solution.status == 2:
                return None
            if solution.mip_dual_bound is not None and solution.mip_dual_bound > -inf:
                best = max(best, ceil(solution.mip_dual_bound - _TOLERANCE))
            if solution.status != 0 or not self._add_cuts(solution.x > 0.5):
                break
        return best

    def _add_cuts(self, chosen: NDArray[np.bool_]) -> bool:
        """Add constraints against subtours, and return True if the solution has any.

        A subtour is a group of blocks that is not connected with the start.
        """
        n, arcs = self._blocks.count, np.flatnonzero(chosen[: self._arcs])
        ends = self._origin[arcs], self._goal[arcs]
        graph = coo_array((np.ones(len(arcs)), ends), shape=(n + 1, n + 1))
        _, component = connected_components(graph, directed=False)
        made = np.flatnonzero(chosen[self._arcs :])
        subtours = set(component[made].tolist()) - {int(component[n])}
        for subtour in subtours:
            inside = component == subtour
            entering = ~inside[self._origin] & inside[self._goal]
            for b in np.flatnonzero(inside).tolist():
                self._rows.append(self._row(entering, b, 0.0, inf))
        return bool(subtours)


def _constraints(rows: list[Row], variables: int) -> LinearConstraint:
    coefficients = np.concatenate([row[1] for row in rows])
    columns = np.concatenate([row[0] for row in rows])
    numbers = np.repeat(np.arange(len(rows)), [len(row[0]) for row in rows])
    matrix = csr_array((coefficients, (numbers, columns)), shape=(len(rows), variables))
    return LinearConstraint(matrix, [row[2] for row in rows], [row[3] for row in rows])
