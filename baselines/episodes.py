"""Episodes of policies on the instances of a test set."""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from argo_compiler.base.errors import ArgoError, Invalid
from argo_env.envs.route import RouteEnv
from baselines.families import InstanceSet
from baselines.policy import Policy

Clock = Callable[[], float]
"""function that returns a time in s"""


@dataclass(frozen=True)
class EpisodeOutcome:
    """Result of one episode: a policy on one instance."""

    instance: int
    """number of the instance"""
    prize: float
    time: float
    """simulated time in s from the start until the robot was docked"""
    feasible: bool
    """whether the robot was docked in time, and no action was illegal"""
    decisions: int
    """number of actions"""
    seconds: float
    """processor time in s that the policy took for its preparation and its decisions"""
    route: tuple[int, ...]
    """nodes chosen by the policy, in their order; the dock or an illegal one is the last"""


def play(
    policy: Policy,
    test_set: InstanceSet,
    instances: int,
    seed: int = 0,
    clock: Clock = time.process_time,
) -> Iterator[EpisodeOutcome]:
    """Run a policy on the first instances of a test set, and yield the outcome of each episode.

    Args:
        policy: the policy.
        test_set: the test set.
        instances: number of its first instances to play.
        seed: seed of the policy's random decisions, the same one for each episode.
        clock: clock that times the policy's decisions; by default that of the processor time.

    Raises:
        ArgoError: if an action of the policy is not a node.
    """
    env = RouteEnv(source=test_set.family.source, full=True)
    for number in test_set.numbers[:instances]:
        yield _run_episode(policy, env, number, seed, clock)


def _run_episode(
    policy: Policy, env: RouteEnv, number: int, seed: int, clock: Clock
) -> EpisodeOutcome:
    observation, _ = env.reset(options={"instance": number})
    begun = clock()
    policy.begin(observation, env.instance.budget, seed)
    seconds = clock() - begun
    total, illegal, over = 0.0, False, False
    route: list[int] = []
    while not over:
        begun = clock()
        action = policy.act(observation)
        seconds += clock() - begun
        try:
            observation, reward, over, _, info = env.step(np.int64(action))
        except (ArgoError, TypeError, ValueError) as error:
            raise Invalid(f"policy {policy.name}, instance {number}: {error}") from None
        route.append(int(action))
        total += reward
        illegal = illegal or info["illegal"]
    feasible = not illegal and not info.get("late", False)
    return EpisodeOutcome(number, total, info["time"], feasible, len(route), seconds, tuple(route))
