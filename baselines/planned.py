"""Policies that plan the rest of the route and follow their plan."""

import numpy as np

from argo_env.envs.observations import Observation
from argo_env.envs.route_instance import DOCK
from baselines.policy import Policy


class PlannedPolicy(Policy):
    """A policy that plans at the start of an episode, and again after a deviation if it `replans`.

    A deviation is a failed reading or a change of the travel times. The policy holds the plan of
    the present episode; nodes of the plan that have become illegal are skipped.
    """

    replans = True

    def plan_route(self, observation: Observation) -> list[int]:
        """Return the nodes to visit from now on, in their order, without the dock at the end."""
        raise NotImplementedError

    def begin(self, observation: Observation, robot_time_budget: float, seed: int) -> None:
        self._budget, self._seed = robot_time_budget, seed
        self._make_plan(observation)

    def act(self, observation: Observation) -> int:
        if self.replans and self._deviates(observation):
            self._make_plan(observation)
        while self._plan:
            node = self._plan.pop(0)
            if observation["mask"][node]:
                self._expected[node] = 0.0
                return node
        return DOCK

    def _make_plan(self, observation: Observation) -> None:
        self._plan = self.plan_route(observation)
        self._expected = observation["prize"].copy()
        self._matrix = observation["matrix"]

    def _deviates(self, observation: Observation) -> bool:
        return not (
            np.array_equal(observation["prize"], self._expected)
            and np.array_equal(observation["matrix"], self._matrix)
        )
