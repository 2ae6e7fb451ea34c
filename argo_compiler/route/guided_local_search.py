"""Large problems: OR-Tools' routing library, whose guided local search keeps improving a route.

Travel times are registered as a matrix: a callback for each arc takes 1.5 to 5 times as long. Order
is a constraint on positions, for which the library finds no first route by itself: it is given one.
"""

from collections.abc import Callable

import numpy as np
from ortools.constraint_solver import pywrapcp, routing_enums_pb2

from argo_compiler.route.network import StepNetwork, compose
from argo_compiler.route.path_timing import PathTiming
from argo_compiler.route.problem import NEVER, Objective, RouteProblem
from argo_compiler.route.pruning import Pruned, horizon
from argo_compiler.route.search import Search

_NO_WAY = 1 << 32
"""cost of an arc that there is not"""


class GuidedLocalSearch:
    """Improves the best route that is known, or begins with one of its own."""

    name = "guided local search"

    def supports(self, problem: RouteProblem, /) -> bool:
        return problem.battery is None and problem.size > 1

    def solve(self, search: Search, /) -> None:
        network, seconds = search.network, search.left()
        if not search.timed or seconds <= 0.0:
            return  # the library has no limit but time
        model, follower = _Model(network, search.pruned), PathTiming(network)
        mandatory = np.flatnonzero(network.mandatory).tolist()

        def note() -> None:
            path = model.path()
            steps = {int(network.step[node]) for node in path}
            if follower.follow(path) is not None and steps.issuperset(mandatory):
                search.offer(path)

        start = None if search.best is None else search.best.path
        model.solve(search.left(), start, note)


class _Model:
    """The library's model of a network. Has state, as the library's has."""

    def __init__(self, network: StepNetwork, pruned: Pruned) -> None:
        self._network, self._pruned = network, pruned
        m = network.size
        self._manager = pywrapcp.RoutingIndexManager(m + 1, 1, m)
        self._routing = pywrapcp.RoutingModel(self._manager)
        time = np.where(pruned.arcs & (network.time < NEVER), network.time, _NO_WAY)
        if network.time[m, m] < NEVER:
            time[m, m] = network.time[m, m]
        service = np.append(network.service, 0)
        passing = time + service[:, None]
        transit = self._routing.RegisterTransitMatrix(passing.tolist())
        waits = network.windowed and network.objective is Objective.DURATION
        self._clock(transit, spanned=waits)
        if not waits and network.objective is not Objective.PRIZE:
            self._routing.SetArcCostEvaluatorOfAllVehicles(transit)
        self._orders()
        self._choices(int(passing[passing < _NO_WAY].max(initial=1)) * (m + 2))

    def _clock(self, transit: int, *, spanned: bool) -> None:
        network, routing = self._network, self._routing
        last = horizon(network)
        if not network.windowed and network.limit >= NEVER:
            return
        routing.AddDimension(transit, last if network.windowed else 0, last, True, "time")
        clock = routing.GetDimensionOrDie("time")
        for node in range(network.size):
            first = min(int(self._pruned.earliest[node]), last)
            latest = max(first, min(int(self._pruned.latest[node]), last))
            clock.CumulVar(self._manager.NodeToIndex(node)).SetRange(first, latest)
        if spanned:
            clock.SetSpanCostCoefficientForAllVehicles(1)

    def _orders(self) -> None:
        """Positions in the order; a node that is left out is bound by nothing."""
        before = self._pruned.before
        if not before.any():
            return
        routing, network = self._routing, self._network
        routing.AddConstantDimension(1, network.size + 2, True, "position")
        position = routing.GetDimensionOrDie("position")
        # Those that follow from others are left out: they would only slow it down.
        redundant = compose(before, before)
        for i, j in np.argwhere(before & ~redundant).tolist():
            for first in network.nodes_of(i):
                for then in network.nodes_of(j):
                    a, b = (self._manager.NodeToIndex(node) for node in (first, then))
                    earlier, later = position.CumulVar(a), position.CumulVar(b)
                    routing.solver().Add(earlier < later)
                    if self._pruned.needs[i, j] and not network.mandatory[i]:
                        routing.solver().Add(routing.ActiveVar(b) <= routing.ActiveVar(a))

    def _choices(self, most: int) -> None:
        """What may be left out, at the price of its prize; and, where windows make first routes
        hard to find, all the rest at a price that is never worth it."""
        network = self._network
        weight = 1 if network.objective is Objective.PRIZE else most + 1
        worst = weight * (int(network.prize.sum()) + 1) + most
        for s, mandatory in enumerate(network.mandatory.tolist()):
            nodes = [self._manager.NodeToIndex(node) for node in network.nodes_of(s)]
            if not nodes:
                continue
            if not mandatory:
                self._routing.AddDisjunction(nodes, int(network.prize[s]) * weight)
            elif network.windowed or len(nodes) > 1 or network.limit < NEVER:
                self._routing.AddDisjunction(nodes, worst)

    def solve(
        self, seconds: float, start: tuple[int, ...] | None, note: Callable[[], None]
    ) -> None:
        """Searches; `note` is called at each route that it finds."""
        parameters = pywrapcp.DefaultRoutingSearchParameters()
        kinds = routing_enums_pb2
        parameters.local_search_metaheuristic = kinds.LocalSearchMetaheuristic.GUIDED_LOCAL_SEARCH
        parameters.first_solution_strategy = kinds.FirstSolutionStrategy.SAVINGS
        if self._network.windowed or self._network.selective or self._pruned.before.any():
            parameters.first_solution_strategy = (
                kinds.FirstSolutionStrategy.PARALLEL_CHEAPEST_INSERTION
            )
        parameters.time_limit.FromMilliseconds(max(1, int(1000 * seconds)))
        routing = self._routing
        routing.AddAtSolutionCallback(note)
        if start is None:
            routing.SolveWithParameters(parameters)
            return
        routing.CloseModelWithParameters(parameters)
        first = routing.ReadAssignmentFromRoutes([list(start)], True)
        if first is None:
            routing.SolveWithParameters(parameters)
        else:
            routing.SolveFromAssignmentWithParameters(first, parameters)

    def path(self) -> tuple[int, ...]:
        """The nodes of the route that is being looked at."""
        routing, path = self._routing, []
        index = routing.NextVar(routing.Start(0)).Value()
        while not routing.IsEnd(index):
            path.append(self._manager.IndexToNode(index))
            index = routing.NextVar(index).Value()
        return tuple(path)
