"""Noise in Route-v0: readings that fail, and stairs that are blocked."""

import gymnasium as gym
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.base.errors import ArgoError
from argo_env.envs.route import RouteEnv
from argo_env.envs.route_instance import DOCK, TICK
from argo_env.envs.route_noise import RouteNoise
from argo_env.envs.route_sources import RandomRoutes, RouteFaults, SiteRoutes
from tests.argo_env.envs.test_route import NUMBERS, choose, equal, make_batch, score_episode
from tests.conftest import examples

NOISES = st.builds(RouteNoise, failing=st.floats(0.01, 0.9), blocked=st.integers(0, 5))


@settings(max_examples=examples(40), deadline=None)
@given(NUMBERS, st.integers(1, 25), NOISES, st.integers(0, 2**32), st.floats(0.3, 1.0))
def test_return_is_the_evaluators_score(number, checkpoints, noise, seed, battery):
    env = RouteEnv(source=RandomRoutes(checkpoints, noise=noise))
    rng = np.random.default_rng(seed)
    far = bool(seed % 2)
    env.reset(options={"instance": number, "faults": {"battery": battery}})

    def next_node():
        legal = rng.random() < 0.97
        return choose(env, rng, far) if legal else int(rng.integers(checkpoints + 1))

    score, info = score_episode(env, next_node)
    assert info["late"] == score.late
    assert score.late == (score.time > env.instance.budget)
    if score.late:
        assert score.prize == 0.0


def test_some_routes_are_late_and_lose_their_prize():
    env = RouteEnv(noise={"blocked": 5})
    rng, late = np.random.default_rng(0), []
    env.reset(seed=0)
    for _ in range(100):
        over, prizes = False, []
        while not over:
            _, reward, over, _, info = env.step(choose(env, rng, far=True))
            prizes.append(info["terms"]["prize"])
        assert reward == pytest.approx(-sum(prizes) if info["late"] else 0.0, abs=1e-12)
        late.append(info["late"])
        env.reset()
    assert 2 < sum(late) < 50


def test_batch_equals_single_environments():
    arguments = {"checkpoints": 9, "full": True, "noise": {"failing": 0.3, "blocked": 5}}
    batch = make_batch(24, **arguments)
    singles = gym.make_vec("argo/Route-v0", num_envs=24, vectorization_mode="sync", **arguments)
    rng, late = np.random.default_rng(7), 0
    options = {"test": True, "faults": {"closed": 1, "battery": 0.6}}
    outcomes = [e.reset(seed=3, options=options) for e in (batch, singles)]
    assert equal(*outcomes)
    for k in range(120):
        mask = outcomes[0][0]["mask"]
        # Mostly the farthest checkpoints, so that some routes are late.
        drawn = (rng.random(mask.shape) + outcomes[0][0]["travel"]) * (mask + 0.01)
        drawn[:, DOCK] = 0.005
        actions = drawn.argmax(axis=1)
        outcomes = [e.step(actions) for e in (batch, singles)]
        for one, other in zip(*outcomes, strict=True):
            assert equal(one, other)
        late += int(outcomes[0][4].get("late", np.zeros(1)).sum())
        if k == 60:
            state = batch.unwrapped.get_state()
            other = make_batch(24, **arguments)
            assert equal(other.unwrapped.set_state(state), outcomes[0][0])
    assert late > 0


def test_a_failed_visit_can_be_repeated():
    env = RouteEnv(noise={"failing": 0.9})
    env.reset(options={"instance": 3})
    failing = env.instance.hidden.failing
    node = next(k for k in np.flatnonzero(env.action_masks())[1:] if 1 <= failing[k] <= 8)
    prize = env.instance.prizes[node]
    for _ in range(failing[node]):
        assert env.action_masks()[node]
        observation, reward, _, _, info = env.step(node)
        assert (reward, info["failed"]) == (0.0, True)
        assert observation["prize"][node] == np.float32(prize)
    observation, reward, _, _, info = env.step(node)
    assert (reward, info["failed"]) == (prize, False)
    assert not observation["mask"][node]


def test_hidden_parts_are_observed_only_when_they_appear():
    plain, noisy = RouteEnv(full=True), RouteEnv(full=True, noise={"failing": 0.5})
    for number in range(20):
        seen = [e.reset(options={"instance": number})[0] for e in (plain, noisy)]
        assert equal(*seen)  # the failing readings are not observed
    env = RouteEnv(full=True, noise={"blocked": 2})
    env.reset(options={"instance": 5})
    (first, second) = env.instance.hidden.changes
    assert first.since % TICK == 0.0
    assert first.since < second.since
    rng, over, before = np.random.default_rng(1), False, -1.0
    while not over:
        node = choose(env, rng)
        place, begun = env._place, max(before, 0.0)
        observation, _, over, _, info = env.step(node)
        # A drive takes the time that was observed at its start.
        assert (
            info["time"] - begun == env.instance.with_known_blockages_at(begun).arrival[place, node]
        )
        known = env.instance.with_known_blockages_at(info["time"])
        assert np.array_equal(observation["matrix"], known.travel_shares)
        assert np.array_equal(observation["home"], known.time_to_dock_shares)
        before = info["time"]
    assert before > second.since


@settings(max_examples=examples(30), deadline=None)
@given(NUMBERS, st.integers(2, 8), st.integers(1, 5))
def test_blocked_stairs_only_ever_make_ways_longer(number, floors, blocked):
    source = RandomRoutes(12, floors, noise=RouteNoise(blocked=blocked))
    instance = source.draw(number)
    before = instance.arrival
    assert len(instance.hidden.changes) == min(blocked, floors - 1)
    for change in instance.hidden.changes:
        now = change.known.arrival
        assert np.isfinite(now[1:]).all()
        assert (now >= before).all()
        before = now
    # Another staircase is a way round: never more than two widths of the floor each.
    assert (before[1:] - instance.arrival[1:]).max() <= 2 * 30 / 0.4 * blocked + 1
    # Two staircases are no slower than the one there is without noise.
    assert (instance.arrival[1:] <= RandomRoutes(12, floors).draw(number).arrival[1:]).all()


def test_noise_does_not_change_the_known_parts():
    for faults in (RouteFaults(), RouteFaults(closed=2, battery=0.7)):
        plain = RandomRoutes(15).draw(8, (1, 2, 3), faults)
        noisy = RandomRoutes(15, noise=RouteNoise(failing=0.4)).draw(8, (1, 2, 3), faults)
        for name in ("arrival", "prizes", "before", "positions"):
            assert equal(getattr(plain, name), getattr(noisy, name))
        assert plain.budget == noisy.budget
        assert plain.hidden is None


def test_blocked_stairs_of_a_site(navigator):
    instance = SiteRoutes(20, "umad", 3000.0, RouteNoise(blocked=1)).draw(4)
    (change,) = instance.hidden.changes
    ((tower, floor),) = change.blocked
    assert navigator.site.spec.towers[tower].name
    now, before = change.known.arrival[1:], instance.arrival[1:]
    assert np.isfinite(now).all()
    assert (now >= before).all()
    longer = (now > before).any(axis=1)
    assert longer.any()
    # Some paths between floors need these stairs; those on one floor do not.
    places = instance.positions
    same = places[1:, None, 2] == places[None, :-1, 2]
    assert (now[same] - before[same]).max() < 60.0
    assert floor in range(1, 6)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"noise": {"failing": 1.0}}, "`failing`"),
        ({"noise": {"blocked": -1}}, "`blocked`"),
        ({"noise": {"blocked": True}}, "`blocked`"),
        ({"noise": {"wind": 1}}, "`wind`"),
        ({"noise": 3}, "dictionary"),
        ({"noise": {"failing": 0.2}, "source": RandomRoutes(3)}, "`noise` and `source`"),
        ({"noise": {"blocked": 1}, "scenario": "darmstadt"}, "no detour"),
    ],
)
def test_bad_noise_is_refused(arguments, words):
    with pytest.raises(ArgoError, match=words):
        RouteEnv(**arguments)


def test_a_site_without_a_detour_is_refused_and_changes_nothing():
    env = RouteEnv(noise={"blocked": 1})
    first, _ = env.reset(seed=3)
    with pytest.raises(ArgoError, match="darmstadt"):
        env.reset(options={"scenario": "darmstadt"})
    assert equal(env.reset(seed=3)[0], first)
