"""Batches of `argo/Route-v0`: many routes at once, as arrays."""

from collections.abc import Mapping, Sequence
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from argo_compiler.base.errors import Invalid
from argo_env.envs.episode import Copyable, check_render_mode, expand_seeds, invalid_state_error
from argo_env.envs.observations import Observation
from argo_env.envs.options import check_integer
from argo_env.envs.route_drawing import draw_route
from argo_env.envs.route_episodes import (
    FPS,
    Episodes,
    RouteOptions,
    episode_hash,
    observation_space,
    route_options_from_dict,
)
from argo_env.envs.route_instance import DOCK, VISITED
from argo_env.envs.route_sources import RouteSource

_NAME = "argo/Route-v0"
_MAX_ENVS = 1_000_000  # routes


class RouteVectorEnv(Copyable, VectorEnv[Observation, NDArray[np.int64], NDArray[Any]]):
    """Vector environment of many routes, which NumPy steps at once.

    `gymnasium.make_vec("argo/Route-v0", num_envs=1024, vectorization_mode="vector_entry_point")`
    makes one. Each route equals, bit for bit, a `RouteEnv` with the same seed and actions. If a
    route has ended, the next step starts a new one, ignores its action and gives reward 0:
    `metadata["autoreset_mode"]` is `AutoresetMode.NEXT_STEP`. Arguments and options are those of
    `RouteEnv`; the option `instance` may also be a list with one number for each route.
    """

    metadata = {  # noqa: RUF012
        "render_modes": ["rgb_array"],
        "render_fps": FPS,
        "autoreset_mode": AutoresetMode.NEXT_STEP,
    }

    def __init__(
        self,
        num_envs: int = 1,
        checkpoints: int = 20,
        scenario: str = "random",
        budget: float = 1200.0,
        full: bool = False,
        source: RouteSource | None = None,
        noise: Mapping[str, Any] | None = None,
        render_mode: str | None = None,
    ) -> None:
        """Create the batch; the docstring of `RouteEnv` describes the arguments.

        Raises ArgoError if an argument is invalid, or if there is no such scenario, noise or render
        mode.
        """
        check_render_mode(render_mode, self.metadata["render_modes"])
        check_integer(_NAME, 1, _MAX_ENVS, num_envs=num_envs)
        self.num_envs = num_envs = int(num_envs)
        self.render_mode = render_mode
        self._full = full
        self._episodes = Episodes(checkpoints, scenario, budget, source, noise)
        n = self._episodes.size
        self.single_action_space = spaces.Discrete(n)
        self.single_observation_space = observation_space(n, full)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self._all_rows = np.arange(num_envs)
        self._keys = np.zeros(num_envs, np.uint64)
        self._seeded = np.zeros(num_envs, np.bool_)
        self._episode = np.zeros(num_envs, np.uint64)
        self._chosen = np.zeros(num_envs, np.int64)
        self._known = np.zeros(num_envs, np.int64)
        self._place = np.zeros(num_envs, np.int64)
        self._time = np.zeros(num_envs, np.float32)
        self._ended = np.zeros(num_envs, np.bool_)
        self._missing = np.zeros((num_envs, n), np.int16)
        self._prizes = np.zeros((num_envs, n), np.float32)
        self._failing = np.zeros((num_envs, n), np.int16)
        self._won = np.zeros(num_envs, np.float64)
        self._mask: NDArray[np.bool_] | None = None

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Observation, dict[str, Any]]:
        """Start a new route in each environment, and return their observations and infos.

        An int seeds them with seed, seed + 1 and so on. An environment without a seed continues
        with the next episode of its last seed, or is seeded randomly if it never had one.
        """
        seeds = expand_seeds(seed, self.num_envs)
        if options is not None:
            self._episodes.apply_options(
                route_options_from_dict(options, self._episodes, self.num_envs)
            )
        self._episode += 1
        for k, one in enumerate(seeds):
            if one is not None or not self._seeded[k]:
                rng, _ = seeding.np_random(one)
                self._keys[k], self._episode[k] = rng.integers(2**63), 0
        self._seeded[:] = True
        self._start_routes(self._all_rows)
        observation = self._observe()
        every = np.ones(self.num_envs, np.bool_)
        return observation, {
            "instance": self._episodes.pool.numbers[self._chosen],
            "_instance": every,
        }

    def step(
        self, actions: NDArray[np.int64]
    ) -> tuple[Observation, NDArray[Any], NDArray[Any], NDArray[Any], dict[str, Any]]:
        mask, nodes = self._legal_actions, self._parse_actions(actions)
        rows, continuing, pool = self._all_rows, ~self._ended, self._episodes.pool
        illegal = ~mask[rows, nodes]
        nodes = np.where(illegal, DOCK, nodes)
        # Routes that restart take part as well, and are set to their start afterwards.
        restarted = self._ended.nonzero()[0]
        rewards = pool.prizes[self._chosen, nodes]
        size = self._missing.shape[1]
        self._time += pool.arrival[self._known * (size + 1) + self._place, nodes]
        effect = pool.missing_decrease_by_visit.take(self._chosen * size + nodes, axis=0)
        if pool.noisy:
            failed = self._apply_failures(nodes, rewards, effect)
        else:
            self._prizes[rows, nodes] = 0.0
        self._missing -= effect
        self._place = nodes
        self._ended = nodes == DOCK
        terms = {"prize": rewards.copy(), "_prize": continuing}
        info: dict[str, Any] = {}
        if pool.noisy:
            late = self._ended & (self._time > pool.budget[self._chosen])
            lost = np.where(late & continuing, 0.0 - self._won, 0.0)
            rewards += lost
            terms |= {"late": lost, "_late": continuing}
            info = {
                "late": late & continuing,
                "_late": continuing,
                "failed": failed,
                "_failed": continuing,
            }
            since = pool.since[self._chosen]
            passed = (self._time[:, None] >= since).sum(axis=1)
            self._known = self._chosen * pool.stages + passed
        if restarted.size:
            self._episode[restarted] += np.uint64(1)
            self._start_routes(restarted)
            rewards[restarted], illegal[restarted] = 0.0, False
        info |= {
            "terms": terms,
            "_terms": continuing.copy(),
            "time": self._time.astype(np.float64),
            "_time": continuing.copy(),
            "illegal": illegal,
            "_illegal": continuing.copy(),
        }
        if restarted.size:
            info["instance"] = np.where(continuing, 0, pool.numbers[self._chosen])
            info["_instance"] = ~continuing
        truncated = np.zeros(self.num_envs, np.bool_)
        return self._observe(), rewards, self._ended.copy(), truncated, info

    def action_masks(self) -> NDArray[np.bool_]:
        """Return a mask of the actions that are legal now, shape (num_envs, n + 1)."""
        return self._legal_actions.copy()

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """Return a picture of each route's present state, without the path that led there.

        Returns None without a render mode.
        """
        if self.render_mode is None:
            return None
        legal, episodes = self._legal_actions, self._episodes
        numbers = episodes.pool.numbers[self._chosen]
        return tuple(
            draw_route(
                episodes.source,
                episodes.options.given_floors,
                episodes.instance(int(numbers[k])),
                [int(self._place[k])],
                (np.flatnonzero(self._missing[k, 1:] == VISITED) + 1).tolist(),
                legal[k],
                float(self._time[k]),
            )
            for k in range(self.num_envs)
        )

    def get_state(self) -> dict[str, Any]:
        """Return the state of all routes, from which `set_state` continues.

        It is plain data that can be pickled.
        """
        arrays = {name: getattr(self, name).copy() for name in _STATE}
        return {"options": self._episodes.options, "arrays": arrays}

    def set_state(self, state: Mapping[str, Any]) -> Observation:
        """Continue from a state that `get_state` returned, and return its observation.

        Raises ArgoError if it is not a state of such a batch of the same size.
        """
        if not self._is_state(state):
            raise invalid_state_error(f"a batch of {self.num_envs} {_NAME}")
        self._episodes.apply_options(state["options"])
        for name, array in state["arrays"].items():
            getattr(self, name)[...] = array
        return self._observe()

    def _state_for_copy(self) -> tuple[RouteOptions, dict[str, Any] | None]:
        return self._episodes.options, None if self._mask is None else self.get_state()

    def _restore_copy(self, state: tuple[RouteOptions, dict[str, Any] | None]) -> None:
        options, episodes = state
        if episodes is not None:
            self.set_state(episodes)
        elif options != self._episodes.options:
            self._episodes.apply_options(options)

    @property
    def _legal_actions(self) -> NDArray[np.bool_]:
        """Mask of legal actions; raises ResetNeeded if there are no episodes yet."""
        if self._mask is None:
            raise gym.error.ResetNeeded(f"{_NAME}: no episode has begun: call reset")
        return self._mask

    def _parse_actions(self, actions: Any) -> NDArray[np.int64]:
        """Return the actions as an array, shape (num_envs,); raise ArgoError for invalid ones."""
        nodes, size = np.asarray(actions), self._missing.shape[1]
        if nodes.shape == (self.num_envs,) and nodes.dtype.kind in "iu":
            nodes = np.ascontiguousarray(nodes, dtype=np.int64)
            # Negative numbers are large ones if they are read as unsigned.
            if nodes.view(np.uint64).max() < size:
                return nodes
        raise Invalid(
            f"{_NAME}: the actions are {actions!r}, and have to be {self.num_envs} whole numbers "
            f"from 0 to {size - 1}"
        )

    def _is_state(self, state: Any) -> bool:
        """Return True if this is a state of such a batch."""
        if not isinstance(state, Mapping) or state.keys() != {"options", "arrays"}:
            return False
        options, arrays = state["options"], state["arrays"]
        if not isinstance(options, RouteOptions) or not isinstance(arrays, Mapping):
            return False
        return arrays.keys() == set(_STATE) and all(
            isinstance(array := arrays[name], np.ndarray)
            and (array.dtype, array.shape) == ((own := getattr(self, name)).dtype, own.shape)
            for name in _STATE
        )

    def _apply_failures(
        self, nodes: NDArray[np.int64], prizes: NDArray[np.float64], effect: NDArray[np.int16]
    ) -> NDArray[np.bool_]:
        """Return a mask of the visits that fail, shape (num_envs,), and record all visits.

        `prizes` and `effect`, what the visits subtract from `_missing`, are changed in place: the
        values of visits that fail are set to 0. A visit that fails reduces the failures left of its
        node by one. The prizes of the other visits are won, and their nodes have no prize any more.
        """
        rows = self._all_rows
        failed = self._failing[rows, nodes] > 0
        self._failing[rows, nodes] -= failed
        prizes[failed], effect[failed] = 0.0, 0
        self._prizes[rows, nodes] *= failed
        self._won += prizes
        return failed

    def _start_routes(self, rows: NDArray[np.int64]) -> None:
        """Start the next episode's instance in these environments."""
        pool = self._episodes.pool
        drawn = episode_hash(self._keys[rows], self._episode[rows])
        chosen = pool.pool_rows_for_envs(rows, drawn)
        self._chosen[rows] = chosen
        self._known[rows] = chosen * pool.stages
        self._missing[rows] = pool.missing_predecessors[chosen]
        self._prizes[rows] = pool.prizes[chosen]
        self._place[rows] = self._missing.shape[1]
        self._time[rows] = 0.0
        self._ended[rows] = False
        if pool.noisy:
            self._failing[rows] = pool.failing[chosen]
            self._won[rows] = 0.0

    def _observe(self) -> Observation:
        pool, chosen, place = self._episodes.pool, self._chosen, self._place
        row = self._known * (self._missing.shape[1] + 1) + place
        budget = pool.budget[chosen, None]
        left = budget - self._time[:, None]
        mask = pool.time_to_dock_via.take(row, axis=0) <= left
        mask &= self._missing == 0
        mask[:, DOCK] = True
        self._mask = mask
        if pool.noisy:  # a robot that docks too late has no time left
            np.maximum(left, np.float32(0.0), out=left)
        observation: Observation = {
            "travel": pool.travel_shares.take(row, axis=0),
            "home": pool.time_to_dock_shares.take(self._known, axis=0),
            "prize": self._prizes.copy(),
            "left": left / budget,
            "mask": mask.astype(np.int8),
        }
        if self._full:
            shape = (-1, self._missing.shape[1] + 1, self._missing.shape[1])
            observation["matrix"] = pool.travel_shares.reshape(shape)[self._known]
            observation["before"] = pool.before[chosen]
            observation["place"] = place.copy()
        return observation


_STATE = (
    "_keys", "_seeded", "_episode", "_chosen", "_known", "_place", "_time", "_ended", "_missing",
    "_prizes", "_failing", "_won",
)  # fmt: skip
