"""Batches of environments whose steps take long: spread over processes, on all cores."""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, ClassVar, cast

import gymnasium as gym
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space, concatenate, create_empty_array
from numpy.typing import NDArray

from argo_compiler.base.errors import Invalid, NotFound
from argo_env.envs.episode import Copying, no_state, seeds_of
from argo_env.envs.observations import Observation
from argo_env.envs.options import check_whole
from argo_env.envs.workers import Workers
from argo_env.worker_processes import usable_processors

_MOST = 10_000  # environments
_RENDER_MODES = ("rgb_array",)


class SpreadVectorEnv(Copying, VectorEnv[Observation, NDArray[Any], NDArray[Any]]):
    """Many environments of one kind, spread over worker processes.

    Each is what a single environment would be with the same seeds, options and actions. An episode
    that has ended is begun anew by the next step, whose action for it is ignored and whose reward
    is 0: `metadata["autoreset_mode"]` is `AutoresetMode.NEXT_STEP`. Close it: else the processes
    end with it.
    """

    single: ClassVar[type[gym.Env[Any, Any]]]
    """the kind of its environments"""
    _title: str

    def __init__(self, num_envs: int = 1, processes: int | None = None, **arguments: Any) -> None:
        """`processes`: how many; None: as many as there are cores, and no more than environments.
        The `arguments` are those of the single environment.

        Raises ArgoError as the single environment does, and for a window as render mode.
        """
        check_whole(self._title, 1, _MOST, num_envs=num_envs)
        if processes is not None:
            check_whole(self._title, 1, _MOST, processes=processes)
        mode = arguments.get("render_mode")
        if mode not in (None, *_RENDER_MODES):
            raise NotFound(
                f"a batch of {self._title} has no render mode `{mode}`; it has rgb_array"
            )
        self.num_envs = num_envs = int(num_envs)
        self.render_mode = mode
        self._begun = False
        # One is made here first: for its spaces, to refuse arguments, and so that processes that
        # are forked have the site already.
        one = self.single(**arguments)
        try:
            self.metadata = one.metadata | {
                "render_modes": list(_RENDER_MODES),
                "autoreset_mode": AutoresetMode.NEXT_STEP,
            }
            self.single_action_space = one.action_space
            self.single_observation_space = one.observation_space
        finally:
            one.close()
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        wanted = usable_processors() if processes is None else int(processes)
        make = partial(self.single, **arguments)
        self._workers = Workers(make, num_envs, min(wanted, num_envs))

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Observation, dict[str, Any]]:
        """Begins all episodes; an int seeds them with seed, seed + 1 and so on."""
        seeds = seeds_of(seed, self.num_envs)
        self._begun = False
        told = self._ask("resets", [(seeds[share], options) for share in self._shares])
        self._begun = True
        return self._joined([one[0] for one in told]), self._infos([one[1] for one in told])

    def step(
        self, actions: NDArray[Any]
    ) -> tuple[Observation, NDArray[Any], NDArray[Any], NDArray[Any], dict[str, Any]]:
        """Steps all. If one of them raises an error, it is raised here, and all have to be reset,
        as others may have gone on."""
        self._require_begun()
        given = np.asarray(actions)
        if given.shape != self.action_space.shape:
            raise Invalid(
                f"{self._title}: no actions {actions!r}; they are an array of the shape "
                f"{self.action_space.shape}"
            )
        self._begun = False
        told = self._ask("steps", [(given[share],) for share in self._shares])
        self._begun = True
        observations, rewards, terminated, truncated, infos = zip(*told, strict=True)
        return (
            self._joined(observations),
            np.array(rewards, dtype=np.float64),
            np.array(terminated, dtype=np.bool_),
            np.array(truncated, dtype=np.bool_),
            self._infos(infos),
        )

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """A picture of each."""
        return None if self.render_mode is None else self.call("render")

    def call(self, name: str, *args: Any, **kwargs: Any) -> tuple[Any, ...]:
        """What a method of each environment returns, or an attribute; it has to be picklable."""
        return self._call_each(name, [args] * self.num_envs, kwargs)

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """An attribute of each environment."""
        return self.call(name)

    def set_attr(self, name: str, values: Any) -> None:
        """Sets an attribute of each environment: to its own of a list or tuple, or to one value."""
        all_values = list(values) if isinstance(values, list | tuple) else [values] * self.num_envs
        if len(all_values) != self.num_envs:
            raise ValueError(f"{self.num_envs} environments need as many values")
        self._ask("sets", [(name, all_values[share]) for share in self._shares])

    def get_state(self) -> dict[str, Any]:
        """All that the future depends on, as plain data that can be pickled."""
        self._require_begun()
        ended = self._ask("ended", [()] * len(self._shares))
        return {"states": self.call("get_state"), "ended": tuple(ended)}

    def set_state(self, state: Mapping[str, Any]) -> Observation:
        """Goes on from what `get_state` gave; returns the observation of that moment. Raises
        ArgoError if it is no state of such a batch, of the same size."""
        fits = isinstance(state, Mapping) and state.keys() == {"states", "ended"}
        if not fits or not all(
            isinstance(part, tuple | list) and len(part) == self.num_envs for part in state.values()
        ):
            raise no_state(f"a batch of {self.num_envs} {self._title}")
        self._begun = False
        observations = self._call_each("set_state", [(one,) for one in state["states"]], {})
        ended = list(state["ended"])
        self._ask("continues", [(ended[share],) for share in self._shares])
        self._begun = True
        return self._joined(observations)

    def close_extras(self, **kwargs: Any) -> None:  # noqa: ARG002
        """Closes the environments, and ends the processes."""
        self._begun = False
        if hasattr(self, "_workers"):
            self._workers.close()

    @property
    def _shares(self) -> list[slice]:
        return self._workers.shares

    def _ask(self, name: str, arguments: Sequence[tuple[Any, ...]]) -> list[Any]:
        if self.closed:
            raise gym.error.ClosedEnvironmentError(f"{self._title}: the batch is closed")
        return self._workers.ask(name, arguments)

    def _call_each(
        self, name: str, arguments: Sequence[tuple[Any, ...]], named: dict[str, Any]
    ) -> tuple[Any, ...]:
        own = [(name, list(arguments[share]), named) for share in self._shares]
        return tuple(self._ask("calls", own))

    def _copied_state(self) -> tuple[tuple[Any, ...], dict[str, Any] | None] | None:
        if self.closed:
            return None
        return self.call("_copied_state"), self.get_state() if self._begun else None

    def _go_on_from(self, state: tuple[tuple[Any, ...], dict[str, Any] | None] | None) -> None:
        if state is None:
            self.close()
        elif state[1] is not None:
            self.set_state(state[1])
        else:
            self._call_each("_go_on_from", [(one,) for one in state[0]], {})

    def _require_begun(self) -> None:
        if not self._begun and not self.closed:
            raise gym.error.ResetNeeded(
                f"{self._title}: no episodes have begun, or one of them has failed: call reset"
            )

    def _joined(self, observations: Sequence[Observation]) -> Observation:
        space = self.single_observation_space
        empty: Any = create_empty_array(space, n=self.num_envs, fn=np.empty)
        joined: Any = concatenate(space, observations, empty)
        return cast("Observation", joined)

    def _infos(self, infos: Sequence[dict[str, Any]]) -> dict[str, Any]:
        joined: dict[str, Any] = {}
        for k, info in enumerate(infos):
            joined = self._add_info(joined, info, k)
        return joined
