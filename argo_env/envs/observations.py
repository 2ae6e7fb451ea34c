"""Observations with named parts."""

from collections.abc import Mapping
from typing import Any, cast

from gymnasium import spaces
from numpy.typing import NDArray

Observation = dict[str, NDArray[Any]]


def dict_space(parts: Mapping[str, spaces.Space[Any]]) -> spaces.Space[Observation]:
    """Return the space of observations with these parts."""
    return cast("spaces.Space[Observation]", spaces.Dict(dict(parts)))
