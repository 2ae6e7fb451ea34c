"""Exact values that the network learns, compared with those of all orders."""

from itertools import permutations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

pytest.importorskip("torch")

from argo_env.envs.route_instance import RouteInstance, score_route
from argo_env.envs.route_sources import RandomRoutes
from baselines.learned.imitation import make_lessons
from baselines.learned.oracle import Oracle, RemainingRoutes
from tests.conftest import examples


def make_oracle(instance: RouteInstance) -> Oracle:
    return Oracle(
        RemainingRoutes(
            start=instance.arrival[-1:, 1:],
            back=instance.arrival[-1:, 0],
            between=instance.arrival[None, 1:-1, 1:],
            home=instance.arrival[None, 1:-1, 0],
            prizes=instance.prizes[None, 1:].astype(np.float32),
            before=instance.before[None, 1:, 1:],
            left=np.array([instance.budget], np.float32),
        )
    )


@given(st.integers(0, 10_000), st.integers(1, 5), st.floats(100.0, 900.0), st.floats(0.0, 1.0))
@settings(max_examples=examples(25))
def test_values_are_those_of_the_best_order(
    number: int, size: int, budget: float, precedence: float
) -> None:
    instance = RandomRoutes(size, 3, 100.0 + budget, precedence=precedence).draw(number)
    oracle = make_oracle(instance)
    start, left = instance.arrival[-1, 1:], instance.budget
    actions = oracle.legal_actions(0, 0, start, left)
    if not len(actions):
        assert all(score_route(instance, [k]).illegal for k in range(1, size + 1))
        return
    prizes, times = oracle.action_prizes_and_times(0, 0, start, left, actions)
    for action in range(1, size + 1):
        scores = [
            score
            for length in range(size)
            for rest in permutations([k for k in range(1, size + 1) if k != action], length)
            if (score := score_route(instance, (action, *rest))).illegal is None
        ]
        assert bool(scores) == (action - 1 in actions)
        if scores:
            k = list(actions).index(action - 1)
            best = max(score.prize for score in scores)
            assert abs(prizes[k] - best) < 1e-4
            assert times[k] == min(score.time for score in scores if score.prize > best - 1e-4)


def test_lessons_are_states_that_the_environment_could_show() -> None:
    lessons = make_lessons(RandomRoutes(12), 8, 60, seed=3)
    again = make_lessons(RandomRoutes(12), 8, 60, seed=3)
    assert np.array_equal(lessons.target, again.target)
    observation = lessons.observation
    assert all(((array >= 0) & (array <= 1)).all() for array in observation.values())
    np.testing.assert_allclose(lessons.target.sum(axis=1), 1.0, rtol=1e-5)
    assert (lessons.target[observation["mask"] == 0] == 0).all()
    assert (lessons.target[:, 0] == 0).all(), "a visit is always better than to dock"
    assert (lessons.value <= observation["prize"].sum(axis=1) + 1e-4).all()
    legal = observation["travel"] + observation["home"] <= observation["left"] + 1e-5
    assert legal[:, 1:][observation["mask"][:, 1:] == 1].all()
