"""The next checkpoint is the one that pays best for the time it takes."""

import numpy as np

from argo_env.envs.observations import Observation
from baselines.policy import Policy


class PrizeOverTime(Policy):
    """Goes to the legal checkpoint with the most prize for each second until its visit ends."""

    name = "prize-over-time"

    def act(self, observation: Observation) -> int:
        rate = observation["prize"] / np.maximum(observation["travel"], np.float32(1e-9))
        # The dock has no prize, and is taken where there is nothing else.
        return int(np.argmax(np.where(observation["mask"], rate, 0.0)))
