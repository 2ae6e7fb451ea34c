"""The next checkpoint is the nearest one."""

import numpy as np

from argo_env.envs.observations import Observation
from argo_env.envs.route_instance import DOCK
from baselines.policy import Policy


class NearestNeighbour(Policy):
    """Goes to the legal checkpoint whose visit ends first."""

    name = "nearest-neighbour"

    def act(self, observation: Observation) -> int:
        travel = np.where(observation["mask"], observation["travel"], np.inf)[1:]
        nearest = int(np.argmin(travel))
        return nearest + 1 if np.isfinite(travel[nearest]) else DOCK
