"""Solver that uses CP-SAT, to prove routes and to find some.

It is set to one worker with the strongest linear relaxation, which proves single tours much faster
than many workers do.
"""

from math import ceil, floor

from ortools.sat.python import cp_model

from argo_compiler.route.circuit_model import CircuitModel, seconds_to_build_and_presolve
from argo_compiler.route.cp_solver import run_solver, solver_for, spend_solver_work
from argo_compiler.route.evaluation import evaluate
from argo_compiler.route.problem import Objective, RouteProblem, Tour
from argo_compiler.route.search import Search, Solution

_MOST_ARCS = 80_000
"""highest number of arcs in a model"""
_PATIENCE = 0.5
"""minimum s of the first attempt before a better route of another solver may end it; it doubles
from one attempt to the next"""


class CpSat:
    """Search for routes better than the best known one, until it is proven that there is none."""

    name = "CP-SAT"

    def supports(self, _problem: RouteProblem, /) -> bool:
        return True

    def solve(self, search: Search) -> None:
        """Maximise the prize first, then minimise the cost at that prize."""
        network = search.network
        if int(search.pruned.arcs.sum()) * (1 + len(network.chargers)) > _MOST_ARCS:
            search.add_reason(f"{len(network.prize)} steps are too many for CP-SAT")
            return
        if not network.mandatory.any():
            offer_routes_without_visits(search)
        patience = _PATIENCE
        while search.remaining_time() > seconds_to_build_and_presolve(network, search.pruned):
            _Attempt(search, self.name, patience).run()
            patience *= 2.0


def offer_routes_without_visits(search: Search) -> None:
    """Offer the feasible routes without visits: straight to the end, or by one charger."""
    for charges in ({}, *({0: number} for number in range(len(search.network.chargers)))):
        tour = Tour((), charges)
        if evaluate(search.problem, tour).feasible:
            search.offer_tour(tour)


class _Attempt:
    """Model and solver for one search, which starts from the best known route."""

    def __init__(self, search: Search, name: str, patience: float) -> None:
        self._search, self._name, self._patience = search, name, patience
        self._best = best = search.best
        network = search.network
        self._maximises_prize = network.selective and (
            best is None or best.prize < search.prize_bound
        )
        self._least_prize = best.prize if best is not None and network.selective else 0
        """lowest prize of the routes to which bounds on the cost apply"""
        # With times in the model, the costs of precedence show sooner if the route must be better.
        is_ordered = network.has_additive_times and bool(search.pruned.before.any())
        is_tight = is_ordered and best is not None and not self._maximises_prize and best.cost > 0
        self._model = CircuitModel(
            network, search.pruned, best.cost - 1 if best is not None and is_tight else None
        )

    def run(self) -> None:
        search, best, model = self._search, self._best, self._model
        if self._maximises_prize:
            model.set_prize_objective(None if best is None else best.prize + 1)
        elif search.network.objective is not Objective.PRIZE:
            most = None if best is None else best.cost - 1
            model.set_cost_objective(self._least_prize if search.network.selective else None, most)
        if best is not None and best.path is not None:
            model.hint(best.path, best.charges)
        solver = solver_for(search)
        solver.best_bound_callback = self._report_bound
        begun = search.elapsed_time()

        def must_stop() -> bool:
            now = search.best
            is_beaten = now is not best and now is not None and now.method != self._name
            return search.remaining_time() <= 0.0 or (
                is_beaten and search.elapsed_time() - begun >= self._patience
            )

        status = run_solver(solver, model.model, _SolutionCallback(model, search), must_stop)
        spend_solver_work(search, solver)
        if status == cp_model.INFEASIBLE:
            self._report_optimality(best)
        elif status == cp_model.OPTIMAL:
            self._report_bound(solver.objective_value)

    def _report_bound(self, value: float) -> None:
        """Report CP-SAT's bound on the prize or the cost of all routes of the model."""
        if abs(value) > 1e15:  # there is no bound yet
            return
        if self._maximises_prize:
            least = 0 if self._best is None else self._best.prize
            self._search.report_bounds(prize_bound=max(least, floor(value + 1e-6)))
        elif self._search.network.objective is not Objective.PRIZE:
            bound = ceil(value - 1e-6)
            bound = bound if self._best is None else min(bound, self._best.cost)
            self._search.report_bounds(bound=bound, least_prize=self._least_prize)

    def _report_optimality(self, best: Solution | None) -> None:
        """Report that no route is better than the best one, or that there is none if it is None."""
        if best is None:
            self._search.report_infeasible()
        elif self._maximises_prize:
            self._search.report_bounds(prize_bound=best.prize)
        else:
            self._search.report_bounds(bound=best.cost, least_prize=self._least_prize)


class _SolutionCallback(cp_model.CpSolverSolutionCallback):
    """Callback of CP-SAT that offers each of its solutions to the search."""

    def __init__(self, model: CircuitModel, search: Search) -> None:
        super().__init__()
        self._model, self._search = model, search

    def on_solution_callback(self) -> None:
        self._search.offer(*self._model.solution_path(self.boolean_value))
