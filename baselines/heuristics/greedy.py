"""Rules that choose the next checkpoint by what is seen of each of them now."""

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


class NearestNeighbour(Policy):
    """Goes to the legal checkpoint whose visit ends first."""

    name = "nearest-neighbour"

    def act(self, observation: Observation) -> int:
        travel = np.where(observation["mask"], observation["travel"], np.inf)[1:]
        nearest = int(np.argmin(travel))
        return nearest + 1 if np.isfinite(travel[nearest]) else DOCK


class PrizeOverTime(Policy):
    """Goes to the legal checkpoint with the most prize for each second until its visit ends."""

    name = "prize-over-time"

    def act(self, observation: Observation) -> int:
        rate = observation["prize"] / np.maximum(observation["travel"], np.float32(1e-9))
        # The dock has no prize, and is taken where there is nothing else.
        return int(np.argmax(np.where(observation["mask"], rate, 0.0)))
