"""Sets of steps as bits of whole numbers.

After k of the s steps of a route that leaves nothing out, a step with p steps before it and f after
it in the order is surely made if k >= s - f, and surely not if k <= p. Only between does it need a
bit, and steps whose times of doubt do not overlap share one: so strongly ordered problems of
hundreds of steps fit into 62 bits.
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
    """What holds for sets of k steps: which nodes may come next. Arrays have an entry a node."""

    bit: Masks
    """of the node's step, among sets of k + 1 steps; 0: it is in all of them that follow"""
    needs: Masks
    """bits of sets of k steps"""
    ruled_out_by: Masks
    """bits of sets of k steps; that of the step itself included"""
    open: NDArray[np.bool_]
    """whether the node can come next at all"""
    kept: np.int64
    """the bits that stay as they are from sets of k to sets of k + 1 steps; others begin as 0"""

    def rows(self, masks: Masks, node: int) -> NDArray[np.int64]:
        """The rows of the sets after which the node may come."""
        if not self.open[node]:
            return np.zeros(0, np.int64)
        needs, ruled = self.needs[node], self.ruled_out_by[node]
        return np.flatnonzero(((masks & needs) == needs) & ((masks & ruled) == 0))

    def after(self, masks: Masks, node: int) -> Masks:
        """The sets with the node's step."""
        return np.asarray((masks & self.kept) | self.bit[node])


class Bits:
    """The bits of a network's steps."""

    def __init__(self, network: StepNetwork, pruned: Pruned) -> None:
        self._network, self._pruned = network, pruned
        count = len(network.prize)
        self.shared = count > MOST_BITS and not network.selective
        self._from = np.zeros(count, np.int64)
        """of each step, how many steps the smallest sets have that it may be in, less 1"""
        self._to = np.full(count, count + 1, np.int64)
        """how many steps the smallest sets have that it must be in"""
        if self.shared:
            self._from = pruned.needs.sum(axis=0)
            self._to = count - pruned.needs.sum(axis=1)
        self._number = self._numbers()
        self._of_layer: dict[int, LayerRules] = {}

    @property
    def fits(self) -> bool:
        """Whether there are bits enough."""
        return int(self._number.max(initial=-1)) < MOST_BITS

    def _numbers(self) -> Masks:
        """The number of each step's bit: the first that is free when the step may first be made."""
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

    def in_doubt(self, size: int) -> NDArray[np.bool_]:
        """The steps that have a bit in sets of that size: those that only some of them have."""
        return np.asarray((self._from < size) & (size < self._to))

    def surely(self, size: int) -> NDArray[np.bool_]:
        """The steps that all sets of that size have."""
        return np.asarray(size >= self._to)

    def mask(self, steps: NDArray[np.bool_]) -> np.int64:
        """The bits of some steps."""
        total = np.int64(0)
        for number in self._number[steps].tolist():
            total |= np.int64(1) << np.int64(number)
        return total

    def bit(self, step: int) -> np.int64:
        return np.int64(1) << np.int64(self._number[step])

    def layer(self, size: int) -> LayerRules:
        """The rules for sets of that size."""
        if size not in self._of_layer:
            self._of_layer[size] = self._rules(size)
        return self._of_layer[size]

    def _rules(self, size: int) -> LayerRules:
        network, pruned = self._network, self._pruned
        doubt, sure = self.in_doubt(size), self.surely(size)
        doubt_after = self.in_doubt(size + 1)
        bit, needs, ruled = (np.zeros(len(doubt), np.int64) for _ in range(3))
        may = pruned.steps & ~sure & (self._from <= size)
        may[may] &= ~pruned.needs[~doubt & ~sure][:, may].any(axis=0)
        may[may] &= ~pruned.before[may][:, sure].any(axis=1)
        for s in np.flatnonzero(may).tolist():
            bit[s] = self.bit(s) if doubt_after[s] else 0
            needs[s] = self.mask(pruned.needs[:, s] & doubt)
            ruled[s] = self.mask(pruned.before[s] & doubt) | (self.bit(s) if doubt[s] else 0)
        step = network.step
        kept = self.mask(doubt & doubt_after)
        return LayerRules(bit[step], needs[step], ruled[step], may[step], kept)
