"""Checkpoints as they are numbered."""

import numpy as np

from argo_env.envs.observations import Observation
from argo_env.envs.route_instance import DOCK
from baselines.policy import Policy


class GivenOrder(Policy):
    """Goes to the legal checkpoint of the lowest number."""

    name = "given-order"

    def act(self, observation: Observation) -> int:
        open_nodes = np.flatnonzero(observation["mask"])
        return int(open_nodes[1]) if len(open_nodes) > 1 else DOCK
