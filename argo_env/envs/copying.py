"""Copies and pickles of environments: made anew of the same arguments, and in the same state."""

from abc import abstractmethod
from collections.abc import Mapping
from copy import deepcopy
from typing import Any, Self

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
