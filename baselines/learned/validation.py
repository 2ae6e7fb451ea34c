"""Validation of the network during the training, on instances that are not trained on."""

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray

from argo_compiler.base.stages import stage_items
from argo_env.envs.route_batch import RouteVectorEnv
from argo_env.envs.route_instance import DOCK
from baselines.learned.network import RouteNetwork
from baselines.learned.sources import TrainingRoutes

_FIRST = 990_000  # number of the first instance; the training uses lower numbers


class Validation:
    """Validation on random routes with 20 and 40 checkpoints, and on a mixture with up to 40."""

    def __init__(self, sites: Sequence[str], instances: int) -> None:
        self._batches = {
            name: RouteVectorEnv(
                instances,
                source=TrainingRoutes(count, sites=sites, plain=plain, offset=_FIRST),
                full=True,
            )
            for name, count, plain in [
                ("random-20", 20, 1.0), ("random-40", 40, 1.0), ("mixed-40", 40, 0.0)
            ]
        }  # fmt: skip

    def __call__(self, network: RouteNetwork) -> dict[str, float]:
        """Return the mean prize of the network's routes on each validation set, by its name."""
        batches = stage_items("evaluating", list(self._batches.items()))
        return {
            name: float(greedy_prizes(network, batch, range(batch.num_envs)).mean())
            for name, batch in batches
        }


def greedy_prizes(
    network: RouteNetwork, batch: RouteVectorEnv, numbers: Sequence[int]
) -> NDArray[np.float64]:
    """Drive a batch of routes, always to the legal node with the highest score; return prizes.

    `numbers` are the instances, one for each route of the batch. The result has the shape
    (routes,).
    """
    observation, _ = batch.reset(options={"instance": tuple(numbers)})
    total = np.zeros(batch.num_envs)
    over = np.zeros(batch.num_envs, np.bool_)
    while not over.all():
        tensors = {name: torch.from_numpy(array) for name, array in observation.items()}
        with torch.no_grad():
            scores = network(tensors)[0].numpy()
        best = np.where(observation["mask"] == 1, scores, -np.inf).argmax(axis=1)
        observation, rewards, ended, _, _ = batch.step(np.where(over, DOCK, best))
        total += np.where(over, 0.0, rewards)
        over |= ended
    return total
