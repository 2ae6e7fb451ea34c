"""`argo/Route-v0`: choose the next checkpoint within a time budget; one by one, and in batches."""

from collections.abc import Mapping, Sequence
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from argo_env.envs.observations import Observation, dict_space
from argo_env.envs.plan_pictures import draw_route
from argo_env.envs.rendering import Window, check_render_mode
from argo_env.envs.route_episodes import Episodes, episode_number, read_route_options
from argo_env.envs.route_instance import DOCK
from argo_env.envs.route_sources import RouteSource

_FPS = 4
_NOTHING = np.zeros(1, np.int16)


class RouteEnv(gym.Env[Observation, np.int64]):
    """## Description
    A robot has some minutes to visit checkpoints of different worth and to be docked again. Some
    checkpoints must be visited before others. This is the orienteering problem with precedence;
    only travel times count, nothing is simulated between two visits.

    ## Observation Space
    A `Dict`; n is the number of checkpoints, and node 0 the dock. All are `float32` from 0 to 1
    but for the mask.

    | key | shape | meaning |
    |---|---|---|
    | `travel` | (n + 1,) | time from here to the end of a visit of each node, as a share of the \
budget; 1 also where it is longer |
    | `home` | (n + 1,) | time from each node to the dock, likewise |
    | `prize` | (n + 1,) | what is still to be had at each node |
    | `left` | (1,) | time that is left, as a share of the budget |
    | `mask` | (n + 1,) | `int8`, 1 where the action is legal |

    With `full=True` also `matrix`, shape (n + 2, n + 1), which is `travel` from every node (the
    last row: from the start), `before`, shape (n + 1, n + 1), 1 where the row's checkpoint must be
    visited before the column's, and `place`, the row where the robot is.

    ## Action Space
    `Discrete(n + 1)`: the node to go to. The dock, action 0, is always legal and ends the episode.
    A checkpoint is legal if it was not visited yet, those before it were, and the robot would be
    docked in time after it. `action_masks()` gives the mask as booleans, as MaskablePPO of
    sb3-contrib asks for. An illegal action does what action 0 does, and `info["illegal"]` is true.

    ## Rewards
    The prize of the checkpoint, 0 for the dock. The return is `evaluate(instance, route).prize`, to
    the bit. `info["terms"]` has the terms of the reward.

    ## Starting State
    At the start, nothing visited, the whole budget left. The instance is drawn from the 4,096 of
    `TRAINING`, by a hash of the seed and of the number of the episode since it was given.

    ## Episode End
    Terminated when the robot is docked. Never truncated: there are at most n + 1 steps.

    ## Randomisation
    Travel times, prizes, precedence and the checkpoints' places differ between instances. The
    instances of `TEST` (numbers 1,000,000 to 1,000,099) are never drawn in training.

    ## Arguments
    - `checkpoints` (20): n.
    - `scenario` ("random"): `random`, or a site: its name, its file, or
      `generated:floors=3,seed=7`.
    - `budget` (1200): s.
    - `full` (False): whether the observation has the whole instance.
    - `source` (None): a `RouteSource` that makes instances, in place of the three above but `full`.

    `reset(options=...)`, which hold until others are given (`{}`: none):
    - `scenario`: as above, for the following episodes.
    - `floor`: number, or list of numbers: other floors' checkpoints can't be reached.
    - `faults`: `closed`, how many checkpoints can't be reached; `battery`, the share of the budget
      that a worn battery leaves.
    - `instance`: the number of the instance, in place of a drawn one.
    - `test`: true draws from `TEST`.

    `get_state()` gives what `set_state(state)` goes on from, the generator included.

    ## Version History
    - v0: first version
    """

    metadata = {  # noqa: RUF012
        "render_modes": ["human", "rgb_array"],
        "render_fps": _FPS,
    }

    def __init__(
        self,
        checkpoints: int = 20,
        scenario: str = "random",
        budget: float = 1200.0,
        full: bool = False,
        source: RouteSource | None = None,
        render_mode: str | None = None,
    ) -> None:
        """Raises ArgoError if there is no such scenario or render mode."""
        check_render_mode(render_mode, self.metadata["render_modes"])
        self.render_mode = render_mode
        self._full = full
        self._episodes = Episodes(checkpoints, scenario, budget, source)
        self.action_space = spaces.Discrete(self._episodes.size)
        self.observation_space = observation_space(self._episodes.size, full)
        self._key: int | None = None
        self._episode = 0
        self._options: dict[str, Any] = {}
        self._window: Window | None = None
        self._route: list[int] = []

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        super().reset(seed=seed)
        if options is not None:
            self._episodes.choose(read_route_options(options, self._episodes))
            self._options = dict(options)
        if seed is not None or self._key is None:
            self._key, self._episode = int(self.np_random.integers(2**63)), 0
        else:
            self._episode += 1
        numbers = self._episodes.numbers
        self._number = numbers[episode_number(self._key, self._episode) % len(numbers)]
        self.instance = self._episodes.instance(self._number)
        self._place, self._route = self.instance.start, []
        self._left = self.instance.left
        self._missing = self.instance.missing.copy()
        self._prizes = self.instance.prizes.astype(np.float32)
        self._show()
        return self._observe(), {"instance": self._number}

    def step(self, action: np.int64 | int) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        instance, node = self.instance, int(action)
        illegal = not self._mask[node]
        if illegal:
            node = DOCK
        if self._place != DOCK:
            self._left = self._left - instance.arrival[self._place, node : node + 1]
        prize = instance.prizes.item(node)
        self._missing -= instance.effect[node]
        self._prizes[node] = 0.0
        self._place = node
        self._route.append(node)
        self._show()
        info = {"terms": {"prize": prize}, "time": self._time(), "illegal": illegal}
        return self._observe(), prize, node == DOCK, False, info

    def action_masks(self) -> NDArray[np.bool_]:
        """Which actions are legal now, shape (n + 1,)."""
        return self._mask.copy()

    def render(self) -> NDArray[np.uint8] | None:
        """The route so far as a picture; with `human` it is in a window."""
        if self.render_mode is None:
            return None
        picture = draw_route(self.instance, self._route, self._time())
        if self.render_mode == "rgb_array":
            return picture
        self._window = self._window or Window("argo/Route-v0")
        self._window.show(picture)
        return None

    def close(self) -> None:
        if self._window:
            self._window.close()
            self._window = None

    def get_state(self) -> dict[str, Any]:
        """All that the future depends on, as plain data that can be pickled."""
        return {
            "key": self._key,
            "episode": self._episode,
            "options": dict(self._options),
            "route": tuple(self._route),
            "generator": self.np_random.bit_generator.state,
        }

    def set_state(self, state: Mapping[str, Any]) -> Observation:
        """Goes on from what `get_state` gave; returns the observation of that moment."""
        mode, self.render_mode = self.render_mode, None
        self.np_random.bit_generator.state = state["generator"]
        self._key, self._episode = state["key"], state["episode"] - 1
        observation, _ = self.reset(options=dict(state["options"]))
        for node in state["route"]:
            observation = self.step(node)[0]
        self.render_mode = mode
        return observation

    def _observe(self) -> Observation:
        instance, place = self.instance, self._place
        # Arrays, also for single numbers: with those NumPy takes twice as long.
        mask = np.less_equal(instance.needs[place], self._left)
        mask &= np.equal(self._missing, _NOTHING)
        mask[DOCK] = True
        self._mask = mask
        observation: Observation = {
            "travel": instance.travels[place].copy(),
            "home": instance.home.copy(),
            "prize": self._prizes.copy(),
            "left": self._left / instance.left,
            "mask": mask.view(np.int8).copy(),
        }
        if self._full:
            observation["matrix"] = instance.travel.copy()
            observation["before"] = instance.before.astype(np.int8)
            observation["place"] = np.int64(place)  # type: ignore[assignment]
        return observation

    def _time(self) -> float:
        return self.instance.budget - self._left.item()

    def _show(self) -> None:
        if self.render_mode == "human":
            self.render()


class RouteVectorEnv(VectorEnv[Observation, NDArray[np.int64], NDArray[Any]]):
    """Many routes at once, as `gymnasium.make_vec("argo/Route-v0", num_envs=1024,
    vectorization_mode="vector_entry_point")` makes them.

    Each is to the bit what `RouteEnv` would be with the same seed and actions. A route that has
    ended is begun anew by the next step, whose action for it is ignored and whose reward is 0:
    `metadata["autoreset_mode"]` is `AutoresetMode.NEXT_STEP`. Arguments and options are those of
    `RouteEnv`; the option `instance` may also be a list with one number for each route.
    """

    metadata = {  # noqa: RUF012
        "render_modes": ["rgb_array"],
        "render_fps": _FPS,
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
        render_mode: str | None = None,
    ) -> None:
        """Raises ArgoError if there is no such scenario or render mode."""
        check_render_mode(render_mode, self.metadata["render_modes"])
        self.num_envs = num_envs
        self.render_mode = render_mode
        self._full = full
        self._episodes = Episodes(checkpoints, scenario, budget, source)
        n = self._episodes.size
        self.single_action_space = spaces.Discrete(n)
        self.single_observation_space = observation_space(n, full)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self._all = np.arange(num_envs)
        self._keys = np.zeros(num_envs, np.uint64)
        self._seeded = np.zeros(num_envs, np.bool_)
        self._episode = np.zeros(num_envs, np.uint64)
        self._chosen = np.zeros(num_envs, np.int64)
        self._place = np.zeros(num_envs, np.int64)
        self._time = np.zeros(num_envs, np.float32)
        self._ended = np.zeros(num_envs, np.bool_)
        self._missing = np.zeros((num_envs, n), np.int16)
        self._prizes = np.zeros((num_envs, n), np.float32)

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Observation, dict[str, Any]]:
        """Begins all routes; an int seeds them with seed, seed + 1 and so on."""
        if options is not None:
            self._episodes.choose(read_route_options(options, self._episodes, self.num_envs))
        seeds: Sequence[int | None]
        if seed is None:
            seeds = [None] * self.num_envs
        elif isinstance(seed, int | np.integer):
            seeds = [int(seed) + k for k in range(self.num_envs)]
        else:
            seeds = seed
        if len(seeds) != self.num_envs:
            raise ValueError(f"{self.num_envs} environments need as many seeds, not {len(seeds)}")
        self._episode += 1
        for k, one in enumerate(seeds):
            if one is not None or not self._seeded[k]:
                rng, _ = seeding.np_random(one)
                self._keys[k], self._episode[k] = rng.integers(2**63), 0
        self._seeded[:] = True
        self._begin(self._all)
        observation = self._observe()
        every = np.ones(self.num_envs, np.bool_)
        return observation, {
            "instance": self._episodes.pool.numbers[self._chosen],
            "_instance": every,
        }

    def step(
        self, actions: NDArray[np.int64]
    ) -> tuple[Observation, NDArray[Any], NDArray[Any], NDArray[Any], dict[str, Any]]:
        rows, going, pool = self._all, ~self._ended, self._episodes.pool
        nodes = np.asarray(actions, dtype=np.int64)
        illegal = ~self._mask[rows, nodes]
        nodes = np.where(illegal, DOCK, nodes)
        # Those that begin anew take part as well, and are put to their start after that.
        anew = self._ended.nonzero()[0]
        rewards = pool.prizes[self._chosen, nodes]
        size = self._missing.shape[1]
        self._time += pool.arrival[self._chosen * (size + 1) + self._place, nodes]
        self._missing -= pool.effect.take(self._chosen * size + nodes, axis=0)
        self._prizes[rows, nodes] = 0.0
        self._place = nodes
        self._ended = nodes == DOCK
        if anew.size:
            self._episode[anew] += np.uint64(1)
            self._begin(anew)
            rewards[anew], illegal[anew] = 0.0, False
        info = {
            "terms": {"prize": rewards.copy(), "_prize": going},
            "_terms": going.copy(),
            "time": self._time.astype(np.float64),
            "_time": going.copy(),
            "illegal": illegal,
            "_illegal": going.copy(),
        }
        if anew.size:
            info["instance"] = np.where(going, 0, pool.numbers[self._chosen])
            info["_instance"] = ~going
        truncated = np.zeros(self.num_envs, np.bool_)
        return self._observe(), rewards, self._ended.copy(), truncated, info

    def action_masks(self) -> NDArray[np.bool_]:
        """Which actions are legal now, shape (num_envs, n + 1)."""
        return self._mask.copy()

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """A picture of each route's present state, without the way that led there."""
        if self.render_mode is None:
            return None
        numbers = self._episodes.pool.numbers[self._chosen]
        return tuple(
            draw_route(self._episodes.instance(int(number)), [int(place)], float(time))
            for number, place, time in zip(numbers, self._place, self._time, strict=True)
        )

    def get_state(self) -> dict[str, Any]:
        """All that the future depends on, as plain data that can be pickled."""
        kept = {name: getattr(self, name).copy() for name in _STATE}
        return {"options": self._episodes.options, "arrays": kept}

    def set_state(self, state: Mapping[str, Any]) -> Observation:
        """Goes on from what `get_state` gave; returns the observation of that moment."""
        self._episodes.choose(state["options"])
        for name, array in state["arrays"].items():
            getattr(self, name)[...] = array
        return self._observe()

    def _begin(self, rows: NDArray[np.int64]) -> None:
        """New instances for these routes."""
        pool = self._episodes.pool
        drawn = episode_number(self._keys[rows], self._episode[rows])
        chosen = pool.choose(rows, drawn)
        self._chosen[rows] = chosen
        self._missing[rows] = pool.missing[chosen]
        self._prizes[rows] = pool.prizes[chosen]
        self._place[rows] = self._missing.shape[1]
        self._time[rows] = 0.0
        self._ended[rows] = False

    def _observe(self) -> Observation:
        pool, chosen, place = self._episodes.pool, self._chosen, self._place
        row = chosen * (self._missing.shape[1] + 1) + place
        budget = pool.budget[chosen, None]
        left = budget - self._time[:, None]
        mask = pool.need.take(row, axis=0) <= left
        mask &= self._missing == 0
        mask[:, DOCK] = True
        self._mask = mask
        observation: Observation = {
            "travel": pool.travel.take(row, axis=0),
            "home": pool.home.take(chosen, axis=0),
            "prize": self._prizes.copy(),
            "left": left / budget,
            "mask": mask.astype(np.int8),
        }
        if self._full:
            shape = (-1, self._missing.shape[1] + 1, self._missing.shape[1])
            observation["matrix"] = pool.travel.reshape(shape)[chosen]
            observation["before"] = pool.before[chosen]
            observation["place"] = place.copy()
        return observation


_STATE = (
    "_keys", "_seeded", "_episode", "_chosen", "_place", "_time", "_ended", "_missing", "_prizes",
)  # fmt: skip


def observation_space(size: int, full: bool) -> spaces.Space[Observation]:
    """The space of the observations with `size` nodes."""
    share = spaces.Box(0.0, 1.0, (size,), np.float32)
    parts: dict[str, spaces.Space[Any]] = {
        "travel": share,
        "home": share,
        "prize": share,
        "left": spaces.Box(0.0, 1.0, (1,), np.float32),
        "mask": spaces.MultiBinary(size),
    }
    if full:
        parts["matrix"] = spaces.Box(0.0, 1.0, (size + 1, size), np.float32)
        parts["before"] = spaces.MultiBinary((size, size))
        parts["place"] = spaces.Discrete(size + 1)
    return dict_space(parts)
