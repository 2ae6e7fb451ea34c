"""The learned policies with the shipped weights."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from argo_env.envs.route import RouteEnv  # noqa: E402
from argo_env.envs.route_sources import TEST  # noqa: E402
from baselines.learned.agent import WEIGHTS, LearnedPolicy, SampledPolicy, Scorer  # noqa: E402
from baselines.policy import make_policy  # noqa: E402

torch.set_num_threads(1)


@pytest.fixture(scope="module")
def scorer() -> Scorer:
    return Scorer()


def play(env: RouteEnv, number: int, policy: Any, seed: int = 0) -> tuple[float, list[int]]:
    """Return the prize and the route of a policy; fail if a step is illegal."""
    observation, _ = env.reset(seed=number, options={"instance": number})
    policy.begin(observation, 1200.0, seed)
    total, route, over = 0.0, [], False
    while not over:
        route.append(policy.act(observation))
        observation, reward, over, _, info = env.step(route[-1])
        assert not info["illegal"]
        total += reward
    return total, route


def test_learned_policies_are_better_than_the_nearest_neighbour(scorer: Scorer) -> None:
    env = RouteEnv(full=True)
    prizes = {
        name: np.array([play(env, number, policy)[0] for number in TEST[:6]])
        for name, policy in [
            ("nearest", make_policy("nearest-neighbour")),
            ("learned", LearnedPolicy(scorer)),
            ("sampled", SampledPolicy(scorer, 8)),
        ]
    }
    assert prizes["learned"].mean() > 1.05 * prizes["nearest"].mean()
    # One of the simulated routes follows the highest scores.
    assert (prizes["sampled"] >= prizes["learned"] - 1e-6).all()


@pytest.mark.parametrize("make", [LearnedPolicy, lambda scorer: SampledPolicy(scorer, 4)])
@pytest.mark.parametrize("checkpoints", [1, 5, 40])
def test_steps_are_legal_with_any_number_of_checkpoints(
    scorer: Scorer, make: Callable[[Scorer], Any], checkpoints: int
) -> None:
    env = RouteEnv(checkpoints, budget=300.0 + 30.0 * checkpoints, full=True)
    assert play(env, TEST[0], make(scorer))[1][-1] == 0


def test_policies_dock_despite_failed_readings_and_blocked_stairs(scorer: Scorer) -> None:
    env = RouteEnv(12, full=True, noise={"failing": 0.3, "blocked": 2})
    for number in TEST[:2]:
        for policy in (LearnedPolicy(scorer), SampledPolicy(scorer, 4)):
            _, route = play(env, number, policy)
            assert route[-1] == 0


def test_equal_seeds_give_equal_routes(scorer: Scorer) -> None:
    env = RouteEnv(40, full=True)
    first, again, other = (
        play(env, TEST[1], SampledPolicy(scorer, 4), seed)[1] for seed in (1, 1, 2)
    )
    assert first == again
    assert first != other


def test_the_shipped_weights_are_small() -> None:
    assert WEIGHTS.stat().st_size < 300_000
