"""Greedy rules, which choose the next checkpoint by the current observation of each one."""

import numpy as np

from argo_env.envs.observations import Observation
from argo_env.envs.route_instance import DOCK
from baselines.policy import Policy


class GivenOrder(Policy):
    """Policy that chooses the legal checkpoint with the lowest number."""

    name = "given-order"

    def act(self, observation: Observation) -> int:
        open_nodes = np.flatnonzero(observation["mask"])
        return int(open_nodes[1]) if len(open_nodes) > 1 else DOCK


class NearestNeighbour(Policy):
    """Policy that chooses the legal checkpoint whose visit ends first."""

    name = "nearest-neighbour"

    def act(self, observation: Observation) -> int:
        travel = np.where(observation["mask"], observation["travel"], np.inf)[1:]
        nearest = int(np.argmin(travel))
        return nearest + 1 if np.isfinite(travel[nearest]) else DOCK


class PrizeOverTime(Policy):
    """Policy that chooses the legal checkpoint with the highest prize per time.

    The time is that until its visit ends.
    """

    name = "prize-over-time"

    def act(self, observation: Observation) -> int:
        rate = observation["prize"] / np.maximum(observation["travel"], np.float32(1e-9))
        # The dock has no prize, so it is chosen only if no checkpoint is legal.
        return int(np.argmax(np.where(observation["mask"], rate, 0.0)))
