"""What lies between a task that is always done and the next one, reckoned in advance.

In the worst case, or on average where it is known how likely each way is. A way back is not
reckoned with: what may be repeated by a condition counts once.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.reorder.units import Spine, TaskUnit

Costs = NDArray[np.float64]
"""by the leaf that the robot comes from, and the destination, of which the first are the leaves"""
Row = NDArray[np.float64]
"""by destination"""
Likely = Mapping[tuple[int, int], float]
"""how likely it is that a leaf goes on to another one by its conditions"""


@dataclass(frozen=True)
class _Out:
    """A way on from a leaf."""

    target: int | None
    """a leaf that is looked at as well; None: it leads out"""
    extra: float
    """what further rounds of groups that end here take"""
    share: float | None
    """how likely; None: not known"""


class Branches:
    """Reckons the stops of a spine. Keeps how many rounds its groups have."""

    def __init__(self, spine: Spine, time: Costs, energy: Costs, unit: float, likely: Likely):
        """`time` in units of so many s; energy in whatever."""
        self._spine, self._time, self._energy = spine, time, energy
        self._unit, self._likely = unit, likely
        self._rounds: dict[int, float] = {}

    def time(self, stop: TaskUnit) -> Row:
        """From the end of a stop's first task to the end of what is done at each destination."""
        return self._row(stop, self._time, self._likely)

    def along(self, stop: TaskUnit) -> float:
        """From the end of a stop's first task to the end of its last, wherever that goes on to."""
        if len(stop.leaves) == 1:
            return 0.0
        inside, costs = frozenset(stop.leaves), self._time
        rows = self._after(
            stop.entry, inside, stop.level, costs, self._likely, lambda _: np.zeros(1)
        )
        return float(rows[0])

    def energy(self, stop: TaskUnit) -> Row:
        """The same, always in the worst case."""
        return self._row(stop, self._energy, {})

    def _row(self, stop: TaskUnit, costs: Costs, likely: Likely) -> Row:
        if len(stop.leaves) == 1 and not self._spine.flow.leaves[stop.entry].conditional:
            row: Row = costs[stop.entry]
            return row
        return self._after(
            stop.entry, frozenset(stop.leaves), stop.level, costs, likely, lambda leaf: costs[leaf]
        )

    def _after(
        self,
        entry: int,
        inside: frozenset[int],
        level: int,
        costs: Costs,
        likely: Likely,
        leaving: Callable[[int], Row],
    ) -> Row:
        """What follows the end of the entry; `leaving` is what it takes to lead out of a leaf."""
        outs = {leaf: self._outs(leaf, inside, level, costs, likely) for leaf in inside}
        order, back = _depth_first(entry, {k: [o.target for o in v] for k, v in outs.items()})
        values: dict[int, Row] = {}
        for leaf in order:
            ways: list[tuple[Row, float | None]] = []
            for out in outs[leaf]:
                if out.target is None:
                    ways.append((out.extra + leaving(leaf), out.share))
                elif (leaf, out.target) not in back:
                    step = costs[leaf, out.target] + out.extra
                    ways.append((step + values[out.target], out.share))
            values[leaf] = _joined(ways, np.full_like(leaving(leaf), -np.inf))
        return values[entry]

    def _outs(
        self, leaf: int, inside: frozenset[int], level: int, costs: Costs, likely: Likely
    ) -> list[_Out]:
        gates = self._spine.gates
        shares: dict[int, float | None] = {
            target: likely.get((leaf, target))
            for _, target in self._spine.flow.leaves[leaf].conditional
            if (leaf, target) not in gates
        }
        outs = [_Out(t if t in inside else None, 0.0, share) for t, share in shares.items()]
        node, extra = self._tail(leaf, level, costs)
        if node is not None and (leaf, node) not in gates:
            known = [share for share in shares.values() if share is not None]
            rest = max(0.0, 1.0 - sum(known)) if len(known) == len(shares) else None
            outs.append(_Out(node if node in inside else None, extra, rest))
        return outs

    def _tail(self, leaf: int, level: int, costs: Costs) -> tuple[int | None, float]:
        """Where the unconditional transition leads to when all groups below the level that end here
        have ended, and what their further rounds take. None: they are endless."""
        flow = self._spine.flow
        node, extra = flow.leaves[leaf].tail, 0.0
        group = flow.group_of_round_end(node)
        while group is not None and group != level:
            if not flow.groups[group].may_end:
                return None, 0.0
            extra += self._further_rounds(group, costs)
            node = flow.groups[group].onward
            group = flow.group_of_round_end(node)
        return node, extra

    def _further_rounds(self, number: int, costs: Costs) -> float:
        """What the rounds after the first one take."""
        group = self._spine.flow.groups[number]
        round_ = self._after(
            group.start,
            frozenset(range(group.first, group.last + 1)),
            number,
            costs,
            {},
            lambda leaf: np.array([0.0 if leaf == group.last else -np.inf]),
        )
        period = float(costs[group.last, group.start] + round_[0])
        if number not in self._rounds:  # times are asked for first
            rounds = group.count or np.inf
            if group.duration and period > 0.0:
                rounds = min(rounds, 1 + np.ceil(group.duration / self._unit / period))
            self._rounds[number] = rounds if np.isfinite(rounds) else 1.0
        return max(0.0, (self._rounds[number] - 1) * period)


def _joined(ways: list[tuple[Row, float | None]], nothing: Row) -> Row:
    """The mean of the ways if all shares are known, else the worst."""
    if not ways:
        return nothing
    shares = [share for _, share in ways if share is not None]
    if len(shares) == len(ways) and sum(shares) > 0.0:
        # 0 times inf is no number, and a way that is never taken no part of a mean.
        parts = [share * row for (row, _), share in zip(ways, shares, strict=True) if share > 0.0]
        return np.asarray(np.sum(parts, axis=0) / sum(shares))
    return np.asarray(np.max([row for row, _ in ways], axis=0))


def _depth_first(
    entry: int, following: Mapping[int, list[int | None]]
) -> tuple[list[int], set[tuple[int, int]]]:
    """The nodes reached, each after those that come next, and the steps that lead back."""
    order: list[int] = []
    back: set[tuple[int, int]] = set()
    done = {entry: False}
    stack = [(entry, 0)]
    while stack:
        node, at = stack.pop()
        targets = following[node]
        while at < len(targets):
            target = targets[at]
            at += 1
            if target is None or done.get(target):
                continue
            if target in done:
                back.add((node, target))
                continue
            done[target] = False
            stack += [(node, at), (target, 0)]
            break
        else:
            done[node] = True
            order.append(node)
    return order, back
