"""Imitation learning, the first stage of the training: the network imitates exact values.

A sample is a state of a small route problem, which has a few checkpoints of a training instance.
The network learns which actions win the highest prize there, or win as much in the least time; how
much worse the others are; and the highest prize that can still be won.
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
from baselines.learned.oracle import Floats, Oracle, RemainingRoutes

_PRIZE_SCALE = 0.1
"""loss of prize that makes an action e times less likely in the target distribution"""
_TIME_SCALE = 0.02  # likewise the loss of time, as a share of the time left
_ROUTES = 2  # routes that are followed through each small problem
_RANDOM = 0.1  # share of steps on these routes that are drawn from all legal actions alike
_BATCH = 16  # small problems in a batch


@dataclass(frozen=True)
class Lessons:
    """Samples with m checkpoints: inputs and targets of the network."""

    observation: dict[str, NDArray[np.float32]]
    """inputs by name, the first dimension being the samples"""
    target: Floats
    """probability of each action, shape (samples, m + 1)"""
    value: Floats
    """highest prize that can still be won, shape (samples,)"""

    def __len__(self) -> int:
        return len(self.value)

    def select_samples(self, rows: NDArray[np.int64]) -> "Lessons":
        """Return a copy with the samples at these indices only."""
        observation = {name: array[rows] for name, array in self.observation.items()}
        return Lessons(observation, self.target[rows], self.value[rows])


def make_lessons(source: RouteSource, size: int, min_count: int, seed: int) -> Lessons:
    """Make at least `min_count` samples with `size` checkpoints, the same for equal arguments.

    A sample is a state on a route through a small problem, with the exact values of its actions.
    There may be more than `min_count`, as samples are made in batches of problems.
    """
    rng = generator(seed, "lessons", size)
    samples: list[tuple[dict[str, Floats], Floats, float]] = []
    with stage(f"making lessons with {size} checkpoints") as report:
        while len(samples) < min_count:
            report(len(samples) / min_count)
            problems = [_draw_problem(source, size, rng) for _ in range(_BATCH)]
            oracle = Oracle(
                RemainingRoutes(*(np.stack(parts) for parts in zip(*problems, strict=True)))
            )
            for k in range(_BATCH):
                for _ in range(_ROUTES):
                    samples += _follow_route(oracle, k, rng)
    observation = {name: np.stack([one[0][name] for one in samples]) for name in samples[0][0]}
    return Lessons(
        observation,
        np.stack([one[1] for one in samples]),
        np.array([one[2] for one in samples], np.float32),
    )


def _draw_problem(source: RouteSource, size: int, rng: np.random.Generator) -> tuple[Any, ...]:
    """Draw a small problem: `size` checkpoints of an instance, a start and the time left.

    Returns the values of RemainingRoutes, of one route.
    """
    while True:
        instance = source.draw(int(rng.integers(2**19)))
        reachable = np.flatnonzero(np.isfinite(instance.arrival[-1, 1:])) + 1
        if len(reachable) > size:
            break
    shuffled = rng.permutation(reachable)
    here = instance.start_row if rng.random() < 0.3 else int(shuffled[size])
    chosen = shuffled[:size]
    between = instance.arrival[np.ix_(chosen, chosen)]
    home, start = instance.arrival[chosen, DOCK], instance.arrival[here, chosen]
    left = _nearest_neighbour_time(start, between, home) * rng.uniform(0.25, 1.1)
    return (
        start,
        instance.arrival[here, DOCK],
        between,
        home,
        instance.prizes[chosen].astype(np.float32),
        instance.before[np.ix_(chosen, chosen)],
        np.float32(max(left, instance.arrival[here, DOCK], 1.0)),
    )


def _nearest_neighbour_time(start: Floats, between: Floats, home: Floats) -> float:
    """Return the time in s of the nearest-neighbour route through all checkpoints to the dock."""
    times, time, visited = start, 0.0, np.zeros(len(start), np.float32)
    for _ in range(len(start)):
        k = int(np.argmin(times + visited))
        time += float(times[k])
        visited[k] = np.inf
        times = between[k]
    return time + float(home[k])


def _follow_route(
    oracle: Oracle, k: int, rng: np.random.Generator
) -> Iterator[tuple[dict[str, Floats], Floats, float]]:
    """Yield samples on a random route through problem k: observation, target, most prize left.

    Most steps are drawn from the target distribution, the others from all legal actions.
    """
    routes, visited = oracle.routes, 0
    travel, back, left = routes.start[k], routes.back[k], float(routes.left[k])
    budget = left
    while len(actions := oracle.legal_actions(k, visited, travel, left)):
        prize, time = oracle.action_prizes_and_times(k, visited, travel, left, actions)
        lost = (prize.max() - prize) / _PRIZE_SCALE
        best = time[prize >= prize.max() - 1e-5].min()
        lost = lost + np.maximum(time - best, 0.0) / left / _TIME_SCALE
        target = np.exp(-lost)
        target /= target.sum()
        yield (
            _observe(oracle, k, visited, np.append(back, travel), left, budget, actions),
            np.append(np.float32(0.0), _scatter(target, actions, len(travel))),
            float(prize.max()),
        )
        chosen = rng.choice(actions) if rng.random() < _RANDOM else rng.choice(actions, p=target)
        visited |= 1 << int(chosen)
        left -= float(travel[chosen])
        travel, back = routes.between[k, chosen], routes.home[k, chosen]


def _scatter(values: Floats, actions: NDArray[np.int32], size: int) -> Floats:
    """Return an array with the values at the indices of their actions, and 0 elsewhere."""
    scattered = np.zeros(size, np.float32)
    scattered[actions] = values
    return scattered


def _observe(
    oracle: Oracle, k: int, visited: int, travel: Floats, left: float, budget: float,
    actions: NDArray[np.int32],
) -> dict[str, Floats]:  # fmt: skip
    """Return the observation that `RouteEnv` would give of this state of problem k.

    The matrix has no row of the start, which is not needed. `visited` is a bit mask of checkpoints;
    `travel` has the times in s from here to all nodes, the dock first; `left` and `budget` are the
    time left and the time left at the start, in s.
    """
    routes = oracle.routes
    m = len(travel) - 1
    unvisited = (visited >> np.arange(m) & 1) == 0
    matrix = np.full((m + 1, m + 1), np.inf, np.float32)
    matrix[1:, 1:], matrix[1:, DOCK] = routes.between[k], routes.home[k]
    before = np.zeros((m + 1, m + 1), np.float32)
    before[1:, 1:] = routes.before[k]
    observation = {
        "travel": np.minimum(travel / budget, 1.0),
        "home": np.minimum(np.append(0.0, routes.home[k]) / budget, 1.0),
        "prize": np.append(0.0, routes.prizes[k] * unvisited),
        "left": np.array([left / budget]),
        "mask": np.append(1.0, _scatter(np.ones(len(actions), np.float32), actions, m)),
        "matrix": np.minimum(matrix / budget, 1.0),
        "before": before,
    }
    return {name: array.astype(np.float32) for name, array in observation.items()}


def action_and_value_losses(
    network: RouteNetwork, lessons: Lessons
) -> tuple[torch.Tensor, torch.Tensor]:
    """Return the losses of the network's action distribution and of its value.

    The first is the Kullback-Leibler divergence from the target distribution in nats, the second
    the mean of the squared errors of the value; this mean is divided by the number of checkpoints.
    """
    observation = {name: torch.from_numpy(array) for name, array in lessons.observation.items()}
    scores, value = network(observation)
    scores = scores.masked_fill(observation["mask"] == 0, -1e9)
    target = torch.from_numpy(lessons.target)
    actions = functional.kl_div(scores.log_softmax(dim=1), target, reduction="batchmean")
    size = target.shape[1] - 1
    return actions, ((value[:, 0] - torch.from_numpy(lessons.value)) ** 2).mean() / size
