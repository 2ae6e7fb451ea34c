"""Parts that all environments share: checks of steps and states, copies, and pictures."""

import os
import sys
from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from copy import deepcopy
from typing import Any, Self, cast

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Invalid, NotFound, Unavailable

StateTypes = Mapping[str, type | tuple[type, ...]]
"""types of the parts of a state, by name"""

_INTEGERS = (int, np.integer)


def expand_seeds(seed: int | Sequence[int | None] | None, count: int) -> list[int | None]:
    """Return a seed for each of `count` environments.

    An int gives seed, seed + 1 and so on; None gives None for each. Raises ValueError if
    the number of seeds is not `count`.
    """
    if seed is None:
        return [None] * count
    if isinstance(seed, int | np.integer):
        return [int(seed) + k for k in range(count)]
    if len(seed) != count:
        raise ValueError(f"{count} environments need as many seeds, not {len(seed)}")
    return list(seed)


def require_episode_begun(over: bool | None, env: str) -> None:
    """Raise ResetNeeded if no episode has begun (`over` is None); the message names `env`."""
    if over is None:
        raise gym.error.ResetNeeded(f"{env}: no episode has begun: call reset")


def require_episode_under_way(over: bool | None, env: str) -> None:
    """Raise ResetNeeded if no episode has begun (`over` is None), or if it is over (True)."""
    require_episode_begun(over, env)
    if over:
        raise gym.error.ResetNeeded(f"{env}: the episode is over: call reset")


def parse_discrete_action(action: Any, count: int, env: str) -> int:
    """Return an action as an int; raise ArgoError if it is no whole number from 0 to count - 1."""
    if isinstance(action, np.ndarray) and action.shape == ():
        action = action[()]
    if isinstance(action, _INTEGERS) and 0 <= (number := int(action)) < count:
        return number
    raise Invalid(
        f"{env}: the action is {action!r}, and has to be a whole number from 0 to {count - 1}"
    )


def check_state(state: Any, parts: StateTypes, env: str) -> None:
    """Raise ArgoError unless the state is a mapping with exactly the `parts`, each of its type.

    The values of `generator` and `begun`, if these are among `parts`, must be states of NumPy's
    PCG64. `env` is for the message.
    """
    fits = (
        isinstance(state, Mapping)
        and state.keys() == parts.keys()
        and all(isinstance(state[name], kind) for name, kind in parts.items())
        and all(
            _is_generator_state(state[name]) for name in ("generator", "begun") if name in parts
        )
    )
    if not fits:
        raise invalid_state_error(env)


def invalid_state_error(env: str) -> Invalid:
    """Return the error for an object that is not a state of the environment."""
    return Invalid(f"this is not a state of {env}: pass a state that its `get_state()` returned")


def _is_generator_state(state: Mapping[str, Any]) -> bool:
    try:
        np.random.PCG64(0).state = cast("Any", state)
    except (KeyError, TypeError, ValueError, OverflowError):
        return False
    return True


_GYMNASIUM_FIELDS = (
    "spec", "action_space", "observation_space", "single_action_space",
    "single_observation_space", "_np_random", "_np_random_seed", "closed",
)  # fmt: skip
"""attributes that Gymnasium sets, with the generators by which spaces are sampled"""


class Copyable:
    """Base of environments whose copies, shallow or deep, and pickles are independent.

    A copy is made with the arguments of the original and continues from its state: equal actions
    give equal steps in both, and neither affects the other. Attributes that were set from outside
    are not copied, and neither is a window: the copy opens its own. Before an episode has begun and
    after `close()` there is no state, and the copy must be reset too.
    """

    _arguments: tuple[tuple[Any, ...], dict[str, Any]]

    def __new__(cls, *args: Any, **kwargs: Any) -> Self:
        self = super().__new__(cls)
        # The caller may change a dictionary or list afterwards.
        self._arguments = (
            tuple(_copy_if_mutable(value) for value in args),
            {name: _copy_if_mutable(value) for name, value in kwargs.items()},
        )
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        args, kwargs = self._arguments
        fields = {name: vars(self)[name] for name in _GYMNASIUM_FIELDS if name in vars(self)}
        return _rebuild, (type(self), args, kwargs, self._state_for_copy(), fields)

    def __copy__(self) -> Self:
        return deepcopy(self)

    @abstractmethod
    def _state_for_copy(self) -> Any:
        """Return the state for `_restore_copy`; it exists at any time, also without an episode."""

    @abstractmethod
    def _restore_copy(self, state: Any) -> None:
        """Restore a state that `_state_for_copy` of another environment returned."""


def _copy_if_mutable(value: Any) -> Any:
    return deepcopy(value) if isinstance(value, Mapping | list | tuple) else value


def _rebuild(
    kind: type[Copyable],
    args: tuple[Any, ...],
    kwargs: dict[str, Any],
    state: Any,
    fields: Mapping[str, Any],
) -> Copyable:
    env = kind(*args, **kwargs)
    env._restore_copy(state)
    vars(env).update(fields)
    return env


_DPI = 100


def check_render_mode(mode: str | None, known: Sequence[str]) -> None:
    """Raise ArgoError if the render mode is neither None nor among the known ones."""
    if mode is not None and mode not in known:
        raise NotFound(f"there is no render mode `{mode}`; choose one of: {', '.join(known)}")


class FigureWindow:
    """Matplotlib window that shows one picture after the other. Close it."""

    def __init__(self, title: str) -> None:
        """Prepare a window, which the first picture opens.

        Raises ArgoError if there is no display. If the environment variable MPLBACKEND is `agg`,
        the window is drawn in memory, as on a machine that only runs tests.
        """
        headless = sys.platform.startswith("linux") and not (
            os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
        )
        if headless and os.environ.get("MPLBACKEND", "").lower() != "agg":
            raise Unavailable(
                "render_mode `human` needs a display, and DISPLAY is not set; "
                "use `rgb_array`, or set MPLBACKEND=agg to draw in memory"
            )
        from matplotlib import pyplot

        self._pyplot = pyplot
        self._title = title
        self._figure: Any = None

    def show(self, picture: NDArray[np.uint8]) -> None:
        """Show a picture, shape (height, width, 3), and process the window's events."""
        if self._figure is None:
            height, width, _ = picture.shape
            # It is named afterwards: a figure made by its name may be another environment's window.
            self._figure = self._pyplot.figure(figsize=(width / _DPI, height / _DPI), dpi=_DPI)
            self._figure.canvas.manager.set_window_title(self._title)
            axes = self._figure.add_axes((0, 0, 1, 1))
            axes.set_axis_off()
            self._image = axes.imshow(picture)
            self._figure.show() if self._interactive else None
        self._image.set_data(picture)
        self._figure.canvas.draw()
        self._figure.canvas.flush_events()

    def close(self) -> None:
        """Close the window."""
        if self._figure is not None:
            self._pyplot.close(self._figure)
            self._figure = None

    @property
    def _interactive(self) -> bool:
        return str(self._pyplot.get_backend()).lower() != "agg"


class Rendering:
    """Base of environments that draw a picture of themselves."""

    render_mode: str | None
    _title: str
    """id of the environment, which messages name; also the title of the window"""
    _window: FigureWindow | None = None

    def render(self) -> NDArray[np.uint8] | None:
        """Return a picture, shape (height, width, 3), or show it in a window with `human`.

        Returns None if the mode is `human`, and if there is no render mode.
        """
        if self.render_mode is None:
            return None
        picture = self._draw_picture()
        if self.render_mode == "rgb_array":
            return picture
        self._window = self._window or FigureWindow(self._title)
        self._window.show(picture)
        return None

    def close(self) -> None:
        """Close the window."""
        if self._window:
            self._window.close()
            self._window = None

    def _draw_picture(self) -> NDArray[np.uint8]:
        raise NotImplementedError

    @contextmanager
    def _replaying(self) -> Iterator[None]:
        """Show nothing while the actions of a state are repeated.

        Raises ArgoError if the actions continue after the end of the episode, as this is no valid
        state.
        """
        mode, self.render_mode = self.render_mode, None
        try:
            yield
        except gym.error.ResetNeeded:
            raise invalid_state_error(self._title) from None
        finally:
            self.render_mode = mode

    def _update_window(self) -> None:
        """Update the window, if there is one."""
        if self.render_mode == "human":
            self.render()
