"""Copies and pickles of environments are independent and continue equally."""

import copy
import pickle

import gymnasium as gym
import numpy as np
import pytest

import argo_env  # noqa: F401
from argo_compiler.base.errors import ArgoError
from argo_env.drives.kinematic import KinematicDrive
from argo_env.drives.tracked.body import TrackedBody
from argo_env.drives.tracked.drive import TrackedDrive
from argo_env.pictures.scene import Scene
from argo_env.site import load_site
from argo_env.world.world import World
from tests.argo_env.envs import rollouts
from tests.processes import run_python

SEED, STEPS = 23, 5


def pickled(value):
    return pickle.loads(pickle.dumps(value))


METHODS = {"copy": copy.copy, "deepcopy": copy.deepcopy, "pickle": pickled}


@pytest.fixture(params=sorted(METHODS))
def duplicate(request, closing):
    """Return a function that duplicates an environment by one of the methods."""
    return lambda env: closing(METHODS[request.param](env))


@pytest.fixture
def make(id, small, closing, request):
    """Return a function that makes environments as Gymnasium does, on a small site if possible."""

    def one(**arguments):
        env = gym.make(id, **small | arguments)
        # A shallow copy of a wrapper of Gymnasium contains the same environment.
        bare = request.node.callspec.params.get("duplicate") == "copy"
        return closing(env.unwrapped if bare else env)

    return one


def start_episode(env, steps=STEPS):
    """Reset, and return the observation after so many steps that don't end the episode."""
    env.action_space.seed(SEED)
    observation, _ = env.reset(seed=SEED)
    rng = np.random.default_rng(SEED)
    for _ in range(steps):
        # The first checkpoint of Inspect-v0, which is illegal after the first time.
        inspecting = "battery" in observation
        action = 0 if inspecting else rollouts.choose(env, observation, rng)
        observation, _, terminated, truncated, _ = env.step(action)
        assert not terminated
        assert not truncated
    return observation


def continue_episode(env, observation):
    """Return the digest of further steps, with resets in between, and of sampled actions."""
    outcomes = rollouts.rollout(env, SEED + 1, 2 * STEPS, observation)
    return rollouts.digest((outcomes, [env.action_space.sample() for _ in range(3)]))


def test_copy_continues_equally_in_the_middle_of_an_episode(make, duplicate):
    env = make()
    observation = start_episode(env)
    before = env.unwrapped.get_state()
    other = duplicate(env)
    assert other is not env
    assert other.unwrapped is not env.unwrapped
    assert type(other) is type(env)
    there = continue_episode(other, observation)
    # The steps of the copy have not affected the original.
    assert rollouts.digest(env.unwrapped.get_state()) == rollouts.digest(before)
    assert continue_episode(env, observation) == there


def test_copy_and_original_agree_step_by_step(make, duplicate):
    env = make()
    observation = start_episode(env)
    other, rng = duplicate(env), np.random.default_rng(SEED)
    for _ in range(STEPS):
        action = rollouts.choose(env, observation, rng)
        here, there = env.step(action), other.step(action)
        assert rollouts.digest(here) == rollouts.digest(there)
        observation = here[0]
        if here[2] or here[3]:
            break


def test_copy_before_a_reset(make, duplicate):
    env = make()
    other = duplicate(env)
    with pytest.raises(gym.error.ResetNeeded):
        other.unwrapped.get_state()
    twins = [rollouts.digest(rollouts.rollout(one, SEED, STEPS)) for one in (env, other)]
    assert twins[0] == twins[1]


def test_copy_after_the_end(id, make, duplicate):
    arguments = {} if id == "argo/Route-v0" else {"time_limit": 0.3}
    env = make(**arguments)
    observation, over, rng = env.reset(seed=SEED)[0], False, np.random.default_rng(SEED)
    while not over:
        observation, _, *ends, _ = env.step(rollouts.choose(env, observation, rng))
        over = any(ends)
    other = duplicate(env)
    with pytest.raises(gym.error.ResetNeeded, match="over"):
        other.unwrapped.step(rollouts.choose(env, observation, rng))
    assert rollouts.digest(other.reset()) == rollouts.digest(env.reset())


def test_copy_after_close(make, duplicate):
    env = make()
    start_episode(env)
    env.close()
    other = duplicate(env)
    assert rollouts.digest(other.reset(seed=SEED)) == rollouts.digest(make().reset(seed=SEED))


def test_options_and_generator_are_copied(id, make, duplicate):
    """The options apply in the copy too, and the same generator draws the next episode."""
    options = {
        "argo/Route-v0": {"faults": {"closed": 3}},
        "argo/Drive-v0": {"max_way": 9.0},
        "argo/Inspect-v0": {"faults": [{"kind": "low_battery"}]},
    }[id]
    env = make()
    env.reset(seed=SEED, options=options)
    running, closed = duplicate(env), None
    if id != "argo/Route-v0":  # which has nothing to close, so its episode continues
        env.close()
        closed = duplicate(env)
    expected = rollouts.digest([env.reset() for _ in range(3)])
    for other in filter(None, (running, closed)):
        assert rollouts.digest([other.reset() for _ in range(3)]) == expected


def test_closing_the_copy_does_not_close_the_original(make, duplicate):
    env = make(render_mode="rgb_array")
    observation = start_episode(env)
    duplicate(env).close()
    assert env.render().ndim == 3
    continue_episode(env, observation)


def test_copy_draws_the_same_picture(make, duplicate):
    env = make(render_mode="rgb_array")
    start_episode(env)
    other = duplicate(env)
    assert np.array_equal(other.render(), env.render())


def test_copy_has_a_window_of_its_own(make, duplicate, monkeypatch):
    monkeypatch.setenv("MPLBACKEND", "agg")  # windows are drawn in memory
    from matplotlib import pyplot

    env = make(render_mode="human")
    start_episode(env, 1)
    windows = len(pyplot.get_fignums())
    other = duplicate(env)
    assert len(pyplot.get_fignums()) == windows  # it opens with the next step
    other.reset()
    assert len(pyplot.get_fignums()) == windows + 1
    other.close()
    assert len(pyplot.get_fignums()) == windows


def test_arguments_may_change_afterwards(closing, duplicate):
    noise = {"failing": 0.3, "blocked": 1}
    env = closing(gym.make("argo/Route-v0", noise=noise)).unwrapped
    made = closing(type(env)(noise=noise))
    observation = start_episode(made)
    noise["failing"] = 0.0
    assert continue_episode(duplicate(made), observation) == continue_episode(made, observation)


def test_copy_in_another_process(make, tmp_path):
    """A pickle that is loaded in another process continues equally."""
    env = make()
    observation = start_episode(env)
    (tmp_path / "env").write_bytes(pickle.dumps((env, observation)))
    code = (
        "import pickle, sys; from tests.argo_env.envs.test_copies import continue_episode; "
        "print(continue_episode(*pickle.load(open(sys.argv[1], 'rb'))))"
    )
    run = run_python("-c", code, tmp_path / "env")
    assert run.stdout.strip() == continue_episode(env, observation)


# -- batches


FEW = {"instance": [3, 1, 4, 1, 5], "faults": {"closed": 2}}
"""options, so that fewer instances than the 4,096 of training have to be made"""


@pytest.fixture
def batch(closing):
    return closing(
        gym.make_vec(
            "argo/Route-v0", num_envs=5, vectorization_mode="vector_entry_point", checkpoints=6
        )
    )


def steps_of(batch, observation, steps=30):
    rng, outcomes = np.random.default_rng(SEED), []
    for _ in range(steps):
        actions = [rng.choice(np.flatnonzero(mask)) for mask in observation["mask"]]
        observation, *rest = batch.step(np.array(actions))
        outcomes.append((observation, *rest))
    return rollouts.digest((outcomes, batch.action_space.sample()))


@pytest.mark.parametrize("steps", [0, 4, 25])
def test_batch_copy_continues_equally(batch, duplicate, steps):
    batch.action_space.seed(SEED)
    observation, _ = batch.reset(seed=SEED, options=FEW)
    for _ in range(steps):
        observation, *_ = batch.step(observation["mask"].argmax(axis=1))
    before = rollouts.digest(batch.get_state()["arrays"])
    other = duplicate(batch)
    there = steps_of(other, observation)
    assert rollouts.digest(batch.get_state()["arrays"]) == before
    assert steps_of(batch, observation) == there


def test_batch_copy_before_a_reset(batch, duplicate):
    other = duplicate(batch)
    with pytest.raises(gym.error.ResetNeeded):
        other.step(np.zeros(5, int))
    resets = [rollouts.digest(one.reset(seed=SEED, options=FEW)) for one in (other, batch)]
    assert resets[0] == resets[1]


def test_batch_copy_after_close(batch, duplicate):
    batch.reset(seed=SEED, options=FEW)
    batch.close()
    other = duplicate(batch)
    assert other.closed
    resets = [rollouts.digest(one.reset(seed=SEED, options=FEW)) for one in (other, batch)]
    assert resets[0] == resets[1]


def test_batches_of_gymnasium(id, small, closing):
    """Gymnasium's batches may contain copies, and may be copied."""
    env = closing(gym.make(id, **small))
    several = closing(gym.vector.SyncVectorEnv([lambda: copy.deepcopy(env)] * 2))
    several.reset(seed=SEED)
    several.step(several.action_space.sample())
    other = closing(copy.deepcopy(several))
    actions = several.action_space.sample()
    # Gymnasium's `info` has arrays of objects, which can't be compared bit by bit.
    assert rollouts.digest(other.step(actions)[:4]) == rollouts.digest(several.step(actions)[:4])
    apart = closing(gym.make_vec(id, 2, "async", **small))
    first = closing(gym.make_vec(id, 2, "sync", **small))
    assert rollouts.digest(apart.reset(seed=SEED)[0]) == rollouts.digest(first.reset(seed=SEED)[0])


# -- objects that hold a simulator


@pytest.mark.physics
@pytest.mark.parametrize("method", sorted(METHODS))
@pytest.mark.parametrize(
    "kind", ["World", "Scene", "TrackedBody", "TrackedDrive", "KinematicDrive"]
)
def test_copies_of_simulators_are_refused_with_the_reason(yard_file, robot, method, kind):
    site = load_site(yard_file)
    with World(site, robot) as world:
        made = {
            "World": lambda: world,
            "Scene": lambda: Scene(site, robot),
            "TrackedBody": lambda: TrackedBody(world, robot),
            "TrackedDrive": lambda: TrackedDrive(world, robot),
            "KinematicDrive": lambda: KinematicDrive(world, robot),
        }[kind]()
        with pytest.raises(ArgoError, match=f"an? {kind} can't be copied or pickled, as") as caught:
            METHODS[method](made)
        assert isinstance(caught.value, TypeError)


@pytest.mark.physics
def test_garbage_collected_connections_end(yard_file, robot):
    """PyBullet has 1,024; a search that copies environments does not close all of them."""
    import gc

    from argo_env.world.world import pybullet

    world = World(load_site(yard_file), robot)
    client = world._client
    assert pybullet.isConnected(client)
    del world
    gc.collect()
    assert not pybullet.isConnected(client)
