"""What is still to come at least, for labels of a dynamic programme: from tables or from prices."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog

from argo_compiler.route.assignment import least_between_steps
from argo_compiler.route.completion_bounds import Sets, to_come
from argo_compiler.route.held_karp import may_end
from argo_compiler.route.network import StepNetwork
from argo_compiler.route.order_ideals import MOST_BITS, Bits, Masks
from argo_compiler.route.problem import NEVER
from argo_compiler.route.pruning import Pruned

Vector = NDArray[np.int64]

_PART = 16
"""bits of a mask that are looked up at once"""


class LowerBound(Protocol):
    """Lower bounds for sets of steps with their last nodes, for some kinds of costs of arcs."""

    def to_come(self, size: int, masks: Masks, last: Vector) -> NDArray[np.int64]:
        """The least that is to come, shape (kinds, labels), in sets of that size."""
        ...

    def may_end(self, size: int, masks: Masks) -> NDArray[np.bool_]:
        """Whether the route may end with the sets."""
        ...

    def within(self, size: int, masks: Masks) -> NDArray[np.bool_]:
        """Whether the sets are among those that are gone through."""
        ...


class TableGuide:
    """The exact costs to come where there are no windows and no battery, for given sets."""

    def __init__(
        self, network: StepNetwork, bits: Bits, sets: Sets, kinds: NDArray[np.int32]
    ) -> None:
        self._sets = sets
        self._least = to_come(network, bits, sets, kinds)

    def to_come(self, size: int, masks: Masks, last: Vector) -> NDArray[np.int64]:
        place, _ = self._sets.find(size, masks)
        return self._least[size][:, place, last].astype(np.int64)

    def may_end(self, size: int, masks: Masks) -> NDArray[np.bool_]:
        place, _ = self._sets.find(size, masks)
        return np.asarray(self._sets.last[size][place])

    def within(self, size: int, masks: Masks) -> NDArray[np.bool_]:
        if size >= len(self._sets.layers):
            return np.zeros(len(masks), np.bool_)
        return self._sets.find(size, masks)[1]


class PriceGuide:
    """Prices of leaving and of entering each step that no arc costs less than together: the dual
    of the assignment problem. For any number of sets, where nothing may be left out."""

    def __init__(
        self, network: StepNetwork, pruned: Pruned, bits: Bits, kinds: list[NDArray[np.int64]]
    ) -> None:
        self._network, self._bits = network, bits
        prices = [_prices(least_between_steps(network, pruned, kind)) for kind in kinds]
        self._leave = np.stack([leave for leave, _ in prices])
        self._enter = np.stack([enter for _, enter in prices])
        self._step = np.append(network.step, len(network.prize))
        self._of_layer: dict[int, list[NDArray[np.int64]]] = {}

    def to_come(self, size: int, masks: Masks, last: Vector) -> NDArray[np.int64]:
        both = (self._leave + self._enter)[:, :-1]
        rest = np.repeat(both.sum(axis=1, keepdims=True), len(masks), axis=1)
        for part, sums in enumerate(self._sums(size, both)):
            rest -= sums[:, (masks >> (_PART * part)) & ((1 << _PART) - 1)]
        return np.asarray(self._leave[:, self._step[last]] + rest + self._enter[:, -1:])

    def _sums(self, size: int, both: NDArray[np.int64]) -> list[NDArray[np.int64]]:
        """For each value of some bits of a mask together, what the steps made are worth: in the
        first table, those that all sets of that size have are included."""
        if size not in self._of_layer:
            doubt, tables = self._bits.in_doubt(size), []
            bit_of = {int(self._bits.bit(s)): s for s in np.flatnonzero(doubt).tolist()}
            sure = both[:, self._bits.surely(size)].sum(axis=1, keepdims=True)
            for first in range(0, MOST_BITS, _PART):
                table = sure if first == 0 else np.zeros_like(sure)
                for number in range(first, first + _PART):
                    step = bit_of.get(1 << number)
                    more = table if step is None else table + both[:, step, None]
                    table = np.concatenate([table, more], axis=1)
                tables.append(table)
            self._of_layer = {size: tables}
        return self._of_layer[size]

    def may_end(self, size: int, masks: Masks) -> NDArray[np.bool_]:
        return may_end(self._network, self._bits, size, masks)

    def within(self, size: int, masks: Masks) -> NDArray[np.bool_]:
        return np.full(len(masks), size <= len(self._network.prize))


def _prices(costs: NDArray[np.int64]) -> tuple[Vector, Vector]:
    """Whole prices of rows and columns of which no pair is worth more than its cost, and together
    as much as they can be but for rounding."""
    count = len(costs)
    rows, columns = np.nonzero(costs < NEVER)
    edges = np.arange(len(rows))
    matrix = np.zeros((2 * count, len(rows)), np.float32)
    matrix[rows, edges] = 1.0
    matrix[count + columns, edges] = 1.0
    answer = linprog(costs[rows, columns].astype(float), A_eq=matrix, b_eq=np.ones(2 * count))
    if not answer.success:
        return np.zeros(count, np.int64), np.zeros(count, np.int64)
    leave = np.floor(answer.eqlin.marginals[:count]).astype(np.int64)
    enter = (costs - leave[:, None]).min(axis=0)
    leave = (costs - enter[None, :]).min(axis=1)
    return leave, enter
