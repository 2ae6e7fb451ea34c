"""Sets of steps as bits of integers.

Consider a route with all s steps, and a step with p predecessors and f successors. After k steps
of the route, the step is certainly made if k >= s - f, and certainly not made if k <= p. It needs a
bit only for the values of k between, where it is undecided. Steps that are undecided for different
values of k share a bit. So problems of hundreds of steps with many precedences fit into 62 bits.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.network import StepNetwork
from argo_compiler.route.pruning import Pruned

Masks = NDArray[np.int64]

MOST_BITS = 62


@dataclass(frozen=True, eq=False)
class LayerRules:
    """Rules for the nodes that may follow sets of k steps; arrays have one entry per node."""

    bit: Masks
    """bit of the node's step in sets of k + 1 steps; 0: all sets with the node contain the step"""
    needs: Masks
    """bits of the steps that the node needs, in sets of k steps"""
    ruled_out_by: Masks
    """bits of the steps that rule out the node, in sets of k steps, with that of its own step"""
    open: NDArray[np.bool_]
    """true if the node may follow some set"""
    unchanged: np.int64
    """bits with the same meaning in sets of k and of k + 1 steps; other bits start as 0"""

    def rows_node_may_follow(self, masks: Masks, node: int) -> NDArray[np.int64]:
        """Return the indices in `masks` of the sets of steps that the node may follow."""
        if not self.open[node]:
            return np.zeros(0, np.int64)
        needs, ruled = self.needs[node], self.ruled_out_by[node]
        return np.flatnonzero(((masks & needs) == needs) & ((masks & ruled) == 0))

    def with_node(self, masks: Masks, node: int) -> Masks:
        """Return the sets with the node's step added."""
        return np.asarray((masks & self.unchanged) | self.bit[node])


class StepBits:
    """Bits of a network's steps, which caches the rules for sets of each size."""

    def __init__(self, network: StepNetwork, pruned: Pruned) -> None:
        self._network, self._pruned = network, pruned
        count = len(network.prize)
        self.shared = count > MOST_BITS and not network.selective
        self._from = np.zeros(count, np.int64)
        """largest size of the sets that cannot contain each step"""
        self._to = np.full(count, count + 1, np.int64)
        """smallest size of the sets that all contain each step"""
        if self.shared:
            self._from = pruned.needs.sum(axis=0)
            self._to = count - pruned.needs.sum(axis=1)
        self._number = self._assign_numbers()
        self._rules_by_size: dict[int, LayerRules] = {}

    @property
    def fits(self) -> bool:
        """True if the bits of all steps fit into a mask."""
        return int(self._number.max(initial=-1)) < MOST_BITS

    def _assign_numbers(self) -> Masks:
        """Return the number of each step's bit.

        It is the lowest that is free at all sizes at which only some sets contain the step.
        """
        if not self.shared:
            return np.arange(len(self._from))
        free_from: list[int] = []
        numbers = np.zeros(len(self._from), np.int64)
        for s in np.argsort(self._from, kind="stable").tolist():
            first, last = int(self._from[s]), int(self._to[s])
            for number, free in enumerate(free_from):
                if free <= first:
                    free_from[number] = last
                    break
            else:
                number = len(free_from)
                free_from.append(last)
            numbers[s] = number
            if number >= MOST_BITS:
                break  # they don't fit, whatever follows
        return numbers

    def steps_in_only_some_sets(self, size: int) -> NDArray[np.bool_]:
        """Return, for each step, whether only some sets of `size` contain it: then it has a bit."""
        return np.asarray((self._from < size) & (size < self._to))

    def steps_in_all_sets(self, size: int) -> NDArray[np.bool_]:
        """Return, for each step, whether all sets of `size` contain it."""
        return np.asarray(size >= self._to)

    def mask(self, steps: NDArray[np.bool_]) -> np.int64:
        """Return the bits of those steps for which `steps`, an array over all steps, is true."""
        total = np.int64(0)
        for number in self._number[steps].tolist():
            total |= np.int64(1) << np.int64(number)
        return total

    def bit(self, step: int) -> np.int64:
        return np.int64(1) << np.int64(self._number[step])

    def layer(self, size: int) -> LayerRules:
        """Return the rules for sets of `size`."""
        if size not in self._rules_by_size:
            self._rules_by_size[size] = self._rules(size)
        return self._rules_by_size[size]

    def _rules(self, size: int) -> LayerRules:
        network, pruned = self._network, self._pruned
        undecided, certain = self.steps_in_only_some_sets(size), self.steps_in_all_sets(size)
        undecided_next = self.steps_in_only_some_sets(size + 1)
        bit, needs, ruled = (np.zeros(len(undecided), np.int64) for _ in range(3))
        may = pruned.steps & ~certain & (self._from <= size)
        may[may] &= ~pruned.needs[~undecided & ~certain][:, may].any(axis=0)
        may[may] &= ~pruned.before[may][:, certain].any(axis=1)
        for s in np.flatnonzero(may).tolist():
            bit[s] = self.bit(s) if undecided_next[s] else 0
            needs[s] = self.mask(pruned.needs[:, s] & undecided)
            ruled[s] = self.mask(pruned.before[s] & undecided) | (
                self.bit(s) if undecided[s] else 0
            )
        step = network.step
        unchanged = self.mask(undecided & undecided_next)
        return LayerRules(bit[step], needs[step], ruled[step], may[step], unchanged)
