"""Any order, prizes, windows and a limit: PyVRP's iterated local search (extra `route`).

PyVRP (N. Wouda, L. Lan, W. Kool, INFORMS Journal on Computing 2024) goes through routes that may
break windows and limits at a price. It takes a network as one vehicle that sets off at time 0, and
the modes of a step as clients of which one is visited. It knows no precedence other than of pairs,
and no battery. It holds Python's lock while it searches.
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
"""to how many of the nearest nodes a node is moved, and how many nodes are disturbed at most"""
_PATIENCE = 400
"""iterations without a better route, after which it is the next turn"""
_MOST = 1 << 60
"""which sums of prizes or penalties stay below: PyVRP does not look out for overflows"""


class PyvrpSearch:
    """A search for better routes; it proves nothing."""

    name = "PyVRP"

    def supports(self, problem: RouteProblem) -> bool:
        """Whether PyVRP is installed and can state it. Precedence may be all within rounds."""
        ordered = bool(problem.precedences) and not problem.rounds
        return find_spec("pyvrp") is not None and problem.battery is None and not ordered

    def solve(self, search: Search) -> None:
        """Offers routes until the time is over."""
        network = search.network
        if network.before.any() or not search.pruned.possible:
            return
        m = network.size
        if not network.mandatory.any() and network.time[m, m] <= horizon(network):
            search.offer(())
        nodes = np.flatnonzero(search.pruned.steps[network.step]).tolist()
        if not nodes:
            return
        import pyvrp.exceptions

        data = _stated(network, nodes)
        # A unit too late must cost more than what it may win, or no route would be in time.
        penalty = min(
            max(1e5, 40.0 * float(network.prize.sum())), _MOST / ((horizon(network) + 1) * (m + 1))
        )
        random = pyvrp.RandomNumberGenerator(search.seed)
        with warnings.catch_warnings():
            # That no route was found is told by what is offered.
            warnings.simplefilter("ignore", pyvrp.exceptions.PenaltyBoundWarning)
            for neighbours, disturbed in cycle(_TURNS):
                if search.remaining() <= 0.0:
                    return
                _Turn(search, nodes, data, random, neighbours, disturbed).run(penalty)


def _stated(network: StepNetwork, nodes: list[int]) -> "ProblemData":
    """The network as PyVRP sees it: node k of `nodes` is location k, then come start and end."""
    import pyvrp

    n, m, worst = len(nodes), network.size, horizon(network)
    rows = [*nodes, m]
    service = np.append(network.service, 0)[rows]
    ways = network.time[np.ix_(rows, rows)]
    # Where there is no way, it is too far for any vehicle.
    ways = np.where(ways < NEVER, ways + service[:, None], worst + 1)
    times = np.full((n + 2, n + 2), worst + 1, dtype=np.int64)
    times[: n + 1, :n], times[: n + 1, n + 1] = ways[:, :n], ways[:, n]
    np.fill_diagonal(times, 0)
    worth = min(worst + 1, _MOST // max(1, int(network.prize.sum())))
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
                prize=int(network.prize[s]) * worth,
                required=bool(network.mandatory[s]) and s not in groups,
                group=numbers.get(s),
            )
        )
    waits = network.windowed and network.objective is Objective.DURATION
    vehicle = pyvrp.VehicleType(
        start_depot=0,
        end_depot=1,
        start_late=0,
        tw_late=worst if network.windowed else NEVER,
        # Where nothing waits, the duration is a distance, in which PyVRP searches better.
        max_distance=worst,
        unit_distance_cost=0 if waits else 1,
        unit_duration_cost=1 if waits else 0,
    )
    places, depots = [pyvrp.Location(0, 0)] * (n + 2), [pyvrp.Depot(n), pyvrp.Depot(n + 1)]
    # PyVRP's stubs know matrices of another shape only.
    far: list[Any] = [times]
    lasting: list[Any] = far if network.windowed else [np.zeros_like(times)]
    return pyvrp.ProblemData(
        places, clients, depots, [vehicle], far, lasting, list(groups.values())
    )


class _Turn:
    """A search from the best route so far, which offers what it comes upon. Has state."""

    def __init__(
        self, search: Search, nodes: list[int], data: "ProblemData",
        random: "RandomNumberGenerator", neighbours: int, disturbed: int,
    ) -> None:  # fmt: skip
        from pyvrp import search as moves

        self._search, self._nodes, self._data, self._random = search, nodes, data, random
        near = moves.compute_neighbours(data, moves.NeighbourhoodParams(num_neighbours=neighbours))
        perturbation = moves.PerturbationParams(max_perturbations=disturbed)
        self._moves = moves.LocalSearch(data, random, near, moves.PerturbationManager(perturbation))
        for operator in moves.OPERATORS:
            if operator.supports(data):
                self._moves.add_operator(operator(data))
        # In nominal s: to disturb nodes, to move them to neighbours, and to reckon the route anew.
        self._work = 1e-4 + disturbed * (5e-7 * neighbours + 2e-7 * len(nodes))
        self._least: int | None = None
        self._idle = 0

    def run(self, penalty: float) -> None:
        """Searches until it finds nothing better any more."""
        import pyvrp

        prices = pyvrp.PenaltyParams(max_penalty=penalty)
        manager = pyvrp.PenaltyManager(prices.midpoint_penalties(self._data), prices)
        best = self._search.best
        if best is not None and best.path:
            place = {node: k for k, node in enumerate(self._nodes)}
            first = pyvrp.Solution(self._data, [[place[node] for node in best.path]])
        else:
            first = pyvrp.Solution.make_random(self._data, self._random)
        first = self(first, manager.max_cost_evaluator(), exhaustive=True)
        turn = pyvrp.IteratedLocalSearch(self._data, manager, self, first)
        turn.run(self._stop, collect_stats=False)

    def __call__(
        self, solution: "Solution", cost_evaluator: "CostEvaluator", exhaustive: bool = False
    ) -> "Solution":
        """PyVRP's local search."""
        found = self._moves(solution, cost_evaluator, exhaustive)
        self._search.spend(self._work * (20 if exhaustive else 1), 1)
        self._idle += 1
        cost = cost_evaluator.cost(found)
        if found.is_feasible() and (self._least is None or cost < self._least):
            self._least, self._idle = cost, 0
            path = [self._nodes[a.idx] for r in found.routes() for a in r if a.is_client()]
            if path:  # one that makes nothing is always possible to PyVRP
                self._search.offer(path)
        return found

    def _stop(self, best_cost: int) -> bool:  # noqa: ARG002
        return self._idle > _PATIENCE or self._search.remaining() <= 0.0
