"""The warm start: the network is taught by the exact values of small routes.

A sample is a state of a route with few checkpoints, cut out of a training instance. The network
learns which actions are best there, how much worse the others are, and what is visited at best.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch.nn import functional

from argo_compiler.base.stages import stage
from argo_env.envs.route_instance import DOCK
from argo_env.envs.route_sources import RouteSource
from argo_env.seeding import generator
from baselines.learned.network import RouteNetwork
from baselines.learned.oracle import Floats, Oracle, Remainder

_PRIZE_SCALE = 0.1
"""a prize lost by an action that makes it e times less likely in what is taught"""
_TIME_SCALE = 0.02  # likewise of time lost, as a share of the time left
_ROUTES = 2  # that are followed through each instance
_ASTRAY = 0.1  # of the steps on them are any legal ones
_BATCH = 16  # routes


@dataclass(frozen=True)
class Lessons:
    """Samples with m checkpoints: what the network observes, and what it is to answer."""

    observation: dict[str, NDArray[np.float32]]
    target: Floats
    """the probability of each action, shape (samples, m + 1)"""
    value: Floats
    """the prize that is still to come at best, shape (samples,)"""

    def __len__(self) -> int:
        return len(self.value)

    def part(self, rows: NDArray[np.int64]) -> "Lessons":
        """Some of the samples."""
        observation = {name: array[rows] for name, array in self.observation.items()}
        return Lessons(observation, self.target[rows], self.value[rows])


def lessons(source: RouteSource, size: int, count: int, seed: int) -> Lessons:
    """At least `count` samples with `size` checkpoints. Equal arguments give equal samples."""
    rng = generator(seed, "lessons", size)
    found: list[tuple[dict[str, Floats], Floats, float]] = []
    with stage(f"lessons with {size} checkpoints") as tell:
        while len(found) < count:
            tell(len(found) / count)
            cuts = [_cut(source, size, rng) for _ in range(_BATCH)]
            oracle = Oracle(Remainder(*(np.stack(parts) for parts in zip(*cuts, strict=True))))
            for k in range(_BATCH):
                for _ in range(_ROUTES):
                    found += _follow(oracle, k, rng)
    observation = {name: np.stack([one[0][name] for one in found]) for name in found[0][0]}
    return Lessons(
        observation,
        np.stack([one[1] for one in found]),
        np.array([one[2] for one in found], np.float32),
    )


def _cut(source: RouteSource, size: int, rng: np.random.Generator) -> tuple[Any, ...]:
    """Some checkpoints of an instance, a place to set off and some time, as Remainder has them."""
    while True:
        instance = source.draw(int(rng.integers(2**19)))
        there = np.flatnonzero(np.isfinite(instance.arrival[-1, 1:])) + 1
        if len(there) > size:
            break
    some = rng.permutation(there)
    here = instance.start if rng.random() < 0.3 else int(some[size])
    chosen = some[:size]
    between = instance.arrival[np.ix_(chosen, chosen)]
    home, start = instance.arrival[chosen, DOCK], instance.arrival[here, chosen]
    left = _tour(start, between, home) * rng.uniform(0.25, 1.1)
    return (
        start,
        instance.arrival[here, DOCK],
        between,
        home,
        instance.prizes[chosen].astype(np.float32),
        instance.before[np.ix_(chosen, chosen)],
        np.float32(max(left, instance.arrival[here, DOCK], 1.0)),
    )


def _tour(start: Floats, between: Floats, home: Floats) -> float:
    """s to the nearest checkpoint, from there to the next nearest, and home at the end."""
    times, time, rest = start, 0.0, np.zeros(len(start), np.float32)
    for _ in range(len(start)):
        k = int(np.argmin(times + rest))
        time += float(times[k])
        rest[k] = np.inf
        times = between[k]
    return time + float(home[k])


def _follow(
    oracle: Oracle, k: int, rng: np.random.Generator
) -> Iterator[tuple[dict[str, Floats], Floats, float]]:
    """The samples on one way through a route: good steps as a rule, at times any."""
    routes, visited = oracle.routes, 0
    travel, back, left = routes.start[k], routes.back[k], float(routes.left[k])
    whole = left
    while len(actions := oracle.legal(k, visited, travel, left)):
        prize, time = oracle.values(k, visited, travel, left, actions)
        lost = (prize.max() - prize) / _PRIZE_SCALE
        best = time[prize >= prize.max() - 1e-5].min()
        lost = lost + np.maximum(time - best, 0.0) / left / _TIME_SCALE
        target = np.exp(-lost)
        target /= target.sum()
        yield (
            _observed(oracle, k, visited, np.append(back, travel), left, whole, actions),
            np.append(np.float32(0.0), _spread(target, actions, len(travel))),
            float(prize.max()),
        )
        chosen = rng.choice(actions) if rng.random() < _ASTRAY else rng.choice(actions, p=target)
        visited |= 1 << int(chosen)
        left -= float(travel[chosen])
        travel, back = routes.between[k, chosen], routes.home[k, chosen]


def _spread(values: Floats, actions: NDArray[np.int32], size: int) -> Floats:
    """The values at their actions, 0 elsewhere."""
    spread = np.zeros(size, np.float32)
    spread[actions] = values
    return spread


def _observed(
    oracle: Oracle, k: int, visited: int, travel: Floats, left: float, whole: float,
    actions: NDArray[np.int32],
) -> dict[str, Floats]:  # fmt: skip
    """The state as `RouteEnv` would show it, but for the row of the start, which is not needed."""
    routes = oracle.routes
    m = len(travel) - 1
    still = (visited >> np.arange(m) & 1) == 0
    matrix = np.full((m + 1, m + 1), np.inf, np.float32)
    matrix[1:, 1:], matrix[1:, DOCK] = routes.between[k], routes.home[k]
    before = np.zeros((m + 1, m + 1), np.float32)
    before[1:, 1:] = routes.before[k]
    observation = {
        "travel": np.minimum(travel / whole, 1.0),
        "home": np.minimum(np.append(0.0, routes.home[k]) / whole, 1.0),
        "prize": np.append(0.0, routes.prizes[k] * still),
        "left": np.array([left / whole]),
        "mask": np.append(1.0, _spread(np.ones(len(actions), np.float32), actions, m)),
        "matrix": np.minimum(matrix / whole, 1.0),
        "before": before,
    }
    return {name: array.astype(np.float32) for name, array in observation.items()}


def loss(network: RouteNetwork, lesson: Lessons) -> tuple[torch.Tensor, torch.Tensor]:
    """How far the network's answers are from what is taught: of the actions (cross-entropy less
    that of the target, nats), and of the value (its square, per checkpoint)."""
    observation = {name: torch.from_numpy(array) for name, array in lesson.observation.items()}
    scores, value = network(observation)
    scores = scores.masked_fill(observation["mask"] == 0, -1e9)
    target = torch.from_numpy(lesson.target)
    actions = functional.kl_div(scores.log_softmax(dim=1), target, reduction="batchmean")
    size = target.shape[1] - 1
    return actions, ((value[:, 0] - torch.from_numpy(lesson.value)) ** 2).mean() / size
