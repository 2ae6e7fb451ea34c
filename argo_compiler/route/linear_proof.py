"""Solver that proves routes by the linear relaxation, and by CP-SAT on the arcs that it leaves.

Routes up to a cost a little above the bound have few possible arcs. If CP-SAT finds the best of
these routes, it is the best of all; if there is none, the bound rises, and the next attempt allows
a higher cost. So the proof needs no good route from another solver.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import ceil

import numpy as np
from numpy.typing import NDArray
from ortools.sat.python import cp_model

from argo_compiler.route.circuit_model import CircuitModel, seconds_to_build_and_presolve
from argo_compiler.route.cp_sat import offer_routes_without_visits
from argo_compiler.route.cp_solver import run_solver, solver_for, spend_solver_work
from argo_compiler.route.linear_relaxation import LinearRelaxation
from argo_compiler.route.network import StepNetwork
from argo_compiler.route.problem import Objective, RouteProblem
from argo_compiler.route.pruning import horizon, least_arc_times_without_service
from argo_compiler.route.search import Search

_FIRST_MARGIN = 0.005
"""share of the bound by which the first attempt exceeds it; each further one doubles the share"""
_MOST_ARCS = 60_000
_PROOF_SHARE, _BOUND_SHARE = 0.5, 0.1
"""share of the remaining time for a proof, and if only a bound is computed"""


class LinearProof:
    """Solver that proves routes without precedences, windows or battery, and bounds all others."""

    name = "linear relaxation"

    def supports(self, problem: RouteProblem, /) -> bool:
        return problem.size > 2

    def solve(self, search: Search) -> None:
        """Maximise the prize first, then minimise the cost at that prize."""
        network, pruned = search.network, search.pruned
        if not pruned.possible or not 0 < int(pruned.arcs.sum()) <= _MOST_ARCS:
            return
        if not network.mandatory.any():
            offer_routes_without_visits(search)  # the circuit model excludes them
        best = search.best
        to_optimality = network.has_additive_times and not network.before.any()
        search = search.with_time_share(_PROOF_SHARE if to_optimality else _BOUND_SHARE)
        m = network.node_count
        if network.selective and (best is None or best.prize < search.prize_bound):
            prizes = np.zeros((m + 1, m + 1), np.int64)
            prizes[:, :m] = -network.prize[network.step]
            _Stage(search, prizes, None).run(to_optimality=to_optimality)
        best = search.best
        prize_proven = not network.selective or (
            best is not None and best.prize >= search.prize_bound
        )
        if network.objective is not Objective.PRIZE and prize_proven:
            times = least_arc_times_without_service(network) + np.append(network.service, 0)
            least = best.prize if best is not None and network.selective else 0
            _Stage(search, times, least).run(to_optimality=to_optimality)


@dataclass
class _Stage:
    """Minimisation of one objective: the negative prize, or the cost."""

    search: Search
    costs: NDArray[np.int64]
    least_prize: int | None
    """lowest prize of the routes that count; None: the prize is the objective"""

    def run(self, *, to_optimality: bool) -> None:
        """Compute a bound, and if `to_optimality`, search until the optimum is proven.

        Bounds and routes are reported to the search, whose limit may end the work earlier.
        """
        search, network = self.search, self.search.network
        relaxation = LinearRelaxation(network, search.pruned, self.costs, self.least_prize or None)
        relaxation.solve(search.with_time_share(0.5 if to_optimality else 1.0), self._best_value())
        low, margin, cap = relaxation.bound, _FIRST_MARGIN, self._cap()
        if low is None:
            return
        self._report_bound(min(low, cap + 1))
        while to_optimality and search.remaining_time() > 0.0 and not self._is_proven(low, cap):
            most = min(low + max(1, int(margin * abs(low))), self._most(cap))
            low = self._solve_within(relaxation, most)
            self._report_bound(low)
            if low <= most:  # the optimum is found, or the time is up
                return
            margin *= 2.0

    def _cap(self) -> int:
        """Return an upper limit on the objective of all routes worth considering."""
        return 0 if self.least_prize is None else horizon(self.search.network)

    def _best_value(self) -> int | None:
        """Return the best route's objective; None if no known route wins `least_prize` or more."""
        best = self.search.best
        if best is None or best.prize < (self.least_prize or 0):
            return None
        return -best.prize if self.least_prize is None else best.cost

    def _most(self, cap: int) -> int:
        """Return the highest objective, at most `cap`, that would improve on the best route."""
        value = self._best_value()
        return cap if value is None else min(cap, value - 1)

    def _is_proven(self, low: int, cap: int) -> bool:
        return low > self._most(cap)

    def _report_bound(self, low: int) -> None:
        """Report that no route has an objective below `low`."""
        search, value = self.search, self._best_value()
        if value is None and low > self._cap():
            search.report_infeasible()
        elif self.least_prize is None:
            search.report_bounds(prize_bound=-low if value is None else max(-low, -value))
        else:
            search.report_bounds(
                bound=low if value is None else min(low, value), least_prize=self.least_prize
            )

    def _solve_within(self, relaxation: LinearRelaxation, most: int) -> int:
        """Offer the best route with an objective of at most `most`, and return a lower bound.

        The bound is above `most` only if it is proven that there is no such route, and not if the
        time ends before one is found.
        """
        search, network, pruned = self.search, self.search.network, self.search.pruned
        arcs, mandatory = relaxation.possible_arcs_and_required_steps(most)
        arcs[network.node_count, network.node_count] = False
        steps = np.zeros_like(pruned.steps)
        steps[network.step[arcs[:, :-1].any(axis=0)]] = True
        restricted, pruned = (
            replace(network, mandatory=mandatory),
            replace(pruned, arcs=arcs, steps=pruned.steps & steps),
        )
        if search.remaining_time() < seconds_to_build_and_presolve(restricted, pruned):
            return min(relaxation.bound or 0, most)
        model = CircuitModel(restricted, pruned)
        for cut in relaxation.binding_cuts:
            model.require_at_least(cut.coefficients, cut.least)
        if _is_symmetric(network):
            model.require_at_least(_one_direction(network.node_count), 0)
        if self.least_prize is None:
            model.set_prize_objective(-most)
        else:
            model.set_cost_objective(self.least_prize or None, most)
        solver = solver_for(search)
        status = run_solver(solver, model.model, None, lambda: search.remaining_time() <= 0.0)
        spend_solver_work(search, solver)
        if status == cp_model.INFEASIBLE:
            return most + 1
        bound = relaxation.bound or 0
        if status in (cp_model.OPTIMAL, cp_model.FEASIBLE):
            search.offer(*model.solution_path(solver.boolean_value))
            sign = -1 if self.least_prize is None else 1
            bound = max(bound, ceil(sign * solver.best_objective_bound - 1e-6))
        return min(bound, most)


def _is_symmetric(network: StepNetwork) -> bool:
    """Return True if each route takes as long as its reverse."""
    between = network.time[:-1, :-1]
    ends = network.time[-1, :-1], network.time[:-1, -1]
    return bool((between == between.T).all() and (ends[0] == ends[1]).all())


def _one_direction(
    m: int,
) -> Callable[[NDArray[np.int64], NDArray[np.int64]], NDArray[np.int64]]:
    """Return coefficients that allow one of the two directions of each route.

    They require that the first node of the route has a lower number than the last one, or the same.
    """
    return lambda tail, head: tail * (head == m) - head * (tail == m)
