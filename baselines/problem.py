"""What a policy sees, as a route problem: what is left to do, from where the robot is."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route import Objective, Precedence, RouteProblem, Visit
from argo_env.envs.observations import Observation
from argo_env.envs.route_instance import DOCK, TICK, RouteInstance

HUNDREDTH = 0.01
"""what a prize of 1 in a problem is worth in the environment"""


@dataclass(frozen=True)
class OpenProblem:
    """A problem of the checkpoints that are still open."""

    problem: RouteProblem
    """times in ticks (`TICK` s); prizes in hundredths; all visits optional"""
    nodes: tuple[int, ...]
    """the node of each visit"""

    def order_of(self, visits: tuple[int, ...]) -> list[int]:
        """Visits as nodes."""
        return [self.nodes[visit] for visit in visits]


def problem_of(
    observation: Observation, budget: float, objective: Objective = Objective.DURATION
) -> OpenProblem:
    """The problem that an observation (with `full=True`) shows, with the budget (s) of its route.

    Nothing is lost: times in observations are whole ticks as shares of the budget. A checkpoint
    that has no prize any more was visited.
    """
    ticks = round(budget / TICK)
    travel = _ticks(observation["matrix"], ticks)
    home, here = _ticks(observation["home"], ticks), int(observation["place"])
    rows = [*np.flatnonzero(observation["prize"][1:] > 0.0) + 1, here]
    left = int(_ticks(observation["left"], ticks)[0])
    return _problem(travel[rows], home[rows[:-1]], rows, observation, left, objective)


def hindsight(instance: RouteInstance) -> OpenProblem:
    """The problem of somebody who knows beforehand which readings fail, and stays until one is
    had; stairs are never blocked. No route on the instance wins more than its optimum, as a later
    visit takes as long as staying does, and blocked stairs only make ways longer."""
    ticks = round(instance.budget / TICK)
    travel = np.minimum(instance.arrival.astype(np.float64) / TICK, ticks + 1)
    if instance.hidden is not None:
        travel += instance.hidden.failing * np.diagonal(travel)
    rows = [*range(1, instance.size), instance.start]
    observation: Observation = {"prize": instance.prizes, "before": instance.before}
    whole = np.minimum(travel, ticks + 1).astype(np.int64)
    return _problem(whole[rows], whole[rows[:-1], DOCK], rows, observation, ticks, Objective.PRIZE)


def _problem(
    travel: NDArray[np.int64],
    home: NDArray[np.int64],
    rows: list[int],
    observation: Observation,
    left: int,
    objective: Objective,
) -> OpenProblem:
    """`travel` with a row for each of `rows`, the last one where the robot is, and a column for
    each node."""
    ends = travel[:, [*rows[:-1], DOCK]].copy()
    ends[:-1, -1] = home
    np.fill_diagonal(ends[:, :-1], 0)
    nodes = rows[:-1]
    prizes = np.rint(observation["prize"][nodes] / HUNDREDTH).astype(int).tolist()
    visits = tuple(
        Visit(f"checkpoint {node}", mandatory=False, prize=prize)
        for node, prize in zip(nodes, prizes, strict=True)
    )
    before = observation["before"][np.ix_(nodes, nodes)]
    precedences = tuple(
        Precedence((a, b), f"checkpoint {nodes[a]} before checkpoint {nodes[b]}", needed=True)
        for a, b in np.argwhere(before).tolist()
    )
    problem = RouteProblem(
        visits, ends, precedences, max_duration=left, objective=objective, unit=TICK
    )
    return OpenProblem(problem, tuple(int(node) for node in nodes))


def _ticks(shares: NDArray[np.float32], ticks: int) -> NDArray[np.int64]:
    return np.rint(shares.astype(np.float64) * ticks).astype(np.int64)
