"""Batched route environment with the interface of stable-baselines3."""

# ruff: noqa: ARG002  (the signatures are those of stable-baselines3)

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from stable_baselines3.common.vec_env import VecEnv

from argo_env.envs.observations import Observation
from argo_env.envs.route_batch import RouteVectorEnv
from argo_env.envs.route_sources import RouteSource


class RouteVecEnv(VecEnv):
    """Vectorized environment of many routes for MaskablePPO; it holds the batch and the returns.

    The batch starts a new route one step after the end of the old one. That step counts here as an
    episode of its own, with the dock as its only action and no prize, so that nothing is learned
    from it; the statistics leave it out.
    """

    def __init__(self, routes: int, source: RouteSource, seed: int) -> None:
        self.batch = RouteVectorEnv(routes, source=source, full=True)
        super().__init__(
            routes, self.batch.single_observation_space, self.batch.single_action_space
        )
        self._first_seed = seed
        self._ended = np.zeros(routes, np.bool_)
        self._returns = np.zeros(routes)
        self._lengths = np.zeros(routes, np.int64)

    def reset(self) -> Observation:
        self._ended[:] = False
        self._returns[:], self._lengths[:] = 0.0, 0
        return self.batch.reset(seed=self._first_seed)[0]

    def step_async(self, actions: NDArray[np.int64]) -> None:
        self._actions = actions

    def step_wait(
        self,
    ) -> tuple[Observation, NDArray[np.float32], NDArray[np.bool_], list[dict[str, Any]]]:
        restarted = self._ended
        observation, rewards, self._ended, _, _ = self.batch.step(self._actions)
        self._returns += rewards
        self._lengths += 1
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for k in np.flatnonzero(self._ended):
            infos[k] = {"episode": {"r": float(self._returns[k]), "l": int(self._lengths[k])}}
        over = self._ended | restarted
        self._returns[over], self._lengths[over] = 0.0, 0
        return observation, rewards.astype(np.float32), over, infos

    def env_method(
        self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any
    ) -> list[Any]:
        """Return the action mask of each route, shape (n + 1,), whatever the `indices`.

        Raises:
            NotImplementedError: The method is not `action_masks`, the only one.
        """
        if method_name != "action_masks":
            raise NotImplementedError(method_name)
        return list(self.batch.action_masks())

    def has_attr(self, attr_name: str) -> bool:
        return attr_name == "action_masks"

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        return [None] * self.num_envs

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        raise NotImplementedError(attr_name)

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        return [False] * self.num_envs

    def seed(self, seed: int | None = None) -> Sequence[int | None]:
        """Return None for each route: the seeds are those of the construction."""
        return [None] * self.num_envs

    def close(self) -> None:
        """Do nothing: there is nothing to close."""
