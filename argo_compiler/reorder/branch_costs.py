"""Costs of the conditional tasks between a task that is always done and the next such task.

The costs are those of the worst case, or the mean where the probability of each transition is
known. Transitions that lead back are ignored: tasks in a conditional loop count once.

A leaf is a state of the mission's state machine that executes one task; leaves are named by their
numbers in the flow (see `argo_compiler.analysis.flow`).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.reorder.units import TaskUnit, UnitChain

Costs = NDArray[np.float64]
"""indexed by the leaf that the robot comes from and the destination; leaves come first"""
Row = NDArray[np.float64]
"""indexed by destination"""
Probabilities = Mapping[tuple[int, int], float]
"""probability of each conditional transition, by the leaves that it connects"""


@dataclass(frozen=True)
class _Branch:
    """Transition from a leaf of a unit."""

    target: int | None
    """next leaf in the same unit; None if the transition leaves the unit"""
    extra: float
    """cost of the further rounds of groups that end here"""
    probability: float | None
    """probability that the transition is taken; None if it is unknown"""


class BranchCosts:
    """Computation of the costs of a chain's units. Caches the numbers of rounds of its groups."""

    def __init__(
        self,
        chain: UnitChain,
        time: Costs,
        energy: Costs,
        seconds: float,
        probabilities: Probabilities,
    ):
        """Store the costs: `time` in units of `seconds` each, `energy` in any unit."""
        self._chain, self._time, self._energy = chain, time, energy
        self._seconds, self._probabilities = seconds, probabilities
        self._rounds: dict[int, float] = {}

    def times_to_destinations(self, unit: TaskUnit) -> Row:
        """Return the times from the end of a unit's first task to the end of each destination.

        A destination is a task with its action, a charger, or the mission's end; they have the
        order of the costs' columns. The times are in
        units of time, and include the conditional tasks of the unit: in the worst case, or in the
        mean where probabilities are known.
        """
        return self._row(unit, self._time, self._probabilities)

    def time_units_after_first_task(self, unit: TaskUnit) -> float:
        """Return the time from the end of a unit's first task to the end of its last one.

        It is in units of time, for the worst case or the mean as in `times_to_destinations`, and 0
        if the unit has one task.
        """
        if len(unit.leaves) == 1:
            return 0.0
        inside, costs = frozenset(unit.leaves), self._time
        rows = self._after(
            unit.entry, inside, unit.level, costs, self._probabilities, lambda _: np.zeros(1)
        )
        return float(rows[0])

    def energies_to_destinations(self, unit: TaskUnit) -> Row:
        """Return the energies of what `times_to_destinations` counts, always in the worst case."""
        return self._row(unit, self._energy, {})

    def _row(self, unit: TaskUnit, costs: Costs, probabilities: Probabilities) -> Row:
        if len(unit.leaves) == 1 and not self._chain.flow.leaves[unit.entry].conditional:
            row: Row = costs[unit.entry]
            return row
        return self._after(
            unit.entry,
            frozenset(unit.leaves),
            unit.level,
            costs,
            probabilities,
            lambda leaf: costs[leaf],
        )

    def _after(
        self,
        entry: int,
        inside: frozenset[int],
        level: int,
        costs: Costs,
        probabilities: Probabilities,
        leaving: Callable[[int], Row],
    ) -> Row:
        """Return the costs from the end of leaf `entry` to the destinations, over leaves `inside`.

        `leaving` returns the costs from the last of these leaves on. Further rounds of groups are
        included for the groups inside of `level`, not for `level` itself (NOWHERE: the mission).
        """
        branches = {
            leaf: self._branches(leaf, inside, level, costs, probabilities) for leaf in inside
        }
        order, back = _depth_first(entry, {k: [o.target for o in v] for k, v in branches.items()})
        values: dict[int, Row] = {}
        for leaf in order:
            options: list[tuple[Row, float | None]] = []
            for branch in branches[leaf]:
                if branch.target is None:
                    options.append((branch.extra + leaving(leaf), branch.probability))
                elif (leaf, branch.target) not in back:
                    step = costs[leaf, branch.target] + branch.extra
                    options.append((step + values[branch.target], branch.probability))
            values[leaf] = _combined(options, np.full_like(leaving(leaf), -np.inf))
        return values[entry]

    def _branches(
        self,
        leaf: int,
        inside: frozenset[int],
        level: int,
        costs: Costs,
        probabilities: Probabilities,
    ) -> list[_Branch]:
        early_exits = self._chain.early_exits
        by_target: dict[int, float | None] = {
            target: probabilities.get((leaf, target))
            for _, target in self._chain.flow.leaves[leaf].conditional
            if (leaf, target) not in early_exits
        }
        branches = [
            _Branch(t if t in inside else None, 0.0, probability)
            for t, probability in by_target.items()
        ]
        node, extra = self._tail(leaf, level, costs)
        if node is not None and (leaf, node) not in early_exits:
            known = [p for p in by_target.values() if p is not None]
            rest = max(0.0, 1.0 - sum(known)) if len(known) == len(by_target) else None
            branches.append(_Branch(node if node in inside else None, extra, rest))
        return branches

    def _tail(self, leaf: int, level: int, costs: Costs) -> tuple[int | None, float]:
        """Return the node that follows a leaf without a condition, and the cost of further rounds.

        These are the further rounds of all groups below `level` that end with the leaf; the node
        follows after all of them. It is None if one of the groups is endless.
        """
        flow = self._chain.flow
        node, extra = flow.leaves[leaf].unconditional, 0.0
        group = flow.group_of_round_end(node)
        while group is not None and group != level:
            if not flow.groups[group].has_limit_or_until:
                return None, 0.0
            extra += self._further_rounds(group, costs)
            node = flow.groups[group].successor
            group = flow.group_of_round_end(node)
        return node, extra

    def _further_rounds(self, number: int, costs: Costs) -> float:
        """Return the cost of all rounds of group `number` after the first one.

        It is 0 for an endless group. A duration limits the number of rounds.
        """
        group = self._chain.flow.groups[number]
        round_ = self._after(
            group.start,
            frozenset(range(group.first, group.last + 1)),
            number,
            costs,
            {},
            lambda leaf: np.array([0.0 if leaf == group.last else -np.inf]),
        )
        period = float(costs[group.last, group.start] + round_[0])
        if number not in self._rounds:  # first set for times, and then used for energies as well
            rounds = group.count or np.inf
            if group.duration and period > 0.0:
                rounds = min(rounds, 1 + np.ceil(group.duration / self._seconds / period))
            self._rounds[number] = rounds if np.isfinite(rounds) else 1.0
        return max(0.0, (self._rounds[number] - 1) * period)


def _combined(options: list[tuple[Row, float | None]], default: Row) -> Row:
    """Return the mean of rows of costs if all their probabilities are known, else the worst.

    `default` is the result if there are no rows.
    """
    if not options:
        return default
    known = [p for _, p in options if p is not None]
    if len(known) == len(options) and sum(known) > 0.0:
        # 0 times inf is not a number, and an option that is never taken is not part of the mean.
        parts = [p * row for (row, _), p in zip(options, known, strict=True) if p > 0.0]
        return np.asarray(np.sum(parts, axis=0) / sum(known))
    return np.asarray(np.max([row for row, _ in options], axis=0))


def _depth_first(
    entry: int, following: Mapping[int, list[int | None]]
) -> tuple[list[int], set[tuple[int, int]]]:
    """Return the nodes reached from `entry`, successors first, and the edges that lead back."""
    order: list[int] = []
    back: set[tuple[int, int]] = set()
    is_done = {entry: False}
    stack = [(entry, 0)]
    while stack:
        node, at = stack.pop()
        targets = following[node]
        while at < len(targets):
            target = targets[at]
            at += 1
            if target is None or is_done.get(target):
                continue
            if target in is_done:
                back.add((node, target))
                continue
            is_done[target] = False
            stack += [(node, at), (target, 0)]
            break
        else:
            is_done[node] = True
            order.append(node)
    return order, back
