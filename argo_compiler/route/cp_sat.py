"""CP-SAT as a solver: proves routes, and finds some.

One worker with the linear relaxation at its strongest proves single tours much faster than many
workers do, so that is what is set.
"""

from math import ceil, floor

from ortools.sat.python import cp_model

from argo_compiler.route.circuit_model import CircuitModel, time_to_build
from argo_compiler.route.cp_solver import run_solver, solver_for, spend
from argo_compiler.route.evaluation import evaluate
from argo_compiler.route.problem import Objective, RouteProblem, Tour
from argo_compiler.route.search import Search, Solution

_MOST_ARCS = 80_000
"""of a model"""
_PATIENCE = 0.5
"""s for which a first try goes on although a better route was found elsewhere; twice as long from
try to try"""


class CpSat:
    """Looks for what is better than the best route that is known, until there is none."""

    name = "CP-SAT"

    def supports(self, _problem: RouteProblem, /) -> bool:
        return True

    def solve(self, search: Search) -> None:
        """First the most prize, then the least cost with it."""
        network = search.network
        if int(search.pruned.arcs.sum()) * (1 + len(network.chargers)) > _MOST_ARCS:
            search.say(f"{len(network.prize)} steps are too many for CP-SAT")
            return
        if not network.mandatory.any():
            offer_nothing(search)
        patience = _PATIENCE
        while search.left() > time_to_build(network, search.pruned):
            _Try(search, self.name, patience).run()
            patience *= 2.0


def offer_nothing(search: Search) -> None:
    """The routes that make nothing, straight or by a charger."""
    for charges in ({}, *({0: number} for number in range(len(search.network.chargers)))):
        tour = Tour((), charges)
        if evaluate(search.problem, tour).feasible:
            search.offer_tour(tour)


class _Try:
    """One model, from the best route that is known. Has state: its solver."""

    def __init__(self, search: Search, name: str, patience: float) -> None:
        self._search, self._name, self._patience = search, name, patience
        self._best = best = search.best
        network = search.network
        self._prizes = network.selective and (best is None or best.prize < search.prize_bound)
        self._least = best.prize if best is not None and network.selective else 0
        """the prize of the routes that what is said of the cost is about"""
        # With times, what order costs is told apart sooner where a better route is looked for.
        ordered = network.plain and bool(search.pruned.before.any())
        tight = ordered and best is not None and not self._prizes and best.cost > 0
        self._model = CircuitModel(
            network, search.pruned, best.cost - 1 if best is not None and tight else None
        )

    def run(self) -> None:
        search, best, model = self._search, self._best, self._model
        if self._prizes:
            model.maximise_prize(None if best is None else best.prize + 1)
        elif search.network.objective is not Objective.PRIZE:
            most = None if best is None else best.cost - 1
            model.minimise_cost(self._least if search.network.selective else None, most)
        if best is not None and best.path is not None:
            model.hint(best.path, best.charges)
        solver = solver_for(search)
        solver.best_bound_callback = self._bound
        begun = search.now()

        def over() -> bool:
            now = search.best
            better = now is not best and now is not None and now.method != self._name
            return search.left() <= 0.0 or (better and search.now() - begun >= self._patience)

        status = run_solver(solver, model.model, _Watch(model, search), over)
        spend(search, solver)
        if status == cp_model.INFEASIBLE:
            self._nothing_better(best)
        elif status == cp_model.OPTIMAL:
            self._bound(solver.objective_value)

    def _bound(self, value: float) -> None:
        """What CP-SAT says of the prize or the cost of all routes that it may find."""
        if abs(value) > 1e15:  # there is none yet
            return
        if self._prizes:
            least = 0 if self._best is None else self._best.prize
            self._search.known(prize_bound=max(least, floor(value + 1e-6)))
        elif self._search.network.objective is not Objective.PRIZE:
            bound = ceil(value - 1e-6)
            bound = bound if self._best is None else min(bound, self._best.cost)
            self._search.known(bound=bound, prize=self._least)

    def _nothing_better(self, best: Solution | None) -> None:
        if best is None:
            self._search.impossible()
        elif self._prizes:
            self._search.known(prize_bound=best.prize)
        else:
            self._search.known(bound=best.cost, prize=self._least)


class _Watch(cp_model.CpSolverSolutionCallback):
    """Takes each solution as it is found."""

    def __init__(self, model: CircuitModel, search: Search) -> None:
        super().__init__()
        self._model, self._search = model, search

    def on_solution_callback(self) -> None:
        self._search.offer(*self._model.path(self.boolean_value))
