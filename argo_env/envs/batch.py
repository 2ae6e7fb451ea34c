"""Vector environments with slow steps, whose environments are distributed over processes."""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, ClassVar, cast

import gymnasium as gym
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space, concatenate, create_empty_array
from numpy.typing import NDArray

from argo_compiler.base.errors import Invalid, NotFound
from argo_env.envs.episode import Copyable, expand_seeds, invalid_state_error
from argo_env.envs.observations import Observation
from argo_env.envs.options import check_integer
from argo_env.envs.workers import Workers
from argo_env.worker_processes import usable_processors

_MAX_ENVS = 10_000  # environments
_RENDER_MODES = ("rgb_array",)


class ProcessVectorEnv(Copyable, VectorEnv[Observation, NDArray[Any], NDArray[Any]]):
    """Vector environment whose environments are distributed over worker processes.

    Each of them equals a single environment with the same seeds, options and actions. If an episode
    has ended, the next step starts a new one, ignores its action and gives reward 0:
    `metadata["autoreset_mode"]` is `AutoresetMode.NEXT_STEP`. Close the environment when it is no
    longer used; otherwise its processes end together with this object.
    """

    env_class: ClassVar[type[gym.Env[Any, Any]]]
    """class of the single environments"""
    _title: str

    def __init__(self, num_envs: int = 1, processes: int | None = None, **arguments: Any) -> None:
        """Create the environments in worker processes.

        Args:
            num_envs: Number of environments, 1 to 10,000.
            processes: Number of worker processes; None for one per usable processor. There are
                never more processes than environments.
            **arguments: Arguments of the single environment.

        Raises:
            ArgoError: The single environment refuses an argument, a number is out of range, or the
                render mode is a window.
        """
        check_integer(self._title, 1, _MAX_ENVS, num_envs=num_envs)
        if processes is not None:
            check_integer(self._title, 1, _MAX_ENVS, processes=processes)
        mode = arguments.get("render_mode")
        if mode not in (None, *_RENDER_MODES):
            raise NotFound(
                f"a batch of {self._title} has no render mode `{mode}`; it has rgb_array"
            )
        self.num_envs = num_envs = int(num_envs)
        self.render_mode = mode
        self._has_episodes = False
        # One environment is made here first: it has the spaces, refuses wrong arguments, and loads
        # the site, which forked processes then have already.
        env = self.env_class(**arguments)
        try:
            self.metadata = env.metadata | {
                "render_modes": list(_RENDER_MODES),
                "autoreset_mode": AutoresetMode.NEXT_STEP,
            }
            self.single_action_space = env.action_space
            self.single_observation_space = env.observation_space
        finally:
            env.close()
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        wanted = usable_processors() if processes is None else int(processes)
        make = partial(self.env_class, **arguments)
        self._workers = Workers(make, num_envs, min(wanted, num_envs))

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Observation, dict[str, Any]]:
        """Reset all environments, and return their observations and infos, stacked.

        An int seeds them with seed, seed + 1 and so on; an environment with the seed None continues
        its random numbers. The options are the same for all.
        """
        seeds = expand_seeds(seed, self.num_envs)
        self._has_episodes = False
        answers = self._request("reset_each", [(seeds[part], options) for part in self._slices])
        self._has_episodes = True
        return self._stack_observations([one[0] for one in answers]), self._merge_infos(
            [one[1] for one in answers]
        )

    def step(
        self, actions: NDArray[Any]
    ) -> tuple[Observation, NDArray[Any], NDArray[Any], NDArray[Any], dict[str, Any]]:
        """Step each environment with its action, and return the results, stacked.

        An environment whose episode is over is reset instead. If an environment raises an error, it
        is raised here. Then all environments must be reset, as some may have made the step.
        """
        self._require_episodes()
        action_array = np.asarray(actions)
        if action_array.shape != self.action_space.shape:
            raise Invalid(
                f"{self._title}: the actions are {actions!r}, and have to be an array of shape "
                f"{self.action_space.shape}"
            )
        self._has_episodes = False
        answers = self._request("step_each", [(action_array[part],) for part in self._slices])
        self._has_episodes = True
        observations, rewards, terminated, truncated, infos = zip(*answers, strict=True)
        return (
            self._stack_observations(observations),
            np.array(rewards, dtype=np.float64),
            np.array(terminated, dtype=np.bool_),
            np.array(truncated, dtype=np.bool_),
            self._merge_infos(infos),
        )

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """Return a picture of each environment, shape (height, width, 3); None without a mode."""
        return None if self.render_mode is None else self.call("render")

    def call(self, name: str, *args: Any, **kwargs: Any) -> tuple[Any, ...]:
        """Call a method of each environment, or read an attribute, and return the results.

        The results must be picklable.
        """
        return self._call_each(name, [args] * self.num_envs, kwargs)

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """Return an attribute of each environment."""
        return self.call(name)

    def set_attr(self, name: str, values: Any) -> None:
        """Set an attribute of each environment to its item of a list or tuple, or to one value."""
        all_values = list(values) if isinstance(values, list | tuple) else [values] * self.num_envs
        if len(all_values) != self.num_envs:
            raise ValueError(f"{self.num_envs} environments need as many values")
        self._request("set_each", [(name, all_values[part]) for part in self._slices])

    def get_state(self) -> dict[str, Any]:
        """Return the states of all environments, from which `set_state` continues.

        They are plain data that can be pickled.
        """
        self._require_episodes()
        ended = self._request("ended_flags", [()] * len(self._slices))
        return {"states": self.call("get_state"), "ended": tuple(ended)}

    def set_state(self, state: Mapping[str, Any]) -> Observation:
        """Continue from a state that `get_state` returned, and return the stacked observations.

        Raises ArgoError if it is not a state of such a batch of the same size.
        """
        fits = isinstance(state, Mapping) and state.keys() == {"states", "ended"}
        if not fits or not all(
            isinstance(part, tuple | list) and len(part) == self.num_envs for part in state.values()
        ):
            raise invalid_state_error(f"a batch of {self.num_envs} {self._title}")
        self._has_episodes = False
        observations = self._call_each("set_state", [(one,) for one in state["states"]], {})
        ended = list(state["ended"])
        self._request("set_ended_flags", [(ended[part],) for part in self._slices])
        self._has_episodes = True
        return self._stack_observations(observations)

    def close_extras(self, **kwargs: Any) -> None:  # noqa: ARG002
        """Close the environments and end the processes."""
        self._has_episodes = False
        if hasattr(self, "_workers"):
            self._workers.close()

    @property
    def _slices(self) -> list[slice]:
        return self._workers.slices

    def _request(self, name: str, arguments: Sequence[tuple[Any, ...]]) -> list[Any]:
        if self.closed:
            raise gym.error.ClosedEnvironmentError(f"{self._title}: the batch is closed")
        return self._workers.call_and_join_answers(name, arguments)

    def _call_each(
        self, name: str, arguments: Sequence[tuple[Any, ...]], named: dict[str, Any]
    ) -> tuple[Any, ...]:
        own = [(name, list(arguments[part]), named) for part in self._slices]
        return tuple(self._request("call_each", own))

    def _state_for_copy(self) -> tuple[tuple[Any, ...], dict[str, Any] | None] | None:
        if self.closed:
            return None
        return self.call("_state_for_copy"), self.get_state() if self._has_episodes else None

    def _restore_copy(self, state: tuple[tuple[Any, ...], dict[str, Any] | None] | None) -> None:
        if state is None:
            self.close()
        elif state[1] is not None:
            self.set_state(state[1])
        else:
            self._call_each("_restore_copy", [(one,) for one in state[0]], {})

    def _require_episodes(self) -> None:
        if not self._has_episodes and not self.closed:
            raise gym.error.ResetNeeded(
                f"{self._title}: no episodes have begun, or one of them has failed: call reset"
            )

    def _stack_observations(self, observations: Sequence[Observation]) -> Observation:
        space = self.single_observation_space
        empty: Any = create_empty_array(space, n=self.num_envs, fn=np.empty)
        joined: Any = concatenate(space, observations, empty)
        return cast("Observation", joined)

    def _merge_infos(self, infos: Sequence[dict[str, Any]]) -> dict[str, Any]:
        joined: dict[str, Any] = {}
        for k, info in enumerate(infos):
            joined = self._add_info(joined, info, k)
        return joined
