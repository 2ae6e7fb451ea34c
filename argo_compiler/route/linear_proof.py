"""Proofs by the linear relaxation, and by CP-SAT with the few arcs that it leaves.

Of routes up to a cost that is a little above the bound, few arcs are possible. If CP-SAT finds the
best of those routes, it is the best of all; if there is none, the bound is higher, and more is
allowed. So no good route need be known before.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import ceil

import numpy as np
from numpy.typing import NDArray
from ortools.sat.python import cp_model

from argo_compiler.route.circuit_model import CircuitModel, time_to_build
from argo_compiler.route.cp_sat import offer_empty_routes
from argo_compiler.route.cp_solver import run_solver, solver_for, spend
from argo_compiler.route.linear_relaxation import LinearRelaxation
from argo_compiler.route.network import StepNetwork
from argo_compiler.route.problem import Objective, RouteProblem
from argo_compiler.route.pruning import horizon, least_arc_times
from argo_compiler.route.search import Search

_ABOVE = 0.005
"""of the bound: what is allowed at first; each time twice as much"""
_MOST_ARCS = 60_000
_SHARE, _SHARE_OF_BOUND = 0.5, 0.1
"""of the time that is left, for proofs, and where only a bound is looked for"""


class LinearProof:
    """For routes in any order without windows or a battery; a bound on the cost of others."""

    name = "linear relaxation"

    def supports(self, problem: RouteProblem, /) -> bool:
        return problem.size > 2

    def solve(self, search: Search) -> None:
        """First the most prize, then the least cost with it."""
        network, pruned = search.network, search.pruned
        if not pruned.possible or not 0 < int(pruned.arcs.sum()) <= _MOST_ARCS:
            return
        if not network.mandatory.any():
            offer_empty_routes(search)  # its circuits make something
        best = search.best
        whole = network.plain and not network.before.any()
        search = search.share(_SHARE if whole else _SHARE_OF_BOUND)
        m = network.size
        if network.selective and (best is None or best.prize < search.prize_bound):
            prizes = np.zeros((m + 1, m + 1), np.int64)
            prizes[:, :m] = -network.prize[network.step]
            _Stage(search, prizes, None).run(whole=whole)
        best = search.best
        some = not network.selective or (best is not None and best.prize >= search.prize_bound)
        if network.objective is not Objective.PRIZE and some:
            times = least_arc_times(network) + np.append(network.service, 0)
            least = best.prize if best is not None and network.selective else 0
            _Stage(search, times, least).run(whole=whole)


@dataclass
class _Stage:
    """One objective, made small."""

    search: Search
    costs: NDArray[np.int64]
    least_prize: int | None
    """of the routes that are of interest; None: the prize is the objective"""

    def run(self, *, whole: bool) -> None:
        """`whole`: until it is proven, else only a bound."""
        search, network = self.search, self.search.network
        relaxation = LinearRelaxation(network, search.pruned, self.costs, self.least_prize or None)
        relaxation.solve(search.share(0.5 if whole else 1.0), self._known())
        low, share, cap = relaxation.bound, _ABOVE, self._cap()
        if low is None:
            return
        self._none_below(min(low, cap + 1))
        while whole and search.remaining() > 0.0 and not self._proven(low, cap):
            most = min(low + max(1, int(share * abs(low))), self._most(cap))
            low = self._best_up_to(relaxation, most)
            self._none_below(low)
            if low <= most:  # found, or no time to find out
                return
            share *= 2.0

    def _cap(self) -> int:
        """No route comes to more."""
        return 0 if self.least_prize is None else horizon(self.search.network)

    def _known(self) -> int | None:
        """What the best route comes to; None: there is none that counts."""
        best = self.search.best
        if best is None or best.prize < (self.least_prize or 0):
            return None
        return -best.prize if self.least_prize is None else best.cost

    def _most(self, cap: int) -> int:
        """The most that is of interest."""
        known = self._known()
        return cap if known is None else min(cap, known - 1)

    def _proven(self, low: int, cap: int) -> bool:
        return low > self._most(cap)

    def _none_below(self, low: int) -> None:
        """It is proven that no route comes to less."""
        search, known = self.search, self._known()
        if known is None and low > self._cap():
            search.report_infeasible()
        elif self.least_prize is None:
            search.report_bounds(prize_bound=-low if known is None else max(-low, -known))
        else:
            search.report_bounds(
                bound=low if known is None else min(low, known), prize=self.least_prize
            )

    def _best_up_to(self, relaxation: LinearRelaxation, most: int) -> int:
        """Offers the best route that comes to `most` at most, if there is one; gives what no route
        comes to less than."""
        search, network, pruned = self.search, self.search.network, self.search.pruned
        arcs, must = relaxation.left(most)
        arcs[network.size, network.size] = False
        steps = np.zeros_like(pruned.steps)
        steps[network.step[arcs[:, :-1].any(axis=0)]] = True
        few, pruned = (
            replace(network, mandatory=must),
            replace(pruned, arcs=arcs, steps=pruned.steps & steps),
        )
        if search.remaining() < time_to_build(few, pruned):
            return min(relaxation.bound or 0, most)
        model = CircuitModel(few, pruned)
        for cut in relaxation.cuts:
            model.at_least(cut.of, cut.least)
        if _symmetric(network):
            model.at_least(_one_direction(network.size), 0)
        if self.least_prize is None:
            model.maximise_prize(-most)
        else:
            model.minimise_cost(self.least_prize or None, most)
        solver = solver_for(search)
        status = run_solver(solver, model.model, None, lambda: search.remaining() <= 0.0)
        spend(search, solver)
        if status == cp_model.INFEASIBLE:
            return most + 1
        bound = relaxation.bound or 0
        if status in (cp_model.OPTIMAL, cp_model.FEASIBLE):
            search.offer(*model.path(solver.boolean_value))
            sign = -1 if self.least_prize is None else 1
            bound = max(bound, ceil(sign * solver.best_objective_bound - 1e-6))
        return min(bound, most)


def _symmetric(network: StepNetwork) -> bool:
    """Whether each route takes as long the other way round."""
    between = network.time[:-1, :-1]
    ends = network.time[-1, :-1], network.time[:-1, -1]
    return bool((between == between.T).all() and (ends[0] == ends[1]).all())


def _one_direction(
    m: int,
) -> Callable[[NDArray[np.int64], NDArray[np.int64]], NDArray[np.int64]]:
    """Of the nodes at the ends of a route, the first has the lower number."""
    return lambda tail, head: tail * (head == m) - head * (tail == m)
