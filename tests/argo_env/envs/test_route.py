"""Route-v0: the environment, its batch and the simple evaluator agree bit for bit."""

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.base.errors import ArgoError
from argo_env.envs.route import RouteEnv
from argo_env.envs.route_instance import DOCK, make_instance, score_route
from argo_env.envs.route_sources import TEST, TRAINING, RandomRoutes, RouteFaults, SiteRoutes
from tests.conftest import examples

ID = "argo/Route-v0"
NUMBERS = st.sampled_from(TRAINING) | st.sampled_from(TEST)


def make_batch(count, **arguments):
    return gym.make_vec(ID, num_envs=count, vectorization_mode="vector_entry_point", **arguments)


def equal(a, b):
    """Return True if two structures of dictionaries and arrays are equal, with their types."""
    if isinstance(a, dict):
        return isinstance(b, dict) and a.keys() == b.keys() and all(equal(a[k], b[k]) for k in a)
    if isinstance(a, tuple):
        return all(equal(x, y) for x, y in zip(a, b, strict=True))
    a, b = np.asarray(a), np.asarray(b)
    return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()


def choose(env, rng, far=False):
    """Return a legal checkpoint, if there is one; with `far` the one that leaves the least time."""
    allowed = np.flatnonzero(env.action_masks())[1:]
    if not len(allowed):
        return DOCK
    if far:
        known = env.instance.with_known_blockages_at(env._time())
        return int(allowed[np.argmax(known.time_to_dock_via[env._place, allowed])])
    return int(rng.choice(allowed))


def score_episode(env, next_node):
    """Return the score of an episode and its last info, after a comparison with the evaluator."""
    route, total, over = [], 0.0, False
    while not over:
        route.append(next_node())
        observation, reward, over, truncated, info = env.step(route[-1])
        assert not truncated
        assert sum(info["terms"].values()) == reward
        assert env.observation_space.contains(observation)
        total += reward
    score = score_route(env.instance, route)
    assert (total, info["time"]) == (score.prize, score.time)
    assert info["illegal"] == (score.illegal is not None)
    return score, info


@settings(max_examples=examples(60), deadline=None)
@given(NUMBERS, st.integers(1, 25), st.integers(0, 2**32), st.booleans())
def test_return_is_the_evaluators_score(number, checkpoints, seed, legal):
    source = RandomRoutes(checkpoints)
    env = RouteEnv(source=source)
    rng = np.random.default_rng(seed)
    env.reset(options={"instance": number})

    def next_node():
        allowed = np.flatnonzero(env.action_masks()) if legal else np.arange(checkpoints + 1)
        # The dock only where there is nothing else, so that routes get long.
        return int(rng.choice(allowed[1:] if len(allowed) > 1 else allowed))

    score, _ = score_episode(env, next_node)
    assert score.time <= env.instance.budget
    if legal:
        assert score.illegal is None


@pytest.mark.parametrize(
    ("checkpoints", "noise"), [(12, None), (10, {"failing": 0.3, "blocked": 3})]
)
@settings(max_examples=examples(30), deadline=None)
@given(NUMBERS, st.integers(0, 2**32), st.booleans())
def test_mask_is_what_the_evaluator_allows(checkpoints, noise, number, seed, short):
    env = RouteEnv(checkpoints=checkpoints, noise=noise)
    rng = np.random.default_rng(seed)
    observation, _ = env.reset(options={"instance": number})
    route, over = [], False
    while not over:
        allowed = [
            node == DOCK or score_route(env.instance, [*route, node]).illegal is None
            for node in range(checkpoints + 1)
        ]
        assert env.action_masks().tolist() == allowed
        assert observation["mask"].tolist() == allowed
        route.append(int(rng.choice(np.flatnonzero(allowed))) if short else choose(env, rng))
        observation, _, over, _, _ = env.step(route[-1])


@pytest.mark.parametrize("arguments", [{}, {"full": True, "checkpoints": 7}])
@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP])
def test_batch_equals_single_environments(arguments, mode):
    batch = make_batch(5, **arguments)
    singles = gym.make_vec(ID, num_envs=5, vectorization_mode="sync", **arguments)
    assert batch.metadata["autoreset_mode"] == singles.metadata["autoreset_mode"] == mode
    assert batch.observation_space == singles.observation_space
    assert batch.action_space == singles.action_space
    rng = np.random.default_rng(7)
    options = {"test": True, "floor": [1, 2, 4], "faults": {"closed": 2, "battery": 0.9}}
    for given_seed, given_options in ((3, None), (None, None), ([9, 2, 2, 8, 1], options)):
        outcomes = [e.reset(seed=given_seed, options=given_options) for e in (batch, singles)]
        if given_seed is not None:
            assert equal(*outcomes)
        else:
            batch.reset(seed=4)
            outcomes = [singles.reset(seed=4)] * 2
        for _ in range(60):
            mask = outcomes[0][0]["mask"]
            actions = (rng.random(mask.shape) * (mask + 0.02)).argmax(axis=1)
            outcomes = [e.step(actions) for e in (batch, singles)]
            for one, other in zip(*outcomes, strict=True):
                assert equal(one, other)


def test_batch_continues_from_a_state():
    batch = make_batch(16).unwrapped
    observation, _ = batch.reset(seed=1)
    rng = np.random.default_rng(0)
    plan = []
    for k in range(30):
        if k == 10:
            state = batch.get_state()
        plan.append((rng.random((16, 21)) * observation["mask"]).argmax(axis=1))
        observation, *rest = batch.step(plan[-1])
    other = make_batch(16).unwrapped
    other.set_state(state)
    for actions in plan[10:]:
        again, *others = other.step(actions)
    assert equal(observation, again)
    assert all(equal(a, b) for a, b in zip(rest, others, strict=True))


def test_training_never_draws_a_test_instance():
    env = RouteEnv(checkpoints=3)
    drawn = [env.reset(seed=5)[1]["instance"]] + [env.reset()[1]["instance"] for _ in range(300)]
    assert set(drawn) <= set(TRAINING)
    assert len(set(drawn)) > 250
    env.reset(options={"test": True})
    assert {env.reset()[1]["instance"] for _ in range(50)} <= set(TEST)
    assert not set(TEST) & set(TRAINING)


def test_site_instances_have_its_travel_times(navigator):
    env = RouteEnv(checkpoints=25, scenario="umad", budget=3000.0)
    observation, _ = env.reset(seed=1)
    # The site has 20 checkpoints: the other five can't be reached.
    assert observation["mask"][21:].sum() == 0
    dock = navigator.site.docks[1]
    times = navigator.travel_times([dock, *(c.id for c in navigator.site.checkpoints)])
    measuring = navigator.robot.sensor.measuring_time
    arrival = env.instance.arrival
    assert np.all(np.abs(arrival[1:21, 1:21] - times[1:, 1:] - measuring) <= 1 / 32)
    assert np.all(np.abs(arrival[26, 1:21] - times[0, 1:] - measuring) <= 1 / 32)
    floors = {c.id: c.floor for c in navigator.site.checkpoints}
    observation, _ = env.reset(options={"floor": 2})
    assert {floors[node] for node in np.flatnonzero(observation["mask"][1:21]) + 1} <= {2}


def test_faults_close_checkpoints_and_shorten_the_time():
    source = RandomRoutes(10)
    plain, hurt = source.draw(3), source.draw(3, (), RouteFaults(closed=4, battery=0.5))
    assert np.isinf(hurt.arrival[-1]).sum() == 4
    assert np.isfinite(plain.arrival[-1]).all()
    assert hurt.budget == plain.budget / 2


@pytest.mark.parametrize("checkpoints", [3, 20])
def test_faults_close_checkpoints_that_exist(checkpoints):
    """The site has 6: further slots are empty."""
    source = SiteRoutes(checkpoints, "darmstadt", 3000.0)
    there = min(6, checkpoints)
    drawn = set()
    for number in range(20):
        for closed in range(there + 1):
            instance = source.draw(number, (), RouteFaults(closed=closed))
            reached = np.isfinite(instance.arrival[-1, 1:])
            assert reached.sum() == there - closed
            assert not reached[there:].any()
            drawn.add(tuple(np.flatnonzero(reached)))
    assert len(drawn) > there + 1  # not always the same ones
    env = RouteEnv(scenario="darmstadt", checkpoints=checkpoints)
    env.reset(seed=1, options={"faults": {"closed": there}})
    assert env.action_masks()[1:].sum() == 0
    with pytest.raises(ArgoError, match=f"0 to {there}: .* has {there} checkpoints"):
        env.reset(options={"faults": {"closed": there + 1}})


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"flor": 1}, ("flor", "floor")),
        ({"scenario": "nowhere"}, ("nowhere", "umad")),
        ({"floor": 9}, ("floors 1 to 6", "9")),
        ({"faults": {"battery": 0}}, ("faults.battery",)),
        ({"instance": -1}, ("instance",)),
        ({"instance": [1, 2]}, ("instance", "one number")),
        ({"instance": 4096}, ("`instance`", "4096", "0 to 4095", "1000000 to 1000099", "leave")),
        ({"instance": 1_000_100}, ("`instance`", "1000100", "0 to 4095", "1000000 to 1000099")),
        ({"instance": 3, "test": True}, ("`instance` and `test`", "give one")),
        ({"instance": 3, "scenario": "random"}, ("`instance` and `scenario`", "scenario='random'")),
        ({"faults": {"closed": 999}}, ("`faults.closed`", "999", "0 to 20", "`checkpoints`")),
    ],
)
def test_bad_options_are_refused(options, words):
    env = RouteEnv()
    first, _ = env.reset(seed=3)
    with pytest.raises(ArgoError) as error:
        env.reset(options=options)
    for word in words:
        assert word in str(error.value)
    assert equal(env.reset(seed=3)[0], first)


def test_options_at_the_bounds_are_accepted():
    env = RouteEnv(checkpoints=4)
    for number in (0, 4095, 1_000_000, 1_000_099):
        assert env.reset(options={"instance": number, "test": False})[1]["instance"] == number
    observation, _ = env.reset(options={"faults": {"closed": 4}})
    assert observation["mask"].tolist() == [1, 0, 0, 0, 0]


@pytest.mark.parametrize("options", [{"instance": [3, 4096]}, {"instance": [3, 4], "test": True}])
def test_bad_options_of_a_batch_are_refused(options):
    batch = make_batch(2)
    with pytest.raises(ArgoError, match="instance"):
        batch.reset(options=options)
    assert batch.reset(options={"instance": [3, 4]})[1]["instance"].tolist() == [3, 4]


@pytest.mark.parametrize("count", [0, -1, 1.5, True, None])
def test_a_batch_without_routes_is_refused(count):
    with pytest.raises(ArgoError, match=f"`num_envs` is {count}, .* whole number of at least 1"):
        make_batch(count)


def test_bad_instances_are_refused():
    def make(**changed):
        given_parts = {
            "times": np.ones((4, 3)),
            "service": np.zeros(3),
            "prizes": np.array([0.0, 0.5, 1.0]),
            "pairs": [(1, 2)],
            "budget": 10.0,
            "positions": np.zeros((4, 3)),
        } | changed
        return make_instance(**given_parts)

    assert score_route(make(), [1, 2]).prize == 1.5
    assert score_route(make(), [2, 1]).illegal == 2
    for changed in (
        {"times": np.ones((3, 3))},
        {"times": -np.ones((4, 3))},
        {"prizes": np.array([0.0, 2.0, 1.0])},
        {"pairs": [(1, 1)]},
        {"budget": 0.5},
        {
            "times": np.ones((602, 601)),
            "service": np.zeros(601),
            "prizes": np.zeros(601),
            "positions": np.zeros((602, 3)),
        },
    ):
        with pytest.raises(ArgoError):
            make(**changed)
