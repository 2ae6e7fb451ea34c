"""`argo/Route-v0`: choose the next checkpoint within a time budget."""

from collections.abc import Mapping
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from argo_env.envs.episode import (
    Copyable,
    Rendering,
    StateTypes,
    check_render_mode,
    check_state,
    parse_discrete_action,
    require_episode_begun,
    require_episode_under_way,
)
from argo_env.envs.observations import Observation
from argo_env.envs.route_drawing import draw_route
from argo_env.envs.route_episodes import (
    FPS,
    Episodes,
    episode_hash,
    observation_space,
    route_options_from_dict,
)
from argo_env.envs.route_instance import DOCK, score_route
from argo_env.envs.route_sources import RouteSource

_ZERO = np.zeros(1, np.int16)
_STATE: StateTypes = {
    "key": int, "episode": int, "options": dict, "route": (tuple, list), "generator": dict,
}  # fmt: skip


class RouteEnv(Copyable, Rendering, gym.Env[Observation, np.int64]):
    """Environment in which a robot chooses the checkpoints to visit within a time budget.

    ## Description
    A robot has some minutes to visit checkpoints with different prizes and to dock again. Some
    checkpoints must be visited before others. This is the orienteering problem with precedence;
    only travel times count, nothing is simulated between two visits. With `noise`, readings fail
    and stairs are found blocked on the way.

    ## Observation Space
    A `Dict`; n is the number of checkpoints, and node 0 the dock. All parts are `float32` from 0 to
    1 except the mask.

    | key | shape | meaning |
    |---|---|---|
    | `travel` | (n + 1,) | share of the budget until the end of a visit of each node, at most 1 |
    | `home` | (n + 1,) | share of the budget from each node to the dock, at most 1 |
    | `prize` | (n + 1,) | prize that is still available at each node |
    | `left` | (1,) | time left, as a share of the budget |
    | `mask` | (n + 1,) | `int8`, 1 where the action is legal |

    With `full=True` also `matrix`, shape (n + 2, n + 1), which is `travel` from every node (the
    last row: from the start); `before`, shape (n + 1, n + 1), 1 where the row's checkpoint must be
    visited before the column's; and `place`, the row of the robot.

    ## Action Space
    `Discrete(n + 1)`: the node to go to. The dock, action 0, is always legal and ends the episode.
    A checkpoint is legal if it was not visited yet, those before it were, and the robot can dock in
    time after it. `action_masks()` returns the mask as booleans, as MaskablePPO of sb3-contrib
    requires. An illegal action has the effect of action 0, and `info["illegal"]` is true.

    ## Rewards
    The reward is the prize of the checkpoint, 0 for the dock. The return equals
    `score_route(instance, route).prize` bit for bit. `info["terms"]` has the terms of the reward.
    With noise there is one more, `late`: a robot that docks after the end of the budget loses all
    that it has won, so that the return is exactly 0. This happens only if stairs were found blocked
    after the robot had left for its last checkpoint; `info["late"]` is true then.

    ## Starting State
    The robot is at the start, nothing is visited, and the whole budget is left. The instance is one
    of the 4,096 of `TRAINING`, chosen by a hash of the seed and of the number of the episode since
    the seed was given.

    ## Episode End
    Terminated when the robot has docked. Never truncated: there are at most n + 1 steps, and one
    for each reading that fails.

    ## Randomisation
    Travel times, prizes, precedence and the positions of the checkpoints differ between instances.
    The instances of `TEST` (numbers 1,000,000 to 1,000,099) are never drawn in training.

    With noise the instance also contains what the robot does not know yet, so an episode depends
    only on its instance and its actions. A visit whose reading fails takes its time and gives no
    prize: the checkpoint stays open, those after it stay illegal, and `info["failed"]` is true. At
    times that belong to the instance, from 10 % to 90 % of the budget, stairs are found blocked:
    from then on the travel times are those of the detour, which observations show at once. A drive
    that started earlier is not changed.

    ## Arguments
    - `checkpoints` (20): n, at most 500; if a site has fewer, the others can't be reached.
    - `scenario` ("random"): `random`, or a site: its name, its file, or
      `generated:floors=3,seed=7`.
    - `budget` (1200): s.
    - `full` (False): whether the observation has the whole instance.
    - `source` (None): a `RouteSource` that makes instances, instead of `checkpoints`, `scenario`,
      `budget` and `noise`.
    - `noise` (None): `{"failing": 0.2, "blocked": 1}`: the probability that a visit gives no
      reading, at most 0.9, and the number of stairs between two floors that are blocked, at most 5,
      as long as there is a detour. With blocked stairs, random routes have stairs at both ends.

    Options of `reset(options=...)` apply until others are given (`{}` removes them):
    - `scenario`: as above, for the following episodes.
    - `floor`: number, or list of numbers, of the floors whose checkpoints can be reached.
    - `faults`: `closed`, the number of existing checkpoints that can't be reached; `battery`, the
      share of the budget that a worn battery leaves.
    - `instance`: number of the instance, of `TRAINING` or `TEST`, instead of a drawn one; not with
      `scenario` or `test`.
    - `test`: true draws from `TEST`.

    `get_state()` returns a state from which `set_state(state)` continues, with the same random
    generator.

    ## Version History
    - v0: first version
    """

    _title = "argo/Route-v0"
    metadata = {  # noqa: RUF012
        "render_modes": ["human", "rgb_array"],
        "render_fps": FPS,
    }

    def __init__(
        self,
        checkpoints: int = 20,
        scenario: str = "random",
        budget: float = 1200.0,
        full: bool = False,
        source: RouteSource | None = None,
        noise: Mapping[str, Any] | None = None,
        render_mode: str | None = None,
    ) -> None:
        """Create the environment; the docstring of the class describes the arguments.

        Raises ArgoError if an argument is invalid, or if there is no such scenario, noise or render
        mode.
        """
        check_render_mode(render_mode, self.metadata["render_modes"])
        self.render_mode = render_mode
        self._full = full
        self._episodes = Episodes(checkpoints, scenario, budget, source, noise)
        self.action_space = spaces.Discrete(self._episodes.size)
        self.observation_space = observation_space(self._episodes.size, full)
        self._key: int | None = None
        self._episode = 0
        self._options: dict[str, Any] = {}
        self._route: list[int] = []
        self._over: bool | None = None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        super().reset(seed=seed)
        if options is not None:
            self._episodes.apply_options(route_options_from_dict(options, self._episodes))
            self._options = dict(options)
        if seed is not None or self._key is None:
            self._key, self._episode = int(self.np_random.integers(2**63)), 0
        else:
            self._episode += 1
        numbers = self._episodes.instance_numbers
        self._number = numbers[episode_hash(self._key, self._episode) % len(numbers)]
        self.instance = self._known = self._episodes.instance(self._number)
        self._place, self._route = self.instance.start_row, []
        self._time_left = self.instance.budget_array
        self._missing = self.instance.missing_predecessors.copy()
        self._prizes = self.instance.prizes.astype(np.float32)
        hidden = self.instance.hidden
        self._failing = [] if hidden is None else hidden.failing.tolist()
        self._won = 0.0
        self._over = False
        observation = self._observe()
        self._update_window()
        return observation, {"instance": self._number}

    def step(self, action: np.int64 | int) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        require_episode_under_way(self._over, self._title)
        instance = self.instance
        node = parse_discrete_action(action, instance.node_count, self._title)
        illegal = not self._mask[node]
        if illegal:
            node = DOCK
        if self._place != DOCK:
            self._time_left = self._time_left - self._known.arrival[self._place, node : node + 1]
        failed = instance.hidden is not None and self._failing[node] > 0
        prize = 0.0 if failed else instance.prizes.item(node)
        if failed:
            self._failing[node] -= 1
        else:
            self._missing -= instance.missing_decrease_by_visit[node]
            self._prizes[node] = 0.0
        self._place = node
        self._route.append(node)
        self._over = node == DOCK
        terms: dict[str, float] = {"prize": prize}
        info: dict[str, Any] = {"terms": terms, "time": self._time(), "illegal": illegal}
        reward = prize
        if instance.hidden is not None:
            self._known = instance.with_known_blockages_at(info["time"])
            late = self._over and info["time"] > instance.budget
            self._won += prize
            terms["late"] = 0.0 - self._won if late else 0.0
            reward += terms["late"]
            info |= {"late": late, "failed": failed}
        observation = self._observe()
        self._update_window()
        return observation, reward, self._over, False, info

    def action_masks(self) -> NDArray[np.bool_]:
        """Return a mask of the actions that are legal now, shape (n + 1,)."""
        require_episode_begun(self._over, self._title)
        return self._mask.copy()

    def get_state(self) -> dict[str, Any]:
        """Return the state of the episode, from which `set_state` continues.

        It is plain data that can be pickled.
        """
        require_episode_begun(self._over, self._title)
        return {
            "key": self._key,
            "episode": self._episode,
            "options": dict(self._options),
            "route": tuple(self._route),
            "generator": self.np_random.bit_generator.state,
        }

    def set_state(self, state: Mapping[str, Any]) -> Observation:
        """Continue from a state that `get_state` returned, and return its observation.

        Raises ArgoError if it is not a state of this environment.
        """
        check_state(state, _STATE, self._title)
        with self._replaying():
            self._over = None
            self.np_random.bit_generator.state = state["generator"]
            self._key, self._episode = state["key"], state["episode"] - 1
            observation, _ = self.reset(options=dict(state["options"]))
            for node in state["route"]:
                observation = self.step(node)[0]
        return observation

    def _state_for_copy(self) -> tuple[dict[str, Any], dict[str, Any] | None]:
        return self._options, None if self._over is None else self.get_state()

    def _restore_copy(self, state: tuple[dict[str, Any], dict[str, Any] | None]) -> None:
        options, episode = state
        if episode is not None:
            self.set_state(episode)
        elif options:
            self._episodes.apply_options(route_options_from_dict(options, self._episodes))
            self._options = options

    def _observe(self) -> Observation:
        instance, place = self._known, self._place
        # Single numbers are arrays too, as NumPy takes twice as long with scalars.
        mask = np.less_equal(instance.time_to_dock_via_rows[place], self._time_left)
        mask &= np.equal(self._missing, _ZERO)
        mask[DOCK] = True
        self._mask = mask
        left = self._time_left
        if self.instance.hidden is not None:  # a robot that docks too late has no time left
            left = np.maximum(left, np.float32(0.0))
        observation: Observation = {
            "travel": instance.travel_share_rows[place].copy(),
            "home": instance.time_to_dock_shares.copy(),
            "prize": self._prizes.copy(),
            "left": left / instance.budget_array,
            "mask": mask.view(np.int8).copy(),
        }
        if self._full:
            observation["matrix"] = instance.travel_shares.copy()
            observation["before"] = instance.before.astype(np.int8)
            observation["place"] = np.int64(place)  # type: ignore[assignment]
        return observation

    def _time(self) -> float:
        return self.instance.budget - self._time_left.item()

    def _draw_picture(self) -> NDArray[np.uint8]:
        """Return a picture of the route so far."""
        require_episode_begun(self._over, self._title)
        return draw_route(
            self._episodes.source,
            self._episodes.options.given_floors,
            self.instance,
            (self.instance.start_row, *self._route),
            score_route(self.instance, self._route).visited,
            self._mask,
            self._time(),
        )
