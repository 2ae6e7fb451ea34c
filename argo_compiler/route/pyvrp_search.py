"""Solver that uses PyVRP's iterated local search (extra `route`).

It supports prizes, windows and a limit, without precedences and battery. PyVRP (N. Wouda, L. Lan,
W. Kool, INFORMS Journal on Computing 2024) also considers routes that violate windows and limits,
at a penalty. For PyVRP, the network is one vehicle that starts at time 0, and the modes of a step
are a group of clients of which one is visited. PyVRP supports precedence only for pairs. It holds
Python's lock while it searches.
"""

import warnings
from importlib.util import find_spec
from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np

from argo_compiler.route.network import StepNetwork
from argo_compiler.route.problem import NEVER, Objective, RouteProblem
from argo_compiler.route.pruning import horizon
from argo_compiler.route.search import Search

if TYPE_CHECKING:
    from pyvrp import CostEvaluator, ProblemData, RandomNumberGenerator, Solution

_TURNS = ((10, 25), (20, 25), (10, 10))
"""settings of the successive turns: number of neighbours of a node, and highest number of
perturbed nodes"""
_PATIENCE = 400
"""number of iterations without a better route that ends a turn"""
_MOST = 1 << 60
"""limit for sums of prizes or penalties, as PyVRP does not check for overflows"""


class PyvrpSearch:
    """Solver that searches for better routes with PyVRP; it proves nothing."""

    name = "PyVRP"

    def supports(self, problem: RouteProblem) -> bool:
        """Return True if PyVRP is installed and may support the problem.

        Precedences are no obstacle if there are rounds, as they may all be within these.
        """
        ordered = bool(problem.precedences) and not problem.rounds
        return find_spec("pyvrp") is not None and problem.battery is None and not ordered

    def solve(self, search: Search) -> None:
        """Offer routes until the time is up."""
        network = search.network
        if network.before.any() or not search.pruned.possible:
            return
        m = network.node_count
        if not network.mandatory.any() and network.time[m, m] <= horizon(network):
            search.offer(())
        nodes = np.flatnonzero(search.pruned.steps[network.step]).tolist()
        if not nodes:
            return
        import pyvrp.exceptions

        data = _problem_data(network, nodes)
        # A unit of lateness must cost more than it can win, or no route would be in time.
        penalty = min(
            max(1e5, 40.0 * float(network.prize.sum())), _MOST / ((horizon(network) + 1) * (m + 1))
        )
        random = pyvrp.RandomNumberGenerator(search.seed)
        with warnings.catch_warnings():
            # The warning says that PyVRP found no feasible route, which the search knows already.
            warnings.simplefilter("ignore", pyvrp.exceptions.PenaltyBoundWarning)
            for neighbours, perturbed in cycle(_TURNS):
                if search.remaining_time() <= 0.0:
                    return
                _Turn(search, nodes, data, random, neighbours, perturbed).run(penalty)


def _problem_data(network: StepNetwork, nodes: list[int]) -> "ProblemData":
    """Return the network as PyVRP's data: node k of `nodes` is location k, then start and end."""
    import pyvrp

    n, m, worst = len(nodes), network.node_count, horizon(network)
    rows = [*nodes, m]
    service = np.append(network.service, 0)[rows]
    arcs = network.time[np.ix_(rows, rows)]
    # Missing arcs are too long for any vehicle.
    arcs = np.where(arcs < NEVER, arcs + service[:, None], worst + 1)
    times = np.full((n + 2, n + 2), worst + 1, dtype=np.int64)
    times[: n + 1, :n], times[: n + 1, n + 1] = arcs[:, :n], arcs[:, n]
    np.fill_diagonal(times, 0)
    prize_unit = min(worst + 1, _MOST // max(1, int(network.prize.sum())))
    steps = network.step[nodes].tolist()
    groups = {s: pyvrp.ClientGroup(required=bool(network.mandatory[s])) for s in steps}
    groups = {s: group for s, group in groups.items() if steps.count(s) > 1}
    numbers = {s: number for number, s in enumerate(groups)}
    clients = []
    for k, s in enumerate(steps):
        if s in groups:
            groups[s].add_client(k)
        clients.append(
            pyvrp.Client(
                location=k,
                tw_early=int(network.earliest[s]),
                tw_late=int(network.latest[s]),
                prize=int(network.prize[s]) * prize_unit,
                required=bool(network.mandatory[s]) and s not in groups,
                group=numbers.get(s),
            )
        )
    waits = network.has_windows and network.objective is Objective.DURATION
    vehicle = pyvrp.VehicleType(
        start_depot=0,
        end_depot=1,
        start_late=0,
        tw_late=worst if network.has_windows else NEVER,
        # Without waiting the duration is a distance, for which PyVRP's search is better.
        max_distance=worst,
        unit_distance_cost=0 if waits else 1,
        unit_duration_cost=1 if waits else 0,
    )
    locations, depots = [pyvrp.Location(0, 0)] * (n + 2), [pyvrp.Depot(n), pyvrp.Depot(n + 1)]
    # PyVRP's stubs have another type for the matrices.
    distances: list[Any] = [times]
    durations: list[Any] = distances if network.has_windows else [np.zeros_like(times)]
    return pyvrp.ProblemData(
        locations, clients, depots, [vehicle], distances, durations, list(groups.values())
    )


class _Turn:
    """Iterated local search from the best route so far, which offers each better route.

    Holds the least cost so far and the number of iterations since then.
    """

    def __init__(
        self, search: Search, nodes: list[int], data: "ProblemData",
        random: "RandomNumberGenerator", neighbours: int, perturbed: int,
    ) -> None:  # fmt: skip
        from pyvrp import search as moves

        self._search, self._nodes, self._data, self._random = search, nodes, data, random
        near = moves.compute_neighbours(data, moves.NeighbourhoodParams(num_neighbours=neighbours))
        perturbation = moves.PerturbationParams(max_perturbations=perturbed)
        self._moves = moves.LocalSearch(data, random, near, moves.PerturbationManager(perturbation))
        for operator in moves.OPERATORS:
            if operator.supports(data):
                self._moves.add_operator(operator(data))
        # In nominal s: to perturb nodes, to move them to neighbours, and to evaluate the route.
        self._work = 1e-4 + perturbed * (5e-7 * neighbours + 2e-7 * len(nodes))
        self._least: int | None = None
        self._idle = 0

    def run(self, penalty: float) -> None:
        """Search until no better route is found for some iterations, or the time is up.

        `penalty`: highest cost of each unit of lateness.
        """
        import pyvrp

        prices = pyvrp.PenaltyParams(max_penalty=penalty)
        manager = pyvrp.PenaltyManager(prices.midpoint_penalties(self._data), prices)
        best = self._search.best
        if best is not None and best.path:
            location = {node: k for k, node in enumerate(self._nodes)}
            first = pyvrp.Solution(self._data, [[location[node] for node in best.path]])
        else:
            first = pyvrp.Solution.make_random(self._data, self._random)
        first = self(first, manager.max_cost_evaluator(), exhaustive=True)
        turn = pyvrp.IteratedLocalSearch(self._data, manager, self, first)
        turn.run(self._stop, collect_stats=False)

    def __call__(
        self, solution: "Solution", cost_evaluator: "CostEvaluator", exhaustive: bool = False
    ) -> "Solution":
        """Run PyVRP's local search on a solution, and offer the result if it is better."""
        improved = self._moves(solution, cost_evaluator, exhaustive)
        self._search.spend(self._work * (20 if exhaustive else 1), 1)
        self._idle += 1
        cost = cost_evaluator.cost(improved)
        if improved.is_feasible() and (self._least is None or cost < self._least):
            self._least, self._idle = cost, 0
            path = [self._nodes[a.idx] for r in improved.routes() for a in r if a.is_client()]
            if path:  # PyVRP takes an empty route for feasible in any case
                self._search.offer(path)
        return improved

    def _stop(self, best_cost: int) -> bool:  # noqa: ARG002
        return self._idle > _PATIENCE or self._search.remaining_time() <= 0.0
