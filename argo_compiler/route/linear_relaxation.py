"""A linear relaxation with cuts: bounds in whole numbers, and the arcs that no better route has.

What is made small is a sum of costs of arcs. Each step is entered once at most, each node left as
often as it is entered, the maximum duration kept; and any set of steps is entered as often as each
step in it, a cut that is added where it does not hold (Dantzig, Fulkerson, Johnson, 1954). GLOP
works with some of the arcs, to which those are added that may pay. It reckons with fractions and
tolerances, so that only its prices are used, rounded: with whatever prices, the Lagrangean bound
(Held, Karp, 1971) is one, and here it is reckoned in whole numbers.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from ortools.graph.python import max_flow
from ortools.linear_solver import pywraplp

from argo_compiler.route.network import StepNetwork
from argo_compiler.route.problem import NEVER
from argo_compiler.route.pruning import Pruned, least_arc_times
from argo_compiler.route.search import Search

Numbers = NDArray[np.int64]
Mask = NDArray[np.bool_]

_BITS = 52
"""sums up to that size are exact in floating point too"""
_FLOW = 1 << 24
"""what a step that is made once lets through"""
_VIOLATED = 0.02
"""by which a cut must not hold to be worth it"""
_NEAR = 6
"""arcs from and to each node to begin with"""
_COLUMNS = 200
"""arcs to be added at once"""
_WORK = 2e-6, 1e-4
"""s of work for a row, in an iteration, and for a flow"""


@dataclass(frozen=True, eq=False)
class LinearRow:
    """What the arcs of a route come to is `least` at least, or just that; shapes (m + 1,)."""

    tails: Mask
    heads: Mask
    """an arc from the one to the other counts 1"""
    leave: Numbers
    enter: Numbers
    """and what its ends count"""
    least: int
    equal: bool = False
    weights: Numbers | None = None
    """and what it counts itself, shape (m + 1, m + 1)"""

    def of(self, tail: Numbers, head: Numbers) -> Numbers:
        """What some arcs count."""
        own = 0 if self.weights is None else self.weights[tail, head]
        across = (self.tails[tail] & self.heads[head]).astype(np.int64)
        return np.asarray(across + self.leave[tail] + self.enter[head] + own)


@dataclass(frozen=True, eq=False)
class _Priced:
    """What prices of the rows prove. All in units of 1 / scale of a cost."""

    prices: Numbers
    total: int
    """no route costs less"""
    reduced: Numbers
    """of each arc, shape (m + 1, m + 1)"""
    entered: Numbers
    """the least of them into each step; 0 at most where it may be left out"""


class LinearRelaxation:
    """Has state: the rows and arcs that are in, and the best prices so far."""

    def __init__(
        self, network: StepNetwork, pruned: Pruned, costs: Numbers, least_prize: int | None = None
    ) -> None:
        """`costs` of arcs, shape (m + 1, m + 1); `least_prize`: only routes that win as much."""
        m = network.size
        self._network = network
        self._home = np.append(network.step, len(network.prize))
        self._must = np.append(network.mandatory, True)
        times = least_arc_times(network) + np.append(network.service, 0)[None, :]
        self._arcs = pruned.arcs.copy()
        # The way straight to the end.
        self._arcs[m, m] = not network.mandatory.any() and times[m, m] < NEVER
        self._costs = np.where(self._arcs, costs, 0)
        most = int(np.abs(self._costs).max())
        self._scale = 1 << max(0, min(20, 40 - most.bit_length()))
        self._missing = 4 * most + 1
        """the cost of what is lacking: so that there always is a solution"""
        self._in = np.zeros_like(self._arcs)
        self._tail = self._head = np.zeros(0, np.int64)
        self._rows: list[LinearRow] = []
        self._glop = pywraplp.Solver.CreateSolver("GLOP")
        self._glop.Objective().SetMinimization()
        self._variables: list[pywraplp.Variable] = []
        self._constraints: list[pywraplp.Constraint] = []
        self._once = [
            self._constraint(1, equal=True) if must else self._glop.Constraint(0.0, 1.0)
            for must in self._must.tolist()
        ]
        self._best: _Priced | None = None
        self._begin(np.where(self._arcs, times, 0), least_prize)
        near = np.where(self._arcs, times, NEVER)
        k = min(_NEAR, m)
        rows, columns = (np.partition(near, k, axis).take([k], axis) for axis in (0, 1))
        self._add_arcs((near <= rows) | (near <= columns))

    @property
    def bound(self) -> int | None:
        """No route costs less; None: nothing is known."""
        return None if self._best is None else -(-self._best.total // self._scale)

    @property
    def cuts(self) -> list[LinearRow]:
        """Those that the bound rests on."""
        prices = [] if self._best is None else self._best.prices.tolist()
        pairs = zip(prices, self._rows, strict=False)
        return [row for p, row in pairs if p > 0 and not row.equal and row.weights is None]

    def left(self, most: int) -> tuple[Mask, Mask]:
        """The arcs that a route of that cost at most may have, and the steps that it must make."""
        if self._best is None:
            return self._arcs.copy(), self._must[:-1]
        spare = most * self._scale - self._best.total
        entered = self._best.entered
        arcs = self._arcs & (self._best.reduced - entered[self._home][None, :] <= spare)
        return arcs, (self._must | (-entered > spare))[:-1]

    def solve(self, search: Search, enough: int | None) -> None:
        """Raises the bound until it is enough, no cut is found, or the time is over."""
        added = False
        while search.remaining() > 0.0:
            simplex = "true" if added else "false"
            self._glop.SetSolverSpecificParametersAsString(
                f"use_preprocessing: false use_dual_simplex: {simplex}"
            )
            if search.timed:
                self._glop.SetTimeLimit(max(1, int(1e3 * search.remaining())))
            status = self._glop.Solve()
            search.spend(_WORK[0] * len(self._rows) * (1 + self._glop.iterations()))
            if status != pywraplp.Solver.OPTIMAL:
                return
            priced = self._priced()
            if priced is None:
                return
            if self._best is None or priced.total > self._best.total:
                self._best = priced
            if enough is not None and self.bound is not None and self.bound >= enough:
                return
            paying = self._paying(priced)
            added = not paying.any()
            if not added:
                self._add_arcs(paying)
                continue
            cuts = list(self._violated(search))
            for cut in cuts:
                self._add_row(cut)
            if not cuts:
                return

    # The linear programme

    def _begin(self, times: Numbers, least_prize: int | None) -> None:
        network, m = self._network, self._network.size
        none, zeros = np.zeros(m + 1, np.bool_), np.zeros(m + 1, np.int64)
        for unit in np.eye(m, m + 1, dtype=np.int64):
            self._add_row(LinearRow(none, none, -unit, unit, 0, equal=True))
        if network.limit < NEVER:
            self._add_row(LinearRow(none, none, zeros, zeros, -network.limit, weights=-times))
        if least_prize is not None:
            prize = np.append(network.prize, 0)[self._home]
            self._add_row(LinearRow(none, none, zeros, prize, least_prize))

    def _constraint(self, least: int, *, equal: bool) -> pywraplp.Constraint:
        most = float(least) if equal else self._glop.infinity()
        constraint = self._glop.Constraint(float(least), most)
        if least > 0:
            self._variable(self._missing, [(constraint, least)])
        return constraint

    def _variable(
        self, cost: int, counts: list[tuple[pywraplp.Constraint, int]]
    ) -> pywraplp.Variable:
        variable = self._glop.NumVar(0.0, self._glop.infinity(), "")
        self._glop.Objective().SetCoefficient(variable, float(cost))
        for constraint, count in counts:
            constraint.SetCoefficient(variable, float(count))
        return variable

    def _add_arcs(self, chosen: Mask) -> None:
        chosen = chosen & self._arcs & ~self._in
        self._in |= chosen
        tail, head = np.nonzero(chosen)
        self._tail, self._head = np.append(self._tail, tail), np.append(self._head, head)
        new = [
            self._variable(int(self._costs[i, j]), [(self._once[self._home[j]], 1)])
            for i, j in zip(tail.tolist(), head.tolist(), strict=True)
        ]
        self._variables += new
        for row, constraint in zip(self._rows, self._constraints, strict=True):
            _count(constraint, new, row.of(tail, head))

    def _add_row(self, row: LinearRow) -> None:
        constraint = self._constraint(row.least, equal=row.equal)
        self._rows.append(row)
        self._constraints.append(constraint)
        _count(constraint, self._variables, row.of(self._tail, self._head))

    # Prices

    def _priced(self) -> _Priced | None:
        """What GLOP's prices prove; None: they are too large to be reckoned with."""
        rows, costs = self._rows, self._costs * self._scale
        fractions = np.array([constraint.dual_value() for constraint in self._constraints])
        if not np.abs(fractions).max(initial=0.0) * self._scale < 1 << _BITS:
            return None
        prices = np.rint(fractions * self._scale).astype(np.int64)
        prices = np.where([row.equal for row in rows], prices, np.maximum(prices, 0))
        largest = int(np.abs(costs).max())
        for price, row in zip(prices.tolist(), rows, strict=True):
            own = 0 if row.weights is None else int(np.abs(row.weights).max())
            ends = int(np.abs(row.leave).max()) + int(np.abs(row.enter).max())
            largest += abs(price) * (1 + own + ends)
        if largest >= 1 << _BITS:
            return None
        tails = prices[:, None] * np.array([row.tails for row in rows])
        heads = np.array([row.heads for row in rows], np.float64)
        reduced = costs - np.rint(tails.T.astype(np.float64) @ heads).astype(np.int64)
        reduced -= (prices @ np.array([row.leave for row in rows]))[:, None]
        reduced -= (prices @ np.array([row.enter for row in rows]))[None, :]
        for price, row in zip(prices.tolist(), rows, strict=True):
            if row.weights is not None:
                reduced -= price * row.weights
        entered = self._least_into(reduced, self._arcs)
        total = sum(p * row.least for p, row in zip(prices.tolist(), rows, strict=True))
        return _Priced(prices, total + sum(entered.tolist()), reduced, entered)

    def _least_into(self, reduced: Numbers, arcs: Mask) -> Numbers:
        least = np.full(len(self._must), 1 << _BITS, np.int64)
        np.minimum.at(least, self._home, np.where(arcs, reduced, 1 << _BITS).min(axis=0))
        return np.where(self._must, least, np.minimum(least, 0))

    def _paying(self, priced: _Priced) -> Mask:
        """Some arcs outside that cost less than those that are in."""
        least = self._least_into(priced.reduced, self._in)
        least = np.minimum(least, self._missing * self._scale)
        saved = least[self._home][None, :] - priced.reduced
        saved = np.where(self._arcs & ~self._in, saved, 0)
        order = np.partition(saved.ravel(), -min(_COLUMNS, saved.size))
        return np.asarray(saved > max(order[-min(_COLUMNS, saved.size)], self._scale / 1000))

    # Cuts

    def _violated(self, search: Search) -> Iterator[LinearRow]:
        """Sets that are entered less often than a step in them, by flows from the start."""
        count = len(self._must) - 1
        flow = np.zeros((count + 1, count + 1))
        values = [variable.solution_value() for variable in self._variables]
        np.add.at(flow, (self._home[self._tail], self._home[self._head]), values)
        np.fill_diagonal(flow, 0.0)
        made = flow.sum(axis=0)
        tail, head = np.nonzero(flow > 0.0)
        graph = max_flow.SimpleMaxFlow()
        graph.add_arc_with_capacity(count, 0, 0)  # the start is there in any case
        graph.add_arcs_with_capacity(tail, head, np.rint(flow[tail, head] * _FLOW).astype(int))
        covered = np.zeros(count + 1, np.bool_)
        for step in np.argsort(-made[:count], kind="stable").tolist():
            if covered[step] or made[step] < _VIOLATED:
                continue
            graph.solve(count, step)
            search.spend(_WORK[1])
            if graph.optimal_flow() >= (made[step] - _VIOLATED) * _FLOW:
                continue
            small = np.zeros(count + 1, np.bool_)
            small[graph.get_sink_side_min_cut()] = True
            large = np.ones(count + 1, np.bool_)
            large[graph.get_source_side_min_cut()] = False
            covered |= small
            yield self._cut(small, made)
            if (small != large).any():
                yield self._cut(large, made)

    def _cut(self, steps: Mask, made: NDArray[np.float64]) -> LinearRow:
        """Those steps are entered, if the one is that is made most."""
        inside, zeros = steps[self._home], np.zeros(len(self._home), np.int64)
        if (self._must & steps).any():
            return LinearRow(~inside, inside, zeros, zeros, 1)
        step = int(np.argmax(np.where(steps, made, -1.0)))
        return LinearRow(~inside, inside, zeros, -(self._home == step).astype(np.int64), 0)


def _count(
    constraint: pywraplp.Constraint, variables: list[pywraplp.Variable], counts: Numbers
) -> None:
    for k in np.flatnonzero(counts).tolist():
        constraint.SetCoefficient(variables[k], float(counts[k]))
