"""Network of a route problem for the solvers: its nodes are the modes of the steps."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from argo_compiler.route.modes import Step, StepMode, Vector, candidate_modes, outermost_steps
from argo_compiler.route.problem import NEVER, Objective, RouteProblem, Tour

_MOST_NODES = 4000
"""number of nodes after which further rounds get few modes, as there are matrices of nodes by
nodes"""
_SPARSE = 0.01
"""highest share of true entries for which relations are composed as sparse matrices"""


@dataclass(frozen=True, eq=False)
class StepNetwork:
    """Network with m nodes, each a mode of one of s steps.

    A route makes each step at most once, by one of its modes. Row m of a matrix is the start,
    column m the end.
    """

    problem: RouteProblem
    nodes: tuple[StepMode, ...]
    step: NDArray[np.int64]
    """step of each node, shape (m,)"""
    time: NDArray[np.int64]
    """time from the end of row to the begin of column (to the end of a round), shape
    (m + 1, m + 1)"""
    service: NDArray[np.int64]
    """time from each node's begin to its end, shape (m,); 0 for a round, which is part of `time`"""
    energy: NDArray[np.int64] | None
    """energy from the end of row to the end of column, shape (m + 1, m + 1); None: no battery"""
    chargers: tuple["ChargingStation", ...]
    prize: NDArray[np.int64]
    """prize of each step, shape (s,)"""
    mandatory: NDArray[np.bool_]
    """true if each route must make the step, shape (s,)"""
    earliest: NDArray[np.int64]
    """earliest begin of each step, shape (s,); 0: no limit"""
    latest: NDArray[np.int64]
    """latest begin of each step, shape (s,); NEVER: no limit"""
    needs: NDArray[np.bool_]
    """true if column requires that row is made before it, shape (s, s)"""
    before: NDArray[np.bool_]
    """true if row can't come after column, shape (s, s)"""
    limit: int
    """latest time to reach the end; NEVER: no limit"""
    exact: bool
    """true if the network has all modes that may be optimal; large rounds may lack some"""

    @property
    def node_count(self) -> int:
        """Number of nodes, which is also the row of the start and the column of the end."""
        return len(self.nodes)

    @cached_property
    def has_windows(self) -> bool:
        """True if a step has a time window, so that the robot may wait."""
        return bool((self.earliest > 0).any() or (self.latest < NEVER).any())

    @property
    def has_additive_times(self) -> bool:
        """True if a route's time is the sum of its arcs, without windows and battery."""
        return self.problem.battery is None and not self.has_windows

    @property
    def objective(self) -> Objective:
        return self.problem.objective

    @property
    def selective(self) -> bool:
        return not bool(self.mandatory.all())

    def nodes_of(self, step: int) -> list[int]:
        return np.flatnonzero(self.step == step).tolist()

    def route(self, path: Iterable[int], charges: dict[int, int] | None = None) -> Tour:
        """Return the route of a path of nodes.

        `charges`: number of the charger by the position in the path before which the robot charges.
        """
        order: list[int] = []
        tour_charges: dict[int, int] = {}
        path = list(path)
        for position, node in enumerate(path):
            if charges and position in charges:
                tour_charges[len(order)] = charges[position]
            order += self.nodes[node].order
        if charges and len(path) in charges:
            tour_charges[len(order)] = charges[len(path)]
        return Tour(tuple(order), tour_charges)

    def tour_path(self, tour: Tour) -> tuple[tuple[int, ...] | None, dict[int, int]]:
        """Return the nodes of a route, and its chargers by the position among them.

        Returns None and no chargers if the network lacks the route's order of some round.
        """
        path: list[int] = []
        charges: dict[int, int] = {}
        position, at = 0, self.node_count
        while position < len(tour.order):
            if position in tour.charges:
                charges[len(path)] = tour.charges[position]
            times = (
                self.time[at]
                if position not in tour.charges
                else (self.chargers[tour.charges[position]].out)
            )
            rest = tour.order[position:]
            matching = (
                node
                for node, mode in enumerate(self.nodes)
                if rest[0] == mode.first and mode.order == rest[: len(mode.order)]
            )
            at = next((node for node in matching if times[node] < NEVER), -1)
            if at < 0:
                return None, {}
            path.append(at)
            position += len(self.nodes[at].order)
        if position in tour.charges:
            charges[len(path)] = tour.charges[position]
        return tuple(path), charges


@dataclass(frozen=True, eq=False)
class ChargingStation:
    """Charger with its times and energies to and from the nodes.

    Entries are from the end of each node to the charger, and from the charger to the node, as in
    the network's `time` and `energy`; the last entry is from the start, and to the end.
    """

    to: Vector
    to_energy: Vector
    out: Vector
    out_energy: Vector


def build_network(
    problem: RouteProblem,
    cyclic_order: Callable[[Step], tuple[Step, ...]],
    is_time_up: Callable[[], bool] = lambda: False,
) -> StepNetwork:
    """Build the network of a problem.

    `cyclic_order` and `is_time_up` are those of `argo_compiler.route.modes.candidate_modes`.
    """
    all_steps = outermost_steps(problem)
    exact, step_of = True, list[int]()
    nodes: list[StepMode] = []

    def must_stop() -> bool:
        return is_time_up() or len(nodes) > _MOST_NODES

    for number, step in enumerate(all_steps):
        step_modes, step_exact = candidate_modes(problem, step, cyclic_order, must_stop)
        exact &= step_exact
        nodes += step_modes
        step_of += [number] * len(step_modes)
    n = problem.size
    is_visit = [step.round is None for step in all_steps]
    visits = [problem.visits[min(step.visits)] for step in all_steps]
    service = np.array([node.service for node in nodes], dtype=np.int64)
    exits = [mode.exit for mode in nodes] + [(n,)]
    times = _worst_drives(problem.travel, exits)
    used = np.zeros_like(times)
    if problem.battery is not None:
        used = _worst_drives(problem.battery.energy, exits)
    time, energies = _enter_nodes(nodes, times, used, problem.end)
    energy = None if problem.battery is None else energies
    needs, before, mandatory = _step_order(problem, all_steps)
    return StepNetwork(
        problem,
        tuple(nodes),
        np.array(step_of, dtype=np.int64),
        time,
        service,
        energy,
        tuple(_station(problem, nodes, exits, k) for k in range(len(problem.chargers))),
        np.array(
            [sum(problem.visits[v].prize for v in s.visits) for s in all_steps], dtype=np.int64
        ),
        mandatory,
        np.array([visits[s].earliest if one else 0 for s, one in enumerate(is_visit)], np.int64),
        np.array([_latest(visits[s].latest) if one else NEVER for s, one in enumerate(is_visit)]),
        needs,
        before,
        NEVER if problem.max_duration is None else problem.max_duration,
        exact,
    )


def _latest(latest: int | None) -> int:
    return NEVER if latest is None else latest


def _worst_drives(matrix: NDArray[np.int64], exits: list[tuple[int, ...]]) -> NDArray[np.int64]:
    """Return the highest time or energy of a drive from each exit's locations to each location."""
    worst = matrix[[locations[0] for locations in exits]]
    for row, locations in enumerate(exits):
        if len(locations) > 1:
            worst[row] = matrix[list(locations)].max(axis=0)
    return worst


def _enter_nodes(
    nodes: list[StepMode], times: NDArray[np.int64], used: NDArray[np.int64], end: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return times and energies of the drives to each node, and to the end.

    If the node is a round, they include the round; else they do not include the service. `times`
    and `used` are those of drives, with a row for each origin and a column for each location.
    """
    firsts = [node.first for node in nodes] + [end]
    time, energy = times[:, firsts], used[:, firsts]
    for column, node in enumerate(nodes):
        if node.entries is not None:
            time[:, column], energy[:, column] = node.add_to_drives(
                time[:, column], energy[:, column]
            )
    return time, energy


def _station(
    problem: RouteProblem, nodes: list[StepMode], exits: list[tuple[int, ...]], number: int
) -> ChargingStation:
    assert problem.battery is not None
    row, energy = problem.charger(number), problem.battery.energy
    out, out_energy = _enter_nodes(nodes, problem.travel[[row]], energy[[row]], problem.end)
    return ChargingStation(
        np.array([problem.travel[list(locations), row].max() for locations in exits]),
        np.array([energy[list(locations), row].max() for locations in exits]),
        out[0],
        out_energy[0],
    )


def _step_order(
    problem: RouteProblem, all_steps: list[Step]
) -> tuple[NDArray[np.bool_], NDArray[np.bool_], NDArray[np.bool_]]:
    """Return the network's `needs`, `before` and `mandatory`, as in `StepNetwork`."""
    step_of_visit = {visit: k for k, step in enumerate(all_steps) for visit in step.visits}
    count = len(all_steps)
    mandatory = np.array(
        [any(problem.visits[v].mandatory for v in step.visits) for step in all_steps],
        dtype=np.bool_,
    )
    needs = np.zeros((count, count), np.bool_)
    before = np.zeros((count, count), np.bool_)
    for precedence in problem.precedences:
        sequence = [step_of_visit[visit] for visit in precedence.sequence]
        for k, later in enumerate(sequence):
            for earlier in sequence[:k]:
                if earlier != later or _repeats_visit(all_steps[later], precedence.sequence):
                    before[earlier, later] = True
                    needs[earlier, later] |= precedence.needed
    # The needs of mandatory steps are mandatory; mandatory steps are needs of those after them.
    while True:
        closed_needs = needs | (before & mandatory[:, None])
        closed_needs |= compose_relations(closed_needs, closed_needs)
        closed_mandatory = mandatory | (closed_needs & mandatory[None, :]).any(axis=1)
        if (closed_needs == needs).all() and (closed_mandatory == mandatory).all():
            return needs, before | needs, mandatory
        needs, mandatory = closed_needs, closed_mandatory


def compose_relations(first: NDArray[np.bool_], then: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the composition of two relations: true if some element links row with column."""
    if not (first.any() and then.any()):
        return np.zeros_like(first)
    if max(first.mean(), then.mean()) < _SPARSE:
        composed: NDArray[np.bool_] = (csr_array(first) @ csr_array(then)).toarray()
        return composed
    # Floating-point numbers have fast matrix products.
    return np.asarray(first.astype(np.float32) @ then.astype(np.float32) > 0.0)


def _repeats_visit(step: Step, sequence: tuple[int, ...]) -> bool:
    """Return True if a visit of the step is in a sequence twice, so that it must precede itself."""
    visits = [visit for visit in sequence if visit in step.visits]
    return len(set(visits)) < len(visits)
