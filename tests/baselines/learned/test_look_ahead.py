"""The look-ahead of the network, compared with the same rules in the environment."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

torch = pytest.importorskip("torch")

from argo_env.envs.route import RouteEnv  # noqa: E402
from argo_env.envs.route_sources import RandomRoutes  # noqa: E402
from baselines.learned.look_ahead import POWERS, rule_prizes_and_times_left  # noqa: E402
from tests.conftest import examples  # noqa: E402


@given(st.integers(0, 4000), st.integers(1, 12), st.integers(0, 3))
@settings(max_examples=examples(10))
def test_the_look_ahead_wins_what_the_rules_win(number: int, size: int, moves: int) -> None:
    env = RouteEnv(source=RandomRoutes(size, budget=800.0, precedence=0.4), full=True)
    observation, _ = env.reset(options={"instance": number})
    for _ in range(moves):
        legal = np.flatnonzero(observation["mask"][1:]) + 1
        if len(legal):
            observation = env.step(legal[0])[0]
    state = env.get_state()
    left = observation["left"][0]
    tensors = {name: torch.from_numpy(np.asarray(a)[None]) for name, a in observation.items()}
    legal = tensors["mask"].bool()
    legal[:, 0] = False
    won, spare = rule_prizes_and_times_left(
        legal,
        tensors["prize"] > 0,
        tensors["prize"],
        tensors["travel"] / left,
        tensors["home"] / left,
        tensors["matrix"][:, : size + 1] / left,
        tensors["before"].float(),
    )
    for node in range(size + 1):
        for rule, power in enumerate(POWERS):
            expected = (0.0, 0.0)
            if legal[0, node]:
                env.set_state(state)
                expected = drive(env, node, power, left)
            assert won[0, node, rule].item() == pytest.approx(expected[0], abs=1e-4)
            assert spare[0, node, rule].item() == pytest.approx(expected[1], abs=1e-3)


def drive(env: RouteEnv, node: int, power: float, left: float) -> tuple[float, float]:
    """Follow a rule after the node; return its prize and the time left before the drive home.

    The time is a share of `left`.
    """
    total = 0.0
    while True:
        observation, prize, _, _, _ = env.step(node)
        total += prize
        legal = np.flatnonzero(observation["mask"][1:]) + 1
        if not len(legal):
            return total, float(observation["left"][0] / left)
        travel = observation["travel"][legal] / left
        rating = observation["prize"][legal] ** power / (travel + 0.01)
        node = int(legal[rating.argmax()])
