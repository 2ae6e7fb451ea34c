"""Policies that plan the rest of the route, and go by their plan."""

import numpy as np

from argo_env.envs.observations import Observation
from argo_env.envs.route_instance import DOCK
from baselines.policy import Policy


class PlannedPolicy(Policy):
    """Plans at the beginning; with `again` also whenever what is seen is not what was planned for:
    a reading failed, or travel times have changed. Holds the plan of the present episode."""

    again = True

    def plan(self, observation: Observation) -> list[int]:
        """The nodes to go to from now on, without the dock at the end."""
        raise NotImplementedError

    def begin(self, observation: Observation, budget: float, seed: int) -> None:
        self._budget, self._seed = budget, seed
        self._prepare(observation)

    def act(self, observation: Observation) -> int:
        if self.again and self._surprised(observation):
            self._prepare(observation)
        while self._plan:
            node = self._plan.pop(0)
            if observation["mask"][node]:
                self._expected[node] = 0.0
                return node
        return DOCK

    def _prepare(self, observation: Observation) -> None:
        self._plan = self.plan(observation)
        self._expected = observation["prize"].copy()
        self._matrix = observation["matrix"]

    def _surprised(self, observation: Observation) -> bool:
        return not (
            np.array_equal(observation["prize"], self._expected)
            and np.array_equal(observation["matrix"], self._matrix)
        )
