"""Exact model for CP-SAT: a circuit through the steps, with self-loops at those left out.

The objective is a sum of arcs, not the time at the end, as the linear relaxation of a sum of arcs
is stronger.
"""

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from ortools.sat.python import cp_model

from argo_compiler.route.network import StepNetwork
from argo_compiler.route.problem import NEVER, Objective
from argo_compiler.route.pruning import Pruned, horizon, path_time_lower_bounds

_TIME_PER_ARC = 6e-5
"""s to build and presolve an arc; twice as long with begin times or ranks in the model"""


def seconds_to_build_and_presolve(network: StepNetwork, pruned: Pruned) -> float:
    """Return the time in s that a search must have left to build a CircuitModel of the network.

    It is the estimated time to build the model and to presolve it. With less time left, the model
    is not worth building.
    """
    per_arc = (
        _TIME_PER_ARC
        if network.has_additive_times and not network.before.any()
        else 2.0 * _TIME_PER_ARC
    )
    return per_arc * int(pruned.arcs.sum()) * (1 + len(network.chargers))


class CircuitModel:
    """CP-SAT model of a network, with its variables and constraints."""

    def __init__(self, network: StepNetwork, pruned: Pruned, end: int | None = None) -> None:
        """Build the model.

        `end`: latest time of the route's end, for networks with `has_additive_times` only. It makes
        precedences constraints on begin times, which are constraints on ranks otherwise. The linear
        relaxation profits only if that limit is tight.
        """
        self.model = cp_model.CpModel()
        self._network, self._pruned = network, pruned
        self._timed = end is not None
        self._distances = path_time_lower_bounds(network)
        self._horizon = horizon(network)
        if end is not None:
            self._horizon = min(self._horizon, end)
        self._arcs: list[tuple[int, int, int | None, cp_model.IntVar]] = []
        self._arc_costs: list[int] = []
        self._arc_energies: list[int] = []
        self._charges: list[cp_model.IntVar] = []
        self._made = self._add_circuit()
        self._cost: Any = 0
        self._add_cost()
        self._add_precedences()

    # Circuit

    def _add_circuit(self) -> list[Any]:
        """Add arcs and self-loops, and return for each step the literal that the route makes it."""
        network, pruned, model = self._network, self._pruned, self.model
        m = network.node_count
        circuit: list[tuple[int, int, cp_model.LiteralT]] = []
        service = [*network.service.tolist(), 0]
        for i, row in enumerate(pruned.arcs.tolist()):
            for j, has_arc in enumerate(row):
                if not has_arc:
                    continue
                if network.time[i, j] < NEVER and self._energy_fits(i, j):
                    self._add_arc(i, j, None, int(network.time[i, j]) + service[j])
                for charger, station in enumerate(network.chargers):
                    drive = int(station.to[i]) + int(station.out[j])
                    if drive < NEVER and self._charge_fits(i, j, charger):
                        assert network.problem.battery is not None
                        overhead = network.problem.battery.overhead
                        self._add_arc(i, j, charger, drive + overhead + service[j])
        circuit += [(i, j, literal) for i, j, _, literal in self._arcs]
        made: list[Any] = []
        for s, mandatory in enumerate(network.mandatory.tolist()):
            nodes = network.nodes_of(s)
            left_out = [model.new_bool_var("") for _ in nodes]
            if len(nodes) == 1 and mandatory:
                made.append(model.new_constant(1))
                # The circuit constraint ignores nodes without arcs.
                entering = [literal for _, j, _, literal in self._arcs if j == nodes[0]]
                model.add_bool_or(entering)
                continue
            circuit += [(node, node, out) for node, out in zip(nodes, left_out, strict=True)]
            if not pruned.steps[s]:
                for out in left_out:
                    model.add(out == 1)
            if mandatory:
                model.add_exactly_one([out.negated() for out in left_out])
                made.append(model.new_constant(1))
            elif len(nodes) == 1:
                made.append(left_out[0].negated())
            else:
                is_made = model.new_bool_var("")
                model.add(sum(out.negated() for out in left_out) == is_made)
                made.append(is_made)
        # The model excludes the route without steps.
        model.add_exactly_one([literal for i, *_, literal in self._arcs if i == m])
        if circuit:
            model.add_circuit(circuit)
        return made

    def _add_arc(self, i: int, j: int, charger: int | None, cost: int) -> None:
        network = self._network
        literal = self.model.new_bool_var("")
        self._arcs.append((i, j, charger, literal))
        self._arc_costs.append(cost)
        if network.energy is not None:
            if charger is None:
                self._arc_energies.append(int(network.energy[i, j]))
            else:
                station = network.chargers[charger]
                self._arc_energies.append(int(station.to_energy[i]) + int(station.out_energy[j]))

    def _energy_fits(self, i: int, j: int) -> bool:
        network, battery = self._network, self._network.problem.battery
        if battery is None or network.energy is None:
            return True
        used = battery.used if i == network.node_count else 0
        return used + int(network.energy[i, j]) <= battery.capacity

    def _charge_fits(self, i: int, j: int, charger: int) -> bool:
        network, battery = self._network, self._network.problem.battery
        assert battery is not None
        station = network.chargers[charger]
        used = battery.used if i == network.node_count else 0
        return (
            used + int(station.to_energy[i]) <= battery.capacity
            and int(station.out_energy[j]) <= battery.capacity
        )

    # Cost, begin times and energy

    def _add_cost(self) -> None:
        network, model = self._network, self.model
        battery = network.problem.battery
        literals = [literal for *_, literal in self._arcs]
        work: Any = cp_model.LinearExpr.weighted_sum(literals, self._arc_costs)
        used: list[Any] = []
        if battery is not None:
            energy = cp_model.LinearExpr.weighted_sum(literals, self._arc_energies)
            if network.chargers:
                used = self._add_energy_levels(battery.used, battery.capacity)
                work = work + battery.used + energy - used[-1]
            else:
                model.add(battery.used + energy <= battery.capacity)
        self._begins: list[cp_model.IntVar] | None = None
        duration = work
        if network.has_windows or self._timed:
            self._begins = self._add_begins(used)
            end = model.new_int_var(0, self._horizon, "end")
            self._add_end(end, used)
            waiting = model.new_int_var(0, 0 if self._timed else self._horizon, "waiting")
            model.add(end == work + waiting)
            duration = end
        elif network.limit < NEVER:
            model.add(work <= network.limit)
        self._cost = duration if network.objective is Objective.DURATION else work

    def _add_energy_levels(self, used: int, capacity: int) -> list[Any]:
        """Add and return the energies used since the last charge, after each step and at the end.

        They are variables. `used` is the energy that is used when the robot starts.
        """
        network, model = self._network, self.model
        count, m = len(network.prize), network.node_count
        assert network.energy is not None
        levels: list[Any] = [model.new_int_var(0, capacity, "") for _ in range(count + 1)]

        def level(node: int) -> Any:
            return levels[int(network.step[node])] if node < m else levels[count]

        for i, j, charger, literal in self._arcs:
            departure = used if i == m else level(i)
            if charger is None:
                energy = int(network.energy[i, j])
                model.add(level(j) == departure + energy).only_enforce_if(literal)
            else:
                station = network.chargers[charger]
                model.add(departure + int(station.to_energy[i]) <= capacity).only_enforce_if(
                    literal
                )
                model.add(level(j) == int(station.out_energy[j])).only_enforce_if(literal)
        for s, made in enumerate(self._made):
            if not network.mandatory[s]:
                model.add(levels[s] == 0).only_enforce_if(made.negated())
        return levels

    def _add_begins(self, used: Sequence[Any]) -> list[cp_model.IntVar]:
        """Add and return the variables of the steps' begin times."""
        network, pruned, model = self._network, self._pruned, self.model
        m, begins = network.node_count, []
        latest_of_all = self._horizon
        for s in range(len(network.prize)):
            nodes = network.nodes_of(s)
            if not pruned.steps[s]:
                begins.append(model.new_int_var(0, latest_of_all, ""))
                continue
            earliest = min(int(pruned.earliest[node]) for node in nodes)
            latest = max(int(pruned.latest[node]) for node in nodes)
            begins.append(
                model.new_int_var(earliest, max(earliest, min(latest, latest_of_all)), "")
            )
        for i, j, charger, literal in self._arcs:
            if j < m:
                begin = begins[int(network.step[j])]
                self._link_begin(begin, self._arrival(begins, used, i, j, charger), literal)
        return begins

    def _link_begin(self, begin: cp_model.IntVar, arrival: Any, literal: cp_model.IntVar) -> None:
        """Constrain a begin by an arrival; with windows, the robot may wait between the two."""
        constraint = begin == arrival if self._timed else begin >= arrival
        self.model.add(constraint).only_enforce_if(literal)

    def _arrival(
        self,
        begins: Sequence[cp_model.IntVar],
        used: Sequence[Any],
        i: int,
        j: int,
        charger: int | None,
    ) -> Any:
        """Return the time of the arrival at node j from node i, straight or by a charger.

        It is an expression of the model's variables.
        """
        network, m = self._network, self._network.node_count
        departure: Any = 0
        if i < m:
            departure = begins[int(network.step[i])] + int(network.service[i])
        if charger is None:
            return departure + int(network.time[i, j])
        battery, station = network.problem.battery, network.chargers[charger]
        assert battery is not None
        used_before = battery.used if i == m else used[int(network.step[i])]
        fixed = (
            int(station.to[i]) + int(station.out[j]) + battery.overhead + int(station.to_energy[i])
        )
        return departure + used_before + fixed

    def _add_end(self, end: cp_model.IntVar, used: Sequence[Any]) -> None:
        assert self._begins is not None
        m = self._network.node_count
        for i, j, charger, literal in self._arcs:
            if j == m:
                arrival = self._arrival(self._begins, used, i, j, charger)
                self._link_begin(end, arrival, literal)

    def _add_precedences(self) -> None:
        """Add constraints for the network's `needs` and `before`, on begin times or on ranks."""
        network, pruned, model = self._network, self._pruned, self.model
        ranks: list[cp_model.IntVar] | None = None
        for i, j in np.argwhere(network.before).tolist():
            if not (pruned.steps[i] and pruned.steps[j]):
                continue  # pruning has removed all steps that need a removed one
            optional = [self._made[s] for s in (i, j) if not network.mandatory[s]]
            if network.needs[i, j] and not network.mandatory[i]:
                model.add_implication(self._made[j], self._made[i])
                optional = [self._made[j]]
            least = min(
                int(network.service[first] + self._distances[first, second])
                for first in network.nodes_of(i)
                for second in network.nodes_of(j)
            )
            if self._begins is not None and least > 0:
                constraint = model.add(self._begins[j] >= self._begins[i] + least)
            else:
                ranks = self._add_ranks() if ranks is None else ranks
                constraint = model.add(ranks[j] > ranks[i])
            if optional:
                constraint.only_enforce_if(optional)

    def _add_ranks(self) -> list[cp_model.IntVar]:
        """Add and return a variable for each step of the network; along a route they increase."""
        network, model = self._network, self.model
        count = len(network.prize)
        ranks = [model.new_int_var(0, count - 1, "") for _ in range(count)]
        for i, j, _, literal in self._arcs:
            if i < network.node_count and j < network.node_count:
                before, after = ranks[int(network.step[i])], ranks[int(network.step[j])]
                model.add(after >= before + 1).only_enforce_if(literal)
        return ranks

    # Objectives

    def set_prize_objective(self, least_prize: int | None) -> None:
        """Set the objective to maximise the prize, and its lower limit; None: no limit."""
        prize = self._prize()
        if least_prize is not None:
            self.model.add(prize >= least_prize)
        self.model.maximize(prize)

    def set_cost_objective(self, least_prize: int | None, greatest_cost: int | None) -> None:
        """Set the objective to minimise the cost, and its upper limit; None: no limit.

        `least_prize` is a lower limit on the prize; None: no limit.
        """
        if least_prize is not None:
            self.model.add(self._prize() >= least_prize)
        if greatest_cost is not None:
            self.model.add(self._cost <= greatest_cost)
        self.model.minimize(self._cost)

    def _prize(self) -> Any:
        prizes = self._network.prize.tolist()
        return sum(int(p) * made for p, made in zip(prizes, self._made, strict=True))

    def require_at_least(
        self,
        coefficients: Callable[[NDArray[np.int64], NDArray[np.int64]], NDArray[np.int64]],
        least: int,
    ) -> None:
        """Require that the weighted sum of a route's arcs is at least `least`.

        `coefficients` returns the weights of arcs with given tails and heads.
        """
        ends = np.array([arc[:2] for arc in self._arcs], np.int64).reshape(-1, 2)
        weights = coefficients(ends[:, 0], ends[:, 1])
        nonzero = np.flatnonzero(weights).tolist()
        literals = [self._arcs[k][3] for k in nonzero]
        total = cp_model.LinearExpr.weighted_sum(literals, weights[nonzero].tolist())
        self.model.add(total >= least)

    def hint(self, path: tuple[int, ...], charges: Mapping[int, int]) -> None:
        """Add a path as a hint: a solution from which CP-SAT starts its search.

        `charges`: number of the charger by the position in the path before which the robot charges.
        """
        m = self._network.node_count
        arcs = enumerate(pairwise((m, *path, m)))
        legs = {(i, j, charges.get(position)) for position, (i, j) in arcs}
        for i, j, charger, literal in self._arcs:
            self.model.add_hint(literal, (i, j, charger) in legs)

    def solution_path(
        self, is_true: Callable[[cp_model.IntVar], bool]
    ) -> tuple[tuple[int, ...], dict[int, int]]:
        """Return the nodes of a solution in order, and its charges, as in `hint`.

        `is_true` returns the value of a literal in the solution.
        """
        m = self._network.node_count
        onward = {i: (j, charger) for i, j, charger, literal in self._arcs if is_true(literal)}
        path: list[int] = []
        charges: dict[int, int] = {}
        node = m
        while node in onward:
            node, charger = onward[node]
            if charger is not None:
                charges[len(path)] = charger
            if node == m:
                break
            path.append(node)
        return tuple(path), charges
