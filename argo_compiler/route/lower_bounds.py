"""Lower bounds on the remaining cost of labels, from tables or from dual prices.

A label describes the beginning of a path (see `argo_compiler.route.beam_search`). Its remaining
cost is that from its last node to the end.
"""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog

from argo_compiler.route.assignment import least_costs_between_steps
from argo_compiler.route.completion_bounds import StepSets, completion_costs
from argo_compiler.route.held_karp import can_end
from argo_compiler.route.network import StepNetwork
from argo_compiler.route.order_ideals import MOST_BITS, Masks, StepBits
from argo_compiler.route.problem import NEVER
from argo_compiler.route.pruning import Pruned

Vector = NDArray[np.int64]

_CHUNK = 16
"""number of bits of a mask in one table"""


class CompletionBound(Protocol):
    """Lower bounds on the remaining cost, for sets of steps and last nodes, and kinds of costs."""

    def remaining_cost_bounds(self, size: int, masks: Masks, last: Vector) -> NDArray[np.int64]:
        """Return lower bounds on the cost from each label's last node to the end of the route.

        Each label has a set of `size` steps in `masks`, and a node in `last`. The shape is (kinds
        of costs, labels); the costs are times or, as a second kind, times plus energies.
        """
        ...

    def can_end(self, size: int, masks: Masks) -> NDArray[np.bool_]:
        """Return, for each set of `size`, whether a route may end with it."""
        ...

    def can_occur_in_route(self, size: int, masks: Masks) -> NDArray[np.bool_]:
        """Return, for each set of `size`, whether a route may have it; others are not searched."""
        ...


class TableBound:
    """Bounds from tables for given sets, exact without time windows and battery."""

    def __init__(
        self, network: StepNetwork, bits: StepBits, sets: StepSets, costs: NDArray[np.int32]
    ) -> None:
        self._sets = sets
        self._least = completion_costs(network, bits, sets, costs)

    def remaining_cost_bounds(self, size: int, masks: Masks, last: Vector) -> NDArray[np.int64]:
        index, _ = self._sets.find(size, masks)
        return self._least[size][:, index, last].astype(np.int64)

    def can_end(self, size: int, masks: Masks) -> NDArray[np.bool_]:
        index, _ = self._sets.find(size, masks)
        return np.asarray(self._sets.can_end[size][index])

    def can_occur_in_route(self, size: int, masks: Masks) -> NDArray[np.bool_]:
        if size >= len(self._sets.layers):
            return np.zeros(len(masks), np.bool_)
        return self._sets.find(size, masks)[1]


class DualBound:
    """Bounds from dual prices of the assignment problem, for any number of sets.

    Each step has a price of leaving and one of entering; no arc costs less than the two prices at
    its ends. For networks without optional steps. Caches its tables for one size of sets.
    """

    def __init__(
        self, network: StepNetwork, pruned: Pruned, bits: StepBits, costs: list[NDArray[np.int64]]
    ) -> None:
        self._network, self._bits = network, bits
        prices = [_dual_prices(least_costs_between_steps(network, pruned, kind)) for kind in costs]
        self._leave = np.stack([leave for leave, _ in prices])
        self._enter = np.stack([enter for _, enter in prices])
        self._step = np.append(network.step, len(network.prize))
        self._tables_by_size: dict[int, list[NDArray[np.int64]]] = {}

    def remaining_cost_bounds(self, size: int, masks: Masks, last: Vector) -> NDArray[np.int64]:
        both = (self._leave + self._enter)[:, :-1]
        rest = np.repeat(both.sum(axis=1, keepdims=True), len(masks), axis=1)
        for chunk, sums in enumerate(self._sums(size, both)):
            rest -= sums[:, (masks >> (_CHUNK * chunk)) & ((1 << _CHUNK) - 1)]
        return np.asarray(self._leave[:, self._step[last]] + rest + self._enter[:, -1:])

    def _sums(self, size: int, both: NDArray[np.int64]) -> list[NDArray[np.int64]]:
        """Return tables of the sum of the steps' prices, for each value of each chunk of a mask.

        A chunk has `_CHUNK` bits; `both` has the sum of the two prices of each step. The first
        table includes the steps that all sets of `size` contain.
        """
        if size not in self._tables_by_size:
            undecided, tables = self._bits.steps_in_only_some_sets(size), []
            step_of_bit = {int(self._bits.bit(s)): s for s in np.flatnonzero(undecided).tolist()}
            certain = both[:, self._bits.steps_in_all_sets(size)].sum(axis=1, keepdims=True)
            for first in range(0, MOST_BITS, _CHUNK):
                table = certain if first == 0 else np.zeros_like(certain)
                for number in range(first, first + _CHUNK):
                    step = step_of_bit.get(1 << number)
                    more = table if step is None else table + both[:, step, None]
                    table = np.concatenate([table, more], axis=1)
                tables.append(table)
            self._tables_by_size = {size: tables}
        return self._tables_by_size[size]

    def can_end(self, size: int, masks: Masks) -> NDArray[np.bool_]:
        return can_end(self._network, self._bits, size, masks)

    def can_occur_in_route(self, size: int, masks: Masks) -> NDArray[np.bool_]:
        return np.full(len(masks), size <= len(self._network.prize))


def _dual_prices(costs: NDArray[np.int64]) -> tuple[Vector, Vector]:
    """Compute integer prices of rows and columns: the dual of the assignment problem.

    The price of a row and that of a column are together at most their cost. The sum of all prices
    is the highest possible one, except for rounding.
    """
    count = len(costs)
    rows, columns = np.nonzero(costs < NEVER)
    edges = np.arange(len(rows))
    matrix = np.zeros((2 * count, len(rows)), np.float32)
    matrix[rows, edges] = 1.0
    matrix[count + columns, edges] = 1.0
    solution = linprog(costs[rows, columns].astype(float), A_eq=matrix, b_eq=np.ones(2 * count))
    if not solution.success:
        return np.zeros(count, np.int64), np.zeros(count, np.int64)
    leave = np.floor(solution.eqlin.marginals[:count]).astype(np.int64)
    enter = (costs - leave[:, None]).min(axis=0)
    leave = (costs - enter[None, :]).min(axis=1)
    return leave, enter
