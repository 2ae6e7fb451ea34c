"""What no route can be better than, for the checks of what solvers claim: a mixed-integer programme
that asks for less than the problem does.

Each block is left as often as it is entered, once if it is mandatory, and all that are made hang
together; what comes directly after what takes as long as it does at the least, by way of a charger
or not. Beside that only the maximum duration counts: no window but between two visits in a row, no
battery that runs empty, and of what comes before what only what can't follow directly.
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

_SLACK = 0.25
"""units and prizes by which the programme's bounds may be wrong, and are not"""
_LARGEST = 10**8
"""a sum of times or prizes up to which that is so"""
_MOST_ARCS = 20_000

Row = tuple[NDArray[np.intp], NDArray[np.float64], float, float]
"""variables and what each counts, and what they come to at least and at most"""


class Relaxation:
    """Bounds for all routes of a problem. The programme has a variable for each arc between blocks
    (the last number: start and end), and one for each block: whether it is made. Has state."""

    def __init__(self, blocks: Blocks, clock: Callable[[], float], deadline: float) -> None:
        self._blocks, self._clock, self._deadline = blocks, clock, deadline
        self._between, n = blocks.between, blocks.count
        some = self._between < NEVER
        self._origin, self._goal = np.nonzero(some)
        self._arcs = len(self._origin)
        self._times = np.append(self._between[some], np.zeros(n)).astype(float)
        self._prizes = np.append(np.zeros(self._arcs), blocks.prize)
        longest = int(self._between[some].max(initial=0)) * (n + 1)
        self._fits = self._arcs <= _MOST_ARCS and max(longest, sum(blocks.prize)) <= _LARGEST
        self._rows: list[Row] = []
        for b in range(n + 1):
            made = 1.0 if b == n else 0.0
            for end in (self._origin, self._goal):
                self._rows.append(self._row(end == b, b, made, made))
        if (limit := blocks.problem.max_duration) is not None:
            self._rows.append((np.arange(n + self._arcs), self._times, -inf, limit + 0.5))

    def most_prize(self, claimed: int) -> int | None:
        """No route wins more; looked for until it is no more than what is claimed. None: there is
        no route."""
        least = self._minimum(-self._prizes, 0, -claimed)
        return None if least is None else -least

    def least_cost(self, prize: int, claimed: int) -> int | None:
        """No route that wins the prize costs less; looked for until it is no less than what is
        claimed. None: no route wins it."""
        if self._blocks.problem.objective is Objective.PRIZE:
            return 0
        cost = 0
        if not self._blocks.problem.selective:
            rows, columns = linear_sum_assignment(self._between)
            cost = int(self._between[rows, columns].sum())
            if cost >= claimed:
                return None if cost >= NEVER else cost
        least = self._minimum(self._times, prize, claimed)
        return None if least is None else max(least, cost)

    def _row(self, arcs: NDArray[np.bool_], block: int, least: float, most: float) -> Row:
        """Counts arcs, less whether the block is made."""
        variables = np.flatnonzero(arcs)
        counts = np.ones(len(variables))
        if block == self._blocks.count:
            return variables, counts, least, most
        return np.append(variables, self._arcs + block), np.append(counts, -1.0), least, most

    def _minimum(self, objective: NDArray[np.float64], prize: int, enough: int) -> int | None:
        """The least that an objective may be for those that win the prize; None: none does."""
        best = int(np.minimum(objective, 0.0).sum())
        lower = np.zeros(len(objective))
        lower[self._arcs :] = [self._blocks.mandatory >> b & 1 for b in range(self._blocks.count)]
        wins = (np.arange(len(objective)), self._prizes, prize - 0.5, inf)
        while self._fits and best < enough and (left := self._deadline - self._clock()) > 0.0:
            found = milp(
                objective,
                integrality=np.ones(len(objective), np.int64),
                bounds=Bounds(lower, 1.0),
                constraints=_constraints([*self._rows, wins], len(objective)),
                options={"time_limit": left, "mip_rel_gap": 0.0},
            )
            if found.status == 2:
                return None
            if found.mip_dual_bound is not None and found.mip_dual_bound > -inf:
                best = max(best, ceil(found.mip_dual_bound - _SLACK))
            if found.status != 0 or not self._cut_off(found.x > 0.5):
                break
        return best

    def _cut_off(self, chosen: NDArray[np.bool_]) -> bool:
        """Whether something made does not hang together with the start; adds rows against it."""
        n, arcs = self._blocks.count, np.flatnonzero(chosen[: self._arcs])
        ends = self._origin[arcs], self._goal[arcs]
        graph = coo_array((np.ones(len(arcs)), ends), shape=(n + 1, n + 1))
        _, home = connected_components(graph, directed=False)
        made = np.flatnonzero(chosen[self._arcs :])
        islands = set(home[made].tolist()) - {int(home[n])}
        for island in islands:
            inside = home == island
            entered = ~inside[self._origin] & inside[self._goal]
            for b in np.flatnonzero(inside).tolist():
                self._rows.append(self._row(entered, b, 0.0, inf))
        return bool(islands)


def _constraints(rows: list[Row], variables: int) -> LinearConstraint:
    counts = np.concatenate([row[1] for row in rows])
    columns = np.concatenate([row[0] for row in rows])
    numbers = np.repeat(np.arange(len(rows)), [len(row[0]) for row in rows])
    matrix = csr_array((counts, (numbers, columns)), shape=(len(rows), variables))
    return LinearConstraint(matrix, [row[2] for row in rows], [row[3] for row in rows])
