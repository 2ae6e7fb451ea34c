"""A route problem as the solvers see it: steps with modes as the nodes of one network."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from argo_compiler.route.modes import Step, StepMode, Vector, modes, steps
from argo_compiler.route.problem import NEVER, Objective, RouteProblem, Tour

_MOST_NODES = 4000
"""after which rounds are made in few ways: matrices of nodes by nodes have to be held"""
_SPARSE = 0.01
"""share of what is true in relations that are composed as lists"""


@dataclass(frozen=True, eq=False)
class StepNetwork:
    """m nodes, each a mode of one of s steps. A route makes each step at most once, by one of its
    modes. Row m of a matrix is the start, column m the end."""

    problem: RouteProblem
    nodes: tuple[StepMode, ...]
    step: NDArray[np.int64]
    """of each node, shape (m,)"""
    time: NDArray[np.int64]
    """from the end of row to the beginning of column, shape (m + 1, m + 1)"""
    service: NDArray[np.int64]
    """from a node's beginning to its end, shape (m,); that of a round is part of `time`"""
    energy: NDArray[np.int64] | None
    """from the end of row to the end of column, shape (m + 1, m + 1); None: without a battery"""
    chargers: tuple["ChargingStation", ...]
    prize: NDArray[np.int64]
    """of each step, shape (s,)"""
    mandatory: NDArray[np.bool_]
    earliest: NDArray[np.int64]
    """of each step; 0: at once"""
    latest: NDArray[np.int64]
    """of each step; NEVER: whenever"""
    needs: NDArray[np.bool_]
    """shape (s, s): row must have been made before column can be"""
    before: NDArray[np.bool_]
    """shape (s, s): row can't be made any more after column"""
    limit: int
    """when the robot must be at the end; NEVER: whenever"""
    exact: bool
    """whether the modes of large rounds are all that may be the best"""

    @property
    def size(self) -> int:
        """The number of nodes, which is the row of the start and the column of the end."""
        return len(self.nodes)

    @cached_property
    def windowed(self) -> bool:
        """Whether a step has a time window, so that there may be waiting."""
        return bool((self.earliest > 0).any() or (self.latest < NEVER).any())

    @property
    def plain(self) -> bool:
        """Whether a route's time is the sum of its arcs, and none is too short."""
        return self.problem.battery is None and not self.windowed

    @property
    def objective(self) -> Objective:
        return self.problem.objective

    @property
    def selective(self) -> bool:
        return not bool(self.mandatory.all())

    def nodes_of(self, step: int) -> list[int]:
        return np.flatnonzero(self.step == step).tolist()

    def route(self, path: Iterable[int], charges: dict[int, int] | None = None) -> Tour:
        """The route that makes these nodes. `charges`: the charger by the position in the path."""
        order: list[int] = []
        places: dict[int, int] = {}
        path = list(path)
        for position, node in enumerate(path):
            if charges and position in charges:
                places[len(order)] = charges[position]
            order += self.nodes[node].order
        if charges and len(path) in charges:
            places[len(order)] = charges[len(path)]
        return Tour(tuple(order), places)

    def path(self, tour: Tour) -> tuple[tuple[int, ...] | None, dict[int, int]]:
        """The nodes of a route, and its charges by the position among them; None: the network does
        not have the order in which it makes a round."""
        path: list[int] = []
        charges: dict[int, int] = {}
        position, at = 0, self.size
        while position < len(tour.order):
            if position in tour.charges:
                charges[len(path)] = tour.charges[position]
            there = (
                self.time[at]
                if position not in tour.charges
                else (self.chargers[tour.charges[position]].out)
            )
            rest = tour.order[position:]
            fits = (
                node
                for node, mode in enumerate(self.nodes)
                if rest[0] == mode.first and mode.order == rest[: len(mode.order)]
            )
            at = next((node for node in fits if there[node] < NEVER), -1)
            if at < 0:
                return None, {}
            path.append(at)
            position += len(self.nodes[at].order)
        if position in tour.charges:
            charges[len(path)] = tour.charges[position]
        return tuple(path), charges


@dataclass(frozen=True, eq=False)
class ChargingStation:
    """A charger: the ways there from the end of each node, and from there to its beginning; the
    last entry is that of the start, and of the end."""

    to: Vector
    to_energy: Vector
    out: Vector
    out_energy: Vector


def network(
    problem: RouteProblem,
    order_of: Callable[[Step], tuple[Step, ...]],
    over: Callable[[], bool] = lambda: False,
) -> StepNetwork:
    """The network of a problem. `order_of`, `over`: see `argo_compiler.route.modes.modes`."""
    found = steps(problem)
    exact, step_of = True, list[int]()
    nodes: list[StepMode] = []

    def full() -> bool:
        return over() or len(nodes) > _MOST_NODES

    for number, step in enumerate(found):
        some, all_of_them = modes(problem, step, order_of, full)
        exact &= all_of_them
        nodes += some
        step_of += [number] * len(some)
    n = problem.size
    single = [step.round is None for step in found]
    visits = [problem.visits[min(step.visits)] for step in found]
    service = np.array([node.service for node in nodes], dtype=np.int64)
    places = [mode.exit for mode in nodes] + [(n,)]
    times = _worst(problem.travel, places)
    used = np.zeros_like(times)
    if problem.battery is not None:
        used = _worst(problem.battery.energy, places)
    time, energies = _entered(nodes, times, used, problem.end)
    energy = None if problem.battery is None else energies
    needs, before, mandatory = _orders(problem, found)
    return StepNetwork(
        problem,
        tuple(nodes),
        np.array(step_of, dtype=np.int64),
        time,
        service,
        energy,
        tuple(_station(problem, nodes, places, k) for k in range(len(problem.chargers))),
        np.array([sum(problem.visits[v].prize for v in s.visits) for s in found], dtype=np.int64),
        mandatory,
        np.array([visits[s].earliest if one else 0 for s, one in enumerate(single)], np.int64),
        np.array([_latest(visits[s].latest) if one else NEVER for s, one in enumerate(single)]),
        needs,
        before,
        NEVER if problem.max_duration is None else problem.max_duration,
        exact,
    )


def _latest(latest: int | None) -> int:
    return NEVER if latest is None else latest


def _worst(matrix: NDArray[np.int64], places: list[tuple[int, ...]]) -> NDArray[np.int64]:
    """The most that a drive to each place takes from some places."""
    firsts = matrix[[there[0] for there in places]]
    for row, there in enumerate(places):
        if len(there) > 1:
            firsts[row] = matrix[list(there)].max(axis=0)
    return firsts


def _entered(
    nodes: list[StepMode], times: NDArray[np.int64], used: NDArray[np.int64], end: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """What rows of drives take until each node's beginning (a round's end), and until the end."""
    firsts = [node.first for node in nodes] + [end]
    time, energy = times[:, firsts], used[:, firsts]
    for column, node in enumerate(nodes):
        if node.entries is not None:
            time[:, column], energy[:, column] = node.enter(time[:, column], energy[:, column])
    return time, energy


def _station(
    problem: RouteProblem, nodes: list[StepMode], places: list[tuple[int, ...]], number: int
) -> ChargingStation:
    assert problem.battery is not None
    row, energy = problem.charger(number), problem.battery.energy
    out, out_energy = _entered(nodes, problem.travel[[row]], energy[[row]], problem.end)
    return ChargingStation(
        np.array([problem.travel[list(there), row].max() for there in places]),
        np.array([energy[list(there), row].max() for there in places]),
        out[0],
        out_energy[0],
    )


def _orders(
    problem: RouteProblem, found: list[Step]
) -> tuple[NDArray[np.bool_], NDArray[np.bool_], NDArray[np.bool_]]:
    """Which steps need which, which rule out which, and which must be made."""
    home = {visit: k for k, step in enumerate(found) for visit in step.visits}
    count = len(found)
    mandatory = np.array(
        [any(problem.visits[v].mandatory for v in step.visits) for step in found], dtype=np.bool_
    )
    needs = np.zeros((count, count), np.bool_)
    before = np.zeros((count, count), np.bool_)
    for precedence in problem.precedences:
        there = [home[visit] for visit in precedence.sequence]
        for k, later in enumerate(there):
            for earlier in there[:k]:
                if earlier != later or _twice(found[later], precedence.sequence):
                    before[earlier, later] = True
                    needs[earlier, later] |= precedence.needed
    # What a mandatory step needs is mandatory; what is mandatory and comes before is needed.
    while True:
        wanted = needs | (before & mandatory[:, None])
        wanted |= compose(wanted, wanted)
        must = mandatory | (wanted & mandatory[None, :]).any(axis=1)
        if (wanted == needs).all() and (must == mandatory).all():
            return needs, before | needs, mandatory
        needs, mandatory = wanted, must


def compose(first: NDArray[np.bool_], then: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The composition of two relations: row to column by way of something between."""
    if not (first.any() and then.any()):
        return np.zeros_like(first)
    if max(first.mean(), then.mean()) < _SPARSE:
        found: NDArray[np.bool_] = (csr_array(first) @ csr_array(then)).toarray()
        return found
    # As numbers with a fraction, for which there are fast products.
    return np.asarray(first.astype(np.float32) @ then.astype(np.float32) > 0.0)


def _twice(step: Step, sequence: tuple[int, ...]) -> bool:
    """Whether a sequence wants a visit of the step to be made before itself."""
    there = [visit for visit in sequence if visit in step.visits]
    return len(set(there)) < len(there)
