"""Copies and pickles of environments stand on their own and go on the same."""

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


WAYS = {"copy": copy.copy, "deepcopy": copy.deepcopy, "pickle": pickled}


@pytest.fixture(params=sorted(WAYS))
def duplicate(request, closing):
    """Duplicates an environment in one of the ways there are."""
    return lambda env: closing(WAYS[request.param](env))


@pytest.fixture
def make(id, small, closing, request):
    """Makes environments of one kind as Gymnasium does, on a small site where they have one."""

    def one(**arguments):
        env = gym.make(id, **small | arguments)
        # A shallow copy of one of Gymnasium's wrappers has the same environment in it.
        bare = request.node.callspec.params.get("duplicate") == "copy"
        return closing(env.unwrapped if bare else env)

    return one


def begun(env, steps=STEPS):
    """The observation after so many steps that don't end the episode."""
    env.action_space.seed(SEED)
    observation, _ = env.reset(seed=SEED)
    rng = np.random.default_rng(SEED)
    for _ in range(steps):
        # The first checkpoint of Inspect-v0, which is an illegal action after the first time.
        inspecting = "battery" in observation
        action = 0 if inspecting else rollouts.choose(env, observation, rng)
        observation, _, terminated, truncated, _ = env.step(action)
        assert not terminated
        assert not truncated
    return observation


def following(env, observation):
    """What further steps give, with resets in between, and sampled actions."""
    heard = rollouts.rollout(env, SEED + 1, 2 * STEPS, observation)
    return rollouts.digest((heard, [env.action_space.sample() for _ in range(3)]))


def test_goes_on_the_same_in_the_middle_of_an_episode(make, duplicate):
    env = make()
    observation = begun(env)
    before = env.unwrapped.get_state()
    other = duplicate(env)
    assert other is not env
    assert other.unwrapped is not env.unwrapped
    assert type(other) is type(env)
    there = following(other, observation)
    # The original has noticed nothing of what the other did.
    assert rollouts.digest(env.unwrapped.get_state()) == rollouts.digest(before)
    assert following(env, observation) == there


def test_step_by_step_side_by_side(make, duplicate):
    env = make()
    observation = begun(env)
    other, rng = duplicate(env), np.random.default_rng(SEED)
    for _ in range(STEPS):
        action = rollouts.choose(env, observation, rng)
        here, there = env.step(action), other.step(action)
        assert rollouts.digest(here) == rollouts.digest(there)
        observation = here[0]
        if here[2] or here[3]:
            break


def test_before_a_reset(make, duplicate):
    env = make()
    other = duplicate(env)
    with pytest.raises(gym.error.ResetNeeded):
        other.unwrapped.get_state()
    twins = [rollouts.digest(rollouts.rollout(one, SEED, STEPS)) for one in (env, other)]
    assert twins[0] == twins[1]


def test_after_the_end(id, make, duplicate):
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


def test_after_close(make, duplicate):
    env = make()
    begun(env)
    env.close()
    other = duplicate(env)
    assert rollouts.digest(other.reset(seed=SEED)) == rollouts.digest(make().reset(seed=SEED))


def test_options_and_generator_last(id, make, duplicate):
    """What was chosen holds on in the copy, and the next episode is drawn by the same generator."""
    options = {
        "argo/Route-v0": {"faults": {"closed": 3}},
        "argo/Drive-v0": {"max_way": 9.0},
        "argo/Inspect-v0": {"faults": [{"kind": "low_battery"}]},
    }[id]
    env = make()
    env.reset(seed=SEED, options=options)
    running, closed = duplicate(env), None
    if id != "argo/Route-v0":  # which has nothing to close, so that its episode goes on
        env.close()
        closed = duplicate(env)
    expected = rollouts.digest([env.reset() for _ in range(3)])
    for other in filter(None, (running, closed)):
        assert rollouts.digest([other.reset() for _ in range(3)]) == expected


def test_closing_the_copy_leaves_the_original(make, duplicate):
    env = make(render_mode="rgb_array")
    observation = begun(env)
    duplicate(env).close()
    assert env.render().ndim == 3
    following(env, observation)


def test_draws_itself(make, duplicate):
    env = make(render_mode="rgb_array")
    begun(env)
    other = duplicate(env)
    assert np.array_equal(other.render(), env.render())


def test_has_a_window_of_its_own(make, duplicate, monkeypatch):
    monkeypatch.setenv("MPLBACKEND", "agg")  # windows are drawn in memory
    from matplotlib import pyplot

    env = make(render_mode="human")
    begun(env, 1)
    windows = len(pyplot.get_fignums())
    other = duplicate(env)
    assert len(pyplot.get_fignums()) == windows  # it opens with the next step
    other.reset()
    assert len(pyplot.get_fignums()) == windows + 1
    other.close()
    assert len(pyplot.get_fignums()) == windows


def test_what_was_given_may_change_afterwards(closing, duplicate):
    noise = {"failing": 0.3, "blocked": 1}
    env = closing(gym.make("argo/Route-v0", noise=noise)).unwrapped
    made = closing(type(env)(noise=noise))
    observation = begun(made)
    noise["failing"] = 0.0
    assert following(duplicate(made), observation) == following(made, observation)


def test_elsewhere(make, tmp_path):
    """Pickled into another process it does the same."""
    env = make()
    observation = begun(env)
    (tmp_path / "env").write_bytes(pickle.dumps((env, observation)))
    code = (
        "import pickle, sys; from tests.argo_env.envs.test_copies import following; "
        "print(following(*pickle.load(open(sys.argv[1], 'rb'))))"
    )
    run = run_python("-c", code, tmp_path / "env")
    assert run.stdout.strip() == following(env, observation)


# -- batches


FEW = {"instance": [3, 1, 4, 1, 5], "faults": {"closed": 2}}
"""options, so that there are fewer instances to be made than the 4,096 of training"""


@pytest.fixture
def batch(closing):
    return closing(
        gym.make_vec(
            "argo/Route-v0", num_envs=5, vectorization_mode="vector_entry_point", checkpoints=6
        )
    )


def steps_of(batch, observation, steps=30):
    rng, heard = np.random.default_rng(SEED), []
    for _ in range(steps):
        actions = [rng.choice(np.flatnonzero(mask)) for mask in observation["mask"]]
        observation, *rest = batch.step(np.array(actions))
        heard.append((observation, *rest))
    return rollouts.digest((heard, batch.action_space.sample()))


@pytest.mark.parametrize("steps", [0, 4, 25])
def test_batch_goes_on_the_same(batch, duplicate, steps):
    batch.action_space.seed(SEED)
    observation, _ = batch.reset(seed=SEED, options=FEW)
    for _ in range(steps):
        observation, *_ = batch.step(observation["mask"].argmax(axis=1))
    before = rollouts.digest(batch.get_state()["arrays"])
    other = duplicate(batch)
    there = steps_of(other, observation)
    assert rollouts.digest(batch.get_state()["arrays"]) == before
    assert steps_of(batch, observation) == there


def test_batch_before_a_reset(batch, duplicate):
    other = duplicate(batch)
    with pytest.raises(gym.error.ResetNeeded):
        other.step(np.zeros(5, int))
    resets = [rollouts.digest(one.reset(seed=SEED, options=FEW)) for one in (other, batch)]
    assert resets[0] == resets[1]


def test_batch_after_close(batch, duplicate):
    batch.reset(seed=SEED, options=FEW)
    batch.close()
    other = duplicate(batch)
    assert other.closed
    resets = [rollouts.digest(one.reset(seed=SEED, options=FEW)) for one in (other, batch)]
    assert resets[0] == resets[1]


def test_batches_of_gymnasium(id, small, closing):
    """Those of copies, and copies of those."""
    env = closing(gym.make(id, **small))
    several = closing(gym.vector.SyncVectorEnv([lambda: copy.deepcopy(env)] * 2))
    several.reset(seed=SEED)
    several.step(several.action_space.sample())
    other = closing(copy.deepcopy(several))
    actions = several.action_space.sample()
    # What Gymnasium tells in `info` are arrays of objects, which are not compared bit by bit.
    assert rollouts.digest(other.step(actions)[:4]) == rollouts.digest(several.step(actions)[:4])
    apart = closing(gym.make_vec(id, 2, "async", **small))
    first = closing(gym.make_vec(id, 2, "sync", **small))
    assert rollouts.digest(apart.reset(seed=SEED)[0]) == rollouts.digest(first.reset(seed=SEED)[0])


# -- what holds a simulator is refused


@pytest.mark.parametrize("way", sorted(WAYS))
@pytest.mark.parametrize(
    "kind", ["World", "Scene", "TrackedBody", "TrackedDrive", "KinematicDrive"]
)
def test_refused_with_the_reason(yard_file, robot, way, kind):
    site = load_site(yard_file)
    with World(site, robot) as world:
        made = {
            "World": lambda: world,
            "Scene": lambda: Scene(site, robot),
            "TrackedBody": lambda: TrackedBody(world, robot),
            "TrackedDrive": lambda: TrackedDrive(world, robot),
            "KinematicDrive": lambda: KinematicDrive(world, robot),
        }[kind]()
        with pytest.raises(ArgoError, match=f"a {kind} can't be copied or pickled, as") as caught:
            WAYS[way](made)
        assert isinstance(caught.value, TypeError)


def test_connections_that_are_forgotten_end(yard_file, robot):
    """PyBullet has 1,024; a search that copies environments does not close all of them."""
    import gc

    from argo_env.world.world import pybullet

    world = World(load_site(yard_file), robot)
    client = world._client
    assert pybullet.isConnected(client)
    del world
    gc.collect()
    assert not pybullet.isConnected(client)
