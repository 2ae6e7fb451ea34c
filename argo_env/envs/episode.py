"""Parts that every environment has: checks of its steps and states, copies, and pictures."""

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

Parts = Mapping[str, type | tuple[type, ...]]
"""the types of what a state has, by name"""

_WHOLE = (int, np.integer)


def seeds_of(seed: int | Sequence[int | None] | None, count: int) -> list[int | None]:
    """The seed of each of so many environments: an int seeds them with seed, seed + 1 and so on."""
    if seed is None:
        return [None] * count
    if isinstance(seed, int | np.integer):
        return [int(seed) + k for k in range(count)]
    if len(seed) != count:
        raise ValueError(f"{count} environments need as many seeds, not {len(seed)}")
    return list(seed)


def check_begun(over: bool | None, env: str) -> None:
    """Raises ResetNeeded if there is no episode yet; `over` is None then."""
    if over is None:
        raise gym.error.ResetNeeded(f"{env}: no episode has begun: call reset")


def check_under_way(over: bool | None, env: str) -> None:
    """Raises ResetNeeded if there is no episode yet (`over` is None), or it is over."""
    check_begun(over, env)
    if over:
        raise gym.error.ResetNeeded(f"{env}: the episode is over: call reset")


def read_choice(action: Any, count: int, env: str) -> int:
    """An action of `Discrete(count)` as an int; ArgoError if it is none."""
    if isinstance(action, np.ndarray) and action.shape == ():
        action = action[()]
    if isinstance(action, _WHOLE) and 0 <= (number := int(action)) < count:
        return number
    raise Invalid(f"{env}: no action {action!r}; an action is a whole number, 0 to {count - 1}")


def check_state(state: Any, parts: Parts, env: str) -> None:
    """Raises ArgoError unless the state has these parts, of these types, and no others.

    The part `generator`, and `begun` likewise, is what NumPy's PCG64 calls its state.
    """
    fits = (
        isinstance(state, Mapping)
        and state.keys() == parts.keys()
        and all(isinstance(state[name], kind) for name, kind in parts.items())
        and all(_of_generator(state[name]) for name in ("generator", "begun") if name in parts)
    )
    if not fits:
        raise no_state(env)


def no_state(env: str) -> Invalid:
    """The error for what is no state of the environment."""
    return Invalid(f"this is no state of {env}: take what `get_state()` of such a one gave")


def _of_generator(state: Mapping[str, Any]) -> bool:
    try:
        np.random.PCG64(0).state = cast("Any", state)
    except (KeyError, TypeError, ValueError, OverflowError):
        return False
    return True


_CARRIED = (
    "spec", "action_space", "observation_space", "single_action_space",
    "single_observation_space", "_np_random", "_np_random_seed", "closed",
)  # fmt: skip
"""what Gymnasium keeps in an environment, the generators of samples included"""


class Copying:
    """An environment whose copies, shallow or deep, and pickles stand on their own.

    A copy is made of the arguments that the environment was made of, and goes on from its state:
    equal actions give equal steps in both, and neither knows of the other. Attributes that were set
    from outside are not taken along, nor is a window: the copy opens one of its own. Before
    an episode has begun and after `close()` there is no state, and the copy has to be reset too.
    """

    _arguments: tuple[tuple[Any, ...], dict[str, Any]]

    def __new__(cls, *args: Any, **kwargs: Any) -> Self:
        self = super().__new__(cls)
        # A dictionary or list may be changed by whoever gave it.
        self._arguments = (
            tuple(_own(value) for value in args),
            {name: _own(value) for name, value in kwargs.items()},
        )
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        args, kwargs = self._arguments
        carried = {name: vars(self)[name] for name in _CARRIED if name in vars(self)}
        return _made_again, (type(self), args, kwargs, self._copied_state(), carried)

    def __copy__(self) -> Self:
        return deepcopy(self)

    @abstractmethod
    def _copied_state(self) -> Any:
        """What `_go_on_from` goes on from, at any time: also without an episode."""

    @abstractmethod
    def _go_on_from(self, state: Any) -> None:
        """Takes on what `_copied_state` of another one gave."""


def _own(value: Any) -> Any:
    return deepcopy(value) if isinstance(value, Mapping | list | tuple) else value


def _made_again(
    kind: type[Copying],
    args: tuple[Any, ...],
    kwargs: dict[str, Any],
    state: Any,
    carried: Mapping[str, Any],
) -> Copying:
    env = kind(*args, **kwargs)
    env._go_on_from(state)
    vars(env).update(carried)
    return env


_DPI = 100


def check_render_mode(mode: str | None, known: Sequence[str]) -> None:
    """Raises ArgoError if there is no such render mode."""
    if mode is not None and mode not in known:
        raise NotFound(f"no render mode `{mode}`; there are: {', '.join(known)}")


class FigureWindow:
    """A matplotlib window that shows one picture after the other. Close it."""

    def __init__(self, title: str) -> None:
        """Raises ArgoError where there is no display. With the environment variable MPLBACKEND set
        to `agg` the window is drawn in memory, as on a machine that only runs tests."""
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
        """Shows a picture, shape (height, width, 3), and lets the window react."""
        if self._figure is None:
            height, width, _ = picture.shape
            # Named afterwards: a figure that is made by a name may be another one's window.
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
        """Closes the window."""
        if self._figure is not None:
            self._pyplot.close(self._figure)
            self._figure = None

    @property
    def _interactive(self) -> bool:
        return str(self._pyplot.get_backend()).lower() != "agg"


class Rendering:
    """What environments have in common that draw a picture of themselves."""

    render_mode: str | None
    _title: str
    """of the window"""
    _window: FigureWindow | None = None

    def render(self) -> NDArray[np.uint8] | None:
        """A picture, shape (height, width, 3); with `human` it is in a window."""
        if self.render_mode is None:
            return None
        picture = self._picture()
        if self.render_mode == "rgb_array":
            return picture
        self._window = self._window or FigureWindow(self._title)
        self._window.show(picture)
        return None

    def close(self) -> None:
        """Closes the window."""
        if self._window:
            self._window.close()
            self._window = None

    def _picture(self) -> NDArray[np.uint8]:
        raise NotImplementedError

    @contextmanager
    def _repeating(self) -> Iterator[None]:
        """While the steps of a state are made again nothing is shown; it is none if it goes on
        after the end of its episode."""
        mode, self.render_mode = self.render_mode, None
        try:
            yield
        except gym.error.ResetNeeded:
            raise no_state(self._title) from None
        finally:
            self.render_mode = mode

    def _show(self) -> None:
        """Brings the window up to date, if there is one."""
        if self.render_mode == "human":
            self.render()
