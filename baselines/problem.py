"""Route problems of observations: the checkpoints that are still open, from the robot's node."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route import Objective, Precedence, RouteProblem, Visit
from argo_env.envs.observations import Observation
from argo_env.envs.route_instance import DOCK, TICK, RouteInstance

PRIZE_UNIT = 0.01
"""prize in the environment that corresponds to a prize of 1 in a route problem"""


@dataclass(frozen=True)
class OpenProblem:
    """A route problem of the checkpoints that are still open."""

    problem: RouteProblem
    """the problem: times in ticks (`TICK` s), prizes in hundredths, all visits optional"""
    nodes: tuple[int, ...]
    """node of each visit"""

    def to_nodes(self, visits: tuple[int, ...]) -> list[int]:
        """Return the nodes of visits, in the same order."""
        return [self.nodes[visit] for visit in visits]


def problem_from_observation(
    observation: Observation, robot_time_budget: float, objective: Objective = Objective.DURATION
) -> OpenProblem:
    """Return the route problem of an observation with `full=True`.

    The conversion loses nothing: times in observations are whole ticks as shares of the budget. A
    checkpoint without a prize counts as visited.

    Args:
        observation: the observation.
        robot_time_budget: time budget of the whole episode in s.
        objective: objective of the route problem.
    """
    ticks = round(robot_time_budget / TICK)
    travel = _ticks(observation["matrix"], ticks)
    home, here = _ticks(observation["home"], ticks), int(observation["place"])
    rows = [*np.flatnonzero(observation["prize"][1:] > 0.0) + 1, here]
    left = int(_ticks(observation["left"], ticks)[0])
    return _problem(travel[rows], home[rows[:-1]], rows, observation, left, objective)


def hindsight_problem(instance: RouteInstance) -> OpenProblem:
    """Return the route problem of a robot that knows in advance which readings fail.

    It stays at a checkpoint until a reading succeeds, and no stairs are blocked. No route on the
    instance wins more than the optimum of this problem: a repeated visit takes at least as long as
    staying does, and blocked stairs only make paths longer.
    """
    ticks = round(instance.budget / TICK)
    travel = np.minimum(instance.arrival.astype(np.float64) / TICK, ticks + 1)
    if instance.hidden is not None:
        travel += instance.hidden.failing * np.diagonal(travel)
    rows = [*range(1, instance.node_count), instance.start_row]
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
    """Return the route problem of the nodes `rows`, of which the last is the robot's position.

    Args:
        travel: times in ticks: a row for each of `rows`, a column for each node.
        home: times in ticks to the dock, from each of `rows` but the last.
        rows: checkpoints that are open, then the row of the robot's position.
        observation: parts `prize` and `before` of an observation.
        left: ticks that are left.
        objective: objective of the route problem.
    """
    ends = travel[:, [*rows[:-1], DOCK]].copy()
    ends[:-1, -1] = home
    np.fill_diagonal(ends[:, :-1], 0)
    nodes = rows[:-1]
    prizes = np.rint(observation["prize"][nodes] / PRIZE_UNIT).astype(int).tolist()
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
    """Return times in ticks from shares of a budget of `ticks`."""
    return np.rint(shares.astype(np.float64) * ticks).astype(np.int64)
