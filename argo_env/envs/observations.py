"""Observations with named parts."""

from collections.abc import Mapping
from typing import Any, cast

from gymnasium import spaces
from numpy.typing import NDArray

Observation = dict[str, NDArray[Any]]


def dict_space(parts: Mapping[str, spaces.Space[Any]]) -> spaces.Space[Observation]:
    """Return the Gymnasium space of observations that have these parts, by their names."""
    return cast("spaces.Space[Observation]", spaces.Dict(dict(parts)))
