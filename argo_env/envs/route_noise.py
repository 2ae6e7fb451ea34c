"""Noise of Route-v0, which the robot learns only on its way: its settings, and how it is drawn."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from argo_compiler.base.model import Model
from argo_env.envs.route_instance import Stair

_FIRST, _LAST = 0.1, 0.9
"""shares of the budget between which stairs are found blocked"""


class RouteNoise(Model):
    """Settings of what the robot learns only on its way."""

    failing: float = Field(default=0.0, ge=0.0, le=0.9, strict=True)
    """probability that a visit of a checkpoint gives no reading, independently each time"""
    blocked: int = Field(default=0, ge=0, le=5, strict=True)
    """number of stairs between two floors that are found blocked, one after the other; fewer if
    more would leave no detour"""


NO_NOISE = RouteNoise()


def draw_failures(noise: RouteNoise, count: int, rng: np.random.Generator) -> NDArray[np.int16]:
    """Draw how many visits of each node fail before the first that succeeds, shape (count + 1,).

    `count` is the number of checkpoints; the dock is node 0, whose number is 0.
    """
    failing = rng.geometric(1.0 - noise.failing, count) - 1
    return np.concatenate([[0], failing]).astype(np.int16)


def draw_blocked_stairs(
    noise: RouteNoise,
    budget: float,
    stairs: Sequence[Stair],
    times_without: Callable[[tuple[Stair, ...]], NDArray[np.float64] | None],
    rng: np.random.Generator,
) -> list[tuple[float, NDArray[np.float64], tuple[Stair, ...]]]:
    """Draw which stairs are found blocked, and when.

    Args:
        noise: Settings.
        budget: s of the episode, during which the stairs are found blocked.
        stairs: Stairs that may be blocked.
        times_without: Function that returns the travel times (s) without some stairs, None if these
            are indispensable.
        rng: Generator.

    Returns:
        For each change, in the order of time: its time (s), the travel times (s) from then on, and
            all stairs that are blocked by then.
    """
    moments = (budget * np.sort(rng.uniform(_FIRST, _LAST, noise.blocked))).tolist()
    changes: list[tuple[float, NDArray[np.float64], tuple[Stair, ...]]] = []
    blocked: tuple[Stair, ...] = ()
    for k in rng.permutation(len(stairs)).tolist():
        if len(changes) == len(moments):
            break
        candidate = (*blocked, stairs[k])
        times = times_without(candidate)
        if times is not None:
            blocked = candidate
            changes.append((moments[len(changes)], times, blocked))
    return changes
