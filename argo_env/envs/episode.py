"""What a step and a state are checked for, in every environment."""

from collections.abc import Mapping
from typing import Any, cast

import gymnasium as gym
import numpy as np

from argo_compiler.base.errors import Invalid

Parts = Mapping[str, type | tuple[type, ...]]
"""the types of what a state has, by name"""

_WHOLE = (int, np.integer)


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
