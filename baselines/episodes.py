"""Policies on the instances of a test set."""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from argo_compiler.base.errors import ArgoError, Invalid
from argo_env.envs.route import RouteEnv
from baselines.families import InstanceSet
from baselines.policy import Policy

Clock = Callable[[], float]


@dataclass(frozen=True)
class EpisodeOutcome:
    """What a policy did on one instance."""

    instance: int
    prize: float
    time: float
    """s when the robot was docked"""
    feasible: bool
    """whether it was docked in time, and no action was illegal"""
    decisions: int
    seconds: float
    """s of processor time that the policy thought, its preparation included"""
    route: tuple[int, ...]
    """the nodes in order, the dock at the end"""


def play(
    policy: Policy,
    tests: InstanceSet,
    instances: int,
    seed: int = 0,
    clock: Clock = time.process_time,
) -> Iterator[EpisodeOutcome]:
    """The outcomes of a policy on the first instances of a test set, one after the other.

    Raises ArgoError if the policy's action is no node.
    """
    env = RouteEnv(source=tests.family.source, full=True)
    for number in tests.numbers[:instances]:
        yield _drive(policy, env, number, seed, clock)


def _drive(policy: Policy, env: RouteEnv, number: int, seed: int, clock: Clock) -> EpisodeOutcome:
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
