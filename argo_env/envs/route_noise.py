"""What goes wrong while a robot is on its way: what may be asked for, and how it is drawn."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from argo_compiler.base.model import Model
from argo_env.envs.route_instance import Stair

_FIRST, _LAST = 0.1, 0.9
"""shares of the budget between which stairs are found blocked"""


class RouteNoise(Model):
    """What the robot finds out on its way only."""

    failing: float = Field(default=0.0, ge=0.0, le=0.9, strict=True)
    """the probability that a visit of a checkpoint gives no reading, each time anew"""
    blocked: int = Field(default=0, ge=0, le=5, strict=True)
    """how many stairs between two floors are found blocked, one after the other; fewer, if more
    would leave no way round"""


NO_NOISE = RouteNoise()


def draw_failing(noise: RouteNoise, count: int, rng: np.random.Generator) -> NDArray[np.int16]:
    """How many visits of each node fail before one does not, shape (count + 1,); the dock's are
    0."""
    failing = rng.geometric(1.0 - noise.failing, count) - 1
    return np.concatenate([[0], failing]).astype(np.int16)


def draw_blocked(
    noise: RouteNoise,
    budget: float,
    stairs: Sequence[Stair],
    times_without: Callable[[tuple[Stair, ...]], NDArray[np.float64] | None],
    rng: np.random.Generator,
) -> list[tuple[float, NDArray[np.float64], tuple[Stair, ...]]]:
    """When (s) stairs are found blocked, the travel times from then on, and all stairs that are
    blocked by then.

    `times_without` says the travel times without some stairs, None if those are indispensable.
    """
    moments = (budget * np.sort(rng.uniform(_FIRST, _LAST, noise.blocked))).tolist()
    found: list[tuple[float, NDArray[np.float64], tuple[Stair, ...]]] = []
    blocked: tuple[Stair, ...] = ()
    for k in rng.permutation(len(stairs)).tolist():
        if len(found) == len(moments):
            break
        tried = (*blocked, stairs[k])
        times = times_without(tried)
        if times is not None:
            blocked = tried
            found.append((moments[len(found)], times, blocked))
    return found
