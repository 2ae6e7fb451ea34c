"""Linear relaxation with cuts: integer bounds, and the arcs that no better route has.

It minimises a sum of arc costs. Each step is entered at most once, each node is left as often as it
is entered, and the maximum duration is met. Any set of steps is entered at least as often as each
step in it; these cuts are added when they are violated (Dantzig, Fulkerson, Johnson, 1954). GLOP
solves the programme with some of the arcs, and arcs with negative reduced costs are added. As GLOP
computes in floating point with tolerances, only its dual prices are used, rounded to integers: the
Lagrangean bound (Held, Karp, 1971) is valid for any prices, and is computed in integers here.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from ortools.graph.python import max_flow
from ortools.linear_solver import pywraplp

from argo_compiler.route.network import StepNetwork
from argo_compiler.route.problem import NEVER
from argo_compiler.route.pruning import Pruned, least_arc_times_without_service
from argo_compiler.route.search import Search

Numbers = NDArray[np.int64]
Mask = NDArray[np.bool_]

_BITS = 52
"""bits of the largest sums, which are exact in floating point as well"""
_FLOW = 1 << 24
"""integer flow that corresponds to a step made once"""
_LEAST_VIOLATION = 0.02
"""least violation of a cut that is added"""
_NEAR = 6
"""number of arcs from and to each node at the start"""
_COLUMNS = 200
"""highest number of arcs that are added at once"""
_WORK = 2e-6, 1e-4
"""nominal s of work for a row in an iteration, and for a flow"""


@dataclass(frozen=True, eq=False)
class LinearRow:
    """Constraint: the weighted sum of a route's arcs is at least, or equal to, `least`.

    The coefficient of an arc is a sum of four terms; arrays have the shape (m + 1,).
    """

    tails: Mask
    heads: Mask
    """1 for an arc from one of `tails` to one of `heads`"""
    leave: Numbers
    enter: Numbers
    """the value of `leave` at the arc's tail, and that of `enter` at its head"""
    least: int
    equal: bool = False
    weights: Numbers | None = None
    """the value of the arc itself, shape (m + 1, m + 1); None: 0"""

    def coefficients(self, tail: Numbers, head: Numbers) -> Numbers:
        """Return the coefficients of the arcs with these tails and heads, which are nodes."""
        own = 0 if self.weights is None else self.weights[tail, head]
        across = (self.tails[tail] & self.heads[head]).astype(np.int64)
        return np.asarray(across + self.leave[tail] + self.enter[head] + own)


@dataclass(frozen=True, eq=False)
class _DualSolution:
    """Dual prices of the rows and the bound that they prove, in units of 1 / scale of a cost."""

    prices: Numbers
    total: int
    """lower bound on the cost of all routes"""
    reduced: Numbers
    """reduced cost of each arc, shape (m + 1, m + 1)"""
    entered: Numbers
    """least reduced cost of an arc into each step; at most 0 for optional steps"""


class LinearRelaxation:
    """Linear programme with rows and arcs that are added, and the best dual prices so far."""

    def __init__(
        self, network: StepNetwork, pruned: Pruned, costs: Numbers, least_prize: int | None = None
    ) -> None:
        """Build the programme.

        `costs`: costs of arcs, shape (m + 1, m + 1); `least_prize`: lower limit on the prize of
        routes, or None.
        """
        m = network.node_count
        self._network = network
        self._step = np.append(network.step, len(network.prize))
        self._mandatory = np.append(network.mandatory, True)
        times = least_arc_times_without_service(network) + np.append(network.service, 0)[None, :]
        self._arcs = pruned.arcs.copy()
        # The arc from the start straight to the end.
        self._arcs[m, m] = not network.mandatory.any() and times[m, m] < NEVER
        self._costs = np.where(self._arcs, costs, 0)
        most = int(np.abs(self._costs).max())
        self._scale = 1 << max(0, min(20, 40 - most.bit_length()))
        self._penalty = 4 * most + 1
        """cost of the artificial variables, with which the programme is always feasible"""
        self._included = np.zeros_like(self._arcs)
        self._tail = self._head = np.zeros(0, np.int64)
        self._rows: list[LinearRow] = []
        self._glop = pywraplp.Solver.CreateSolver("GLOP")
        self._glop.Objective().SetMinimization()
        self._variables: list[pywraplp.Variable] = []
        self._constraints: list[pywraplp.Constraint] = []
        self._once = [
            self._constraint(1, equal=True) if mandatory else self._glop.Constraint(0.0, 1.0)
            for mandatory in self._mandatory.tolist()
        ]
        self._best: _DualSolution | None = None
        self._add_first_rows(np.where(self._arcs, times, 0), least_prize)
        near = np.where(self._arcs, times, NEVER)
        k = min(_NEAR, m)
        rows, columns = (np.partition(near, k, axis).take([k], axis) for axis in (0, 1))
        self._add_arcs((near <= rows) | (near <= columns))

    @property
    def bound(self) -> int | None:
        """Lower bound on the cost of all routes; None before the first solution."""
        return None if self._best is None else -(-self._best.total // self._scale)

    @property
    def binding_cuts(self) -> list[LinearRow]:
        """Cuts with a positive dual price, on which the bound rests."""
        prices = [] if self._best is None else self._best.prices.tolist()
        pairs = zip(prices, self._rows, strict=False)
        return [row for p, row in pairs if p > 0 and not row.equal and row.weights is None]

    def possible_arcs_and_required_steps(self, most_cost: int) -> tuple[Mask, Mask]:
        """Return the arcs that routes up to a cost of `most_cost` may have, and steps they need.

        A step is returned if each of these routes must make it. This is variable fixing by reduced
        costs.
        """
        if self._best is None:
            return self._arcs.copy(), self._mandatory[:-1]
        spare = most_cost * self._scale - self._best.total
        entered = self._best.entered
        arcs = self._arcs & (self._best.reduced - entered[self._step][None, :] <= spare)
        return arcs, (self._mandatory | (-entered > spare))[:-1]

    def solve(self, search: Search, enough_bound: int | None) -> None:
        """Raise the bound until it is `enough_bound`, no cut is violated, or the time is up.

        `enough_bound`: value from which on the bound is not raised further; None: no such value.
        """
        has_new_rows = False
        while search.remaining_time() > 0.0:
            simplex = "true" if has_new_rows else "false"
            self._glop.SetSolverSpecificParametersAsString(
                f"use_preprocessing: false use_dual_simplex: {simplex}"
            )
            if search.timed:
                self._glop.SetTimeLimit(max(1, int(1e3 * search.remaining_time())))
            status = self._glop.Solve()
            search.spend(_WORK[0] * len(self._rows) * (1 + self._glop.iterations()))
            if status != pywraplp.Solver.OPTIMAL:
                return
            dual = self._rounded_dual()
            if dual is None:
                return
            if self._best is None or dual.total > self._best.total:
                self._best = dual
            if enough_bound is not None and self.bound is not None and self.bound >= enough_bound:
                return
            improving = self._improving_arcs(dual)
            has_new_rows = not improving.any()
            if not has_new_rows:
                self._add_arcs(improving)
                continue
            cuts = list(self._violated_cuts(search))
            for cut in cuts:
                self._add_row(cut)
            if not cuts:
                return

    # Linear programme

    def _add_first_rows(self, times: Numbers, least_prize: int | None) -> None:
        network, m = self._network, self._network.node_count
        none, zeros = np.zeros(m + 1, np.bool_), np.zeros(m + 1, np.int64)
        for unit in np.eye(m, m + 1, dtype=np.int64):
            self._add_row(LinearRow(none, none, -unit, unit, 0, equal=True))
        if network.limit < NEVER:
            self._add_row(LinearRow(none, none, zeros, zeros, -network.limit, weights=-times))
        if least_prize is not None:
            prize = np.append(network.prize, 0)[self._step]
            self._add_row(LinearRow(none, none, zeros, prize, least_prize))

    def _constraint(self, least: int, *, equal: bool) -> pywraplp.Constraint:
        most = float(least) if equal else self._glop.infinity()
        constraint = self._glop.Constraint(float(least), most)
        if least > 0:
            self._variable(self._penalty, [(constraint, least)])
        return constraint

    def _variable(
        self, cost: int, coefficients: list[tuple[pywraplp.Constraint, int]]
    ) -> pywraplp.Variable:
        variable = self._glop.NumVar(0.0, self._glop.infinity(), "")
        self._glop.Objective().SetCoefficient(variable, float(cost))
        for constraint, coefficient in coefficients:
            constraint.SetCoefficient(variable, float(coefficient))
        return variable

    def _add_arcs(self, chosen: Mask) -> None:
        chosen = chosen & self._arcs & ~self._included
        self._included |= chosen
        tail, head = np.nonzero(chosen)
        self._tail, self._head = np.append(self._tail, tail), np.append(self._head, head)
        new = [
            self._variable(int(self._costs[i, j]), [(self._once[self._step[j]], 1)])
            for i, j in zip(tail.tolist(), head.tolist(), strict=True)
        ]
        self._variables += new
        for row, constraint in zip(self._rows, self._constraints, strict=True):
            _set_coefficients(constraint, new, row.coefficients(tail, head))

    def _add_row(self, row: LinearRow) -> None:
        constraint = self._constraint(row.least, equal=row.equal)
        self._rows.append(row)
        self._constraints.append(constraint)
        _set_coefficients(constraint, self._variables, row.coefficients(self._tail, self._head))

    # Dual prices

    def _rounded_dual(self) -> _DualSolution | None:
        """Return GLOP's prices, rounded, with their bound, or None if they are too large."""
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
        return _DualSolution(prices, total + sum(entered.tolist()), reduced, entered)

    def _least_into(self, reduced: Numbers, arcs: Mask) -> Numbers:
        least = np.full(len(self._mandatory), 1 << _BITS, np.int64)
        np.minimum.at(least, self._step, np.where(arcs, reduced, 1 << _BITS).min(axis=0))
        return np.where(self._mandatory, least, np.minimum(least, 0))

    def _improving_arcs(self, dual: _DualSolution) -> Mask:
        """Return arcs outside the programme whose reduced cost is below that of the arcs in it.

        They are the best ones, at most _COLUMNS.
        """
        least = self._least_into(dual.reduced, self._included)
        least = np.minimum(least, self._penalty * self._scale)
        saved = least[self._step][None, :] - dual.reduced
        saved = np.where(self._arcs & ~self._included, saved, 0)
        order = np.partition(saved.ravel(), -min(_COLUMNS, saved.size))
        return np.asarray(saved > max(order[-min(_COLUMNS, saved.size)], self._scale / 1000))

    # Cuts

    def _violated_cuts(self, search: Search) -> Iterator[LinearRow]:
        """Yield cuts for sets of steps that are entered less often than a step in them.

        They are minimum cuts of flows from the start to single steps.
        """
        count = len(self._mandatory) - 1
        flow = np.zeros((count + 1, count + 1))
        values = [variable.solution_value() for variable in self._variables]
        np.add.at(flow, (self._step[self._tail], self._step[self._head]), values)
        np.fill_diagonal(flow, 0.0)
        made = flow.sum(axis=0)
        tail, head = np.nonzero(flow > 0.0)
        graph = max_flow.SimpleMaxFlow()
        graph.add_arc_with_capacity(count, 0, 0)  # so that the start is a node in any case
        graph.add_arcs_with_capacity(tail, head, np.rint(flow[tail, head] * _FLOW).astype(int))
        covered = np.zeros(count + 1, np.bool_)
        for step in np.argsort(-made[:count], kind="stable").tolist():
            if covered[step] or made[step] < _LEAST_VIOLATION:
                continue
            graph.solve(count, step)
            search.spend(_WORK[1])
            if graph.optimal_flow() >= (made[step] - _LEAST_VIOLATION) * _FLOW:
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
        """Return the constraint that a route enters a set of steps as often as it should.

        That is at least once if the set has a mandatory step, else at least as often as the route
        makes that step of the set which the current solution makes most often.
        """
        inside, zeros = steps[self._step], np.zeros(len(self._step), np.int64)
        if (self._mandatory & steps).any():
            return LinearRow(~inside, inside, zeros, zeros, 1)
        step = int(np.argmax(np.where(steps, made, -1.0)))
        return LinearRow(~inside, inside, zeros, -(self._step == step).astype(np.int64), 0)


def _set_coefficients(
    constraint: pywraplp.Constraint, variables: list[pywraplp.Variable], coefficients: Numbers
) -> None:
    for k in np.flatnonzero(coefficients).tolist():
        constraint.SetCoefficient(variables[k], float(coefficients[k]))
